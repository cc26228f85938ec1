"""Cases of the second laboratory (`worlds`) in the mould of the first: made, measured, scored."""

import shutil
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path

import xarray as xr
from worlds import case as worlds
from worlds import laboratory
from worlds.faults import EFFECTS
from worlds.measure import Measure

from blind.draw import LABORATORIES, number
from blind.make import BeyondRange

LIKE_A_POWER = {"ripple", "T_exc", "T_vib", "selfabs"}  # effects
SAME_PRESSURE = 0.1  # [1] to which the main job's simulation is one of the pressure of a gas
ATTEMPTS = 4  # tests drawn until one can show an effect
UNITS = {
    "time": "s",
    "spectrum_time": "s",
    "wavelength": "m",
    "signal_wide": "A",
    "signal_narrow": "A",
    "counts": "count",
    "background_counts": "count",
    "chamber_pressure": "Pa",
    "source_temperature": "K",
    "calibration_counts": "count",
    "calibration_background": "count",
}


@dataclass(frozen=True)
class Made:
    """A case of the second laboratory; `test` is all that the analyser gets."""

    case: object
    base: worlds.Base
    effects: tuple
    stage: worlds.Stage

    coldest = 850.0  # [K] below, silicon sees no surface, and samples may stay there for long

    @property
    def plasma_off(self):
        return self.base.off

    @cached_property
    def test(self):
        """The test file."""
        return self.stage.test(self.effects)

    @cached_property
    def measure(self):
        """Sizes and angles of effects."""
        return Measure(self.stage)

    def truth(self):
        """What was hidden, for the record."""
        world = self.stage.world
        drawn = {name: factor.tolist() for name, factor in world.factors.items()}
        lab = {name: list(v) if isinstance(v, tuple) else v for name, v in asdict(self.stage.lab).items()}
        return {
            "case": self.case.as_dict(),
            "base": asdict(self.base),
            "effects": list(self.effects),
            "laboratory": lab,
            "strengths": drawn,
        }

    def temperature(self, time):
        """True surface temperature (t,) [K]."""
        return self.stage.temperature(time)

    @property
    def power(self):
        """True power of the gas over that of its condition [1]; None where an effect may be taken for one."""
        hidden = {one["effect"]: one["amplitude"] for one in self.effects}
        if LIKE_A_POWER & set(hidden):
            return None
        return self.base.power / nominal(self.base.condition) * (1 + hidden.get("P_eff", 0.0))

    def angle(self, one, other):
        """Degrees between the signatures of two effects."""
        return self.measure.angle(one, other, {e["effect"]: e for e in self.effects})


def nominal(condition):
    """Power [W] that a condition of the main job is named after."""
    return 1e3 * float(condition.removesuffix("kW"))


def bench(results, seed):
    """Worlds and laboratories of a seed word."""
    return worlds.load(results, number(seed, "second", "worlds"), LABORATORIES)


def simulations(workbench):
    """What each gas is compared with: the main job, its own simulation, or one of another pressure.

    A laboratory that runs at a pressure simulates it; but for the last of the gases at other pressures.
    """
    away = [abs(one / worlds.PRESSURE - 1) > SAME_PRESSURE for one in workbench.pressures]
    last = max((index for index, one in enumerate(away) if one), default=None)
    return [
        "another pressure" if index == last else "own" if one else "main job"
        for index, one in enumerate(away)
    ]


def make(case, workbench):
    """Make a case of the second laboratory; BeyondRange as for one of the first."""
    for attempt in range(ATTEMPTS):  # a laboratory may lack the instrument, or a test the light that shows it
        base = worlds.draw(case.seed + attempt, workbench)
        made = Made(case, base, (), worlds.Stage(workbench, base))
        sized = [made.measure.sized(*one) for one in case.effects]
        if None not in sized:
            return replace(
                made, effects=tuple(one | {"truth": list(EFFECTS[one["effect"]].truth)} for one in sized)
            )
    raise BeyondRange(
        f"{', '.join(f'{name} at SNR {snr:g}' for name, snr, *_ in case.effects)}: no test shows it"
    )


def write(dataset, path):
    """Store a dataset with the units of its variables."""
    for name in dataset.variables:
        dataset[name].attrs["units"] = UNITS[name]
    path.parent.mkdir(parents=True, exist_ok=True)
    dataset.to_netcdf(path)


def calibration_files(lab, results, folder):
    """What a laboratory keeps of its calibration, in a folder."""
    response = Path(results) / "instrument/response.nc"
    with xr.open_dataset(response) as stated:
        points, counts = laboratory.calibrate(lab, stated.load())
    write(points, folder / "calibration_points.nc")
    write(counts, folder / "spectrometer_counts.nc")
    shutil.copy(response, folder / "response.nc")
