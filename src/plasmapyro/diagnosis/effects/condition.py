"""Effects that belong to the simulation of a condition: there they act on the flow and on the levels."""

from types import MappingProxyType

import numpy as np

from plasmapyro.diagnosis.effects import gas
from plasmapyro.diagnosis.effects.effect import effect


@effect("power")
def power(scene, amplitude):
    """The gas of another power; a condition that holds this is simulated anew at that power."""
    return scene.but(spectrum=scene.spectrum * scene.library.power_factor(np.log1p(amplitude)))


OF_CONDITION = MappingProxyType(
    {one.id: one for one in (power, gas.excitation, gas.vibration, gas.ripple, gas.copper, gas.argon)}
)
SPECIES = MappingProxyType({gas.copper.id: "Cu I", gas.argon.id: "Ar I"})  # whose lines an effect adds


def species_of(identity):
    """Species whose lines an effect adds to the jet, None of one that adds none."""
    return SPECIES.get(identity) or (
        identity.removeprefix(f"{gas.LINES} ") if gas.proposed(identity) else None
    )
