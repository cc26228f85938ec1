"""Figure of the facility: heat flux against Pitot pressure."""

from plasmapyro.plots import style

RATES = {  # of recombination in the gas before the wall
    "kossyi": "rates measured (kossyi)",
    "gupta": "rates from shocks (gupta)",
    "park": "rates from shocks (park)",
}


def pairs(found, paths):
    """Computed flows ('facility') in the plane of heat flux and Pitot pressure, beside measured pairs."""
    _, axes = style.figure(size=(5.6, 3.8))
    pressure = found.pitot_pressure.values[:, 0]
    axes.plot(
        pressure, found.equilibrium_heat_flux * 1e-3, color="0.1", lw=1.6, label="equilibrium at the wall"
    )
    colours = style.case_colours(found.sizes["recombination"])
    for kind, dash in zip(found.rates.values, style.DASHES, strict=False):
        for gamma, colour in zip(found.recombination.values, colours, strict=True):
            flux = found.stagnation_heat_flux.sel(rates=kind, recombination=gamma) * 1e-3
            label = f"recombination $\\gamma$ = {gamma:g}" if kind == found.rates.values[0] else None
            axes.plot(pressure, flux, color=colour, ls=dash, label=label)
    for kind, dash in zip(found.rates.values, style.DASHES, strict=False):
        axes.plot([], [], color="0.5", ls=dash, label=RATES.get(kind, kind))
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
        axes.annotate(str(name), (x, y), xytext=(7, 5), textcoords="offset points", fontsize=7)
    axes.set(
        xlabel="Pitot pressure above that of the chamber [Pa]", ylabel="Heat flux [kW m$^{-2}$]",
        xscale="log", yscale="log",
    )  # fmt: skip
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("{x:g}")
    axes.tick_params(which="both", labelsize=6)
    power = " to ".join(
        f"{one / 1e3:g}" for one in (found.numerical_power.min(), found.numerical_power.max())
    )
    face, nose = (f"{1e3 * one:g} mm" for one in (found.attrs["probe_radius"], found.pitot_radius[0]))
    axes.set_title(
        f"laminar jets of {power} kW; hemisphere of {face}, Pitot nose of {nose}", loc="left", fontsize=7
    )
    style.legend_beside(axes, fontsize=7).set_title("")
    style.save(axes, paths, found)
