"""Codes, limits and switches of a record, written out a second time: a changed one is a changed result."""

import numpy as np
import pytest
import xarray as xr
from test_inputs import sound

from plasmapyro.record import flags, inputs, onset, status
from plasmapyro.record.phases import phases
from plasmapyro.record.record import record_of

STATUS = {
    -1: "below_range",
    0: "valid",
    1: "above_range",
    2: "calibration_extrapolated",
    3: "missing",
    4: "no_signal",
    5: "gas_dominated",
    6: "not_injected",
    7: "straddling",
    8: "saturated",
    9: "contradicted",
}
LIMITS = {  # attribute -> lowest, highest
    "injection_time": (-1e9, 1e9),
    "plasma_off_time": (-1e9, 1e9),
    "emittance": (0, 1),
    "emittance_uncertainty": (0, 1),
    "window_transmittance_pyrometer": (0, 1),
    "window_transmittance_spectrometer": (0, 1),
    "window_transmittance_radiometer": (0, 1),
    "pyrometer_integration_time": (0, 1e6),
    "radiometer_integration_time": (0, 1e6),
    "spectrometer_integration_time": (0, 1e6),
    "spectrometer_fwhm": (0, 1e-6),
    "signal_saturation_wide": (0, np.inf),
    "signal_saturation_narrow": (0, np.inf),
    "emittance_slope": (0, 10),
    "emittance_slope_uncertainty": (0, 1),
    "temperature_spread": (0, 0.2),
}
MAY_BE_ZERO = {"injection_time", "plasma_off_time", "emittance_uncertainty", "emittance_slope_uncertainty"}
PLAUSIBLE = {"signal_wide": (1e-30, 1e6), "signal_narrow": (1e-30, 1e6), "spectral_radiance": (1e-30, 1e25)}


def test_codes_of_a_status_are_those_of_the_files():
    assert status.MEANINGS == STATUS
    assert status.WITH_VALUE == (0, 2, 5)
    assert status.flags()["flag_values"].tolist() == list(STATUS)
    assert status.flags()["flag_meanings"].split() == list(STATUS.values())


def test_flags_of_samples_are_single_bits():
    bits = [flags.SATURATED, flags.MASKED, flags.LOST, flags.STUCK, flags.CLIPPED, flags.SPIKED, flags.UNLIT]
    bits.append(flags.RELIT)
    assert bits == [1, 2, 4, 8, 16, 32, 64, 128] and set(flags.MEANINGS) == set(bits)


def faults_of(name, value):
    test = sound()
    test.attrs[name] = value
    return [fault for fault in inputs.attribute_faults(test, ["pyrometer", "spectrometer"]) if name in fault]


def test_limits_of_all_attributes_are_tested_here():
    assert {name: limits[:2] for name, limits in inputs.NUMBERS.items()} == LIMITS


@pytest.mark.parametrize("name", LIMITS)
def test_an_attribute_may_reach_its_limits_and_not_pass_them(name):
    low, high = LIMITS[name]
    top = high if np.isfinite(high) else 1e12
    assert faults_of(name, float(top)) == []
    assert np.isinf(high) or faults_of(name, high * (1 + 1e-9))
    assert bool(faults_of(name, float(low))) == (low == 0 and name not in MAY_BE_ZERO)
    assert faults_of(name, low - max(1e-9 * abs(low), 1e-12))
    assert faults_of(name, np.nan) and faults_of(name, "1")


@pytest.mark.parametrize("name", PLAUSIBLE)
def test_magnitudes_may_reach_their_limits_and_not_pass_them(name):
    for edge, factor in zip(PLAUSIBLE[name], (0.99, 1.01), strict=True):
        for value, wrong in ((edge, False), (-edge, False), (edge * factor, True), (0.0, False)):
            test = sound()
            test[name][...] = np.full(test[name].shape, value)
            found = [fault for fault in inputs.faults(test) if "a wrong unit" in fault]
            assert bool(found) == wrong, (value, found)


def test_three_samples_in_the_reference_window_are_enough_and_two_are_not():
    test = sound()
    inside = np.flatnonzero((test.time.values >= 0) & (test.time.values <= 6))
    for kept, count in ((3, 0), (2, 2), (0, 2)):
        spoilt = sound()
        lost = np.where(np.isin(np.arange(test.time.size), inside[kept:]), np.nan, 1.0)
        for name in ("signal_wide", "signal_narrow"):
            spoilt[name] = ("time", lost, test[name].attrs)
        found = inputs.faults(spoilt)
        assert len(found) == count
        assert all(f"{kept} samples in the reference window 0 to 6 s, 3 needed" in fault for fault in found)


def test_phases_hold_their_ends():
    injected, shining = phases([-0.1, 0.0, 2.0, 5.0, 5.1], 0.0, 5.0)
    assert injected.tolist() == [False, True, True, True, True]
    assert shining.tolist() == [False, True, True, True, False]


def test_the_onset_is_the_end_of_the_first_window_that_shows_the_surface():
    time = np.arange(0, 20, 0.05)
    noise = 1e-2 * np.random.default_rng(5).standard_normal((2, time.size))
    growth = 0.5 * (time / 20) ** 3 * np.array([[1.0], [0.3]])
    first, window = onset.onset(time, 1 + growth + noise, 0.0, 19.0)
    # 60 windows that grow by some 7 % each: this one shows the surface, the one before did not.
    ends = time[(time > 0) & (time <= 19)][onset.LEAST_SAMPLES - 2 :]
    picks = ends[np.unique(np.geomspace(1, ends.size, 60).astype(int)) - 1]
    place = int(np.flatnonzero(picks == first)[0])
    words = [onset.verdict(time, 1 + growth + noise, (0.0, end)).word for end in picks[place - 1 : place + 3]]
    assert words[0] != onset.SHOWS and words[1:] == [onset.SHOWS] * 3
    # The proposed window ends seven tenths of the way there.
    assert window == [0.0, pytest.approx(0.7 * first)]


def test_a_growth_of_four_deviations_is_seen_and_one_of_less_is_not():
    time = np.linspace(0, 10, 2000)
    noise = np.random.default_rng(6).standard_normal((2, time.size))
    for size, word in ((2.0, onset.CLEAN), (9.0, onset.SHOWS)):
        # Uncertainty of the growth of u^3: s / sqrt(sum (u^3 - 1/4)^2) = s / sqrt(n 9/112).
        growth = size * 1e-3 / np.sqrt(time.size * 9 / 112) * (time / 10) ** 3
        signals = 1 + 1e-3 * noise + growth * np.array([[1.0], [0.2]])
        assert onset.verdict(time, signals, (0.0, 10.0)).word == word


def test_a_window_of_eight_samples_is_judged_and_one_of_seven_is_not():
    time = np.arange(8.0)
    signals = np.ones((2, 8)) + 1e-3 * np.random.default_rng(7).standard_normal((2, 8))
    assert onset.verdict(time, signals, (0, 7)).word != onset.UNKNOWN
    assert onset.verdict(time, signals, (0, 6)).word == onset.UNKNOWN


def test_a_run_of_ten_equal_samples_is_left_alone_and_one_of_eleven_is_not():
    noise = np.random.default_rng(8).standard_normal((200, 2))
    for length, repeated in ((10, 0), (11, 10)):
        values = noise.copy()
        values[50 : 50 + length] = [1.0, 2.0]
        found = flags.stuck(values)
        assert np.flatnonzero(found).tolist() == list(range(51, 51 + repeated))
    for length, count in ((10, 0), (11, 11)):
        values = noise.copy()
        values[50 : 50 + length, 1] = 9.0
        assert flags.clipped(values).sum(axis=0).tolist() == [0, count]


def with_counts():
    """The sound test as counts, and a calibration of factor 1."""
    test = sound().rename(spectral_radiance="counts").drop_vars(["signal_wide", "signal_narrow", "time"])
    test["counts"] = (test.counts.dims, np.arange(test.counts.size).reshape(test.counts.shape) + 100.0)
    test["background_counts"] = ("wavelength", np.full(test.sizes["wavelength"], 50.0))
    for name in ("counts", "background_counts"):
        test[name].attrs["units"] = "count"
    ones = np.ones(test.sizes["wavelength"])
    calibration = xr.Dataset(
        {
            "calibration_factor": ("wavelength", ones),
            "calibration_factor_uncertainty": ("wavelength", ones / 100),
            "pixel_status": ("wavelength", np.where(np.arange(ones.size) == 7, 4, 0)),
        },
        {"wavelength": test.wavelength.values},
    )
    return test, calibration


def test_each_sample_of_a_spectrum_has_the_flag_of_its_own_fault():
    test, calibration = with_counts()
    limit = float(test.counts[3, 5])
    lost = test.counts.values.copy()
    lost[2, 4] = np.nan
    test["counts"] = (test.counts.dims, lost, test.counts.attrs)
    found = record_of(test, {"spectrometer": calibration}, saturation_counts=limit).instrument("spectrometer")
    flag = found.flag
    assert flag[2, 4] == flags.LOST
    assert (flag[:, 7] & flags.MASKED == flags.MASKED).all()
    rest = np.delete(flag, 7, axis=1)
    expected = np.where(np.delete(test.counts.values, 7, axis=1) >= limit, flags.SATURATED, 0)
    expected[2, 4] = flags.LOST
    np.testing.assert_array_equal(rest, expected)
    # (count - dark) / s
    assert found.value[0, 0] == 50.0 and found.integration_time == 1.0
