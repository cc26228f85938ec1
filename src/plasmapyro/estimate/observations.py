"""What the instruments say about the chain of states and about the constants."""

import dataclasses
import operator

import numpy as np

from plasmapyro.estimate.banded import inner
from plasmapyro.estimate.dynamics import FLICKER, GAS, RATE, SIZE, TEMPERATURE
from plasmapyro.estimate.instrument import GreyTable

PARTED = np.array([0.5, -0.5])  # share of the two bands in what their ratio wanders by
TINY = 1e-9  # [1] of a brightness that a path may pass through
HUBER = 4.0  # [1] residuals beyond this many standard deviations count less
NODES, WEIGHTS = np.polynomial.legendre.leggauss(5)  # of the mean over an exposure, which lasts from -1 to 1


@dataclasses.dataclass(frozen=True)
class Constants:
    """Values, prior means and standard deviations of what does not change during a test."""

    names: tuple  # of each entry
    mean: np.ndarray
    deviation: np.ndarray

    def where(self, name):
        """Positions of the entries of a name."""
        return np.flatnonzero([entry == name for entry in self.names])

    def __add__(self, other):
        return Constants(
            self.names + other.names,
            np.append(self.mean, other.mean),
            np.append(self.deviation, other.deviation),
        )


def constants(name, mean, deviation):
    """One kind of constant, as many as there are means."""
    mean = np.atleast_1d(np.asarray(mean, dtype=float))
    return Constants((name,) * mean.size, mean, np.broadcast_to(deviation, mean.shape).astype(float))


@dataclasses.dataclass(frozen=True)
class Information:
    """Half the sum of squares, its gradient, and its Gauss-Newton matrix."""

    value: float
    state_gradient: np.ndarray  # (n, 4)
    state_matrix: np.ndarray  # (n, 4, 4)
    border: np.ndarray  # (n, 4, p)
    corner: np.ndarray  # (p, p)
    constant_gradient: np.ndarray  # (p,)

    @classmethod
    def none(cls, count, size):
        """That of no data, of n states and p constants."""
        shapes = (count, SIZE), (count, SIZE, SIZE), (count, SIZE, size), (size, size), size
        return cls(0.0, *map(np.zeros, shapes))

    def __add__(self, other):
        return Information(*map(operator.add, vars(self).values(), vars(other).values()))


@dataclasses.dataclass(frozen=True)
class PyrometerData:
    r"""Signals of C bands, on the time axis of the chain.

    .. math:: S_i = e^{\pm r(t)/2}\left[e^{\ln\varepsilon + \phi_i\cdot a - g_i\delta + n_i + D_i(T)\cdot d}
              \,S_i^{bb}(T) + G_i\,(1 + p_i) + (m + f)\,G_i^0\right]

    with the course a of the emissivity (`shape`; none: grey, or as stated), the source's error delta [K], the
    gain's own error n_i, the errors d of the stated responses (`errors`: their place, how they err over
    wavelength, their linearity), the gas signal G_i, and p_i only before injection: without the sample the
    gas may have another colour. Of two bands the ratio of the gains wanders by r (`parting`). How the gas
    changes, m, and flickers, f, is times a first guess of it: times the gas that is fitted, more gas would
    change and flicker more, and explain what else does (a beam that moves, a gain), at the cost of 20 K.
    """

    signal: np.ndarray  # (C, n), NaN where missing or not to be used
    noise: np.ndarray  # (C, n)
    injected: np.ndarray  # (n,) bool
    shining: np.ndarray  # (n,) bool, gas in view
    table: GreyTable
    source_slope: np.ndarray  # (C,) [K-1] g_i
    errors: dict  # `ResponseErrors` by the name of their constants
    first_gas: np.ndarray  # (C,) its signal as first guessed
    name: str = "pyrometer"
    shape: np.ndarray | None = None  # (C, K) change of ln(emissivity) per unit of its course
    longest: int = 1  # band of the longest waves
    drift: np.ndarray | None = None  # (n, K) ramps of the level of the surface's light; none: it stays
    parting: np.ndarray | None = None  # (n, K) modes by which the ratio of two bands wanders; none: it stays

    def leverages(self, path):
        """D_i(T) (n, C, K) and its slope by the temperature, by the name of the constants."""
        return {name: one(path[:, TEMPERATURE]) for name, one in self.errors.items()}

    def predict(self, path, values, of):
        """Surface (C, n) and gas (C, n) parts, and the derivative of the surface by the temperature."""
        body, slope, _ = self.table(path[:, TEMPERATURE])
        gain = np.exp(
            values[of("log_emittance")]
            - self.source_slope * values[of("source_error")]
            + values[of("gain_error")]
            + course(values, of, self.shape)
            + values[of("band_level")].sum()
        )[:, None]
        gain, bend = np.broadcast_to(gain, self.signal.shape), 0.0
        for name, (leverage, by_temperature) in self.leverages(path).items():
            gain = gain * np.exp(leverage @ values[of(name)]).T
            bend = bend + (by_temperature @ values[of(name)]).T
        if of("band_drift").size:
            gain = gain * np.exp(self.drift @ values[of("band_drift")])
        seen = gain * self.injected
        gas = values[of("gas_signal")][:, None] * np.where(
            self.injected, 1.0, 1 + values[of("gas_signal_before")][:, None]
        )
        parted = self._parted(values, of)
        gas, seen = (gas * self.shining + self._changing(path)) * parted, seen * parted
        return seen * body.T, gas, seen * (slope.T + bend * body.T)

    def _parted(self, values, of):
        """Factor (C, n) of the bands by the wandering of their ratio; 1 without."""
        if self.parting is None:
            return 1.0
        return np.exp(np.outer(PARTED, self.parting @ values[of("ratio_wander")]))

    def _changing(self, path):
        """Signal (C, n) that the gas has more than right after injection."""
        return self.first_gas[:, None] * self.shining * (path[:, GAS] + path[:, FLICKER])

    def residual(self, path, values, of):
        """Whitened residuals (C, n), NaN where there is no sample."""
        surface, gas, _ = self.predict(path, values, of)
        return (self.signal - surface - gas) / self.noise

    def _by_state(self, values, of, slope):
        """Derivative (C, n, 4) of the whitened prediction by the states."""
        rows = np.zeros((*slope.shape, SIZE))
        rows[..., TEMPERATURE] = slope
        by_gas = self.first_gas[:, None] * self.shining * self._parted(values, of)
        rows[..., GAS] = rows[..., FLICKER] = by_gas
        return rows / self.noise[..., None]

    def state_matrix(self, path, values, of):
        """Gauss-Newton matrix (n, 4, 4) of the states alone, as in `information`."""
        surface, gas, slope = self.predict(path, values, of)
        weight = robust_weight((self.signal - surface - gas) / self.noise)
        rows = self._by_state(values, of, slope)
        return np.einsum("bn,bni,bnj->nij", weight, rows, rows)

    def _by_constants(self, band, path, surface, gas, values, of, leverages):
        """Derivatives (n,) of the prediction of a band by the constants it depends on, by their place."""
        steady = gas - self._changing(path) * self._parted(values, of)
        before = 1 + values[of("gas_signal_before")[band]]
        found = {
            of("log_emittance")[0]: surface[band],
            of("source_error")[0]: -self.source_slope[band] * surface[band],
            of("gain_error")[band]: surface[band],
            of("gas_signal")[band]: steady[band] / values[of("gas_signal")[band]],
            of("gas_signal_before")[band]: np.where(~self.injected, steady[band] / before, 0.0),
        }
        for name, (leverage, _) in leverages.items():
            own = leverage[:, band].T * surface[band]
            found |= {at: row for at, row in zip(of(name), own, strict=True) if row.any()}
        found |= {at: self.shape[band, k] * surface[band] for k, at in enumerate(of("emissivity_shape"))}
        found |= {at: self.drift[:, k] * surface[band] for k, at in enumerate(of("band_drift"))}
        if self.parting is not None:
            both = PARTED[band] * (surface[band] + gas[band])
            found |= {at: self.parting[:, k] * both for k, at in enumerate(of("ratio_wander"))}
        return found | {at: surface[band] for at in of("band_level")}

    def of_sample(self, path, values, of):
        """Whitened Jacobian (C, 4 + p) by states and constants of a single sample, and its residuals (C,)."""
        surface, gas, slope = self.predict(path, values, of)
        leverages = self.leverages(path)
        rows = np.zeros((len(gas), SIZE + len(values)))
        rows[:, :SIZE] = self._by_state(values, of, slope)[:, 0]
        for band, row in enumerate(rows):
            for place, column in self._by_constants(band, path, surface, gas, values, of, leverages).items():
                row[SIZE + place] = column[0] / self.noise[band, 0]
        return rows, ((self.signal - surface - gas) / self.noise)[:, 0]

    def information(self, path, values, of):
        surface, gas, slope = self.predict(path, values, of)
        residual = (self.signal - surface - gas) / self.noise
        weight = robust_weight(residual)
        result = Information.none(len(path), len(values))
        leverages, states = self.leverages(path), self._by_state(values, of, slope)
        for band, by_state in enumerate(states):
            w, r = weight[band], np.nan_to_num(residual[band])
            columns = self._by_constants(band, path, surface, gas, values, of, leverages)
            where = list(columns)
            by_constant = np.stack(list(columns.values()), axis=1) / self.noise[band][:, None]
            weighted = w[:, None] * by_state
            result.state_matrix[:] += weighted[:, :, None] * by_state[:, None, :]
            result.state_gradient[:] -= weighted * r[:, None]
            result.border[:, :, where] += weighted[:, :, None] * by_constant[:, None, :]
            result.corner[np.ix_(where, where)] += inner(by_constant, w[:, None] * by_constant)
            result.constant_gradient[where] -= inner(by_constant, (w * r)[:, None])[:, 0]
        return dataclasses.replace(result, value=robust_sum(residual))


def course(values, of, shape, name="emissivity_shape"):
    """Change (C,) of ln(emissivity) in channels by its course over wavelength, or by another one of a `name`;
    0 without one."""
    return 0.0 if shape is None else shape @ values[of(name)]


def _less(rows, common):
    """Whitened rows (S, C, ...), with what their channels share (S, C), in standard deviations, taken out.

    A root of the inverse of 1 + c c': 1 - s c c', s = (1 - (1 + |c|^2)^(-1/2))/|c|^2.
    """
    power = np.sum(common**2, axis=1)
    share = np.where(power > 0, (1 - 1 / np.sqrt(1 + power)) / np.maximum(power, 1e-300), 0.0)
    along = np.einsum("sc,sc...->s...", common, rows)
    return rows - np.einsum("s,sc,s...->sc...", share, common, along)


@dataclasses.dataclass(frozen=True)
class SpectrometerData:
    r"""Radiances of the bins, or signals of the bands, of an instrument with its own clock.

    .. math:: L_c = e^{d(t)}\left[e^{\ln\varepsilon + \phi_c\cdot a - w_c\delta + s + \sigma_c\cdot b + r_c}
              \,\bar B_c(T) + (1 + m)\,l_c\,(1 + p_c)\right],
              \qquad w_c = \frac{c_2}{\lambda_c T_s^2}

    s is the error of the scale, b that of its course over wavelength (`instrument.scale`), r_c that of a bin,
    d how the scale drifts from the injection on (`ramps`).
    The flicker within an exposure is common to all its bins, and so is how a beam that moves dims it: their
    variances times the outer products of the gas spectrum and of all light stand in their covariance. The
    mean over an exposure follows temperature and rate at its sample, and how the path bends away from them
    (`bent`), which an iteration holds.
    """

    place: np.ndarray  # (S,) sample nearest to the middle of the exposure
    offset: np.ndarray  # (S,) [s] middle of the exposure less that sample
    exposure: float  # [s]
    radiance: np.ndarray  # (S, C) NaN where not to be used
    noise: np.ndarray  # (S, C)
    injected: np.ndarray  # (S,) bool
    shining: np.ndarray  # (S,) bool
    table: GreyTable
    source_slope: np.ndarray  # (C,) [K-1] w_c
    flicker: float  # [1] standard deviation of the mean over an exposure
    name: str = "spectrometer"
    tag: str = ""  # before the names of its own constants
    source: str = "source_error"  # constant that is the error of its source
    shape: np.ndarray | None = None  # (C, K) as that of `PyrometerData`
    away: np.ndarray | float = 0.0  # (S, nodes) temperature less that of its straight line, see `bent`
    drift: np.ndarray | None = None  # (S, K) ramps of the scale; none: it stays
    scale: np.ndarray | None = None  # (C, m) sigma_c, modes of its course; none: it has no such error
    jitter: float = 0.0  # [1] standard deviation of all light from exposure to exposure

    def moments(self):
        """Times (S, nodes) [s] of the nodes of each exposure, from its sample on."""
        return self.offset[:, None] + self.exposure / 2 * NODES

    def bent(self, time, path, switches):
        """The same with the path (n, 4) at times (n,) as the one that exposures see between its samples."""
        line = path[self.place, TEMPERATURE, None] + self.moments() * path[self.place, RATE, None]
        seen = between(time, path, time[self.place, None] + self.moments(), switches)
        return dataclasses.replace(self, away=seen - line)

    def predict(self, path, values, of):
        """Surface (S, C) and gas (S, C) parts, and the surface's derivatives by temperature and rate."""
        state, moments = path[self.place], self.moments()
        temperature = state[:, TEMPERATURE, None] + moments * state[:, RATE, None] + self.away
        found = self.table(np.clip(temperature, *self.table.temperatures).ravel())
        body, slope = (one.reshape(*moments.shape, -1) for one in found[:2])
        mean = WEIGHTS / WEIGHTS.sum()
        by_rate = np.einsum("q,sq,sqc->sc", mean, moments, slope)
        body, slope = (np.einsum("q,sqc->sc", mean, one) for one in (body, slope))
        gain = np.exp(
            values[of("log_emittance")]
            - self.source_slope * values[of(self.source)]
            + values[of(self.tag + "scale_error")]
            + values[of(self.tag + "bin_error")]
            + course(values, of, self.shape)
            + course(values, of, self.scale, "scale_course")
        )
        seen = gain * self.injected[:, None]
        gas = values[of(self.tag + "gas_radiance")] * np.where(
            self.injected[:, None], 1.0, 1 + values[of(self.tag + "gas_radiance_before")]
        )
        drifted = 1.0 if self.drift is None else np.exp(self.drift @ values[of(self.tag + "scale_drift")])
        seen = seen * np.reshape(drifted, (-1, 1))
        amplitude = (np.where(self.shining, 1 + state[:, GAS], 0.0) * drifted)[:, None]
        return seen * body, gas * amplitude, seen * slope, seen * by_rate

    def _whitened(self, gas, rows):
        """Rows (S, C, ...) over the noise, with what all bins of an exposure share taken out."""
        good = np.isfinite(self.radiance)
        weight = np.where(good, 1 / self.noise, 0.0)
        rows = np.nan_to_num(rows) * weight.reshape(*weight.shape, *(1,) * (rows.ndim - 2))
        flickering = self.flicker * gas * weight
        dimmed = self.jitter * np.nan_to_num(self.radiance) * weight
        return _less(_less(rows, flickering), _less(dimmed, flickering))

    def residual(self, path, values, of):
        """Whitened residuals (S, C), NaN where there is no sample."""
        surface, gas, *_ = self.predict(path, values, of)
        return np.where(np.isfinite(self.radiance), self._weighed(surface, gas)[0], np.nan)

    def _weighed(self, surface, gas):
        """Whitened residuals (S, C), 0 where there is no sample, and their robust weights (S, C)."""
        white = self._whitened(gas, np.nan_to_num(self.radiance) - surface - gas)
        return white, np.where(np.isfinite(self.radiance), robust_weight(white), 0.0)

    def _by_state(self, path, gas, slopes):
        """Derivative (S, C, 4) of the prediction by the states."""
        rows = np.zeros((*gas.shape, SIZE))
        rows[:, :, TEMPERATURE], rows[:, :, RATE] = slopes
        rows[:, :, GAS] = gas / _brightness(path[self.place])[:, None]
        return rows

    def state_matrix(self, path, values, of):
        """Gauss-Newton matrix (n, 4, 4) of the states alone, as in `information`."""
        surface, gas, *slopes = self.predict(path, values, of)
        _, weight = self._weighed(surface, gas)
        rows = self._whitened(gas, self._by_state(path, gas, slopes))
        result = np.zeros((len(path), SIZE, SIZE))
        np.add.at(result, self.place, np.matmul(np.swapaxes(rows * weight[:, :, None], 1, 2), rows))
        return result

    def information(self, path, values, of):
        surface, gas, *slopes = self.predict(path, values, of)
        frames, bins = surface.shape
        size = len(values)
        residual, weight = self._weighed(surface, gas)
        jacobian = np.zeros((frames, bins, SIZE + size))
        jacobian[:, :, :SIZE] = self._by_state(path, gas, slopes)
        jacobian[:, :, SIZE + of("log_emittance")[0]] = surface
        jacobian[:, :, SIZE + of(self.tag + "scale_error")[0]] = surface
        jacobian[:, :, SIZE + of(self.source)[0]] = -self.source_slope * surface
        level, before = (values[of(self.tag + one)] for one in ("gas_radiance", "gas_radiance_before"))
        for k, at in enumerate(of("emissivity_shape")):
            jacobian[:, :, SIZE + at] = self.shape[:, k] * surface
        for k, at in enumerate(() if self.scale is None else of("scale_course")):
            jacobian[:, :, SIZE + at] = self.scale[:, k] * surface
        for k, at in enumerate(of(self.tag + "scale_drift")):
            jacobian[:, :, SIZE + at] = self.drift[:, k, None] * (surface + gas)
        own = np.arange(bins)
        jacobian[:, own, SIZE + of(self.tag + "bin_error")] = surface
        jacobian[:, own, SIZE + of(self.tag + "gas_radiance")] = gas / level
        jacobian[:, own, SIZE + of(self.tag + "gas_radiance_before")] = np.where(
            self.injected[:, None], 0.0, gas / (1 + before)
        )
        jacobian = self._whitened(gas, jacobian)
        weighted = jacobian * weight[:, :, None]
        result = Information.none(len(path), size)
        part = weighted[:, :, :SIZE]
        np.add.at(result.state_matrix, self.place, np.einsum("sci,scj->sij", part, jacobian[:, :, :SIZE]))
        np.add.at(result.state_gradient, self.place, -np.einsum("sci,sc->si", part, residual))
        by_constant = jacobian[:, :, SIZE:].reshape(frames * bins, size)
        cross = np.matmul(np.swapaxes(part, 1, 2), jacobian[:, :, SIZE:])
        np.add.at(result.border, self.place, cross)
        flat = weighted[:, :, SIZE:].reshape(frames * bins, size)
        result.corner[:] = inner(flat, by_constant)
        result.constant_gradient[:] = -inner(flat, residual.reshape(-1, 1))[:, 0]
        return dataclasses.replace(
            result, value=robust_sum(np.where(np.isfinite(self.radiance), residual, np.nan))
        )


def _brightness(path):
    """1 + m (n,) of the gas, and not 0."""
    amplitude = 1 + path[:, GAS]
    return np.where(np.abs(amplitude) > TINY, amplitude, TINY)


def between(time, path, moments, switches):
    """Temperatures at any moments on a path (n, 4): cubic between samples, straight up to a switch.

    Parameters
    ----------
    time : (n,) array [s]
    path : (n, 4) array
    moments : array [s], within the times
    switches : floats [s]
        Moments when the heat, and so the rate, jumps.

    Returns
    -------
    ndarray like `moments` [K]
    """
    after = np.clip(np.searchsorted(time, moments), 1, time.size - 1)
    before = after - 1
    step = time[after] - time[before]
    x, (first, last) = (moments - time[before]) / step, (path[before], path[after])
    bend = x * (1 - x) * step
    rise = (last[..., TEMPERATURE] - first[..., TEMPERATURE]) / step
    whole = first[..., TEMPERATURE] + x * step * rise
    whole = whole + bend * ((1 - x) * (first[..., RATE] - rise) - x * (last[..., RATE] - rise))
    for moment in switches:
        apart = (time[before] < moment) & (moment <= time[after])
        near = np.where(moments < moment, before, after)
        straight = path[near, TEMPERATURE] + (moments - time[near]) * path[near, RATE]
        whole = np.where(apart, straight, whole)
    return whole


def robust_weight(residual):
    """Weight of each whitened residual in Huber's sense; 0 for NaN.

    Notes
    -----
    Source: Huber, Ann. Math. Stat. 35, 73 (1964).
    """
    size = np.abs(residual)
    with np.errstate(invalid="ignore"):
        return np.where(np.isfinite(size), HUBER / np.maximum(size, HUBER), 0.0)


def robust_sum(residual):
    """Half the sum of squares, growing only linearly beyond `HUBER`."""
    size = np.abs(residual[np.isfinite(residual)])
    return float(np.sum(np.where(size <= HUBER, 0.5 * size**2, HUBER * (size - HUBER / 2))))
