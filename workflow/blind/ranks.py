"""Whether the stated laws of amplitudes hold as a whole: ranks of the truth in them, and their ECDF.

    python workflow/blind/ranks.py OUT [--figure FILE.svg]

OUT is the folder of a blind set (`run.py --out`); the figure shows the ECDF less that of right laws. Left
out are effects whose amplitude counts something else in a laboratory than in the catalogue, listed here with
what it counts.
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
        "edge_p": "a cover of emittance 0.8",
        "edge_s": "a cover of emittance 0.8",
    },
}
GROWING = ("gas_drift", "winD", "winE", "winD_sl", "winE_sl")  # until the end; per 300 s in the second
COMPRESSED = ("nonlin_p", "nonlin_s")  # at the largest signal; in the catalogue at the recorded one
GRAINS, PIVOT = 2300.0, 0.95e-6  # [K], [m] of the black body that grains count in
BINS = 10
PLACES = np.arange(1, 40) / 40  # where an ECDF is held against its band
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
    if name in COMPRESSED:
        return amplitude * (1 - amplitude)
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


def ranks(rows):
    r"""Ranks :math:`u = \Phi((a - \hat a)/s)` of true amplitudes in their stated laws; are they uniform?

    `rows` of (effect, a, estimate, s). Returns `number`, `histogram` (BINS,), `coverage` of 95 % intervals,
    `band` half width in standard deviations of an ECDF, `outside` share of its points beyond the band, None
    without rows.

    Source: T. Saeilynoja, P.-C. Buerkner & A. Vehtari, Stat. Comput. 32 (2022) 32: simultaneous band.
    """
    told = np.array([(true, mean, sigma) for _, true, mean, sigma in rows]).reshape(-1, 3)
    count = len(told)
    if not count:
        return {"number": 0, "histogram": [0] * BINS, "coverage": None, "band": None, "outside": None}
    found = ndtr((told[:, 0] - told[:, 1]) / told[:, 2])
    drawn = np.random.default_rng(1).uniform(size=(DRAWS, count))
    band = float(np.quantile(np.abs(_off(drawn)).max(axis=1), LEVEL))
    return {
        "number": count,
        "histogram": np.histogram(found, BINS, (0, 1))[0].tolist(),
        "coverage": float(np.mean(np.abs(found - 0.5) < LEVEL / 2)),
        "band": band,
        "outside": float(np.mean(np.abs(_off(found)) > band)),
        "ecdf": _share(found).tolist(),
    }


def _share(values):
    """ECDF (..., PLACES) of values (..., n)."""
    return np.stack([np.mean(values <= place, axis=-1) for place in PLACES], axis=-1)


def _off(values):
    """ECDF of values (..., n) less that of right laws, in its standard deviations."""
    return (_share(values) - PLACES) / np.sqrt(PLACES * (1 - PLACES) / values.shape[-1])


def figure(told, path):
    """Draw the ECDF of ranks less that of right laws, with its band: {title: `ranks`}, those with rows."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    told = {title: one for title, one in told.items() if one["number"]}
    fig, row = plt.subplots(
        1, max(len(told), 1), figsize=(8, 3), sharey=True, squeeze=False, layout="constrained"
    )
    for axes, (title, one) in zip(row[0], told.items(), strict=False):
        half = one["band"] * np.sqrt(PLACES * (1 - PLACES) / one["number"])
        axes.fill_between(PLACES, -half, half, color="0.85", label="95 % of right laws stay inside")
        axes.plot(PLACES, np.array(one["ecdf"]) - PLACES, drawstyle="steps-mid", label="measured")
        inside = f"{one['number']} amplitudes, {100 * one['coverage']:.0f} % in their 95 % intervals"
        axes.set(title=f"{title}: {inside}", xlabel="rank of the true amplitude in its stated law")
        axes.title.set_fontsize(8)
    row[0, 0].set_ylabel("share below, less the rank")
    row[0, 0].legend(fontsize=7, loc="lower left")
    fig.savefig(path, metadata={"Date": None} if Path(path).suffix == ".svg" else None)
    plt.close(fig)


def main():
    """Print the ranks of both laboratories, and draw them if asked to."""
    top = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    top.add_argument("out", metavar="OUT", help="folder of a blind set")
    top.add_argument("--figure", metavar="FILE", help="draw the ECDF with its band")
    options = top.parse_args()
    told = {f"{name} laboratory": ranks(amplitudes(options.out, name)) for name in OTHER}
    for title, one in told.items():
        sys.stdout.write(f"{title}\n")
        for name, value in one.items():
            if name != "ecdf":
                sys.stdout.write(f"  {name}: {value}\n")
    if options.figure:
        figure(told, options.figure)


if __name__ == "__main__":
    main()
