"""Figures of the light of the gas: all conditions with a surface; one line of sight, one spectrum."""

from plasmapyro.plots import style


def spectral_radiance(radiances, surface, bands, paths):
    """Figure 6: gas radiance by condition with that of a grey surface, and the pyrometer bands."""
    _, axes = style.figure(size=(7.2, 4.0))
    for spectrum, curve in zip(radiances.values(), style.curves_of(radiances), strict=True):
        axes.semilogy(
            spectrum.wavelength_slit * 1e9,
            spectrum.gas_radiance_slit * 1e-6,
            color=curve.color,
            lw=0.6,
            label=curve.label,
        )
    first, last = surface.wavelength.values[[0, -1]] * 1e9
    for temperature in surface.object_temperature.values:
        curve = surface.surface_radiance.sel(object_temperature=temperature) * 1e-6
        axes.semilogy(surface.wavelength * 1e9, curve, "k--", lw=0.8)
        beside = last + 1, float(curve[-1])
        axes.annotate(f"{temperature:.0f} K", beside, fontsize=7, va="center", annotation_clip=False)
    for number, curve in enumerate(style.responsivities(bands)[0]):
        inside = bands.wavelength.values[curve > 0.05] * 1e9
        axes.axvspan(inside[0], inside[-1], color=("0.93", "0.86")[number % 2], zorder=0)
    axes.legend(title="gas $L_\\lambda^{g,e}$ at the numerical power", ncols=5, loc="lower center")
    axes.set(
        xlim=(first, last),
        ylim=(1e-3, 3e5),
        xlabel="Wavelength (vacuum) [nm]",
        ylabel="Spectral radiance [W m$^{-2}$ sr$^{-1}$ µm$^{-1}$]",
    )
    emittance = float(surface.attrs["emittance"])
    axes.set_title(
        rf"dashed: grey surface, $\varepsilon$ = {emittance:g}; shaded: bands of the pyrometer",
        loc="left",
        fontsize=7,
    )
    style.save(axes, paths, *radiances.values())


def line_of_sight(line, paths):
    """Temperature along one line of sight, above the pressure."""
    _, (upper, lower) = style.figure(size=(4.6, 3.4), nrows=2, height_ratios=(3, 1), sharex=True)
    path = line.path_distance * 1e3
    upper.plot(path, line.temperature, color=style.NARROW)
    lower.plot(path, line.pressure / 100, color=style.WIDE)
    upper.set(ylabel="Temperature [K]", ylim=(0, None))
    lower.set(xlabel=r"Path distance $\zeta$ [mm]", ylabel="Pressure [mbar]")
    style.save(upper, paths, line)


def spectrum(radiance, paths, most=4):
    """One spectrum ('spectrum' or 'radiation') through its slit, with its `most` brightest components."""
    _, axes = style.figure(size=(5.6, 3.2))
    nanometre = radiance.wavelength_slit * 1e9
    axes.semilogy(nanometre, radiance.gas_radiance_slit * 1e-6, "k-", lw=1.0, label="all", zorder=5)
    parts = radiance.gas_radiance_component_slit
    for one in parts.sortby(-parts.sum("wavelength_slit"))[:most]:
        axes.semilogy(nanometre, one * 1e-6, lw=0.7, label=str(one.component.values))
    top = float(radiance.gas_radiance_slit.max()) * 1e-6
    if top > 0:
        axes.set_ylim(1e-6 * top, 3 * top)
    axes.legend(ncols=most + 1, loc="lower center")
    axes.set(xlabel="Wavelength (vacuum) [nm]", ylabel="Spectral radiance [W m$^{-2}$ sr$^{-1}$ µm$^{-1}$]")
    style.save(axes, paths, radiance)
