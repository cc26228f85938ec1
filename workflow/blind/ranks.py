"""Whether the stated laws of amplitudes hold as a whole: ranks of the truth in them, and their ECDF.

    python workflow/blind/ranks.py OUT

OUT is the folder of a blind set (`run.py --out`). Left out are effects whose amplitude counts something else
in a laboratory than in the catalogue, listed here with what it counts.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from scipy.special import ndtr

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from twin.light import planck

LINES = dict.fromkeys(("NaK", "CaII", "CN", "Cu", "Ar"), "light of lines: another yardstick")
AIR = dict.fromkeys(("h2o", "o2a"), "depth of a band: another table of absorption")
LIGHT = {"contin": "share of its own continua", "bl": "another share of molecules", "second": "other images"}
EVERY = LINES | AIR | LIGHT | {"resp_long": "another range of wavelengths"}
OTHER = {
    "first": EVERY,
    "second": EVERY
    | {
        "P_eff": "power, not temperature",
        "selfabs": "depth at each place of the path",
        "refl": "another view of the torch",
        "scat": "light that it adds, too",
        "edge1": "the blue flank alone",
        "edge2": "the blue flank alone",
        "edge_p": "a cover of emittance 0.8",
        "edge_s": "a cover of emittance 0.8",
    },
}
GROWING = ("gas_drift", "winD", "winE", "winD_sl", "winE_sl")  # until the end; per 300 s in the second
GRAINS, PIVOT = 2300.0, 0.95e-6  # [K], [m] of the black body that grains count in
BINS = 10
LEVEL = 0.95
DRAWS = 2000


def in_catalogue(hidden, case):
    """Amplitude of a hidden effect {effect, amplitude, shape} of a case in the unit of the catalogue, or None
    where it counts something else."""
    world, name, amplitude = case["case"].get("world", "first"), hidden["effect"], hidden["amplitude"]
    if name in OTHER[world]:
        return None
    if world == "second" and name in GROWING:
        return amplitude * case["base"]["off"] / 300.0
    if world == "first" and name == "refl":  # the share that is scattered: a mirror's is the gas of all
        return amplitude * hidden["shape"]["diffuse"]
    if world == "first" and name == "particles":
        return amplitude * float(planck(PIVOT, hidden["shape"]["grain_k"]) / planck(PIVOT, GRAINS))
    return amplitude


def amplitudes(out, world=None):
    """(effect, true amplitude, its estimate, standard error) of every hidden effect that was named, of one
    world if it is given, in the unit of the catalogue."""
    for folder in sorted((Path(out) / "cases").iterdir()):
        made, told = folder / "truth.json", folder / "out/diagnosis.json"
        if not (made.is_file() and told.is_file()):
            continue
        report = json.loads(told.read_text(encoding="utf-8"))
        entries = {entry["id"]: entry for entry in report["candidates"]}
        case = json.loads(made.read_text(encoding="utf-8"))
        for one in case["effects"] if world in (None, case["case"].get("world", "first")) else ():
            true = in_catalogue(one, case)
            if one["effect"] in report["verdict"]["named"] and true is not None:
                entry = entries[one["effect"]]
                yield one["effect"], true, entry["amplitude"], entry["standard_error"]


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
    top = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    top.add_argument("out", metavar="OUT", help="folder of a blind set")
    folder = top.parse_args().out
    for laboratory in OTHER:
        sys.stdout.write(f"{laboratory} laboratory\n")
        for name, value in ranks(amplitudes(folder, laboratory)).items():
            sys.stdout.write(f"  {name}: {value}\n")
