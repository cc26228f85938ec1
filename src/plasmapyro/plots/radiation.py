"""Figure of the radiance of gas and surface."""

from plasmapyro.plots import style


def spectral_radiance(radiances, surface, bands, paths):
    """Figure 6: gas radiance for all powers with that of a grey surface, and the pyrometer bands.

    Parameters
    ----------
    radiances : mapping of condition -> Dataset, contract 'radiation', rising power
    surface : Dataset, contract 'surface_radiance'
    bands : Dataset, contract 'response'
    paths : paths of the files to write
    """
    drawing, axes = style.figure(size=(7.2, 4.0))
    for spectrum, curve in zip(radiances.values(), style.curves_of(radiances), strict=True):
        axes.semilogy(
            spectrum.wavelength_slit * 1e9,
            spectrum.gas_radiance_slit * 1e-6,
            color=curve.color,
            lw=0.6,
            label=curve.label,
        )
    for temperature in surface.object_temperature.values:
        curve = surface.surface_radiance.sel(object_temperature=temperature) * 1e-6
        axes.semilogy(surface.wavelength * 1e9, curve, "k--", lw=0.8)
        axes.annotate(
            f"{temperature:.0f} K", (1201, float(curve[-1])), fontsize=7, va="center", annotation_clip=False
        )
    for name, shade in (("wide", "0.93"), ("narrow", "0.86")):
        inside = bands.wavelength.values[bands[f"responsivity_{name}"].values > 0.05] * 1e9
        axes.axvspan(inside[0], inside[-1], color=shade, zorder=0)
    axes.legend(title="gas $L_\\lambda^{g,e}$ at the numerical power", ncols=5, loc="lower center")
    axes.set(
        xlim=(700, 1200),
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
    style.mark_origin(axes, *radiances.values())
    style.save(drawing, paths)
