"""`plasmapyro init`: a first test.yaml for a folder of raw files."""

import sys
from pathlib import Path

from plasmapyro import io
from plasmapyro.readers.guess import describe
from plasmapyro.readers.stage import check_test


def run(options):
    """Run `plasmapyro init`: folder in, test.yaml in it, and the questions."""
    folder = Path(options.folder)
    if not folder.is_dir():
        raise ValueError(f"{folder}: no such folder; name the one with the raw files")
    for name in ("test.yaml", "test.nc", "calibration.yaml"):
        if (folder / name).exists():
            raise ValueError(f"{folder / name}: exists already, and nothing is overwritten; check it instead")
    guess = describe(folder)
    io.write_text(guess.text, folder / "test.yaml")
    faults = check_test(folder)
    lines = [f"{folder / 'test.yaml'}: written, with {len(guess.questions)} questions:"]
    lines += [f"  ? {words}" for words in guess.questions]
    lines += [
        "as it stands, check finds:"
        if faults
        else f"as it stands it can be read; next: plasmapyro check {folder}"
    ]
    sys.stdout.write("\n".join(lines + [f"  {words}" for words in faults]) + "\n")
