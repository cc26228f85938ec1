"""The scoreboard: rates with their confidence intervals, against the bars, as JSON, text and a figure."""

from collections import Counter, defaultdict

import numpy as np
from scipy.stats import beta

LEVEL = 0.95


def clopper_pearson(hits, trials, level=LEVEL):
    """Exact confidence interval of a proportion; (0, 1) without trials."""
    if trials == 0:
        return 0.0, 1.0
    tail = (1 - level) / 2
    low = beta.ppf(tail, hits, trials - hits + 1) if hits else 0.0
    high = beta.ppf(1 - tail, hits + 1, trials - hits) if hits < trials else 1.0
    return float(low), float(high)


def rate(values):
    """{hits, trials, rate, low, high} of truth values."""
    values = [bool(value) for value in values]
    low, high = clopper_pearson(sum(values), len(values))
    share = sum(values) / len(values) if values else None
    return {"hits": sum(values), "trials": len(values), "rate": share, "low": low, "high": high}


def summary(records):
    """All scores of a set of finished cases (dicts of case, kind, effects, score, cost)."""
    done = [one for one in records if one["outcome"] == "scored"]
    kinds = defaultdict(list)
    for one in done:
        kinds[one["kind"]].append(one)
    single = kinds["single"]
    board = {
        "cases": dict(Counter(one["kind"] for one in done)),
        "skipped": dict(Counter(one["kind"] for one in records if one["outcome"] == "beyond range")),
        "failed": dict(Counter(one["kind"] for one in records if one["outcome"] == "failed")),
        "false_alarms": rate(one["score"]["alarm"] for one in kinds["null"]),
        "not_adequate_nulls": rate(one["score"]["status"] == "not-adequate" for one in kinds["null"]),
        "false_alarms_wrong_noise": rate(one["score"]["alarm"] for one in kinds["liar"]),
        "false_alarms_by_noise": {
            noise: rate(one["score"]["alarm"] for one in group)
            for noise, group in _grouped(kinds["liar"], lambda one: one["noise"]).items()
        },
        "ladder": {
            f"{snr:g}": _naming(group)
            for snr, group in sorted(_grouped(single, lambda one: one["effects"][0]["snr"]).items())
        },
        "at_least_8": _naming([one for one in single if one["effects"][0]["snr"] >= 8]),
        "at_least_20": _naming([one for one in single if one["effects"][0]["snr"] >= 20]),
        "double": {
            "both_classes": rate(all(one["score"]["class"]) for one in kinds["double"]),
            "both_exact": rate(all(one["score"]["exact"]) for one in kinds["double"]),
            "spurious": rate(one["score"]["extra"] for one in kinds["double"]),
        },
        "outside": {
            "unknown": rate(one["score"]["unknown"] for one in kinds["outside"]),
            "confident_wrong": rate(one["score"]["confident_wrong"] for one in kinds["outside"]),
            "by_effect": {
                effect: rate(one["score"]["unknown"] for one in group)
                for effect, group in _grouped(kinds["outside"], _first).items()
            },
        },
        "without": {
            "unknown_or_sibling": rate(
                one["score"]["unknown"] or any(one["score"]["class"]) for one in kinds["without"]
            ),
            "confident_wrong": rate(one["score"]["confident_wrong"] for one in kinds["without"]),
        },
        "sabotage": {"still_exact": rate(any(one["score"]["exact"]) for one in kinds["sabotage"])},
        "puzzle": {
            "right": rate(_solved(one) for one in kinds["puzzle"]),
            "by_explanation": {
                name: rate(_solved(one) for one in group)
                for name, group in _grouped(kinds["puzzle"], _first).items()
            },
        },
        "temperature": _temperature(done),
        "calibration_error": _calibration(done),
        "mean_log_score": _mean(one["score"]["log_score"] for one in done),
        "mean_brier": _mean(one["score"]["brier"] for one in done),
        "cost": _cost(done),
        "by_effect": {
            effect: _naming([one for one in group if one["effects"][0]["snr"] >= 8])
            for effect, group in sorted(_grouped(single, _first).items())
        },
        "confusion": _confusion(single),
    }
    board["bars"] = _bars(board)
    return board


def _grouped(records, key):
    groups = defaultdict(list)
    for one in records:
        groups[key(one)].append(one)
    return groups


def _first(one):
    return one["effects"][0]["effect"]


def _mean(values):
    values = [value for value in values if value is not None]
    return float(np.mean(values)) if values else None


def _naming(group):
    return {
        "detected": rate(one["score"]["alarm"] for one in group),
        "class": rate(one["score"]["class"][0] for one in group),
        "exact": rate(one["score"]["top"] == _first(one) for one in group),
        "in_set": rate(one["score"]["in_set"][0] for one in group),
        "extra": rate(one["score"]["extra"] for one in group),
        "set_size": _median(max((len(part) for part in one["score"]["set"]), default=0) for one in group),
    }


def _median(values):
    values = [value for value in values if value is not None]
    return float(np.median(values)) if values else None


SAME = ({"ripple", "P_eff"},)  # explanations that count as one


def _solved(one):
    truth, score = _first(one), one["score"]
    answers = {score["closest"], *score["named"]} if score["named"] else {score["closest"]}
    return any(truth == answer or {truth, answer} in SAME for answer in answers)


def _temperature(done):
    rows = [one["score"]["temperature"] for one in done if one["kind"] in ("null", "single", "double")]
    named = [one for one in done if one["kind"] in ("single", "double") and one["score"]["named"]]
    known = [one for one in named if all(one["score"]["class"])]
    strong = [
        one["score"]["temperature"]
        for one in done
        if one["kind"] == "single"
        and one["effects"][0]["snr"] >= 8
        and (one["score"]["temperature"]["base"]["worst"] or 0) >= 10
    ]
    ratios = [row["base"]["rms"] / row["extended"]["rms"] for row in strong if row["extended"]["rms"]]
    worse = [
        row["extended"]["rms"] > row["base"]["rms"] + row["base"]["sigma"]
        for row in rows
        if row["extended"]["rms"] is not None and row["base"]["rms"] is not None
    ]
    return {
        "coverage_extended_named": _mean(
            one["score"]["temperature"]["extended"]["coverage"] for one in known
        ),
        "coverage_base_all": _mean(row["base"]["coverage"] for row in rows),
        "coverage_extended_all": _mean(row["extended"]["coverage"] for row in rows),
        "rms": {name: _median(row[name]["rms"] for row in rows) for name in ("paper", "base", "extended")},
        "rms_named": {
            name: _median(one["score"]["temperature"][name]["rms"] for one in known)
            for name in ("paper", "base", "extended")
        },
        "reduction_where_biased": _median(ratios),
        "biased_cases": len(ratios),
        "worse_than_base": rate(worse),
    }


def _calibration(done, bins=10):
    """Expected calibration error of the stated probability of the most probable answer."""
    pairs = [
        (one["score"]["stated"], one["score"]["stated_right"])
        for one in done
        if one["score"]["stated"] is not None and one["kind"] in ("null", "single", "outside")
    ]
    if not pairs:
        return None
    stated, right = np.array(pairs, dtype=float).T
    place = np.minimum((stated * bins).astype(int), bins - 1)
    return float(sum(abs((stated - right)[place == one].sum()) for one in range(bins)) / stated.size)


def _cost(done):
    wall = [one["cost"]["wall"] for one in done]
    processor = [one["cost"]["processor"] for one in done]
    if not wall:
        return None
    return {
        "wall_median": float(np.median(wall)),
        "wall_worst": max(wall),
        "processor_median": float(np.median(processor)),
    }


def _confusion(single):
    table = defaultdict(Counter)
    for one in single:
        if one["effects"][0]["snr"] >= 8:
            score = one["score"]
            answer = score["top"] or {"null": "none"}.get(score["status"], score["status"])
            table[_first(one)][answer] += 1
    return {truth: dict(row) for truth, row in sorted(table.items())}


def _bars(board):
    """Each bar with its value and whether it holds."""

    def share(entry):
        return entry["rate"]

    temperature = board["temperature"]
    reduction = temperature["reduction_where_biased"]
    doubles, outside = board["double"], board["outside"]
    siblings = share(board["without"]["unknown_or_sibling"])
    rows = [
        ("false alarms, right noise", share(board["false_alarms"]), "<=", 0.05),
        ("false alarms, wrong noise", share(board["false_alarms_wrong_noise"]), "<=", 0.08),
        ("class named, SNR >= 8", share(board["at_least_8"]["class"]), ">=", 0.90),
        ("exact name, SNR >= 8", share(board["at_least_8"]["exact"]), ">=", 0.80),
        ("class named, SNR >= 20", share(board["at_least_20"]["class"]), ">=", 0.97),
        ("exact name, SNR >= 20", share(board["at_least_20"]["exact"]), ">=", 0.92),
        ("two effects, SNR >= 12: both classes", share(doubles["both_classes"]), ">=", 0.90),
        ("two effects, SNR >= 12: spurious third", share(doubles["spurious"]), "<=", 0.08),
        ("outside the catalogue, SNR >= 12: unknown", share(outside["unknown"]), ">=", 0.90),
        ("outside the catalogue: confident wrong name", share(outside["confident_wrong"]), "<=", 0.03),
        ("left out of the catalogue, SNR 20: unknown or sibling", siblings, ">=", 0.85),
        ("sabotaged formula: still named exactly", share(board["sabotage"]["still_exact"]), "<=", 0.50),
        ("95 % temperature interval, named and extended", temperature["coverage_extended_named"], ">=", 0.92),
        ("the same, from above", temperature["coverage_extended_named"], "<=", 0.98),
        ("temperature error over extended, bias >= 10 K, SNR >= 8", reduction, ">=", 3.0),
        ("extended worse than base by a sigma", share(temperature["worse_than_base"]), "<=", 0.05),
        ("six explanations of 60 against 85 kW", share(board["puzzle"]["right"]), ">=", 0.90),
        ("calibration error of stated probabilities", board["calibration_error"], "<=", 0.05),
    ]  # fmt: skip
    return [
        {
            "bar": name,
            "value": value,
            "rule": f"{sign} {bar:g}",
            "held": None if value is None else bool(value <= bar if sign == "<=" else value >= bar),
        }
        for name, value, sign, bar in rows
    ]


def text(board, heading, notes=()):
    """The scoreboard as a page of text."""
    lines = [
        "# Scoreboard of the blind tests",
        "",
        heading,
        "",
        *(part for note in notes for part in (note, "")),
        f"Cases: {_counts(board['cases'])}. Not reachable within the physical range:"
        f" {_counts(board['skipped'])}. Failed: {_counts(board['failed'])}.",
        "",
        "## Against the bars",
        "",
        "| | measured | bar | |",
        "|---|---|---|---|",
    ]
    for row in board["bars"]:
        verdict = {None: "not measured", True: "held", False: "**missed**"}[row["held"]]
        lines.append(f"| {row['bar']} | {_number(row['value'])} | {row['rule']} | {verdict} |")
    lines += ["", "## One hidden effect", ""]
    lines += [
        "| SNR | cases | detected | class | exact | in the ambiguity set | median set | extra term |",
        "|---|" + "---|" * 7,
    ]
    for snr, row in board["ladder"].items():
        cells = [_share(row[name]) for name in ("detected", "class", "exact", "in_set")]
        lines.append(
            f"| {snr} | {row['class']['trials']} | {' | '.join(cells)} | {_number(row['set_size'])}"
            f" | {_share(row['extra'])} |"
        )
    lines += [
        "",
        "## Nothing hidden",
        "",
        "| noise | cases | false alarms (95 % interval) |",
        "|---|---|---|",
    ]
    for name, row in [("as assumed", board["false_alarms"]), *sorted(board["false_alarms_by_noise"].items())]:
        lines.append(f"| {name} | {row['trials']} | {_interval(row)} |")
    lines += [
        "",
        "## Effects outside the catalogue: called unknown",
        "",
        "| effect | cases | unknown |",
        "|---|---|---|",
    ]
    for name, row in sorted(board["outside"]["by_effect"].items()):
        lines.append(f"| {name} | {row['trials']} | {_interval(row)} |")
    lines += ["", "## Six explanations", "", "| explanation | cases | found |", "|---|---|---|"]
    for name, row in sorted(board["puzzle"]["by_explanation"].items()):
        lines.append(f"| {name} | {row['trials']} | {_interval(row)} |")
    lines += [
        "",
        "## By effect, SNR >= 8",
        "",
        "| effect | cases | class | exact | answers |",
        "|---|---|---|---|---|",
    ]
    for name, row in board["by_effect"].items():
        answers = sorted(board["confusion"].get(name, {}).items(), key=lambda pair: (-pair[1], pair[0]))
        said = ", ".join(f"{answer} {count}" for answer, count in answers)
        lines.append(
            f"| {name} | {row['class']['trials']} | {_share(row['class'])} | {_share(row['exact'])}"
            f" | {said} |"
        )
    temperature = board["temperature"]
    lines += [
        "",
        "## Temperature, t = 18 to 330 s",
        "",
        "| median rms error [K] | paper | base | extended |",
        "|---|---|---|---|",
    ]
    for label, key in (("all", "rms"), ("class named", "rms_named")):
        row = temperature[key]
        lines.append(
            f"| {label} | {_number(row['paper'])} | {_number(row['base'])} | {_number(row['extended'])} |"
        )
    lines.append("")
    if board["cost"]:
        lines.append(
            f"Cost per data set: {board['cost']['processor_median']:.0f} s of one processor (median),"
            f" {board['cost']['wall_worst']:.0f} s at worst by the clock."
        )
    return "\n".join(lines) + "\n"


def _number(value):
    return "-" if value is None else f"{value:.3g}"


def _share(entry):
    return "-" if entry["rate"] is None else f"{entry['rate']:.2f}"


def _interval(entry):
    return (
        "-" if entry["rate"] is None else f"{entry['rate']:.2f} ({entry['low']:.2f} to {entry['high']:.2f})"
    )


def _counts(counter):
    return ", ".join(f"{count} {kind}" for kind, count in sorted(counter.items())) or "none"


def figure(board, path):
    """Naming against SNR, and who is taken for whom."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, (left, right) = plt.subplots(
        1, 2, figsize=(12, 6.5), gridspec_kw={"width_ratios": [1, 1.6]}, layout="constrained"
    )
    snr = [float(one) for one in board["ladder"]]
    for name, style in (("detected", "k:"), ("class", "C0o-"), ("exact", "C1s-"), ("in_set", "C2^--")):
        rows = [row[name] for row in board["ladder"].values()]
        share = np.array([row["rate"] for row in rows], dtype=float)
        below = share - [row["low"] for row in rows]
        above = np.array([row["high"] for row in rows]) - share
        left.errorbar(snr, share, [below, above], fmt=style, capsize=3, label=name.replace("_", " "))
    if snr:
        left.set_xscale("log")
        left.set_xticks(snr, [f"{one:g}" for one in snr])
        left.minorticks_off()
        left.legend()
    left.set(xlabel="signal-to-noise ratio of the hidden effect", ylabel="share of cases", ylim=(-0.02, 1.02))
    left.set_title("One hidden effect")
    truths = list(board["confusion"])
    answers = truths + sorted({a for row in board["confusion"].values() for a in row} - set(truths))
    table = np.array([[board["confusion"][t].get(a, 0) for a in answers] for t in truths], dtype=float)
    if table.size:
        image = right.imshow(table / table.sum(axis=1, keepdims=True), cmap="Blues", vmin=0, vmax=1)
        right.set_xticks(range(len(answers)), answers, rotation=90, fontsize=7)
        right.set_yticks(range(len(truths)), truths, fontsize=7)
        fig.colorbar(image, ax=right, label="share of the cases with this effect")
    right.set(xlabel="named first", ylabel="hidden", title="SNR >= 8: hidden against named")
    fig.savefig(path, dpi=110)
    plt.close(fig)
