"""How large an effect is in standard deviations of the data, and how alike two effects are."""

import dataclasses
from functools import cached_property, lru_cache

import numpy as np
from scipy import sparse
from scipy.special import erf
from twin import campaign, hidden, light, sensors
from twin.light import planck
from twin.sensors import Pyrometer
from worlds.case import PRESSURE
from worlds.engine import CENTRES, COMPONENTS, SCATTER, World
from worlds.measure import CLOCKS, FAINT, SCALE, slit_error, within_stated

from blind.bench import EMITTANCE_ERROR, LINE_ERROR, LINES, POWER_ERROR, SYSTEM_ERROR, apply

FLICKER = 0.012  # of the brightness, from frame to frame
GAIN_ERROR, BAND_ERROR, BRIGHTNESS_ERROR = 0.03, 0.01, 0.3
# Gains wander linearly between knots; the scale of the spectrometer errs by waves of half periods 1 to 8.
WANDER, WANDER_KNOTS, SMOOTH, WAVES = (2e-3, 1e-3, 3e-3), 8, 0.005, 8
RESPONSES = (("edge1", 1.0), ("edge2", 1.0), ("resp_long", 0.02))  # nm, nm, 1: tolerances of what is stated
FREE = 0.3  # of the light of the gas in every pixel and band, before and after injection apart
STEADY = ("P_eff", "ripple", "T_exc", "T_vib", "selfabs", "contin", "Cu", "Ar", "wshift", "lsf", "second")
# Surface temperature is free at these times [s] and linear between them: dense where it changes fast, and
# every 8 s later. ASSUME: no analysis may take a steadier surface for granted. 0.04 K in a swing of 37 s, by
# a heat flux that varies by 1.4e-4, look like 2.3e-4 of a gain, 12 standard deviations of the spectra.
KNOTS = np.concatenate(
    [
        [0, 1, 2, 3, 4.5, 6, 8, 10, 13, 16, 20, 25, 31, 38],
        np.arange(46.0, 295.0, 8.0),
        [300, 302, 305, 309, 314, 321, 330.0],
    ]
)

SYSTEMS = ("N I", "O I", "N2 1P", "N2+ Meinel", "NO 11000 A")  # each with a strength of its own
# What a simulation must state, as the second laboratory has it from published sets: at least what nulls draw.
SYSTEM_SIZES = {name: max(SYSTEM_ERROR, SCATTER.get(name, 0.0)) for name in (*SYSTEMS, "continuum")}
LINE_SIZE = max(LINE_ERROR, SCATTER["multiplet"])
GAS_ROWS = 1 + len(SYSTEMS) + 1 + len(LINES)  # power, systems, all others, multiplets: last in the nuisance
LINEAR = 1.0  # standard deviations of a strength up to which its tangent serves
STEPS = 12


def _no_glow(instrument, wavelength, temperature, time):
    """A surface that does not shine."""
    return 0.0


@lru_cache(maxsize=8)
def slit(device):
    """Edges of bins (B+1,) [m] and the matrix (W, B) from their means to the pixels of a spectrometer."""
    edges, _ = light.bins(device.first - 4e-9, device.last + 4e-9, 0.02e-9)
    sigma = device.fwhm / np.sqrt(8 * np.log(2))
    place = np.searchsorted(edges, device.wavelength)
    reach = int(np.ceil(6 * sigma / (edges[1] - edges[0]))) + 1
    near = place[:, None] + np.arange(-reach, reach + 1)
    weight = np.diff(erf((edges[near] - device.wavelength[:, None]) / (np.sqrt(2) * sigma)))
    weight /= weight.sum(axis=1, keepdims=True)
    rows = np.repeat(np.arange(place.size), weight.shape[1])
    shape = (place.size, edges.size - 1)
    return edges, sparse.csr_array((weight.ravel(), (rows, near[:, :-1].ravel())), shape=shape)


class Metric:
    r"""Whitened data of one base, with what any analysis must leave free projected out.

    Free are: the temperature (piecewise linear through `KNOTS`), emittance, gain of each band and of the
    spectrometer and their wandering, the shape of its scale, brightness of the gas before and after injection
    and in each frame, its power and the strengths of its systems, multiplets, bands and continua, the
    wavelengths and slit of the spectrometer, all but the first with their prior uncertainty. For all but
    `STEADY` effects, which are a spectrum of the gas and nothing else, the gas is free in every pixel and
    band as well:

    .. math:: G = e^T (I - N (N^T N + 1)^{-1} N^T) e

    with whitened signatures e and N (scaled by the prior). The SNR of an effect is :math:`\sqrt{G}`.
    Where an effect calls for another strength of the gas than `LINEAR` standard deviations, the strengths
    act as the factors that they are: a doubled line is not sixteen steps of 6 % but nine of them in a row.
    """

    def __init__(self, bench, base, power_prior=POWER_ERROR, *, free=False):
        self.bench, self.base, self.gas, self.free = bench, base, bench.gas(base), free
        self.scene = bench.scene(base)
        # Flicker is kept, so that base and changed scene differ by the effect alone.
        self.reference = bench.clean(self.scene, self.gas, base)
        signals, rate = self.reference
        pyrometer = Pyrometer()
        self.exposure = self.scene.spectrometer_integration_time
        variance = sensors.counts_variance(self.scene.spectrometer, rate, self.exposure)
        self.sigma = (
            np.hypot(pyrometer.reading_noise * signals, pyrometer.floor_noise),
            np.sqrt(variance) / self.exposure,
        )
        self.time = np.round(
            np.arange(self.scene.start, self.scene.end + 1e-9, self.scene.pyrometer_period), 9
        )
        self.frames = campaign.exposures(
            self.scene, np.arange(self.scene.start, self.scene.end + campaign.TICK / 2, campaign.TICK)
        )[0]
        # The moments around injection and shut-down are for no analysis.
        self.usable = [
            ~((time > -1.5) & (time < 0.3)) & ~((time > 299.3) & (time < 301.0))
            for time in (self.time, self.frames)
        ]
        self.power_prior, self._shares = power_prior, {}
        self.nuisance = self._nuisance(power_prior)
        self.inner = np.linalg.cholesky(self.nuisance @ self.nuisance.T + np.eye(len(self.nuisance)))

    def whiten(self, output):
        """One vector of the difference of an output from the reference, in standard deviations."""
        parts = [
            (new - old) / sigma for new, old, sigma in zip(output, self.reference, self.sigma, strict=True)
        ]
        return self._flat(parts)

    def _flat(self, parts):
        """Vector of the usable data with flicker and the fixed patterns of the pixels taken out."""
        signals, rates = parts[0][:, self.usable[0]], parts[1][self.usable[1]]
        signals, rates = self._deflicker(signals, 0), self._without_pattern(self._deflicker(rates, 1))
        if self.free:
            signals, rates = self._without_gas(signals, 0), self._without_gas(rates, 1)
        return np.concatenate([signals.ravel(), rates.ravel()])

    def _without_pattern(self, rates):
        """Take out what the noise of lamp and dark scans, the same in all frames (S, W), can explain."""
        columns, inner = self._patterns
        share = inner @ (columns @ rates.T[:, :, None])
        return rates - (columns.transpose(0, 2, 1) @ share)[:, :, 0].T

    @cached_property
    def _patterns(self):
        """Columns (W, 2, S) scaled by their prior, and the core (W, 2, 2) of the root of the projector."""
        device, source = self.scene.spectrometer, campaign.Source()
        lamp = device.rate_per_radiance(planck) * planck(device.wavelength, source.spectrometer_temperature)
        exposure = source.spectrometer_integration_time
        noise = sum(sensors.counts_variance(device, rate, exposure) for rate in (lamp, 0.0 * lamp))
        relative = np.sqrt(noise / source.scans) / (lamp * exposure)
        dark = sensors.counts_variance(device, 0.0 * lamp, self.exposure) / campaign.DARK_SCANS
        rate, sigma = self.reference[1][self.usable[1]], self.sigma[1][self.usable[1]]
        columns = np.stack([rate * relative, np.sqrt(dark) / self.exposure * np.ones_like(rate)])
        columns = np.ascontiguousarray((columns / sigma).transpose(2, 0, 1))
        value, vector = np.linalg.eigh(columns @ columns.transpose(0, 2, 1))
        value = np.maximum(value, 1e-12)
        shrink = (1 - 1 / np.sqrt(1 + value)) / value
        return columns, np.einsum("wik,wk,wjk->wij", vector, shrink, vector)

    @cached_property
    def thermometer(self):
        """The metric with a free gas."""
        return self if self.free else Metric(self.bench, self.base, self.power_prior, free=True)

    def _for(self, *effects):
        """The metric that tells of all of some effects."""
        return self if set(effects) <= set(STEADY) else self.thermometer

    def signature(self, effects):
        """Whitened signature of effects with the base parameters projected out, and its size."""
        return self._for(*(one["effect"] for one in effects))._signature(effects)

    def _signature(self, effects):
        scene = apply(self.scene, self.gas, effects)
        change = self.whiten(self.bench.clean(scene, self.gas, self.base))
        vector = self.project(change)
        if np.abs(vector[-GAS_ROWS:]).max() > LINEAR:
            name = tuple(one["effect"] for one in effects)
            start = self._shares.get(name)
            if start is None:
                start = np.clip(vector[-len(self.nuisance) :], -LINEAR, LINEAR)
            vector = self._beyond_tangents(change, start)
            self._shares[name] = vector[-len(self.nuisance) :]
        if not self.free:
            vector = within_stated(vector, effects, self.scene.spectrometer.fwhm)
        return vector, float(np.sqrt(vector @ vector))

    def _beyond_tangents(self, change, share):
        """As `project`, the strengths of the gas as factors: Gauss-Newton steps from the linear estimate."""
        fixed = self.nuisance[:-GAS_ROWS]
        unmoved = fixed @ fixed.T
        lit, strength = self._of_gas(self.gas.radiance), self._strengths(self.gas.radiance)

        def row(radiance, plain):
            factors = [n / s for n, s in zip(self._strengths(radiance - plain), strength, strict=True)]
            return self._flat([lit[0] * factors[0][:, None], lit[1] * factors[1]])

        def left(share):
            gas = self._gas_at(share[-GAS_ROWS:])
            rest = change - share[:-GAS_ROWS] @ fixed - row(gas.radiance, self.gas.radiance)
            return gas, np.concatenate([rest, share])

        gas, best = left(share)
        for _ in range(STEPS):
            rows = [row(more, gas.radiance) for more in self._gas_changes(self.power_prior, share, gas)]
            rows = np.array(rows)
            cross = rows @ fixed.T
            normal = np.block([[unmoved, cross.T], [cross, rows @ rows.T]]) + np.eye(len(share))
            rest = best[: -len(share)]
            step = np.linalg.solve(normal, np.concatenate([fixed @ rest, rows @ rest]) - share)
            for shorter in (1.0, 0.5, 0.25, 0.1):
                other, trial = left(share + shorter * step)
                if trial @ trial < best @ best:
                    break
            else:
                return best
            gained = best @ best - trial @ trial
            share, gas, best = share + shorter * step, other, trial
            if gained < 0.01 * (best @ best):
                break
        return best

    def _gas_at(self, share):
        """The gas with strengths off by some standard deviations (GAS_ROWS,), in the order of `_nuisance`."""
        power, systems, lines = share[0], share[1 : 1 + len(SYSTEMS) + 1], share[-len(LINES) :]
        base = self.base
        strengths = dict(base.strengths)
        for name, more in zip((*SYSTEMS, "continuum"), systems, strict=True):
            strengths[name] += SYSTEM_SIZES[name] * more
        for name, more in zip(LINES, lines, strict=True):
            strengths[name] += LINE_SIZE * more
        low, high = self.bench.spectra.power[[0, -1]]
        power = float(np.clip(base.power * np.exp(self.power_prior * power), low * 1.04, high / 1.04))
        return self.bench.gas(dataclasses.replace(base, power=power, strengths=strengths))

    def angle(self, one, other, known=None):
        """Degrees between the signatures of two effects; 90 if one is unknown to the twin.

        `known` holds amplitude and shape of the effects that are in the data.
        """
        lengths = []
        for effect in (one, other):
            if effect not in hidden.EFFECTS:
                return 90.0
            plain = {"effect": effect, "amplitude": 0.2 * hidden.EFFECTS[effect].unit}
            lengths.append(self._for(one, other)._signature([(known or {}).get(effect, plain)]))
        (a, size_a), (b, size_b) = lengths
        if size_a == 0 or size_b == 0:
            return 90.0
        return float(np.degrees(np.arccos(np.clip(abs(a @ b) / (size_a * size_b), 0, 1))))

    def project(self, vector):
        """(I - N (N^T N + 1)^-1 N^T)^(1/2) applied to a vector: lengths are sqrt(G)."""
        # The square root of the projector is realised by appending the pull of the priors.
        share = np.linalg.solve(self.inner.T, np.linalg.solve(self.inner, self.nuisance @ vector))
        return np.concatenate([vector - share @ self.nuisance, share])

    def _deflicker(self, block, axis):
        """Take out, frame by frame, what a brightness of the gas unknown to 1.2 % can explain.

        block is (2, t) for the signals (axis 0 is the band) or (S, W) for the spectra (axis 1 the pixels).
        """
        return _without(block, self._gas_pattern[axis], FLICKER, axis)

    def _without_gas(self, block, which):
        """Take out, pixel by pixel or in each band, what a gas unknown to `FREE` can explain."""
        time, axis = (self.time, self.frames)[which][self.usable[which]], 1 - which
        early = (time < 0) if axis else (time < 0)[:, None]
        pattern = self._gas_pattern[which]
        return _without(_without(block, pattern * early, FREE, axis), pattern * ~early, FREE, axis)

    @cached_property
    def _gas_light(self):
        """Whitened light of the gas alone, without flicker: (2, t) and (S, W)."""
        return self._of_gas(self.gas.radiance, flicker=0.0)

    @cached_property
    def _gas_pattern(self):
        return self._gas_light[0][:, self.usable[0]], self._gas_light[1][self.usable[1]]

    def _strengths(self, radiance):
        """Light of a gas (C, B) in the bands (2,) and in the pixels (W,), in units of its own."""
        total, device, nodes = (
            radiance.sum(axis=0),
            self.scene.spectrometer,
            self.bench.response.wavelength.values,
        )
        bands = []
        for name in ("responsivity_wide", "responsivity_narrow"):
            edges, _, weight = light.band(nodes, self.bench.response[name].values)
            bands.append(light.bin_mean(self.gas.centres, total, edges) @ weight)
        edges, matrix = slit(device)
        return np.array(bands), matrix @ light.bin_mean(self.gas.centres, total, edges)

    def _of_gas(self, radiance, **plasma):
        """Whitened output for some light of the gas (C, B) and none of the surface."""
        dark = dataclasses.replace(
            self.scene, glow=_no_glow, plasma=dataclasses.replace(self.scene.plasma, **plasma)
        )
        gas = dataclasses.replace(self.gas, radiance=radiance)
        output = self.bench.clean(dark, gas, self.base)
        return [one / sigma for one, sigma in zip(output, self.sigma, strict=True)]

    def _nuisance(self, power_prior):
        rows = []
        both = (self.time, self.frames)
        gas_part = self._gas_light
        warm = self.bench.clean(self.scene, self.gas, self.base, warmer=1.0)
        slope = [(a - b) / s for a, b, s in zip(warm, self.reference, self.sigma, strict=True)]
        for basis in self._hats():
            rows.append([slope[0] * basis[0] * 1e3, slope[1] * basis[1][:, None] * 1e3])
        whole = [a / s for a, s in zip(self.reference, self.sigma, strict=True)]
        surface = [w - g for w, g in zip(whole, gas_part, strict=True)]
        none = [np.zeros_like(part) for part in whole]
        rows.append([EMITTANCE_ERROR * part for part in surface])
        for band in (0, 1):
            only = np.zeros((2, 1))
            only[band] = 1.0
            rows.append([BAND_ERROR * whole[0] * only, none[1]])
        rows.append([GAIN_ERROR * whole[0], none[1]])
        rows.append([none[0], GAIN_ERROR * whole[1]])
        # The bias of the blackbody source, at most 3 K at 1773 K, is common to both instruments.
        pixels = self.scene.spectrometer.wavelength
        rows.append(
            [
                0.3 * 0.01 * whole[0] * np.array([[1.0], [0.93]]),
                1.7 * 1.438776877e-2 / (pixels * 1773.0**2) * whole[1],
            ]
        )
        late = CLOCKS * np.gradient(self.reference[0], self.time, axis=1)
        rows.append([late / self.sigma[0], none[1]])
        rows += self._persistent(whole)
        for effect, size in RESPONSES:
            seen = apply(self.scene, self.gas, [{"effect": effect, "amplitude": size}])
            changed = self.bench.clean(seen, self.gas, self.base)
            rows.append([(n - o) / s for n, o, s in zip(changed, self.reference, self.sigma, strict=True)])
        before = [np.where(time < 0, 1.0, 0.0) for time in both]
        for mask in (before, [1 - part for part in before]):
            rows.append(
                [BRIGHTNESS_ERROR * gas_part[0] * mask[0], BRIGHTNESS_ERROR * gas_part[1] * mask[1][:, None]]
            )
        # Light of the gas is its strength in a band or pixel times a history that all changes share.
        lit, strength = self._of_gas(self.gas.radiance), self._strengths(self.gas.radiance)
        changes = [one - self.gas.radiance for one in self._gas_changes(power_prior)]
        if not self.free:  # which has them in its free gas
            changes = [*self._local_changes(), *changes]
            rows += [[none[0], lit[1] * one] for one in self._of_scale()]
        for change in changes:
            factors = [n / s for n, s in zip(self._strengths(change), strength, strict=True)]
            rows.append([lit[0] * factors[0][:, None], lit[1] * factors[1]])
        return np.stack([self._flat(row) for row in rows])

    def _persistent(self, whole):
        """Rows of gains that wander and of a scale that is smoothly wrong over wavelength."""
        none, rows = [np.zeros_like(part) for part in whole], []
        places = np.linspace(self.scene.start, self.scene.end, WANDER_KNOTS)
        for hat in np.eye(WANDER_KNOTS):
            bands, frames = (np.interp(time, places, hat) for time in (self.time, self.frames))
            rows.append([WANDER[0] * whole[0] * bands, none[1]])
            rows.append([WANDER[1] * whole[0] * bands * np.array([[0.5], [-0.5]]), none[1]])
            rows.append([none[0], WANDER[2] * whole[1] * frames[:, None]])
        place = np.linspace(0, np.pi, whole[1].shape[1])
        return rows + [
            [none[0], SMOOTH / order * whole[1] * np.cos(order * place)] for order in range(1, WAVES + 1)
        ]

    def _hats(self):
        """Linear hats over the knots of temperature, at the readings and at the frames."""
        for hat in np.eye(KNOTS.size):
            yield [np.interp(time, KNOTS, hat) * (time >= 0) for time in (self.time, self.frames)]

    def _gas_changes(self, power_prior, share=None, gas=None):
        """Spectra by system (C, B) one prior standard deviation off, about some strengths of the gas."""
        gas = gas or self.gas
        power = self.base.power * np.exp(power_prior * (0.0 if share is None else share[-GAS_ROWS]))
        low, high = self.bench.spectra.power[[0, -1]]
        power = np.clip(power, low * 1.04, high / 1.04)
        up, down = (self.bench.spectra.at(power * np.exp(step)) for step in (0.03, -0.03))
        slope = np.log(np.maximum(up, 1e-30) / np.maximum(down, 1e-30)) / 0.06
        yield gas.radiance * np.exp(power_prior * slope)
        names = gas.systems
        for system in SYSTEMS:
            changed = gas.radiance.copy()
            changed[names.index(system)] *= 1 + SYSTEM_SIZES[system]
            yield changed
        others = [row for row, name in enumerate(names) if name not in self.base.strengths]
        changed = gas.radiance.copy()
        changed[others] *= 1 + SYSTEM_SIZES["continuum"]
        yield changed
        for system, first, last in LINES.values():
            inside = (gas.centres > first * 1e-9) & (gas.centres < last * 1e-9)
            changed = gas.radiance.copy()
            changed[names.index(system), inside] *= 1 + LINE_SIZE
            yield changed

    def _local_changes(self):
        """Changes of the light (C, B) of other multiplets than `LINES`, levels of bands, and continua."""
        gas = self.gas
        rest = gas.radiance.copy()
        for system, low, high in LINES.values():
            inside = (gas.centres > low * 1e-9) & (gas.centres < high * 1e-9)
            rest[gas.systems.index(system), inside] = 0.0
        known = [
            (gas.systems.index(COMPONENTS[place]), size, np.interp(gas.centres, CENTRES, share))
            for place, size, share in World(0).shares(float(np.max(gas.temperature)), PRESSURE)
            if COMPONENTS[place] in SYSTEMS
        ]
        others = [row for row, name in enumerate(gas.systems) if name not in self.base.strengths]
        for row, size, share in [*known, *((row, SCATTER["continuum"], 1.0) for row in others)]:
            change = np.zeros_like(rest)
            change[row] = size * rest[row] * share
            if change.sum() > size * FAINT * gas.radiance.sum():
                yield change

    def _of_scale(self):
        """Relative changes of the light in the pixels: scale moved, stretched, slit wider."""
        device, total = self.scene.spectrometer, self.gas.radiance.sum(axis=0)
        wider = device.fwhm + slit_error(device.fwhm)
        plain, *changed = (
            matrix @ light.bin_mean(self.gas.centres, total, edges)
            for edges, matrix in (
                slit(dataclasses.replace(device, **change))
                for change in (
                    {},
                    {"first": device.first + SCALE, "last": device.last + SCALE},
                    {"first": device.first - SCALE, "last": device.last + SCALE},
                    {"fwhm": wider},
                )
            )
        )
        return [one / plain - 1 for one in changed]


def _without(block, pattern, size, axis):
    """A block less what a multiple of a pattern along an axis, unknown to some size, can explain."""
    gain = (block * pattern).sum(axis=axis, keepdims=True)
    square, prior = (pattern**2).sum(axis=axis, keepdims=True), 1 / size**2
    # 1 - (1 - square/(square+prior))^(1/2): the square root of the projector for one column.
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(square > 0, (1 - np.sqrt(prior / (square + prior))) / square, 0.0)
    return block - pattern * gain * share
