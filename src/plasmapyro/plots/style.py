"""One look for all figures: size, type, colours by power, the mark of synthetic data, repeatable files."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

from plasmapyro import io
from plasmapyro.conditions import number
from plasmapyro.plots import colours
from plasmapyro.plots.laid import Laid

COLUMN = (3.5, 2.8)  # one journal column [inch]
BESIDE = (4.3, 2.8)  # the same with the legend beside the axes [inch]
WARM, COOL = plt.get_cmap("YlOrBr"), plt.get_cmap("Blues")
DASHES = ("-", "--", "-.", ":")
WIDE, NARROW = colours.WIDE, colours.NARROW
SETTINGS = matplotlib.rc_params_from_file(
    Path(__file__).with_name("figures.mplstyle"), use_default_template=False
)


def figure(size=COLUMN, **options):
    """A new figure and its axes in the common style (options as for `matplotlib.pyplot.subplots`)."""
    matplotlib.rcParams.update(SETTINGS)
    return plt.subplots(figsize=size, FigureClass=Laid, **options)


def case_colours(count):
    """Colours (count, 4) of ordered cases: darker for the later, neighbours warm and cool by turns.

    In grey the order is left, and to colour-blind eyes warm and cool stay apart.
    """
    places = np.linspace(0.4, 1.0, count) if count > 1 else [0.8]
    return np.array([COOL(at - 0.05) if k % 2 else WARM(at) for k, at in enumerate(places)])


def bands(names, most):
    """(number, name, colour) of the bands that a figure shows: all, or `most` of them from end to end."""
    names = list(map(str, names))
    shown = sorted(set(np.linspace(0, len(names) - 1, min(len(names), most)).round().astype(int).tolist()))
    colour = (WIDE, NARROW) if len(shown) < 3 else case_colours(len(shown))
    return [(place + 1, names[place], colour[at]) for at, place in enumerate(shown)]


def responsivities(response):
    """Normalised responses (band, wavelength) of a dataset of contract 'response', and names of the bands."""
    if "responsivity" in response:
        return response.responsivity.values, response.band.values
    return [response[f"responsivity_{name}"].values for name in ("wide", "narrow")], ("wide", "narrow")


@dataclass(frozen=True)
class Curve:
    """How one condition is drawn: `drawn` are the options of a line, without its label."""

    label: str
    color: tuple
    dash: str

    @property
    def drawn(self):
        return {"color": self.color, "ls": self.dash}

    @property
    def options(self):
        return {**self.drawn, "label": self.label}


def curves(names, power, pressure):
    """One Curve per condition, told apart by colour and line; each pressure has a line of its own.

    `power` [W] and `pressure` [Pa], NaN if not known. Labels such as '90 kW', or '90 kW, 20 mbar' where
    pressures differ or are not the paper's; the name where that does not tell a condition from another, or
    its power is not known.
    """
    pressures = list(dict.fromkeys("" if np.isnan(p) else f"{p / 100:g} mbar" for p in pressure))
    several = len(pressures) > 1
    told = several or pressures[:1] not in (["50 mbar"], [""])
    labels, dashes = [], []
    for k, (watt, pascal) in enumerate(zip(power, pressure, strict=True)):
        at = "" if np.isnan(pascal) else f"{pascal / 100:g} mbar"
        labels.append(", ".join([f"{watt / 1e3:g} kW"] + [at] * (told and bool(at))))
        dashes.append(DASHES[pressures.index(at) % len(DASHES)] if several else DASHES[k % 2])
    return [
        Curve(str(name) if labels.count(label) > 1 or np.isnan(watt) else label, tuple(colour), dash)
        for name, label, watt, colour, dash in zip(
            names, labels, power, case_colours(len(labels)), dashes, strict=True
        )
    ]


def curves_in(dataset):
    """Curves of the conditions side by side in one dataset."""
    power = dataset.numerical_power.values
    pressure = dataset.get("chamber_pressure", xr.full_like(dataset.numerical_power, np.nan)).values
    return curves(dataset.condition.values, power, pressure)


def curves_of(datasets):
    """Curves of the conditions in a mapping of name -> Dataset, which state what they are (`conditions`)."""
    stated = [
        [number(one, name) for one in datasets.values()] for name in ("numerical_power", "chamber_pressure")
    ]
    return curves(list(datasets), *stated)


def legend_beside(axes, title="Numerical\npower", **options):
    """Legend to the right of the axes, off the curves; of the powers by default."""
    return axes.legend(title=title, loc="center left", bbox_to_anchor=(1.01, 0.5), **options)


def mark_origin(axes, *datasets):
    """Say on the figure if any of the datasets it shows is synthetic."""
    if any(dataset.attrs.get("origin") == "synthetic" for dataset in datasets):
        axes.set_title("synthetic data", loc="right", fontsize=7, color="#b03060", style="italic")


def save(axes, paths, *datasets):
    """Write the figure of some axes to every path (format by suffix) without a date, and close it.

    If any of the datasets it shows is synthetic, the axes say so.
    """
    mark_origin(axes, *datasets)
    for path in paths:
        metadata = {"Date": None} if str(path).endswith(".svg") else {"Software": None}
        io.store(path, partial(axes.figure.savefig, metadata=metadata))
        with plt.rc_context({"figure.constrained_layout.use": False}):
            axes.figure.set_layout_engine(None)  # a layout draws once more: for the first file alone
    plt.close(axes.figure)
