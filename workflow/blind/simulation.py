"""A simulation of the gas at another pressure, made by the package as a user of it would: run by `worker.py`.

Along the temperatures of the main job's sight lines: radiation of the powers that a test may have, variations
of those that the main job varies.
"""

from pathlib import Path

import numpy as np

BOUNDARY_LAYER = 5e-3  # [m] as `diagnosis.boundary_layer_depth_mm` of the configuration
# than the grid of the main job: NO shines in the colder gas of higher pressures, in narrower lines
FINER = 1.5
REACH = 1.35  # about a varied power: beyond the 30 % that are hidden of it


def simulate(results, folder, pressure):
    """Write `radiation` and `radiation_variations` of a pressure [Pa] into a folder."""
    from plasmapyro import conditions, io
    from plasmapyro.diagnosis.gas.stage import gas_variations
    from plasmapyro.gas.species import nitrogen_of
    from plasmapyro.radiation.stage import line_of_sight_radiance
    from plasmapyro.radiation.stored_table import stored_table

    results, folder, table = Path(results), Path(folder), None
    response = io.read(results / "instrument/response.nc", "response")
    known = {path.stem: io.read(path, "radiation") for path in (results / "radiation").glob("[!.]*.nc")}
    power = {name: conditions.number(one, conditions.POWER) for name, one in known.items()}
    varied = {path.stem for path in (results / "radiation_variations").glob("[!.]*.nc")}
    for name, one in known.items():
        if all(abs(np.log(power[name] / power[other])) > np.log(REACH) for other in varied):
            continue
        line = io.read(results / f"sightline/{name}.nc", "sightline")
        nitrogen = nitrogen_of(line)
        factor = pressure / conditions.number(line, "chamber_pressure")
        line = at_pressure(line, factor, nitrogen, "").assign_attrs(chamber_pressure=pressure)
        grid = {
            "wavelength_range": tuple(np.round(one["wavelength"].values[[0, -1]], 13)),
            "grid_points": round(FINER * one.sizes["wavelength"]),
        }
        if table is None:
            table = stored_table(**grid, pressure=pressure, nitrogen=nitrogen)
        slit = float(one.attrs["slit_fwhm"])
        made = line_of_sight_radiance(line, response, **grid, slit_fwhm=slit, table=table)
        io.write(made, folder / f"radiation/{name}.nc", "radiation")
        if name in varied:
            view = io.read(results / f"surface_view/{name}.nc", "surface_view")
            view = at_pressure(view, factor, nitrogen, "ray_")
            more = gas_variations(
                line, view, made, table, pressure=pressure, boundary_layer_depth=BOUNDARY_LAYER
            )
            io.write(more, folder / f"radiation_variations/{name}.nc", "gas_variations")


def at_pressure(gas, factor, nitrogen, prefix):
    """A sight line, or the rays of a surface view (`prefix`), in equilibrium at `factor` times the pressure.

    The air of the laboratory, cold and dark, with it.
    """
    from plasmapyro.gas.equilibrium import number_density

    kelvin, pressure = gas[f"{prefix}temperature"], gas[f"{prefix}pressure"] * factor
    found = number_density(kelvin.values.ravel(), pressure.values.ravel(), nitrogen)
    density = kelvin.expand_dims(species=gas["species"], axis=-1).copy(data=found.reshape(*kelvin.shape, -1))
    return gas.assign(
        {
            f"{prefix}pressure": pressure,
            f"{prefix}number_density": density.transpose(*gas[f"{prefix}number_density"].dims),
        }
    )
