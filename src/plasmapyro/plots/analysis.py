"""Figures of the paper's section 4: visibility, apparent temperature, error, error map, transient."""

import numpy as np

from plasmapyro.plots import style


def visibility_factors(visibility, paths):
    """Figure 6a: visibility factor of both bands against surface temperature."""
    drawing, axes = style.figure(size=style.BESIDE)
    colours = style.case_colours(visibility.sizes["condition"])
    for case, colour, label in zip(
        range(visibility.sizes["condition"]),
        colours,
        style.case_labels(visibility.condition.values, visibility.numerical_power),
        strict=True,
    ):
        for band, dash in (("wide", "-"), ("narrow", "--")):
            factor = visibility.visibility_factor.isel(condition=case).sel(band=band)
            axes.plot(
                visibility.object_temperature,
                factor,
                dash,
                color=colour,
                label=label if band == "wide" else None,
            )
    axes.add_artist(_band_legend(axes, loc="lower right"))
    style.legend_beside(axes)
    axes.set(
        xlabel="Object temperature $T_{obj}$ [K]",
        ylabel=r"Visibility factor $\nu_{\Delta\lambda_i}$ [–]",
        ylim=(-0.02, 1.02),
        xlim=(500, 2000),
    )
    style.mark_origin(axes, visibility)
    style.save(drawing, paths)


def _band_legend(axes, **where):
    lines = [axes.plot([], [], dash, color="0.3")[0] for dash in ("-", "--")]
    return axes.legend(lines, ["band 1 (wide)", "band 2 (narrow)"], **where)


def visibility_limits(visibility, paths):
    """Figure 6b: surface temperature at which the visibility factor reaches its levels, against power."""
    drawing, axes = style.figure()
    order = np.argsort(visibility.numerical_power.values)
    power = visibility.numerical_power.values[order] / 1e3
    for level, marker in zip(visibility.visibility_level.values, "osD^", strict=False):
        for band, colour in (("wide", style.WIDE), ("narrow", style.NARROW)):
            limit = visibility.visibility_limit.sel(visibility_level=level, band=band).values[order]
            number = 1 if band == "wide" else 2
            axes.plot(power, limit, marker + "-", ms=3.5, color=colour, label=rf"$\nu_{number}={level:.2f}$")
    axes.legend(ncols=2)
    axes.set(xlabel="Numerical power $P_{el}^{sim}$ [kW]", ylabel="Object temperature $T_{obj}$ [K]")
    style.mark_origin(axes, visibility)
    style.save(drawing, paths)


def apparent_temperature(reading, paths):
    """Figure 7a: temperature read through the gas against the true one."""
    drawing, axes = style.figure(size=style.BESIDE)
    truth = reading.object_temperature
    axes.plot(truth, truth, "k:", lw=0.9, label="no gas")
    _one_line_per_power(axes, reading, reading.apparent_temperature)
    axes.axhspan(*reading.instrument_range.values, color="0.9", zorder=0, label="instrument range")
    style.legend_beside(axes)
    axes.set(
        xlabel="Object temperature $T_{obj}$ [K]",
        ylabel="Apparent temperature $T_{app}$ [K]",
        xlim=(truth.values[0], truth.values[-1]),
        ylim=(500, 4000),
    )
    style.mark_origin(axes, reading)
    style.save(drawing, paths)


def relative_error(reading, paths):
    """Figure 7b: relative error against the true temperature."""
    drawing, axes = style.figure(size=style.BESIDE)
    _one_line_per_power(axes, reading, 100 * reading.relative_error)
    axes.axhline(1, color="k", lw=0.7, ls=":")
    axes.annotate("1 %", (2480, 1.1), ha="right", fontsize=7)
    axes.set_yscale("log")
    style.legend_beside(axes)
    axes.set(
        xlabel="Object temperature $T_{obj}$ [K]",
        ylabel="Relative error $e$ [%]",
        xlim=(500, 2500),
        ylim=(0.05, 1000),
    )
    style.mark_origin(axes, reading)
    style.save(drawing, paths)


def _one_line_per_power(axes, dataset, values):
    colours = style.case_colours(dataset.sizes["condition"])
    for row, colour, label in zip(
        values.values,
        colours,
        style.case_labels(dataset.condition.values, dataset.numerical_power),
        strict=True,
    ):
        axes.plot(dataset.object_temperature, row, color=colour, label=label)


def error_map(errors, paths):
    """Figure 7c: curves of one error level over emittance and surface temperature."""
    drawing, axes = style.figure(size=style.BESIDE)
    colours = style.case_colours(errors.sizes["condition"])
    for row, colour, label in zip(
        errors.error_limit.values,
        colours,
        style.case_labels(errors.condition.values, errors.numerical_power),
        strict=True,
    ):
        axes.plot(row, errors.emittance, color=colour, label=label)
    level = 100 * float(errors.attrs["error_level"])
    axes.annotate(f"$e < {level:g}$ %", (0.72, 0.85), xycoords="axes fraction", fontsize=8)
    axes.annotate(f"$e > {level:g}$ %", (0.03, 0.04), xycoords="axes fraction", fontsize=8)
    style.legend_beside(axes)
    axes.set(
        xlabel=rf"Object temperature $T_{{obj}}$ at $e={level:g}$ % [K]",
        ylabel=r"Emittance $\varepsilon$ [–]",
        xlim=(600, None),
        ylim=(0, 1),
    )
    style.mark_origin(axes, errors)
    style.save(drawing, paths)


def transient(history, paths):
    """Figure 7d: true and apparent temperature while a sample heats."""
    drawing, axes = style.figure()
    axes.plot(history.time, history.object_temperature_history, "k-", label="$T_{obj}$")
    for row, dash, label in zip(
        history.apparent_temperature.values,
        ("-", "--", "-.", ":"),
        style.case_labels(history.condition.values, history.numerical_power),
        strict=False,
    ):
        axes.plot(history.time, row, dash, color=style.NARROW, label=f"$T_{{app}}$, {label}")
    axes.axhspan(*history.instrument_range.values, color="0.92", zorder=0, label="instrument range")
    axes.legend()
    axes.set(xlabel="Time after injection $t$ [s]", ylabel="Temperature [K]", ylim=(300, 3500))
    style.mark_origin(axes, history)
    style.save(drawing, paths)
