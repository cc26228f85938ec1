"""Figure of the facility: heat flux against Pitot pressure."""

from plasmapyro.plots import style

DASHES = ("-", "--", "-.", ":")


def pairs(found, paths):
    """Computed flows in the plane of heat flux and Pitot pressure, beside measured pairs.

    Parameters
    ----------
    found : Dataset, contract 'facility'
    paths : paths of the files to write
    """
    _, axes = style.figure(size=(5.6, 3.8))
    pressure = found.pitot_pressure.values[:, 0]
    axes.plot(pressure, found.equilibrium_heat_flux * 1e-3, color="0.1", lw=1.6, label="equilibrium")
    colours = style.case_colours(found.sizes["recombination"])
    for kind, dash in zip(found.rates.values, DASHES, strict=False):
        for gamma, colour in zip(found.recombination.values, colours, strict=True):
            flux = found.stagnation_heat_flux.sel(rates=kind, recombination=gamma) * 1e-3
            label = f"$\\gamma$ = {gamma:g}" if kind == found.rates.values[0] else None
            axes.plot(pressure, flux, color=colour, ls=dash, label=label)
    for name, colour in zip(found.pitot_radius.values[1:], ("#4e79a7", "#59a14f", "#af7aa1"), strict=False):
        reading = found.pitot_pressure.sel(pitot_radius=name)
        axes.plot(
            reading, found.equilibrium_heat_flux * 1e-3, color=colour, lw=0.9,
            label=f"equilibrium, Pitot nose {name * 1e3:g} mm",
        )  # fmt: skip
    axes.errorbar(
        found.pair_pressure, found.pair_heat_flux * 1e-3, fmt="s", color="#d62728", capsize=2, zorder=5,
        xerr=found.pair_pressure_uncertainty, yerr=found.pair_flux_uncertainty * 1e-3, label="measured",
    )  # fmt: skip
    for name, x, y in zip(found.pair.values, found.pair_pressure, found.pair_heat_flux * 1e-3, strict=True):
        axes.annotate(str(name), (x, y), xytext=(5, -10), textcoords="offset points", fontsize=7)
    kinds = ", ".join(f"{name} {dash}" for name, dash in zip(found.rates.values, DASHES, strict=False))
    axes.set(
        xlabel="Pitot pressure above that of the chamber [Pa]", ylabel="Heat flux [kW m$^{-2}$]",
        xscale="log", yscale="log",
    )  # fmt: skip
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("{x:g}")
    axes.tick_params(which="both", labelsize=6)
    axes.set_title(
        f"hemisphere of {found.attrs['probe_radius'] * 1e3:g} mm; rates: {kinds}", loc="left", fontsize=8
    )
    style.legend_beside(axes, fontsize=7).set_title("")
    style.save(axes, paths, found)
