"""What a fit leaves behind: patterns of any shape, and paths that no spline over time follows."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.fit.model import History
from plasmapyro.diagnosis.fit.noise import Noise
from plasmapyro.diagnosis.fit.weights import Weigher
from plasmapyro.diagnosis.select import leftover

SAMPLES, CHANNELS = 100, 150
FRAME_LIGHT = 2000.0  # standard deviations of one channel of one frame


@pytest.fixture
def left(monkeypatch):
    """`left_over` of residuals (n, C) of bins that are white already, of light of 1, and of residuals of
    frames, one a bin, of light of `FRAME_LIGHT` half of which is gas."""

    def of(z, channels=CHANNELS, frames=None):
        frames, half = (z if frames is None else frames), np.full(z.shape, FRAME_LIGHT / 2)
        half = half * (1 + np.arange(z.shape[1]) % 2)  # the gas shines in every other channel alone
        monkeypatch.setattr(
            leftover, "raw_residuals", lambda *_: [(frames, np.full(z.shape, FRAME_LIGHT), half)]
        )
        instrument = SimpleNamespace(
            channels=channels,
            value=z,
            time=np.arange(len(z)) - 10.0,
            raw_moment=np.arange(len(z))[:, None] - 10.0,
            raw_bin=np.arange(len(z)),
            number=np.ones(z.shape),
        )
        weigher = Weigher(Noise(np.ones(z.shape), np.zeros(len(z)), np.zeros(len(z))), np.zeros(z.shape))
        model, solution = (
            SimpleNamespace(instruments=[instrument], off=70.0, plasma=True),
            SimpleNamespace(residual=[z], prediction=[np.ones(z.shape)], weighers=[weigher]),
        )
        return leftover.left_over(model, solution)

    return of


@pytest.mark.parametrize("seed", range(5))
def test_noise_leaves_nothing(left, seed):
    assert left(np.random.default_rng(seed).standard_normal((SAMPLES, CHANNELS))) is None


def test_lines_that_shine_for_some_seconds_are_a_moment(left):
    z = np.random.default_rng(3).standard_normal((SAMPLES, CHANNELS))
    z[60:64, [40, 41, 90]] += 9.0  # four samples, three channels
    assert left(z) == leftover.MOMENT


@pytest.mark.parametrize("size", [(2, 2), (4, 1), (1, 4)])
def test_a_line_that_flashes_is_a_moment_though_no_pattern_leads(left, size):
    """Eight and a half standard deviations together: the largest singular value stays that of noise."""
    z = np.random.default_rng(3).standard_normal((SAMPLES, CHANNELS))
    _, _, plain, _ = leftover.leading(z)
    z[60 : 60 + size[0], 40 : 40 + size[1]] += 8.5 / np.sqrt(np.prod(size))
    assert leftover.leading(z)[2] < 1.02 * plain
    assert left(z) == leftover.MOMENT


def test_one_hit_is_no_flash(left):
    z = np.random.default_rng(3).standard_normal((SAMPLES, CHANNELS))
    z[60, 40] = 9.0
    assert left(z) is None


def test_a_pattern_that_comes_and_goes_is_one(left):
    random = np.random.default_rng(4)
    z = random.standard_normal((SAMPLES, CHANNELS))
    z += 8 * np.outer(np.sin(np.arange(SAMPLES) / 9), random.standard_normal(CHANNELS)) / np.sqrt(SAMPLES)
    assert left(z) == leftover.PATTERN


@pytest.mark.parametrize("shaken", [0.0, 0.02])
def test_frames_that_are_too_bright_stand_out_of_any_common_noise(shaken):
    """A tenth of the frames are 11 % brighter; alone, 2 % of noise that channels share stands out nowhere.

    The noise is stated as large as both together would make it."""
    random = np.random.default_rng(6)
    value, sigma = np.full((SAMPLES, CHANNELS), 100.0), 1.0
    noise = Noise(np.full(value.shape, sigma**2), np.zeros(SAMPLES), np.full(SAMPLES, 0.04**2))
    weigher = Weigher(noise, 0 * value, value)
    usual = value * shaken * random.standard_normal((SAMPLES, 1)) + sigma * random.standard_normal(
        value.shape
    )
    phase = (np.arange(SAMPLES) >= 10).astype(int)
    assert not leftover.standing_out(usual, value, weigher, phase).any()
    brighter = np.zeros(SAMPLES, dtype=bool)
    brighter[[3, 11, 20, 34, 41, 57, 58, 66, 83, 91]] = True
    found = leftover.standing_out(usual + 11.0 * (1 + shaken) * brighter[:, None], value, weigher, phase)
    assert not found[~brighter].any() and found.sum() >= (10 if not shaken else leftover.FEWEST)


def test_two_kinds_of_frames_stand_out_of_the_noise_that_they_were_taken_for():
    """A tenth of the frames are 2 % brighter, less than two deviations of the common noise that is stated."""
    random = np.random.default_rng(6)
    value = np.full((SAMPLES, CHANNELS), 400.0)
    weigher = Weigher(
        Noise(np.ones(value.shape), np.zeros(SAMPLES), np.full(SAMPLES, 0.012**2)), 0 * value, value
    )
    brighter = np.zeros(SAMPLES, dtype=bool)
    brighter[[13, 20, 34, 41, 57, 66, 73, 81, 88, 94]] = True
    phase = (np.arange(SAMPLES) >= 10).astype(int)
    left = random.standard_normal(value.shape) + value * (
        0.001 * random.standard_normal((SAMPLES, 1)) + 0.02 * brighter[:, None]
    )
    np.testing.assert_array_equal(leftover.standing_out(left, value, weigher, phase), brighter)


def test_a_gas_that_flickers_does_not_stand_out_of_a_surface_that_does_not():
    """Fifteen of a hundred frames show the gas alone, which flickers by as much as is known: 1 %."""
    random = np.random.default_rng(6)
    value, gas = np.full((SAMPLES, CHANNELS), 400.0), np.arange(SAMPLES) < 15
    flicker, phase = np.where(gas, 0.01, 1e-4) ** 2, np.zeros(SAMPLES, dtype=int)
    weigher = Weigher(Noise(np.ones(value.shape), flicker, np.zeros(SAMPLES)), value)
    for _ in range(20):
        whole = np.where(gas, 0.01, 2e-5) * random.standard_normal(SAMPLES)
        assert leftover.standing_out(value * whole[:, None], value, weigher, phase).sum() < leftover.FEWEST


def frames_with(seed, *, step=0.0, gas=0.0, wander=0.0):
    """Residuals of frames: noise, gains that walk, a flicker of the gas, and a step of all light half-way."""
    random = np.random.default_rng(seed)
    z = random.standard_normal((SAMPLES, CHANNELS))
    gain = wander * np.cumsum(random.standard_normal(SAMPLES)) + step * (np.arange(SAMPLES) > 45)
    shine = gas * random.standard_normal(SAMPLES)
    light = FRAME_LIGHT * np.ones(CHANNELS)
    return z + gain[:, None] * light + shine[:, None] * light / 2 * (1 + np.arange(CHANNELS) % 2)


def test_a_step_of_the_frames_is_seen_where_the_bins_do_not_show_it(left):
    """A step of 0.3 % beside gas that flickers by 1 % and gains that walk by 0.01 % from frame to frame."""
    flat = np.random.default_rng(1).standard_normal((SAMPLES, CHANNELS))
    assert left(flat, frames=frames_with(2, step=3e-3, gas=0.01, wander=1e-4)) == leftover.STEP
    assert left(flat, frames=frames_with(2, gas=0.01, wander=1e-4)) is None


def test_frames_of_two_kinds_are_told_though_the_noise_of_frames_holds_them(left):
    """A seventh of the frames are 0.6 % brighter beside gains that are 0.1 % of noise each."""
    random = np.random.default_rng(1)
    flat, frames = random.standard_normal((SAMPLES, CHANNELS)), frames_with(2, gas=0.01)
    noise, brighter = 1e-3 * random.standard_normal(SAMPLES), 6e-3 * (random.random(SAMPLES) < 0.14)
    assert left(flat, frames=frames + noise[:, None] * FRAME_LIGHT) is None
    assert left(flat, frames=frames + (noise + brighter)[:, None] * FRAME_LIGHT) == leftover.FRAMES


def test_frames_of_a_surface_that_cools_fast_tell_no_step():
    """An ablator loses a third of its light in a frame: a hundredth of that, missed, were a step."""
    value = FRAME_LIGHT * np.where(np.arange(SAMPLES) < 50, 1.0, 0.7)[:, None] * np.ones(CHANNELS)
    frames = SimpleNamespace(raw_bin=np.arange(SAMPLES), number=np.ones(value.shape))
    _, error = leftover.gains_of_frames(frames, 0 * value, value, 0 * value, np.ones(value.shape))
    assert (error[[49, 50]] > leftover.STEP_STANDS * 1e-3).all()
    assert (error[:48] < 1e-4).all() and (error[52:] < 1e-4).all()


def test_a_step_is_held_against_usual_ones(left):
    """Gains that walk by 0.3 % from frame to frame have no step of 0.3 %."""
    flat = np.random.default_rng(1).standard_normal((SAMPLES, CHANNELS))
    assert left(flat, frames=frames_with(2, step=3e-3, wander=3e-3)) is None


@pytest.mark.parametrize("seed", range(4))
def test_frames_of_a_plasma_are_not_held_against_those_without(left, seed):
    """A beam that wanders by 0.3 % on a sample in the flow, and not on the one that cools."""
    random = np.random.default_rng(seed)
    flat = random.standard_normal((300, CHANNELS))
    wander = 3e-3 * random.standard_normal(300) * (np.arange(300) < 80)
    assert left(flat, frames=flat + wander[:, None] * FRAME_LIGHT) is None


def test_the_end_of_the_plasma_is_no_step(left):
    flat = np.random.default_rng(1).standard_normal((SAMPLES, CHANNELS))
    frames = frames_with(2)
    frames[80:] += 0.01 * FRAME_LIGHT  # from 70 s on
    assert left(flat, frames=frames) is None


def test_a_ramp_is_no_step():
    time, error = np.arange(100.0), np.full(100, 1e-4)
    noise = 1e-4 * np.random.default_rng(3).standard_normal(100)
    ramp, step = 1e-3 * np.clip((time - 40) / 10, 0, 1), 1e-3 * (time > 40)
    assert leftover.largest_step(noise + ramp, error, 1.0)[0] < leftover.STEP_STANDS
    size, place = leftover.largest_step(noise + step, error, 1.0)
    assert size > leftover.STEP_STANDS and abs(place - 41) <= 1


@pytest.mark.parametrize("seed", range(6))
def test_flicker_of_a_surface_that_brightens_is_no_step(seed):
    """Errors fall from 0.2 to 0.01 %, gains flicker by 0.06 %: beside early frames late ones seem to step."""
    random = np.random.default_rng(seed)
    error = np.geomspace(2e-3, 1e-4, 60)
    gain = error * random.standard_normal(60) + 6e-4 * random.standard_normal(60)
    assert leftover.largest_step(gain, error, 5.0)[0] < leftover.STEP_STANDS
    size, place = leftover.largest_step(gain + 1e-2 * (np.arange(60) >= 40), error, 5.0)
    assert size > leftover.STEP_STANDS and abs(place - 40) <= 1


def test_no_step_is_told_near_the_ends_of_a_phase():
    """There a path bends, and what a spline misses of it jumps from one frame to the next."""
    gain, error = 1e-4 * np.random.default_rng(3).standard_normal(60), np.full(60, 1e-4)
    gain[[-7, -6, -5, -4]] = 37e-4, -36e-4, 29e-4, 37e-4
    gain[[6, 5, 4, 3]] = 37e-4, -36e-4, 29e-4, 37e-4
    assert leftover.largest_step(gain, error, 1.0)[0] < leftover.STEP_STANDS


def test_two_bands_have_no_patterns(left):
    assert left(np.random.default_rng(3).standard_normal((SAMPLES, 2)) * 5, channels=2) is None


@pytest.mark.parametrize("power", [0.5, 1.0])
def test_a_path_follows_what_a_flux_does_to_thick_and_thin_samples(power):
    """Sixty kelvin in the first quarter of a second, as an ablator; and as steadily as a bare sheet."""
    off = 100.0
    knots = np.concatenate(
        [np.arange(0.0, 100.0, 8), [off], off + np.array([0.25, 0.75, 1.25, 1.75, 2.25, 3.5, 5, 8, 12])]
    )
    history, time = History(knots, off), off + np.linspace(0, 3, 400)

    def path(time):
        return 1700 - 120 * np.maximum(time - off, 0) ** power

    # A spline over the time itself errs by 6 K where the root begins; a kelvin is 0.6 % of the light.
    assert np.abs(history.basis(time) @ path(knots) - path(time)).max() < 1.0


def test_a_thick_sample_may_near_its_end_slowly_but_not_wiggle():
    """A rise with 80 s bends by six deviations of the floor for minutes; a surface 7 K colder bent less."""
    off = 280.0
    knots = np.concatenate([np.arange(20.0), np.arange(20.0, 60.0, 2.0), np.arange(60.0, off, 8.0), [off]])
    history = History(knots, off)
    slow = 350 + 1000 * -np.expm1(-knots / 80.0)

    def penalty(path):
        return np.sum((history.roughness()[:-1] @ (path - 350.0)) ** 2)

    assert penalty(slow) < 5.0
    assert penalty(slow + np.where(knots == knots[-8], 1.0, 0.0)) > 100.0


def test_what_bands_leave_is_worded_as_bands():
    many, few = (SimpleNamespace(channels=n, source="radiometer") for n in (25, 2))
    spectra = SimpleNamespace(channels=300, source="spectrometer")
    said = leftover.names([many])
    assert said.keys() == leftover.NAMES.keys()
    assert not any("spectrometer" in one or "frame" in one for one in said.values())
    assert leftover.names([few, spectra]) == leftover.NAMES
