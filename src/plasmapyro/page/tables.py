"""Tables and key numbers of a diagnosis as heads and rows; the template makes HTML of them."""

from typing import NamedTuple

from plasmapyro.page.words import (
    DASH,
    kelvin,
    number,
    probability,
    with_error,
    with_unit,
)
from plasmapyro.plots.colours import MISFIT

CHANNELS = {
    "wide": "wide band",
    "narrow": "narrow band",
    "lines": "gas lines",
    "hump": "smooth",
    "red": "red end",
}
SHADES = tuple(zip((1e-4, 1e-3, 0.01, 0.05, 2.0), MISFIT, strict=True))  # of probabilities below
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
    known = {row["id"]: row["name"] for row in (*report["limits"], *report["candidates"])}
    return known | {
        "none": "nothing is wrong",
        "unknown": "something unknown",
        "path": "a longer path, or a mirror",
        "calibration": "the calibration of an instrument",
    }


def named(report, ids):
    """Names of some ids in one line."""
    known = names(report)
    return ", ".join(known.get(identity, identity) for identity in ids)


def key_numbers(report):
    """Pairs of a value and what it is, for the boxes beside the verdict."""
    verdict, base, extended = report["verdict"], report["base"], report["extended"]
    boxes = []
    if verdict["probability"]:
        answer, share = max(verdict["probability"].items(), key=lambda pair: pair[1])
        first = "probability of the first answer" if len(verdict["named"]) > 1 else "probability"
        boxes.append((probability(share), f"{first}: {named(report, [answer])}"))
    causes = "causes" if len(verdict["named"]) > 1 else "cause"
    boxes += [
        (kelvin(verdict["temperature_shift"]), f"change of temperature by the named {causes}, at worst"),
        (ratio(base) + (f" → {ratio(extended)}" if extended else ""), "χ² per degree of freedom"),
        (probability(verdict["p_base"]), "probability of such a misfit if nothing were wrong"),
    ]
    hidden = [row for row in report["limits"] if row["invisible"]]
    if hidden:
        worst = max(hidden, key=lambda row: abs(row["temperature_prior"]))
        size = kelvin(worst["temperature_prior"], signed=False)
        boxes.append((size, f"possible and invisible: {worst['name']}"))
    return boxes


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
    return table(heads, rows)


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
        "#from to [nm]",
        "#measured over simulated",
        "#by the best power",
        "#remains",
        "#stated by the simulation",
        "beyond",
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
    score = with_error(entry["heldout_log_score"], entry["heldout_standard_error"])
    rows = [
        ("log score of held-out blocks", score),
        ("held-out blocks that improve", f"{better} of {len(entry['blocks'])}"),
        ("log score of the other instrument", number(entry["cross_instrument"])),
        ("log score of another power condition", number(entry["cross_condition"])),
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
        "#tail, 1 is normal",
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
