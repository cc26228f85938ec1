"""A main job in half a minute: the radiation engine on three invented jets, for blind tests of the suite."""

import numpy as np
import xarray as xr
from half_disc import flow
from two_bands import RESPONSE

from plasmapyro import io
from plasmapyro.conditions import stated
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.stage import line_of_sight_radiance

PRESSURE = 5000.0  # [Pa]
DISTANCE = np.concatenate([np.linspace(0.0, 0.006, 7), np.linspace(0.012, 0.16, 14)])


def sight_line(power):
    """A jet whose core warms with the power, cold at both ends."""
    core = 5950.0 * (power / 80e3) ** 0.12
    shape = -np.expm1(-DISTANCE / 0.0025) * np.exp(-((DISTANCE / 0.125) ** 6))
    temperature = 350.0 + (core - 350.0) * shape
    density = number_density(temperature, np.full(temperature.size, PRESSURE))
    return xr.Dataset(
        {
            "temperature": ("path_distance", temperature),
            "pressure": ("path_distance", np.full(temperature.size, PRESSURE)),
            "number_density": (("species", "path_distance"), density.T),
        },
        {"path_distance": DISTANCE, "species": list(SPECIES)},
        {"origin": "modelled", **stated(gas="air", settings={}, numerical_power=power)},
    )


def surface_view(line):
    """The light that meets the surface: as the sight line, mirrored, and from straight above."""
    two = {"ray": 2}
    both = {
        name: xr.concat([line[name].rename(path_distance="node")] * 2, "ray").values
        for name in ("temperature", "pressure")
    }
    density = line.number_density.rename(path_distance="node").values
    return xr.Dataset(
        {
            "ray_angle": ("ray", [0.61, 0.0]),
            "ray_weight": ("ray", [0.0, 1.0]),
            "ray_distance": (("ray", "node"), np.stack([DISTANCE] * two["ray"])),
            "ray_temperature": (("ray", "node"), both["temperature"]),
            "ray_pressure": (("ray", "node"), both["pressure"]),
            "ray_number_density": (("ray", "species", "node"), np.stack([density] * two["ray"])),
        },
        {"species": list(SPECIES)},
    )


def make_results(folder):
    """The files of a small main job: three powers, their variations, the response, the composition."""
    from plasmapyro.diagnosis.gas.stage import gas_variations

    for power in (50e3, 80e3, 130e3):
        name, line = f"{power / 1e3:.0f}kW.nc", sight_line(power)
        radiation = line_of_sight_radiance(
            line, RESPONSE, wavelength_range=(700e-9, 1200e-9), grid_points=160_000, slit_fwhm=0.75e-9
        )
        io.write(line, folder / "sightline" / name, "sightline")
        (folder / "flow").mkdir(parents=True, exist_ok=True)
        kelvin = line.temperature.values
        field = flow(lambda away, kelvin=kelvin: np.interp(away, DISTANCE, kelvin), DISTANCE)
        field.to_netcdf(folder / "flow" / name)
        io.write(radiation, folder / "radiation" / name, "radiation")
        if power == 80e3:
            view = surface_view(line)
            varied = gas_variations(line, view, radiation, pressure=PRESSURE, boundary_layer_depth=5e-3)
            io.write(varied, folder / "radiation_variations" / name, "gas_variations")
    io.write(RESPONSE, folder / "instrument/response.nc", "response")
    table = np.arange(300.0, 15000.0, 50.0)
    density = number_density(table, np.full(table.size, PRESSURE))
    fraction = density / density.sum(axis=1, keepdims=True)
    (folder / "gas").mkdir()
    xr.Dataset(
        {"mole_fraction": (("pressure", "temperature", "species"), fraction[None])},
        {"pressure": [PRESSURE], "temperature": table, "species": list(SPECIES)},
    ).to_netcdf(folder / "gas/air11.nc")
    return folder
