"""Tables and key numbers of a diagnosis as heads and rows; the template makes HTML of them."""

import json
from typing import NamedTuple

import numpy as np

from plasmapyro.page.words import DASH, kelvin, number, probability, with_error, with_unit
from plasmapyro.plots.colours import MISFIT
from plasmapyro.record.status import EXTRAPOLATED, VALID

CHANNELS = {
    "wide": "wide band",
    "narrow": "narrow band",
    "lines": "gas lines",
    "hump": "smooth",
    "red": "red end",
}
SHADES = tuple(zip((1e-4, 1e-3, 0.01, 0.05, 2.0), MISFIT, strict=True))  # of probabilities below
LEAST_COST = 0.5  # [K] below which nothing is asked for
SWITCH = 5.0  # [s] about the end of the plasma
DECIDED = 3.0  # of a log score: odds of 20
FURTHER = 0.01  # probability as the first answer below which a named cause explains what others leave


class Head(NamedTuple):
    """Head of a column; `number`: its cells are numbers."""

    label: str
    number: bool


class Table(NamedTuple):
    """Heads, and rows of (head, cell); `stacked`: on phones one card per row."""

    heads: list
    rows: list
    stacked: bool


def table(heads, rows, *, stacked=True):
    """A table from words for the heads (a leading '#' marks numbers) and rows of cells."""
    heads = [Head(words.lstrip("#"), words.startswith("#")) for words in heads]
    return Table(heads, [list(zip(heads, row, strict=True)) for row in rows], stacked)


def names(report):
    """Readable name of each id the report uses."""
    rows = *report["limits"], *report.get("given", ()), *report["candidates"]
    known = {row["id"]: row["name"] for row in rows}
    of_gas = {row["id"]: row["name"] for row in (report["show"].get("line_hump") or {}).get("tracks", ())}
    return (
        of_gas
        | known
        | {
            "none": "no cause is needed",
            "unknown": "something unknown",
            "path": "a longer path, or a mirror",
            "calibration": "the calibration of an instrument",
        }
    )


def named(report, ids):
    """Names of some ids in one line."""
    known = names(report)
    return ", ".join(known.get(identity, identity) for identity in ids)


POWER, FAR = "power", 3.0  # of synthetic gas; standard errors from which a simulated power is wrong
OWN = {"null": "none", "unknown": "unknown"}  # answer of a verdict without names


def key_numbers(report):
    """Pairs of a value and what it is, for the boxes below the verdict."""
    verdict, base, extended = report["verdict"], report["base"], report["extended"]
    boxes, several = [], len(verdict["named"]) > 1
    own, joint = OWN.get(verdict["status"]), verdict.get("joint_probability")
    if own in verdict["probability"]:
        boxes.append((probability(verdict["probability"][own]), f"probability: {named(report, [own])}"))
    elif joint is not None:
        words = "all named causes are right" if several else "the named cause is right"
        boxes.append((probability(joint), f"probability that {words}"))
    if verdict["named"] and extended and extended["applied"]:
        shift, causes = kelvin(verdict["temperature_shift"]), "causes" if several else "cause"
        boxes.append((shift, f"change of temperature by the named {causes}, at worst"))
    boxes += [
        (ratio(base) + (f" → {ratio(extended)}" if extended else ""), "χ² per degree of freedom"),
        (probability(verdict["p_base"]), "probability of such a misfit if nothing were wrong"),
    ]
    hidden = [row for row in report["limits"] if row["invisible"]]
    if hidden:
        worst = max(hidden, key=lambda row: abs(row["temperature_prior"]))
        size = kelvin(worst["temperature_prior"], signed=False)
        boxes.append((size, f"in the paper's correction, possible and invisible: {worst['name']}"))
    return boxes


def next_steps(report):
    """What to do next, most urgent first: sentences."""
    verdict, applied = report["verdict"], report["extended"] and report["extended"]["applied"]
    wrong = [one["remedy"] for one in report["findings"] if one["severity"] == "contradiction"]
    steps = [f"Before anything else: {remedy}." for remedy in wrong]
    steps += [
        f"{_capital(row['measurement'])}: it decides between {named(report, row['decides'])}."
        for row in verdict["missing_evidence"]
    ]
    if seen := verdict["unknown"]:
        who = {"both": "both instruments"}.get(seen["instrument"], f"the {seen['instrument']}")
        steps.append(f"Look at the light of {who} along {seen['axis']}: something unknown is seen there.")
    if verdict["status"] == "not-adequate":
        steps.append("See first whether condition, clock, emittance and calibration are those of this test.")
    unseen = [row for row in report["limits"] if row["invisible"] and row["temperature_prior"] >= LEAST_COST]
    for row in sorted(unseen, key=lambda row: -row["temperature_prior"])[:2]:
        cost = kelvin(row["temperature_prior"], signed=False)
        words = f"it would show an error of {cost} of the paper's correction that these data hide"
        steps.append(f"{_capital(row['measurement'])}: {words} ({row['name']}).")
    if applied:
        steps.append("Take what was named into the next fit: terms.yaml with --with, or as its effects.")
    return steps


def _capital(words):
    return words[:1].upper() + words[1:]


def hidden(report, truth):
    """Of a synthetic test: what was hidden, what was found."""
    known, rows = names(report), []
    entries = {row["id"]: row for row in report["candidates"]}
    given = {row["id"]: row for row in report.get("given", ())}
    planted = json.loads(truth.attrs.get("hidden", "[]"))
    for one in planted:
        row, way = entries.get(one["effect"]), "found"
        found = one["effect"] in report["verdict"]["named"] and row is not None
        if one["effect"] in given and not found:
            row, way, found = given[one["effect"]], "taken as given", True
        if one["effect"] == POWER:
            row = _power(report["simulation"])
            found = abs(row["amplitude"]) > FAR * row["standard_error"]
        size = with_error(row["amplitude"], row["standard_error"], row["unit"]) if found else DASH
        said = way if found else "not named"
        if found and row["standard_error"]:
            apart = abs(row["amplitude"] - one["amplitude"]) / row["standard_error"]
            said = f"{way}, {apart:.1f} standard errors off"
        if one["effect"] == POWER and given and not found:
            said = "nothing of it is left"
        rows.append((known.get(one["effect"], one["effect"]), number(one["amplitude"]), size, said))
    ids = {one["effect"] for one in planted}
    for identity in report["verdict"]["named"]:
        if identity not in ids:
            row = entries[identity]
            size = with_error(row["amplitude"], row["standard_error"], row["unit"])
            rows.append((known.get(identity, identity), "nothing", size, "a false name"))
    return table(("effect", "#hidden", "#found", ""), rows)


def _power(simulation):
    """What the gas says of its power, as an entry: relative change and standard error."""
    power = simulation["power"]
    return {"amplitude": power - 1, "standard_error": power * simulation["power_error"], "unit": "1"}


def errors(truth, temperature):
    """Of a synthetic test: root mean squares of the errors [K] of each temperature, where one is given."""
    time = temperature["time_bin"].values
    good = np.isin(temperature["recommended_status"].values, (VALID, EXTRAPOLATED))
    true = np.interp(time, truth["time"].values, truth["surface_temperature"].values)
    # A bin that holds a switch of the plasma has no one temperature to compare with.
    off = truth.attrs.get("plasma_off_time", temperature.attrs.get("plasma_off_time"))
    if off is not None:
        good &= np.abs(time - float(off)) > SWITCH
    rows = []
    for name, words in (
        ("paper", "the paper's correction"),
        ("base", "base model"),
        ("recommended", "to take away"),
    ):
        apart = (temperature[f"{name}_temperature"].values - true)[good]
        apart = apart[np.isfinite(apart)]
        if apart.size:
            size = f"{np.sqrt(np.mean(apart**2)):.2g} K"
            rows.append((words, size, f"{np.max(np.abs(apart)):.2g} K"))
    low, high = temperature["recommended_temperature_interval"].values[:, good]
    inside = np.mean((low <= true[good]) & (true[good] <= high)) if good.any() else np.nan
    return table(("temperature", "#root mean square error", "#largest error"), rows), inside


def candidates(report, most=15):
    """Candidates in the order of the report (kelvin first)."""
    heads = ("cause", "#paper's T", "#base T", "amplitude", "#gain in χ²", "#as first answer", "most like it")
    rows = []
    for row in report["candidates"][:most]:
        mark = " ★" if row["id"] in report["verdict"]["named"] else ""
        alike, share = DASH, probability(row["probability"])
        if row["angle_to_next"] is not None and row["next"]:
            alike = f"{named(report, [row['next']])}, {number(row['angle_to_next'], 2)}°"
        if mark and row["probability"] < FURTHER:
            share = "beside it"
        size = with_error(row["amplitude"], row["standard_error"], row["unit"])
        seen = row["significance"] > 0
        rows.append(
            (
                row["name"] + mark,
                kelvin(row["temperature_shift"]["paper"]),
                kelvin(row["temperature_shift"]["base"]),
                row["amplitude_name"] + ": " + size if seen else "the base model takes it up",
                number(row["gain_chi2"]) if seen else DASH,
                share,
                alike,
            )
        )
    return table(heads, rows)


def ambiguity(report):
    """Measurements that would tell apart what the data do not."""
    rows = []
    for row in report["verdict"]["missing_evidence"]:
        expected = row["expected_significance"]
        size = DASH if expected is None else f"{number(expected, 2)} sd"
        rows.append((row["measurement"], named(report, row["decides"]), size))
    return table(("measurement", "decides between", "#expected"), rows)


def following(report):
    """Measurements that may follow, the one that takes most from the uncertainty first."""
    first = report["next"][0]
    rows = [
        (
            row["measurement"],
            f"{number(row['kelvin_after'], 2)} K",
            DASH if row is first else f"{number(row['after_first'], 2)} K",
            "; ".join(named(report, group) for group in row["resolves"]) or DASH,
        )
        for row in report["next"]
    ]
    heads = ("measurement", "#then T is known to", "#with the first one too", "tells apart")
    told = len(heads) if any(row["resolves"] for row in report["next"]) else -1
    return table(heads[:told], [row[:told] for row in rows])


def limits(report, most=12):
    """What remains possible and invisible, by kelvin."""
    heads = (
        "cause",
        "#T error when just seen (5 sd)",
        "#T error of a usual size",
        "#amplitude just seen",
        "would a usual size be seen?",
        "measurement that would show it",
    )
    rows = [
        (
            row["name"],
            kelvin(row["temperature_5sigma"], signed=False),
            kelvin(row["temperature_prior"], signed=False),
            with_unit(row["amplitude_5sigma"], row["unit"]),
            "no" if row["invisible"] else "yes",
            row["measurement"],
        )
        for row in report["limits"][:most]
    ]
    return table(heads, rows)


def ratio(fit):
    """Chi-squared per degree of freedom, two places."""
    return f"{fit['chi2'] / max(fit['dof'], 1):.2f}"


def systems(report):
    """Measured over simulated light of the gas, by radiating system and multiplet."""
    heads = (
        "radiating system",
        "#wavelengths [nm]",
        "#measured over simulated",
        "#by the best power",
        "#remains",
        "#stated by the simulation",
        "beyond what it states",
    )
    rows = [
        (
            row["name"],
            " to ".join(f"{end * 1e9:.0f}" for end in row["wavelength"]),
            f"{row['ratio']:.2f} ± {row['error']:.2f}",
            f"{row['by_power']:.2f}",
            f"{row['ratio'] / row['by_power'] - 1:+.0%}",
            f"± {row['stated']:.0%}",
            "yes" if row["beyond"] else "no",
        )
        for row in report["simulation"]["systems"]
    ]
    return table(heads, rows)


def gain(report):
    """What the extension is worth on data not used for it."""
    entry, extended = report["gain"], report["extended"]
    better = sum(block["difference"] > 0 for block in entry["blocks"])
    sigmas = (number(entry[f"temperature_sigma_{model}"], 2) for model in ("base", "extended"))
    sure = entry["heldout_log_score"] / max(entry["heldout_standard_error"], 1e-9)
    each = entry["heldout_log_score"] / max(report["base"]["dof"], 1)
    rows = [
        (
            "data left out of the fit",
            f"foretold better by {sure:.1f} standard errors"
            if sure > 0
            else f"foretold worse by {-sure:.1f} standard errors",
        ),
        ("odds of each such value, with what was named over without", f"{np.exp(each):.3f}"),
        ("blocks of time that are foretold better", f"{better} of {len(entry['blocks'])}"),
        ("one instrument foretold by the other", _foretold(entry["cross_instrument"])),
        ("tests at another condition", _foretold(entry["cross_condition"])),
        (
            "step at plasma-off over reference, before and after",
            f"{number(entry['kappa_before'])} and {number(entry['kappa_after'])}",
        ),
        ("worst change of temperature", kelvin(entry["temperature_shift"])),
        ("standard deviation of temperature, before and after", " and ".join(sigmas) + " K"),
        ("χ² per degree of freedom, before", ratio(report["base"])),
    ]
    if extended:
        rows.append(("χ² per degree of freedom, after", ratio(extended)))
    return table(("measure", "#value"), rows, stacked=False)


def _foretold(score):
    """A log score in words."""
    if score is None or not np.isfinite(score):
        return DASH
    return "better" if score > DECIDED else "worse" if score < -DECIDED else "no difference"


class Cell(NamedTuple):
    """A value on a shade, with words for who points at it."""

    value: str
    shade: str = ""
    title: str = ""


def phases(report):
    """Heads and rows of chi-squared per datum by phase and channel, shaded by its calibrated p-value."""
    found = {(row["phase"], row["channel"]): row for row in report["base"]["by_phase"]}
    present = {channel for _, channel in found}
    channels = [one for one in CHANNELS if one in present] + sorted(present - set(CHANNELS))

    def cell(row):
        if row is None or not row["count"]:
            return Cell(DASH)
        shade = next(colour for limit, colour in SHADES if row["p"] < limit)
        return Cell(number(row["chi2"] / row["count"]), shade, f"p = {row['p']:.2g}, {row['count']} data")

    rows = [
        (phase["name"], [cell(found.get((phase["id"], channel))) for channel in channels])
        for phase in report["dataset"]["phases"]
    ]
    return {"heads": [CHANNELS.get(one, one) for one in channels], "rows": rows}


def lines_left(report):
    """Species whose lines or bands explain light that the model leaves, and how to keep each."""
    rows = []
    for line in report["discrepancy"]["lines"]:
        effect = line["effect"]
        share = " ± ".join(number(effect[key], 2) for key in ("amplitude", "uncertainty"))
        places = ", ".join(number(place * 1e9, 5) for place in line["lines"])
        rivals = ", ".join(line["rivals"]) or DASH
        rows.append((line["species"], probability(line["probability"]), places, rivals, share, effect["id"]))
    heads = (
        "species",
        "#probability",
        "strongest lines [nm, air]",
        "or else",
        "#tenths of O I 777",
        "effect",
    )
    return table(heads, rows)


def component_words(report, entry):
    """How much a leading pattern of the residuals stands out, and what it resembles."""
    known = names(report)
    like = ", ".join(
        f"{known.get(one['id'], one['id'])} ({one['cosine']:.2f})" for one in entry["resembles"][:3]
    )
    size = f"Singular value {entry['singular_value']:.3g}; noise alone would give {entry['expected']:.3g}."
    return size + (f" Resembles (cosine): {like}." if like else "")


def method(report):
    """Pairs of a title and a table of how it was judged."""
    tests = [
        (row["name"], number(row["statistic"]), number(row["threshold"]), probability(row["p"]))
        for row in report["tests"]
    ]
    pulls = [
        (
            row["name"],
            with_unit(row["value"], row["unit"], 3),
            f"± {number(row['sigma'], 2)}",
            f"{number(row['pull'], 2)} sd",
            "a finding" if row["finding"] else "",
        )
        for row in report["base"]["pulls"]
    ]
    unknown = [
        (row["name"], number(row["log_bayes"]))
        for row in sorted(report["discrepancy"]["per_class"], key=lambda row: -row["log_bayes"])
    ]
    noise = [
        (
            row["channel"],
            f"{number(100 * row['relative'], 2)} %",
            number(row["lag1"], 2),
            number(row["tail"], 2),
        )
        for row in report["noise"]
    ]
    of_noise = (
        "channel",
        "#standard deviation at the median",
        "#correlation of neighbours",
        "#samples beyond 4 standard deviations, over those of a normal law",
    )
    made = (
        ("Tests", table(("test", "#statistic", "#threshold", "#p"), tests)),
        (
            "Parameters of the base model",
            table(("parameter", "#fitted change", "#known to", "#pull", ""), pulls),
        ),
        ("Structures without a name", table(("structure", "#log Bayes factor"), unknown, stacked=False)),
        ("Noise", table(of_noise, noise)),
    )
    return [(title, found) for title, found in made if found.rows]


def provenance(report):
    """Where everything came from."""
    entry, thresholds = report["provenance"], report["thresholds"]
    rows = [
        ("program", f"plasmapyro {entry['version']}"),
        ("commit", entry["commit"] or DASH),
        ("seed", str(entry["seed"])),
        (
            "thresholds",
            f"effect {number(thresholds['effect'])}, unknown {number(thresholds['unknown'])}, further effect"
            f" {number(thresholds['third'])}; from {thresholds['nulls']} simulated tests with nothing wrong,"
            f" level {number(thresholds['level'])}, seed {thresholds['seed']}",
        ),
        ("blind tests of this version", entry["blind_score"] or DASH),
        *sorted(entry["files"].items()),
    ]
    return table(("", ""), rows, stacked=False)
