"""What one test teaches about the instruments, tried on another test at another power."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from blind import bench, worker
from twin import campaign, story
from twin.plasma import Plasma

WINDOW = [{"effect": "winE", "amplitude": 0.03}]
CLEAN = [{"effect": "winE", "amplitude": 1e-6}]


def made(results, condition, effects, seed):
    """A short test at one of the powers of the small job."""
    gas = [(1.0, xr.load_dataset(results / f"radiation/{condition}.nc"))]
    profile = [xr.load_dataset(results / name) for name in (f"sightline/{condition}.nc", "gas/air11.nc")]
    response = xr.load_dataset(results / "instrument/response.nc")
    scene = replace(
        story.scene(condition, effects, gas, profile),
        end=330.0,
        pyrometer_period=0.5,
        spectrometer_period=1.0,
        spectrometer_integration_time=0.9,
        spectrometer=bench.spectrometer(),
        plasma=Plasma(drift=0.0, swing=0.0),
    )
    return campaign.record(scene, response, gas, seed)[0]


@pytest.fixture(scope="module")
def crossed(small_results):
    """Function of other tests: the score on them of what a test at 80 kW teaches."""
    from plasmapyro.diagnosis import command

    folder = small_results / "laboratory"
    response = xr.load_dataset(small_results / "instrument/response.nc")
    campaign.write(campaign.calibration_points(response, 160), folder / "calibration_points.nc")
    counts = campaign.spectrometer_counts(160, spectrometer=bench.spectrometer())
    campaign.write(counts, folder / "spectrometer_counts.nc")
    (folder / "response.nc").write_bytes((small_results / "instrument/response.nc").read_bytes())
    worker.prepare({"laboratory": str(folder)})
    inputs = command.load_inputs(small_results / "radiation", folder)
    first = made(small_results, "80kW", WINDOW, 160)

    def score(*others):
        tests = [made(small_results, "130kW", effects, 161) for effects in others]
        report = command.check(command.diagnose_test(first, inputs, others=tests).report)
        assert report["verdict"]["named"] == ["winE"]
        return report["gain"]["cross_condition"]

    return score


def test_the_same_window_at_another_power_is_predicted(crossed):
    # 3 % of a spectrometer that sees 1 % over minutes: beyond any doubt.
    assert crossed(WINDOW) > 20


def test_a_clean_window_at_another_power_speaks_against_it(crossed):
    # Odds of 1 to 20 000; more would deny gains that wander by 0.3 % and a lamp known to 0.4 %.
    assert crossed(CLEAN) < -10


def test_score_is_that_of_a_gaussian_integral():
    """Against brute force: one number, a quadratic objective, integrated on a grid."""
    from types import SimpleNamespace

    from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
    from plasmapyro.diagnosis.fit.setting import WIDE, Setting
    from plasmapyro.diagnosis.select.held_out import cross_condition

    prior = (WIDE * CATALOGUE["winE"].sigma) ** -2.0
    data, best, floor, plain = 9e4, 0.021, 100.0, 140.0  # curvature, optimum, chi-squared with and without
    mean, spread = 0.024, 0.004
    curvature = data + prior
    fitted = data * best / curvature
    objective = floor + data * (fitted - best) ** 2 + prior * fitted**2
    settings = (Setting(CATALOGUE["winE"], fitted, {}),)
    other = SimpleNamespace(
        covariance=np.diag([1.0, 1 / curvature]),
        settings=settings,
        objective=objective,
        state=SimpleNamespace(amplitudes=np.array([fitted])),
    )
    one = SimpleNamespace(
        covariance=np.diag([1.0, 1.0, spread**2]), state=SimpleNamespace(amplitudes=np.array([mean]))
    )
    found = cross_condition(one, SimpleNamespace(objective=plain), other, 2, 1)
    a = np.linspace(mean - 8 * spread, mean + 8 * spread, 20001)
    weight = np.exp(-0.5 * ((a - mean) / spread) ** 2)
    likelihood = np.exp(-0.5 * (floor - plain + data * (a - best) ** 2))
    assert found == pytest.approx(np.log(np.sum(weight * likelihood) / np.sum(weight)), rel=1e-6)
