"""Stages of the design: spectra of the gas in bins, and the pyrometers that it disturbs least."""

import numpy as np
import xarray as xr

from plasmapyro.design import candidates
from plasmapyro.design.judge import STATES, Judge, make_bench
from plasmapyro.design.spectra import HOTTEST, AirSpectra, heated
from plasmapyro.design.table import tabulate
from plasmapyro.gas.species import nitrogen_of
from plasmapyro.sightline.stage import surface_view


def gas_spectra(
    sightlines,
    flows,
    *,
    wavelength_range,
    grid_points,
    table_nodes,
    bin_width,
    temperature_change,
    thinning,
    mirror_angle,
    directions,
    core_angle,
    ray_points,
):
    """Binned spectra of every line of sight, as computed, colder and hotter, and of what hits the sample.

    ASSUME: the mirrored ray is the line of sight (axisymmetric jet). Conditions of one chamber pressure share
    an emission table; the pressure of the table sets line widths only.

    Parameters
    ----------
    sightlines, flows : mappings condition -> Dataset, contracts 'sightline' and 'flow'
    wavelength_range, bin_width : [m]
    grid_points, table_nodes : int
    temperature_change : float [1]
        Of the colder and hotter state, 0.05 for 5 %.
    thinning : int
        Every how many path points of a sight line are used; ends are kept.
    mirror_angle, core_angle : float [rad]
    directions, ray_points : int, as in `sightline.stage.surface_view`

    Returns
    -------
    Dataset, contract 'gas_spectra', sorted by power
    """
    views = {
        name: surface_view(
            flow,
            mirror_angle=mirror_angle,
            directions_count=directions,
            core_angle=core_angle,
            points=ray_points,
        )
        for name, flow in flows.items()
    }
    factors = (1 - temperature_change, 1 + temperature_change)
    hottest = max(
        *(float(case.temperature.max()) * factors[1] for case in sightlines.values()),
        *(float(view.ray_temperature.max()) for view in views.values()),
    )
    tables = {}
    own, incident = [], []
    for name, case in sightlines.items():
        # That of the chamber: at the stagnation point each power has its own, and would want its own table.
        pressure = float(flows[name].chamber_pressure)
        if pressure not in tables:
            tables[pressure] = AirSpectra(
                pressure,
                min(hottest, HOTTEST),
                wavelength_range=wavelength_range,
                grid_points=grid_points,
                nodes=table_nodes,
                bin_width=bin_width,
            )
        air = tables[pressure]
        points = np.unique(
            np.append(np.arange(0, case.sizes["path_distance"], thinning), case.sizes["path_distance"] - 1)
        )
        thin = case.isel(path_distance=points)
        states = [(thin.temperature.values, thin.number_density.values)]
        states += [
            heated(thin.temperature.values, thin.pressure.values, factor, nitrogen_of(thin))
            for factor in factors
        ]
        own.append([air.radiance(thin.path_distance.values, *state) for state in states])
        incident.append([own[-1][0].sum(axis=0), _diffuse(air, views[name])])
    spectra = xr.Dataset(
        {
            "binned_radiance": (("condition", "state", "component", "wavelength"), own),
            "incident_binned": (("condition", "reflection", "wavelength"), incident),
            "wavelength_edge": ("edge", air.edges),
            "component_uncertainty": ("component", air.uncertainty),
            "numerical_power": ("condition", [float(flow.numerical_power) for flow in flows.values()]),
        },
        {
            "condition": list(sightlines),
            "state": list(STATES),
            "component": list(air.components),
            "reflection": ["specular", "diffuse"],
            "wavelength": (air.edges[1:] + air.edges[:-1]) / 2,
        },
        {"origin": "modelled", "temperature_change": float(temperature_change)},
    )
    return spectra.sortby(["numerical_power", "condition"])


def _diffuse(air, view):
    """Hemispherical mean (B,) of the light that comes down on the stagnation point."""
    mean = 0.0
    for number in np.flatnonzero(view.ray_weight.values > 0):
        ray = view.isel(ray=number)
        distance = ray.ray_distance.values[::-1]
        radiance = air.radiance(
            distance[0] - distance,
            ray.ray_temperature.values[::-1],
            ray.ray_number_density.values[:, ::-1],
            apart=False,
        )
        mean = mean + float(ray.ray_weight) * radiance
    return mean


def band_design(spectra, response, tables, *, settings):
    """Search, confirm and rank pyrometers (contract 'band_design') by their errors behind the gas.

    What is minimised: the root mean square of the total error over conditions (each as computed, colder and
    hotter), temperatures and emittances. For a robust optimum, the excess of the change of its gain over the
    tolerance is added, in all gases of the bench and in that of 10 kW less and more. ASSUME: errors of
    different sources are independent. `response` is that of the reference instrument; `tables` and
    `settings`: see `settings`.
    """
    bench = make_bench(spectra, tables, settings)
    judge = Judge(bench, spectra.numerical_power.values, response, settings)
    found = [candidates.reference(response, judge)]
    found += candidates.searched(bench, judge, settings)
    optimum = min((entry for entry in found if entry.kind == "robust optimum"), key=lambda entry: entry.score)
    grid, cloud = candidates.brute_force(bench, judge, settings, optimum)
    found.append(grid)
    found += candidates.from_filters(bench, judge, tables["filters"], settings)
    found += candidates.on_the_shelf(bench, tables["pyrometers"])
    found += candidates.without_gas(bench, settings)
    result = tabulate(found, bench, judge, spectra, settings)
    result = result.assign(cloud)
    result.attrs |= {
        "origin": "modelled",
        "best_two_band": optimum.name,
        "lowest_two_band": min(
            (entry for entry in found if entry.kind == "optimum" and entry.centre.size == 2),
            key=lambda entry: entry.score,
        ).name,
        "error_level": float(judge.level),
        "limit_emittance": float(judge.emittance[0]),
    }
    return result
