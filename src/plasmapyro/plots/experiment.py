"""Figures of a test: signals, temperatures before and after correction, spectra, two instruments."""

import itertools

import numpy as np

from plasmapyro.plots import style

GAS_DOMINATED = 5  # status of a reading whose signal is mostly gas: kept in the file, not drawn
NOISE_PIXELS = 60  # that tell the noise of a spectrum
FAINTEST = 1.0  # [W m-2 sr-1 um-1], lower end of the axis
DEFAULT_SLIT, SMOOTH_BIN = 0.75e-9, 4e-9  # [m], widths of bins


def after_injection(dataset):
    """Results of a test with their times counted from the injection, whatever clock the test was on."""
    start = dataset.attrs["injection_time"]
    own = {name: dataset[name] - start for name in ("time", "spectrum_time") if name in dataset.coords}
    events = {"injection_time": 0.0, "plasma_off_time": dataset.attrs["plasma_off_time"] - start}
    return dataset.assign_coords(own).assign_attrs(events)


def figures(given, radiances, times, paths):
    """All figures of a test; `given`: its datasets by name, those of the instruments that it has.

    `radiances` (contract 'radiation', by condition) are shown beside a spectrum, the spectra at `times` [s];
    `paths` has the files of each figure under the figure's name.
    """
    pyrometer, spectra = given.get("pyrometer"), given.get("spectrometer")
    if pyrometer is not None:
        sample_emittance(given["test"], paths.fig9b_sample_emittance)
        signals(pyrometer, paths.fig10a_signals)
        temperatures(pyrometer, paths.fig10b_temperatures)
        error_of_measured(pyrometer, paths.fig10c_error)
        joint_temperature(pyrometer, given["joint"], paths.joint_estimate)
    if spectra is not None:
        reference_spectrum(spectra, radiances, paths.fig11a_reference_spectrum)
        normalised_spectra(spectra, times, paths.fig11b_normalised_spectra)
    if pyrometer is not None and spectra is not None:
        two_instruments(pyrometer, spectra, paths.fig11c_two_instruments)


def signals(corrected, paths):
    """Figure 10a: signals of both bands with their reference levels."""
    corrected = after_injection(corrected)
    _, axes = style.figure(size=(5.2, 2.8))
    for number, (band, colour) in enumerate((("wide", style.WIDE), ("narrow", style.NARROW)), start=1):
        axes.semilogy(
            corrected.time, corrected[f"signal_{band}"], color=colour, lw=0.8, label=f"$S_{number}$ ({band})"
        )
        level = float(corrected.reference_signal.sel(band=band))
        axes.axhline(level, color=colour, ls="--", lw=0.8, label=rf"$S_{number}^{{ref}}$")
    start, end = corrected.attrs["reference_window"]
    axes.axvspan(start, end, color="0.85", zorder=0, label="reference window")
    for moment, word in (
        (corrected.attrs["injection_time"], "injection"),
        (corrected.attrs["plasma_off_time"], "plasma off"),
    ):
        axes.axvline(moment, color="0.4", lw=0.7, ls=":")
        axes.annotate(
            word, (moment, 0.02), xycoords=("data", "axes fraction"), rotation=90, fontsize=6, ha="right"
        )
    axes.legend(ncols=2)
    axes.set(xlabel="Time after injection $t$ [s]", ylabel="Signal [A]")
    style.save(axes, paths, corrected)


def temperatures(corrected, paths):
    """Figure 10b: apparent temperature as measured and corrected, with the corrected one's uncertainty."""
    corrected = after_injection(corrected)
    _, axes = style.figure(size=(4.4, 2.8))
    time = corrected.time
    trusted = corrected.corrected_status != GAS_DOMINATED
    best = corrected.corrected_temperature.where(trusted)
    spread = corrected.corrected_temperature_uncertainty.where(trusted)
    axes.fill_between(
        time, best - 2 * spread, best + 2 * spread, color=style.NARROW, alpha=0.2, lw=0, label="95 %"
    )
    axes.plot(time, corrected.measured_temperature, ".", ms=1.2, color="0.35", label="$T_{app}^{meas}$")
    axes.plot(time, best, ".", ms=1.2, color=style.NARROW, label="$T_{app}^{corr}$")
    for bound in corrected.instrument_range.values:
        axes.axhline(bound, color="0.5", lw=0.7, ls=":")
    axes.legend(markerscale=5)
    low, high = corrected.instrument_range.values
    axes.set(xlabel="Time after injection $t$ [s]", ylabel="Temperature [K]", ylim=(low - 100, high + 100))
    style.save(axes, paths, corrected)


def error_of_measured(corrected, paths):
    """Figure 10c: relative error of the measured against the corrected temperature, while heating."""
    corrected = after_injection(corrected)
    _, axes = style.figure(size=(2.9, 2.8))
    heating = (corrected.time >= 0) & (corrected.time <= corrected.attrs["plasma_off_time"])
    axes.semilogy(
        corrected.corrected_temperature[heating],
        100 * np.abs(corrected.relative_error[heating]),
        ".",
        ms=1.5,
        color=style.WIDE,
    )
    for level in (1, 10):
        axes.axhline(level, color="0.4", lw=0.7, ls=":")
    axes.set(
        xlabel="$T_{app}^{corr}$ [K]",
        ylabel=r"$|T_{app}^{meas}-T_{app}^{corr}|\,/\,T_{app}^{corr}$ [%]",
        ylim=(0.01, 200),
    )
    style.save(axes, paths, corrected)


def sample_emittance(test, paths):
    """Figure 9b: emittance of the sample as the test states it, grey over the bands of the pyrometer."""
    _, axes = style.figure(size=(2.9, 2.6))
    value, spread = test.attrs["emittance"], test.attrs["emittance_uncertainty"]
    axes.fill_between([0.75, 1.15], value - spread, value + spread, color=style.WIDE, alpha=0.25, lw=0)
    axes.plot([0.75, 1.15], [value, value], color=style.WIDE, label=rf"{value:g} $\pm$ {spread:g}, grey")
    axes.legend()
    axes.set(
        xlabel="Wavelength [µm]", ylabel=r"Emittance $\varepsilon_\lambda$ [–]", ylim=(0, 1), xlim=(0.7, 1.2)
    )
    style.save(axes, paths, test)


def _on_bins(wavelength, values, width):
    """Middles [m] of bins of about `width` [m], means of values (W,), and their noise, from neighbours."""
    count = max(1, round(width / float(np.median(np.diff(wavelength)))))
    last = len(wavelength) // count * count
    centre, mean = (part[:last].reshape(-1, count).mean(axis=1) for part in (wavelength, values))
    rough = np.abs(np.diff(values)) / (0.6745 * np.sqrt(2))  # a normal law's standard deviation by its median
    reach = NOISE_PIXELS // 2
    places = np.arange(count // 2, last, count)
    noise = [np.median(rough[max(0, at - reach) : at + reach]) for at in places]
    return centre, mean, np.array(noise) / np.sqrt(count)


def reference_spectrum(spectra, radiances, paths):
    """Figure 11a: spectrum of the reference window, on bins as wide as the slit, and radiances."""
    _, axes = style.figure(size=(7.2, 3.0))
    slit = max((float(one.attrs["slit_fwhm"]) for one in radiances.values()), default=DEFAULT_SLIT)
    centre, mean, noise = _on_bins(spectra.wavelength.values, spectra.reference_radiance.values, slit)
    axes.fill_between(centre * 1e9, FAINTEST, noise * 1e-6, color="0.88", lw=0, label="noise of a bin")
    seen = np.where(mean > noise, mean, np.nan)
    axes.semilogy(
        centre * 1e9, seen * 1e-6, "k-", lw=0.9, label=rf"$L_\lambda^{{ref}}$, {slit * 1e9:g} nm bins"
    )
    colours = (style.NARROW, style.WIDE, "#7a5195", "#ef9b20")
    for spectrum, colour, curve in zip(
        radiances.values(), itertools.cycle(colours), style.curves_of(radiances), strict=False
    ):
        axes.semilogy(
            spectrum.wavelength_slit * 1e9,
            spectrum.gas_radiance_slit * 1e-6,
            color=colour,
            ls=curve.dash,
            lw=0.7,
            label=rf"$L_\lambda^{{g,e}}$, {curve.label}",
        )
    axes.legend(ncols=4)
    axes.set(
        xlim=(750, 1030),
        ylim=(FAINTEST, 3e4),
        xlabel="Wavelength (vacuum) [nm]",
        ylabel="Spectral radiance [W m$^{-2}$ sr$^{-1}$ µm$^{-1}$]",
    )
    style.save(axes, paths, spectra)


def normalised_spectra(spectra, times, paths):
    """Figure 11b: corrected spectra over their value at the pivot, on bins, with the fitted Planck curves."""
    spectra = after_injection(spectra)
    _, axes = style.figure(size=(3.6, 2.9))
    for place, (wanted, colour) in enumerate(zip(times, style.case_colours(len(times)), strict=True)):
        one = spectra.sel(spectrum_time=wanted, method="nearest")
        reading = float(one.spectrometer_temperature)
        result = "no temperature" if np.isnan(reading) else f"{reading:.0f} K"
        label = f"{float(one.spectrum_time):.0f} s, {result}"
        centre, mean, noise = _on_bins(one.wavelength.values, one.normalised_radiance.values, SMOOTH_BIN)
        axes.errorbar(
            centre * 1e9, mean, noise, fmt=".", ms=2.5, elinewidth=0.5, color=colour, zorder=1 + place
        )
        axes.plot(one.wavelength * 1e9, one.normalised_fit, "-", lw=1.0, color=colour, label=label, zorder=9)
    axes.legend(title="time, $T_{sp}$")
    axes.set(
        xlabel="Wavelength (vacuum) [nm]",
        ylabel=f"Normalised radiance, {SMOOTH_BIN * 1e9:g} nm bins [–]",
        ylim=(-0.1, 1.4),
    )
    style.save(axes, paths, spectra)


def two_instruments(pyrometer, spectra, paths):
    """Figure 11c: corrected temperature of the pyrometer and temperature of the spectrometer."""
    pyrometer, spectra = (after_injection(part) for part in (pyrometer, spectra))
    _, axes = style.figure(size=(3.6, 2.9))
    axes.plot(
        pyrometer.time,
        pyrometer.corrected_temperature.where(pyrometer.corrected_status != GAS_DOMINATED),
        ".",
        ms=1.2,
        color=style.NARROW,
        label="$T_{app}^{corr}$",
    )
    usable = spectra.spectrum_status == 0
    axes.errorbar(
        spectra.spectrum_time[usable],
        spectra.spectrometer_temperature[usable],
        2 * spectra.spectrometer_temperature_uncertainty[usable],
        fmt="o",
        ms=1.5,
        lw=0.5,
        color=style.WIDE,
        label="$T_{sp}$ (95 %)",
    )
    low, high = pyrometer.instrument_range.values
    axes.legend()
    axes.set(xlabel="Time after injection $t$ [s]", ylabel="Temperature [K]", ylim=(low - 100, high))
    style.save(axes, paths, pyrometer, spectra)


def joint_temperature(corrected, joint, paths):
    """Temperatures as measured, after the subtraction, and jointly estimated; below, the gas amplitude."""
    corrected, joint = (after_injection(part) for part in (corrected, joint))
    _, (axes, lower) = style.figure(size=(4.6, 4.0), nrows=2, sharex=True, height_ratios=(3, 1))
    time, best = joint.time, joint.surface_temperature
    trusted = corrected.corrected_temperature.where(corrected.corrected_status != GAS_DOMINATED)
    axes.plot(
        corrected.time, corrected.measured_temperature, ".", ms=1.0, color="0.6", label="$T_{app}^{meas}$"
    )
    axes.plot(corrected.time, trusted, ".", ms=1.0, color=style.NARROW, alpha=0.5, label="$T_{app}^{corr}$")
    low, high = joint.surface_temperature_interval.values
    axes.fill_between(time, low, high, color=style.WIDE, alpha=0.3, lw=0, label="95 %")
    axes.plot(time, best, color=style.WIDE, lw=0.9, label="joint estimate")
    axes.legend(markerscale=5, ncols=2)
    valid = (joint.estimate_status == 0) & best.notnull()
    if valid.any():
        start = float(time.where(valid).min())
        axes.annotate(
            f"valid from {start:.1f} s",
            (start, float(best.sel(time=start))),
            (12, -2),
            textcoords="offset points",
            fontsize=7,
            va="top",
        )
    readable = np.concatenate([best.values, trusted.values])
    axes.set(
        ylabel="Temperature [K]", ylim=(np.nanmin(readable) - 80, np.nanpercentile(readable, 99.5) + 120)
    )
    gas, spread = joint.gas_amplitude, 2 * joint.gas_amplitude_uncertainty
    lower.fill_between(time, gas - spread, gas + spread, color=style.NARROW, alpha=0.25, lw=0)
    lower.plot(time, gas, color=style.NARROW, lw=0.9)
    lower.set(xlabel="Time after injection $t$ [s]", ylabel="Gas amplitude [–]", ylim=(0, None))
    style.save(axes, paths, corrected, joint)
