"""The campaign in words: laws, tests and their pulls, and what each test gave to the next."""

import numpy as np
from scipy.special import ndtr, ndtri

from plasmapyro.campaign.stage import law_numbers

HEADS = {
    "power": "efficiency",
    "gain_pyrometer": "window P",
    "gain_spectrometer": "window S",
    "emittance": "emittance",
    "ratio": "ratio",
}
SHARES = "emittance of", "efficiency at"  # which no more than 1 can be


def page(found):
    """The `campaign.stage.Found` as Markdown text."""
    odd = [row for row in found.rows if row.odd]
    count = len(found.rows) - len(odd)
    said = [f"{row.test.name} ({' and '.join(row.odd)})" for row in odd]
    lines = [
        f"# A campaign of {len(found.rows)} tests",
        "",
        f"{count} tests agree with one another."
        + (f" Left out where it does not belong: {', '.join(said)}." if odd else " None stands apart.")
        if len(found.rows) > 1
        else "One test: there is none to hold it against.",
        "",
        "![efficiency, windows and pulls](campaign.png)",
        "",
        "## Laws",
        "",
        "| | found | 95 % interval |",
        "|---|---|---|",
    ]
    for name, mean, sigma in law_numbers(found):
        ends = ""
        if np.isfinite(sigma):
            low, high = interval(mean, sigma, 1.0 if name.startswith(SHARES) else np.inf)
            ends = f"{low:.3g} to {high:.3g}"
        lines.append(f"| {name} | {mean if abs(mean) > 1e-6 else 0:.3g} | {ends} |")
    lines += [
        "",
        "## Tests",
        "",
        "Pulls: how far the data of a test move what all others say, in standard deviations of a law whose"
        " scatter these others tell. A test does not belong where its being off is likelier than a wider"
        " scatter.",
        "",
        f"| test | electric power, kW | {' | '.join(HEADS.values())} | does not belong |",
        "|---" * (len(HEADS) + 3) + "|",
    ]
    for row in found.rows:
        pulls = [f"{row.pulls[name]:+.1f}" if name in row.pulls else "" for name in HEADS]
        cells = [row.test.name, f"{row.test.electric_power / 1e3:g}", *pulls, " and ".join(row.odd)]
        lines.append(f"| {' | '.join(cells)} |")
    lines += [
        "",
        "## What each test gave to the next",
        "",
        "Standard deviation before the data of the test, and of its temperature above 1000 K: alone, with the"
        " tests before it, with all tests.",
        "",
        f"| test | {', % | '.join(HEADS.values())}, % | T alone, K | with earlier, K | with all, K |",
        "|---" * (len(HEADS) + 4) + "|",
    ]
    for row in found.rows:
        law = row.test.before if row.prior is None else row.prior
        cells = [_percent(law, name) for name in HEADS]
        lines.append(f"| {' | '.join([row.test.name, *cells, *(f'{one:.2f}' for one in row.sigma)])} |")
    lines.append(f"| next | {' | '.join(_percent(found.next, name) for name in HEADS)} | | | |")
    return "\n".join(lines) + "\n"


def interval(mean, sigma, most):
    """Ends (2,) of the 95 % interval of a normal law, cut at the `most` that can be."""
    return mean + sigma * ndtri(np.array([0.025, 0.975]) * ndtr((most - mean) / sigma))


def _percent(law, name):
    return f"{100 * law.of([name]).sigma[0]:.2f}" if name in law.names else ""
