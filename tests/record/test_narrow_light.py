"""Narrow light before a hot surface: found where it was put, and nowhere else."""

import numpy as np
import pytest

from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record.foreign import narrow_light

AXIS = np.arange(450e-9, 1000e-9, 0.35e-9)
SLIT = 4e-9


def spectra(kelvin, places=(), share=0.3, width=SLIT, seed=0, noise=0.01):
    """Ten spectra (10, W) of a surface behind a response that is wrong by smooth 1 %, with lines on it."""
    light = blackbody_radiance(AXIS, kelvin) * (1 + 0.01 * np.sin(AXIS / 12e-9))
    level = light[:, None] * np.ones(10)
    for place in places:
        line = np.exp(-4 * np.log(2) * ((AXIS - place) / width) ** 2)
        level = level + (share * np.interp(place, AXIS, light) * line)[:, None]
    scatter = np.random.default_rng(seed).standard_normal(level.shape)
    return (level + noise * light.max() * 0.02 * scatter + noise * level * scatter).T


@pytest.mark.parametrize("place", [532e-9, 650e-9, 808e-9, 976e-9])
def test_a_laser_is_found_at_its_wavelength(place):
    found = narrow_light(AXIS, spectra(2000.0, [place]), SLIT)
    assert found == pytest.approx([place], abs=SLIT / 4)


def test_two_lines_come_strongest_first():
    # the same share of the light beside it is more where that is brighter
    found = narrow_light(AXIS, spectra(2000.0, [600e-9, 811.5e-9]), SLIT)
    assert found == pytest.approx([811.5e-9, 600e-9], abs=SLIT / 4)


@pytest.mark.parametrize("kelvin", [800.0, 1500.0, 3000.0])
def test_a_surface_alone_has_none(kelvin):
    for seed in range(6):
        for slit in (1e-9, SLIT, 30e-9):
            assert not narrow_light(AXIS, spectra(kelvin, seed=seed), slit).size


def test_what_is_wider_than_the_slit_is_no_line():
    assert not narrow_light(AXIS, spectra(2000.0, [700e-9], width=8 * SLIT), SLIT).size
