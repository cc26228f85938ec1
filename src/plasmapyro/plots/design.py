"""Figures of the design: bands before the spectrum, trade-off, error maps, shelf, reflecting samples,
trust.
"""

import numpy as np

from plasmapyro.plots import style

KELVIN = "Object temperature $T_{obj}$ [K]"
KIND_MARKS = {  # kind: label, marker, colour
    "reference": ("MR1SB (modelled response)", "s", style.NARROW),
    "robust optimum": ("two bands, robust", "*", "#117733"),
    "optimum": ("two bands, smallest error", "P", "#117733"),
    "filters": ("filters that can be bought", "D", "#7b4ba0"),
    "shelf": ("pyrometers on the shelf", "o", style.WIDE),
}
SURFACE_DASHES = {"no reflection": ":", "mirror": "--", "mixed": "-.", "matt": "-"}


def _short(name):
    return (
        str(name)
        .replace("MR1SB, modelled response", "Raytek MR1SB, modelled response")
        .replace("Raytek Marathon MR1S", "Raytek MR1S box")
        .replace("extended InGaAs", "ext. InGaAs")
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
    drawing, (top, low) = style.figure((7.0, 5.0), nrows=2, sharex=True, height_ratios=[1.5, 1])
    nanometre = spectra.wavelength * 1e9
    gas = spectra.binned_radiance.sel(state="nominal", condition=condition).sum("component")
    top.semilogy(nanometre, gas * 1e-6, color="0.15", lw=0.7, label=f"gas, {condition}, 1 nm bins")
    colours = style.case_colours(surface.sizes["object_temperature"])
    for row, colour in zip(surface.surface_radiance, colours, strict=True):
        label = f"surface, {float(row.object_temperature):g} K, $\\varepsilon={surface.attrs['emittance']:g}$"
        top.semilogy(surface.wavelength * 1e9, row * 1e-6, color=colour, label=label)
    top.set(ylabel=r"Radiance [W m$^{-2}$ sr$^{-1}$ $\mu$m$^{-1}$]", ylim=(1e-1, 1e7))
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
    low.set_yticks(range(rows.size), [_short(designs.design.values[row]) for row in rows], fontsize=5.5)
    low.set(xlabel="Wavelength in vacuum [nm]", xlim=(nanometre[0], nanometre[-1]))
    style.mark_origin(top, spectra)
    style.save(drawing, paths)


def trade_off(designs, paths):
    """Sensitivity of the ratio against the temperature above which the gas adds less than the level."""
    drawing, axes = style.figure((5.6, 3.6))
    slope, limit = designs.candidate_sensitivity.values, designs.candidate_limit.values
    axes.plot(slope, limit, ".", ms=1.2, color="0.75", rasterized=True, label="pairs of the coarse grid")
    front = designs.candidate_on_front.values == 1
    order = np.argsort(slope[front])
    axes.plot(slope[front][order], limit[front][order], "k.-", ms=3, lw=0.9, label="Pareto front")
    mean = designs.design_limit.mean("condition", skipna=False).values
    count = np.isfinite(designs.band_centre.values).sum(axis=1)
    kinds = designs.design_kind.values.astype(str)
    best = np.isin(designs.design.values, [designs.attrs["best_two_band"], designs.attrs["lowest_two_band"]])
    for kind, (label, marker, colour) in KIND_MARKS.items():
        rows = (kinds == kind) & ((count == 2) | (kind == "reference"))
        rows &= best | (kind not in ("optimum", "robust optimum"))
        axes.plot(designs.ratio_sensitivity.values[rows], mean[rows], marker, ms=6, color=colour, label=label)
    level = 100 * designs.attrs["error_level"]
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
    axes.set(
        xlabel=r"Sensitivity of the ratio at 1500 K, $d\ln\rho/d\ln T$ [–]",
        ylabel=f"Gas shifts less than {level:g} % above [K]\n(mean over the powers)",
        xlim=(0, None),
    )
    style.mark_origin(axes, designs)
    style.save(drawing, paths)


def error_maps(designs, paths):
    """Curves of the error level of the reference, the robust and the smallest-error design, side by side."""
    chosen = [designs.design.values[0], designs.attrs["best_two_band"], designs.attrs["lowest_two_band"]]
    drawing, panels = style.figure((7.4, 2.9), ncols=3, sharex=True, sharey=True)
    labels = style.case_labels(designs.condition.values, designs.numerical_power)
    for axes, name in zip(panels, chosen, strict=True):
        case = designs.sel(design=name)
        for number, colour in enumerate(style.case_colours(designs.sizes["condition"])):
            axes.plot(
                case.map_limit.isel(condition=number), designs.emittance, color=colour, label=labels[number]
            )
        centres = case.band_centre.values * 1e9
        widths = case.band_width.values * 1e9
        text = " + ".join(f"{c:.0f}/{w:.0f}" for c, w in zip(centres, widths, strict=True) if np.isfinite(c))
        title = {"reference": "MR1SB", "robust optimum": "robust two bands", "optimum": "smallest error"}
        heading = title[str(case.design_kind.values)]
        axes.set_title(
            heading + (f"\n{case.design_detector.item()}, {text} nm" if text else "\nmodelled"), fontsize=7
        )
    level = 100 * designs.attrs["error_level"]
    panels[1].set_xlabel(rf"{KELVIN} at $|e|={level:g}$ %")
    panels[0].set(ylabel=r"Emittance $\varepsilon$ [–]", ylim=(0, 1), xlim=(700, 2600))
    style.legend_beside(panels[2])
    style.mark_origin(panels[2], designs)
    style.save(drawing, paths)


def shelf(designs, paths):
    """Temperature above which the gas adds less than the level: instruments by power, in numbers."""
    rows = _chosen(designs)
    limit = designs.design_limit.values[rows]
    drawing, axes = style.figure((7.2, 0.28 * rows.size + 1.2))
    shown = axes.imshow(limit, aspect="auto", cmap="RdYlGn_r", vmin=800, vmax=1900)
    middle = 1350
    for (place, case), value in np.ndenumerate(limit):
        text = f"{value:.0f}" if np.isfinite(value) else "–"
        dark = np.isfinite(value) and abs(value - middle) > 450
        axes.text(case, place, text, ha="center", va="center", fontsize=6.5, color="w" if dark else "k")
    axes.set_yticks(range(rows.size), [_short(designs.design.values[row]) for row in rows], fontsize=6)
    axes.set_xticks(
        range(designs.sizes["condition"]),
        style.case_labels(designs.condition.values, designs.numerical_power),
    )
    axes.grid(False)
    level, emittance = 100 * designs.attrs["error_level"], designs.attrs["limit_emittance"]
    axes.set_title(
        f"The gas shifts the reading by less than {level:g} % above this temperature [K],"
        rf" $\varepsilon={emittance:g}$,"
        " no reflection\n(one band: emittance known)",
        fontsize=7.5,
    )
    drawing.colorbar(shown, ax=axes, label="[K]", fraction=0.03)
    style.save(drawing, paths)


def reflecting_samples(reflection, conditions, paths):
    """The error level over emittance for samples that reflect differently, and what neglect costs."""
    drawing, panels = style.figure((7.4, 3.0), ncols=3)
    level = 100 * reflection.attrs["error_level"]
    colours = style.case_colours(len(conditions))
    labels = style.case_labels(conditions, reflection.numerical_power.sel(condition=conditions))
    for axes, correction in zip(panels[:2], ("none", "reference"), strict=True):
        for surface, dash in SURFACE_DASHES.items():
            for name, colour in zip(conditions, colours, strict=True):
                curve = reflection.error_limit.sel(surface=surface, correction=correction, condition=name)
                axes.plot(curve, reflection.emittance, dash, color=colour)
        title = "as read" if correction == "none" else "reference of the cold sample subtracted"
        axes.set_title(title, fontsize=7)
        axes.set(xlabel=rf"$T_{{obj}}$ [K] at $e={level:g}$ %", ylim=(0, 1), xlim=(800, None))
    panels[0].set_ylabel(r"Emittance $\varepsilon$ [–]")
    for surface, dash in (("mirror", "--"), ("mixed", "-."), ("matt", "-")):
        for name, colour, label in zip(conditions, colours, labels, strict=True):
            curve = reflection.neglect_limit.sel(surface=surface, correction="none", condition=name)
            panels[2].plot(
                curve, reflection.emittance, dash, color=colour, label=label if surface == "matt" else None
            )
    cost = reflection.attrs["neglect_tolerance"]
    panels[2].set_title(f"neglecting reflection costs < {cost:g} K", fontsize=7)
    panels[2].set(xlabel="above this $T_{obj}$ [K]", ylim=(0, 1), xlim=(800, None))
    lines = [panels[0].plot([], [], dash, color="0.3")[0] for dash in SURFACE_DASHES.values()]
    panels[0].legend(lines, list(SURFACE_DASHES), loc="upper right")
    style.legend_beside(panels[2])
    style.mark_origin(panels[2], reflection)
    style.save(drawing, paths)


def trust(result, paths):
    """Temperature from which each setup reads within the first level, against power, for two kinds of
    sample.
    """
    drawing, panels = style.figure((7.4, 3.3), ncols=result.sizes["surface"], sharey=True)
    power = result.numerical_power.values / 1e3
    styles = [
        (style.NARROW, "s-"),
        (style.NARROW, "s--"),
        (style.NARROW, "s:"),
        ("#7b4ba0", "D-"),
        (style.WIDE, "o-"),
        ("#44aa66", "P-"),
        ("#117733", "*-"),
        ("#117733", "*--"),
    ]
    for axes, surface in zip(panels, result.surface.values, strict=True):
        for setup, (colour, mark) in zip(result.setup.values, styles, strict=True):
            limit = result.trust_temperature.sel(surface=surface, setup=setup).isel(trust_level=0)
            axes.plot(power, limit, mark, ms=3.5, color=colour, label=_short(setup))
        axes.set_title(f"{surface} sample", fontsize=8)
        axes.set_xlabel("Numerical power $P_{el}^{sim}$ [kW]")
    low, high = result.attrs["emittance_range"]
    level = 100 * float(result.trust_level[0])
    panels[0].set_ylabel(f"Within {level:g} % from [K], emittance {low:g} to {high:g}")
    handles, names = panels[0].get_legend_handles_labels()
    drawing.legend(handles, names, loc="outside lower center", ncols=2, fontsize=6)
    style.mark_origin(panels[-1], result)
    style.save(drawing, paths)
