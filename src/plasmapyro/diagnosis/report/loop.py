"""One page: what was wrong, what was changed, and what became better or worse outside the fit."""

import numpy as np

from plasmapyro.diagnosis.fit.terms import AMPLITUDE
from plasmapyro.quantities import behind
from plasmapyro.record.status import VALID

BLOCKS = 10  # of time or emittance, for the standard error of a root mean square
BETTER = 2.0  # standard errors from which a change counts
MATTERS = 0.01  # of what it was: a smaller change helps nobody, however sure
ODDS = 3.0  # log score of a single number from which it counts: odds of 20
CHANGED = {"power": "the flow is solved again", "T_exc": "the light is computed again"}
NOTE = f"""A log score is the logarithm of the probability that a model gives to data: +3 are odds of 20.
Standard errors come from blocks of the data; a change of less than {BETTER:g} of them, or of
{100 * MATTERS:g} %, is called none. Kelvin are root mean squares over valid samples. The gas is that of the
reference window; "read with the simulated gas": it is taken from the signals in place of the measured one,
and held against the temperature that the measured one gives. The error map is held against that of the
measured gas, over all emittances and temperatures that the instrument reads."""
SEEN = "The gas that the fit saw"
READ = "read with the simulated gas, K"
HEAD = "| measured on | base | extended | change ± standard error | |", "|---|---|---|---|---|"


def loop_page(name, base, extended, corrections, predictions, terms=(), beside=None):
    """Markdown text of the loop base -> diagnosis -> extended of a test.

    `base`, `extended`: reports of the diagnosis without and with what was named; `corrections`: of each,
    those of pyrometer and spectrometer; `predictions`: test -> pair of `simulation.predicted.Prediction`;
    `terms`: what was changed in the simulation; `beside`: test -> `claims.beside.Beside` of the base,
    extended and measured gas.
    """
    named = base["extended"]["terms"] if base["extended"] else []
    words = {row["id"]: row for row in base["candidates"]}
    wrong = [
        f"- {words[term['id']]['sentence']} Taken out of the data." for term in named if term["id"] in words
    ]
    wrong += [f"- The simulation: {_change(term)}." for term in terms]
    changed = {*(term["id"] for term in named), *(term.setting.id for term in terms)}
    changed |= {"P_eff"} if "power" in changed else set()  # by another name
    left = [words[i]["sentence"] for i in base["verdict"]["named"] if i in words and i not in changed]
    wrong += [f"- {sentence} Of the simulation; not changed." for sentence in left]
    parts = {
        "Blocks of time that were left out of the fit": list(_held_out(base)),
        "One instrument against the other": [*_foretold(base), *_between_instruments(corrections)],
    }
    for test, pair in predictions.items():
        unseen = f"The gas of {test}, at another condition, which no fit saw"
        parts[SEEN if test == name else unseen] = list(_of_simulation(*pair, (beside or {}).get(test)))
    verdicts = {word: [] for word in ("better", "worse", "no change")}
    for part, rows in parts.items():
        for row in rows if part != SEEN else ():
            verdicts[row[-1]].append(f"{part[0].lower()}{part[1:]}: {row[0]}")
    lines = [f"# What {name} taught the model", ""]
    lines += [_summary(parts, verdicts), "", "## What was wrong, and what was changed", ""]
    lines += wrong or ["Nothing was named: the extended run is the base run."]
    lines += ["", "## Base and extended, side by side", ""]
    for part, rows in parts.items():
        lines += [f"### {part}", "", *HEAD, *(f"| {' | '.join(row)} |" for row in rows), ""] if rows else []
    for test, found in (beside or {}).items():
        lines += [f"### The paper's claims, before the gas of {test}", ""]
        lines += ["| claim | base | extended | measured gas |", "|---|---|---|---|"]
        lines += [
            f"| {said} | {' | '.join(f'{value:.4g}' for value in values)} |" for said, values in found.claims
        ]
        lines.append("")
    lines += ["## What the extended model still finds", "", extended["verdict"]["sentences"][0], ""]
    lines.append(NOTE)
    return "\n".join(lines) + "\n"


def _change(term):
    """What a term of the condition changes, in words."""
    effect, size = term.setting.effect, term.setting.amplitude
    error = term.uncertainty.get(AMPLITUDE, 0.0)
    what = f"{size:+.3g} ± {error:.2g}{behind(effect.unit)}"
    if effect.unit == "1":
        what = f"{size:+.1%} ± {error:.1%}"
    return f"{effect.name}, {effect.amplitude} {what}; {CHANGED.get(effect.id, CHANGED['T_exc'])}"


def _summary(parts, verdicts):
    """The outcome in two sentences."""
    said = [
        f"{part}: read with the simulated in place of the measured one, the temperature errs by {row[2]} K"
        f" (rms), by {row[1]} K with the base simulation. "
        for part, rows in parts.items()
        for row in rows
        if part != SEEN and row[0] == READ
    ]
    first = "".join(said)
    count = {word: len(rows) for word, rows in verdicts.items()}
    worse = f": {'; '.join(verdicts['worse'])}" if verdicts["worse"] else ""
    return (
        f"{first}Of {sum(count.values())} comparisons outside the fit {count['better']} became better,"
        f" {count['no change']} did not change, {count['worse']} became worse{worse}."
    )


def _row(what, before, after, change, error, larger_is_better=False):
    gained = change if larger_is_better else -change
    least = max(BETTER * error, MATTERS * abs(float(before)))
    word = "better" if gained > least else "worse" if gained < -least else "no change"
    digits = max(0, 1 - int(np.floor(np.log10(error)))) if error > 0 else 0
    return what, before, after, f"{change:+.{digits}f} ± {error:.{digits}f}", word


def _held_out(base):
    gain = base["gain"]
    if gain is not None:
        change, error = gain["heldout_log_score"], gain["heldout_standard_error"]
        yield _row("log score", "0", f"{change:+.0f}", change, error, True)


def _foretold(base):
    for what, key in (
        ("pyrometer foretold by the spectrometer, log score", "cross_instrument"),
        ("tests at other conditions with what was named, log score", "cross_condition"),
    ):
        size = None if base["gain"] is None else base["gain"][key]
        if size is not None:
            word = "better" if size > ODDS else "worse" if size < -ODDS else "no change"
            yield what, "0", f"{size:+.0f}", "one number", word


def _between_instruments(corrections):
    """Temperature of the pyrometer less that of the spectrometer, two instruments that share no signal."""
    apart = []
    for pyrometer, spectra in corrections:
        time, frames = pyrometer["time"].values, spectra["spectrum_time"].values
        half = np.median(np.diff(frames)) / 2
        first, last = (np.searchsorted(time, frames + side * half) for side in (-1, 1))
        good = pyrometer["corrected_status"].values == VALID
        total = np.concatenate([[0], np.cumsum(np.where(good, pyrometer["corrected_temperature"].values, 0))])
        count = np.concatenate([[0], np.cumsum(good)])
        number = count[last] - count[first]
        mean = (total[last] - total[first]) / np.where(number > 0, number, np.nan)
        fitted = spectra["scaled_temperature"].values
        apart.append(np.where(spectra["spectrum_status"].values == VALID, mean - fitted, np.nan))
    yield from _kelvin("pyrometer less spectrometer, K", *apart)


def _of_simulation(before, after, beside):
    yield from _kelvin(READ, before.temperature, after.temperature)
    if beside is not None:
        base, extended, measured = beside.errors
        yield from _kelvin("error map, K", *(np.ravel(one - measured) for one in (base, extended)))
    for what, one in (("in the bands", "signal"), ("in the spectrum, blocks of 25 nm", "spectrum")):
        sizes = [100 * float(np.sqrt(np.mean(getattr(pair, one) ** 2))) for pair in (before, after)]
        spread = np.abs(getattr(after, one)) - np.abs(getattr(before, one))
        error = 100 * float(np.std(spread, ddof=1) / np.sqrt(spread.size))
        yield _row(f"gas {what}, % rms", *(f"{size:.1f}" for size in sizes), sizes[1] - sizes[0], error)
    change = after.log_score - before.log_score
    error = float(np.std(change, ddof=1) * np.sqrt(change.size))
    scores = (f"{pair.log_score.sum():.1f}" for pair in (before, after))
    yield _row("gas, log score", *scores, float(change.sum()), error, True)


def _kelvin(what, before, after):
    """Row of two series (t,) [K] of errors, where both have values; nothing without any."""
    both = np.isfinite(before) & np.isfinite(after)
    if both.sum() < BLOCKS:
        return
    pairs = [np.sqrt(np.mean(row[both] ** 2)) for row in (before, after)]
    parts = [
        [np.sqrt(np.mean(part**2)) for part in np.array_split(row[both], BLOCKS)] for row in (before, after)
    ]
    error = float(np.std(np.subtract(*parts[::-1]), ddof=1) / np.sqrt(BLOCKS))
    yield _row(what, *(f"{size:.2f}" for size in pairs), float(pairs[1] - pairs[0]), error)
