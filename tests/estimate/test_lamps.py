"""Light of a lamp beside that of a hot surface: drawn worlds with and without one."""

import numpy as np
import pytest

from plasmapyro.estimate.emissivity import Channels, smooth_prior
from plasmapyro.estimate.lamps import SURE, lamp, spectra
from plasmapyro.radiation.planck import blackbody_radiance

BINS, SLIT = np.linspace(480e-9, 1000e-9, 27), 30e-9
PRIOR = smooth_prior(BINS, 0.5, level=0.1, shape=0.1, length=200e-9)


def furnace(seed, kelvin=873.0):
    """Light (C,) of a surface as the prior expects it, its uncertainty, and the even light that may add."""
    random = np.random.default_rng(seed)
    body = blackbody_radiance(BINS, kelvin)
    surface = 0.5 * np.exp(PRIOR.basis @ random.standard_normal(PRIOR.basis.shape[1])) * body
    factor = blackbody_radiance(BINS, 1173.0) / np.exp(-(((BINS - 750e-9) / 250e-9) ** 2)) / 25e3
    error = np.hypot(np.hypot(0.2, np.sqrt(surface / factor / 500)) * factor, 0.005 * surface)
    return surface + error * random.standard_normal(BINS.size), error, 0.3 * factor[:, None]


def odds(seen, error, even):
    return lamp(Channels(BINS), PRIOR, BINS, seen, error, even, SLIT)


@pytest.mark.parametrize("seed", range(4))
def test_a_surface_alone_speaks_for_no_lamp(seed):
    assert odds(*furnace(seed)).odds < 3.0


@pytest.mark.parametrize("kind", spectra(BINS, SLIT))
def test_a_lamp_is_seen_and_less_than_no_light_is_none(kind):
    """30 and -6 standard deviations of the noise, did the surface say nothing of it."""
    seen, error, even = furnace(1)
    own = spectra(BINS, SLIT)[kind]
    own = own / np.sqrt(np.sum((own / error) ** 2))
    found = odds(seen + 30 * own, error, even)
    assert found.odds > 100.0
    assert odds(seen + 15 * own, error, even).odds > SURE > 0.0 > odds(seen - 6 * own, error, even).odds
    if kind in ("a fluorescent lamp", "a white diode"):
        assert found.kind == kind and spectra(BINS, SLIT)[kind][BINS == found.most] > 0.3
