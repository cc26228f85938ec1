"""Tables of a diagnosis as HTML."""

from plasmapyro.page.words import (
    DASH,
    file_name,
    kelvin,
    number,
    probability,
    text,
    with_error,
    with_unit,
)

CHANNELS = {
    "wide": "wide band",
    "narrow": "narrow band",
    "lines": "gas lines",
    "hump": "smooth",
    "red": "red end",
}


def table(heads, rows, *, stacked=True):
    """A table from heads (a leading '#' marks numbers) and rows of HTML cells; on phones one card per row."""
    numeric = [head.startswith("#") for head in heads]
    labels = [head.lstrip("#") for head in heads]

    def cell(value, label, is_number):
        kind = " class=n" if is_number else ""
        return f'<td{kind} data-label="{text(label)}">{value}</td>'

    head = "".join(
        f'<th scope="col"{" class=n" if one else ""}>{text(label)}</th>'
        for label, one in zip(labels, numeric, strict=True)
    )
    body = "".join(
        "<tr>" + "".join(cell(*one) for one in zip(row, labels, numeric, strict=True)) + "</tr>"
        for row in rows
    )
    kind = ' class="stack"' if stacked else ""
    return f'<div class="wide"><table{kind}><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def names(report):
    """Readable name of each id the report uses."""
    known = {row["id"]: row["name"] for row in report["limits"]}
    known |= {row["id"]: row["name"] for row in report["candidates"]}
    return known | {
        "none": "nothing is wrong",
        "unknown": "something unknown",
        "path": "a longer path, or a mirror",
        "calibration": "the calibration of an instrument",
    }


def candidates(report, most=15):
    """Candidates in the order of the report (kelvin first)."""
    known, rows = names(report), []
    for row in report["candidates"][:most]:
        angle = row["angle_to_next"]
        alike = DASH
        if angle is not None and row["next"]:
            alike = f"{text(known.get(row['next'], row['next']))}, {number(angle, 2)}°"
        mark = " ★" if row["id"] in report["verdict"]["named"] else ""
        rows.append(
            (
                f"{text(row['name'])}{mark}",
                kelvin(row["temperature_shift"]["paper"]),
                kelvin(row["temperature_shift"]["base"]),
                text(row["amplitude_name"])
                + ": "
                + with_error(row["amplitude"], row["standard_error"], row["unit"]),
                number(row["gain_chi2"]),
                probability(row["probability"]),
                alike,
            )
        )
    heads = ("cause", "#paper's T", "#base T", "amplitude", "#gain in χ²", "#probability", "most like it")
    return table(heads, rows)


def ambiguity(report):
    """What the data cannot tell apart, and the measurement that would."""
    known, rows = names(report), []
    for row in report["verdict"]["missing_evidence"]:
        expected = row["expected_significance"]
        rows.append(
            (
                text(row["measurement"]),
                text(", ".join(known.get(one, one) for one in row["decides"])),
                f"{number(expected, 2)} sd" if expected is not None else DASH,
            )
        )
    return table(("measurement", "decides between", "#expected"), rows) if rows else ""


def limits(report, most=12):
    """What remains possible and invisible, by kelvin."""
    rows = [
        (
            text(row["name"]),
            kelvin(row["temperature_5sigma"], signed=False),
            kelvin(row["temperature_prior"], signed=False),
            with_unit(row["amplitude_5sigma"], row["unit"]),
            "no" if row["invisible"] else "yes",
            text(row["measurement"]),
        )
        for row in report["limits"][:most]
    ]
    heads = (
        "cause",
        "#T error when just seen (5 sd)",
        "#T error of a usual size",
        "#amplitude just seen",
        "would a usual size be seen?",
        "measurement that would show it",
    )
    return table(heads, rows)


def ratio(fit):
    """Chi-squared per degree of freedom, two places."""
    return f"{fit['chi2'] / max(fit['dof'], 1):.2f}"


def gain(report):
    """What the extension is worth on data not used for it."""
    entry = report["gain"]
    extended = report["extended"]
    base = report["base"]
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
        ("χ² per degree of freedom, before", ratio(base)),
    ]
    if extended:
        rows.append(("χ² per degree of freedom, after", ratio(extended)))
    return table(("measure", "#value"), [(text(name), value) for name, value in rows], stacked=False)


def phases(report):
    """Chi-squared per datum by phase and channel, coloured by its calibrated p-value."""
    cells = {(row["phase"], row["channel"]): row for row in report["base"]["by_phase"]}
    channels = [one for one in CHANNELS if any(key[1] == one for key in cells)]
    channels += sorted({key[1] for key in cells} - set(CHANNELS))
    head = "".join(f'<th scope="col">{text(CHANNELS.get(one, one))}</th>' for one in channels)
    body = ""
    for phase in report["dataset"]["phases"]:
        body += f'<tr><th scope="row">{text(phase["name"])}</th>'
        for channel in channels:
            row = cells.get((phase["id"], channel))
            if row is None or not row["count"]:
                body += f'<td class="heat">{DASH}</td>'
                continue
            shade = _shade(row["p"])
            title = f"p = {row['p']:.2g}, {row['count']} data"
            share = number(row["chi2"] / row["count"])
            body += f'<td class="heat" style="background:{shade}" title="{title}">{share}</td>'
        body += "</tr>"
    return (
        '<div class="wide"><table><thead><tr><th scope="col">χ² per datum</th>'
        f"{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _shade(p):
    for limit, colour in ((1e-4, "#e9967f"), (1e-3, "#f2bda8"), (0.01, "#f8ddcf"), (0.05, "#fcf0e4")):
        if p < limit:
            return colour
    return "#eef6ee"


def pulls(report):
    """Parameters of the base model against what was known of them."""
    rows = [
        (
            text(row["name"]),
            with_unit(row["value"], row["unit"], 3),
            f"± {number(row['sigma'], 2)}",
            f"{number(row['pull'], 2)} sd",
            "<b>a finding</b>" if row["finding"] else "",
        )
        for row in report["base"]["pulls"]
    ]
    return table(("parameter", "#fitted change", "#known to", "#pull", ""), rows)


def noise(report):
    """The noise as it was found in the data."""
    rows = [
        (
            text(row["channel"]),
            f"{number(100 * row['relative'], 2)} %",
            number(row["lag1"], 2),
            number(row["tail"], 2),
        )
        for row in report["noise"]
    ]
    return table(
        ("channel", "#standard deviation at the median", "#correlation of neighbours", "#tail, 1 is normal"),
        rows,
    )


def tests(report):
    """Calibrated tests of the base model."""
    rows = [
        (text(row["name"]), number(row["statistic"]), number(row["threshold"]), probability(row["p"]))
        for row in report["tests"]
    ]
    return table(("test", "#statistic", "#threshold", "#p"), rows)


def unknown(report):
    """Structures without a name that were looked for."""
    rows = [
        (text(row["name"]), number(row["log_bayes"]))
        for row in sorted(report["discrepancy"]["per_class"], key=lambda one: -one["log_bayes"])
    ]
    return table(("structure", "#log Bayes factor"), rows, stacked=False)


def provenance(report):
    """Where everything came from."""
    entry, thresholds = report["provenance"], report["thresholds"]
    rows = [
        ("program", f"plasmapyro {text(entry['version'])}"),
        ("commit", text(entry["commit"]) if entry["commit"] else DASH),
        ("seed", str(entry["seed"])),
        (
            "thresholds",
            f"effect {number(thresholds['effect'])}, unknown {number(thresholds['unknown'])}, further term"
            f" {number(thresholds['third'])}; from {thresholds['nulls']} simulated tests with nothing wrong,"
            f" level {number(thresholds['level'])}, seed {thresholds['seed']}",
        ),
        ("blind tests of this version", text(entry["blind_score"]) if entry["blind_score"] else DASH),
    ]
    rows += [
        (text(file_name(name)), f"<code>{text(digest)}</code>")
        for name, digest in sorted(entry["files"].items())
    ]
    return table(("", ""), rows, stacked=False)
