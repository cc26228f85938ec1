"""Figures of a parameter study: from which surface temperature on a reading is good, over its conditions."""

import numpy as np

from plasmapyro.plots import style

PANEL = (2.3, 2.5)  # of one mass flow rate [inch]
BARE = "0.85"  # colour of a condition without a flow


def limit_over_conditions(study, paths):
    """Limit of the error over power and pressure, one panel per mass flow rate.

    At the middle emittance and angle. Grey: there is no number; a word says why.
    """
    chosen = _middle(study, "emittance", "sightline_angle")
    rates = study.mass_flow_rate.values
    drawing, rows = style.figure(
        size=(PANEL[0] * rates.size + 1.2, PANEL[1]), ncols=rates.size, squeeze=False
    )
    values = chosen.error_limit
    known = values.values[np.isfinite(values.values)]
    low, high = (known.min(), known.max()) if known.size else (0.0, 1.0)
    mesh = None
    for axes, rate in zip(rows[0], rates, strict=True):
        panel = values.sel(mass_flow_rate=rate)
        axes.set_facecolor(BARE)
        axes.grid(False)
        power, pressure = np.arange(panel.numerical_power.size), np.arange(panel.chamber_pressure.size)
        mesh = axes.imshow(
            panel.values.T, origin="lower", aspect="auto", vmin=low, vmax=max(high, low + 1), cmap="viridis"
        )
        _mark_cells(axes, chosen.sel(mass_flow_rate=rate))
        axes.set_xticks(power, [f"{value / 1e3:g}" for value in panel.numerical_power.values])
        axes.set_yticks(pressure, [f"{value / 100:g}" for value in panel.chamber_pressure.values])
        axes.set_title(f"{rate * 1e3:g} g/s", fontsize=8, loc="left")
        axes.set_xlabel("Numerical power [kW]")
    rows[0, 0].set_ylabel("Chamber pressure [mbar]")
    level = 100 * float(study.attrs["error_level"])
    drawing.colorbar(mesh, ax=rows[0].tolist(), label=f"$T_{{obj}}$ at $e={level:g}$ % [K]")
    drawing.suptitle(_where(chosen), fontsize=8)
    style.save(rows[0, -1], paths, study)


def limit_over_emittance(study, paths):
    """The same over emittance, one line per angle, at the middle power, pressure and mass flow rate."""
    chosen = _middle(study, "numerical_power", "chamber_pressure", "mass_flow_rate")
    _, axes = style.figure(size=style.BESIDE)
    colours = style.case_colours(chosen.sightline_angle.size)
    for angle, colour in zip(chosen.sightline_angle, colours, strict=True):
        limit = chosen.error_limit.sel(sightline_angle=angle)
        axes.plot(
            limit, chosen.emittance, "o-", ms=2.5, color=colour, label=f"{np.degrees(float(angle)):.3g}°"
        )
    level = 100 * float(study.attrs["error_level"])
    axes.set(
        xlabel=rf"Object temperature $T_{{obj}}$ at $e={level:g}$ % [K]",
        ylabel=r"Emittance $\varepsilon$ [–]",
        ylim=(0, 1.02),
    )
    style.legend_beside(axes, title="angle to the axis")
    axes.set_title(_where(chosen), fontsize=7, loc="left")
    style.save(axes, paths, study)


def _middle(study, *dims):
    """The study at the middle value of some dimensions."""
    return study.isel({dim: study.sizes[dim] // 2 for dim in dims})


def _mark_cells(axes, panel):
    """A word on each cell without a number: why there is none."""
    words = {1: "out", 2: "unsteady", 3: ""}
    for i, j in np.ndindex(panel.numerical_power.size, panel.chamber_pressure.size):
        cell = panel.isel(numerical_power=i, chamber_pressure=j)
        status, limit = int(cell.study_status), int(cell.study_limit_status)
        word = words.get(status, {-1: "below", 1: "above"}.get(limit, ""))
        axes.text(i, j, word, ha="center", va="center", fontsize=6, color="0.2")


def _where(chosen):
    """The values at which a figure was drawn."""
    units = {
        "numerical_power": (1e-3, "kW"),
        "chamber_pressure": (1e-2, "mbar"),
        "mass_flow_rate": (1e3, "g/s"),
        "emittance": (1.0, ""),
        "sightline_angle": (np.degrees(1.0), "°"),
    }
    told = [
        f"{float(chosen[name]) * factor:.4g} {unit}".strip().replace(" °", "°")
        for name, (factor, unit) in units.items()
        if chosen[name].ndim == 0
    ]
    return ("emittance " if "emittance" in chosen.coords and chosen.emittance.ndim == 0 else "") + ", ".join(
        told
    )
