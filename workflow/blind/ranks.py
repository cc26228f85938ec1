"""Whether the stated laws of amplitudes hold as a whole: ranks of the truth in them, and their ECDF.

    python workflow/blind/ranks.py OUT

OUT is the folder of a blind set (`run.py --out`).
"""

import json
import sys
from pathlib import Path

import numpy as np
from scipy.special import ndtr

BINS = 10
LEVEL = 0.95
DRAWS = 2000


def amplitudes(out):
    """(effect, true amplitude, its estimate, standard error) of every hidden effect that was named."""
    for folder in sorted((Path(out) / "cases").iterdir()):
        made, told = folder / "truth.json", folder / "out/diagnosis.json"
        if not (made.is_file() and told.is_file()):
            continue
        report = json.loads(told.read_text(encoding="utf-8"))
        entries = {entry["id"]: entry for entry in report["candidates"]}
        for one in json.loads(made.read_text(encoding="utf-8"))["effects"]:
            if one["effect"] in report["verdict"]["named"]:
                entry = entries[one["effect"]]
                yield one["effect"], one["amplitude"], entry["amplitude"], entry["standard_error"]


def ranks(rows, seed=1):
    r"""Ranks :math:`u = \Phi((a - \hat a)/s)` of true amplitudes in their stated laws; are they uniform?

    Parameters
    ----------
    rows : iterable of (effect, a, estimate, s)
    seed : int
        Of the simulated band.

    Returns
    -------
    dict
        `number`, `histogram` (BINS,), `coverage` of 95 % intervals, `band` half width in standard deviations
        of an ECDF, `outside` share of its points beyond the band, None without rows.

    Notes
    -----
    Source: T. Saeilynoja, P.-C. Buerkner & A. Vehtari, Stat. Comput. 32 (2022) 32: simultaneous band.
    """
    told = np.array([(true, mean, sigma) for _, true, mean, sigma in rows]).reshape(-1, 3)
    count = len(told)
    if not count:
        return {"number": 0, "histogram": [0] * BINS, "coverage": None, "band": None, "outside": None}
    found = np.sort(ndtr((told[:, 0] - told[:, 1]) / told[:, 2]))
    drawn = np.sort(np.random.default_rng(seed).uniform(size=(DRAWS, count)), axis=1)
    band = float(np.quantile(np.abs(_off(drawn)).max(axis=1), LEVEL))
    return {
        "number": count,
        "histogram": np.histogram(found, BINS, (0, 1))[0].tolist(),
        "coverage": float(np.mean(np.abs(found - 0.5) < LEVEL / 2)),
        "band": band,
        "outside": float(np.mean(np.abs(_off(found)) > band)),
    }


def _off(values):
    """ECDF of sorted values (..., n) at BINS - 1 places less the place, in its standard deviations."""
    places = np.arange(1, BINS) / BINS
    share = np.mean(values[..., None] <= places, axis=-2)
    return (share - places) / np.sqrt(places * (1 - places) / values.shape[-1])


if __name__ == "__main__":
    for name, value in ranks(amplitudes(sys.argv[1])).items():
        sys.stdout.write(f"{name}: {value}\n")
