"""Noise that is found where a fit lags behind the temperature, or where most frames are faint."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.fit import noise, outliers
from plasmapyro.diagnosis.fit.coloured import coloured


@pytest.fixture
def random():
    return np.random.default_rng(5)


def test_a_temperature_that_lags_behind_is_no_noise_of_a_band(random):
    """A slow pyrometer on a surface that cools: what both bands share has a memory, their noise has none."""
    count, sigma = 400, 0.002
    lag = 0.02 * np.sin(np.linspace(0, 40, count)) + 0.06 * np.linspace(0, 1, count) ** 8
    relative = np.stack([lag, 1.1 * lag], axis=1) + sigma * random.standard_normal((count, 2))
    level = np.exp(-np.linspace(0, 4, count))[:, None] * [1.0, 0.5]
    law, memory, *_ = noise._of_bands(
        relative * level, level, 0 * level, np.ones(count, dtype=bool), np.zeros(count, dtype=int), 1.0
    )
    assert memory == 0.0
    # 400 differences that share samples: 9 % of a variance; the lag is not the same in both bands.
    assert np.sqrt(law[2]) == pytest.approx(sigma, rel=0.2)


def test_amplifiers_of_unlike_noise_are_told_apart(random):
    """Before a flickering gas the wide band has four times the noise of the narrow one, before a hot
    surface both a thousandth."""
    count, noise_of, sigma = 1200, np.array([4e-3, 1e-3]), 1e-3
    cold = np.arange(count) < 400
    level = np.where(cold, 1.0, np.exp(np.linspace(0, 4, count)))[:, None] * [1.0, 0.3]
    gas = np.where(cold[:, None], level, 0.0)
    own = random.standard_normal((count, 2)) * np.hypot(noise_of, sigma * level)
    flickering = own + gas * 0.004 * random.standard_normal((count, 1))
    law, _, light, *_ = noise._of_bands(
        flickering, level, gas, np.ones(count, dtype=bool), cold.astype(int), 1.0
    )
    # 400 differences that share samples, of which the flicker is as large a part: 15 % of a deviation.
    assert np.sqrt(law[0]) == pytest.approx(noise_of, rel=0.25)
    assert np.sqrt(law[2]) == pytest.approx(sigma, rel=0.2)
    assert np.sqrt(light.total) == pytest.approx(0.004, rel=0.2)


def test_a_light_that_falls_by_decades_shows_a_constant_noise(random):
    """A converter's noise before a surface that cools out of sight within a tenth of a long record."""
    constant, sigma, count = np.array([2e-4, 1e-4]), 1e-3, 6000
    fall = np.concatenate([np.zeros(count - 600), np.linspace(0, 7, 600)])
    level = np.exp(-fall)[:, None] * [1.0, 0.5]
    own = random.standard_normal((count, 2)) * np.hypot(constant, sigma * level)
    used, phase = np.ones(count, dtype=bool), np.zeros(count, dtype=int)
    law, *_ = noise._of_bands(own, level, 0 * level, used, phase, 0.1)
    noise_of_faint = np.hypot(*(np.sqrt(law[0]) / [1.0, 0.5]))  # of the ratio, which is all that it costs
    assert noise_of_faint == pytest.approx(np.hypot(*(constant / [1.0, 0.5])), rel=0.15)
    assert np.sqrt(law[2]) == pytest.approx(sigma, rel=0.1)


def test_samples_with_some_light_of_a_gas_that_flickers_tell_the_noise_of_bright_ones(random):
    """The gas is 2 to 6 % of all bright light and flickers by 1.5 %; without gas it falls by ten decades."""
    constant, sigma, count = np.array([2e-5, 3e-5]), 1e-3, 800
    place = np.arange(count)
    cold, after = place < 60, place >= 740
    share = np.where(cold, 1.0, np.where(after, 0.0, 0.06))[:, None] * np.where(
        cold[:, None], 1.0, [1.0, 0.3]
    )
    level = np.where(cold, 0.05, np.exp(np.where(after, -(place - 740) * 0.4, 0.0)))[:, None] * [1.0, 0.7]
    own = random.standard_normal((count, 2)) * np.hypot(constant, sigma * level)
    seen = own + share * level * 0.015 * random.standard_normal((count, 1))
    phase = np.where(cold, 0, np.where(after, 2, 1))
    law, memory, *_ = noise._of_bands(seen, level, share * level, np.ones(count, dtype=bool), phase, 0.5)
    assert memory == 0.0
    assert np.sqrt(law[2]) == pytest.approx(sigma, rel=0.15)  # 680 samples; it was nought
    assert np.sqrt(law[0]) == pytest.approx(constant, rel=0.4)  # 30 samples each, of which half are shared


def test_a_noisy_band_hides_no_memory_of_the_gas(random):
    """A gas that flickers with 0.3 s, sampled each 0.1 s; the narrow band has twice its noise."""
    count, size, period, time = 220, 2.5e-3, 0.1, 0.3
    bins = []
    for _ in range(30):
        steps, value = random.standard_normal(count), np.zeros(count)
        for place in range(1, count):
            keep = np.exp(-period / time)
            value[place] = keep * value[place - 1] + size * np.sqrt(1 - keep**2) * steps[place]
        own = random.standard_normal((count, 2)) * [1e-3, 6e-3]
        one = np.ones((count, 2))
        light = noise._of_bands(
            value[:, None] + own, one, one, np.ones(count, dtype=bool), np.zeros(count, dtype=int), period
        )[2]
        bins.append(light.of_mean(20, period))
    lag = np.arange(1, 20)
    true = size**2 / 20 * (1 + 2 * np.sum((1 - lag / 20) * np.exp(-lag * period / time)))
    # 20 s hold 30 memories: a factor of two. By what both bands share the typical bin has a tenth of it.
    assert 0.5 < np.median(bins) / true < 2.5


def test_a_gas_that_flickers_hides_no_gain_of_the_time_after_it(random):
    """Both bands wander together by 0.1 % within seconds; a gas that has flickered more than it does now
    explains too much of it."""
    period, phase = 0.02, np.repeat([0, 1, 2], [1000, 4500, 1500])
    time = period * np.arange(phase.size)
    together = 1e-3 * np.interp(time, np.arange(0, 141, 0.7), random.standard_normal(202))
    share = np.choose(phase, [1.0, np.linspace(0.29, 0.2, time.size), 0.0])[:, None] * np.ones(2)
    flicker = 0.02 * np.interp(time, np.arange(0, 141, 1.0), random.standard_normal(141))
    relative = together + share[:, 0] * flicker * np.choose(phase, [2.0, 1.0, 0.0])
    relative = relative[:, None] + 3e-4 * random.standard_normal(share.shape)
    level, used = np.ones(share.shape) * [1.0, 0.5], np.ones(time.size, dtype=bool)
    gain = noise._of_bands(relative * level, level, share * level, used, phase, period)[3]
    # 30 s hold some forty memories.
    assert np.sqrt(gain.between(1.0)) == pytest.approx(0.8e-3, rel=0.35)


def test_faint_frames_do_not_hide_the_gain_of_bright_ones(random):
    """Errors stated 15 % too large, as they are while the law of the noise holds the gain: faint frames
    would take all of it away."""
    count, sigma, time, period = 500, 0.003, 0.7, 0.4
    keep = np.exp(-period / time)
    gain, steps = np.zeros(count), random.standard_normal(count)
    for place in range(1, count):
        gain[place] = keep * gain[place - 1] + sigma * np.sqrt(1 - keep**2) * steps[place]
    error = np.where(np.arange(count) < 350, 2e-4, 0.009)
    level = gain + error * random.standard_normal(count)
    found = coloured(
        level, level, (1.15 * error) ** 2, np.ones(count, dtype=bool), np.zeros(count, dtype=int), period, 6.0
    )
    # 350 frames that share samples: some 8 % of a standard deviation; a mean of all frames finds none.
    assert np.sqrt(found.between(period)) == pytest.approx(sigma * np.sqrt(1 - keep), rel=0.2)


def test_what_is_smooth_from_sample_to_sample_is_no_longer_memory_than_it_is(random):
    """A sight line that shakes with 0.7 s, at 60 Hz: its third differences from sample to sample are a
    thousandth of what exponential memories have, and so sure that only the longest of these came near."""
    count, size, period, time = 9000, 2.4e-3, 0.017, 0.7
    knots = np.arange(0.0, count * period + 1, time / 8)
    keep = np.exp(-1 / 8)
    value = np.zeros(knots.size)
    for at in range(1, knots.size):
        value[at] = keep * value[at - 1] + np.sqrt(1 - keep**2) * random.standard_normal()
    shared = size * np.interp(np.arange(count) * period, knots, value)
    bands = shared + 2e-4 * random.standard_normal((2, count))
    whole = np.ones(count, dtype=bool)
    found = coloured(*bands, np.zeros(count), whole, np.zeros(count, dtype=int), period, 6.0)
    # Two hundred memories long: 10 %, and what smooth noise loses below its knots.
    assert np.sqrt(found.total) == pytest.approx(size, rel=0.25)


def test_rounded_samples_that_stand_still_do_not_say_that_there_is_no_noise(random):
    """Noise of ten steps on a hot surface, of a tenth of one on the gas before: that shows nothing,
    and would outweigh all that does."""
    count, sigma, step = 3000, 0.003, 3e-4
    cold = np.arange(count) < 500
    level = np.where(cold, 30.2 * step, 1.0)[:, None] * [1.0, 0.8]
    written = step * np.round(level * (1 + sigma * random.standard_normal((count, 2))) / step)
    whole, rounded = np.ones(count, dtype=bool), np.full((count, 2), step**2 / 12)
    gas = np.where(cold[:, None], level, 0.0)
    law, *_ = noise._of_bands(written - level, level, gas, whole, cold.astype(int), 1.0, rounded)
    # 2500 differences that share samples.
    assert np.sqrt(law[2]) == pytest.approx(sigma, rel=0.15)


def test_series_of_other_exposures_have_a_noise_of_their_own(random):
    """Ten frames of 1 s, counted as if they were of 0.1 s, and ten of 0.1 s: read noise of 12 counts is a
    tenth of it in the first. A pair of neighbours knows the noise of 100 channels to 7 %."""
    channels, series = 100, np.repeat([0, 1], 10)
    level = np.geomspace(20, 3000, channels) * np.where(series, 1.0, 0.3)[:, None]
    share = np.where(series, 1.0, 0.1)[:, None]
    variance = (12 * share) ** 2 + 0.05 * share * level
    instrument = SimpleNamespace(
        kind="spectrometer",
        channels=channels,
        raw_bin=np.arange(20),
        raw_moment=np.arange(20.0)[:, None] + [0.0, 0.1],
        pixels=np.ones(channels),
        factor=np.ones(channels),
    )
    residual = np.sqrt(variance) * random.standard_normal(level.shape)
    law, _ = noise.estimate(instrument, residual, level, 0 * level, 3 * series, None, series)
    found = law.variance(series, level, 1.0, 1.0)
    for one in (0, 1):
        ratio = (found / variance)[series == one]
        assert np.median(ratio) == pytest.approx(1.0, abs=0.2)
        assert np.all((ratio > 0.5) & (ratio < 2.0))


@pytest.mark.parametrize(("flicker", "white"), [(0.0, 0.0), (5e-4, 0.0), (0.0, 5e-4)])
def test_a_course_over_wavelength_flickers_as_it_does(random, flicker, white):
    """Frames of 0.3 % noise in 90 channels whose tilt from 0.7 to 1 um has 1/f noise, or none of its own."""
    frames, channels = 200, 90
    instrument = SimpleNamespace(
        kind="spectrometer",
        channels=channels,
        wavelength=np.linspace(7e-7, 1e-6, channels),
        raw_moment=np.arange(float(frames))[:, None] + [0.0, 0.1],
    )
    frequency = np.fft.rfftfreq(frames)
    frequency[0] = frequency[1]
    pink = np.fft.irfft(np.fft.rfft(random.standard_normal(frames)) / np.sqrt(frequency), frames)
    shapes = noise.course_shapes(instrument.wavelength)[-2]  # the longest beside the mean
    amplitude = flicker * pink / pink.std() + white * random.standard_normal(frames)
    value = np.full((frames, channels), 100.0)
    residual = value * (3e-3 * random.standard_normal(value.shape) + amplitude[:, None] * shapes)
    weight = np.full(value.shape, (3e-3 * 100.0) ** -2.0)
    used, phase = np.ones(frames, dtype=bool), np.zeros(frames, dtype=int)
    found = noise._course(residual, value, used, phase, instrument, weight)
    # The mean of two shapes of which one has it; of bins of four frames.
    wanted = amplitude.reshape(-1, 4).mean(axis=1).var() / 2
    size = float(np.sqrt(found.of_mean(4, 1.0)))
    assert 0.6 * np.sqrt(wanted) < size < 1.3 * np.hypot(np.sqrt(wanted), 2.5e-4)  # what noise may hide


def test_a_gas_that_an_offset_hides_has_a_first_noise_all_the_same(random):
    """An amplifier with its zero below: before the injection no signal is above it, so no gas is seen."""
    value = np.append(np.full(20, -0.002), np.linspace(0.1, 1.0, 30))[:, None] * np.ones(2)
    value = value + 1e-4 * random.standard_normal(value.shape)
    model = SimpleNamespace(instruments=[SimpleNamespace(value=value)])
    (found,) = noise.first_guess(model, [np.zeros_like(value)])
    assert np.isfinite(found.variance).all() and (found.variance > 0).all()


def test_seconds_of_memory_show_in_few_longest_lags(random):
    """Brightness that is drawn anew each second, straight between, seen 18 s long at 10 Hz by two halves of
    0.09 %: neighbours hardly differ, and five stretches of seconds scatter as widely as what they show."""
    count, size, period, found = 180, 1.3e-3, 0.1, []
    plain = np.zeros(count), np.ones(count, dtype=bool), np.zeros(count, dtype=int), period, 20.0
    for drawn in (size, 0.0):
        total = []
        for _ in range(40):
            seconds = np.interp(np.arange(count) * period, np.arange(20), random.standard_normal(20))
            two = drawn * seconds + 9e-4 * random.standard_normal((2, count))
            total.append(coloured(*two, *plain))
        found.append(total)
    shown, none = ([one.remembers for one in total] for total in found)
    # Of 200 each 97 % and none; by the scatter at each lag itself it was 69 %.
    assert np.mean(shown) > 0.85 and not np.any(none)
    assert np.median([one.total for one in found[0]]) > 0.5 * size**2


def test_a_slope_within_a_bin_makes_no_hits(random):
    """A temperature that runs faster than its model by 7 standard deviations within a bin; one true hit."""
    count = 19
    time, index = np.arange(count) / 10, np.zeros(count, dtype=int)
    left = random.standard_normal((count, 3)) + 9.0 * (time[:, None] - time.mean())
    left[4, 1] = np.nan  # a hit that was found before
    line = outliers.line_in_bins(left, time, index, 1)
    assert np.nanmax(np.abs(left - line)) < noise.CLIP < np.nanmax(np.abs(left - np.nanmean(left, axis=0)))
    assert line_of_three(time, left) == pytest.approx(line[:3, 0])


def line_of_three(time, left):
    """A line by another hand, at the first three samples of the first channel."""
    return np.polynomial.Polynomial.fit(time, left[:, 0], 1)(time[:3])


def test_each_of_many_bands_has_a_noise_of_its_own(random):
    """Halves of four bands told sums of two: one of them had none, and stood out of the faint gas for it."""
    count, noise_of, sigma = 1200, np.array([2e-3, 6e-3, 4e-3, 8e-3]), 1e-3
    cold = np.arange(count) < 400
    level = np.where(cold, 1.0, np.exp(np.linspace(0, 4, count)))[:, None] * np.ones(4)
    gas = np.where(cold[:, None], level, 0.0)
    own = random.standard_normal((count, 4)) * np.hypot(noise_of, sigma * level)
    flickering = own + gas * 0.004 * random.standard_normal((count, 1))
    used = np.ones(count, dtype=bool)
    law, *_ = noise._of_bands(flickering, level, gas, used, cold.astype(int), 1.0)
    assert np.sqrt(law[0]) == pytest.approx(noise_of, rel=0.3)


def test_bright_light_makes_no_noise_of_the_flicker_before_one_band(random):
    """A band of 0.3 % whose gas of 1/300 of the light flickers by 1 % within 0.4 s."""
    size, period, time, true = 0.01, 0.05, 0.4, []
    for _ in range(20):
        phase = np.repeat([0, 1], [180, 1600])
        steps, value = random.standard_normal(phase.size), np.zeros(phase.size)
        keep = np.exp(-period / time)
        for place in range(1, phase.size):
            value[place] = keep * value[place - 1] + size * np.sqrt(1 - keep**2) * steps[place]
        share = np.where(phase == 0, 1.0, 0.003)[:, None]
        level = np.where(phase == 0, 1.0, 300.0)[:, None]
        relative = value[:, None] * share + 0.003 * random.standard_normal(share.shape)
        # What a base model that bends less than the surface leaves looks like a constant of the bright light.
        relative += np.where(phase == 1, 4e-3 * random.standard_normal(phase.size), 0.0)[:, None]
        used = np.ones(phase.size, dtype=bool)
        law, _, light, *_ = noise._of_bands(relative * level, level, share * level, used, phase, period)
        true.append((np.sqrt(light.total), np.sqrt(law[0][0])))
    flicker, constant = np.median(true, axis=0)
    # 0.3 % and, from sample to sample, 0.34 % of the flicker.
    assert 0.6 < flicker / size < 1.6 and constant < 0.005


def pink(random, count):
    """Noise of variance 1 that is as strong in each octave of frequency."""
    frequency = np.fft.rfftfreq(count)
    size = np.append(0.0, frequency[1:] ** -0.5)
    made = np.fft.irfft(size * (random.standard_normal((2, size.size)).T @ [1, 1j]), count)
    return made / made.std()


@pytest.mark.parametrize("share", [0.0, 0.3])
def test_a_zero_that_flickers_makes_means_before_the_injection_less_certain(random, share):
    """Half a minute of gas that flickers by 2 %; of each amplifier 30 % of its variance are 1/f noise."""
    count, period, number, size = 1500, 0.02, 150, 0.01
    used, phase = np.ones(count, dtype=bool), np.zeros(count, dtype=int)
    gas, lasting, scatter = np.ones((count, 2)), [], []
    for _ in range(10):
        own = random.standard_normal((16 * count, 2))
        own += np.sqrt(share) * np.stack([pink(random, 16 * count) for _ in range(2)], axis=1)
        scatter.append(own.reshape(-1, number, 2).mean(axis=1).var())
        residual = size * own[:count] + 0.02 * random.standard_normal((count, 1))
        zero = noise._zero(residual, gas, gas, used, phase, period, 0.5 * period)
        lasting.append(float(zero.of_mean(number, period)))
    found, true = np.median(lasting) + 1 / number, np.mean(scatter)
    assert true / 1.5 < found < 3 * true + 5e-3
    instrument = SimpleNamespace(
        factor=None,
        channels=2,
        pixels=np.ones(2),
        raw_bin=np.zeros(number, dtype=int),
        raw_moment=period * np.arange(number)[:, None] * np.ones(2),
        number=np.full((1, 2), number),
        value=np.ones((1, 2)),
        rounded=lambda *_: 0.0,
    )
    law = noise.NoiseModel(np.full(2, size**2), 0.0, 0.0, 0.0, noise.Coloured(), 1.0, zero=zero)
    assert noise.on_bins(law, instrument, np.ones((1, 2)), np.zeros(1)).variance == pytest.approx(
        size**2 * (1 / number + lasting[-1]), rel=1e-6
    )


@pytest.mark.parametrize("size", [0.0, 3e-4, 1e-3])
def test_gains_of_bands_that_flicker_apart_make_means_of_their_ratio_less_certain(random, size):
    """A minute of a hot surface at 100 Hz, 0.2 % of noise from sample to sample, and each gain flickers."""
    count, period, number, rough = 6000, 0.01, 200, 2e-3
    used, phase = np.ones(count, dtype=bool), np.zeros(count, dtype=int)
    level, gas = np.ones((count, 2)) * [2.0, 1.0], np.zeros((count, 2))
    lasting, scatter = [], []
    for _ in range(6):
        apart = size * np.stack([pink(random, count) for _ in range(2)], axis=1)
        wander = 0.01 * pink(random, count)[:, None]  # of both: a temperature, or a gain
        relative = rough * random.standard_normal((count, 2)) + apart + wander
        law = noise._gains(relative * level, level, gas, used, phase, period)
        lasting.append(float(law.of_mean(number, period)))
        means = apart.reshape(-1, number, 2).mean(axis=1)
        scatter.append(np.var(means[2:] - 2 * means[1:-1] + means[:-2]) / 6)
    found, true = np.sqrt(np.median(lasting)), np.sqrt(np.mean(scatter))
    # 30 means tell little of what is below the rest of their noise, 1.4e-4.
    assert true / 2 < found < 2 * true + 1.4e-4


@pytest.mark.parametrize("bright", range(6))
def test_a_few_bright_samples_tell_a_finite_flicker_of_gains(random, bright):
    """One of them had ended in eigenvalues that did not converge: a slow pyrometer before a bright gas."""
    level = np.ones((20, 2))
    gas = np.where(np.arange(20) < bright, 0.0, 0.5)[:, None] * level
    noisy = 1e-3 * random.standard_normal((20, 2))
    used, phase = np.ones(20, dtype=bool), np.zeros(20, dtype=int)
    law = noise._gains(noisy, level, gas, used, phase, 0.7)
    assert np.isfinite(law.total) and law.total < 1e-5
    instrument = SimpleNamespace(kind="pyrometer", raw_moment=0.7 * np.arange(20.0)[:, None] * np.ones(2))
    rest = noise.NoiseModel(0.0, 0.0, 1e-6, 0.0, noise.Coloured(), 1.0, own=law)
    assert 0 < noise._late(noisy, level, gas, used, phase, instrument, 1e6 * level, rest) < 1e-2


@pytest.mark.parametrize("jitter", [0.0, 0.02, 0.05])
def test_frames_whose_times_jitter_are_as_uncertain_as_their_light_changes(random, jitter):
    """Frames of 0.5 s of a surface that heats by 8 % a second at first, with 0.05 % of noise."""
    time = np.arange(0.0, 120.0, 0.5)
    rise = 0.08 * np.exp(-time / 30.0)
    light = np.exp(np.cumsum(rise) * 0.5)[:, None] * np.linspace(1.0, 0.6, 30)
    late = jitter * random.standard_normal(time.size)
    noisy = light * (rise * late + 5e-4 * random.standard_normal(time.size))[:, None]
    instrument = SimpleNamespace(kind="spectrometer", raw_moment=time[:, None] * np.ones(2))
    law = noise.NoiseModel(0.0, 0.0, 0.0, 0.0, noise.Coloured(), 1.0, noise.Coloured(white=2.5e-7))
    weight = 1e6 / light**2
    used, phase = np.ones(time.size, dtype=bool), np.zeros(time.size, dtype=int)
    found = noise._late(noisy, light, 0 * light, used, phase, instrument, weight, law)
    assert found == pytest.approx(jitter, rel=0.5, abs=noise.JITTER["spectrometer"])
    one = SimpleNamespace(
        factor=None, channels=30, pixels=np.ones(30), raw_bin=np.arange(time.size),
        number=np.ones(light.shape), value=light, raw_moment=instrument.raw_moment,
        time=time, rounded=lambda *_: 0.0,
    )  # fmt: skip
    row = noise.on_bins(noise.replace(law, late=0.02), one, light, phase).late
    expected = 0.02 * rise[:, None] * light
    assert row[2:-2] == pytest.approx(expected[2:-2], rel=0.02)  # of differences over 1 s of a curve


def samples_with_memory(random, memory, count):
    """Samples (t, 2) of variance 1 whose neighbours correlate."""
    sample = random.standard_normal((count, 2))
    for before, after in zip(sample[:-1], sample[1:], strict=True):
        after *= np.sqrt(1 - memory**2)
        after += memory * before
    return sample


@pytest.mark.parametrize("memory", [0.0, 0.3, 0.6])
def test_a_trend_is_no_memory_of_noise(random, memory):
    """An offset of one band beside a surface that cools makes their ratio drift by a third of the noise from
    sample to sample."""
    count = 3000
    drift = np.linspace(0, 0.33 * count, count)[:, None] * [1.0, -1.0]
    sample = samples_with_memory(random, memory, count) + drift
    found = noise.memory_beside_trend(sample, np.ones(count, dtype=bool))
    assert found == pytest.approx(memory, abs=0.08)  # two and a half standard errors of 3000 pairs


def test_four_samples_tell_no_memory(random):
    assert np.isnan(noise.memory_beside_trend(random.standard_normal((4, 2)), np.ones(4, dtype=bool)))


def test_an_offset_beside_a_surface_that_cools_has_no_memory(random):
    """A slow pyrometer, some thirty samples after the end of the plasma: noise of 1.5 per mil."""
    count, sigma = 34, 1.5e-3
    level = np.exp(-np.linspace(0, 2.8, count))[:, None] * [1.0, 0.4]
    relative = sigma * random.standard_normal((count, 2)) - 3e-3 / level * [1.0, 0.0]
    law, memory, *_ = noise._of_bands(
        relative * level, level, 0 * level, np.ones(count, dtype=bool), np.zeros(count, dtype=int), 0.87
    )
    assert memory == 0.0
    assert np.sqrt(law[2]) < 2 * sigma
