"""Does the diagnosis list which radiating systems its simulation has wrong, with sign and size?

    python benchmarks/gas_errors.py RESULTS [--cases 30] [--seed WORD]

Tests of the second laboratory, whose gas is of another engine, with the light of one of its systems changed
by 3 to 8 of the uncertainties that the package states of that system. RESULTS are those of the main job. Each
row that the diagnosis gives is held against the light that the laboratory put in over that of the simulation,
in the same stretch of the spectrum.
"""

import argparse
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import minimize_scalar

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "workflow"))
from blind import second, worker
from blind.draw import number
from worlds import case as worlds
from worlds.engine import CENTRES, COMPONENTS

from plasmapyro import io
from plasmapyro.diagnosis import command
from plasmapyro.diagnosis.simulation.systems import BEYOND

SYSTEMS = ("N I", "O I", "N2 1P", "N2+ Meinel", "NO 11000 A")
STATED = {"N I": 0.12, "O I": 0.12, "N2 1P": 0.1, "N2+ Meinel": 0.3, "NO 11000 A": 0.3}  # [1]
SIZES = (3.0, 8.0)  # of the logarithm, in stated uncertainties
CLOSE = 0.2  # [1], relative error of a ratio


def make(seed, bench):
    """A test of a laboratory with spectrometer, and the factor of each component (C,) of its gas."""
    random = np.random.default_rng([seed, 41])
    while True:
        base = worlds.draw(int(random.integers(2**31)), bench)
        stage = worlds.Stage(bench, base)
        if stage.lab.has_spectrometer and stage.lab.has_pyrometer:
            break
    system = str(random.choice(SYSTEMS))
    factor = np.ones(len(COMPONENTS))
    size = STATED[system] * random.uniform(*SIZES) * random.choice([-1.0, 1.0])
    factor[COMPONENTS.index(system)] = np.exp(size)
    stage.components = stage.light() * factor[:, None]
    return stage, system, size


def truth_of(row, stage, simulated):
    """The laboratory's light over the simulated, of a row's system where that lies; None if it has none."""
    system = next((name for name in SYSTEMS if f"{row['name']} ".startswith(f"{name} ")), None)
    if system is None:
        return None
    first, last = row["wavelength"]
    place = (CENTRES > first) & (CENTRES < last)
    there = stage.components[COMPONENTS.index(system), place].mean()
    axis = simulated.wavelength_slit.values
    light = simulated.gas_radiance_component_slit.sel(component=system).values
    return float(there / light[(axis > first) & (axis < last)].mean())


def deviations(row, truth):
    """Standard deviations by which a system's light is off, as the data could show it at best.

    The fewest of both: the simulation errs by so many of its own in the logarithm, and the measured ratio by
    the rest of its normal error. (Were both errors of logarithms, what the data hardly see would be far off.)
    """
    rest = np.log(max(truth, 1e-3) / row["by_power"])

    def chi2(share):
        left = (row["by_power"] * np.exp(share * rest) - truth) / row["error"]
        return (share * rest / row["stated"]) ** 2 + left**2

    return np.sqrt(minimize_scalar(chi2, bounds=(0.0, 1.0), method="bounded").fun)


@dataclass
class Score:
    """Rows, those that are off as the data could show, those of them listed rightly, and false ones."""

    rows: int = 0
    off: int = 0
    right: int = 0
    false: int = 0

    def add(self, row, truth):
        """Count one row; returns what is to be said of it, or None."""
        self.rows += 1
        rest, found = (np.log(max(value, 1e-3) / row["by_power"]) for value in (truth, row["ratio"]))
        off = deviations(row, truth) > BEYOND
        right = row["beyond"] and rest * found > 0 and abs(row["ratio"] / truth - 1) < CLOSE
        self.off += off
        self.right += off and right
        self.false += row["beyond"] and abs(rest) < row["stated"]
        if not (off or row["beyond"]):
            return None
        word = "listed" if row["beyond"] else "not listed"
        numbers = (truth, row["ratio"], row["error"], row["by_power"])
        return f"{row['name']}: true {{:.2f}}, found {{:.2f}} +- {{:.2f}}, by power {{:.2f}}, {word}".format(
            *numbers
        )


def main():
    """Print one line per case, and the rates."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("results", type=Path)
    options.add_argument("--cases", type=int, default=30)
    options.add_argument("--seed", default="gas")
    options = options.parse_args()
    bench, score = second.bench(options.results, options.seed), Score()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "test.nc"
        for which in range(options.cases):
            stage, system, size = make(number(options.seed, "gas", which), bench)
            place = Path(folder) / str(stage.base.laboratory)
            if not place.exists():
                place.mkdir()
                second.calibration_files(stage.lab, options.results, place)
                worker.prepare({"laboratory": str(place)})
            base = stage.base
            path.unlink(missing_ok=True)
            second.write(stage.test(()), path)
            inputs = command.load_inputs(options.results / "radiation", place)
            report = command.diagnose_test(path, inputs).report
            inputs = command.of_its_pressure(io.read(path, "test"), inputs)  # as the diagnosis simulates it
            simulated = inputs.radiation[stage.base.condition]
            told = [
                score.add(row, truth)
                for row in report["simulation"]["systems"]
                if (truth := truth_of(row, stage, simulated)) is not None
            ]
            head = f"{which}: {base.condition}, {base.pressure:.0f} Pa, {system} x {np.exp(size):.2f}"
            print("; ".join([head, *filter(None, told)]), flush=True)
    print(
        f"rows {score.rows}; off beyond three uncertainties {score.off}, of them listed with sign and within"
        f" {CLOSE:.0%} {score.right}; listed though within one stated uncertainty {score.false}"
    )


if __name__ == "__main__":
    main()
