"""From finished blind cases to the table by which the diagnosis states its probabilities.

    python workflow/blind/calibrate.py results/own_seed_1 results/own_seed_2 --seeds own_seed_1 own_seed_2

Of every status of the verdict: how often the most probable answer was right, by what would have been stated
without the table. Kinds of cases count as in the full set, so that 'none' is as frequent here as there.
Never from the seed of the published scoreboard.
"""

import argparse
import csv
import hashlib
import io
import sys
from collections import defaultdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
import yaml

from blind import board, run

TARGET = Path(__file__).resolve().parents[2] / "src/plasmapyro/data/diagnosis/stated_probability"
LEAST_SNR = 8.0  # of the effects that the table is made of: weaker ones nobody sees
IN_STEP = 30  # cases that make one row
PRIOR = 1.0  # cases right and wrong that every row is given


def pairs(records):
    """{status: list of (stated, right, weight)} of finished cases."""
    scored = [one for one in records if one["outcome"] == "scored" and board.rung(one) in board.MIX]
    used = [one for one in scored if (board.rung(one)[1] or LEAST_SNR) >= LEAST_SNR]
    found = defaultdict(list)
    for one, weight in zip(used, board.weights(used), strict=True):
        score = one["score"]
        found[score["basis"]].append((score["uncalibrated"], score["stated_right"], weight))
    return found


def steps(cases):
    """Rows (stated, right, number) of one status: a rising staircase through groups of alike number."""
    stated, right, weight = np.array(cases, dtype=float).T
    scale = weight.mean()
    rows = [[0.0, 0.0, 0.0, 0]]
    for value in np.unique(stated):  # equal ones stay together
        if rows[-1][3] >= IN_STEP:
            rows.append([0.0, 0.0, 0.0, 0])
        own = stated == value
        share = weight[own].sum() / scale
        more = (share, share * value, (weight * right)[own].sum() / scale, int(own.sum()))
        rows[-1] = [a + b for a, b in zip(rows[-1], more, strict=True)]
    if len(rows) > 1 and rows[-1][3] < IN_STEP:
        rows[-2:] = [[a + b for a, b in zip(*rows[-2:], strict=True)]]
    place = 0
    while place < len(rows) - 1:  # pool adjacent violators
        if _share(rows[place]) < _share(rows[place + 1]):
            place += 1
            continue
        rows[place : place + 2] = [[a + b for a, b in zip(*rows[place : place + 2], strict=True)]]
        place = max(place - 1, 0)
    return [(row[1] / row[0], _share(row), row[3]) for row in rows]


def _share(row):
    """Share of right answers of (number, stated, right, cases), a little of one half mixed in."""
    return (row[2] + PRIOR) / (row[0] + 2 * PRIOR)


def main():
    """Write the table and its certificate."""
    top = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    top.add_argument("folders", nargs="+", help="folders with records")
    top.add_argument("--seeds", nargs="+", required=True, help="seeds of the folders, for the certificate")
    top.add_argument("--target", type=Path, default=TARGET, help="path of the table, without suffix")
    options = top.parse_args()
    found = pairs([record for folder in options.folders for record in run.finished(folder)])
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["status [text]", "stated [1]", "right [1]", "cases [1]"])
    for status, cases in sorted(found.items()):
        for stated, right, size in steps(cases):
            writer.writerow([status, f"{stated:.6f}", f"{right:.4f}", size])
    content = text.getvalue().encode()
    options.target.with_suffix(".csv").write_bytes(content)
    number = sum(len(cases) for cases in found.values())
    certificate = {
        "title": "Share of right answers of the diagnosis by status and probability before this table",
        "source": "workflow/blind/calibrate.py of this package on simulated cases",
        "origin": "synthetic",
        "obtained": f"{number} blind cases of the seeds {', '.join(options.seeds)}",
        "licence": "own work",
        "valid": "tests like the simulated ones; 'none' as frequent as among 400 nulls, 840 single effects"
        " of SNR 8 to 50 and 200 effects outside the catalogue",
        "uncertainty": "binomial, from the number of cases of a row",
        "sha256": hashlib.sha256(content).hexdigest(),
    }
    text = yaml.safe_dump(certificate, sort_keys=False, allow_unicode=True, width=110)
    options.target.with_suffix(".yml").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
