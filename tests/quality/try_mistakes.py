"""What becomes of each mistake: refused, said, shown in the status, harmless, or silently wrong."""

import contextlib
import io as streams
import shutil
from pathlib import Path

import laboratory
import numpy as np
from mistakes import MISTAKES, described

from plasmapyro import cli, io

EXAMPLE = Path(__file__).resolve().parents[2] / "docs" / "example"
NEAR = 5.0  # [K] of the truth: the quadratic curve of the calibration is off by 3 K
OFTEN = 0.05  # share of valid samples that may lie beyond two uncertainties


def run(*words):
    """Exit status and what the command said on its error stream."""
    error = streams.StringIO()
    with contextlib.redirect_stderr(error), contextlib.redirect_stdout(streams.StringIO()):
        status = cli.main([str(word) for word in words])
    return status, error.getvalue()


def error_of(result):
    """Largest wrong share of valid samples and median error [K] of the instruments of a result."""
    worst = 0.0, 0.0
    for name, axis, state in (
        ("corrected_temperature", "time", "corrected_status"),
        ("scaled_temperature", "spectrum_time", "spectrum_status"),
    ):
        if name not in result:
            continue
        good = (result[state].values == 0) & np.isfinite(result[name].values)
        if not good.any():
            continue
        off = result[name].values[good] - laboratory.temperature(result[axis].values)[good]
        bound = 2 * np.nan_to_num(result[f"{name}_uncertainty"].values[good], nan=1e9) + NEAR
        share = float(np.mean(np.abs(off) > bound))
        worst = max(worst, (share, float(np.median(np.abs(off)))))
    return worst


def outcome(name, place, lab, left_out=None):
    """(word, what was said) of one mistake.

    `lab` holds the calibration of sound files; `left_out` names an instrument that the test does without.
    """
    folder = place / "case"
    shutil.copytree(EXAMPLE, folder)
    before = {path: path.read_bytes() for path in (folder / "calibration").rglob("*")}
    MISTAKES[name](folder)
    if left_out:
        described(folder, lambda values: values.pop(left_out))
    said = ""
    if before != {path: path.read_bytes() for path in (folder / "calibration").rglob("*")}:
        lab = place / "lab"
        for words in (("check", folder / "calibration"), ("calibrate", folder / "calibration", "--out", lab)):
            status, own = run(*words)
            said += own
            if status:
                return "refused", said
    status, own = run("check", folder / "my_test", "--instrument", lab)
    said += own
    if status:
        return "refused", said
    if said:
        return "said", said
    out = place / "t.nc"
    status, own = run("correct", folder / "my_test", "--instrument", lab, "--out", out, "--draws", 50)
    if status:
        return "refused", own
    result = io.read(out, "correction")
    share, middle = error_of(result)
    if share <= OFTEN:
        return "harmless", f"{share:.0%} of the valid samples are off, {middle:.0f} K in the middle"
    return "silent", f"{share:.0%} of the valid samples are off, {middle:.0f} K in the middle"
