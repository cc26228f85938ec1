"""What both pages show of the temperature to take away: the figure on top, and its uncertainty budget."""

import numpy as np

from plasmapyro.page.shell import SIZE, drawn
from plasmapyro.page.tables import table
from plasmapyro.page.words import DASH, kelvin, number, with_unit
from plasmapyro.plots.colours import EXTENDED
from plasmapyro.record import budget
from plasmapyro.record.status import EXTRAPOLATED, VALID

LEAST = 0.005  # [1] of the whole uncertainty: inputs that never add more are counted, not listed
MANY = 500  # points, from which they are drawn small and faint
ROOM = 1.5  # of what nine tenths of the differences fill
BESIDE = {  # severity of a finding, the worst first: what it adds to the verdict
    "contradiction": "but the data contradict themselves",
    "doubt": "but the data are in doubt",
}


def headline(words, edge, findings, best):
    """Verdict of a page and colour of its edge (str, str), which nothing that stands beside it contradicts.

    `words`, `edge`: as they would stand alone; an edge 'open' says itself that something is amiss.
    `findings`: entries of `quality.rule.Finding`; `best`: the recommended estimate, or 'none'.
    """
    against = [said for severity, said in BESIDE.items() if severity in {one["severity"] for one in findings}]
    if best == "none":
        against.append("but no temperature is recommended")
    return (f"{words}, {against[0]}", "open") if against and edge != "open" else (words, edge)


def axis_of(result):
    """Times (t,) [s] of the recommended series."""
    return result[result.recommended_temperature.dims[0]].values


def ends(time):
    """First and last of times (t,) [s] as ends of an axis, which those of a single sample are not."""
    return (min(time), max(time)) if len(time) > 1 else (time[0] - 0.5, time[0] + 0.5)


def counted(state):
    """Samples that count as having a temperature, as the commands count them."""
    return np.isin(state, (VALID, EXTRAPOLATED))


def key_numbers(result):
    """Pairs of a value and what it is: first and highest temperature to take away, and how many there are."""
    time, best = axis_of(result), result.recommended_temperature.values
    good = np.flatnonzero(counted(result.recommended_status.values) & np.isfinite(best))
    boxes = []
    for place, what in ((good[0], "first"), (good[np.argmax(best[good])], "highest")) if good.size else ():
        low, high = result.recommended_temperature_interval.values[:, place]
        boxes.append((f"{best[place]:.0f} ± {_half(low, high)} K", f"{what}, at {time[place]:.4g} s (95 %)"))
    boxes.append((f"{good.size} of {time.size}", "samples with a temperature to take away"))
    return boxes


def _half(low, high):
    half = (high - low) / 2
    return f"{half:.0f}" if half >= 10 else f"{half:.1f}"


def figure(result, others):
    """The recommended temperature with its interval and the others; below, differences in kelvin.

    `others`: (words, time, values, marker, colour) of each.
    """
    time, best = axis_of(result), result.recommended_temperature.values
    low, high = result.recommended_temperature_interval.values
    label, colour_of = "to take away, 95 %", EXTENDED
    if not np.isfinite(best).any() and others:
        (label, time, best, _, colour_of), *others = others
        low, high = best, best
    known = np.isfinite(best)

    def draw(axes):
        axes[0].fill_between(time, low, high, color=colour_of, alpha=0.3, lw=0)
        axes[0].plot(time, best, color=colour_of, lw=1.3, label=label, zorder=3)
        axes[1].fill_between(time, low - best, high - best, color=colour_of, alpha=0.3, lw=0)
        axes[1].axhline(0, color=colour_of, lw=1.0, zorder=3)
        seen = [np.abs(high - best)]
        for words, moment, values, marker, colour in others:
            many = np.isfinite(values).sum() > MANY
            points = {"ls": "", "marker": marker, "ms": 1.5 if many else 2.5, "alpha": 0.4 if many else 1.0}
            style = points if marker else {"lw": 1.1}
            axes[0].plot(moment, values, color=colour, label=words, **style)
            apart = values - np.interp(moment, time[known], best[known], left=np.nan, right=np.nan)
            axes[1].plot(moment, apart, color=colour, **style)
            seen.append(np.abs(apart))
        seen = np.concatenate(seen)
        seen = seen[np.isfinite(seen)]
        if seen.size:
            limit = max(ROOM * np.quantile(seen, 0.9), 5.0)
            axes[1].set_ylim(-limit, limit)
        axes[0].set(ylabel="surface temperature [K]", xlim=ends(time))
        axes[0].legend(loc="lower center", ncols=1)
        axes[1].set(xlabel="time [s]", ylabel="difference [K]")

    ratios = {"gridspec_kw": {"height_ratios": (3, 2)}}
    return drawn(draw, "recommended", (SIZE[0], 4.4), nrows=2, sharex=True, **ratios)


def by_group(result):
    """The uncertainty at a few moments, by what it comes from: standard uncertainties in kelvin."""
    places, time = budget.moments(result.recommended_temperature.values), axis_of(result)
    parts = budget.by_group(result)
    heads = ("moment", "#temperature", *(f"#{group}" for group in parts), "#all together", "#95 % interval")
    rows = []
    for place in places:
        low, high = result.recommended_temperature_interval.values[:, place]
        rows.append(
            (
                f"{time[place]:.4g} s",
                f"{float(result.recommended_temperature[place]):.0f} K",
                *(kelvin(part[place], signed=False) for part in parts.values()),
                kelvin(float(result.recommended_temperature_uncertainty[place]), signed=False),
                f"± {_half(low, high)} K",
            )
        )
    return table(heads, rows)


def inputs(result):
    """The budget of every input (JCGM 100:2008), and how many are too small for a row."""
    places, time = budget.moments(result.recommended_temperature.values), axis_of(result)
    rows, found = [], budget.inputs_of(result)
    whole = budget.combined(found)
    hottest = max(places, key=lambda place: result.recommended_temperature.values[place], default=None)
    shown = [one for one in found if any(abs(one.contribution[at]) > LEAST * whole[at] for at in places)]
    for one in sorted(shown, key=lambda one: -abs(one.contribution[hottest])):
        stated = np.isfinite(one.uncertainty) and one.uncertainty > 0
        slope = one.contribution[hottest] / one.uncertainty if stated else None
        per = "K" if one.unit in ("", "1") else f"K/{one.unit}"
        rows.append(
            (
                one.name,
                one.group,
                with_unit(one.uncertainty, one.unit) if stated else DASH,
                f"{number(slope)} {per}" if stated else DASH,
                one.law,
                _freedom(one.freedom),
                *(_small(one.contribution[at]) for at in places),
            )
        )
    freedom = _freedom(budget.freedom(found, hottest)) if places else DASH
    rows.append(
        ("root of the summed squares", "", "", "", "", freedom, *(_small(whole[at]) for at in places))
    )
    heads = ("input", "kind", "#standard uncertainty", "#sensitivity", "law", "#degrees of freedom")
    return table((*heads, *(f"#K at {time[at]:.4g} s" for at in places)), rows), len(found) - len(shown)


def _freedom(value):
    return "∞" if not np.isfinite(value) else f"{value:.0f}"


def _small(value):
    return number(abs(value), 2)
