"""What a pyrometer of one or more bands reads, and every error of it that a design can change."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from plasmapyro.constants import BOLTZMANN, ELEMENTARY_CHARGE, LIGHT_SPEED, PLANCK
from plasmapyro.radiation.planck import blackbody_radiance

SOURCES = ("gas", "noise", "emittance", "calibration", "window", "air")
TEMPERATURE_GRID = 1 / np.linspace(1 / 300.0, 1 / 10000.0, 240)  # [K], of the inversion, equal steps of 1/T
ROOM_TEMPERATURE = 300.0  # [K] of the detector
NO_READING = 1.0  # [1], error that counts for a reading off the curve


@dataclass(frozen=True)
class Uncertainties:
    """Stated errors of a pyrometer: `signal` [1] of each band's calibration, `source_temperature` [K] at
    `source_reference` [K], `emittance` [1] relative (for one band), slopes of the logarithms of emittance and
    window with wavelength [m-1], `air_path` [m]."""

    signal: float
    source_temperature: float
    source_reference: float
    emittance: float
    emittance_slope: float
    window_slope: float
    air_path: float


@dataclass(frozen=True)
class Receiver:
    """Etendue times optics [m2 sr], detector area [m2], bandwidth [Hz], noise of the amplifier [A Hz-1/2]."""

    throughput: float
    area: float
    bandwidth: float
    amplifier_noise: float


@dataclass(frozen=True)
class Currents:
    """Photocurrents of D designs with N bands: `black` (D, N, K) on `TEMPERATURE_GRID`, `gas` (D, N, C), mean
    wavelength (D, N) [m] and air loss (D, N) [1], and the detectors' noise current squared (D,) [A2 Hz-1]."""

    black: np.ndarray
    gas: np.ndarray
    wavelength: np.ndarray
    air: np.ndarray
    dark_noise: np.ndarray

    def split(self, size):
        """The same designs, `size` at a time."""
        for start in range(0, len(self.wavelength), size):
            yield self.rows(slice(start, start + size))

    def rows(self, part):
        """Some of the designs."""
        return Currents(*(values[part] for values in vars(self).values()))

    def pick(self, index):
        """Designs made of other designs' first bands: `index` (D, N) of rows."""
        return Currents(
            self.black[index, 0],
            self.gas[index, 0],
            self.wavelength[index, 0],
            self.air[index, 0],
            self.dark_noise[index[:, 0]],
        )


def currents(responses, edges, gas_radiance, receiver, resistance_area, air, reference_temperature):
    r"""Photocurrents of bands in front of black bodies and of the gas alone.

    .. math:: I = \frac{e}{hc}\, G \int \lambda\, \eta\, \tau\, L_\lambda\, d\lambda

    `responses` (D, N, B) [1]: quantum efficiency times filter, mean of each bin; `gas_radiance` (C, B) [W m-2
    sr-1 m-1]; `resistance_area` (D,) [ohm m2] of the detector at zero bias; `air` (B,) [1], absorbed between
    window and instrument; `reference_temperature` [K] weighs the mean wavelength and air.
    """
    middle, size = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    weight = responses * (ELEMENTARY_CHARGE / (PLANCK * LIGHT_SPEED) * receiver.throughput * middle * size)
    black, reference = _black_bodies(middle.tobytes(), reference_temperature)
    reference = weight * reference
    total = np.maximum(reference.sum(-1), np.finfo(float).tiny)
    rows = weight.reshape(-1, weight.shape[-1])  # one product of matrices, not one of rows for each design
    johnson = 4 * BOLTZMANN * ROOM_TEMPERATURE * receiver.area / np.asarray(resistance_area, dtype=float)
    return Currents(
        (rows @ black).reshape(*weight.shape[:-1], -1),
        (rows @ gas_radiance.T).reshape(*weight.shape[:-1], -1),
        (reference @ middle) / total,
        (reference @ air) / total,
        johnson + receiver.amplifier_noise**2,
    )


@lru_cache(maxsize=4)
def _black_bodies(middle, reference_temperature):
    """Radiance at the grid of temperatures (B, T) and at the reference (B,); `middle`: bytes of the bins."""
    middle = np.frombuffer(middle)
    return (
        blackbody_radiance(middle[:, None], TEMPERATURE_GRID),
        blackbody_radiance(middle, reference_temperature),
    )


def contrast(signal, uncertainties, gas_covariance, reference_temperature):
    r"""Weights c (D, N) of the logarithms of band signals: :math:`F = \sum_i c_i \ln I_i, \sum c_i = 0`.

    One band: 1. Two: the ratio, (1, -1). More: the combination of least variance under calibration, slopes
    and the gas, for a given sensitivity, :math:`c \propto C^{-1}(d - \bar d\,\mathbf 1)` with :math:`d_i =
    d\ln I_i/d\ln T`. `gas_covariance` (D, N, N) [1], of ln(1 + gas over surface).
    """
    designs, bands = signal.wavelength.shape
    if bands <= 2:
        return np.broadcast_to([1.0] if bands == 1 else [1.0, -1.0], (designs, bands))
    slopes = np.stack(
        [
            sensitivity(signal.black[:, [band]], np.ones((designs, 1)), reference_temperature)
            for band in range(bands)
        ],
        axis=1,
    )
    common = uncertainties.emittance_slope**2 + uncertainties.window_slope**2
    covariance = uncertainties.signal**2 * np.eye(bands)
    covariance = covariance + common * signal.wavelength[:, :, None] * signal.wavelength[:, None, :]
    inverse = np.linalg.inv(covariance + gas_covariance)
    ones = np.ones(bands)
    mean = np.einsum("dij,dj->d", inverse, slopes) / np.einsum("dij,i,j->d", inverse, ones, ones)
    weights = np.einsum("dij,dj->di", inverse, slopes - mean[:, None])
    return weights / np.abs(weights).max(axis=1, keepdims=True)


def sensitivity(black, weights, temperature):
    r""":math:`dF/d\ln T` at temperatures: (D,) or (D, T) [1] for a float or (T,) [K]; `weights` (D, N)."""
    slope = np.gradient(contrast_curve(black, weights), np.log(TEMPERATURE_GRID), axis=-1)
    low = np.clip(np.searchsorted(TEMPERATURE_GRID, temperature, "right") - 1, 0, TEMPERATURE_GRID.size - 2)
    rise = (slope[:, low + 1] - slope[:, low]) / (TEMPERATURE_GRID[low + 1] - TEMPERATURE_GRID[low])
    return rise * (temperature - TEMPERATURE_GRID[low]) + slope[:, low]


def contrast_curve(black, weights):
    """F of a black body (D, K)."""
    return np.einsum("dn,dnk->dk", weights, np.log(black))


def at_temperature(black, temperature):
    """Currents (D, N, T) at temperatures (T,) [K]; linear in ln I over 1/T, the grid is fine."""
    position = np.interp(
        -1 / np.asarray(temperature), -1 / TEMPERATURE_GRID, np.arange(TEMPERATURE_GRID.size)
    )
    low = np.minimum(position.astype(int), TEMPERATURE_GRID.size - 2)
    share = position - low
    logarithm = np.log(black)
    return np.exp(logarithm[..., low] * (1 - share) + logarithm[..., low + 1] * share)


def read(signal, weights, measured, emittance):
    """Temperature [K] of each design from its measured currents (D, N, ...); NaN off the curve.

    The emittance, which a single band needs, broadcasts to `measured` without bands. A curve that does not
    rise everywhere gives no reading at all.
    """
    curve = contrast_curve(signal.black, weights)
    direction = np.sign(curve[:, -1] - curve[:, 0])
    curve = curve * direction[:, None]
    value = np.einsum("dn,dn...->d...", weights, np.log(measured))
    if weights.shape[1] == 1:
        value = value - np.log(emittance)
    value = value * direction.reshape(-1, *[1] * (value.ndim - 1))
    inverse, grid = np.full(value.shape, np.nan), 1 / TEMPERATURE_GRID
    for design in np.flatnonzero((np.diff(curve) > 0).all(axis=1)):
        inverse[design] = np.interp(value[design], curve[design], grid, left=np.nan, right=np.nan)
    return 1 / inverse


def errors(signal, weights, gas, temperature, emittance, receiver, uncertainties):
    r"""Relative errors of temperature by source.

    .. math:: e_s = \frac{\sigma_s(F)}{|dF/d\ln T|}, \qquad e_{gas} = T_{app}/T - 1

    The gas is inverted exactly and keeps its sign; it counts as `NO_READING` where there is no reading.
    Noise is
    :math:`\sigma_i^2 = (2 e I_i + 4 k T_d / R + i_a^2) \Delta f` with the photocurrents of surface and gas.

    Parameters
    ----------
    signal : Currents
    weights : (D, N)
    gas : (D, N, C)
        `signal.gas`, or some of it.
    temperature, emittance : (T,) [K], (E,) [1]
    receiver, uncertainties

    Returns
    -------
    ndarray (source, D, C, E, T) [1], in the order of `SOURCES`
    """
    temperature, emittance = np.asarray(temperature, dtype=float), np.asarray(emittance, dtype=float)
    black = at_temperature(signal.black, temperature)[:, :, None, None, :]
    grey = emittance[:, None]
    measured = black * grey + gas[:, :, :, None, None]
    apparent = read(signal, weights, measured, grey)
    bias = np.nan_to_num(np.clip(apparent / temperature - 1, -NO_READING, NO_READING), nan=NO_READING)
    response = np.abs(sensitivity(signal.black, weights, temperature))[:, None, None, :]
    variance = 2 * ELEMENTARY_CHARGE * measured + signal.dark_noise[:, None, None, None, None]
    noise = np.einsum("dn,dncet->dcet", weights**2, variance * receiver.bandwidth / measured**2)
    slope = np.abs(np.einsum("dn,dn->d", weights, signal.wavelength))[:, None, None, None]
    window_error = uncertainties.window_slope * slope
    grey_error = uncertainties.emittance if weights.shape[1] == 1 else uncertainties.emittance_slope * slope
    calibration = uncertainties.signal * np.sqrt(np.sum(weights**2, axis=1))[:, None, None, None]
    scale = uncertainties.source_temperature * temperature / uncertainties.source_reference**2
    air = np.abs(np.einsum("dn,dn->d", weights, signal.air))[:, None, None, None]
    parts = [
        bias,
        np.sqrt(noise) / response,
        grey_error / response,
        np.hypot(calibration / response, scale),
        window_error / response,
        air / response,
    ]
    return np.stack([np.broadcast_to(part, bias.shape) for part in parts])


def total(parts):
    """Root of the summed squares of the sources, never more than `NO_READING`: (D, C, E, T)."""
    whole = np.sqrt(np.sum(np.square(parts), axis=0))
    return np.minimum(np.nan_to_num(whole, nan=NO_READING, posinf=NO_READING), NO_READING)


def score(parts):
    """Root mean square of the total error over conditions, emittances and temperatures (D,)."""
    return np.sqrt(np.mean(total(parts) ** 2, axis=(1, 2, 3)))
