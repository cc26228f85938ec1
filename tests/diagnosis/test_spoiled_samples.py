"""Samples that were hit, lost or saturated: found, replaced, and no bias left behind."""

from dataclasses import dataclass

import numpy as np
import pytest

from plasmapyro.diagnosis.fit import build, noise, observation, outliers
from plasmapyro.record import binning

SAMPLES, CHANNELS = 200, 60


@dataclass(frozen=True)
class Binned:
    """As much of an instrument as the cleaning needs."""

    raw: np.ndarray
    raw_bin: np.ndarray
    value: np.ndarray
    number: np.ndarray | None = None


@pytest.fixture
def random():
    return np.random.default_rng(11)


def test_a_hit_stands_out_though_it_is_alone_in_its_bin(random):
    scaled = random.standard_normal((SAMPLES, CHANNELS)) + 30 * np.linspace(0, 1, SAMPLES)[:, None] ** 2
    scaled[70, 5] += 12
    phase = np.zeros(SAMPLES, dtype=int)
    found = outliers.outliers(scaled, np.ones(SAMPLES, dtype=bool), phase)
    assert found[70, 5]
    # 12 000 normal numbers: beyond 4.5 standard deviations 0.08 are expected.
    assert found.sum() <= 3


def test_light_in_many_channels_at_once_is_no_hit(random):
    scaled = random.standard_normal((SAMPLES, CHANNELS))
    scaled[100, :20] += 15
    found = outliers.outliers(scaled, np.ones(SAMPLES, dtype=bool), np.zeros(SAMPLES, dtype=int))
    assert not found[100].any()


def test_a_bin_in_which_many_samples_stand_out_holds_a_misfit():
    """Of ten samples four are a misfit, three or fewer may be hits; of four in a bin nothing is said."""
    index = np.repeat([0, 1, 2, -1], [10, 10, 4, 2])
    hit = np.zeros((index.size, 2), dtype=bool)
    hit[:4, 0], hit[10:13, 0], hit[20:, 1] = True, True, True
    found = outliers.crowded(hit, index, 3)
    assert found[:10, 0].all() and found.sum() == 10


def test_neighbours_are_of_the_same_phase():
    scaled = np.where(np.arange(40) < 20, 0.0, 50.0)[:, None]
    phase = (np.arange(40) >= 20).astype(int)
    assert not outliers.outliers(scaled, np.ones(40, dtype=bool), phase).any()
    assert outliers.slow_part(scaled, np.ones(40, dtype=bool), phase) == pytest.approx(scaled)


def test_replaced_samples_leave_time_and_mean_of_their_bin(random):
    ramp = np.linspace(0, 1, 20)[:, None] * np.ones(3)
    raw = ramp.copy()
    raw[3, 0], raw[4, 1] = 9.0, np.nan
    one = Binned(raw, np.arange(20) // 10, np.zeros((2, 3)))
    hit = np.zeros(raw.shape, dtype=bool)
    hit[3, 0] = True
    clean = outliers.without_outliers(one, ramp, hit)
    assert clean.value == pytest.approx(binning.mean_in_bins(ramp, one.raw_bin, 2)[0])
    assert clean.number[0].tolist() == [9, 9, 10]


def test_what_saturation_leaves_has_no_bias(random):
    """Pixels near the limit: those that by chance stay below it are too dark on average."""
    time = np.linspace(0.8, 1.2, 400)
    counts = time[:, None] + 0.05 * random.standard_normal((400, 50))
    saturated = counts > 1.0
    index = np.arange(400) // 10
    edges = np.arange(51)
    lost = observation.beside_saturation(saturated, index, edges)
    truth = np.broadcast_to(time[:, None], counts.shape)
    naive = (counts - truth)[~saturated & (np.abs(time[:, None] - 1) < 0.03)]
    kept = (counts - truth)[~lost]
    error = 0.05 / np.sqrt(kept.size)
    assert abs(kept.mean()) < 4 * error < abs(naive.mean())
    assert lost[saturated].all()


def test_no_bin_holds_pixels_from_both_sides_of_a_gap():
    wavelength = np.delete(np.linspace(750e-9, 1030e-9, 361), slice(101, 160))
    edges = binning.pixel_edges(wavelength, np.ones(wavelength.size), 0.75e-9)
    first, last = wavelength[edges[:-1]], wavelength[edges[1:] - 1]
    assert (last - first).max() < 3e-9
    assert edges[0] == 0 and edges[-1] == wavelength.size


@pytest.mark.parametrize("share", [0.0, 0.01])
def test_law_of_the_noise_survives_hits(random, share):
    law, pixels, factor = np.array([1.0, 0.5, 1e-4]), np.full(40, 2.0), np.linspace(1, 2, 40)
    level = np.linspace(2, 60, 1500)[:, None] * np.ones(40)
    sigma = np.sqrt(noise.sample_variance(*law, level, factor, pixels))
    sample = sigma * random.standard_normal(level.shape)
    sample[random.random(level.shape) < share] += 60.0
    found = noise._fit_variance(np.diff(sample, axis=0), (level[1:] + level[:-1]) / 2, factor, pixels)
    fitted = noise.sample_variance(*found, level, factor, pixels)
    # Clipping at 4.5 and 60 000 differences: one per cent.
    assert np.median(fitted / sigma**2) == pytest.approx(1, abs=0.02)


def test_a_sample_below_zero_has_the_noise_of_a_faint_one():
    """Pure shot noise: a prediction below zero, as of a fit on its way, had none."""
    level = np.array([[100.0, 40.0], [-3.0, 20.0], [200.0, 0.0]])
    found = noise.sample_variance(0.0, 0.2, 0.0, level, np.ones(2), np.ones(2))
    assert found[[0, 2], [0, 0]] == pytest.approx([20.0, 40.0]) and found[1, 1] == pytest.approx(4.0)
    assert found[1, 0] == pytest.approx(0.2 * 1e-3 * 100) and found[2, 1] == pytest.approx(0.2 * 1e-3 * 20)


def test_spectra_that_hold_nothing_cost_no_pixel():
    radiance = np.ones((8, 3))
    radiance[:4] = np.nan  # before the plasma burned
    radiance[5:, 1] = np.nan
    assert list(build.seen_in_most(radiance)) == [True, False, True]
    assert not build.seen_in_most(np.full((8, 3), np.nan)).any()
