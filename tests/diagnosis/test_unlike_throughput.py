"""A pyrometer alone, whose level and ratio contradict each other: which of them is wrong nobody knows."""

import numpy as np
import pytest
from small_laboratory import temperature_of

from plasmapyro.diagnosis import command
from plasmapyro.quality.agreement import throughput_in_doubt

OF_SPECTRA = ["spectrum_time", "wavelength"]
HOT = 1300.0  # [K]


@pytest.fixture(scope="module")
def found(laboratory, record):
    """Makes the diagnosis of a pyrometer alone."""

    def diagnose(**settings):
        inputs = command.Inputs(
            radiation=laboratory.radiation,
            variations={"80kW": laboratory.variations},
            response=laboratory.response,
            calibration=laboratory.calibration,
            spectrometer_calibration=None,
            origin="synthetic",
            digests={},
        )
        return command.diagnose_test(record(**settings).drop_dims(OF_SPECTRA), inputs, draws=200)

    return diagnose


def test_a_fit_that_breaks_down_says_what_is_wrong_with_the_data(found, monkeypatch):
    """Where the sample was gone at 55 s, it said that a leading minor is not positive definite."""

    def breaks(*_, **__):
        raise np.linalg.LinAlgError("225-th leading minor of the array is not positive definite")

    monkeypatch.setattr(command.stage, "fit_test", breaks)
    with pytest.raises(ValueError, match="cannot follow these data: `check` and `correct` show them"):
        found()


def test_an_emittance_that_follows_the_temperature_widens_the_interval_of_what_is_colder(found):
    kept = found().temperature
    place = list(kept.input_quantity.values).index("emittance that follows the temperature")
    added = kept.temperature_contribution.values[place]
    kelvin = kept.recommended_temperature.values
    cold, hot = kelvin < 0.9 * np.nanmax(kelvin), kelvin > 0.999 * np.nanmax(kelvin)
    assert (added[cold] > 0.5).all() and (added[hot] < 0.1).all()
    low, high = kept.recommended_temperature_interval.values
    assert (high - low)[cold].min() > 2 * 1.9 * added[cold].min()


@pytest.mark.parametrize(
    ("settings", "doubted"),
    [
        ({}, False),
        ({"ratio_error": 0.03}, True),
        ({"ratio_error": -0.03}, True),
        ({"emittance": 0.6}, True),
    ],
    ids=["sound", "ratio 3 % high", "ratio 3 % low", "30 % of the light lost"],
)
def test_the_interval_holds_the_truth(found, settings, doubted):
    kept = found(**settings).temperature
    truth = temperature_of(kept.time_bin.values)
    hot = (truth > HOT) & (kept.time_bin.values < 110) & np.isfinite(kept.recommended_temperature.values)
    low, high = kept.recommended_temperature_interval.values
    assert (kept.attrs["throughput_chance"] > throughput_in_doubt.limit) == doubted
    assert hot.any() and ((low < truth) & (truth < high))[hot].all()
