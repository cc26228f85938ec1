"""What bins swallow of a few bands: jumps from one sample to the next, waves of seconds."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.select import jumps, left_in_bands
from plasmapyro.diagnosis.select.jumps import largest_jump
from plasmapyro.diagnosis.select.leftover import STEP_STANDS
from plasmapyro.diagnosis.select.periodic import chance_of_peak
from plasmapyro.diagnosis.select.structures import seen_by

PERIOD, OFF = 0.1, 250.0  # [s]
SIGMA = 1e-3


def walk(random, size, memory=7):
    """Gains that remember some samples, linear between points three and a half samples apart."""
    points = random.standard_normal(int(size / 3.5) + 2)
    for i in range(1, points.size):
        points[i] = np.exp(-3.5 / memory) * points[i - 1] + np.sqrt(-np.expm1(-7 / memory)) * points[i]
    return np.interp(np.arange(size) / 3.5, np.arange(points.size), points)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("wander", [0.0, 5.0])
def test_a_jump_from_sample_to_sample_is_told_and_where(seed, wander):
    random = np.random.default_rng(seed)
    error = np.full(3000, SIGMA)
    gain = SIGMA * (random.standard_normal(3000) + wander * walk(random, 3000))
    assert largest_jump(gain, error, PERIOD)[0] < STEP_STANDS
    gain += (6 + 8 * wander) * SIGMA * (np.arange(3000) >= 1200)
    size, place = largest_jump(gain, error, PERIOD)
    assert size > STEP_STANDS and abs(place - 1200) <= 1


def test_neither_a_spike_nor_a_fast_ramp_is_a_jump():
    gain, error, time = SIGMA * np.random.default_rng(3).standard_normal(3000), np.full(3000, SIGMA), 1200
    spiky, ramp = gain.copy(), gain + 20 * SIGMA * np.clip((np.arange(3000) - time) / 6, 0, 1)
    spiky[time] += 100 * SIGMA
    assert largest_jump(spiky, error, PERIOD)[0] < STEP_STANDS
    assert largest_jump(ramp, error, PERIOD)[0] < STEP_STANDS


def test_usual_jumps_are_those_about(monkeypatch):
    """A gas that flickers for a while, and kinks of a gain that swings, are held against their like."""
    random, error = np.random.default_rng(4), np.full(3000, SIGMA)
    swinging = SIGMA * (0.1 * random.standard_normal(3000) + 10 * walk(random, 3000))
    for a_while in (np.ones(3000), np.where(np.abs(np.arange(3000) - 800) < 100, 1.0, 0.02)):
        assert largest_jump(swinging * a_while, error / 10, PERIOD)[0] < STEP_STANDS
    monkeypatch.setattr(jumps, "_usual", lambda *_: 1.0)
    assert largest_jump(swinging, error / 10, PERIOD)[0] > STEP_STANDS


@pytest.mark.parametrize("steep", [0.0, 0.5])
def test_noise_repeats_as_often_as_is_said(steep):
    """White, and with a spectrum of 1/f."""
    random, chances = np.random.default_rng(5), []
    frequency = np.maximum(np.fft.rfftfreq(1600), 1 / 1600) ** -steep
    for _ in range(400):
        noise = np.fft.irfft(np.fft.rfft(random.standard_normal(1600)) * frequency)[:400]
        chances.append(chance_of_peak(noise, 1.0, 50.0)[0])
    assert np.mean(np.array(chances) < 0.1) == pytest.approx(0.08, abs=0.05)
    assert np.mean(np.array(chances) < 0.01) < 0.03


def test_a_wave_far_below_the_noise_is_found_with_its_period():
    noise = np.random.default_rng(6).standard_normal(4000)
    wave = 0.3 * np.sin(2 * np.pi * np.arange(4000) / 34.0)
    chance, period = chance_of_peak(noise + wave, PERIOD, 24.0)
    assert chance < 1e-6 and period == pytest.approx(3.4, rel=0.02)
    hit = 300.0 * (np.random.default_rng(7).random(4000) < 0.01)
    assert chance_of_peak(noise + wave + hit, PERIOD, 24.0)[0] < 1e-3
    assert chance_of_peak(noise + wave, PERIOD, 3.0)[0] > 1e-3  # of periods that are asked for


@pytest.fixture
def left(monkeypatch):
    """`left_in_bands` of residuals (t, 2) over the light of two bands, known to `SIGMA`."""

    def of(relative, channels=2, plasma=True, share=(0.0, 0.0)):
        time = PERIOD * np.arange(len(relative)) - 10.0
        value = np.array([3.0, 1.0]) * np.ones(relative.shape)
        found = relative * value, value, share * value * (time < OFF)[:, None]
        monkeypatch.setattr(left_in_bands, "raw_residuals", lambda *_: [found])
        instrument = SimpleNamespace(
            channels=channels,
            raw_moment=time[:, None],
            raw_bin=np.arange(len(time)) // 80,
            number=np.full((len(time) // 80 + 1, 2), 80.0),
        )
        weight = np.full((len(time) // 80 + 1, 2), 80.0) / (SIGMA * np.array([3.0, 1.0])) ** 2
        model = SimpleNamespace(instruments=[instrument], off=OFF, plasma=plasma)
        return left_in_bands.left_in_bands(model, SimpleNamespace(weighers=[SimpleNamespace(weight=weight)]))

    return of


def noise_of_bands(seed):
    return SIGMA * np.random.default_rng(seed).standard_normal((3000, 2))


@pytest.mark.parametrize("seed", range(3))
def test_noise_leaves_nothing_in_bands(left, seed):
    assert left(noise_of_bands(seed)) is None


def test_a_step_and_a_wave_of_bands_have_their_kind(left):
    sample = np.arange(3000)[:, None]
    step = 6 * SIGMA * (sample > 1300) * np.exp(-np.maximum(sample - 1300, 0) / 30)  # a fit follows it then
    wave = 0.4 * SIGMA * np.sin(sample / 5.4) * [1.0, 0.0]
    assert left(noise_of_bands(1) + step) == left_in_bands.STEP
    assert left(noise_of_bands(1) + np.roll(step, 1400, axis=0)) == left_in_bands.STEP  # without the plasma
    assert left(noise_of_bands(1) + wave) == left_in_bands.WAVE
    assert left(noise_of_bands(1) + step, channels=25) is None  # frames of many bands are asked elsewhere
    assert left(noise_of_bands(1) + step, plasma=False) is None


def test_a_torch_that_ripples_is_no_wave_of_bands_but_the_mains_is_one(left):
    """4 % of a gas that is 6 and 2 % of the light, folded down; a zero swings after the plasma too."""
    wave, share = np.sin(np.arange(3000)[:, None] / 5.4), np.array([0.06, 0.02])
    burning = np.arange(3000)[:, None] < 2600
    assert left(noise_of_bands(2) + 0.04 * share * wave * burning, share=share) is None
    assert left(noise_of_bands(2) + 0.04 * share * wave, share=share) == left_in_bands.WAVE
    assert left(noise_of_bands(2) + 0.04 * share[::-1] * wave * burning, share=share) == left_in_bands.WAVE


def test_the_end_of_the_plasma_is_no_step_of_bands(left):
    end = 0.02 * (np.arange(3000)[:, None] >= 2600)  # at 250 s
    assert left(noise_of_bands(1) + end) is None


def test_what_bands_leave_is_of_the_pyrometer_in_time():
    for one in (left_in_bands.STEP, left_in_bands.WAVE):
        assert seen_by(one) == {"instrument": "pyrometer", "axis": "time"}
    few, spectra = (SimpleNamespace(channels=n, source=s) for n, s in ((2, "radiometer"), (300, "spectra")))
    assert all("radiometer" in name for name in left_in_bands.names([spectra, few]).values())


def test_a_path_that_knots_round_off_is_no_jump():
    """A surface that is heated more from one moment on: straight between knots 1 s apart, the path misses
    15 standard deviations of its light there and less and less to either side. One in twenty passes."""
    away, found = np.abs(np.arange(800) - 300.3), 0
    for seed in range(40):
        gain, error = SIGMA * np.random.default_rng(seed).standard_normal(800), np.full(800, SIGMA)
        dip = 15 * SIGMA * np.maximum(1 - away / 6, 0)
        found += largest_jump(gain - dip, error, PERIOD)[0] > STEP_STANDS
    assert found <= 5
