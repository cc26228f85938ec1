"""Probes of the facility in a computed jet: calorimeter and Pitot probe."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.checks import positive, within
from plasmapyro.constants import MOLAR_GAS
from plasmapyro.facility.jet import potential_edge
from plasmapyro.facility.kinetics import MOLAR_MASS
from plasmapyro.facility.stagnation_line import solve
from plasmapyro.gas import equilibrium

# A flat face of 25 mm with a shoulder of 11 mm takes as much as a sphere of this many times its radius.
# From our flows past both: 0.64 of the heat flux at 70 and at 90 kW.
EFFECTIVE_RADIUS = {"hemisphere": 1.0, "blunt": 2.4}


@dataclass(frozen=True)
class Calorimeter:
    """Shape (see `EFFECTIVE_RADIUS`), radius [m], wall temperature [K] and recombination [1] of its face."""

    radius: float
    shape: str = "hemisphere"
    wall_temperature: float = 350.0
    recombination: float = 1.0

    def __post_init__(self):
        positive("radius", self.radius, "m")
        within("recombination", self.recombination, 0.0, 1.0, "1")
        if self.shape not in EFFECTIVE_RADIUS:
            raise ValueError(f"shape must be one of {', '.join(EFFECTIVE_RADIUS)}; got '{self.shape}'")


def heat_flux(jet, calorimeter, chemistry, start=None):
    """Heat flux [W m-2] that a `Calorimeter` takes from a `Jet`, and its `StagnationLine`.

    The jet has the temperature of the edge of the layer; `chemistry`, `start`: see `stagnation_line.solve`.
    """
    radius = calorimeter.radius * EFFECTIVE_RADIUS[calorimeter.shape]
    wall = {name: getattr(calorimeter, name) for name in ("wall_temperature", "recombination")}
    line = solve(potential_edge(jet, radius), radius, **wall, chemistry=chemistry, start=start)
    return line.heat_flux, line


def pitot_pressure(jet, radius, *, wall_temperature=350.0, start=None):
    r"""Reading [Pa] of a cooled Pitot probe with a hemispherical nose in a `Jet`, above the chamber pressure.

    .. math:: p = p_j + \tfrac12\rho(U^2 - u_e^2) + \Delta p

    with the rise :math:`\Delta p` along its stagnation line, friction and the cold gas on the wall included.
    `radius` [m], `wall_temperature` [K]; `start`: a `StagnationLine` nearby to begin with.
    """
    edge, wall = potential_edge(jet, radius), {"wall_temperature": wall_temperature, "recombination": 1.0}
    line = solve(edge, radius, **wall, chemistry="equilibrium", start=start)
    slowed = 0.5 * density(jet) * (jet.speed**2 - edge.normal_speed**2)
    return jet.gauge_pressure + slowed + line.pressure_rise


def density(jet):
    """Density [kg m-3] of the equilibrium gas of a Jet."""
    x = equilibrium.composition(np.array([jet.temperature]), jet.pressure, jet.nitrogen)[0]
    return float(jet.pressure * (x @ MOLAR_MASS) / (MOLAR_GAS * jet.temperature))


def enthalpy(jet):
    """Enthalpy [J kg-1] of the equilibrium gas of a Jet, zero for cold air at 298.15 K."""
    temperature = np.array([jet.temperature])
    x = equilibrium.composition(temperature, jet.pressure, jet.nitrogen)
    return float(equilibrium.enthalpy(x, equilibrium.species_enthalpy(temperature))[0])
