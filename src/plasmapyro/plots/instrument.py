"""Figures of the instruments: responses, calibration of the pyrometer, calibration of the spectrometer."""

from plasmapyro.plots import style

MOST_NAMED = 8  # bands with a name each in the legend


def responses(response, paths):
    """Figure 3a: normalised spectral responses of the bands."""
    _, axes = style.figure(size=(3.0, 2.6))
    wavelength, (curves, names) = response.wavelength.values * 1e6, style.responsivities(response)
    for number, name, colour in style.bands(names, most=len(names)):
        label = rf"$\tilde{{R}}_{{\lambda,{number}}}$ ({name})" if len(names) < MOST_NAMED else None
        axes.plot(wavelength, curves[number - 1], color=colour, label=label)
    if len(names) < MOST_NAMED:
        axes.legend(loc="upper left", ncols=1 + len(names) // 3)
    first, last = min(0.70, wavelength[0]), max(1.20, wavelength[-1])
    top = 1.25 if len(names) < 3 else 1.5
    axes.set(xlabel="Wavelength [µm]", ylabel="Normalised response [–]", xlim=(first, last), ylim=(0, top))
    title = response.attrs.get("instrument", "modelled: layered silicon, long-pass edge")
    axes.set_title(title, loc="left", fontsize=7)
    style.save(axes, paths)


def calibration(calibrated, paths):
    """Figure 3b: signal ratio against source temperature, modelled curve, quadratic fit, residuals."""
    _, (upper, lower) = style.figure(size=(4.2, 3.6), nrows=2, sharex=True, height_ratios=(3, 1))
    curve = calibrated.calibration_temperature
    low, high = calibrated.instrument_range.values
    fitted = (curve >= calibrated.fit_range[0]) & (curve <= calibrated.fit_range[1])
    beyond = (curve >= calibrated.fit_range[1]) & (curve <= high)
    phi, spread = float(calibrated.sensitivity_ratio), float(calibrated.sensitivity_ratio_uncertainty)
    upper.plot(
        curve, calibrated.calibration_ratio, "k-", label=rf"model, $\varphi$ = {phi:.4f} $\pm$ {spread:.4f}"
    )
    upper.plot(
        curve[fitted], calibrated.fitted_ratio[fitted], "--", color=style.NARROW, label="quadratic fit"
    )
    upper.plot(
        curve[beyond], calibrated.fitted_ratio[beyond], ":", color=style.NARROW, label="fit, extrapolated"
    )
    upper.plot(
        calibrated.source_temperature, calibrated.point_ratio, "o", ms=3.5, color=style.WIDE, label="points"
    )
    upper.legend()
    inside = (curve >= low) & (curve <= high)
    top = float(calibrated.calibration_ratio[inside].max())
    upper.set(ylabel=r"Signal ratio $\rho_c$ [–]", xlim=(low - 50, high + 50), ylim=(0, 1.08 * top))
    lower.axhline(0, color="k", lw=0.7)
    lower.plot(
        calibrated.source_temperature, 100 * calibrated.model_residual, "o", ms=3, color="k", label="model"
    )
    lower.plot(
        calibrated.source_temperature,
        100 * calibrated.fit_residual,
        "s",
        ms=3,
        color=style.NARROW,
        label="fit",
    )
    lower.legend(ncols=2)
    lower.set(xlabel="Source temperature [K]", ylabel="Residual [%]", ylim=(-3, 3))
    style.save(upper, paths, calibrated)


def spectrometer_factor(calibrated, paths):
    """Figure 4b: calibration factor of the spectrometer."""
    _, axes = style.figure(size=(3.9, 3.0))
    good = calibrated.pixel_status == 0
    axes.semilogy(
        calibrated.wavelength[good] * 1e9,
        calibrated.calibration_factor[good] * 1e-6,
        color=style.WIDE,
        lw=0.8,
    )
    axes.set(
        xlabel="Wavelength [nm]",
        ylabel="Calibration factor $f_\\lambda^c$\n[W m$^{-2}$ sr$^{-1}$ µm$^{-1}$ s count$^{-1}$]",
    )
    other = axes.secondary_yaxis("right", functions=(lambda si: 100 * si, lambda paper: paper / 100))
    other.set_ylabel("[mW ms count$^{-1}$ cm$^{-2}$ µm$^{-1}$ sr$^{-1}$]")
    style.save(axes, paths, calibrated)
