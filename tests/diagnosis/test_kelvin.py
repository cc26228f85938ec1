"""The paper's temperature as the diagnosis reads it: the gas is taken off while the plasma shines only."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro import contracts
from plasmapyro.diagnosis.report.kelvin import (
    PaperShift,
    fitted_shift,
    judged_span,
    paper_temperature,
    reference_of,
    reference_weight,
)
from plasmapyro.experiment.correction import Reading
from plasmapyro.instrument.stage import pyrometer_calibration
from plasmapyro.record import status
from plasmapyro.record.record import record_of

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "commands"))
CURVE = 3.0  # [K] the quadratic curve is off by that
KELVIN = 1500.0


@pytest.fixture(scope="module")
def laboratory_record():
    import laboratory

    from plasmapyro.commands.calibrate import RESPONSE
    from plasmapyro.instrument.stage import band_response

    source = np.arange(973.0, 1774.0, 100.0)
    wide, narrow = laboratory.signals(source)
    points = laboratory.xr.Dataset(
        {
            "source_temperature": ("calibration_point", source),
            "signal_wide": ("calibration_point", wide),
            "signal_narrow": ("calibration_point", narrow),
        }
    )
    calibration = pyrometer_calibration(
        band_response(**RESPONSE),
        points,
        source_temperature_uncertainty=3.0,
        signal_uncertainty=0.01,
        instrument_range=(973.0, 2073.0),
        calibration_temperature=np.arange(900.0, 2101.0, 50.0),
        draws=20,
        seed=1,
    )
    test = contracts.label(laboratory.made(spectrometer=False), "test")
    record = record_of(test, {"pyrometer": calibration}, needed=["pyrometer"])
    reading = Reading.of(
        calibration,
        1.0,
        signal_uncertainty=0.01,
        gas_variation=0.03,
        detection_level=2.0,
        least_surface_share=0.5,
    )
    surface = laboratory.EMITTANCE * laboratory.signals(np.full(3, KELVIN))
    gas = laboratory.gas()[0]
    return record, reading, surface, gas[:, None]


def test_the_gas_is_taken_off_until_the_plasma_is_off(laboratory_record):
    record, reading, surface, gas = laboratory_record
    moment = np.array([30.0, 50.0, 52.0])  # the plasma goes off at 50 s
    temperature, state = paper_temperature(
        (surface + 3 * gas * [1, 1, 0]).T, moment, record, reading, (3 * gas[:, 0], np.zeros(2))
    )
    np.testing.assert_allclose(temperature, KELVIN, atol=CURVE)
    assert (state == status.VALID).all()


def test_the_reference_is_the_mean_of_the_test_in_its_window(laboratory_record):
    record, reading, surface, gas = laboratory_record
    moment = np.array([30.0, 50.0, 52.0])
    temperature, _ = paper_temperature((surface + gas * [1, 1, 0]).T, moment, record, reading)
    np.testing.assert_allclose(temperature, KELVIN, atol=CURVE)


def test_a_shift_is_looked_for_where_the_surface_is_warm_and_in_the_span():
    knots = np.arange(6.0)
    solution = SimpleNamespace(
        state=SimpleNamespace(knots=np.array([800.0, 899.0, 901.0, 1500.0, 1500.0, 1500.0]))
    )
    model = SimpleNamespace(history=SimpleNamespace(knots=knots))
    found = SimpleNamespace(shift=np.array([[90.0], [80.0], [-7.0], [5.0], [6.0], [70.0]]))
    assert fitted_shift(model, solution, found, 0, 2.0, (0.0, 4.0)) == (-14.0, 2.0)
    assert fitted_shift(model, solution, found, 0, 2.0, (3.0, 5.0)) == (140.0, 5.0)


def test_judged_is_from_when_the_surface_is_warm_and_gives_half_of_the_light():
    time = np.arange(-1.0, 9.0)
    kelvin = np.where(time < 3, 800.0, 1200.0)
    share = np.select([time < 5, time < 8], [0.49, 0.5], 0.1)
    model = SimpleNamespace(
        instruments=[SimpleNamespace(time=time)], history=SimpleNamespace(basis=lambda t: np.eye(t.size))
    )
    predicted = np.ones((time.size, 2))
    gas = [predicted * (1 - share[:, None])]
    state = SimpleNamespace(knots=kelvin)
    solution = SimpleNamespace(gas=gas, prediction=[predicted], state=state)
    assert judged_span(model, solution) == (5.0, 7.0)
    state.knots = kelvin - 350.0
    assert judged_span(model, solution) == (np.inf, -np.inf)


def shift_of(laboratory_record, wide):
    """Shift by a term that changes the wide band (factors (4,)): in the window, hot twice, hardly there."""
    record, reading, surface, gas = laboratory_record
    moment = np.array([2.0, 30.0, 40.0, 45.0])

    def evaluate(which, knots, values, settings, gas_error):
        seen = surface[:, :1] * [0, 1, 1, 1e-3] + gas
        return (seen * (1 + np.array([[1.0], [0.0]]) * bool(settings) * wide)).T

    model = SimpleNamespace(
        instruments=[SimpleNamespace(kind="pyrometer", time=moment, number=np.ones((4, 2)))],
        record=record,
        evaluate=evaluate,
    )
    solution = SimpleNamespace(state=SimpleNamespace(knots=None, values=None, error_of_gas=lambda which: 0.0))
    return PaperShift(model, solution, reading)


def test_a_term_that_brightens_the_wide_band_costs_kelvin_upwards(laboratory_record):
    shift = shift_of(laboratory_record, np.array([0, 0.02, 0, 0.5]))
    effect = SimpleNamespace(instruments=("pyrometer",), bounds=(-1.0, 1.0))
    change, worst = shift(effect, 0.02, None)
    # The ratio rises by 0.08 per unit of ln S, ln S by 9.4 per unit of ln T: 2 % are 2.7 % of 1500 K, 40 K.
    assert worst == 30.0 and 25.0 < change < 45.0
    assert shift(SimpleNamespace(instruments=("spectrometer",)), 0.02, None) == (0.0, 0.0)
    # Beyond its bounds a term is taken at the bound and scaled.
    bounded = SimpleNamespace(instruments=("pyrometer",), bounds=(-0.01, 0.01))
    assert shift(bounded, 0.02, None)[0] == pytest.approx(2 * change, rel=1e-12)


def test_a_term_may_lead_out_of_the_range_of_the_instrument(laboratory_record):
    shift = shift_of(laboratory_record, np.array([0, 0.6, 0, 0]))
    change, worst = shift(SimpleNamespace(instruments=("pyrometer",), bounds=(-1.0, 1.0)), 0.6, None)
    assert worst == 30.0 and change > 2073.0 - KELVIN


@pytest.mark.parametrize(
    ("window", "number", "weight"),
    [
        ((0, 10), [3, 4, 5], [3, 4, 0]),
        ((3, 4), [3, 4, 5], [1, 0, 0]),  # shorter than a bin
        ((0, 3), [0, 4, 5], [0, 1, 0]),  # all of its samples lost
    ],
)
def test_the_reference_is_that_of_the_nearest_bin_where_its_window_holds_no_sound_one(window, number, weight):
    record = SimpleNamespace(window=window, in_window=lambda t: (t >= window[0]) & (t <= window[1]))
    found = reference_weight(np.array([2.0, 8.0, 14.0]), np.array(number), record)
    assert found.tolist() == weight


def test_a_reference_window_of_two_samples_gives_no_reference():
    """A slow pyrometer: the diagnosis goes on without the paper's method."""
    bands = SimpleNamespace(time=np.array([-1.0, 0.3, 0.9, 2.0]), sound=np.ones((4, 2)))
    record = SimpleNamespace(
        window=(0.0, 1.5), instrument=lambda kind: bands, in_window=lambda time: (time >= 0) & (time <= 1.5)
    )
    assert np.isnan(reference_of(record)).all()
    bands.time = np.array([0.0, 0.5, 1.0, 1.5])
    assert reference_of(record) == pytest.approx(np.array([[1.0, 1.0], [0.0, 0.0]]))


def test_a_ratio_that_no_temperature_gives_costs_no_kelvin(laboratory_record):
    """Six times the wide signal is an infinite reading, which the report had held and JSON refuses."""
    shift = shift_of(laboratory_record, np.array([0, 0.02, 5.0, 0]))
    change, worst = shift(SimpleNamespace(instruments=("pyrometer",), bounds=(-1.0, 1.0)), 0.02, None)
    assert worst == 30.0 and 25.0 < change < 45.0
