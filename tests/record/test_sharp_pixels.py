"""Pixels that show what no light behind the slit does: cosmic rays, hot and dead ones."""

import numpy as np
import pytest

from plasmapyro.record.flags import sharper

SLIT, STEP, DARK = 1.3e-9, 0.3e-9, 30.0  # [m], [m], noise in the unit of the light
AXIS = np.arange(750e-9, 1020e-9, STEP)
LINES = np.random.default_rng(3).uniform(760e-9, 1010e-9, 25)


def light(slit=SLIT, shape="gauss", frames=30):
    """A surface that heats behind a gas of 25 narrow lines."""
    away = np.abs(AXIS - LINES[:, None]) / slit
    each = np.exp(-4 * np.log(2) * away**2) if shape == "gauss" else np.maximum(1 - away, 0)
    surface = np.linspace(0, 1, frames)[:, None] ** 2 * np.linspace(3000, 9000, AXIS.size)
    random = np.random.default_rng(1)
    whole = surface + 20000 * random.exponential(size=25) @ each / 3
    return whole + np.hypot(DARK, 0.01 * whole) * random.standard_normal(whole.shape)


@pytest.mark.parametrize(
    "slit, shape", [(SLIT, "gauss"), (SLIT, "triangle"), (0.7 * SLIT, "gauss"), (3e-9, "gauss")]
)
def test_light_behind_the_slit_is_never_too_sharp(slit, shape):
    assert not sharper(light(slit, shape), AXIS, SLIT).any()


@pytest.mark.parametrize("width", [1, 2])
def test_a_cosmic_ray_is_found_in_its_frame_alone(width):
    values = light()
    for frame, pixel in ((3, 100), (12, 400), (20, 731)):
        values[frame, pixel : pixel + width] += 4 * values[frame, pixel - 3 : pixel + 4].max() + 1000
    found = sharper(values, AXIS, SLIT)
    assert found.sum() == 3 * width and found[3, 100] and found[12, 400] and found[20, 731]


def test_a_hot_and_a_dead_pixel_never_count():
    values = light()
    values[:, 200] += 4000.0  # less than the surface in the end
    values[:, 600] = DARK * np.random.default_rng(2).standard_normal(len(values))
    found = sharper(values, AXIS, SLIT)
    assert found[:, 200].all() and found[:, 600].all() and found.sum() == 2 * len(values)


def test_two_dead_pixels_side_by_side_never_count():
    """Their dark was alive, so that less than no light is left of them."""
    values = light()
    values[:, 600:602] = -2000.0
    found = sharper(values, AXIS, SLIT)
    assert found[:, 600:602].all() and found.sum() == 2 * len(values)


def test_lines_far_sharper_than_the_stated_slit_are_no_fault_of_pixels():
    """A slit of 3 nm for one of 0.4 nm: then it is the statement that is wrong."""
    assert not sharper(light(0.4e-9), AXIS, 3e-9).any()
