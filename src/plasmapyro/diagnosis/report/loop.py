"""One page: what was wrong, what was changed, and what became better or worse outside the fit."""

import numpy as np

from plasmapyro.record.status import VALID

BLOCKS = 10  # of time, for the standard error of a root mean square
BETTER = 2.0  # standard errors from which a change counts


def loop_page(name, base, extended, corrections, predictions):
    """Markdown text of the loop base -> diagnosis -> extended.

    Parameters
    ----------
    name : str
        Of the test.
    base, extended : mappings, reports of the diagnosis without and with what was named
    corrections : pair (base, extended) of (pyrometer, spectrometer) corrections
    predictions : mapping name of a test -> pair (base, extended) of `simulation.predicted.Prediction`

    Returns
    -------
    str
    """
    named = base["extended"]["terms"] if base["extended"] else []
    words = {row["id"]: row for row in base["candidates"]}
    lines = [f"# What {name} taught the model", "", "## What was wrong, and what was changed", ""]
    lines += [f"- {words[term['id']]['sentence']}" for term in named if term["id"] in words]
    lines += [f"- {words[i]['sentence']} (of the gas)" for i in _of_gas(base) if i in words]
    if len(lines) == 4:
        lines.append("Nothing was named: the extended run is the base run.")
    lines += ["", "## What it is worth on data that no fit has seen", ""]
    rows = [*_held_out(base), *_between_instruments(corrections)]
    for test, pair in predictions.items():
        rows += _of_simulation("this test" if test == name else test, *pair)
    lines += ["| measured on | base | extended | change | |", "|---|---|---|---|---|"]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    lines += ["", "## What the extended model still finds", "", extended["verdict"]["sentences"][0], ""]
    lines.append(
        f"A log score is the logarithm of the probability given to the data: +3 are odds of 20. Errors are"
        f" standard errors over blocks; a change of less than {BETTER:g} of them is called none. Kelvin are"
        f' root mean squares over valid samples. The gas is that of the reference window; "read with the'
        f' simulated gas" takes it from the signals in place of the measured one.'
    )
    return "\n".join(lines) + "\n"


def _of_gas(report):
    test = {term["id"] for term in report["extended"]["terms"]} if report["extended"] else set()
    return [identity for identity in report["verdict"]["named"] if identity not in test]


def _row(what, before, after, change, error, larger_is_better=False):
    gained = change if larger_is_better else -change
    word = "better" if gained > BETTER * error else "worse" if gained < -BETTER * error else "no change"
    return what, before, after, f"{change:+.3g} ± {error:.2g}", word


def _held_out(base):
    gain = base["gain"]
    if gain is None:
        return
    change, error = gain["heldout_log_score"], gain["heldout_standard_error"]
    yield _row("blocks of time left out, log score", "0", f"{change:+.0f}", change, error, True)
    if gain["cross_instrument"] is not None:
        size = gain["cross_instrument"]
        word = "better" if size > 3 else "worse" if size < -3 else "no change"
        yield "pyrometer foretold by the spectrometer, log score", "0", f"{size:+.0f}", f"{size:+.3g}", word
    if gain["cross_condition"] is not None:
        size = gain["cross_condition"]
        word = "better" if size > 3 else "worse" if size < -3 else "no change"
        yield "tests at other conditions, log score", "0", f"{size:+.0f}", f"{size:+.3g}", word


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
    yield from _kelvin("pyrometer against spectrometer, K", *apart)


def _of_simulation(where, before, after):
    yield from _kelvin(f"{where}: read with the simulated gas, K", before.temperature, after.temperature)
    for what, one in (("gas in the bands", "signal"), ("gas in the spectrum", "spectrum")):
        sizes = [100 * float(np.sqrt(np.mean(getattr(pair, one) ** 2))) for pair in (before, after)]
        spread = np.abs(getattr(after, one)) - np.abs(getattr(before, one))
        error = 100 * float(np.std(spread, ddof=1) / np.sqrt(spread.size))
        shown = (f"{size:.1f}" for size in sizes)
        yield _row(f"{where}: {what}, % rms", *shown, sizes[1] - sizes[0], error)
    change = after.log_score - before.log_score
    error = float(np.std(change, ddof=1) * np.sqrt(change.size))
    scores = (f"{pair.log_score.sum():.1f}" for pair in (before, after))
    yield _row(f"{where}: gas, log score", *scores, float(change.sum()), error, True)


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
