"""One look for all figures: size, type, colours by power, the mark of synthetic data, repeatable files."""

from functools import partial

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from plasmapyro import io

COLUMN = (3.5, 2.8)  # one journal column [inch]
BESIDE = (4.3, 2.8)  # the same with the legend beside the axes [inch]
POWER_COLOURS = plt.get_cmap("viridis_r")
WIDE, NARROW = "#1f5fa8", "#c0392b"
SETTINGS = {
    "font.size": 8,
    "axes.labelsize": 8,
    "legend.fontsize": 6.5,
    "legend.frameon": False,
    "lines.linewidth": 1.1,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "grid.linewidth": 0.5,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "figure.constrained_layout.use": True,
    "savefig.dpi": 300,
    "svg.hashsalt": "plasmapyro",
    "svg.fonttype": "none",
    "mathtext.default": "regular",
}


def figure(size=COLUMN, **options):
    """A new figure and its axes in the common style (options as for `matplotlib.pyplot.subplots`)."""
    matplotlib.rcParams.update(SETTINGS)
    return plt.subplots(figsize=size, **options)


def case_colours(count):
    """One colour per condition, dark for the last; a lone one gets the middle of the scale."""
    return POWER_COLOURS(np.linspace(0.1, 1.0, count) if count > 1 else [0.5])


def case_labels(condition, numerical_power):
    """Legend texts such as '90 kW'; the names of the conditions if two share a power."""
    labels = [f"{power / 1e3:g} kW" for power in np.asarray(numerical_power)]
    return labels if len(set(labels)) == len(labels) else [str(name) for name in condition]


def legend_beside(axes, **options):
    """Legend of the powers to the right of the axes, off the curves."""
    return axes.legend(title="$P_{el}^{sim}$", loc="center left", bbox_to_anchor=(1.01, 0.5), **options)


def mark_origin(axes, *datasets):
    """Say on the figure if any of the datasets it shows is synthetic."""
    if any(dataset.attrs.get("origin") == "synthetic" for dataset in datasets):
        axes.set_title("synthetic data", loc="right", fontsize=7, color="#b03060", style="italic")


def save(drawing, paths):
    """Write the figure to every path (format by suffix) without a date, and close it."""
    for path in paths:
        metadata = {"Date": None} if str(path).endswith(".svg") else {"Software": None}
        io.store(path, partial(drawing.savefig, metadata=metadata))
    plt.close(drawing)
