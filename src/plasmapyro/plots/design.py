"""Figures of the design: bands and spectrum, trade-off, error maps, shelf, reflecting samples, trust."""

import numpy as np

from plasmapyro.plots import style

ZIGZAG = "Corners: the light of the gas in the two bands cancels there, and the error changes its sign."
KELVIN = "Object temperature $T_{obj}$ [K]"
KIND_MARKS = {  # kind: label, marker, colour
    "reference": ("{name} ({response})", "s", style.NARROW),
    "robust optimum": ("two bands, robust", "*", "#117733"),
    "optimum": ("two bands, smallest error", "P", "#117733"),
    "filters": ("filters that can be bought", "D", "#7b4ba0"),
    "shelf": ("pyrometers on the shelf", "o", style.WIDE),
}
DARK = 1400.0  # [K], from which the colour of a cell wants white letters
SURFACE_COLOURS = {"no reflection": "0.55", "mirror": "#56b4e9", "mixed": "#e69f00", "matt": "#7a2048"}
REFLECTION_PANELS = (("error_limit", "none"), ("error_limit", "reference"), ("neglect_limit", "none"))


def _short(name):
    return (
        str(name)
        .replace("MR1SB, modelled response", "Raytek MR1SB, modelled response")
        .replace("Raytek Marathon MR1S", "Raytek MR1S box")
        .replace("extended InGaAs", "ext. InGaAs")
        .replace(" um)", " µm)")
    )


def _chosen(designs):
    """Rows of the reference, the best designs, filters and shelf, with limits, from worst to best."""
    kind = designs.design_kind.values.astype(str)
    bands = np.isfinite(designs.band_centre.values).sum(axis=1)
    named = np.isin(designs.design.values, [designs.attrs["best_two_band"], designs.attrs["lowest_two_band"]])
    wanted = named | np.isin(kind, ["reference", "shelf"]) | ((kind == "optimum") & (bands == 1))
    wanted |= (kind == "filters") & (np.cumsum(kind == "filters") <= 4)
    rows = np.flatnonzero(wanted & np.isfinite(designs.total_error.values))
    return rows[np.argsort(-designs.total_error.values[rows], kind="stable")]


def bands(spectra, designs, surface, condition, paths):
    """Where the bands lie on the spectrum of the gas and of hot surfaces (contract 'surface_radiance')."""
    _, (top, low) = style.figure((7.0, 5.0), nrows=2, sharex=True, height_ratios=[1.5, 1])
    nanometre = spectra.wavelength * 1e9
    gas = spectra.binned_radiance.sel(state="nominal", condition=condition).sum("component")
    label = dict(zip(spectra.condition.values, style.curves_in(spectra), strict=True))[condition].label
    top.semilogy(nanometre, gas * 1e-6, color="0.15", lw=0.7, label=f"gas, {label}, 1 nm bins")
    colours = style.case_colours(surface.sizes["object_temperature"])
    for row, colour in zip(surface.surface_radiance, colours, strict=True):
        label = f"surface, {float(row.object_temperature):g} K, $\\varepsilon={surface.attrs['emittance']:g}$"
        top.semilogy(surface.wavelength * 1e9, row * 1e-6, color=colour, label=label)
    top.set(ylabel=r"Radiance [W m$^{-2}$ sr$^{-1}$ µm$^{-1}$]", ylim=(1e-1, 1e7))
    top.legend(loc="upper left", ncols=3)
    rows = _chosen(designs)
    rows = rows[np.isfinite(designs.band_centre.values[rows, 0])]
    for place, row in enumerate(rows):
        kind = str(designs.design_kind.values[row])
        for number in range(designs.sizes["design_band"]):
            centre, width = (
                float(designs[name][row, number]) * 1e9 for name in ("band_centre", "band_width")
            )
            low.barh(
                place + 0.18 * (1 - 2 * (number % 2)),
                width,
                left=centre - width / 2,
                height=0.34,
                color=KIND_MARKS[kind][2],
                alpha=0.85 if number % 2 == 0 else 0.5,
            )
    low.set_yticks(range(rows.size), [_short(designs.design.values[row]) for row in rows], fontsize=6.5)
    low.set(xlabel="Wavelength in vacuum [nm]", xlim=(nanometre[0], nanometre[-1]))
    style.save(top, paths, spectra)


def trade_off(designs, paths):
    """Sensitivity of the ratio against the temperature above which the gas adds less than the level."""
    _, axes = style.figure((5.6, 3.6))
    slope, limit = designs.candidate_sensitivity.values, designs.candidate_limit.values
    axes.plot(slope, limit, ".", ms=1.2, color="0.75", rasterized=True, label="pairs of the coarse grid")
    front = designs.candidate_on_front.values == 1
    order = np.argsort(slope[front])
    axes.plot(slope[front][order], limit[front][order], "k.-", ms=3, lw=0.9, label="Pareto front")
    mean = designs.design_limit.mean("condition", skipna=False).values
    count = np.isfinite(designs.band_centre.values).sum(axis=1)
    kinds = designs.design_kind.values.astype(str)
    best = np.isin(designs.design.values, [designs.attrs["best_two_band"], designs.attrs["lowest_two_band"]])
    name, response = str(designs.design.values[0]).rsplit(", ", 1)
    for kind, (words, marker, colour) in KIND_MARKS.items():
        label = words.format(name=name, response=response)
        rows = (kinds == kind) & ((count == 2) | (kind == "reference"))
        rows &= best | (kind not in ("optimum", "robust optimum"))
        axes.plot(designs.ratio_sensitivity.values[rows], mean[rows], marker, ms=6, color=colour, label=label)
    level = 100 * designs.attrs["error_level"]
    style.legend_beside(axes, title=None)
    axes.set(
        xlabel=r"Sensitivity of the ratio at 1500 K, $d\ln\rho/d\ln T$ [–]",
        ylabel=f"Gas shifts less than {level:g} % above [K]\n(mean over the powers)",
        xlim=(0, None),
    )
    style.save(axes, paths, designs)


def error_maps(designs, paths):
    """Curves of the error level of the reference, the robust and the smallest-error design, side by side."""
    chosen = [designs.design.values[0], designs.attrs["best_two_band"], designs.attrs["lowest_two_band"]]
    drawing, panels = style.figure((7.4, 3.1), ncols=3, sharex=True, sharey=True)
    for axes, name in zip(panels, chosen, strict=True):
        case = designs.sel(design=name)
        for limit, curve in zip(case.map_limit.values, style.curves_in(designs), strict=True):
            axes.plot(limit, designs.emittance, **curve.options)
        centres = case.band_centre.values * 1e9
        widths = case.band_width.values * 1e9
        text = " + ".join(f"{c:.0f}/{w:.0f}" for c, w in zip(centres, widths, strict=True) if np.isfinite(c))
        own = str(name).split(",")[0]
        title = {"reference": own, "robust optimum": "robust two bands", "optimum": "smallest error"}
        heading = title[str(case.design_kind.values)]
        axes.set_title(
            heading + (f"\n{case.design_detector.item()}, {text} nm" if text else "\nmodelled"), fontsize=7
        )
    level = 100 * designs.attrs["error_level"]
    panels[1].set_xlabel(rf"{KELVIN} at $|e|={level:g}$ %")
    panels[0].set(ylabel=r"Emittance $\varepsilon$ [–]", ylim=(0, 1), xlim=(700, 2600))
    style.legend_beside(panels[2])
    drawing.supxlabel(ZIGZAG, fontsize=6.5, color="0.3")
    style.save(panels[2], paths, designs)


def shelf(designs, paths):
    """Temperature above which the gas adds less than the level: instruments by power, in numbers."""
    rows = _chosen(designs)
    limit = designs.design_limit.values[rows]
    drawing, axes = style.figure((7.2, 0.28 * rows.size + 1.2))
    shown = axes.imshow(limit, aspect="auto", cmap="cividis_r", vmin=800, vmax=1900)
    for (place, case), value in np.ndenumerate(limit):
        text = f"{value:.0f}" if np.isfinite(value) else "–"
        dark = np.isfinite(value) and value > DARK
        axes.text(case, place, text, ha="center", va="center", fontsize=7, color="w" if dark else "k")
    axes.set_yticks(range(rows.size), [_short(designs.design.values[row]) for row in rows], fontsize=6)
    axes.set_xticks(range(designs.sizes["condition"]), [curve.label for curve in style.curves_in(designs)])
    axes.grid(False)
    level, emittance = 100 * designs.attrs["error_level"], designs.attrs["limit_emittance"]
    axes.set_title(
        f"The gas shifts the reading by less than {level:g} % above this temperature [K],"
        rf" $\varepsilon={emittance:g}$,"
        " no reflection\n(one band: emittance known)",
        fontsize=7.5,
    )
    drawing.colorbar(shown, ax=axes, label="[K]", fraction=0.03)
    style.save(axes, paths)


def reflecting_samples(reflection, conditions, paths):
    """The error level over emittance for samples that reflect differently, and what neglect costs.

    A colour for each kind of sample, a line for each power.
    """
    drawing, panels = style.figure((7.4, 3.4), ncols=3)
    level = 100 * reflection.attrs["error_level"]
    shown = reflection.sel(condition=conditions)
    dashes = [style.DASHES[::-1][k % len(style.DASHES)] for k in range(len(conditions))]
    for axes, (name, correction) in zip(panels, REFLECTION_PANELS, strict=True):
        for surface, colour in SURFACE_COLOURS.items():
            rows = shown[name].sel(surface=surface, correction=correction).values
            for row, dash in zip(rows, dashes, strict=True):
                axes.plot(row, reflection.emittance, dash, color=colour)
        axes.set(xlabel=rf"$T_{{obj}}$ [K] at $e={level:g}$ %", ylim=(0, 1), xlim=(800, None))
    cost = reflection.attrs["neglect_tolerance"]
    titles = (
        "as read",
        "reference of the cold sample subtracted",
        f"neglecting reflection costs < {cost:g} K",
    )
    for axes, title in zip(panels, titles, strict=True):
        axes.set_title(title, fontsize=7.5)
    panels[0].set_ylabel(r"Emittance $\varepsilon$ [–]")
    panels[2].set_xlabel("above this $T_{obj}$ [K]")
    kinds = [panels[0].plot([], [], color=colour)[0] for colour in SURFACE_COLOURS.values()]
    lines = [panels[0].plot([], [], dash, color="0.2")[0] for dash in dashes]
    labels = [*SURFACE_COLOURS, *(curve.label for curve in style.curves_in(shown))]
    drawing.legend([*kinds, *lines], labels, loc="outside lower center", ncols=len(labels))
    style.save(panels[2], paths, reflection)


def trust(result, paths):
    """Temperature from which each setup reads within the first level, against power, for two samples."""
    drawing, panels = style.figure((7.4, 3.8), ncols=result.sizes["surface"], sharey=True)
    power = result.numerical_power.values / 1e3
    styles = [
        ("#7a1f14", "s-"),
        ("#e8743b", "v--"),
        ("#f2a900", "^-."),
        ("#7b4ba0", "D-"),
        (style.WIDE, "o-"),
        ("#6cc08b", "P-"),
        ("#0b4f2f", "*-"),
        ("#117733", "x--"),
    ]
    for axes, surface in zip(panels, result.surface.values, strict=True):
        for setup, (colour, mark) in zip(result.setup.values, styles, strict=True):
            limit = result.trust_temperature.sel(surface=surface, setup=setup).isel(trust_level=0)
            axes.plot(power, limit, mark, ms=3.5, color=colour, label=_short(setup))
        axes.set_title(f"{surface} sample", fontsize=8)
        axes.set_xlabel("Numerical power [kW]")
    low, high = result.attrs["emittance_range"]
    level = 100 * float(result.trust_level[0])
    panels[0].set_ylabel(f"Right within {level:g} % from [K]")
    panels[0].annotate(
        rf"$\varepsilon$ = {low:g} to {high:g}", (0.03, 0.95), xycoords="axes fraction", va="top", fontsize=7
    )
    handles, names = panels[0].get_legend_handles_labels()
    drawing.legend(handles, names, loc="outside lower center", ncols=2, fontsize=7)
    style.save(panels[-1], paths, result)
