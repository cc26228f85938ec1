"""Each rule says what it saw of the contradiction it is for, and nothing of sound data."""

import tracemalloc
from datetime import datetime, timedelta
from pathlib import Path

import laboratory
import numpy as np
import pytest
import xarray as xr

from plasmapyro.constants import BOLTZMANN
from plasmapyro.instrument.pyrometer import blackbody_signals
from plasmapyro.quality import agreement, series
from plasmapyro.quality.catalogue import OF_CALIBRATION, OF_SIGHTLINE, OF_TEST, agreed, merged, of_test, table
from plasmapyro.quality.rule import Case, look
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.readers.stage import Reading
from plasmapyro.record import flags
from plasmapyro.tables import rows

PLACE = Path("my_test")
ALL = {rule.name: rule for rule in (*OF_TEST, *OF_CALIBRATION, *OF_SIGHTLINE)}
NAMES = [f"spectrum_{index:03d}.txt" for index in range(30)]
START = datetime(2026, 11, 22, 10)


@pytest.fixture(scope="module")
def sound():
    return laboratory.made()


def files(**changes):
    """Files of the spectra of the sound test: one every 2 s from 1 s on."""
    dates = [START + timedelta(seconds=2 * index) for index in range(30)]
    known = {
        "place": Path("spectrometer"),
        "names": NAMES,
        "dates": dates,
        "ordered": True,
        "counted": True,
        "background": None,
    }
    return known | changes


def said(test=None, given=None, rules=OF_TEST, **more):
    """Names of the rules that speak of a case -> their words."""
    case = Case(PLACE, test, files() if given is None and test is not None else given or {}, **more)
    return {finding.rule.name: finding.words for finding in look(case, rules)}


def with_signals(test, change):
    """The test with other signals: (time, pair (2, t)) -> pair."""
    pair = change(test.time.values, np.stack([test.signal_wide.values, test.signal_narrow.values]))
    return test.assign(signal_wide=("time", pair[0]), signal_narrow=("time", pair[1]))


def with_spectra(test, change, name="counts"):
    return test.assign({name: (test[name].dims, change(test[name].values.copy()))})


def attributes(test, **changes):
    return test.copy().assign_attrs(test.attrs | changes)


def times(row, span, value):
    row = row.copy()
    row[span] = value
    return row


def test_sound_data_are_passed_in_silence(sound):
    assert said(sound) == {}


def at(time, begin, end):
    return (time >= begin) & (time < end)


PYROMETER = {
    "equal_channels": (lambda t, p: np.stack([p[0], 0.7 * p[0]]), "their ratio is 1.42857 in all samples"),
    "swapped_bands": (lambda t, p: p[::-1], "falls while both signals rise (slope -0.1"),
    "negative_signal": (lambda t, p: np.stack([p[0], -p[1]]), "signal_narrow is below zero in 100%"),
    "stuck": (
        lambda t, p: np.where(at(t, 30, 34), p[:, [136]], p),
        "exactly the same over 16 samples, from 30 to 33.75 s",
    ),
    "flat_top": (
        lambda t, p: np.stack([p[0], np.minimum(p[1], 1e-3)]),
        "signal_narrow stands at exactly its highest value, 0.001 A, in ",
    ),
    "rounded_top": (
        lambda t, p: np.stack([np.tanh(p[0] / 1.7e-3) * 1.7e-3, p[1]]),
        "signal_wide bends away from the other one above 0.00116 A, first at 32 s",
    ),
    "unit_of_signals": (lambda t, p: p * 1e3, "signal_wide reaches 2.09 A"),
    "unexplained_step": (
        lambda t, p: p * np.where(t >= 35, [[1.05], [1.0]], 1.0),
        "the ratio wide/narrow steps by +",
    ),
    "spikes": (
        lambda t, p: p * np.where(t == 2.5, 2.0, 1.0),
        "signal_wide and signal_narrow: 1 samples far above or below all their neighbours, ",
    ),
    "scatter_of_signals": (
        lambda t, p: p * np.stack([1 + 0.04 * np.cos(np.pi * np.arange(t.size)), np.ones(t.size)]),
        "signal_wide scatters by 9.",
    ),
    "dark_reference": (
        lambda t, p: p * np.where(t < 5.5, 1e-5, 1.0),
        "in the reference window the signals are 5e-08",
    ),
}


@pytest.mark.parametrize("name", PYROMETER)
def test_a_rule_of_the_pyrometer_says_what_it_saw(sound, name):
    change, words = PYROMETER[name]
    found = said(with_signals(sound, change))
    assert words in found[name]
    assert found[name].startswith("my_test: ")


def test_noise_about_nought_in_the_dark_is_no_light_below_zero(sound):
    random = np.random.default_rng(1)

    def faded(t, p):
        dark = 1e-4 * p.max() * random.standard_normal(p.shape)
        return np.where(t > t[t.size // 2], dark, p)

    assert "negative_signal" not in said(with_signals(sound, faded))
    below = said(with_signals(sound, lambda t, p: faded(t, p) - 1e-3 * p.max()))
    assert "is below zero in" in below["negative_signal"]


def test_a_record_that_never_changes_is_stuck(sound):
    for channels in ([0, 1], [1]):
        held = with_signals(sound, lambda t, p, c=channels: np.where(np.isin([[0], [1]], c), p[:, [99]], p))
        assert f"over {sound.time.size} samples" in said(held)["stuck"]


SMALL = {  # just inside the limits: nothing is said of them
    "stuck": lambda t, p: np.where(at(t, 30, 32.25), p[:, [136]], p),
    "unexplained_step": lambda t, p: p * np.where(t >= 35, [[1.015], [1.0]], 1.0),
    "negative_signal": lambda t, p: p * np.where(at(t, 30, 35.75), -1, 1),
    "unit_of_signals": lambda t, p: p * 470,
    "scatter_of_signals": lambda t, p: p * (1 + 0.01 * np.cos(np.pi * np.arange(t.size))),
    "dark_reference": lambda t, p: p * np.where(t < 5.5, 2e-5 * p.max() / np.median(p[0][t < 5.5]), 1.0),
}


@pytest.mark.parametrize("name", SMALL)
def test_a_rule_of_the_pyrometer_is_silent_below_its_limit(sound, name):
    assert name not in said(with_signals(sound, SMALL[name]))


def test_a_shutter_that_opens_in_the_reference_window_is_a_step(sound):
    """Light that comes in the window is no surface: that window holds none."""
    shut = with_signals(sound, lambda t, p: p * np.where(t < 3, 0.5, 1.0))
    assert "signal_wide steps by +9" in said(shut)["unexplained_step"]


def test_a_saturation_that_is_stated_is_not_said_again(sound):
    clipped = with_signals(sound, lambda t, p: np.minimum(p, [[np.inf], [1e-3]]))
    assert "flat_top" not in said(attributes(clipped, signal_saturation_narrow=0.99e-3))


def test_signals_of_few_digits_are_neither_stuck_nor_clipped(sound):
    rounded = with_signals(sound, lambda t, p: np.round(p / p.max(axis=1, keepdims=True) * 200) * 1e-6)
    assert not {"stuck", "flat_top", "equal_channels"} & set(said(rounded))


def test_rules_of_spectra_say_what_they_saw(sound):
    repeated = with_spectra(sound, lambda c: times(c, 9, c[8]))
    assert "the spectra at 17 and 19 s are equal" in said(repeated)["repeated_spectrum"]
    exchanged = with_spectra(sound, lambda c: c[[*range(8), 20, *range(9, 20), 8, *range(21, len(c))]])
    assert (
        "3 spectra do not lie between their neighbours, the first at 17 s" in said(exchanged)["lone_spectrum"]
    )
    summed = with_spectra(sound, lambda c: c * 10)
    assert "more than a 16-bit converter gives" in said(summed)["nonlinear_end"]


@pytest.mark.parametrize("frame", [6, 15, 22])
def test_a_ray_that_hits_a_pixel_moves_no_clock(sound, frame):
    """It outshines its spectrum: the mean of a few pixels is as if of another moment."""

    def hit(counts):
        counts[frame, 40] += 0.2 * np.nansum(counts[frame] - sound.background_counts.values)
        return counts

    assert {"two_clocks", "lone_spectrum"}.isdisjoint(said(with_spectra(sound, hit), {}))


def test_samples_that_are_missing_by_chance_contradict_nothing(sound):
    """Exposures over the end of the plasma see what no sample tells; a step over a gap is no end of it."""
    for seed in range(8):
        lost = np.random.default_rng(seed).random((2, sound.time.size)) < 0.15
        assert said(with_signals(sound, lambda t, p, lost=lost: np.where(lost, np.nan, p))) == {}, seed


@pytest.mark.parametrize("frames", [[0], [8, 9, 10], [0, 29]])
def test_spectra_that_are_missing_are_no_copies_and_blind_no_rule(sound, frames):
    lost = with_spectra(sound, lambda c: times(c.astype(float), frames, np.nan))
    assert said(lost) == {}
    assert "lone_spectrum" in said(with_spectra(lost, lambda c: times(c, 20, 2 * c[20])))


def test_pixels_that_are_lost_in_all_files_make_no_constant_dark(sound):
    lost = (sound.wavelength > sound.wavelength[40]) & (sound.wavelength < sound.wavelength[44])
    names = ("counts", "background_counts")
    assert said(sound.assign({name: sound[name].where(~lost) for name in names})) == {}


DARKS = {
    "dark_constant": (lambda dark, counts: 0 * dark, "the dark is 0 counts in every pixel"),
    "dark_brighter": (lambda dark, counts: counts[15], "the dark is brighter than the spectrum at"),
    "dark_like_light": (lambda dark, counts: counts[0], "the dark equals the spectrum at 1 s"),
}


@pytest.mark.parametrize("name", DARKS)
def test_a_rule_of_the_dark_names_its_file(sound, name):
    change, words = DARKS[name]
    dark = change(sound.background_counts.values, sound.counts.values)
    test = sound.assign(background_counts=("wavelength", dark))
    found = said(test, files(background=Path("my_test/dark.txt")))
    assert found[name].startswith("my_test/dark.txt: ")
    assert words in found[name]


@pytest.mark.parametrize("unit", [1.0, 1e6, 1e7, 1e9, 1e13])
def test_counts_that_are_called_radiance_are_whole_numbers(sound, unit):
    values = np.round(sound.counts.values) * unit
    test = sound.drop_vars(["counts", "background_counts"])
    test["spectral_radiance"] = (("spectrum_time", "wavelength"), values)
    assert "counts_as_radiance" in said(test)
    noisy = values * (1 + 1e-3 * np.random.default_rng(3).standard_normal(values.shape))
    test["spectral_radiance"] = (("spectrum_time", "wavelength"), noisy)
    assert "counts_as_radiance" not in said(test)
    # 1e4 counts are 1e13 W m-2 sr-1 m-1 in W/m2/sr/nm; a black body of 3500 K gives 3e12 at 900 nm.
    assert ("too_bright" in said(test)) == (unit > 1e8)


FILES = {
    "natural_order": (
        {"names": [f"s{i}.txt" for i in range(1, 31)]},
        "s1.txt, s2.txt, ..., s30.txt (by letters s10.txt",
    ),
    "missing_frame": (
        {"names": [f"s{i:02d}.txt" for i in range(31) if i != 7]},
        "1 numbers are missing in the file names, the first after s06.txt: all later spectra",
    ),
    "mixed_series": (
        {"names": [*NAMES[:29], "lamp_1.txt"]},
        "lamp_1.txt does not belong to the series spectrum_000",
    ),
    "dates_against_order": (
        {
            "dates": [START + timedelta(seconds=2 * i + 2 * (i > 10) + 1) for i in range(30)][:11]
            + [START + timedelta(seconds=2 * i + 4) for i in range(11, 30)]
        },
        "by its header spectrum_011.txt was taken 25 s after spectrum_000.txt, by `from: order` 22 s",
    ),
}


@pytest.mark.parametrize("name", FILES)
def test_a_rule_of_the_files_says_what_it_saw(sound, name):
    changes, words = FILES[name]
    found = said(sound, files(**changes))
    assert found[name].startswith("spectrometer: ")
    assert words in found[name]


def test_the_few_spectra_of_a_window_are_alike(sound):
    alone = sound.drop_vars(["time", "signal_wide", "signal_narrow"])
    dark = alone.background_counts.values
    for growth, words in ((1.08, None), (1.15, "0 to 5 s: the light of its 3 spectra differs by 1")):
        heating = np.where(np.arange(30) == 2, growth, 1.0)[:, None]
        seen = said(with_spectra(alone, lambda c: dark + (c - dark) * heating))  # noqa: B023
        assert (words is None and "frames_in_window" not in seen) or words in seen["frames_in_window"]
    faint = with_spectra(alone, lambda c: np.where(np.arange(30)[:, None] < 3, dark + (c - c.mean()), c))
    assert "frames_in_window" not in said(faint)
    both = with_spectra(sound, lambda c: dark + (c - dark) * heating)
    assert "frames_in_window" not in said(both)  # the pyrometer tells more


def test_without_a_plasma_the_dark_holds_no_light_of_it(sound):
    for wrong in (1.0, 1e-9):  # of the light of the gas in the pyrometer
        case = with_signals(sound, lambda t, p: np.where(t <= 5.0, p * wrong, p))  # noqa: B023
        case["background_counts"] = case.counts[0]
        words = said(case)
        assert ("dark_like_light" in words) is (wrong == 1.0)
        assert ("dark_reference" in words) is (wrong != 1.0)


@pytest.mark.parametrize("dead", [0.0, 9000.0], ids=["dead", "hot"])
def test_a_dark_that_holds_the_light_is_seen_beside_pixels_that_see_none(sound, dead):
    counts = sound.counts.values.copy()
    dark = counts[0].copy()
    counts[:, [40, 90]] = dead  # not so in the dark
    case = sound.assign(counts=(sound.counts.dims, counts), background_counts=("wavelength", dark))
    assert "dark_like_light" in said(case)


def test_dates_may_differ_by_their_rounding(sound):
    rounded = [START + timedelta(seconds=2 * i + i % 3) for i in range(30)]
    assert said(sound, files(dates=rounded)) == {}
    assert said(sound, files(dates=[None, *rounded[1:]])) == {}


def moved(test, axis, change):
    return test.assign_coords({axis: change(test[axis].values)})


AXES = {
    "gap_in_cycle": (
        lambda t: moved(t, "spectrum_time", lambda s: s + 3.0 * (s > 20)),
        "spectra come every 2 s, but 1 intervals are longer, the first from 19 to 24 s",
    ),
    "exposures_overlap": (
        lambda t: attributes(t, spectrometer_integration_time=2.5),
        "exposures of 2.5 s follow one another every 2 s",
    ),
    "wavelength_range": (
        lambda t: moved(t, "wavelength", lambda w: w * 1.5),
        "the pixels run from 1125 to 1545 nm",
    ),
    "width_of_spectrometer": (
        lambda t: attributes(t, spectrometer_fwhm=0.4e-9),
        "spectrometer_fwhm is 0.4 nm, the pixels are 1.88 nm apart over 280.1 nm",
    ),
    "record_begins_late": (
        lambda t: t.isel(time=slice(22, None)),
        "time begins at 1.5 s, the injection is at 0 s",
    ),
    "record_ends_early": (lambda t: t.isel(time=slice(0, 200)), "time ends at 45.75 s, the plasma at 50 s"),
    "gaps": (
        lambda t: t.isel(time=[*range(60), *range(110, 256)]),
        "time has 1 gaps, the first from 10.75 to 23.5 s",
    ),
    "few_in_plasma": (
        lambda t: moved(t, "spectrum_time", lambda s: s * 1000),
        "spectrum_time has 0 values between injection (0 s) and the end of the plasma (50 s)",
    ),
    "integration_longer_than_step": (
        lambda t: attributes(t, pyrometer_integration_time=10.0),
        "pyrometer_integration_time is 10 s, the samples follow every 0.25 s",
    ),
    "plasma_off_time": (
        lambda t: attributes(t, plasma_off_time=53.0),
        "the light of the pyrometer falls by 5% between 47.8",
    ),
    "light_after_end": (
        lambda t: t.assign(signal_wide=t.signal_wide + 2e-3 * (t.time > 55)),
        "the light of the pyrometer grows again from 55.25 s on, after the end of the plasma at 50 s",
    ),
    "two_clocks": (
        lambda t: moved(t, "spectrum_time", lambda s: s + 2.0),
        "the spectra fit the pyrometer best when moved by -2.4 s",  # a square is not quite their bend
    ),
}


@pytest.mark.parametrize("name", AXES)
def test_a_rule_of_times_and_axes_says_what_it_saw(sound, name):
    change, words = AXES[name]
    assert words in said(change(sound), {})[name]


def test_a_lag_that_the_joint_estimate_would_follow_is_said(sound):
    """It moves the temperature of the example by 11 K at a stated 4 K, and contradicts nothing else."""
    early = moved(sound, "spectrum_time", lambda s: s - 0.6)
    assert "moved by +0.6" in said(early, {})["two_clocks"]


@pytest.mark.parametrize(("late", "words"), [(-0.4, "moved by +0.3"), (0.4, "moved by -0.3")])
def test_a_lag_below_two_steps_of_the_log_is_said(sound, late, words):
    test = attributes(moved(sound, "spectrum_time", lambda s: s + late), spectrometer_integration_time=0.2)
    assert words in said(test, {})["two_clocks"]


def with_bands(test, late=0.0):
    """The test with its narrow band as two of a radiometer besides, on a clock that is late [s]."""
    own = test.signal_narrow.values[:, None] * [0.5, 1.0]
    more = test.assign(radiometer_signal=(("radiometer_time", "band"), own))
    return more.assign_coords(radiometer_time=test.time.values + late, band=["b1", "b2"])


def test_the_clock_of_a_radiometer_is_held_against_the_others(sound):
    assert said(with_bands(sound), {}) == said(sound, {})
    late = said(with_bands(sound, 12.5), {})
    assert "radiometer_time begins at 8.5 s, the injection is at 0 s" in late["record_begins_late"]
    assert "the light of the radiometer falls by" in late["plasma_off_time"]


def test_a_plasma_off_time_within_a_second_is_passed(sound):
    for moment in (49.0, 51.0):
        assert "plasma_off_time" not in said(attributes(sound, plasma_off_time=moment))


LIGHT = "corrected_radiance", "radiance_noise"


def result_of(pyrometer, spectrometer, uncertainties=(20.0, 2.0), state=0):
    """A correction that holds what the comparison needs: both temperatures at 1 to 10 s."""
    time = np.arange(1.0, 11.0)
    values = {
        "corrected_temperature": ("time", time, pyrometer, uncertainties[0], "corrected_status"),
        "scaled_temperature": ("spectrum_time", time, spectrometer, uncertainties[1], "spectrum_status"),
    }
    data, coords = {}, {}
    for name, (axis, moments, kelvin, error, status) in values.items():
        coords[axis] = moments
        data[name] = (axis, np.broadcast_to(np.asarray(kelvin, dtype=float), moments.shape).copy())
        data[f"{name}_uncertainty"] = (axis, np.full(moments.size, error))
        data[status] = (axis, np.full(moments.size, state, dtype="int8"))
    return xr.Dataset(data, coords)


def test_instruments_are_compared_in_their_combined_uncertainty():
    # hypot(21, 20) = 29: three of them are 87 K.
    for off, count in ((86.9, 0), (87.1, 10), (-87.1, 10)):
        moment, difference, error = agreement.disagreeing(result_of(1600 + off, 1600, (21.0, 20.0)), 3.0)
        assert moment.size == count
        np.testing.assert_allclose(difference, off)
        np.testing.assert_allclose(error, 29.0)
    assert agreement.disagreeing(result_of(1900, 1600, state=4), 3.0)[0].size == 0


def test_a_logger_that_asks_before_the_pyrometer_answers_is_said_and_its_repeats_are_left_out(sound):
    held = with_signals(sound, lambda t, p: p[:, np.arange(t.size) - np.arange(t.size) % 3])
    words = said(held)["asked_too_often"]
    assert "in 67% of the samples" in words or "in 66% of the samples" in words
    step = float(np.median(np.diff(sound.time)))
    assert f"about every {3 * step:.3g} s" in words


@pytest.mark.parametrize("digits", [6.0, 1.0, 0.02], ids=["fine", "coarse", "steady"])
def test_rounding_makes_no_band_repeat_with_the_other(digits):
    random = np.random.default_rng(5)
    noise = random.standard_normal((2000, 2)) * digits
    rounded = np.round(50 + noise)
    assert not flags.asked_again(rounded).any()
    again = flags.asked_again(np.repeat(50 + noise, 2, axis=0))
    assert 1990 < again.sum() <= 2000 and not again[::2].any()


def test_a_dark_within_the_series_lies_not_between_its_neighbours(sound):
    counts = sound.counts.values.copy()
    counts[5] = sound.background_counts.values
    words = said(sound.assign(counts=(sound.counts.dims, counts)))
    assert "the first at 11 s (-" in words["lone_spectrum"] and "plasma_off_time" not in words


def test_planck_fits_to_a_surface_that_is_not_grey_have_no_value(sound):
    fits = result_of(1600.0, np.where(np.arange(10) < 6, 1600.0, 1680.0), (20.0, 24.0))
    for end in ("", "_uncertainty"):
        fits[f"spectrometer_temperature{end}"] = fits[f"scaled_temperature{end}"]
    fits = fits.drop_vars([name for name in fits.variables if name.startswith("corrected")])
    light = {name: (("spectrum_time", "wavelength"), np.ones((10, 2))) for name in LIGHT}
    light["reference_radiance"] = "wavelength", np.ones(2)
    fits = fits.assign(light).assign_coords(wavelength=[8e-7, 9e-7])  # two pixels tell no level
    whole = np.full(10, 1600.0)
    estimate = xr.Dataset(
        {
            "spectral_temperature": ("spectrum_time", whole),
            "spectral_temperature_uncertainty": ("spectrum_time", 0 * whole + 32.0),
            "spectral_status": ("spectrum_time", np.where(np.arange(10) == 9, 4, 0).astype("int8")),
        },
        {"spectrum_time": fits.spectrum_time},
    )
    # hypot(24, 32) = 40: two of them are 80 K, which is not beyond.
    assert "spectra_not_grey" not in said(sound, result=fits, estimate=estimate)
    fits["scaled_temperature"] = fits.scaled_temperature + 0.1
    words = said(sound, result=fits, estimate=estimate)["spectra_not_grey"]
    assert "in 3 spectra the fits" in words and "at 7 s by +80 K +- 40 K" in words
    first, second = agreed([fits, estimate], sound)
    assert first.spectrum_status.values.tolist() == [0] * 6 + [9] * 3 + [0]
    for name in ("scaled_temperature", "spectrometer_temperature"):
        np.testing.assert_array_equal(np.isnan(first[name]), first.spectrum_status == 9)
    assert second.identical(estimate)


def test_the_contradiction_of_the_instruments_is_said_first(sound):
    one = result_of(np.where(np.arange(10) == 4, 1700.0, 1600.0), 1600.0)
    both = with_signals(sound, lambda t, p: p * 1e3)
    words = said(both, result=one)
    assert next(iter(words)) == "instruments_disagree"
    assert (
        "in 1 of 10 spectra they differ by more than three uncertainties, at 5 s by +100 K +- 20 K"
        in words["instruments_disagree"]
    )


def test_a_contradiction_is_said_before_a_doubt_and_each_has_a_file_and_a_remedy(sound):
    case = with_signals(sound, lambda t, p: p[::-1] * 1e3)
    found = of_test(PLACE, Reading(case, {"spectrometer": files()}))
    assert [(one.entry["rule"], one.entry["severity"]) for one in found] == [
        ("swapped_bands", "contradiction"),
        ("unit_of_signals", "doubt"),
    ]
    assert all(one.words.startswith("my_test: ") and one.remedy in one.words for one in found)


def test_the_estimate_that_fits_nothing_says_so(sound):
    both = [result_of(1600.0, 1600.0), xr.Dataset({"surface_temperature": ("time", [1600.0])})]
    assert of_test(PLACE, Reading(sound, {}), both) == []
    both[1].attrs["contradictions"] = "the data pull a gain"
    (found,) = of_test(PLACE, Reading(sound, {}), both)
    assert found.saw == "the joint estimate finds no temperature that fits all: the data pull a gain"


WINDOWS = {
    "surface_in_window": (
        lambda _: {"reference_window": [0.0, 12.0]},
        lambda t, p: p,
        "try --reference-window 0 ",
    ),
    "gas_drifts": (
        lambda t: {},
        lambda t, p: p * np.where((t > 0) & (t <= 5), 1 - 0.2 * (np.clip(t, 0, 5) / 5) ** 3, 1),
        "the gas drifts in it beyond its noise",
    ),
    "dark_in_window": (
        lambda t: {},
        lambda t, p: p * np.where((t > 0.5) & (t < 2), 0.0, 1),
        "a shutter or a probe hides the plasma then, or it does not burn; try --reference-window 2 5 [",
    ),
}


@pytest.mark.parametrize("name", WINDOWS)
def test_a_window_that_is_not_steady_gas_is_said(sound, name):
    stated, change, words = WINDOWS[name]
    found = said(attributes(with_signals(sound, change), **stated(sound)))
    assert words in found[name]


def gas(path=0.1, factor=1.0, pressure=5000.0):
    """A sight line of an ideal gas at 6000 K."""
    distance = np.linspace(0, path, 20)
    density = np.full((1, 20), factor * pressure / (BOLTZMANN * 6000.0))
    return xr.Dataset(
        {
            "temperature": ("path_distance", np.full(20, 6000.0)),
            "pressure": ("path_distance", np.full(20, pressure)),
            "number_density": (("species", "path_distance"), density),
        },
        {"path_distance": distance, "species": ["N"]},
    )


def test_a_sight_line_has_the_length_pressure_and_density_of_a_wind_tunnel():
    assert said(sightline=gas(), rules=OF_SIGHTLINE) == {}
    for path in (0.009, 10.1, 3e-4, 300.0):
        assert "m long; check `length_unit`" in said(sightline=gas(path), rules=OF_SIGHTLINE)["path_length"]
    for path in (0.011, 9.9):
        assert said(sightline=gas(path), rules=OF_SIGHTLINE) == {}
    for pressure in (101.0, 1.99e5):
        assert said(sightline=gas(pressure=pressure), rules=OF_SIGHTLINE) == {}
    for pressure in (50.0, 5e5, 5e6):  # 50 mbar said to be Pa; Pa said to be mbar, kPa
        assert set(said(sightline=gas(pressure=pressure), rules=OF_SIGHTLINE)) == {"gas_pressure"}
    for factor in (1e-6, 0.66, 1.51, 1e6, 0.0):
        assert set(said(sightline=gas(factor=factor), rules=OF_SIGHTLINE)) == {"ideal_gas"}
    for factor in (0.67, 1.49):
        assert said(sightline=gas(factor=factor), rules=OF_SIGHTLINE) == {}
    assert "n k T = 0.005 Pa at 0" in said(sightline=gas(factor=1e-6), rules=OF_SIGHTLINE)["ideal_gas"]


def test_a_step_is_found_and_a_bend_is_not():
    height, deviations = series.steps(np.r_[np.zeros(40), np.ones(40)])
    assert np.flatnonzero(height).tolist() == [39]
    assert height[39] == 1.0 and deviations[39] > 1e3
    bend, _ = series.steps(np.r_[np.arange(40.0), np.full(40, 40.0)])
    assert not bend.any()
    ramp, _ = series.steps(np.arange(80.0) ** 2)
    assert not ramp.any()


def test_the_longest_run_and_the_means_over_blocks():
    assert series.longest_run([0, 1, 1, 0, 1, 1, 1, 0]) == (4, 3)
    assert series.longest_run([0, 0]) == (0, 0)
    time, values = series.blocks(np.arange(10.0), np.arange(20.0).reshape(2, 10), 0, 9, 2.0)
    np.testing.assert_allclose(time, [0.5, 2.5, 4.5, 6.5, 8.5])
    np.testing.assert_allclose(values[1], [10.5, 12.5, 14.5, 16.5, 18.5])


def test_the_page_holds_the_table_of_the_rules():
    page = (Path(__file__).resolve().parents[2] / "docs" / "your-own-data.md").read_text(encoding="utf-8")
    for rules in (OF_TEST, OF_CALIBRATION, OF_SIGHTLINE):
        assert table(rules) in page


def test_every_rule_is_named_once_and_says_what_to_do():
    names = [rule.name for rule in (*OF_TEST, *OF_CALIBRATION, *OF_SIGHTLINE)]
    assert sorted(names) == sorted(row["name"] for row in rows("quality/rules.csv"))
    assert len(set(names)) == len(names)
    assert all(rule.remedy and rule.reason and rule.looks_at for rule in ALL.values())


def test_a_spectrum_taken_earlier_than_its_place_says_is_found_too(sound):
    early = [START + timedelta(seconds=2 * i - 3 * (i > 20)) for i in range(30)]
    words = said(sound, files(dates=early))["dates_against_order"]
    assert (
        "by its header spectrum_021.txt was taken 39 s after spectrum_000.txt, by `from: order` 42 s" in words
    )


@pytest.mark.parametrize(
    ("slope", "noise", "exchanged"),
    [(0.08, 0, False), (-0.015, 0, False), (-0.025, 0, True), (0.08, 0.6, False), (-0.08, 0.05, True)],
)
def test_bands_are_exchanged_from_a_slope_of_their_ratio_on(sound, slope, noise, exchanged):
    """Signals that are powers of one level: the logarithm of their ratio has the slope over it.

    Noise of the narrow band makes the ratio fall where that is bright: a surface that is too cold to read had
    been called exchanged bands."""
    time = sound.time.values
    level = np.where(time < 6, 1e-6, np.exp(np.clip(0.2 * (time - 6), 0.0, 4.0)))
    powers = level ** np.array([[1 + slope / 2], [1 - slope / 2]])
    pair = 1e-6 * np.where(time < 6, 1e-6, powers)
    pair[1] *= np.exp(noise * np.random.default_rng(1).standard_normal(time.size))
    test = with_signals(sound, lambda t, p: pair)
    found = ALL["swapped_bands"](Case(PLACE, test))
    assert (found is not None) == exchanged


def test_a_long_log_is_judged_in_the_memory_of_a_short_one():
    """`level_against_ratio` over 200 000 good samples, whose black bodies would take 0.6 GB."""
    count, wavelength = 200_000, np.linspace(700e-9, 1200e-9, 400)
    boxes = [(wavelength > low) & (wavelength < 1100e-9) for low in (750e-9, 950e-9)]
    response = xr.Dataset(
        {
            f"responsivity_{band}": ("wavelength", box.astype(float))
            for band, box in zip(("wide", "narrow"), boxes, strict=True)
        },
        {"wavelength": wavelength},
    )
    kelvin = np.linspace(1300.0, 1700.0, count)
    some = np.linspace(1300.0, 1700.0, 50)
    curves = blackbody_signals(some, response)
    level = np.stack([np.exp(np.interp(kelvin, some, np.log(curve))) for curve in curves])
    result = xr.Dataset(
        {
            "corrected_status": ("time", np.zeros(count, dtype="int8")),
            "surface_share": (("band", "time"), np.ones((2, count))),
            "corrected_temperature": ("time", kelvin),
            "corrected_temperature_uncertainty": ("time", np.full(count, 15.0)),
            "corrected_signal": (("band", "time"), 0.8 * level),
        }
    )
    stated = {"emittance": 0.8, "emittance_uncertainty": 0.05, "window_transmittance_pyrometer": 0.9}
    calibration = xr.Dataset({"absolute_sensitivity": ("band", np.ones(2))})
    sound = Case(PLACE, xr.Dataset(attrs=stated), {}, calibration, response, result=result)

    def said_of(case):
        return {finding.rule.name: finding.words for finding in look(case, [ALL["level_against_ratio"]])}

    tracemalloc.start()
    assert "level_against_ratio" not in said_of(sound)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # 10 000 black bodies at 400 wavelengths take 32 MB, an expression of them four times that at most, and
    # columns of the log 10 MB.
    assert peak < 150e6
    far = Case(PLACE, xr.Dataset(attrs=stated | {"emittance": 0.3}), {}, calibration, response, result=result)
    assert "0.8" in said_of(far)["level_against_ratio"]


def test_times_that_differ_in_their_last_bit_are_one_clock():
    """Some estimators count from the injection and back: where it lies before zero, that loses a bit."""
    time = np.array([0.0, 0.2, 0.4, 30.2])
    back = (time + 0.4201) - 0.4201
    parts = [xr.Dataset({name: ("time", time)}, {"time": own}) for name, own in (("a", time), ("b", back))]
    assert (back != time).any()
    np.testing.assert_array_equal(merged(parts).time, time)
    with pytest.raises(ValueError, match="time"):
        merged([parts[0], parts[1].assign_coords(time=time + 1e-3)])


@pytest.mark.parametrize(("bend", "said"), [(0.0, False), (0.12, True)])
def test_the_shape_of_spectra_is_judged_where_the_surface_shines(bend, said):
    """From 400 nm on: there 1600 K give a millionth of their light at 1000 nm, and the dark all there is."""
    wavelength, random = np.linspace(400e-9, 1000e-9, 600), np.random.default_rng(3)
    fitted = np.tile(blackbody_radiance(wavelength, 1600.0), (20, 1))
    noise = np.full(fitted.shape, 2e-3 * fitted.max())
    seen = fitted * (1 + bend * np.sin((wavelength - 700e-9) / 60e-9)) + noise * random.standard_normal(
        noise.shape
    )
    across = ("spectrum_time", "wavelength")
    result = xr.Dataset(
        {
            "spectrum_status": ("spectrum_time", np.zeros(20, dtype="int8")),
            "corrected_radiance": (across, seen),
            "radiance_noise": (across, noise),
            "normalised_radiance": (across, seen / fitted.max()),
            "normalised_fit": (across, fitted / fitted.max()),
        }
    )
    assert bool(ALL["shape_of_spectra"](Case(PLACE, result=result))) is said
    for name in ("corrected_radiance", "normalised_radiance"):  # most of a few spectra is saturated
        result[name][:3, 550:] = np.nan
    assert bool(ALL["shape_of_spectra"](Case(PLACE, result=result))) is said


def test_a_copied_file_is_no_missing_frame_and_times_in_names_are_no_counters(sound):
    copied = [*NAMES[:10], "spectrum_009b.txt", *NAMES[10:29]]
    assert "missing_frame" not in said(sound, files(names=copied))
    timed = [f"t={0.75 * place:g}s.txt" for place in range(30)]
    found = said(sound, files(names=timed, counted=False))
    assert not {"missing_frame", "mixed_series"} & found.keys()
