"""Temperature and emissivity together: analytic limits, drawn worlds, another way to the same numbers."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.estimate.emissivity import Channels, Prior, follow, infer, log_emissivity, smooth_prior
from plasmapyro.estimate.emissivity_stage import FREER, course_freedom, estimate_emissivity
from plasmapyro.instrument.bands import radiometer_calibration
from plasmapyro.radiation.planck import blackbody_radiance

PIXELS = np.linspace(0.5e-6, 1.0e-6, 60)
KNOWN = {"level": 0.1, "shape": 0.1, "length": 2e-7}


def light(emissivity, kelvin, wavelength=PIXELS):
    return emissivity * blackbody_radiance(wavelength, np.asarray(kelvin, dtype=float)[:, None])


def test_without_noise_a_surface_as_expected_comes_out_exactly():
    mean = 0.3 + 0.4 * (1e-6 - PIXELS) / 5e-7
    prior = smooth_prior(PIXELS, mean, **KNOWN)
    kelvin = np.array([700.0, 1100.0, 2400.0])
    seen = light(mean, kelvin)
    found = infer(Channels(PIXELS), prior, seen, 1e-3 * seen)
    assert found.converged.all()
    np.testing.assert_allclose(found.temperature, kelvin, rtol=1e-6)  # the iteration ends there
    value, _ = log_emissivity(found, prior.logarithm, prior.basis)
    np.testing.assert_allclose(np.exp(value), np.tile(mean, (3, 1)), rtol=1e-5)


def test_the_prior_alone_decides_along_the_direction_of_wien():
    """In Wien's limit ln L = ln(emissivity) - c2/(lambda T) + ..: generalised least squares in 1/T.

    Its standard deviation is 1/sqrt(s^T C^-1 s) with s = c2/lambda and C of emissivity and noise together.
    """
    kelvin, x = 1000.0, (PIXELS - 750e-9) / 200e-9
    mean, one = np.full((PIXELS.size,) * 2, 1 / PIXELS.size), np.eye(PIXELS.size)
    going = np.outer(x, x) + 0.75 * np.outer(x**2, x**2)
    course, beside = (np.exp(-((x[:, None] - x) ** 2) / 2) + going) / 2, np.exp(-(x**2) / 2) / 2
    of_mean = (one - mean) @ course @ (one - mean)
    of_middle = course - beside - beside[:, None] + 1 / 2  # that of its difference from its value at x = 0
    covariance = 0.1**2 + 0.1**2 * (of_mean + of_middle) / 2 + 1e-3**2 * one
    shape = SECOND_RADIATION / PIXELS
    expected = kelvin / np.sqrt(shape @ np.linalg.solve(covariance, shape))
    seen = light(0.5, [kelvin])
    prior = smooth_prior(PIXELS, 0.5, **KNOWN)
    found = infer(Channels(PIXELS), prior, seen, 1e-3 * seen)
    # 5 %: shapes of less than 1e-7 of the variance are left out.
    assert found.relative_uncertainty[0] == pytest.approx(expected, rel=0.05)
    assert found.noise_only[0] < 1e-2 * found.relative_uncertainty[0]


def test_a_brighter_direction_of_wien_is_not_seen():
    """Light of a surface 20 K hotter whose emissivity follows exp(-c2 delta/lambda): the same counts."""
    delta = 1 / 1000.0 - 1 / 1020.0
    emissivity = 0.5 * np.exp(-SECOND_RADIATION * delta / PIXELS)
    np.testing.assert_allclose(light(emissivity, [1020.0]), light(0.5, [1000.0]), rtol=1e-6)


def test_samples_after_one_another_are_one_large_fit():
    """Two samples that share all coefficients, against a joint fit by a general optimiser."""
    from scipy.optimize import least_squares

    random = np.random.default_rng(5)
    prior = smooth_prior(PIXELS, 0.5, **KNOWN)
    count, kelvin = prior.basis.shape[1], np.array([1000.0, 1300.0])
    truth = 0.5 * np.exp(prior.basis @ (0.5 * random.standard_normal(count)))
    seen = light(truth, kelvin)
    noise = 0.002 * seen
    seen = seen + noise * random.standard_normal(seen.shape)
    nothing = np.zeros((*seen.shape, 0))
    found = follow(Channels(PIXELS), prior, np.ones((1, count)), seen, noise, nothing)

    def rest(x):
        model = light(0.5 * np.exp(prior.basis @ x[2:]), 1000.0 / x[:2])
        return np.concatenate([((seen - model) / noise).ravel(), x[2:]])

    best = least_squares(rest, np.append(1000.0 / kelvin, np.zeros(count)), xtol=1e-14, ftol=1e-14)
    spread = np.sqrt(np.diag(np.linalg.inv(best.jac.T @ best.jac)))[:2] / best.x[:2]
    # A tenth of the uncertainty: the filter does not return to the first sample's linearisation.
    np.testing.assert_allclose(found.temperature, 1000.0 / best.x[:2], rtol=0.1 * spread.min())
    np.testing.assert_allclose(found.relative_uncertainty, spread, rtol=0.05)


def test_a_sample_without_light_carries_on_what_is_known():
    prior = smooth_prior(PIXELS, 0.5, **KNOWN)
    seen = light(0.6, [1000.0, 1000.0, 1000.0])
    seen[1] = np.nan
    kept = np.ones((2, prior.basis.shape[1]))
    found = follow(Channels(PIXELS), prior, kept, seen, 1e-3 * seen, np.zeros((*seen.shape, 0)))
    assert list(found.converged) == [True, False, True] and np.isnan(found.temperature[1])
    np.testing.assert_allclose(found.state[0], found.state[2], atol=1e-3)


def test_added_light_of_known_colour_is_taken_out():
    prior = smooth_prior(PIXELS, 0.5, **KNOWN)
    seen = light(0.5, [1000.0])
    glow = np.broadcast_to(1e-2 * seen.max(), seen.shape)
    found = infer(Channels(PIXELS), prior, seen + 0.7 * glow, 1e-4 * seen, glow[..., None])
    assert found.state[0, -1] == pytest.approx(0.7, abs=0.01)  # its prior, 0 +- 1, pulls it by less
    assert found.temperature[0] == pytest.approx(1000.0, abs=1.0)


CENTRES = np.array([0.65, 0.75, 0.85, 0.95, 1.05]) * 1e-6
FIVE = np.linspace(0.6e-6, 1.1e-6, 101)
BANDS = np.abs(FIVE - CENTRES[:, None]) <= 0.03e-6
WORLDS = ("tilted", "curved", "oxidising")


def worlds(random, count):
    """Emissivities (3, count, W) of 0.75 on average, by formulas that are no Gaussian process."""
    x = (FIVE - 0.85e-6) / 0.25e-6
    first, second, moment = random.standard_normal((3, 3, count, 1))
    level = 0.75 * np.exp(0.08 * first)
    metal, oxide = 0.62 - 0.17 * x, 0.88 + 0.0 * x
    share = 1 / (1 + np.exp(-1.5 * moment[2]))
    return np.stack(
        [
            level[0] * np.exp(0.12 * second[0] * x),
            level[1] * np.exp(0.12 * second[1] * (x**2 - 0.5)),
            level[2] / 0.75 * ((1 - share) * metal + share * oxide),
        ]
    )


def test_five_bands_beat_two_grey_ones_and_know_how_well():
    random = np.random.default_rng(12)
    count = 400
    emissivity = worlds(random, count)
    kelvin = random.uniform(1100.0, 2100.0, count)
    signal = np.einsum("wnl,nl,bl->wnb", emissivity, blackbody_radiance(FIVE, kelvin[:, None]), BANDS * 1.0)
    signal *= 1 + 0.003 * random.standard_normal(signal.shape)
    trials = np.linspace(600.0, 4000.0, 20001)
    body = blackbody_radiance(FIVE, trials[:, None])
    curve = (body @ BANDS[3]) / (body @ BANDS[4])  # a ratio pyrometer of the two longest bands
    for name, seen, own in zip(WORLDS, signal, emissivity, strict=True):
        stated = np.sqrt(np.mean(np.log(own.mean(axis=1) / 0.75) ** 2))  # an oxide changes the level too
        prior = smooth_prior(FIVE, 0.75, level=stated, shape=0.12, length=2.5e-7)
        found = infer(Channels(FIVE, BANDS * 1.0), prior, seen, 0.003 * seen)
        assert found.converged.all()
        error = found.temperature / kelvin - 1
        grey = np.interp(seen[:, 3] / seen[:, 4], curve, trials) / kelvin - 1
        assert np.sqrt(np.mean(grey**2)) >= 3 * np.sqrt(np.mean(error**2)), name
        inside = np.abs(np.log(found.temperature / kelvin)) < 1.959964 * found.relative_uncertainty
        assert inside.mean() >= 0.92, name
        # ... and by no great width
        assert np.sqrt(np.mean(error**2)) > 0.7 * np.median(found.relative_uncertainty), name


@pytest.mark.parametrize("level", [0.06, 0.15])
@pytest.mark.parametrize("bands", [3, 25, 60])
@pytest.mark.parametrize("world", ["tilted", "curved"])
def test_intervals_hold_what_is_tilted_or_curved_over_a_wide_range(world, bands, level):
    """Smooth surfaces that differ by a quarter at the ends: intervals held 51 to 85 % of them before."""
    random, at, count = np.random.default_rng(bands), np.linspace(560e-9, 1040e-9, bands), 300
    size, x = random.standard_normal((count, 1)), (at - 800e-9) / 200e-9
    course = 0.08 * size * x if world == "tilted" else 0.08 * size * (x**2 - np.mean(x**2))
    emissivity = 0.75 * np.exp(level * random.standard_normal((count, 1)) + course)
    seen = light(emissivity, np.full(count, 1700.0), at)
    seen *= 1 + 0.003 * random.standard_normal(seen.shape)
    found = infer(
        Channels(at), smooth_prior(at, 0.75, level=level, shape=0.1, length=2e-7), seen, 0.003 * seen
    )
    error = np.log(found.temperature / 1700.0)
    assert (np.abs(error) < 1.959964 * found.relative_uncertainty).mean() >= 0.92
    assert np.sqrt(np.mean(error**2)) > 0.6 * np.median(found.relative_uncertainty)


def test_evidence_is_the_integral_over_all_that_is_free():
    """By a sum over a grid of 1000 K/T and one coefficient, between priors of two widths."""
    at, kelvin = np.array([0.7e-6, 0.9e-6, 1.1e-6]), 1500.0
    seen, tilt = light(0.7 * np.array([1.02, 1.0, 0.97]), [kelvin], at), (at / 0.9e-6 - 1)[:, None]
    noise, logarithm = 0.01 * seen, np.full(3, np.log(0.7))
    inverse = 1000 / kelvin + np.linspace(-0.06, 0.06, 801)[:, None, None]
    unit = np.linspace(-6, 6, 601)[None, :, None]
    found, summed = [], []
    for width in (0.1, 0.4):
        prior = Prior(logarithm, width * tilt)
        found.append(infer(Channels(at), prior, seen, noise).evidence[0])
        model = np.exp(logarithm + unit * width * tilt[:, 0]) * blackbody_radiance(at, 1000 / inverse)
        chi = np.sum(((seen - model) / noise) ** 2, axis=-1) + unit[..., 0] ** 2
        summed.append(np.log(np.exp(-chi / 2).sum()))
    # Laplace: the model is not quite straight in both; some 1 % of a factor
    assert found[0] - found[1] == pytest.approx(summed[0] - summed[1], abs=0.02)
    assert abs(found[0] - found[1]) > 0.1


@pytest.mark.parametrize("true", [1.0, 3.0])
def test_surfaces_say_how_freely_their_emissivity_runs(true):
    random = np.random.default_rng(5)
    at = np.linspace(0.7e-6, 1.1e-6, 5)
    priors = {one: smooth_prior(at, 0.7, level=0.1, shape=0.1 * one, length=2e-7) for one in (1.0, 3.0)}
    drawn = random.standard_normal((200, priors[true].basis.shape[1])) @ priors[true].basis.T
    seen = light(np.exp(priors[true].logarithm + drawn), np.full(200, 1500.0), at)
    seen *= 1 + 0.003 * random.standard_normal(seen.shape)
    told = {one: np.median(infer(Channels(at), p, seen, 0.003 * seen).evidence) for one, p in priors.items()}
    assert max(told, key=told.get) == true


def test_light_that_does_not_tell_leaves_more_than_the_likeliest_course():
    """Chances 1, 1/1.5, 1/2 and 1/3 beforehand: their mean square is (1 + 1.5 + 2 + 3)/(5/2)."""
    assert FREER == (1.0, 1.5, 2.0, 3.0)
    assert course_freedom(np.full(4, -7.0), 5) == pytest.approx(np.sqrt(3.0))
    assert course_freedom(np.array([-60.0, -30.0, -20.0, 90.0]), 5) == pytest.approx(3.0)
    assert course_freedom(np.full(4, -7.0), 3) == 1.0  # a ratio, or three bands, hold the stated course
    assert course_freedom(np.full(4, np.nan), 5) == 1.0  # no sample is clear


TWELVE = np.linspace(700e-9, 1100e-9, 12)


def by_bands(kelvin, level=0.75, *, centre=TWELVE, half=5e-9, step=0.5, source=1.0):
    """Estimate of grey surfaces of `level` (S,), stated as 0.75 +- 0.05, every `step` [s]."""
    random, time = np.random.default_rng(8), np.arange(len(kelvin)) * step
    names = [f"b{one}" for one in range(centre.size)]
    axis = np.arange(centre[0] - 2 * half, centre[-1] + 2 * half, 0.5e-9)
    curves = np.abs(axis - centre[:, None]) < half
    facts = {"instrument": "bands", "calibration": "absolute", "signal_uncertainty": 0.003}
    facts |= {"origin": "synthetic", "instrument_range": (900.0, 2600.0)}
    response = xr.Dataset(
        {"responsivity": (("band", "wavelength"), curves.astype(float))},
        {"wavelength": axis, "band": names},
        facts,
    )

    def seen(kelvin):
        return 0.5e-9 * blackbody_radiance(axis, np.asarray(kelvin)[:, None]) @ curves.T

    hot = np.arange(1100.0, 2001.0, 150.0)
    points = {"source_temperature": hot} | dict(zip(names, seen(hot).T, strict=True))
    known = radiometer_calibration(response, points, source_temperature_uncertainty=source)
    noise = random.normal(1, 0.003, (len(kelvin), centre.size))
    signal = np.reshape(level, (-1, 1)) * seen(kelvin) * noise
    test = xr.Dataset(
        {"radiometer_signal": (("radiometer_time", "band"), signal, {"units": "1"})},
        {"radiometer_time": ("radiometer_time", time, {"units": "s"}), "band": names},
        {
            "origin": "synthetic",
            "condition": "none",
            "emittance": 0.75,
            "emittance_uncertainty": 0.05,
            "window_transmittance_radiometer": 1.0,
            "radiometer_integration_time": 0.01,
        },
    )
    settings = {"level": None, "shape": 0.1, "length": 200e-9, "memory": 100.0, "stray_light": 0.003}
    settings |= {"bin_width": 20e-9, "bin_uncertainty": 0.005, "gas_variation": 0.03, "noise_block": 50}
    limits = {"least_signal_to_noise": 10.0, "least_surface_share": 0.5, "saturation_counts": 65000.0}
    return estimate_emissivity(test, known, **settings, **limits)


def test_constants_of_many_bands_do_not_learn_from_noise():
    """300 samples of 12 bands at a stated grey emissivity: what is constant stays where it was stated."""
    kelvin = 1300 + 300 * np.sin(np.arange(300) / 80)
    found = by_bands(kelvin)
    off = (found.spectral_temperature.values - kelvin) / found.spectral_temperature_uncertainty.values
    assert np.abs(off).max() < 0.5  # the prior is right; noise makes a tenth of the uncertainty


def test_a_long_record_of_three_bands_does_not_learn_the_source_from_noise():
    """Columns that held the noise of the samples grew until it vanished: 10 uncertainties of the source."""
    kelvin, centre = np.linspace(900.0, 1400.0, 2000), np.array([1050e-9, 1250e-9, 1550e-9])
    found = by_bands(kelvin, centre=centre, half=25e-9, step=0.05, source=3.0)
    off = (found.spectral_temperature.values - kelvin) / found.spectral_temperature_uncertainty.values
    assert np.abs(off).max() < 0.5


def test_a_level_that_was_stated_ages():
    """A surface that oxidises from 0.75 to 0.87: the level was stated of what it was at the injection."""
    kelvin = np.full(300, 1500.0)
    found = by_bands(kelvin, np.linspace(0.75, 0.87, 300))
    low, high = found.spectral_temperature_interval.values
    assert ((low < kelvin) & (kelvin < high)).all()
    stated = by_bands(kelvin).spectral_temperature_uncertainty.values
    grown = np.sqrt(1 + (0.1 / 3) ** 2 * (1 - np.exp(-2 * 149.5 / 100)) / (0.05 / 0.75) ** 2)
    assert stated[-1] == pytest.approx(grown * stated[0], rel=0.05)  # the course stands beside both
