"""What benchmarks on drawn tests of the first laboratory (`workflow/twin`) ask for and start from."""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "workflow"))
from powers import ladder

from plasmapyro import io
from plasmapyro.diagnosis import command


def asked(description):
    """Options of the call; `command.Inputs` of a diagnosis; power [W] -> light of the gas."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--results", type=Path, default=Path("results"))
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    inputs = command.load_inputs(options.results / "radiation", options.results / "instrument")
    gas = {power: io.read(path, "radiation") for power, path in ladder(options.results / "radiation").items()}
    return options, inputs, gas
