"""One test at a glance: signals, temperature with its status, spectra; on axes, or in one picture."""

import numpy as np

from plasmapyro.plots import style
from plasmapyro.plots.colours import NARROW, SPECTRUM, STATUS, WIDE

MICRO, NANO = 1e6, 1e9
STRIP = 0.05  # of the height of the axes: which status each sample has
SHOWN = 4  # spectra, spread over those that give a temperature
MANY = 4000  # samples or spectra: more are thinned, evenly
DECADES = 1e5  # of a spectrum that are shown
TEMPERATURES = {  # name: axis, status, colour, words
    "surface_temperature": ("time", "estimate_status", WIDE, "joint estimate"),
    "corrected_temperature": ("time", "corrected_status", WIDE, "pyrometer, corrected"),
    "spectral_temperature": ("spectrum_time", "spectral_status", SPECTRUM, "spectra, with emissivity"),
    "spectrometer_temperature": ("spectrum_time", "spectrum_status", SPECTRUM, "spectrometer"),
}


def statuses(variable):
    """Words of each code of a status variable, from its own attributes."""
    return dict(
        zip(
            np.atleast_1d(variable.attrs["flag_values"]).tolist(),
            variable.attrs["flag_meanings"].split(),
            strict=True,
        )
    )


def thinned(dataset):
    """What is drawn of a long record: every so-manieth sample and spectrum, or a page takes 30 MB."""
    long = [axis for axis in ("time", "spectrum_time") if dataset.sizes.get(axis, 0) > MANY]
    return dataset.isel({axis: slice(None, None, -(-dataset.sizes[axis] // MANY)) for axis in long})


def given(result):
    """Names of the temperatures that a result holds, the leading one first."""
    return [name for name in TEMPERATURES if name in result]


def shown_spectra(temperature):
    """Places of a few spectra that give a temperature, spread over the test."""
    good = np.flatnonzero(np.isfinite(temperature.values))
    return good[np.unique(np.linspace(0, good.size - 1, SHOWN).round().astype(int))] if good.size else good


def signals(axes, test, result):
    """Signals of both bands with their reference levels, the window and the events of the test."""
    time, positive = test.time.values, []
    for at, (band, colour) in enumerate((("wide", WIDE), ("narrow", NARROW))):
        values = test[f"signal_{band}"].values.astype(float)
        positive.append(values[values > 0])
        axes.plot(time, np.where(values > 0, values, np.nan), color=colour, lw=0.9, label=f"{band} band")
        if "reference_signal" in result:
            level = float(result.reference_signal.values[at])
            axes.axhline(level, color=colour, ls="--", lw=0.8)
    positive = np.concatenate(positive)
    if positive.size:
        axes.set_yscale("log")
        axes.set_ylim(bottom=max(positive.min() / 2, positive.max() * 1e-6))
    if "reference_window" in result.attrs:
        window = result.attrs["reference_window"]
        axes.axvspan(*window, color="0.86", zorder=0, lw=0, label="reference window")
    events(axes, result)
    axes.set(xlabel="time [s]", ylabel="signal [A]")
    axes.legend(ncols=2)


def events(axes, result):
    """Mark the injection and the end of the plasma."""
    for name, words in (("injection_time", "injection"), ("plasma_off_time", "plasma off")):
        if name in result.attrs:
            moment = result.attrs[name]
            axes.axvline(moment, color="0.4", lw=0.8, ls=":")
            axes.annotate(
                words,
                (moment, 0.98),
                xycoords=("data", "axes fraction"),
                rotation=90,
                fontsize=8,
                ha="right",
                va="top",
                color="0.35",
            )


def _runs(time, here):
    """Begin and length of each run of samples that are `here`; a sample lasts to the next."""
    ends = np.append(time[1:], time[-1] + (time[-1] - time[-2] if time.size > 1 else 1.0))
    steps = np.flatnonzero(np.diff(np.concatenate([[False], here, [False]]).astype(int)))
    return [(time[first], ends[last - 1] - time[first]) for first, last in steps.reshape(-1, 2)]


def temperatures(axes, test, result):
    """Temperatures with 95 % intervals, samples in the colours of their status, refused ones in the strip."""
    leading, used = given(result)[0], {}
    for name in given(result):
        axis, state, colour, words = TEMPERATURES[name]
        time, best = result[axis].values, result[name].values
        spread = 2 * result[f"{name}_uncertainty"].values
        low, high = best - spread, best + spread
        if f"{name}_interval" in result:
            low, high = result[f"{name}_interval"].values
        if name != leading:
            axes.errorbar(
                time,
                best,
                [best - low, high - best],
                fmt="D",
                ms=3,
                lw=0.8,
                color=colour,
                label=words,
                zorder=4,
            )
            continue
        words_of, states = statuses(result[state]), result[state].values
        axes.fill_between(time, low, high, color=colour, alpha=0.2, lw=0, label="95 % interval")
        for code in np.unique(states):
            word = words_of[int(code)]
            used[word], here = STATUS[word], states == code
            axes.plot(time[here], best[here], ".", ms=3, color=STATUS[word], zorder=3)
            axes.broken_barh(
                _runs(time, here),
                (0, STRIP),
                color=STATUS[word],
                lw=0,
                transform=axes.get_xaxis_transform(),
                zorder=2,
            )
    if "measured_temperature" in result:
        read = result.measured_temperature
        axes.plot(read.time, read, ".", ms=1.5, color="0.6", zorder=1, label="as measured")
    for word, colour in used.items():
        axes.plot([], [], "s", ms=5, color=colour, label=word.replace("_", " "))
    finite = np.concatenate([result[name].values[np.isfinite(result[name].values)] for name in given(result)])
    if finite.size:
        low, high = np.quantile(finite, (0, 0.995))
        room = max(0.12 * (high - low), 40.0)
        axes.set_ylim(low - 1.8 * room, high + room)
    events(axes, result)
    axes.set(xlabel="time [s]", ylabel="surface temperature [K]")
    axes.legend(ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.16))


def spectra(axes, test, result):
    """Radiance of the gas in the reference, and of the surface at a few moments with Planck fits."""
    wavelength, top = result.wavelength.values * NANO, []
    if "reference_radiance" in result and np.isfinite(result.reference_radiance).any():
        gas = result.reference_radiance.values / MICRO
        axes.plot(wavelength, np.where(gas > 0, gas, np.nan), color="0.55", lw=0.9, label="gas (reference)")
        top.append(np.nanmax(gas))
    places = shown_spectra(result.spectrometer_temperature)
    for place, colour in zip(places, style.case_colours(max(len(places), 1)), strict=False):
        one = result.isel(spectrum_time=place)
        values = one.corrected_radiance.values / MICRO
        top.append(np.nanmax(values))
        label = f"{float(one.spectrum_time):.4g} s, {float(one.spectrometer_temperature):.0f} K"
        axes.plot(wavelength, np.where(values > 0, values, np.nan), ".", ms=1.5, color=colour)
        with np.errstate(invalid="ignore", divide="ignore"):  # a pixel without light has no scale
            scale = np.nanmedian(values / one.normalised_radiance.values)
        axes.plot(wavelength, scale * one.normalised_fit.values, color=colour, lw=1.2, label=label)
    if top and max(top) > 0:
        axes.set_yscale("log")
        axes.set_ylim(max(top) / DECADES, 3 * max(top))
    axes.set(xlabel="wavelength, vacuum [nm]", ylabel="radiance [W m$^{-2}$ sr$^{-1}$ µm$^{-1}$]")
    axes.legend(ncols=2)


def emissivities(axes, test, result):
    """Emissivity over wavelength with its 95 % interval, at a few moments."""
    wavelength = result.emissivity_wavelength.values * NANO
    places = shown_spectra(result.spectral_temperature)
    for place, colour in zip(places, style.case_colours(max(len(places), 1)), strict=False):
        one = result.isel(spectrum_time=place)
        axes.fill_between(wavelength, *one.emissivity_interval.values, color=colour, alpha=0.15, lw=0)
        axes.plot(wavelength, one.emissivity, color=colour, lw=1.2, label=f"{float(one.spectrum_time):.4g} s")
    axes.set(xlabel="wavelength, vacuum [nm]", ylabel="emissivity [1]")
    axes.legend(ncols=2)


def panels(test, result):
    """Drawing functions for what a test holds, by name."""
    found = {"signals": signals} if "signal_wide" in test else {}
    found["temperatures"] = temperatures
    shown = "emissivity" in result and np.isfinite(result.emissivity).any()
    found |= {"emissivity": emissivities} if shown else {}
    return found | ({"spectra": spectra} if "corrected_radiance" in result else {})


def picture(test, result, paths):
    """All panels of a test in one figure; `result` of contract 'correction' or 'joint_estimate'."""
    test, result = thinned(test), thinned(result)
    drawn = panels(test, result).values()
    _, axes = style.figure(size=(5.6, 2.9 * len(drawn)), nrows=len(drawn), squeeze=False)
    for one, draw in zip(axes[:, 0], drawn, strict=True):
        draw(one, test, result)
    style.save(axes[0, 0], paths, result)
