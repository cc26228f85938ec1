"""Which known causes can bring a family of flows onto a measured pair, and how much of each it takes."""

import numpy as np

from plasmapyro.checks import flags
from plasmapyro.facility.causes import NAMES, TOLD, causes
from plasmapyro.facility.prediction import MIDDLE, scale

LEAST = 5e-4  # probability below which a cause is not listed
SUFFICES = 2.0  # standard uncertainties within which a cause explains
FLAGS = {1: "explains", 0: "too_much_heat", -1: "too_little_heat", 2: "pressure_outside"}
WORDS = {
    1: "explains: some admissible recombination meets the pair",
    0: "does not explain: too much heat at the measured pressure, whatever admissible recombination",
    -1: "does not explain: too little heat at the measured pressure, whatever admissible recombination",
    2: "not known: the measured pressure lies outside that of the flows",
}


def judge(found, admissible):
    r"""Add to readings and pairs what each pair asks of recombination, probe and momentum.

    At the measured pressure (read by each Pitot probe) the flows give q(gamma): `needed_recombination` is the
    gamma that meets the measured flux, NaN where none does; `heat_left` is q over the measured flux at both
    ends of the admissible recombination. The other way round, `momentum_left` is the measured pressure over
    that of the flow which gives the measured flux: what momentum, or a mixing that makes the jet colder at
    the same momentum, would have to supply. `cause_probability` names causes, see `causes`; what each leaves
    free lies between the ends `cause_mixing` and so on, 95 %.

    Parameters
    ----------
    found : Dataset
        With the variables of contract 'facility' but those of the verdict, sorted by pressure.
    admissible : pair of float [1]

    Returns
    -------
    Dataset, contract 'facility'
    """
    gamma = found.recombination.values
    shape = tuple(found.sizes[name] for name in ("pair", "rates", "pitot_radius"))
    needed, verdict = np.full(shape, np.nan), np.empty(shape, dtype="int8")
    heat, momentum = np.full((*shape, 2), np.nan), np.full((*shape, 2), np.nan)
    power, kelvin = np.full((shape[0], shape[2]), np.nan), np.full((shape[0], shape[2]), np.nan)
    for pair, rates, radius in np.ndindex(shape):
        pressure = found.pitot_pressure.values[:, radius]
        flux = found.stagnation_heat_flux.values[:, rates]
        target, goal = found.pair_heat_flux.values[pair], found.pair_pressure.values[pair]
        at_ends = np.stack([_along(one, gamma, flux) for one in admissible])  # (2, condition)
        momentum[pair, rates, radius] = [goal / _inside(target, ends, pressure) for ends in at_ends]
        if not pressure[0] <= goal <= pressure[-1]:
            verdict[pair, rates, radius] = 2
            continue
        there = np.array([_inside(goal, pressure, column) for column in flux.T])
        power[pair, radius] = _inside(goal, pressure, found.numerical_power.values)
        kelvin[pair, radius] = _inside(goal, pressure, found.edge_temperature.values)
        needed[pair, rates, radius] = _recombination(target, there, gamma)
        ends = np.array([_inside(goal, pressure, one) for one in at_ends])
        heat[pair, rates, radius] = ends / target
        margin = SUFFICES * found.pair_flux_uncertainty.values[pair]
        verdict[pair, rates, radius] = (
            0 if ends.min() > target + margin else -1 if ends.max() < target - margin else 1
        )
    dims = ("pair", "rates", "pitot_radius")
    return named(found, admissible).assign(
        needed_recombination=(dims, needed),
        heat_left=((*dims, "bound"), heat),
        momentum_left=((*dims, "bound"), momentum),
        matching_power=(("pair", "pitot_radius"), power),
        matching_temperature=(("pair", "pitot_radius"), kelvin),
        pair_verdict=(dims, verdict, flags(FLAGS)),
    )


def named(found, admissible):
    """Readings and pairs with the causes of each pair, their probabilities and sizes; see `causes`."""
    names = ["none", *NAMES, "unknown"]
    probability = np.empty((found.sizes["pair"], len(names)))
    sizes = {size: np.full((*probability.shape, 2), np.nan) for size in TOLD}
    for pair, row in enumerate(probability):
        one = found.isel(pair=pair)
        flux, read = float(one.pair_heat_flux), float(one.pair_pressure)
        known = causes(
            flux, read, admissible=admissible,
            flux_uncertainty=float(one.pair_flux_uncertainty) / flux,
            pressure_uncertainty=float(one.pair_pressure_uncertainty) / read,
        )  # fmt: skip
        for k, name in enumerate(names):
            row[k] = known[name][0]
            for size, ends in known[name][1].items():
                sizes[size][pair, k] = ends
    columns = {f"cause_{size}": (("pair", "cause", "bound"), ends) for size, ends in sizes.items()}
    return found.assign_coords(cause=names).assign(
        cause_probability=(("pair", "cause"), probability), **columns
    )


def _along(gamma, known, flux):
    """Heat flux (condition,) at one recombination, linear in gamma / (gamma + middle) of the known ones."""
    order = np.argsort(known)
    return np.array([np.interp(scale(gamma), scale(known[order]), row[order]) for row in flux])


def _recombination(target, flux, known):
    """Recombination at which the heat flux is `target`; NaN outside the known ones."""
    order = np.argsort(known)
    rising = flux[order]
    if not rising[0] <= target <= rising[-1]:
        return np.nan
    part = np.interp(target, rising, scale(known[order]))
    return MIDDLE * part / (1 - part)


def _inside(x, known, values):
    """Linear in the logarithms; NaN outside."""
    if not known[0] <= x <= known[-1]:
        return np.nan
    return float(np.exp(np.interp(np.log(x), np.log(known), np.log(values))))


def as_markdown(found):
    """The verdict as a page, of a dataset of contract 'facility'."""
    low, high = found.attrs["admissible_recombination"]
    lines = [
        "# What measured pairs of heat flux and Pitot pressure say of these flows",
        "",
        f"Admissible recombination {low:g} to {high:g}. Heat left: computed over measured heat flux at the"
        " measured pressure, at both ends. Momentum left: measured over computed pressure where the heat"
        " flux is the measured one.",
        "",
        "| pair | rates | Pitot radius | power there | temperature ahead | recombination needed | heat left |"
        " momentum left | recombination alone |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for pair, name in enumerate(found.pair.values):
        for rates, kind in enumerate(found.rates.values):
            for radius, size in enumerate(found.pitot_radius.values):
                at = pair, rates, radius
                lines.append(
                    f"| {name} | {kind} | {size * 1e3:g} mm | "
                    f"{_word(found.matching_power.values[pair, radius] / 1e3, '.0f', ' kW')} | "
                    f"{_word(found.matching_temperature.values[pair, radius], '.0f', ' K')} | "
                    f"{_word(found.needed_recombination.values[at], '.4f')} | "
                    f"{_words(found.heat_left.values[at])} | {_words(found.momentum_left.values[at])} | "
                    f"{WORDS[int(found.pair_verdict.values[at])]} |"
                )
    lines += [
        "",
        "## Names",
        "",
        "Causes alone and together, with the priors of a diagnosis, and 95 % of what each leaves free, the"
        " mixing in torch radii. `none`: a good catalyst (0.1 to 1), a nose of 25 mm, a laminar jet;"
        " `unknown`: something else. A measured temperature ahead of the probe decides between causes.",
        "",
        "| pair | cause | probability | temperature ahead | power | mixing | recombination | Pitot nose |"
        " momentum |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for name in found.pair.values:
        one = found.sel(pair=name).sortby("cause_probability", ascending=False)
        for k in np.flatnonzero(one.cause_probability.values >= LEAST):
            cells = [
                _words(factor * one[f"cause_{size}"].values[k], form, unit)
                for size, (factor, form, unit) in TOLD.items()
            ]
            probability = f"{float(one.cause_probability[k]):.3f}"
            lines.append(f"| {name} | {one.cause.values[k]} | {probability} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _word(value, form, unit=""):
    return f"{value:{form}}{unit}" if np.isfinite(value) else "-"


def _words(pair, form=".2f", unit=""):
    return " to ".join(_word(one, form) for one in pair) + unit if np.isfinite(pair).any() else "-"
