"""The traditional rebuilding: edge temperature and enthalpy from measured heat flux and Pitot pressure."""

from dataclasses import dataclass, replace

import numpy as np

from plasmapyro.checks import positive
from plasmapyro.facility.jet import Jet
from plasmapyro.facility.probes import density, enthalpy, heat_flux
from plasmapyro.gas.species import AIR

TEMPERATURES = (1200.0, 9000.0)  # [K] between which the edge is looked for
FIRST_TEMPERATURE = 4500.0  # [K]
TOLERANCE, LARGEST_COUNT = 1e-3, 30  # of the heat flux; it grows nearly as the enthalpy does


@dataclass(frozen=True)
class Rebuilt:
    """Temperature [K], enthalpy [J kg-1] (zero for cold air at 298.15 K) and speed [m s-1] of the jet."""

    temperature: float
    enthalpy: float
    speed: float


def rebuild(
    measured_heat_flux, dynamic_pressure, pressure, calorimeter, *, chemistry, pitot_factor,
    nitrogen=AIR["N2"],
):  # fmt: skip
    r"""`Rebuilt` state of the jet that gives a measured pair on a calorimeter of assumed catalysis.

    .. math:: q(T_e, U; \gamma) = q_{meas}, \qquad U = \sqrt{2 p_{dyn} / (K\rho_e(T_e))}

    Parameters
    ----------
    measured_heat_flux : float [W m-2]
    dynamic_pressure : float [Pa]
        Pitot less static pressure.
    pressure : float [Pa]
        Static.
    calorimeter : Calorimeter
        Its recombination is the assumption.
    chemistry : str
        See `stagnation_line.solve`.
    pitot_factor : float [1]
        K: what friction on the Pitot probe multiplies the dynamic pressure with.
    nitrogen : float [1]
        Mole fraction of N2 in the cold gas.

    Raises
    ------
    ValueError
        No temperature between 1200 and 9000 K gives the heat flux.
    """
    target = float(positive("measured_heat_flux", measured_heat_flux, "W m-2"))
    pitot_factor = float(positive("pitot_factor", pitot_factor, "1"))
    positive("dynamic_pressure", dynamic_pressure, "Pa")

    grid = np.linspace(*TEMPERATURES, 391)
    levels = np.array([enthalpy(Jet(one, pressure, 0.0, 0.0, nitrogen)) for one in grid])
    temperature, line = FIRST_TEMPERATURE, None
    for _ in range(LARGEST_COUNT):
        jet = _jet(temperature, pressure, dynamic_pressure / pitot_factor, nitrogen)
        flux, line = heat_flux(jet, calorimeter, chemistry, line)
        if abs(flux / target - 1) < TOLERANCE:
            return Rebuilt(jet.temperature, enthalpy(jet), jet.speed)
        wanted = np.interp(temperature, grid, levels) * target / flux
        if not levels[0] < wanted < levels[-1]:
            break
        temperature = float(np.interp(wanted, levels, grid))
    raise ValueError(
        f"no edge of {TEMPERATURES[0]:g} to {TEMPERATURES[1]:g} K gives {target:g} W m-2 at "
        f"{dynamic_pressure:g} Pa with recombination {calorimeter.recombination:g}"
    )


def _jet(temperature, pressure, dynamic_pressure, nitrogen):
    still = Jet(float(temperature), float(pressure), 0.0, 0.0, nitrogen)
    return replace(still, speed=float(np.sqrt(2 * dynamic_pressure / density(still))))
