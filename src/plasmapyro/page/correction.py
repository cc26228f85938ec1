"""The page of one corrected test: what contradicts itself, what came out, what was refused and why."""

import json
from functools import partial

import numpy as np

from plasmapyro.page import recommended
from plasmapyro.page.shell import SIZE, drawn, rendered, spoken
from plasmapyro.page.tables import table
from plasmapyro.page.words import DASH, number, without_folders
from plasmapyro.plots.one_test import TEMPERATURES, given, panels, statuses, thinned
from plasmapyro.record.recommended import SERIES
from plasmapyro.record.status import REASONS, WITH_VALUE
from plasmapyro.tables import rows as register

# title, caption, alternative
FIGURES = {row["figure"]: list(row.values())[1:] for row in register("page/figures.csv")}
JOINT = "surface_temperature"  # a line, the others are points
TALLER = {"temperatures": 4.2}  # [inch], for the legend below


def write_page(test, result, findings):
    """The page of a corrected test: one HTML text that needs nothing else, contradictions first.

    `result`: contract 'correction' or 'joint_estimate', as it was stored; `findings`: entries of
    `quality.rule.Finding`, the worst first. Style and figures (SVG) are inside; user text is escaped, folders
    of the machine are cut off; the same inputs give the same text.
    """
    words = without_folders(dict(result.attrs) | {"findings": findings})
    pictures, best = panels(test, result), result.attrs["recommended"]
    test, few = thinned(test), thinned(result)
    status, edge = "no temperature is recommended", "open"
    if best != "none":
        status, edge = recommended.headline("one temperature to take away", "fine", words["findings"], best)

    def draw(name, alternative, data=None):
        if name == "taken":
            return spoken(recommended.figure(few, _others(few)), alternative)
        size = (SIZE[0], TALLER.get(name, SIZE[1]))
        svg = drawn(partial(pictures[name], test=test, result=few), name, size)
        return spoken(svg, alternative)

    return rendered(
        "correction.html",
        title=words.get("title") or "A test",
        origin=words["origin"],
        version=words["plasmapyro_version"],
        attributes=words,
        findings=words["findings"],
        status=status,
        edge=edge,
        key_numbers=key_numbers(result),
        result=result,
        recommended=recommended,
        refused=refused(result),
        figures={name: FIGURES[name] for name in pictures},
        settings=table(
            ("setting", "value"),
            [(name, DASH if value is None else str(value)) for name, value in _settings(words)],
            stacked=False,
        ),
        sources=table(
            ("file", "SHA-256"), [line.split("  ")[::-1] for line in words["sources"].splitlines()]
        ),
        draw=draw,
    )


def _settings(attributes):
    return sorted(json.loads(attributes["configuration"]).get("correct", {}).items())


def _others(result):
    """The estimates beside the recommended one, as `recommended.figure` takes them."""
    best, _ = SERIES.get(result.attrs["recommended"], (None, None))
    same = {best, "spectrometer_temperature" if best == "scaled_temperature" else best}
    rows = [
        (words, result[axis].values, result[name].values, "." if name != JOINT else None, colour)
        for name, (axis, _, colour, words) in TEMPERATURES.items()
        if name in result and name not in same
    ]
    return [row for row in rows if np.isfinite(row[2]).any()]


def key_numbers(result):
    """Pairs of a value and what it is: of the temperature to take away, then of each other estimate."""
    boxes = recommended.key_numbers(result)
    best, _ = SERIES.get(result.attrs["recommended"], (None, None))
    for name in (one for one in given(result) if one != best):
        axis, state, _, words = TEMPERATURES[name]
        time, values = result[axis].values, result[name].values
        good = np.flatnonzero(recommended.counted(result[state].values) & np.isfinite(values))
        boxes.append((f"{good.size} of {time.size}", f"samples with a temperature: {words}"))
        if good.size:
            place = good[np.argmax(values[good])]
            half = 2 * float(result[f"{name}_uncertainty"].values[place])
            boxes.append((f"{values[place]:.0f} ± {half:.0f} K", f"highest, at {time[place]:.4g} s: {words}"))
    return boxes


def refused(result):
    """Every status of each temperature: how many samples, when, whether they have a value, and why."""
    rows = []
    for name in given(result):
        axis, state, _, words = TEMPERATURES[name]
        codes, time = result[state].values, result[axis].values
        for code, word in statuses(result[state]).items():
            here = time[codes == code]
            if here.size:
                value = "given" if code in WITH_VALUE else "none"
                when = " to ".join(number(moment, 4) for moment in dict.fromkeys(here[[0, -1]]))
                rows.append((words, word.replace("_", " "), here.size, when, value, REASONS[code] or DASH))
    return table(("temperature", "status", "#samples", "#first to last [s]", "value", "because"), rows)
