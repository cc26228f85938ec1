"""The scoreboard as data, as a page of text (`scoreboard.md`) and as a picture."""

import json
import re
from pathlib import Path

import jinja2
import numpy as np


def data(board):
    """The scoreboard as JSON, a line for each innermost mapping or list."""
    return re.sub(
        r"[\[{][^\[\]{}]*[\]}]",
        lambda found: re.sub(r"\s*\n\s*", " ", found[0]),
        json.dumps(board, indent=1) + "\n",
    )


def text(board, heading, notes=()):
    """The scoreboard as a page of text."""
    page = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        trim_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    shown = (_measured, _number, _share, _interval, _counts, _answers)
    page.filters |= {form.__name__[1:]: form for form in shown}
    return page.get_template("scoreboard.md").render(board=board, heading=heading, notes=notes)


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


def _answers(counter):
    """Answers to one effect, the most frequent first."""
    said = sorted(counter.items(), key=lambda pair: (-pair[1], pair[0]))
    return ", ".join(f"{answer} {count}" for answer, count in said)


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
