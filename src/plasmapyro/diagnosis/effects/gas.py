"""Effects of the gas: other spectra from the engine, other histories, matter that does not belong there."""

from dataclasses import replace
from functools import cache, lru_cache

import numpy as np

from plasmapyro.diagnosis.effects.effect import effect
from plasmapyro.diagnosis.effects.surface import COLD, HOTTEST, PIVOT
from plasmapyro.identification.species import catalogue
from plasmapyro.radiation.atoms import TABLE_RANGE
from plasmapyro.radiation.foreign import continuum as free_electrons
from plasmapyro.radiation.foreign import oxygen_triplet
from plasmapyro.radiation.planck import planck
from plasmapyro.radiation.slit import FWHM_PER_SIGMA
from plasmapyro.refraction import vacuum_wavelength

RELEASE_EXCITATION = 5000.0  # [K] of metals at the wall
LEAKS = ("H I", "He I", "Ne I", "Kr I", "Xe I", "F I", "Cl I")
LINES, THIN = "lines", 1e-3  # first word of the id of lines of any species, and their optical depth
GRAINS = 2300.0  # [K], whose light at 0.95 um counts hot grains
JET_EXCITATION = 6000.0  # [K] of foreign gas in the jet


def varied(name):
    """Formula that replaces the spectrum of the gas by one varied with the engine."""

    def vary(scene, amplitude):
        return scene.but(spectrum=scene.spectrum * scene.library.factor(name, amplitude, scene.power))

    return vary


power = effect("P_eff")(varied("core_temperature"))
ripple = effect("ripple")(varied("ripple"))
excitation = effect("T_exc")(varied("excitation"))
vibration = effect("T_vib")(varied("vibration"))
self_absorption = effect("selfabs")(varied("optical_depth"))


@effect("contin", shape={"own": ((0.0, 1.0), (0.0, 1.0))})
def continuum(scene, amplitude, *, own):
    r"""More continuum; 1 is a hundredth of the light.

    A share `own` of it with the spectrum of the simulated continua and their edges (detachment of O-: 849
    nm, 1.46 eV), the rest that of free electrons, :math:`\propto \lambda^{-2} e^{-hc/\lambda kT}`.
    """
    free, light = free_electrons(scene.spectral_axis), scene.library.continua
    shape = (1 - own) * free / free.mean() + own * light / (light.mean() or 1.0)
    return scene.but(spectrum=scene.spectrum + 0.01 * amplitude * scene.spectrum.mean() * shape)


@effect("gas_drift")
def drift(scene, amplitude):
    r"""Brightness that drifts: :math:`g(t) = 1 + a\,t/t_{off}`."""
    return scene.but(gas_gain=scene.gas_gain * (1 + amplitude * scene.exposure))


@effect("bl")
def warm_wall(scene, amplitude):
    """A boundary layer that warms up with the wall: light added in proportion to its temperature."""
    grown = np.clip((scene.temperature - COLD) / (HOTTEST - COLD), 0.0, None) * scene.injected
    share = amplitude * grown * scene.gas_gain
    return scene.but(more_gas=(*scene.more_gas, (share, scene.library.addition["warm_wall"])))


@effect("afterglow", shape={"decay": ((0.5, 2.0), (0.1, 10.0))})
def afterglow(scene, amplitude, *, decay):
    """Gas that still shines after the end, with the spectrum of the weakest plasma simulated."""
    after = scene.time - scene.off_time
    share = amplitude * np.where(after > 0, np.exp(-np.maximum(after, 0.0) / decay), 0.0)
    return scene.but(more_gas=(*scene.more_gas, (share, scene.library.weakest)))


@effect("particles", shape={"temperature": ((2000.0, 2400.0), (1900.0, 2700.0))})
def particles(scene, amplitude, *, temperature):
    """Hot grains in the sight line while the plasma burns: grey light.

    Counted at 0.95 um in shares of a black body of 2300 K, which data tell whatever the temperature is.
    """
    share = amplitude * scene.injected * scene.plasma
    level = planck(PIVOT, np.array(GRAINS)) / planck(PIVOT, np.array(temperature))
    body = planck(scene.wavelength, np.array(temperature)) * level
    return scene.but(added=scene.added + share[..., None] * body)


def released(*species):
    """Formula of lines of matter that a hot surface releases; 1 is a tenth of the O I triplet at 1600 K."""

    def release(scene, amplitude, *, growth):
        light = line_spectrum(species, scene.library, RELEASE_EXCITATION)
        share = amplitude * _release(scene, growth) * scene.gas_gain
        return scene.but(more_gas=(*scene.more_gas, (share, light)))

    return release


GROWTH = {"growth": ((6.0, 12.0, 20.0), (3.0, 30.0))}
alkali = effect("NaK", shape=GROWTH)(released("Na I", "K I"))
calcium = effect("CaII", shape=GROWTH)(released("Ca II"))


@effect("CN", shape={"growth": ((4.0, 10.0), (1.0, 20.0)), "decay": ((150.0, 600.0), (20.0, 2000.0))})
def cyanogen(scene, amplitude, *, growth, decay):
    """CN at the wall: starts as carbon oxidises, fades as oxide seals; 1 is a hundredth of the light."""
    light = scene.library.addition["cyanogen"]
    light = light * (0.01 * scene.library.base.sum() / light.sum())
    faded = np.exp(-np.maximum(scene.time, 0.0) / decay)
    share = amplitude * _release(scene, growth) * faded * scene.gas_gain
    return scene.but(more_gas=(*scene.more_gas, (share, light)))


def foreign(*species):
    """Formula of lines of matter in the jet, with or without a sample; 1 is a tenth of the O I triplet."""

    def contaminate(scene, amplitude):
        lines = line_spectrum(species, scene.library, JET_EXCITATION, scene.spectrum)
        return scene.but(spectrum=scene.spectrum + amplitude * lines)

    return contaminate


copper = effect("Cu")(foreign("Cu I"))
argon = effect("Ar")(foreign("Ar I"))


def lines_of(name):
    """The effect 'lines <species>': lines of any species of the table of lines, in the jet.

    It is not in the catalogue, which would name the nearest of hundreds: the lines that are left choose it.

    Raises
    ------
    KeyError
        Not a species of the table.
    """
    by_name = {one.name: one for one in catalogue()}
    plain = effect(LINES)(foreign(name))
    return replace(plain, id=f"{LINES} {by_name[name].name}", name=f"lines of {name}")


@cache
def leaks():
    """The effects 'lines <species>' of gases that purges and leaks bring, and air has not."""
    return tuple(lines_of(name) for name in LEAKS)


def proposed(identity):
    """The effect of an id that `lines_of` gave, else None."""
    kind, _, name = str(identity).partition(" ")
    return lines_of(name) if kind == LINES and name in {one.name for one in catalogue()} else None


def _release(scene, growth):
    """Release (n, 2), 1 at 1600 K: Arrhenius with the exponent `growth` there."""
    exponent = np.clip(growth * (1 - HOTTEST / scene.temperature), -60.0, 2.0)
    return np.exp(exponent) * scene.injected * scene.plasma


@lru_cache(maxsize=64)
def species_lines(species, temperature=JET_EXCITATION):
    """Wavelengths in vacuum [m] and relative strengths of the lines of some species."""
    air, strength, names = np.zeros(0), np.zeros(0), np.zeros(0, dtype=str)
    for one in catalogue():
        one = one.between(*TABLE_RANGE) if one.name in species else None
        if one:
            air, names = np.append(air, one.wavelength), np.append(names, [one.name] * one.wavelength.size)
            strength = np.append(strength, one.light(temperature, THIN))
    for name in set(names):  # each species as bright as the other: their amounts are unknown
        strength[names == name] /= strength[names == name].sum() * len(set(names))
    return vacuum_wavelength(air), strength


def line_spectrum(species, library, temperature, light=None):
    """Lines (K,) behind the slit of the library, together a tenth of the O I triplet [W m-2 sr-1 m-1] of some
    light (K,), or of that of the library."""
    axis = library.wavelength
    lines = _behind_slit(species, temperature, library.slit_fwhm, axis.tobytes())
    return 0.1 * oxygen_triplet(axis, library.base if light is None else light) * lines


@lru_cache(maxsize=64)
def _behind_slit(species, temperature, slit_fwhm, axis):
    """Lines (K,) of some species behind a slit [m-1], together 1; `axis`: the bytes of the wavelengths."""
    centre, strength = species_lines(species, temperature)
    sigma = slit_fwhm / FWHM_PER_SIGMA
    shape = np.exp(-(((np.frombuffer(axis) - centre[:, None]) / sigma) ** 2) / 2)
    return strength @ (shape / (sigma * np.sqrt(2 * np.pi)))
