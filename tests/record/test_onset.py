"""The reference window: gas alone, gas that drifts, or the surface already in it."""

import numpy as np
import pytest

from plasmapyro.record import onset

TIME = np.arange(0.0, 60.0, 0.1)
GAS = np.array([[2.0], [1.0]])
SURFACE = np.array([[0.4], [1.0]])  # a cold surface is redder than the gas


def made(seed=1, rise=12.0, noise=0.01, flicker=0.0, drift=0.0, surface=1.0):
    """Signals of a gas and of a surface that doubles every 2 s and is as bright as the gas at `rise`."""
    generator = np.random.default_rng(seed)
    level = np.zeros(TIME.size)
    for i in range(1, TIME.size):
        level[i] = 0.9 * level[i - 1] + flicker * generator.standard_normal()
    gas = GAS * np.exp(level + drift * TIME / 60)
    warm = surface * SURFACE * 2 ** np.minimum((TIME - rise) / 2, 5)
    return (gas + warm) * (1 + noise * generator.standard_normal((2, TIME.size)))


def test_growth_comes_back_with_its_uncertainty():
    generator, u = np.random.default_rng(2), np.linspace(0, 1, 200)
    found = [
        onset.trend(u, 5 + 0.3 * u**3 + 0.1 * generator.standard_normal(200), (0.0, 1.0)) for _ in range(400)
    ]
    growth = np.array([one.growth for one in found])
    stated = np.array([one.growth / one.deviations for one in found])
    assert growth.mean() == pytest.approx(0.3, abs=4 * growth.std() / 20)
    assert np.median(stated) == pytest.approx(growth.std(), rel=0.15)  # of 400 repeats, and r_1 cut at 0
    assert np.mean([one.bias for one in found]) == pytest.approx(0.3 / 4, rel=0.05)  # mean of u^3


@pytest.mark.parametrize("flicker", [0.0, 0.02])
def test_gas_alone_is_hardly_ever_taken_for_a_surface(flicker):
    words = [onset.verdict(TIME, made(seed, flicker=flicker, surface=0), (0, 6)).word for seed in range(300)]
    assert words.count(onset.SHOWS) <= 1
    assert words.count(onset.CLEAN) > 270


@pytest.mark.parametrize("count", [8, 10, 20])
def test_chance_is_as_rare_in_a_few_samples(count):
    """The scatter of eight samples is known to a quarter: four of their deviations are no four of many."""
    time, generator = np.linspace(0.0, 6.0, count), np.random.default_rng(count)
    made = (GAS * (1 + 0.01 * generator.standard_normal((2, count))) for _ in range(1000))
    assert sum(onset.verdict(time, gas, (0, 6)).word != onset.CLEAN for gas in made) <= 1


def test_a_surface_in_the_window_is_found():
    words = [onset.verdict(TIME, made(seed, flicker=0.02), (0, 10)).word for seed in range(30)]
    assert set(words) == {onset.SHOWS}
    bias = onset.verdict(TIME, made(noise=1e-4), (0, 10)).bias
    # Mean of 2^((t-12)/2) from 0 to 10 s over that at the begin of the window, and over the gas.
    mean = (2**-1 - 2**-6) / (10 * np.log(2) / 2)
    assert bias[1] == pytest.approx(mean, rel=0.35) and bias[1] > 3 * bias[0] > 0


def test_a_gas_that_brightens_as_a_whole_is_no_surface():
    assert onset.verdict(TIME, made(drift=0.5, surface=0), (0, 10)).word == onset.DRIFTS


def test_a_gas_that_fades_is_no_surface():
    fading = made(drift=-0.5, surface=0) * np.exp(np.array([[-0.005], [0.0]]) * TIME)
    assert onset.verdict(TIME, fading, (0, 10)).word == onset.DRIFTS


def test_a_gas_that_changes_its_colour_is_no_surface():
    turning = made(surface=0) * np.exp(np.array([[-0.02], [0.02]]) * TIME)
    assert onset.verdict(TIME, turning, (0, 10)).word == onset.DRIFTS


@pytest.mark.parametrize("rise", [12.0, 15.0, 30.0])
def test_the_proposed_window_is_clean_and_not_wasteful(rise):
    for seed in range(10):
        signals = made(seed, rise=rise, flicker=0.01)
        first, window = onset.onset(TIME, signals, 0.0, 60.0)
        share = SURFACE[1, 0] * 2 ** ((window[1] - rise) / 2)  # of the gas, narrow band, at its end
        assert window[1] < first < rise
        assert share < 0.06 and window[1] > 0.2 * rise


def test_a_window_that_is_mostly_surface_is_found_as_well():
    for end in (14.0, 20.0, 40.0):
        found = onset.attributes("pyrometer", TIME, made(), (0.0, end), 60.0)
        assert found["pyrometer_reference_verdict"] == onset.SHOWS
        assert found["pyrometer_proposed_window"][1] < 10


def test_no_surface_no_proposal():
    assert np.isnan(onset.onset(TIME, made(surface=0), 0.0, 60.0)[0])
    found = onset.attributes("pyrometer", TIME, made(surface=0), (0.0, 5.0), 60.0)
    assert found.keys() == {"pyrometer_reference_verdict", "pyrometer_reference_bias"}


def test_few_or_missing_samples_give_no_verdict():
    signals = made()
    signals[0, :60] = np.nan
    assert onset.verdict(TIME, signals, (0, 6)).word == onset.UNKNOWN
    assert onset.verdict(TIME[::10], made()[:, ::10], (0, 6)).word == onset.UNKNOWN
    assert np.isnan(onset.onset(TIME[:5], made()[:, :5], 0.0, 60.0)[0])


def test_signals_without_noise_are_judged_too():
    assert onset.verdict(TIME, made(noise=0.0, surface=0), (0, 6)).word == onset.CLEAN
    assert onset.verdict(TIME, made(noise=0.0), (0, 6)).word == onset.SHOWS


def test_a_bias_is_harmless_only_where_both_bands_have_little():
    """A surface of 0.4 and 1.0 over a gas of 2 and 1 grows as u^3, whose mean is 1/4."""
    for size, word in ((3e-3, onset.HARMLESS), (1.2e-2, onset.SHOWS)):
        signals = GAS + size * SURFACE * (TIME / 10) ** 3
        found = onset.attributes("pyrometer", TIME, signals, (0.0, 10.0), 10.0)
        wide, narrow = found["pyrometer_reference_bias"]
        assert narrow == pytest.approx(size / 4, rel=0.02) and wide < onset.LEAST_BIAS
        assert found["pyrometer_reference_verdict"] == word


@pytest.mark.parametrize("end", [9.0, 10.0, 12.0])
def test_a_surface_that_heats_by_itself_is_seen_before_it_rules(end):
    """Wien's law at 0.9 and 1.0 um, 350 + 1260 (1 - exp(-t/9))^2 K: at 9 s 6 and 14 % of the gas."""
    time = np.arange(0.0, 50.0, 0.25)
    kelvin = 350 + 1260 * (1 - np.exp(-time / 9)) ** 2
    level = 14388 * np.array([[1 / 0.9], [1.0]])
    nine = 350 + 1260 * (1 - np.exp(-1.0)) ** 2
    surface = np.array([[0.06], [0.14]]) * np.exp(level / nine - level / kelvin)
    flicker = 0.006 * np.random.default_rng(2).standard_normal(time.size)
    noise = 0.001 * np.random.default_rng(3).standard_normal((2, time.size))
    found = onset.attributes("p", time, (1 + flicker + surface) * (1 + noise), (0.0, end), 50.0)
    assert found["p_reference_verdict"] == onset.SHOWS
    assert 6 < found["p_surface_onset"] < 9 and found["p_proposed_window"][1] < 6.5
