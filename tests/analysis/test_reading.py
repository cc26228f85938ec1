"""Displayed temperatures go back through the gas: a synthetic record with known truth comes back."""

import numpy as np
import pytest
from gas_signals import POWERS, gas
from test_analysis_stage import calibration, response

from plasmapyro import contracts
from plasmapyro.analysis import reading as module
from plasmapyro.analysis.reading import correct_reading
from plasmapyro.instrument.pyrometer import blackbody_signal, invert_ratio

PRIORS = {"emittance_uncertainty": 0.05, "power_uncertainty": 0.02, "engine_uncertainty": 0.05}
SEED = {"draws": 300, "seed": 3}
INVERSION = 0.02  # [K]: straight lines between surfaces 2 K apart
COVERAGE = (0.92, 0.98)


def display(truth, light, emittance=0.85, slope=1.0, colour=1.0):
    """What the instrument shows of a surface [K] behind light (wide, narrow), by its definition."""
    bands = [
        emittance * tint * blackbody_signal(truth, response().wavelength.values, response()[name].values)
        for name, tint in (("responsivity_wide", colour), ("responsivity_narrow", 1.0))
    ]
    curve = calibration()
    ratio = 0.315 * (bands[0] + light[0]) / (bands[1] + light[1]) / slope
    return invert_ratio(ratio, curve.calibration_temperature.values, curve.calibration_ratio.values)[0]


def correct(readings, condition="110kW", powers=POWERS, **options):
    options = {**PRIORS, **SEED, **options}
    times = np.arange(len(readings), dtype=float)
    return correct_reading(
        gas(powers), response(), calibration(), condition=condition, time=times, reading=readings, **options
    )


def test_a_reading_gives_its_hot_and_its_cold_surface():
    truth = np.array([1450.0, 1700.0, 2200.0])
    shown = display(truth, POWERS["110kW"])
    assert shown[0] > truth[0] + 10
    found = correct(shown)
    assert found.surface_temperature.values == pytest.approx(truth, abs=INVERSION)
    cold = found.other_temperature.values
    assert np.all(cold < found.attrs["turning_temperature"])
    assert display(cold, POWERS["110kW"]) == pytest.approx(
        shown, abs=1.0
    )  # as steep as 40 K per kelvin there
    assert list(found.corrected_reading_status.values) == [1, 1, 1]
    contracts.check(contracts.label(found, "corrected_reading"), "corrected_reading")


def test_a_thermocouple_below_the_surface_leaves_one_of_them():
    shown = display(np.array([1700.0]), POWERS["110kW"])
    found = correct(shown, at_least=1300.0)
    assert found.corrected_reading_status.values[0] == 0
    assert np.isnan(found.other_temperature.values[0])


def test_without_gas_the_reading_is_the_truth():
    powers = {"60kW": (1e-9, 1e-9), "90kW": (2e-9, 2e-9)}
    found = correct(np.array([1200.0, 1800.0]), "60kW", powers)
    assert found.surface_temperature.values == pytest.approx([1200.0, 1800.0], abs=INVERSION)


def test_the_slope_setting_is_undone():
    truth = np.array([1600.0])
    shown = display(truth, POWERS["90kW"], slope=1.03)
    assert correct(shown, "90kW", slope=1.03).surface_temperature.values == pytest.approx(
        truth, abs=INVERSION
    )
    assert abs(correct(shown, "90kW").surface_temperature.values - truth) > 20.0


def test_what_cannot_be_corrected_is_said():
    least = correct(np.array([1500.0])).attrs["least_reading"]
    found = correct(np.array([np.nan, 1100.0, least - 5.0, least + 0.5, 1700.0]), floor=1200.0)
    assert list(found.corrected_reading_status.values) == [6, 3, 2, 4, 1]
    assert np.isnan(found.surface_temperature.values[:4]).all()
    assert correct(np.array([4500.0])).corrected_reading_status.values[0] == 5


def test_the_interval_holds_the_truth_and_the_error_falls_threefold():
    """Sixty gases, surfaces and noises drawn from the uncertainties, none the nominal one."""
    random = np.random.default_rng(11)
    held, before, after = [], [], []
    elasticity = module._elasticity(gas(), "110kW", 1.0)
    for number in range(60):
        power, bands = 0.02 * random.standard_normal(), 0.05 * random.standard_normal(2)
        light = np.array(POWERS["110kW"]) * np.exp(elasticity * power + bands)
        truth = random.uniform(1400.0, 1900.0, 6)
        shown = display(truth, light, 0.85 * np.exp(0.05 * random.standard_normal()))
        shown = np.round(shown + 2.0 * random.standard_normal(6))
        found = correct(shown, quantum=1.0, noise=2.0, seed=number)
        good = np.isin(found.corrected_reading_status.values, (0, 1))
        low, high, middle = (found[f"surface_temperature{end}"].values[good] for end in ("_low", "_high", ""))
        held.extend((truth[good] >= low) & (truth[good] <= high))
        wrong = np.abs(shown[good] - truth[good]) >= 30.0
        before.extend(np.abs(shown[good] - truth[good])[wrong])
        after.extend(np.abs(middle - truth[good])[wrong])
    assert COVERAGE[0] <= np.mean(held) <= COVERAGE[1]
    assert len(before) > 20
    assert np.mean(after) < np.mean(before) / 3


def heated(random, hertz=5.0, noise=5.0):
    """A surface heated from cold behind gas of 110 kW, drawn as the command assumes."""
    elasticity = module._elasticity(gas(), "110kW", 1.0)
    light = np.exp(elasticity * 0.05 * random.standard_normal() + 0.1 * random.standard_normal(2))
    times = np.arange(0.0, 40.0, 1 / hertz)
    truth = 1750.0 - 1000.0 * np.exp(-times / random.uniform(5.0, 15.0))
    shown = display(truth, light * POWERS["110kW"], 0.85 * np.exp(0.05 * random.standard_normal()))
    return times, truth, np.round(shown + noise * random.standard_normal(times.size))


def of_record(times, shown, **options):
    """Corrected with what the command assumes; the noise is that of the record."""
    assumed = {"emittance_uncertainty": 0.05, "power_uncertainty": 0.05, "engine_uncertainty": 0.1}
    options = {"condition": "110kW", "quantum": 1.0, "draws": 100, "seed": 1, **assumed, **options}
    return correct_reading(gas(), response(), calibration(), time=times, reading=shown, **options)


def test_a_surface_heated_through_the_least_reading_tells_the_gas():
    """With all that the command assumes, noise found in the record: hot side of five records."""
    random = np.random.default_rng(2)
    held, before, after = [], [], []
    for _ in range(5):
        times, truth, shown = heated(random)
        found = of_record(times, shown)
        assert found.attrs["noise"] == pytest.approx(5.0, rel=0.5)
        turn, moment = found.attrs["turning_temperature"], found.attrs["heated_through"]
        assert np.interp(moment, times, truth) == pytest.approx(turn, abs=20.0)
        assert (found.corrected_reading_status.values != 1).all()
        low, high, middle = (found[f"surface_temperature{end}"].values for end in ("_low", "_high", ""))
        cold = (times < moment - 0.5) & np.isfinite(middle)
        assert np.median(np.abs(middle - truth)[cold]) < 10.0
        hot = (truth > turn) & np.isfinite(middle)
        held.extend(((truth >= low) & (truth <= high))[hot])
        wrong = hot & (np.abs(shown - truth) >= 30.0)
        before.extend(np.abs(shown - truth)[wrong])
        after.extend(np.abs(middle - truth)[wrong])
    assert np.mean(held) > 0.9 and len(before) > 20
    assert np.mean(after) < np.mean(before) / 4


def test_a_hot_surface_that_cools_and_warms_again_tells_no_gas():
    times = np.arange(0.0, 40.0, 0.2)
    truth = 1700.0 - 350.0 * np.exp(-(((times - 20.0) / 6.0) ** 2))
    shown = np.round(display(truth, POWERS["110kW"]) + 3.0 * np.random.default_rng(1).standard_normal(200))
    found = of_record(times, shown)
    assert np.isnan(found.attrs["heated_through"])
    times, _, shown = heated(np.random.default_rng(2))
    for options, passes in (({}, True), ({"at_least": 1300.0}, False), ({"floor": 1600.0}, False)):
        found = of_record(times, shown, **options)
        assert np.isfinite(found.attrs["heated_through"]) == passes


def test_gas_that_outshines_every_surface_leaves_no_reading_to_correct():
    found = correct(np.array([1500.0]), "90kW", {"60kW": (1.0, 1.0), "90kW": (1e9, 1e7)})
    assert np.isnan(found.surface_temperature.values).all()


def test_same_seed_same_interval_and_another_seed_another():
    one, same, other = (correct(np.array([1600.0]), seed=seed) for seed in (1, 1, 2))
    assert one.identical(same)
    assert not one.surface_temperature_low.equals(other.surface_temperature_low)


@pytest.mark.parametrize(
    "options, message",
    [
        ({"condition": "95kW"}, "no condition '95kW'; known: 60kW, 90kW, 110kW, 130kW"),
        ({"slope": 0.0}, "slope must be > 0"),
        ({"powers": {"110kW": (20.0, 4.0)}}, "needs a second condition"),
    ],
)
def test_what_means_nothing_is_refused(options, message):
    with pytest.raises(ValueError, match=message):
        correct(np.array([1500.0]), **options)
