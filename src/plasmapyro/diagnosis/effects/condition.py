"""Effects that belong to the simulation of a condition: there they act on the flow and on the levels."""

from types import MappingProxyType

import numpy as np

from plasmapyro.diagnosis.effects import gas
from plasmapyro.diagnosis.effects.effect import effect

COOLED_BY_MIXING = 15.0
"""Relative fall of the temperature of the gas over the square of the mixing length in torch radii. ASSUME:
as the light of computed flows has it, 16, 12 and 19 at 60, 80 and 110 kW (50 mbar, 16 g/s; 0.06), 11 at 80 kW
and 0.03; their spectra are those of gas that is so much colder everywhere within 4 %."""


@effect("power")
def power(scene, amplitude):
    """The gas of another power; a condition that holds this is simulated anew at that power."""
    return scene.but(spectrum=scene.spectrum * scene.library.power_factor(np.log1p(amplitude)))


@effect("mixing")
def mixing(scene, amplitude):
    r"""A jet that mixes with the gas around it; a condition that holds this is simulated anew so.

    :math:`T' = T (1 - c\,a^2)` for the whole path, c as `COOLED_BY_MIXING`: an eddy viscosity goes with the
    square of its mixing length.
    """
    colder = -COOLED_BY_MIXING * amplitude**2
    return scene.but(spectrum=scene.spectrum * scene.library.factor("core_temperature", colder, scene.power))


OF_FLOW = MappingProxyType({one.id: one for one in (power, mixing)})  # that solve the flow again
OF_LIGHT = (
    gas.power,
    gas.excitation,
    gas.vibration,
    gas.ripple,
    gas.self_absorption,
    gas.continuum,
    gas.copper,
    gas.argon,
)
OF_CONDITION = MappingProxyType({**OF_FLOW, **{one.id: one for one in OF_LIGHT}})
SPECIES = MappingProxyType({gas.copper.id: "Cu I", gas.argon.id: "Ar I"})  # whose lines an effect adds


def species_of(identity):
    """Species whose lines an effect adds to the jet, None of one that adds none."""
    return SPECIES.get(identity) or (
        identity.removeprefix(f"{gas.LINES} ") if gas.proposed(identity) else None
    )
