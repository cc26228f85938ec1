"""The scoreboard as a page of text and a picture."""

import numpy as np


def _by_world(worlds):
    """Rates of each world beside the bars."""
    if not worlds:
        return []
    lines = ["", "## By world", "", f"| | bar | {' | '.join(worlds)} |", "|---|---|" + "---|" * len(worlds)]
    for rows in zip(*(board["bars"] for board in worlds.values()), strict=True):
        if any(row["value"] is not None for row in rows):
            cells = [f"{_measured(row)} of {row['cases']}" for row in rows]
            lines.append(f"| {rows[0]['bar']} | {rows[0]['rule']} | {' | '.join(cells)} |")
    return lines


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
        "In brackets 95 % intervals: exact binomial ones of rates, by resampling the cases of all else.",
        "",
        "| | measured | cases | bar | |",
        "|---|---|---|---|---|",
    ]
    for row in board["bars"]:
        verdict = {None: "not measured", True: "held", False: "**missed**"}[row["held"]]
        lines.append(f"| {row['bar']} | {_measured(row)} | {row['cases']} | {row['rule']} | {verdict} |")
    lines += _by_world(board.get("worlds", {}))
    told = [row for row in board["bars"] if row["why"]]
    if told:
        lines += ["", "Behind the bars that are missed:", ""]
        lines += [f"- {row['bar']}: {row['why']}" for row in told]
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
    lines += ["", _reductions(temperature), ""]
    lines += ["## Stated probabilities", "", "| stated | right | cases |", "|---|---|---|"]
    lines += [f"| {said:.2f} | {right:.2f} | {number} |" for said, right, number in board["reliability"]]
    cost = board["cost"]
    if cost:
        lines += [
            "",
            f"Cost per data set, screening, refits and gain together: {cost['processor_median']:.1f} s of one"
            f" processor (median), {cost['processor_worst']:.0f} s at worst, {cost['wall_worst']:.0f} s at"
            " worst by the clock; the bars are 60 s for the screening and 600 s with refits on two cores.",
        ]
    return "\n".join(lines) + "\n"


def _reductions(temperature):
    """Sentence about what the extension does to wrong temperatures."""
    parts = []
    for key, name in (
        ("reduction_of_paper_where_biased", "the paper's correction"),
        (
            "reduction_where_biased",
            "the base fit, which frees temperature, emittance, gains and power already",
        ),
    ):
        row = temperature[key]
        if row["value"] is not None:
            parts.append(f"{name}: {_measured(row)} times in {row['trials']} cases")
    if not parts:
        return "No single effect of SNR 8 or more biased a temperature by 10 K."
    return (
        "Root mean square error over that of the extended fit (median), single effects of SNR 8 and more"
        " where the former has a bias of 10 K or more over nine successive values. Of "
        + "; of ".join(parts)
        + "."
    )


def _measured(row):
    if row["value"] is None or row["low"] is None:
        return _number(row["value"])
    return f"{_number(row['value'])} ({_number(row['low'])} to {_number(row['high'])})"


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
    """Naming against SNR, who is taken for whom, and stated against measured probabilities."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig = plt.figure(figsize=(15, 9), layout="constrained")
    grid = fig.add_gridspec(2, 2, width_ratios=[1, 2])
    _ladder(fig.add_subplot(grid[0, 0]), board["ladder"])
    _reliability(fig.add_subplot(grid[1, 0]), board["reliability"])
    _confusion(fig, fig.add_subplot(grid[:, 1]), board["confusion"])
    fig.savefig(path, dpi=110)
    plt.close(fig)


CURVES = (
    ("detected", "detected", "k:", 0.94),
    ("in_set", "among the names given", "C2^--", 0.98),
    ("class", "class right", "C0o-", 1.02),
    ("exact", "name right", "C1s-", 1.06),
)


def _ladder(axes, ladder):
    snr = np.array([float(one) for one in ladder])
    for name, label, style, shift in CURVES:  # side by side, so that no interval hides another
        rows = [row[name] for row in ladder.values()]
        share = np.array([row["rate"] for row in rows], dtype=float)
        spread = [share - [row["low"] for row in rows], [row["high"] for row in rows] - share]
        axes.errorbar(snr * shift, share, spread, fmt=style, capsize=2, lw=1.2, ms=5, label=label)
    if snr.size:
        axes.set_xscale("log")
        axes.set_xticks(snr, [f"{one:g}" for one in snr])
        axes.minorticks_off()
        axes.legend(loc="best")
    axes.set(xlabel="signal-to-noise ratio of the hidden effect", ylabel="share of cases", ylim=(-0.02, 1.02))
    axes.set_title("One hidden effect, 95 % intervals")


def _reliability(axes, rows):
    axes.plot([0, 1], [0, 1], "k:", lw=1)
    if rows:
        said, right, number = np.array(rows).T
        axes.scatter(said, right, s=20 + 8 * np.sqrt(number), color="C0")
        for x, y, count in rows:
            axes.annotate(f"{count:.0f}", (x, y), (8, -4), textcoords="offset points", fontsize=8)
    axes.set(xlabel="stated probability of the first answer", ylabel="share of right answers")
    axes.set(xlim=(0, 1.06), ylim=(-0.02, 1.04), title="Stated and measured; numbers of cases")


def _confusion(fig, axes, confusion):
    truths = list(confusion)
    others = sorted({answer for row in confusion.values() for answer in row} - set(truths))
    answers = truths + others
    table = np.array([[confusion[t].get(a, 0) for a in answers] for t in truths], dtype=float)
    if table.size:
        share = table / table.sum(axis=1, keepdims=True)
        image = axes.imshow(np.where(share > 0, share, np.nan), cmap="viridis_r", vmin=0, vmax=1)
        axes.set_xticks(range(len(answers)), answers, rotation=90, fontsize=8)
        labels = [f"{name} ({total:.0f})" for name, total in zip(truths, table.sum(axis=1), strict=True)]
        axes.set_yticks(range(len(truths)), labels, fontsize=8)
        axes.set_xticks(np.arange(len(answers)) - 0.5, minor=True)
        axes.set_yticks(np.arange(len(truths)) - 0.5, minor=True)
        axes.grid(which="minor", color="0.9", lw=0.4)
        axes.tick_params(which="minor", length=0)
        axes.axvline(len(truths) - 0.5, color="k", lw=0.8)
        fig.colorbar(image, ax=axes, label="share of the cases with this effect", shrink=0.6)
    axes.set(xlabel="named first (right of the line: answers that were not hidden)", ylabel="hidden (cases)")
    axes.set_title("SNR >= 8: hidden against named")
