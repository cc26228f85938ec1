"""The gas of a simulation with the effects of its condition that are taken as given."""

from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.effects.condition import COOLED_BY_MIXING, OF_CONDITION, OF_FLOW, species_of
from plasmapyro.diagnosis.effects.gas import continuum
from plasmapyro.diagnosis.effects.gas import power as hotter
from plasmapyro.diagnosis.effects.scene import Scene
from plasmapyro.diagnosis.fit.model import POWER_SIGMA
from plasmapyro.diagnosis.fit.terms import AMPLITUDE

POWER, MIXING = OF_FLOW
EXACT_POWER = 1e-3  # [1] standard deviation of ln P where a power is given without an uncertainty


def of_gas(term):
    """Whether a term changes the gas as it is simulated."""
    return term.setting.id in OF_CONDITION or species_of(term.setting.id) is not None


def with_gas(library, terms):
    r"""A library of the gas with terms of its condition, and what is known of its power.

    Power, temperatures, ripple and depth multiply the light; foreign light is one group of lines more. What
    is uncertain of an amplitude is an error of the simulated light, :math:`u\,\partial L/\partial a`; of the
    power, it is the prior of the power.

    Parameters
    ----------
    library : GasLibrary
    terms : sequence of Term, those `of_gas`

    Returns
    -------
    GasLibrary, (mean, standard deviation) of ln P over the power of that library
    """
    known, place = (0.0, POWER_SIGMA), {identity: at for at, identity in enumerate(OF_CONDITION)}
    for term in sorted(terms, key=lambda one: place.get(one.setting.id, len(place))):
        setting, sigma, before = term.setting, term.uncertainty.get(AMPLITUDE, 0.0), library
        library = _with(before, setting)
        if setting.id == POWER:
            known = 0.0, max(sigma / (1 + setting.amplitude), EXACT_POWER)
            known = (-np.log1p(setting.amplitude), POWER_SIGMA) if term.own else known
        elif sigma:
            low, high = (term.at({AMPLITUDE: setting.amplitude + end * sigma}) for end in (-1, 1))
            change = light_with(before, high) - light_with(before, low)
            library = _with_error(library, change * sigma / (high.amplitude - low.amplitude))
    return replace(library, given=tuple(terms)), known


def light_with(library, setting):
    """Light (K,) of the gas of a library with one effect of its condition."""
    none = np.zeros((1, 1))
    scene = Scene(
        kind="",
        time=none,
        temperature=none,
        wavelength=library.wavelength,
        off_time=0.0,
        glow=none,
        emittance=1.0,
        gas_gain=none,
        spectral_axis=library.wavelength,
        spectrum=library.base,
        library=library,
    )
    return setting.effect.light(scene, setting.amplitude, **setting.shape).spectrum


def _with(library, setting):
    """The library of a gas with one effect of its condition."""
    effect, light = setting.effect, light_with(library, setting)
    if effect.id == continuum.id or species_of(effect.id):
        names, more = (*library.group_name, effect.name), light - library.base
        return replace(library, group_name=names, group=np.concatenate([library.group, more[None]]))
    factor = light / np.maximum(library.base, 1e-12 * library.base.max())
    core, power = library.core, library.power
    if effect.id == POWER:
        power *= 1 + setting.amplitude
        core = library.hotter(library.warmth_of(np.log1p(setting.amplitude)))
    elif effect.id in (hotter.id, MIXING):
        size = setting.amplitude
        core = library.hotter(size if effect.id == hotter.id else -COOLED_BY_MIXING * size**2)
    return replace(
        library,
        power=power,
        core=core,
        group=library.group * factor,
        strength_modes=library.strength_modes * factor,
        shape_modes=library.shape_modes * factor,
        bands=library.bands * factor,
        addition={name: row * factor for name, row in library.addition.items()},
    )


def _with_error(library, mode):
    """The library whose whole light errs by one mode (K,) more."""
    return replace(
        library,
        shape_systems=(*library.shape_systems, ""),
        shape_causes=(*library.shape_causes, ""),
        shape_modes=np.concatenate([library.shape_modes, mode[None]]),
    )
