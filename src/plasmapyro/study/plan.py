"""What a parameter study asks for: its conditions, their flows and sight lines, and which flow starts where.

A condition is a power, a pressure, a mass flow rate, an emittance and an angle of the line of sight. Those of
one power, pressure and mass flow rate share a flow; those of one flow and angle share a sight line.
"""

from collections import Counter
from dataclasses import dataclass
from itertools import product
from math import atan2, degrees, prod, radians, sin

import numpy as np

from plasmapyro.configuration import ConfigurationError
from plasmapyro.flow.condition import STEP

AXES = ("numerical_power_kw", "chamber_pressure_mbar", "mass_flow_rate_g_s", "emittance", "angle_deg")
FLOW_AXES = AXES[:3]
DEFAULT_LIMIT = 1000  # conditions, where the study names no limit of its own
DIGITS = 10  # of a value in a name: values that agree in these are one value


@dataclass(frozen=True)
class Plan:
    """The jobs of a study.

    `flows`: name -> values of FLOW_AXES; `chains`: name -> names of the flows it may start from, the nearest
    on the way back to the cold start first; `sight_lines`: name -> (name of the flow, angle [deg]);
    `conditions`: tuples of the five values in the order of AXES.
    """

    flows: dict
    chains: dict
    sight_lines: dict
    conditions: tuple

    def level(self, flow):
        """Flows that have to be known before this one: 0 for one that continues from the cold start."""
        return len(self.chains[flow])


def make(study, start, power_step_kw):
    """The Plan of a study, the key `study` of the configuration.

    `start`: values of FLOW_AXES at the cold start; `power_step_kw`: largest step of power in one part of a
    continuation. ConfigurationError: more conditions than the limit, two values of an axis that cannot be
    told apart, a condition given twice.
    """
    axes = {axis: list(study["axes"][axis]) for axis in AXES}
    extra = [tuple(one[axis] for axis in AXES) for one in study.get("extra", [])]
    _within_limit(axes, len(extra), study.get("limit", DEFAULT_LIMIT))
    for place, (axis, values) in enumerate(axes.items()):
        _told_apart(f"study.axes.{axis}", [_text(value) for value in values])
        _told_apart(f"study, {axis}", [_text(value) for value in {*values, *(one[place] for one in extra)}])
    conditions = (*product(*axes.values()), *extra)
    twice = [one for one, count in Counter(conditions).items() if count > 1]
    _told_apart("study.extra", [", ".join(map(_text, one)) for one in twice for _ in range(2)])
    places = sorted({one[: len(FLOW_AXES)] for one in conditions})
    flows = {flow_name(place): dict(zip(FLOW_AXES, place, strict=True)) for place in places}
    lines = sorted({(*one[: len(FLOW_AXES)], one[-1]) for one in conditions})
    sight_lines = {sight_line_name(line): (flow_name(line), line[-1]) for line in lines}
    chains = starting_tree(flows, start, power_step_kw, study["longest_chain"])
    return Plan(flows, chains, sight_lines, conditions)


def in_si(axes, extra):
    """All conditions (N, 5) of a study in SI, the angle in radians, columns in the order of AXES."""
    rows = [*product(*(axes[axis] for axis in AXES)), *(tuple(one[axis] for axis in AXES) for one in extra)]
    return np.array(rows, dtype=float) * (1e3, 100.0, 1e-3, 1.0, np.pi / 180)


def flow_name(condition):
    """Name of the flow of a condition (its values begin with FLOW_AXES); stands in file names."""
    power, pressure, rate = map(_text, condition[:3])
    return f"{power}kW_{pressure}mbar_{rate}gs"


def sight_line_name(condition):
    """Name of the sight line of a condition (its values begin with FLOW_AXES, end with the angle)."""
    return f"{flow_name(condition)}_{_text(condition[-1])}deg"


def starting_tree(flows, start, power_step_kw, longest_chain):
    """For each flow the flows it may start from: its parent, the parent's parent, ... without the cold start.

    The parent is the known flow that needs the fewest parts of a continuation (see `flow.condition`); of
    those the one with the shortest chain behind it; of those the nearest. Known are the cold start, and the
    flows nearer to it than this one whose own chain is not the longest allowed, a number of flows >= 0. So a
    study of any size has no chain longer than `longest_chain`, and most of its flows can be computed side by
    side.
    """
    names, origin = list(flows), np.array(_place(start, power_step_kw))
    places = np.array([_place(one, power_step_kw) for one in flows.values()])
    distance = _parts(origin, places)
    # Known flows so far: the cold start first, which has no name.
    known, depth, whose = np.empty((len(names) + 1, origin.size)), np.zeros(len(names) + 1, int), [None]
    known[0] = origin
    chains = {}
    for index in np.lexsort((np.arange(len(names)), distance)):
        count = len(whose)
        parts = _parts(known[:count], places[index])
        whole = np.maximum(np.ceil(parts - 1e-9), 1)
        best = np.flatnonzero(whole == whole.min())
        best = best[depth[best] == depth[best].min()]
        parent = whose[best[np.argmin(parts[best])]]
        chains[names[index]] = () if parent is None else (parent, *chains[parent])
        if len(chains[names[index]]) < longest_chain:
            known[count], depth[count] = places[index], len(chains[names[index]]) + 1
            whose.append(names[index])
    return {name: chains[name] for name in names}


def check(config):
    """Refuse a study whose values are right one by one but do not fit the rest of the configuration.

    ConfigurationError names every value that does not fit, and the rule.
    """
    study, torch, view = config["study"], config["flow"]["torch"], config["sightline"]
    values = {axis: [*study["axes"][axis], *(one[axis] for one in study.get("extra", []))] for axis in AXES}
    lowest, highest = min(config["gas"]["pressure_mbar"]), max(config["gas"]["pressure_mbar"])
    faults = [
        f"chamber_pressure_mbar: {value} mbar lies outside gas.pressure_mbar ({lowest} to {highest} mbar)"
        for value in values["chamber_pressure_mbar"]
        if not lowest <= value <= highest
    ]
    radius, window = torch["chamber_radius_mm"], view["window_distance_mm"]
    least = degrees(atan2(radius, torch["probe_distance_mm"]))
    for value in values["angle_deg"]:
        if value <= least:
            faults.append(
                f"angle_deg: {value} deg; a line of sight this close to the axis ends at the torch instead of"
                f" leaving the chamber: more than {least:.3g} deg"
            )
        elif radius / sin(radians(value)) >= window:
            faults.append(
                f"angle_deg: {value} deg; its line of sight leaves the simulated chamber behind the window"
                f" (sightline.window_distance_mm: {window} mm)"
            )
    if faults:
        raise ConfigurationError("\n  ".join(["the study does not fit the configuration:", *faults]))


def _text(value):
    return f"{value:.{DIGITS}g}"


def _within_limit(axes, extra_count, limit):
    count = prod(len(values) for values in axes.values()) + extra_count
    if count > limit:
        sizes = " x ".join(f"{len(values)} {axis}" for axis, values in axes.items())
        raise ConfigurationError(
            f"study: {count} conditions ({sizes}, {extra_count} extra) are more than the limit of {limit};"
            f" shorten an axis, or set study.limit to {count} or more if you mean it"
        )


def _told_apart(key, texts):
    twice = [text for text, count in Counter(texts).items() if count > 1]
    if twice:
        raise ConfigurationError(
            f"{key}: {'; '.join(twice)} is given twice (values that agree in {DIGITS} digits are one value)"
        )


def _place(values, power_step_kw):
    """Coordinates whose largest difference between two conditions is the number of parts between them."""
    power, pressure, rate = (float(values[axis]) for axis in FLOW_AXES)
    return (
        power / power_step_kw,
        np.log(power) / STEP["numerical_power"],
        np.log(pressure) / STEP["chamber_pressure"],
        np.log(rate) / STEP["mass_flow_rate"],
    )


def _parts(here, there):
    return np.abs(here - there).max(axis=-1)
