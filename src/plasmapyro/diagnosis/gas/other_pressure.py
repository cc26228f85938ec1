"""The gas of a test at another pressure than the simulated one, along the temperatures of its flow."""

import numpy as np

from plasmapyro import conditions
from plasmapyro.checks import within
from plasmapyro.diagnosis.gas.stage import gas_variations
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import nitrogen_of
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.radiation.stored_table import stored_table

BOUNDARY_LAYER = 5e-3  # [m] as `diagnosis.boundary_layer_depth_mm` of the configuration
FINER = 1.5  # [1], grid over that of the simulations: NO shines in the colder gas of higher pressures
MBAR = 100.0  # [Pa]
PRESSURES = 1.5e3, 3e4  # [Pa] as `chamber_pressure_mbar` of a condition
REACH = 1.35  # [1], of powers about the one that a test ran at


def simulated_at(pressure, around, sightlines, views, radiation, *, wavelength, response=None):
    """Spectra at another pressure of the powers about some conditions, and the variations of these.

    ASSUME: the temperatures of the simulated flows, and equilibrium at the pressure; a flow at that pressure
    differs from them nearly as one of another power does (`simulation.simulated.expected_power`).

    Parameters
    ----------
    pressure : float [Pa]
        Of the chamber, 1.5 to 30 kPa, as that of conditions.
    around : sequence of conditions
        That share all but the power.
    sightlines, views : mapping condition -> Datasets, contracts 'sightline' and 'surface_view'
        Variations are made where there is a view.
    radiation : mapping condition -> Dataset, contract 'radiation'
        Whose powers and slit are taken.
    wavelength : (K,) [m]
        Grid of that radiation.
    response : Dataset, contract 'response', optional

    Returns
    -------
    radiation : mapping condition -> Dataset, contract 'radiation', or 'spectrum' without a response
    variations : mapping condition -> Dataset, contract 'gas_variations'

    Raises
    ------
    ValueError
        A pressure beyond that range; else see `nitrogen_of` and `line_of_sight_radiance`.
    """
    pressure = float(within("chamber pressure", pressure, *PRESSURES, "Pa"))
    nitrogen = nitrogen_of(sightlines[around[0]])
    flow = conditions.number(radiation[around[0]], "chamber_pressure")
    ends = tuple(np.round(np.asarray(wavelength)[[0, -1]], 13))
    grid = {"wavelength_range": ends, "grid_points": round(FINER * len(wavelength))}
    table = stored_table(**grid, pressure=pressure, nitrogen=nitrogen)
    power = {name: conditions.number(one, conditions.POWER) for name, one in radiation.items()}
    found, varied = {}, {}
    for name in conditions.ladder(around[0], radiation):
        near = [abs(np.log(power[name] / power[one])) <= np.log(REACH) for one in around]
        if name not in sightlines or not (name in around or any(near)):
            continue
        line = at_pressure(sightlines[name], pressure / flow, nitrogen)
        line = line.assign_attrs(chamber_pressure=pressure)
        slit = float(radiation[name].attrs["slit_fwhm"])
        made = line_of_sight_radiance(line, response, **grid, slit_fwhm=slit, table=table)
        found[name] = made.assign_attrs({conditions.FLOW_PRESSURE: flow})
        if name in around and name in views:
            view = at_pressure(views[name], pressure / flow, nitrogen, "ray_")
            depth = {"pressure": pressure, "boundary_layer_depth": BOUNDARY_LAYER}
            varied[name] = gas_variations(line, view, made, table, **depth)
    return found, varied


def at_pressure(gas, factor, nitrogen, prefix=""):
    """A sight line, or the rays of a surface view (`prefix`), in equilibrium at `factor` times the pressure.

    The air of the laboratory, cold and dark, with it.
    """
    kelvin, pressure = gas[f"{prefix}temperature"], gas[f"{prefix}pressure"] * factor
    found = number_density(kelvin.values.ravel(), pressure.values.ravel(), nitrogen)
    density = kelvin.expand_dims(species=gas["species"], axis=-1).copy(data=found.reshape(*kelvin.shape, -1))
    return gas.assign(
        {
            f"{prefix}pressure": pressure,
            f"{prefix}number_density": density.transpose(*gas[f"{prefix}number_density"].dims),
        }
    )


def remarks(radiation):
    """What to know of a spectrum of `simulated_at`: a list of one sentence, or none."""
    flow = conditions.number(radiation, conditions.FLOW_PRESSURE) / MBAR
    own = conditions.number(radiation, "chamber_pressure") / MBAR
    if np.isnan(flow):
        return []
    return [
        f"the gas is simulated at the {own:.3g} mbar of the test along the temperatures of the flow at"
        f" {flow:.3g} mbar; a condition of that pressure solves its flow"
    ]
