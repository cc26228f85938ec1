"""Effects of the surface: its emittance, its temperature over the spot, what it reflects."""

from functools import partial

import numpy as np

from plasmapyro.diagnosis.effects.effect import (
    EXPOSED,
    HOT,
    PAPER,
    PYROMETER,
    SPECTROMETER,
    Amplitude,
    effect,
)
from plasmapyro.radiation.planck import planck, planck_curvature

PIVOT = 0.95e-6  # [m] where spectral slopes turn
MICROMETRE = 1e-6
HOTTEST, COLD = 1600.0, 350.0  # [K] between which a dependence on temperature is counted
FOOTPRINT_RATIO = 10.0 / 14.0  # diameter of the spot of the spectrometer over that of the pyrometer
COVER_EMITTANCE = 1.0  # ASSUME: the cover of the probe emits like the sample

surface = partial(effect, stage="surface")


@surface(
    "eps_slope",
    "emittance that varies with wavelength",
    klass="spectral emittance",
    amplitude=Amplitude("slope", "um-1", sigma=0.3, bounds=(-1.5, 1.5)),
    phases=HOT,
    measurement="spectral emittance of the sample at temperature",
    degenerate_with=("edge2", "phi"),
)
def slope(scene, amplitude):
    r"""Emittance that varies with wavelength: :math:`\varepsilon[1 + b(\lambda - 0.95\,\mu m)]`."""
    return scene.but(emittance=scene.emittance * (1 + amplitude * (scene.wavelength - PIVOT) / MICROMETRE))


@surface(
    "eps_T",
    "emittance that follows the temperature",
    klass="emittance with temperature",
    amplitude=Amplitude("change", "1", sigma=0.05, bounds=(-0.6, 0.6)),
    phases=HOT,
    measurement="emittance measured at two temperatures",
    degenerate_with=("grad",),
)
def with_temperature(scene, amplitude):
    r"""Emittance that follows the temperature: :math:`\varepsilon[1 + c (T - 350)/1250]`."""
    change = (scene.temperature[..., None] - COLD) / (HOTTEST - COLD)
    return scene.but(emittance=scene.emittance * (1 + amplitude * change))


@surface(
    "eps_ox",
    "emittance that changes for good (oxidation, loss of coating)",
    klass="emittance in time",
    amplitude=Amplitude("change", "1", sigma=0.1, bounds=(-0.8, 0.8)),
    phases=HOT,
    measurement="emittance measured after the test",
    shape={"time_constant": ((10.0, 40.0, 150.0), (3.0, 400.0))},
    degenerate_with=("eps_T",),
)
def oxidation(scene, amplitude, *, time_constant):
    r"""Emittance that changes for good: :math:`\varepsilon[1 + a(1 - e^{-t/\tau})]`."""
    grown = -np.expm1(-np.maximum(scene.time, 0.0) / time_constant)[..., None]
    return scene.but(emittance=scene.emittance * (1 + amplitude * grown))


@surface(
    "refl",
    "light of the gas reflected by the surface",
    klass="reflected gas",
    amplitude=Amplitude("share of a mirror", "1", sigma=1.0, bounds=(0.0, 3.0)),
    phases=EXPOSED,
    measurement="a sample of low emittance; a spectrum before injection",
    reference=PAPER,
    shape={"diffuse": ((0.0, 0.1), (0.0, 1.0))},
    degenerate_with=("P_eff", "T_exc"),
)
def reflection(scene, amplitude, *, diffuse):
    r"""Light of the gas that the surface reflects: :math:`(1 - \varepsilon) f L^{gs}`.

    `diffuse` shares it between what a mirror and what a matt surface returns.
    """
    library = scene.library
    mirrored = library.addition["reflected_specular"] / library.base
    scattered = library.addition["reflected_diffuse"] / library.base
    spectrum = scene.spectrum * ((1 - diffuse) * mirrored + diffuse * scattered)
    dark = 1 - np.asarray(scene.emittance)
    mean = dark if dark.ndim == 0 else np.broadcast_to(dark, scene.glow.shape).mean(axis=-1)
    share = amplitude * mean * scene.gas_gain * scene.injected
    return scene.but(more_gas=(*scene.more_gas, (share, spectrum)))


@surface(
    "torchglow",
    "glow of hot walls reflected by the surface",
    klass="reflected glow",
    amplitude=Amplitude("view factor", "1", sigma=0.004, bounds=(0.0, 0.2)),
    phases=("cold", "heating", "cooling"),
    measurement="a cold sample in view of the torch",
    shape={"temperature": ((850.0, 1200.0, 1550.0), (700.0, 1800.0)), "decay": ((8.0, 40.0), (2.0, 100.0))},
    degenerate_with=("off2",),
)
def torch_glow(scene, amplitude, *, temperature, decay):
    r"""Reflected glow of hot walls: :math:`(1-\varepsilon) c B(T_q)`, fading after the plasma ends."""
    after = np.maximum(scene.time - scene.off_time, 0.0)
    share = amplitude * scene.injected * np.exp(-after / decay)
    body = planck(scene.wavelength, np.array(temperature))
    return scene.but(added=scene.added + (1 - scene.emittance) * share[..., None] * body)


@surface(
    "grad",
    "temperature gradient over the spot",
    klass="spot",
    amplitude=Amplitude("standard deviation", "K", sigma=60.0, bounds=(0.0, 250.0)),
    phases=HOT,
    measurement="an infrared camera; a second spot size",
    degenerate_with=("eps_T", "clock"),
    quadratic=True,
)
def gradient(scene, amplitude):
    r"""Unequal temperature, amplitude :math:`\sigma_T` [K]: :math:`B + \tfrac12 \sigma_T^2 B''`.

    ASSUME: the standard deviation goes with the area of the spot, 14 and 10 mm across.
    """
    sigma = amplitude * (FOOTPRINT_RATIO**2 if scene.kind == "spectrometer" else 1.0)
    relative = np.clip(scene.temperature[..., None] / HOTTEST, 0.0, 2.0)
    more = 0.5 * (sigma * relative) ** 2 * planck_curvature(scene.wavelength, scene.temperature)
    return scene.but(glow=scene.glow * (1 + more))


def cover(scene, amplitude, *, ratio, lag):
    """A share of the spot falls beside the sample, on something cooler that lags behind."""
    behind = scene.history(np.maximum(scene.time - lag, 0.0))
    other = COLD + ratio * (np.where(scene.time > 0, behind, COLD) - COLD)
    body = planck(scene.wavelength, np.maximum(other, 250.0)) * scene.injected[..., None]
    return scene.but(glow=scene.glow + amplitude * (COVER_EMITTANCE * body - scene.glow))


beyond_sample = partial(
    surface,
    klass="spot",
    amplitude=Amplitude("share of the spot", "1", sigma=0.08, bounds=(0.0, 0.6)),
    phases=HOT,
    measurement="an image of the spot; an alignment laser",
    shape={"ratio": ((0.72, 0.86), (0.5, 0.98)), "lag": ((3.0, 12.0), (0.5, 30.0))},
)
cover_pyrometer = beyond_sample(
    "edge_p",
    "spot of the pyrometer beyond the sample",
    instruments=PYROMETER,
    degenerate_with=("edge_s",),
)(cover)
cover_spectrometer = beyond_sample(
    "edge_s",
    "spot of the spectrometer beyond the sample",
    instruments=SPECTROMETER,
    degenerate_with=("edge_p",),
)(cover)
