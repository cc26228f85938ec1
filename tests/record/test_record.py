"""The record of a test against numbers written down, and what its readers make of its flags."""

import dataclasses

import numpy as np
import pytest
import xarray as xr

from plasmapyro.contracts.variables import VARIABLES
from plasmapyro.diagnosis.fit import observation
from plasmapyro.experiment.stage import correct_pyrometer
from plasmapyro.instrument.calibration import quadratic_ratio
from plasmapyro.record import binning, flags, status
from plasmapyro.record.calibrated import of_pixels
from plasmapyro.record.emittance import UNTOLD_SLOPE
from plasmapyro.record.phases import afterwards, during, unlit
from plasmapyro.record.record import record_of

START, STEP = 100.0, 0.1  # [s] injection on the clock of the test; from sample to sample
TIME = np.round(np.arange(-3.0, 60.0, STEP), 9)
COEFFICIENT, FIT, INSTRUMENT = np.array([0.40, 0.12, -0.003]), (973.0, 1773.0), (973.0, 2073.0)
LIMITS = {
    "signal_uncertainty": 0.01,
    "gas_variation": 0.03,
    "detection_level": 2.0,
    "least_surface_share": 0.5,
}
NOISE = 0.002


def calibration():
    return xr.Dataset(
        {
            "fit_coefficient": ("fit_power", COEFFICIENT),
            "fit_covariance": (("fit_power", "other_fit_power"), np.diag([1e-6, 2e-6, 2e-6])),
            "fit_range": ("bound", list(FIT)),
            "instrument_range": ("bound", list(INSTRUMENT)),
        }
    )


def temperature(time, rate=60):
    return np.clip(350 + rate * (time - 5), 350, 1600)


def slowly(change=None):
    """The same, heating over all of the test."""
    return made(change, rate=28)


def made(change=None, rate=60, **attributes):
    """A noisy pyrometer in front of a plate that heats to 1600 K; plasma until 50 s after the injection."""
    kelvin = temperature(TIME, rate)
    narrow = 1e-6 * np.exp(14000 * (1 / 1600 - 1 / kelvin)) * (TIME >= 0)
    wide = np.maximum(quadratic_ratio(kelvin, COEFFICIENT, FIT), 0.01) * narrow
    gas = np.array([2e-8, 1e-8])[:, None] * (TIME <= 50)
    noise = 1 + NOISE * np.random.default_rng(5).standard_normal((2, TIME.size))
    signals = (np.stack([wide, narrow]) + gas) * noise
    if change is not None:
        signals = change(signals)
    return xr.Dataset(
        {
            "signal_wide": ("time", signals[0], {"units": "A"}),
            "signal_narrow": ("time", signals[1], {"units": "A"}),
            "electric_power": ("time", np.full(TIME.size, 1.6e5), {"units": "W"}),
        },
        {"time": ("time", TIME + START, {"units": "s"})},
        {
            "origin": "synthetic",
            "condition": "80kW",
            "injection_time": START,
            "plasma_off_time": START + 50.0,
            "reference_window": np.array([START + 1.0, START + 4.0]),
            "emittance": 0.85,
            "emittance_uncertainty": 0.05,
            "window_transmittance_pyrometer": 0.9,
            "pyrometer_integration_time": 0.01,
        }
        | attributes,
    )


def corrected(test):
    return correct_pyrometer(test, calibration(), **LIMITS, draws=20, seed=1)


def test_a_record_counts_from_the_injection_and_tells_what_the_test_states():
    record = record_of(made(emittance_slope=1.02, emittance_slope_uncertainty=0.01), {"pyrometer": None})
    bands = record.instrument("pyrometer")
    np.testing.assert_allclose(bands.time, TIME, atol=1e-12)
    np.testing.assert_allclose(record.clock(bands.time), TIME + START, atol=1e-12)
    assert (record.off, record.window) == (50.0, (1.0, 4.0))
    assert (record.emittance_slope, record.emittance_slope_uncertainty) == (1.02, 0.01)
    untold = record_of(made(), {"pyrometer": None})
    assert untold.emittance_slope_uncertainty == UNTOLD_SLOPE == 0.01
    assert (
        record_of(made(emittance_slope_uncertainty=0.0), {"pyrometer": None}).emittance_slope_uncertainty == 0
    )
    assert (bands.band, bands.window_transmittance, bands.integration_time) == (("wide", "narrow"), 0.9, 0.01)
    assert list(record.accompanying) == ["electric_power"] and record.instrument("spectrometer") is None
    np.testing.assert_array_equal(
        record.in_window(np.array([0.9, 1.0, 4.0, 4.1])), [False, True, True, False]
    )
    with pytest.raises(dataclasses.FrozenInstanceError):
        record.off = 3.0


def test_flagged_samples_are_kept_as_measured_and_left_out_of_what_is_sound():
    limit = 5e-7
    bands = record_of(made(signal_saturation_narrow=limit), {"pyrometer": None}).instrument("pyrometer")
    beyond = bands.value[:, 1] >= limit
    assert beyond.sum() > 100
    np.testing.assert_array_equal(bands.flag[:, 1] == flags.SATURATED, beyond)
    assert np.isfinite(bands.value).all() and np.isnan(bands.sound[beyond, 1]).all()
    np.testing.assert_array_equal(bands.sound[~beyond], bands.value[~beyond])


def test_a_flat_top_that_nothing_states_gives_no_temperature():
    """The wide band ends at 0.35 uA, as one with a stated limit there: up to 300 K too cold, else."""

    def clip(signals):
        return np.stack([np.minimum(signals[0], 3.5e-7), signals[1]])

    stated = corrected(made(clip, signal_saturation_wide=3.5e-7))
    found = corrected(made(clip))
    assert (found.corrected_status == status.SATURATED).sum() > 100
    np.testing.assert_array_equal(found.corrected_status, stated.corrected_status)
    np.testing.assert_array_equal(
        found.signal_wide, clip(np.array([made().signal_wide, made().signal_narrow]))[0]
    )


def test_a_logger_that_hangs_gives_no_temperature():
    first, last = np.searchsorted(TIME, [20.0, 30.0])

    def hang(signals):
        signals[:, first:last] = signals[:, [first]]
        return signals

    state = corrected(made(hang)).corrected_status.values
    assert (state[first + 1 : last] == status.MISSING).all()
    assert state[first] == state[last] == status.VALID


def test_a_record_that_never_changes_has_no_sound_sample_but_the_first():
    bands = record_of(made(lambda s: np.tile(s[:, [300]], s.shape[1])), {"pyrometer": None}).instruments[0]
    assert (bands.flag[1:] == flags.STUCK).all() and (bands.flag[0] == 0).all()
    lamp = flags.stuck(bands.value)  # a steady furnace read with few digits
    assert not lamp.any()


@pytest.mark.parametrize("channel", [0, 1])
def test_a_channel_that_saturates_softly_is_flagged_from_where_it_bends(channel):
    """S = L tanh(S0 / L), with an analytic slope 2x / sinh(2x) of its logarithm, x = S0 / L."""

    def bend(signals):
        top = 0.8 * signals[channel].max()
        signals[channel] = top * np.tanh(signals[channel] / top)
        return signals

    sound = record_of(slowly(), {"pyrometer": None}).instruments[0]
    assert (sound.flag == 0).all()
    bands = record_of(slowly(bend), {"pyrometer": None}).instruments[0]
    high = bands.flag[:, channel] == flags.CLIPPED
    assert high.sum() > 50 and (bands.flag[:, 1 - channel] == 0).all()
    lost = 1 - bands.value[:, channel] / sound.value[:, channel]
    # 2x / sinh(2x) = 0.93 at x = 0.33, where tanh has lost 3.5 %; bins and the mean over three of them: 15 %.
    assert lost[high].min() > 0.03 and lost[~high].max() < 0.15


def test_a_gas_that_was_brighter_before_and_takes_a_moment_to_die_is_no_bend():
    """Sound samples of the band that sees less of it had been left out as near the end of its detector."""

    def shine(signals):
        course = np.where(TIME < 0, 2.9, np.exp(-np.maximum(TIME - 50, 0) / 0.05))
        return signals + np.array([[0.6], [0.06]]) * signals.max(axis=1, keepdims=True) * course

    bands = record_of(slowly(shine), {"pyrometer": None}).instruments[0]
    assert (bands.flag == 0).all()


@pytest.mark.parametrize(("slope", "flagged"), [(0.9, False), (0.8, True)])
def test_a_bend_is_one_from_a_slope_of_85_per_cent_on(slope, flagged):
    """ln S of one channel rises with the other's as 1, and as `slope` in its upper third."""
    level = np.repeat(np.linspace(0, 3, 301), 2)
    bent = np.minimum(level, 2.0) + slope * np.maximum(level - 2.0, 0)
    found = flags.rounded(np.exp(np.stack([level, bent], axis=1)), np.zeros((602, 2)))
    assert found[:, 1].any() == flagged and not found[:, 0].any()
    if flagged:  # known to a tenth, the width of a bin, and two more that a mean spans
        assert 2.0 < level[found[:, 1]].min() < 2.3
    level[:] = 1.0  # one that hangs
    assert not flags.rounded(np.exp(np.stack([level, bent], axis=1)), np.zeros((602, 2))).any()


@pytest.mark.parametrize("fog", [0.0, 0.2])
def test_a_gas_that_is_not_quite_taken_out_bends_no_band(fog):
    """A wide band whose gas is as bright as its surface, behind a window that fogs, and then without gas."""
    narrow = np.concatenate([np.linspace(-3, 0, 400), np.linspace(0, -3, 100)])
    surface = np.exp(np.stack([1.07 * narrow, narrow], axis=1)) * [1.0, 4.0]
    gas = np.where(np.arange(500) < 400, 1.0, 0.0)[:, None] * [1.0, 0.8]
    through = 1 - fog * np.clip(np.arange(500) / 400, 0, 1)[:, None]
    assert not flags.rounded((surface + gas) * through, gas).any()


FAR = {  # samples of the narrow band that are multiplied, and whether they are a spike
    "one sample, brighter": (slice(200, 201), 1.1, True),
    "three samples, darker": (slice(200, 203), 0.5, True),
    "a mark for none": (slice(200, 202), -9999.0, True),
    "noise": (slice(200, 201), 1.01, False),
    "a step": (slice(200, None), 1.5, False),
    "a pulse of four samples": (slice(200, 204), 1.5, False),
    "the light goes out": (slice(400, None), 1e-3, False),
    "a first sample without neighbours": (slice(0, 1), 3.0, False),
}


@pytest.mark.parametrize("case", FAR)
def test_samples_beyond_all_their_neighbours_are_spikes(case):
    where, factor, spike = FAR[case]
    value = np.exp(TIME / 20)[:, None] * [2.0, 1.0]
    value *= 1 + NOISE * np.random.default_rng(4).standard_normal(value.shape)
    value[50, 1] = np.nan
    assert not flags.spiked(value).any()
    value[where, 1] *= factor
    found = flags.spiked(value)
    assert not found[:, 0].any()
    assert np.flatnonzero(found[:, 1]).tolist() == (list(range(where.start, where.stop)) if spike else [])


def test_noise_of_a_record_that_begins_between_its_neighbours_is_no_spike():
    """Three first samples in line, by chance: the scatter there is that of the samples about it."""
    noise = 1 + 0.04 * np.random.default_rng(4).standard_normal((200, 1))
    noise[:5, 0] = [1.05, 1.0, 0.95, 1.0, 1.05]
    assert not flags.spiked(noise).any()
    assert not flags.spiked(noise[::-1]).any()
    noise[2] = 2.0
    assert np.flatnonzero(flags.spiked(noise)).tolist() == [2]


def test_a_stated_slope_is_taken_out_of_the_ratio():
    def steeper(signals):
        return np.stack([1.03 * signals[0], signals[1]])

    plain, stated = corrected(made()), corrected(made(steeper, emittance_slope=1.03))
    for name in ("corrected_temperature", "measured_temperature"):
        np.testing.assert_allclose(stated[name], plain[name], rtol=1e-9)
    assert (
        np.nanmax(np.abs(corrected(made(steeper)).corrected_temperature - plain.corrected_temperature)) > 20
    )


def test_parts_of_a_test_are_shares_of_its_exposure():
    np.testing.assert_allclose(during([0.1, 1.0], 300.0), [30.0, 300.0])
    np.testing.assert_allclose(afterwards([0.0, 0.5, 1.0], 300.0, 400.0), [300.0, 350.0, 400.0])
    np.testing.assert_allclose(afterwards([1.0], 300.0, 320.0), [320.0])  # to the end of the record
    np.testing.assert_allclose(afterwards([1.0], 300.0, 9000.0), [400.0])  # a third of the exposure at most
    np.testing.assert_allclose(afterwards([1.0], 300.0, 200.0), [300.0])  # the record ends before


def test_bins_of_a_short_exposure_are_short():
    edges = binning.time_edges(-4.0, 12.0, 0.0, 6.0)
    np.testing.assert_allclose(np.diff(edges[(edges >= 1) & (edges <= 4)]), 0.2)
    np.testing.assert_allclose(np.diff(edges[(edges >= 0) & (edges <= 1)]), 0.1)


def test_bins_before_the_end_of_the_plasma_are_as_short_as_a_clock_may_be_off():
    edges = binning.time_edges(-10.0, 320.0, 0.0, 300.0)
    last = edges[(edges > 295.9) & (edges <= 300)]
    np.testing.assert_allclose(last, [296, 297, 298, 298.5, 299, 299.5, 300])
    steps = np.diff(edges[(edges >= 100) & (edges <= 296)])
    assert np.all((steps > 0.3 * 8.0) & (steps < 1.4 * 8.0))
    assert (
        binning.time_edges(-10.0, 300.0, 0.0, 300.0)[-2] < 296
    )  # nothing is seen of an end at the last sample


def test_no_bin_holds_a_sample_beside_a_switch():
    """The second before the injection and a quarter beside the end are in no bin, nor straddlers."""
    begin = np.array([-1.9, -1.4, -0.4, 0.0, 8.5, 9.5, 9.95, 10.2, 10.25])
    found = binning.membership(begin, begin + 0.5, np.arange(-2.0, 13.0), 0.0, 10.0)
    np.testing.assert_array_equal(found, [0, -1, -1, 2, 10, -1, -1, -1, 12])


def test_a_mean_stands_at_the_mean_time_of_its_samples():
    bands = record_of(made(), {"pyrometer": None}).instrument("pyrometer")
    short = binning.thinned(bands, 50.0, 100)
    group = binning.groups(bands.time, (0.0, 50.0), 100)
    for one in (0, 50, group.max()):
        assert short.time[one] == pytest.approx(bands.time[group == one].mean(), abs=1e-9)


def test_a_mean_over_a_saturated_sample_is_saturated_and_one_over_a_lost_sample_is_not():
    bands = record_of(made(), {"pyrometer": None}).instrument("pyrometer")
    flag = bands.flag.copy()
    flag[100, 0], flag[200, 0] = flags.SATURATED, flags.LOST
    short = binning.thinned(dataclasses.replace(bands, flag=flag), 50.0, 100)
    group = binning.groups(bands.time, (0.0, 50.0), 100)
    assert short.flag[group[100], 0] == flags.SATURATED and np.isnan(short.sound[group[100], 0])
    assert short.flag[group[200], 0] == 0
    others = np.flatnonzero((group == group[200]) & (flag[:, 0] == 0))
    assert short.value[group[200], 0] == pytest.approx(bands.value[others, 0].mean(), rel=1e-12)


@pytest.mark.parametrize(("exposure", "error"), [(1.0, 2e-3), (3.6, 2e-3)])
def test_the_instants_of_an_exposure_give_the_mean_of_light_that_grows_fast(exposure, error):
    """Exponential growth, by a factor of ten in 2.4 s; two instants would be 3 % off in the long exposure."""
    rate = np.log(10) / 2.4
    nodes = observation.nodes_of(exposure)
    index = np.zeros(1, dtype=int)
    half = np.array([exposure / 2])
    instants, _ = observation.instants(-half, half, index, 1, nodes)
    exact = np.sinh(rate * half[0]) / (rate * half[0])
    assert np.exp(rate * instants).mean() == pytest.approx(exact, rel=error)


def test_a_calibration_serves_a_test_that_holds_some_of_its_pixels():
    axis = np.linspace(500e-9, 900e-9, 9)
    whole = xr.Dataset({"calibration_factor": ("wavelength", np.arange(9.0))}, {"wavelength": axis})
    part = of_pixels(whole, xr.Dataset(coords={"wavelength": axis[2:6] + 4e-12}))
    assert part.calibration_factor.values.tolist() == [2, 3, 4, 5]
    other = xr.Dataset(coords={"wavelength": axis[2:6] + 1e-9})
    assert of_pixels(whole, other) is whole  # which is refused later


@pytest.mark.parametrize("before", [0.0, 0.02])
def test_what_was_recorded_before_the_plasma_burned_is_no_gas(before):
    """The dark of a record that begins early would be gas that grew a thousandfold."""
    dark = TIME < -1.5

    def late(signals):
        return np.where(dark, before * signals, signals)

    pyrometer = record_of(made(late), {"pyrometer": None}).instrument("pyrometer")
    assert (pyrometer.flagged(flags.UNLIT).all(axis=1) == dark).all()
    weak = record_of(made(lambda x: np.where(dark, 0.5 * x, x)), {"pyrometer": None}).instrument("pyrometer")
    assert not weak.flagged(flags.UNLIT).any()  # without a probe before it a jet shines less


def test_a_slow_instrument_without_a_sample_in_the_window_knows_the_dark_by_its_last_before():
    time, light = np.array([-26.0, -18.0, -10.0, -2.0, 6.0]), np.array([0.01, 0.01, 0.9, 1.0, 3.0])
    assert list(unlit(time, light[:, None] * [2.0, 1.0], (0.2, 4.0))) == [True, True, False, False, False]
    assert not unlit(time, np.full((5, 2), np.nan), (0.2, 4.0)).any()


def test_an_exposure_that_goes_on_behind_the_window_is_no_gas():
    """Half of it sees the surface, beside which the gas before would pass for dark."""
    time, light = np.array([-26.0, -18.0, -10.0, -2.0, 6.0]), np.array([0.01, 0.9, 1.0, 1.0, 30.0])
    value = light[:, None] * [2.0, 1.0]
    assert list(unlit(time, value, (0.2, 9.0), exposure=7.0)) == [True, False, False, False, False]


def test_a_gas_as_faint_as_the_noise_of_a_pixel_is_seen_by_all_of_them():
    random, time = np.random.default_rng(4), np.array([-128.0, -92.0, -57.0, -21.0, 14.0, 50.0])
    value = 1.0 + 2.0 * random.standard_normal((time.size, 3000))
    assert not unlit(time, value, (0.0, 17.0), exposure=28.0).any()
    value[:2] -= 1.0
    assert list(unlit(time, value, (0.0, 17.0), exposure=28.0)) == [True, True, False, False, False, False]


def test_a_shutter_between_the_window_and_the_injection_leaves_the_reference():
    time, light = np.arange(-20.0, 5.0), np.ones((25, 2))
    light[(time < -18) | (time == -3)] = 0.01
    assert list(time[unlit(time, light, (-15.0, -5.0))]) == [-20.0, -19.0]


def test_gas_that_is_not_there_may_be_told_as_a_little_less_than_none():
    """The walk of the joint estimate before the plasma, or in a pause, scatters about zero."""
    assert VARIABLES["gas_amplitude"].low < 0


def cooling(lamp=0.0, noise=1e-4):
    """Times (t,) [s] from the end of the plasma and light (t, 2) that fades; that of a lamp from 5 s on."""
    time = np.arange(0.1, 10.0, 0.1)
    scatter = noise * np.random.default_rng(2).standard_normal((time.size, 2))
    light = np.exp(-time)[:, None] * [2.0, 1.0] * (1 + scatter) + scatter
    return time, light + lamp * (time > 4.95)[:, None] * [1.0, 0.1]


def test_light_that_grows_after_the_end_is_of_no_surface_and_all_later_samples_go():
    time, light = cooling(lamp=0.02)
    assert time[flags.relit(time, light, 0.0)][0] == pytest.approx(5.0)
    assert flags.relit(time, light, 0.0).sum() == (time > 4.95).sum()
    light[20], light[25:28] = np.nan, 0.0
    assert flags.relit(time, light, 0.0).sum() == (time > 4.95).sum()
    dark = cooling()[1]
    dark[25:28] = 0.0  # a dropout
    assert not flags.relit(time, dark, 0.0).any()


@pytest.mark.parametrize(
    "light",
    [
        cooling()[1],
        cooling(noise=0.02)[1],
        cooling(lamp=1e-3)[1],  # a thousandth of what shone at the end
        np.random.default_rng(1).standard_normal((99, 2)),  # the sample left the view before the end
        np.full((99, 2), np.nan),
        np.zeros((99, 2)),
        np.exp(cooling()[0] / 5)[:, None] * [2.0, 1.0],  # the plasma burns on, the stated end is wrong
    ],
    ids=["clean", "noisy", "faint", "dark", "lost", "zero", "burning"],
)
def test_a_surface_that_cools_and_darkness_keep_their_samples(light):
    assert not flags.relit(cooling()[0], light, 0.0).any()


def test_a_lamp_after_the_end_of_the_plasma_leaves_no_temperature_there():
    fading = np.exp(-np.maximum(TIME - 50.0, 0.0) / 10)
    test = made(lambda x: np.where(TIME > 55.0, 3.0, 1.0) * fading * x)
    assert record_of(test, {"pyrometer": None}).instrument("pyrometer").flagged(flags.RELIT).any()
    limited = test.assign_attrs(signal_saturation_narrow=5e-7)  # which the light at the end exceeds
    assert record_of(limited, {"pyrometer": None}).instrument("pyrometer").flagged(flags.RELIT).any()
    found = corrected(test)
    assert (found.corrected_status.values[TIME > 55.05] == status.MISSING).all()
    assert (found.corrected_status.values[TIME < 55.0] != status.MISSING).all()
