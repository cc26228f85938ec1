"""The gas of a test simulated for it: at its pressure, behind its slit, along the temperatures of a flow."""

import numpy as np

from plasmapyro import conditions
from plasmapyro.checks import within
from plasmapyro.diagnosis.gas.stage import gas_variations
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import nitrogen_of
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.radiation.stored_table import stored_table
from plasmapyro.record.inputs import instruments

BOUNDARY_LAYER = 5e-3  # [m] as `diagnosis.boundary_layer_depth_mm` of the configuration
FINER = 1.5  # [1], grid over that of the simulations: NO shines in the colder gas of higher pressures
STORED_SLIT = "stored_slit_fwhm"  # attribute [m]: of the spectrum at hand
MBAR = 100.0  # [Pa]
PRESSURES = 1.5e3, 3e4  # [Pa] as `chamber_pressure_mbar` of a condition
REACH = 1.35  # [1], of powers about the one that a test ran at
# [1], slit of a test over the stored one, where a width s more shows half as clearly again: chi-squared goes
# as (s / slit)**4.
NARROWER = 0.9
FINEST = 0.5e-9  # [m] of a slit: behind 0.34 nm places of rotational lines err by 0.1 to 0.2 of the light


def slit_of(test, simulated):
    """Slit [m] behind which a test shows its gas: that of its spectrometer where clearly finer than that of a
    simulated spectrum, else the latter."""
    stored = float(simulated.attrs["slit_fwhm"])
    if "spectrometer" not in instruments(test):
        return stored
    own = max(float(test.attrs["spectrometer_fwhm"]), FINEST)
    return own if own < NARROWER * stored else stored


def simulated_for(pressure, slit, around, sightlines, views, radiation, *, wavelength, response=None):
    """Spectra at a pressure and behind a slit of the powers about some conditions, and variations of these.

    ASSUME: the temperatures of the simulated flows, and at another pressure equilibrium; a flow at that
    pressure differs from them nearly as one of another power does (`simulation.simulated.expected_power`).

    Parameters
    ----------
    pressure : float [Pa]
        Of the chamber, 1.5 to 30 kPa, as that of conditions.
    slit : float [m]
        Full width at half maximum.
    around : sequence of conditions
        That share all but the power.
    sightlines, views : mapping condition -> Datasets, contracts 'sightline' and 'surface_view'
        Variations are made where there is a view.
    radiation : mapping condition -> Dataset, contract 'radiation'
        Whose powers are taken.
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
    moved = pressure != flow
    ends = tuple(np.round(np.asarray(wavelength)[[0, -1]], 13))
    grid = {"wavelength_range": ends, "grid_points": round((FINER if moved else 1) * len(wavelength))}
    table = stored_table(**grid, pressure=pressure, nitrogen=nitrogen)
    power = {name: conditions.number(one, conditions.POWER) for name, one in radiation.items()}
    found, varied = {}, {}
    for name in conditions.ladder(around[0], radiation):
        near = [abs(np.log(power[name] / power[one])) <= np.log(REACH) for one in around]
        if name not in sightlines or not (name in around or any(near)):
            continue
        line, view, said = (
            sightlines[name],
            views.get(name),
            {STORED_SLIT: radiation[name].attrs["slit_fwhm"]},
        )
        if moved:
            line = at_pressure(line, pressure / flow, nitrogen).assign_attrs(chamber_pressure=pressure)
            view = None if view is None else at_pressure(view, pressure / flow, nitrogen, "ray_")
            said[conditions.FLOW_PRESSURE] = flow
        made = line_of_sight_radiance(line, response, **grid, slit_fwhm=slit, table=table)
        found[name] = made.assign_attrs(said)
        if name in around and view is not None:
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
    """What to know of a spectrum of `simulated_for`: a list of sentences, none of another spectrum."""
    said = []
    flow = conditions.number(radiation, conditions.FLOW_PRESSURE) / MBAR
    if np.isfinite(flow):
        own = conditions.number(radiation, "chamber_pressure") / MBAR
        said.append(
            f"the gas is simulated at the {own:.3g} mbar of the test along the temperatures of the flow at"
            f" {flow:.3g} mbar; a condition of that pressure solves its flow"
        )
    own, stored = (1e9 * conditions.number(radiation, name) for name in ("slit_fwhm", STORED_SLIT))
    if own < stored:
        said.append(
            f"the gas is simulated behind a slit of {own:.3g} nm, the spectra at hand of {stored:.3g} nm"
        )
    return said
