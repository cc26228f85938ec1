"""Figures of the paper's section 4: visibility, apparent temperature, error, error map, transient."""

import numpy as np

from plasmapyro.plots import style

# Back wall of the torch -> grey, and power over that with a cold wall at which the gas is as bright: 40 and
# 53 % more signal (docs/flow_matters.csv, 90 kW), by that of the wide band from 90 to 110 kW.
BACK_WALLS = {"back wall of 7200 K": ("0.82", 1.105), "adiabatic back wall": ("0.5", 1.13)}


def visibility_factors(visibility, paths):
    """Figure 7a: visibility factor against surface temperature, one panel per band (of many, three)."""
    shown = style.bands(visibility.band.values, most=3)
    _, panels = style.figure(size=(3.2 * len(shown), 2.8), ncols=len(shown), sharey=True, squeeze=False)
    for axes, (number, band, _) in zip(panels[0], shown, strict=True):
        _one_line_per_power(axes, visibility, visibility.visibility_factor.sel(band=band))
        axes.set_title(f"band {number} ({band})", loc="left", fontsize=8)
        axes.set(xlabel="Object temperature $T_{obj}$ [K]", ylim=(-0.02, 1.02), xlim=(500, 2000))
    panels[0, 0].set_ylabel(r"Visibility factor $\nu_{\Delta\lambda_i}$ [–]")
    style.legend_beside(panels[0, -1])
    style.save(panels[0, -1], paths, visibility)


def visibility_limits(visibility, paths):
    """Figure 7b: surface temperature at which the visibility factor reaches its levels, against power.

    Powers of one pressure are joined; each further pressure is drawn paler. Conditions without a power are
    left out.
    """
    many = visibility.sizes["band"] > 2
    _, axes = style.figure(size=style.BESIDE) if many else style.figure()
    known = visibility.isel(condition=np.isfinite(visibility.numerical_power.values))
    pressures = known.get("chamber_pressure", known.numerical_power * np.nan).fillna(0.0).values
    several = len(np.unique(pressures)) > 1
    for place, pressure in enumerate(np.unique(pressures)[::-1]):
        where = f", {pressure / 100:g} mbar" if several else ""
        some = known.isel(condition=pressures == pressure).sortby("numerical_power")
        for level, marker in zip(visibility.visibility_level.values, "osD^", strict=False):
            for number, band, colour in style.bands(visibility.band.values, most=5):
                axes.plot(
                    some.numerical_power / 1e3,
                    some.visibility_limit.sel(visibility_level=level, band=band),
                    marker + style.DASHES[(number - 1) % len(style.DASHES)],
                    ms=3.5,
                    color=colour,
                    alpha=1.0 / (1 + place),
                    label=rf"$\nu_{{{number}}}={level:.2f}$" + where,
                )
    style.legend_beside(axes, title=None) if many else axes.legend(ncols=2)
    axes.set(xlabel="Numerical power [kW]", ylabel="Object temperature $T_{obj}$ [K]")
    style.save(axes, paths, visibility)


def apparent_temperature(reading, paths):
    """Figure 8a: temperature read through the gas against the true one."""
    _, axes = style.figure(size=style.BESIDE)
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
    style.save(axes, paths, reading)


def relative_error(reading, paths):
    """Figure 8b: relative error against the true temperature."""
    _, axes = style.figure(size=style.BESIDE)
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
    style.save(axes, paths, reading)


def _one_line_per_power(axes, dataset, values):
    for row, curve in zip(values.values, style.curves_in(dataset), strict=True):
        axes.plot(dataset.object_temperature, row, **curve.options)


def error_map(errors, paths):
    """Figure 8c: curves of one error level over emittance and surface temperature."""
    _, axes = style.figure(size=style.BESIDE)
    for row, curve in zip(errors.error_limit.values, style.curves_in(errors), strict=True):
        axes.plot(row, errors.emittance, **curve.options)
    _bands_of_back_walls(axes, errors)
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
    style.save(axes, paths, errors)


def _bands_of_back_walls(axes, errors):
    """What back walls of the torch that take little or nothing would do to the middle one of some powers."""
    ladder = errors.sortby("numerical_power")
    power, limit = ladder.numerical_power.values, ladder.error_limit.values
    middle, pressures = len(power) // 2, np.unique(ladder.get("chamber_pressure", ladder.condition[:1]))
    if len(power) < 3 or len(pressures) > 1 or not np.all(np.diff(power) > 0):
        return
    colder = limit[middle]
    for wall, (grey, factor) in BACK_WALLS.items():
        warmer = [np.interp(factor * power[middle], power, column) for column in limit.T]
        words = f"{power[middle] / 1e3:g} kW with\n{wall}"
        axes.fill_betweenx(ladder.emittance, colder, warmer, color=grey, lw=0, zorder=0, label=words)
        colder = warmer


def transient(history, paths):
    """Figure 8d: true and apparent temperature while a sample heats."""
    _, axes = style.figure()
    axes.plot(history.time, history.object_temperature_history, "k-", label="$T_{obj}$")
    for row, curve in zip(history.apparent_temperature.values, style.curves_in(history), strict=True):
        axes.plot(history.time, row, color=curve.color, ls=curve.dash, label=f"$T_{{app}}$, {curve.label}")
    axes.axhspan(*history.instrument_range.values, color="0.92", zorder=0, label="instrument range")
    axes.legend()
    axes.set(xlabel="Time after injection $t$ [s]", ylabel="Temperature [K]", ylim=(300, 3500))
    style.save(axes, paths, history)
