"""Terms of the gas: other spectra from the radiation engine, other histories, matter that does not belong
there."""

from functools import lru_cache

import numpy as np

from plasmapyro import tables
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.diagnosis.scene import planck
from plasmapyro.diagnosis.terms_surface import COLD, HOT
from plasmapyro.radiation.slit import FWHM_PER_SIGMA
from plasmapyro.refraction import vacuum_wavelength

OXYGEN = (776.5e-9, 778.8e-9)  # [m] around the triplet of O I, the yardstick of line strengths
RELEASE_EXCITATION = 5000.0  # [K] of metals at the wall
JET_EXCITATION = 6000.0  # [K] of foreign gas in the jet
CONTINUUM_TEMPERATURE = 6000.0  # [K]


def varied(name):
    """A term that replaces the spectrum of the gas by one varied with the engine."""

    def apply(scene, amplitude):
        return scene.but(spectrum=scene.spectrum * scene.library.factor(name, amplitude, scene.power))

    apply.__doc__ = f"The gas with another {name.replace('_', ' ')}."
    return apply


def drift(scene, amplitude, **waves):
    r"""Brightness that drifts: :math:`g(t) = 1 + a\,t/t_{off}`, and follows free values in between if wanted.

    `waves`: `hat_0`, `hat_1`... are relative changes at equal steps of the exposure, joined linearly.
    """
    change = amplitude * scene.exposure
    if waves:
        values = [waves[f"hat_{place}"] for place in range(len(waves))]
        change = change + np.interp(
            scene.exposure, np.linspace(0, 1, len(waves) + 1)[1:], values, left=0.0
        ) * (scene.time > 0)
    return scene.but(gas_gain=scene.gas_gain * (1 + change))


WAVES = 9  # free values of a brightness that wanders
LARGEST_WAVE = 0.3  # [1]


def continuum(scene, amplitude):
    r"""More continuum: :math:`\propto \lambda^{-2} e^{-hc/\lambda kT}`; 1 is a hundredth of the mean
    light."""
    axis = scene.spectral_axis
    shape = axis**-2.0 * np.exp(-SECOND_RADIATION / (axis * CONTINUUM_TEMPERATURE))
    more = shape * (0.01 * scene.library.base.mean() / shape.mean())
    return scene.but(spectrum=scene.spectrum + amplitude * more)


def warm_wall(scene, amplitude):
    """A boundary layer that warms up with the wall: light added in proportion to its temperature."""
    grown = np.clip((scene.temperature - COLD) / (HOT - COLD), 0.0, None) * scene.injected
    share = amplitude * grown * scene.gas_gain
    return scene.but(more_gas=(*scene.more_gas, (share, scene.library.addition["warm_wall"])))


def afterglow(scene, amplitude, *, decay):
    """Gas that still shines after the end, with the spectrum of the weakest plasma simulated."""
    after = scene.time - scene.off_time
    share = amplitude * np.where(after > 0, np.exp(-np.maximum(after, 0.0) / decay), 0.0)
    return scene.but(more_gas=(*scene.more_gas, (share, scene.library.weakest)))


def particles(scene, amplitude, *, temperature):
    """Hot grains in the sight line while the plasma burns: a grey share of a black body."""
    share = amplitude * scene.injected * scene.plasma
    body = planck(scene.wavelength, np.array(temperature))
    return scene.but(added=scene.added + share[..., None] * body)


def released(*species):
    """A term: lines of matter that a hot surface releases; 1 is a tenth of the O I triplet at 1600 K."""

    def apply(scene, amplitude, *, growth):
        light = line_spectrum(species, scene.library, RELEASE_EXCITATION)
        share = amplitude * _release(scene, growth) * scene.gas_gain
        return scene.but(more_gas=(*scene.more_gas, (share, light)))

    apply.__doc__ = f"Lines of {', '.join(species)} from the surface."
    return apply


def foreign(*species):
    """A term: lines of matter in the jet, with or without a sample; 1 is a tenth of the O I triplet."""

    def apply(scene, amplitude):
        return scene.but(
            spectrum=scene.spectrum + amplitude * line_spectrum(species, scene.library, JET_EXCITATION)
        )

    apply.__doc__ = f"Lines of {', '.join(species)} in the jet."
    return apply


def cyanogen(scene, amplitude, *, growth, decay):
    """CN at the wall: starts with the oxidation of carbon, fades as oxide seals; 1 is a hundredth of the
    light."""
    light = scene.library.addition["cyanogen"]
    light = light * (0.01 * scene.library.base.sum() / light.sum())
    share = (
        amplitude * _release(scene, growth) * np.exp(-np.maximum(scene.time, 0.0) / decay) * scene.gas_gain
    )
    return scene.but(more_gas=(*scene.more_gas, (share, light)))


def _release(scene, growth):
    """Release (n, 2), 1 at 1600 K: Arrhenius with the exponent `growth` there."""
    exponent = np.clip(growth * (1 - HOT / scene.temperature), -60.0, 2.0)
    return np.exp(exponent) * scene.injected * scene.plasma


@lru_cache(maxsize=64)
def _lines(species, temperature):
    """Wavelengths in vacuum [m] and relative strengths of the lines of some species."""
    table = tables.load("diagnosis/impurity_lines")
    chosen = np.isin(table["species"], species)
    air = table["wavelength_air"][chosen]
    strength = (
        table["einstein_a"][chosen]
        * table["upper_degeneracy"][chosen]
        / air
        * np.exp(-SECOND_RADIATION * table["upper_energy"][chosen] / temperature)
    )
    names = table["species"][chosen]
    for name in set(names):  # each species as bright as the other: their amounts are unknown
        strength[names == name] /= strength[names == name].sum() * len(set(names))
    return vacuum_wavelength(air), strength


def line_spectrum(species, library, temperature):
    """Lines (K,) behind the slit of the library, together a tenth of its O I triplet [W m-2 sr-1 m-1]."""
    axis = library.wavelength
    centre, strength = _lines(species, temperature)
    sigma = library.slit_fwhm / FWHM_PER_SIGMA
    shape = np.exp(-(((axis - centre[:, None]) / sigma) ** 2) / 2) / (sigma * np.sqrt(2 * np.pi))
    near = (axis > OXYGEN[0]) & (axis < OXYGEN[1])
    triplet = np.trapezoid(library.base[near], axis[near])
    return 0.1 * triplet * strength @ shape


SECOND_ORDER = (  # [nm] in the first order, strength, tail to the blue: what would appear twice as far
    (470.9, 1.0, 3.0),  # N2+ 1-, 0-2
    (465.2, 0.5, 3.0),  # N2+ 1-, 1-3
    (486.1, 0.3, 0.1),  # H beta
    (493.5, 0.2, 0.1),  # N I
)


def second_order(scene, amplitude):
    """Light of half the wavelength in the second order of the grating, beyond 910 nm.

    ASSUME: positions are those of N2+ 1- heads (Gilmore, Laher & Espy 1992), H beta and N I; their strengths,
    outside the range of the engine, are guesses: 1 makes the strongest image as bright as the gas beside it.
    """
    if scene.kind != "spectrometer":
        return scene
    axis = scene.spectral_axis
    image = np.zeros(axis.size)
    level = scene.library.base[(axis > 930e-9) & (axis < 960e-9)].mean()
    for place, strength, tail in SECOND_ORDER:
        away = 2 * place * 1e-9 - axis
        width = max(2 * tail * 1e-9, 0.6e-9)
        shape = np.where(away >= 0, np.exp(-np.maximum(away, 0) / width), np.exp(-((away / 0.4e-9) ** 2)))
        image += strength * shape
    image *= level / (1 + np.exp(-(axis - 915e-9) / 4e-9))
    opening = 1 / (1 + np.exp(-(scene.wavelength - 915e-9) / 4e-9))
    hot = planck(scene.wavelength / 2, scene.temperature) * scene.injected[..., None] * opening
    return scene.but(
        more_gas=(*scene.more_gas, (amplitude * scene.gas_gain, image)),
        added=scene.added + amplitude * scene.emittance * hot,
    )
