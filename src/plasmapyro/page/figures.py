"""Figures of a diagnosis as SVG text, each with the sentence that says what it shows."""

import math
import textwrap

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.ticker import NullFormatter

from plasmapyro.page import recommended
from plasmapyro.page.shell import SIZE, drawn
from plasmapyro.page.tables import names
from plasmapyro.plots.colours import BASE, EXTENDED, NARROW, PAPER, PHASES, SPECTRUM, WIDE

RESIDUAL_LIMIT = 4.0
MOST_BANDS = 6  # drawn
LETTER = 0.015  # of the width of the axes: a phase that is too narrow for its name has none
NANOMETRE = 1e-9
WORST_STEP = 0.3  # standard deviation of a step at plasma-off that is still shown


def _array(values):
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def _shade(axes, phases, *, labelled=True):
    """Colour the phases of the test behind the curves."""
    for index, phase in enumerate(phases):
        axes.axvspan(phase["start"], phase["end"], color=PHASES[index % len(PHASES)], zorder=0, lw=0)
    if labelled:
        whole = phases[-1]["end"] - phases[0]["start"] if phases else 0.0
        for phase in phases:
            if phase["end"] - phase["start"] >= LETTER * len(phase["name"]) * whole:
                axes.text(
                    (phase["start"] + phase["end"]) / 2,
                    1.01,
                    phase["name"],
                    transform=axes.get_xaxis_transform(),
                    ha="center",
                    va="bottom",
                    fontsize=8,
                    color="#555555",
                )


def _colours(bands):
    """Band -> colour: the pyrometer's own, of others from short to long waves."""
    own = {"wide": WIDE, "narrow": NARROW}
    if set(bands) <= set(own):
        return {band: own[band] for band in bands}
    from matplotlib import colormaps

    places = np.linspace(0, 0.9, len(bands))
    return {band: colormaps["viridis"](place) for band, place in zip(bands, places, strict=True)}


def _some(bands):
    """Bands that are drawn: all of a few, else evenly chosen ones."""
    return [bands[place] for place in np.unique(np.linspace(0, len(bands) - 1, MOST_BANDS).astype(int))]


def _points(axes, across, values, errors, good, **options):
    """Points with their errors, where they are good."""
    axes.errorbar(across[good], values[good], errors[good], fmt=".", **options)


def _name_rows(axes, names):
    """Words beside the rows of bars, and lines across none of them."""
    axes.set_yticks(range(len(names)), names, fontsize=8)
    axes.grid(visible=False, axis="y")


def _legend_above(axes, columns):
    axes.legend(loc="lower center", bbox_to_anchor=(0.4, 1.0), ncols=columns, fontsize=8)


def signals(report):
    """Signals of the bands with the model's."""
    shown, phases = report["show"]["signals"], report["dataset"]["phases"]
    time = _array(shown["time"])
    bands = _some([band for band in shown if f"{band}_model" in shown])
    paper = bands == ["wide", "narrow"]

    def draw(axes):
        _shade(axes, phases)
        for band, colour in _colours(bands).items():
            axes.plot(
                time, _array(shown[band]), ".", ms=2.5, color=colour, alpha=0.6, label=f"{band}, measured"
            )
            model = f"{band}, base model" if paper else None
            axes.plot(time, _array(shown[f"{band}_model"]), color=colour, lw=1.2, label=model)
        values = np.concatenate([_array(shown[band]) for band in bands])
        if np.nanmax(values, initial=0) > 0:
            axes.set_yscale("log")
            axes.set_ylim(bottom=max(np.nanmin(values[values > 0]) / 2, np.nanmax(values) * 1e-6))
        axes.set(xlabel="time [s]", ylabel="signal [A]" if paper else "signal", xlim=(time.min(), time.max()))
        axes.legend(ncols=2)

    return drawn(draw, "signals")


def temperature(report, dataset):
    """Temperature to take away with its interval, that of the paper and of the base model; differences."""
    time, best = dataset["time_bin"].values, dataset.attrs.get("recommended")
    rows = {
        "subtraction": ("before: the paper's correction", "paper", ".", PAPER),
        "base": ("base model", "base", None, BASE),
    }
    others = [
        (words, time, dataset[f"{kind}_temperature"].values, marker, colour)
        for name, (words, kind, marker, colour) in rows.items()
        if name != best and np.isfinite(dataset[f"{kind}_temperature"]).any()
    ]
    return recommended.figure(dataset, others)


def residual_maps(report, dataset):
    """Residuals over time and wavelength, before and after the extension, on one scale."""
    # Bins of time without an exposure would only be white stripes.
    seen = np.isfinite(dataset["radiance_residual"].sel(model="base").values).any(axis=1)
    dataset = dataset.isel(time_bin=seen)
    edges = np.append(dataset["time_edge"].values[:, 0], dataset["time_edge"].values[-1, 1])
    light = np.append(dataset["wavelength_edge"].values[:, 0], dataset["wavelength_edge"].values[-1, 1])
    models = ["base", "extended"] if report["extended"] else ["base"]

    def draw(axes):
        for one, model in zip(np.atleast_1d(axes), models, strict=True):
            values = np.ma.masked_invalid(dataset["radiance_residual"].sel(model=model).values.T)
            image = one.pcolormesh(
                edges,
                light / NANOMETRE,
                values,
                cmap="RdBu_r",
                vmin=-RESIDUAL_LIMIT,
                vmax=RESIDUAL_LIMIT,
                rasterized=True,
            )
            one.grid(visible=False)
            one.set(ylabel="wavelength [nm]")
            one.set_title(f"{model} model", fontsize=10, loc="left")
        np.atleast_1d(axes)[-1].set_xlabel("time [s]")
        figure = image.figure
        figure.colorbar(image, ax=axes, label="(measured − model) / standard deviation", extend="both")

    return drawn(draw, "residual-map", (SIZE[0], 2.9 * len(models)), nrows=len(models), sharex=True)


def signal_residuals(report, dataset):
    """Residuals of the bands over time."""
    time = dataset["time_bin"].values
    bands = _some([str(band) for band in dataset["band"].values])

    def draw(axes):
        axes = np.atleast_1d(axes)
        for one, (band, colour) in zip(axes, _colours(bands).items(), strict=True):
            _shade(one, report["dataset"]["phases"], labelled=band == bands[0])
            base = dataset["signal_residual"].sel(model="base", band=band).values
            one.plot(time, base, ".", ms=3, color=colour, label="base model")
            if report["extended"]:
                more = dataset["signal_residual"].sel(model="extended", band=band).values
                one.plot(time, more, "x", ms=3, color="#444444", mew=0.7, label="extended model")
            one.axhline(0, color="k", lw=0.7)
            one.set(ylabel=f"{band} [sd]", xlim=(min(time), max(time)))
        axes[0].legend(ncols=2, loc="upper left")
        axes[-1].set_xlabel("time [s]")

    count = len(bands)
    return drawn(draw, "signal-residuals", (SIZE[0], 1.0 + 1.3 * count), nrows=count, sharex=True)


def step(report):
    """Step at the end of the plasma over the reference, by wavelength."""
    kappa = report["show"]["kappa"]
    wavelength = _array(kappa["wavelength"]) / NANOMETRE
    value, error = _array(kappa["kappa"]), _array(kappa["error"])

    def draw(axes):
        axes.axhline(1, color="k", lw=0.8)
        certain = np.isfinite(value) & (error < WORST_STEP)
        label = "spectrometer" if "spectrometer" in report["dataset"]["instruments"] else "bands"
        _points(axes, wavelength, value, error, certain, ms=4, lw=0.7, color=SPECTRUM, label=label)
        for band, place, colour in (("wide", 0.93, WIDE), ("narrow", 1.0, NARROW)):
            off = kappa[f"{band}_error"] or 0
            if finite(kappa[band]) and off < WORST_STEP and wavelength.size:
                at = wavelength.min() + place * np.ptp(wavelength)
                style = {"fmt": "o", "ms": 4, "capsize": 3, "color": colour}
                axes.errorbar([at], [kappa[band]], [off], label=f"{band} band", **style)
        if certain.any():
            limit = max(0.3, 1.3 * np.abs(value[certain] - 1).max())
            axes.set_ylim(1 - limit, 1 + limit)
        for label in kappa["labels"]:
            axes.annotate(
                label["text"],
                (label["wavelength"] / NANOMETRE, 1.0),
                xycoords=("data", "axes fraction"),
                rotation=90,
                va="top",
                ha="right",
                fontsize=8,
                color="#555555",
            )
            axes.axvline(label["wavelength"] / NANOMETRE, color="#bbbbbb", lw=0.6, zorder=0)
        axes.set(xlabel="wavelength [nm]", ylabel="step at plasma-off / reference")
        axes.legend(loc="lower left", ncols=3)

    return drawn(draw, "kappa")


def emittance_loop(report):
    """Apparent emittance against temperature, heating and cooling apart."""
    loop = report["show"]["emittance_loop"]
    kelvin, value, error = (_array(loop[name]) for name in ("temperature", "emittance", "error"))
    heating = np.array(loop["heating"], dtype=bool)

    def draw(axes):
        axes.axhline(loop["stated"], color="k", lw=0.8, label=f"stated: {loop['stated']:g}")
        for mask, colour, label in ((heating, NARROW, "plasma on"), (~heating, WIDE, "cooling")):
            _points(axes, kelvin, value, error, mask, ms=3, lw=0.5, color=colour, alpha=0.7, label=label)
        middle = np.nanmedian(value) if value.size else loop["stated"]
        spread = max(0.05, 1.3 * np.nanquantile(np.abs(value - middle), 0.97)) if value.size else 0.1
        axes.set_ylim(middle - spread, middle + spread)
        axes.set(xlabel="surface temperature [K]", ylabel="apparent emittance")
        axes.legend(ncols=3)

    return drawn(draw, "emittance-loop")


def line_hump(report):
    """Lines against smooth light of the gas, with the tracks of the explanations."""
    plane = report["show"]["line_hump"]
    point = plane["measured"]

    def draw(axes):
        for index, track in enumerate(plane["tracks"]):
            line, hump = _array(track["line"]), _array(track["hump"])
            axes.plot(hump, line, "-", color=f"C{index}", label=track["name"])
            axes.plot(hump[-1:], line[-1:], ">", ms=4, color=f"C{index}")
        axes.errorbar(
            [point["hump"]],
            [point["line"]],
            xerr=[point["hump_error"]],
            yerr=[point["line_error"]],
            fmt="k*",
            ms=10,
            capsize=3,
            label="measured",
        )
        axes.plot(1, 1, "ko", mfc="none", ms=7, label="simulation")
        axes.set_xscale("log")
        axes.set_yscale("log")
        for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            axis.set_major_formatter("{x:g}")
            # Within a decade the powers of ten alone would leave the axis without numbers.
            axis.set_minor_formatter("{x:g}" if limits[1] < 10 * limits[0] else NullFormatter())
        axes.tick_params(which="minor", labelsize=8)
        axes.set(xlabel="smooth light, over simulation", ylabel="O I 777 nm line, over simulation")
        axes.legend(fontsize=8, markerscale=0.8)

    return drawn(draw, "line-hump", (SIZE[0], 3.8))


def impact(report, most=14):
    """Kelvin that each candidate costs, at the fitted amplitude."""
    rows = report["candidates"][:most][::-1]

    def draw(axes):
        place = np.arange(len(rows))
        named = report["verdict"]["named"]
        sides = ("paper", "paper's correction", 0.18, PAPER), ("base", "base model", -0.18, BASE)
        for which, label, shift, colour in sides:
            values = [row["temperature_shift"][which] for row in rows]
            axes.barh(place + shift, values, 0.36, color=colour, label=label)
        axes.axvline(0, color="k", lw=0.8)
        _name_rows(axes, [textwrap.fill(row["name"], 28) for row in rows])
        for label, row in zip(axes.get_yticklabels(), rows, strict=True):
            label.set_fontweight("bold" if row["id"] in named else "normal")
        axes.set_xlabel("change of temperature [K]")
        _legend_above(axes, 2)

    return drawn(draw, "impact", (SIZE[0], 1.3 + 0.32 * max(len(rows), 3)))


def evidence(report, most=8):
    """Probability of each answer."""
    probability = report["verdict"]["probability"]
    known = names(report)
    rows = sorted(probability.items(), key=lambda pair: -pair[1])[:most][::-1]

    def draw(axes):
        place = np.arange(len(rows))
        axes.barh(place, [max(value, 1e-6) for _, value in rows], color="#6b8fb8")
        _name_rows(axes, [textwrap.fill(known.get(key, key), 28) for key, _ in rows])
        axes.set_xscale("log")
        axes.set_xlim(1e-6, 1.5)
        axes.set_xlabel("probability, given these data")
        for at, (_, value) in zip(place, rows, strict=True):
            start, side = (value * 0.8, "right") if value > 1e-3 else (2e-6, "left")
            axes.text(start, at, f"{value:.2g}", va="center", ha=side, fontsize=8)

    return drawn(draw, "evidence", (SIZE[0], 1.1 + 0.3 * max(len(rows), 3)))


def component(report, index):
    """Leading pattern of the residuals of an instrument: its history and its spectrum."""
    entry = report["show"]["components"][index]

    def draw(axes):
        axis, profile = _array(entry["axis"]), _array(entry["axis_weight"])
        largest = profile[np.nanargmax(np.abs(profile))]
        history = entry["singular_value"] * largest * _array(entry["time_weight"])
        axes[0].plot(_array(entry["time"]), history, color=SPECTRUM)
        axes[0].set(xlabel="time [s]", ylabel="largest channel [sd]")
        spectral = np.nanmax(axis) < 0.5  # [m]; else places of the two bands
        axes[1].plot(
            axis / NANOMETRE if spectral else axis,
            profile / largest,
            "-" if spectral else "o",
            color=SPECTRUM,
        )
        if not spectral:
            axes[1].set_xticks(axis, ("wide", "narrow")[: axis.size])
        axes[1].set(xlabel="wavelength [nm]" if spectral else "band", ylabel="over the largest [1]")
        for one in axes:
            one.axhline(0, color="k", lw=0.6)

    return drawn(draw, f"component-{index}", (SIZE[0], 3.8), nrows=2)


def whiteness(report):
    """Autocorrelation of the residuals, and their quantiles against a normal law."""
    correlation, quantiles = (_some(report["show"][name]) for name in ("autocorrelation", "quantiles"))

    def draw(axes):
        for index, row in enumerate(correlation):
            axes[0].plot(
                row["lag"], _array(row["value"]), "o-", ms=3, lw=0.8, color=f"C{index}", label=row["channel"]
            )
        if correlation:
            band = max(row["band"] for row in correlation)
            axes[0].axhspan(-band, band, color="#dddddd", zorder=0, lw=0)
            axes[0].legend(fontsize=8)
        axes[0].set(xlabel="lag [samples]", ylabel="autocorrelation")
        for index, row in enumerate(quantiles):
            axes[1].plot(
                _array(row["normal"]),
                _array(row["residual"]),
                "o",
                ms=3,
                color=f"C{index}",
                label=row["channel"],
            )
        reach = [-3.5, 3.5]
        axes[1].plot(reach, reach, "k-", lw=0.7)
        axes[1].set(xlabel="normal quantile", ylabel="residual quantile")

    return drawn(draw, "whiteness", (SIZE[0], 2.7), ncols=2)


def gas_monitor(report):
    """Brightness of the gas through the test, with the tunnel's channels."""
    monitor = report["show"]["gas_monitor"]
    time, gas, error = (_array(monitor[name]) for name in ("time", "gas", "error"))

    def draw(axes):
        _shade(axes, report["dataset"]["phases"])
        certain = np.isfinite(gas) & (error < 0.5)
        _points(axes, time, gas, error, certain, ms=3, lw=0.5, color=SPECTRUM, label="O I 777 nm")
        for index, (name, values) in enumerate(monitor["channels"].items()):
            if values:
                axes.plot(time, _array(values), color=f"C{index}", lw=0.9, label=name.replace("_", " "))
        axes.set(xlabel="time [s]", ylabel="relative to the reference", xlim=(time.min(), time.max()))
        axes.legend(fontsize=8, ncols=2)

    return drawn(draw, "gas-monitor")


def angles(report):
    """How alike the candidates look in these data."""
    table, known = report["show"]["angles"], names(report)
    words = [textwrap.shorten(known.get(one, one), 30, placeholder=" …") for one in table["ids"]]
    degrees = _array([value for row in table["degrees"] for value in row]).reshape(len(table["ids"]), -1)

    def draw(axes):
        image = axes.imshow(np.maximum(degrees, 1.0), cmap="magma", norm=LogNorm(1, 90))
        axes.set_xticks(range(len(table["ids"])), words, rotation=90, fontsize=8)
        axes.set_yticks(range(len(table["ids"])), words, fontsize=8)
        axes.grid(visible=False)
        bar = image.figure.colorbar(image, ax=axes, label="angle [degrees]", ticks=[1, 5, 15, 45, 90])
        bar.ax.set_yticklabels(["1", "5", "15", "45", "90"])

    return drawn(draw, "angles", (SIZE[0], 4.4))


def systems(report):
    """Measured over simulated light of the gas by radiating system, with what the simulation states."""
    rows = report["simulation"]["systems"][::-1]

    def draw(axes):
        place = np.arange(len(rows))
        power = np.array([row["by_power"] for row in rows])
        stated = np.array([row["stated"] for row in rows])
        axes.barh(
            place,
            2 * stated * power,
            0.7,
            power * (1 - stated),
            color="#d9e3ef",
            label="simulated, at the best power",
        )
        for beyond, colour in ((False, BASE), (True, EXTENDED)):
            chosen = [at for at, row in enumerate(rows) if row["beyond"] is beyond]
            axes.errorbar(
                [rows[at]["ratio"] for at in chosen],
                chosen,
                xerr=[2 * rows[at]["error"] for at in chosen],
                fmt="D" if beyond else "o",
                ms=4,
                color=colour,
                label="measured, off by more than 3 sd" if beyond else "measured, 95 %",
            )
        axes.axvline(1, color="k", lw=0.8)
        _name_rows(axes, [row["name"] for row in rows])
        largest = max(row["ratio"] + 2 * row["error"] for row in rows)
        axes.set_xlim(0, min(max(2.0, 1.1 * largest), 10.0))
        axes.set_xlabel("light over that of the simulation")
        _legend_above(axes, 1)

    return drawn(draw, "systems", (SIZE[0], 1.6 + 0.24 * max(len(rows), 3)))


def finite(value):
    """Whether a number is there at all."""
    return value is not None and math.isfinite(value)
