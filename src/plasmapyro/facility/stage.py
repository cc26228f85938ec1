"""Stages of the facility group: what probes read in each computed flow, and what measured pairs say of it."""

import json
import logging
from dataclasses import replace

import numpy as np
import xarray as xr

from plasmapyro import tables
from plasmapyro.checks import positive
from plasmapyro.facility.causes import causes, sentences
from plasmapyro.facility.jet import edge_ahead, jet_ahead, own_heat_flux, own_pressure
from plasmapyro.facility.prediction import GASES, MASS_FLOW, RADIUS
from plasmapyro.facility.probes import Calorimeter, density, enthalpy, heat_flux, pitot_pressure
from plasmapyro.facility.rebuild import Rebuilt, rebuild
from plasmapyro.facility.stagnation_line import solve
from plasmapyro.facility.verdict import judge

log = logging.getLogger(__name__)

TORCH_WALLS = ("back_wall", "tube_wall")
WIDE = 0.5  # of the radius of the torch: the hot core has that
ODD = 3.0  # ratio of what was measured and what was computed that asks for a second look
FINE = 0.005  # of the value: an uncertainty that is doubted
TOLD = {"W m-2": (1e3, "kW/m2"), "W": (1e3, "kW")}  # as the configuration says it


def probe_readings(
    flow, gas, *, rates, recombination, probe_radius, wall_temperature, pitot_radius, measured=None
):
    """What a calorimeter and Pitot probes read in one computed flow, beside what was measured there.

    Parameters
    ----------
    flow, gas : Datasets, contracts 'flow' and 'gas'
    rates : sequence of str
        Sets of reaction rates, see `kinetics`.
    recombination : sequence of float [1]
        Of the calorimeter, each computed from the solution of the one before.
    probe_radius : float [m]
        Of the hemisphere.
    wall_temperature : float [K]
    pitot_radius : sequence of float [m]
    measured : mapping, optional
        The key `measured` of a condition in SI: quantity -> mapping of value, uncertainty and probe. How
        each fits is logged in a sentence.

    Returns
    -------
    Dataset, contract 'probe_readings'
    """
    radius = float(positive("probe_radius", probe_radius, "m"))
    edge, jet = edge_ahead(flow, radius), jet_ahead(flow, radius)
    whole = solve(edge, radius, wall_temperature=wall_temperature, recombination=1.0, chemistry="equilibrium")
    flux = np.empty((len(rates), len(recombination)))
    lines = [None] * len(rates)
    for column, gamma in enumerate(recombination):
        wall = {"wall_temperature": wall_temperature, "recombination": gamma}
        for row, name in enumerate(rates):  # other rates start from the first
            lines[row] = solve(edge, radius, **wall, chemistry=name, start=lines[row] or lines[0])
            flux[row, column] = lines[row].heat_flux
    pitot = [pitot_pressure(jet, one, wall_temperature=wall_temperature, start=whole) for one in pitot_radius]
    scalars = {
        "numerical_power": float(flow.numerical_power),
        "own_heat_flux": own_heat_flux(flow, gas),
        "own_pressure": own_pressure(flow),
        "equilibrium_heat_flux": whole.heat_flux,
        "edge_temperature": edge.temperature,
        "edge_enthalpy": enthalpy(edge),
        "jet_speed": jet.speed,
    }
    found = xr.Dataset(
        {
            "stagnation_heat_flux": (("rates", "recombination"), flux),
            "pitot_pressure": ("pitot_radius", pitot),
            **{name: ((), value) for name, value in scalars.items()},
        },
        {"rates": list(rates), "recombination": list(recombination), "pitot_radius": list(pitot_radius)},
        {"probe_radius": radius, "wall_temperature": float(wall_temperature)},
    )
    if not measured:
        return found
    rows = [_beside(name, one, flow, edge, jet, rates[0]) for name, one in measured.items()]
    for name, row in zip(measured, rows, strict=True):
        log.info("%s: %s", name, _verdict(name, *row))
    if {"heat_flux", "pitot_pressure"} <= set(measured):
        said, there = _together(measured, rows, edge, jet, rates[0])
        log.info("heat_flux and pitot_pressure: %s", said)
        found = _with_causes(found, measured, there, float(flow.mass_flow_rate), rates[0])
    names = ("measured_value", "measured_uncertainty", "simulated_low", "simulated_high")
    values = np.array([row[1:] for row in rows], dtype=float).T
    return found.assign(
        {name: ("measurement", column) for name, column in zip(names, values, strict=True)}
        | {"measured_unit": ("measurement", [row[0] for row in rows])}
    ).assign_coords(measurement=list(measured))


def _beside(name, measured, flow, edge, jet, rates):
    """Unit, measured value and uncertainty, and the least and largest value that the flow gives."""
    known = measured["value"], measured["uncertainty"]
    torch = json.loads(flow.attrs["torch"])["radius"]
    if measured.get("radius", 0.0) > WIDE * torch:
        words = "%s: a probe of %g mm behind a torch of %g mm; the jet is taken as uniform around it"
        log.warning(words, name, 1e3 * measured["radius"], 1e3 * torch)
    if name == "heat_flux":
        there = replace(jet, temperature=edge.temperature)
        ends = [heat_flux(there, wall, rates)[0] for wall in _faces(measured)]
        return "W m-2", *known, min(ends), max(ends)
    if name == "pitot_pressure":
        reading = pitot_pressure(jet, measured["radius"], wall_temperature=measured["wall_temperature"])
        return "Pa", *known, reading, reading
    if name == "coil_current":
        return "A", *known, *2 * [float(flow.coil_current)]
    if name == "water_heat":
        heat = float(flow.boundary_heat_flow.sel(boundary=list(TORCH_WALLS)).sum())
        return "W", *known, heat, heat
    return "W", *known, *2 * [float(flow.numerical_power)]


def _faces(measured):
    """The calorimeter of a measured heat flux at both ends of its recombination."""
    probe = [measured[name] for name in ("radius", "shape", "wall_temperature")]
    return [Calorimeter(*probe, one) for one in measured["recombination"]]


def _verdict(name, unit, *values):
    """One measured quantity beside what the flow gives, in one sentence."""
    factor, unit = TOLD.get(unit, (1.0, unit))
    value, uncertainty, low, high = (one / factor for one in values)
    if name == "electric_power":
        said = f"{low:g} of {value:g} +- {uncertainty:g} {unit} reach the gas: efficiency {low / value:.2f}"
        return said + (", which no torch has: less power is in this gas" if low > value else "")
    found = f"{low:.4g}" if f"{low:.4g}" == f"{high:.4g}" else f"{low:.4g} to {high:.4g}"
    known = f"measured {value:g} +- {uncertainty:g} {unit}, simulated {found}"
    off = max(low - value, value - high, 0.0) / uncertainty
    way = "high" if low > value else "low"
    said = f"{known}: " + (f"{off:.1f} standard uncertainties too {way}" if off else "agrees")
    if uncertainty < FINE * value:
        said += f", with an uncertainty of {100 * uncertainty / value:.2g} %; is it in {unit}, not a share?"
    ratio = max(low / value, value / max(high, 1e-300))
    if ratio > ODD:
        whole = " and not with the chamber's pressure" if name == "pitot_pressure" else ""
        said += f", {ratio:.3g} times; was it written in {unit}{whole}?"
    return said


def _together(measured, rows, edge, jet, rates):
    """The jet that both measured values ask for, in one sentence beside that of the flow, and as a Jet.

    The Pitot probe reads as much more than the dynamic pressure as it does in the flow.
    """
    flux, pitot = measured["heat_flux"], measured["pitot_pressure"]["value"]
    reading = rows[list(measured).index("pitot_pressure")][-1]
    factor = (reading - jet.gauge_pressure) / (0.5 * density(jet) * jet.speed**2)
    try:
        found = [
            rebuild(
                flux["value"],
                pitot - jet.gauge_pressure,
                jet.pressure,
                face,
                chemistry=rates,
                pitot_factor=factor,
                nitrogen=jet.nitrogen,
            )
            for face in _faces(flux)
        ]
    except ValueError as fault:
        return str(fault), replace(jet, temperature=edge.temperature)
    found.sort(key=lambda one: one.temperature)
    here = Rebuilt(edge.temperature, enthalpy(edge), jet.speed)
    asked = [
        " to ".join(dict.fromkeys(f"{getattr(one, name) / scale:.4g}" for one in found))
        + f" {unit} (this flow {getattr(here, name) / scale:.4g})"
        for name, scale, unit in (("temperature", 1, "K"), ("enthalpy", 1e6, "MJ/kg"), ("speed", 1, "m/s"))
    ]
    asked_for = replace(jet, temperature=found[0].temperature, speed=found[0].speed)
    return "together they ask for a jet of " + ", ".join(asked), asked_for


def _with_causes(found, measured, jet, mass_flow, rates):
    """Readings with the probabilities of what can explain a pair in jets of the table; said in sentences."""
    flux, pitot = measured["heat_flux"], measured["pitot_pressure"]
    kinds = [name for name, nitrogen in GASES.items() if np.isclose(jet.nitrogen, nitrogen)]
    if not kinds or not np.isclose(mass_flow, MASS_FLOW, rtol=0.01):
        log.info("causes: not known, jets were computed in air and in nitrogen, with 16 g/s")
        return found
    face, standard = _faces(flux)[0], Calorimeter(RADIUS, recombination=flux["recombination"][0])
    share = (
        1.0 if face == standard else np.divide(*(heat_flux(jet, one, rates)[0] for one in (face, standard)))
    )
    try:
        known = causes(
            flux["value"] / share,
            pitot["value"],
            admissible=sorted(flux["recombination"]),
            flux_uncertainty=flux["uncertainty"] / flux["value"],
            pressure_uncertainty=pitot["uncertainty"] / pitot["value"],
            pressure=jet.pressure,
            gas=kinds[0],
            nose=2 * (pitot["radius"],),
        )
    except ValueError as fault:
        log.info("causes: not known, %s", fault)
        return found
    for sentence in sentences(known):
        log.info("causes: %s", sentence)
    probability = [one for one, _ in known.values()]
    return found.assign(cause_probability=("cause", probability)).assign_coords(cause=list(known))


def facility(readings, *, admissible_recombination, flux_uncertainty, pressure_uncertainty):
    """What measured pairs of heat flux and Pitot pressure say of a family of computed flows.

    Parameters
    ----------
    readings : mapping of condition -> Dataset, contract 'probe_readings'
    admissible_recombination : pair of float [1]
        Least and largest coefficient that the literature gives for the calorimeter.
    flux_uncertainty, pressure_uncertainty : float [1]
        Relative standard uncertainties of a pair.

    Returns
    -------
    Dataset, contract 'facility'
    """
    common = [one.drop_dims(["measurement", "cause"], errors="ignore") for one in readings.values()]
    found = xr.concat(common, xr.Variable("condition", list(readings)), combine_attrs="override")
    found = found.sortby(["own_pressure", "condition"])
    pairs = tables.load("facility/plasmatron_pairs")
    found = found.assign_coords(pair=list(pairs["pair"])).assign(
        pair_heat_flux=("pair", pairs["heat_flux"]),
        pair_pressure=("pair", pairs["dynamic_pressure"]),
        pair_flux_uncertainty=("pair", flux_uncertainty * pairs["heat_flux"]),
        pair_pressure_uncertainty=("pair", pressure_uncertainty * pairs["dynamic_pressure"]),
    )
    found.attrs["admissible_recombination"] = list(admissible_recombination)
    return judge(found, admissible_recombination)
