"""The shape of a spectrum as a temperature: how two calibrations, or two lamps, compare."""

from typing import NamedTuple

import numpy as np

from plasmapyro.radiation.planck import blackbody_radiance

COLDEST, HOTTEST = 500.0, 10_000.0  # [K] where the shape is looked for
TEMPERATURE_STEP = 1e-3  # [K] of the search


class Shape(NamedTuple):
    """Planck's law with a free scale, fitted to a spectrum."""

    temperature: float  # [K]
    scale: float  # [unit of the spectrum over W m-2 sr-1 m-1]
    residual: float  # [1] rms of the spectrum over the fit, minus 1


class Comparison(NamedTuple):
    """A spectrum beside a reference."""

    temperature_difference: float  # [K] of the two shapes
    level: float  # [1] median ratio
    residual: float  # [1] rms of the ratio about a Planckian change of shape


def planck_shape(wavelength, spectrum, band):
    r"""Temperature of the black body with the shape of a spectrum (W,), within a band (2,) [m].

    Minimises :math:`\overline{(y_i / (c L^{bb}_i(T)) - 1)^2}` over `c` and `T`; samples that are not finite
    and > 0 are left out. ValueError: fewer than 10 usable samples in the band, or a shape beyond 500 to 10
    000 K.
    """
    from scipy.optimize import minimize_scalar

    wavelength, spectrum = np.asarray(wavelength, dtype=float), np.asarray(spectrum, dtype=float)
    used = (wavelength >= band[0]) & (wavelength <= band[1]) & np.isfinite(spectrum) & (spectrum > 0)
    if used.sum() < 10:
        raise ValueError(
            f"planck_shape needs 10 samples in {band[0] * 1e9:g} to {band[1] * 1e9:g} nm; got {used.sum()}"
        )
    grid, values = wavelength[used], spectrum[used]

    def ratio(temperature):
        return values / blackbody_radiance(grid, temperature)

    def misfit(temperature):
        over = ratio(temperature)
        return np.var(over) / np.mean(over**2)

    found = minimize_scalar(
        misfit, bounds=(COLDEST, HOTTEST), method="bounded", options={"xatol": TEMPERATURE_STEP}
    )
    if not COLDEST + 1 < found.x < HOTTEST - 1:
        raise ValueError(f"the spectrum has no shape of a black body between {COLDEST:g} and {HOTTEST:g} K")
    over = ratio(found.x)
    scale = np.mean(over**2) / np.mean(over)
    return Shape(float(found.x), float(scale), float(np.sqrt(np.mean((over / scale - 1) ** 2))))


def compare(wavelength, spectrum, reference, band):
    """How a spectrum differs from a reference: in the temperature of its shape, in level, and beyond both."""
    mine, its = (planck_shape(wavelength, values, band) for values in (spectrum, reference))
    used = (wavelength >= band[0]) & (wavelength <= band[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = (np.asarray(spectrum) / np.asarray(reference))[used]
        planck = blackbody_radiance(wavelength[used], mine.temperature) / blackbody_radiance(
            wavelength[used], its.temperature
        )
    flat = ratio / planck
    flat = flat[np.isfinite(flat)]
    return Comparison(
        mine.temperature - its.temperature,
        float(np.median(ratio[np.isfinite(ratio)])),
        float(np.std(flat) / np.mean(flat)),
    )
