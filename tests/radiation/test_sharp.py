"""Few lines: broad parts on a coarse grid, sharp parts in windows; together Voigt profiles."""

import numpy as np
import pytest
from scipy.special import wofz

from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.lines import LineList
from plasmapyro.radiation.opacity import prepare, spread
from plasmapyro.radiation.sharp import KAISER_POINTS, broad_share, kaiser, kaiser_transform

RANGE, POINTS = (770e-9, 790e-9), 8000
STEP = log_grid(RANGE, POINTS).step
CORE = 1e-5  # of the peak; the Fourier content beyond the grid is 1e-8 where sigma is 2 steps
WING_RTOL = 1e-3  # 1e-8 of the peak where the wing is 1e-5 of it, the end of the window
DARK = 1e-9  # of the peak; a profile cut off at the highest frequency rings to -5e-5
KERNEL = 1e-8  # of the kernel's repetition


def list_of(place):
    """Lines at places on the grid, in steps."""
    wavenumber = log_grid(RANGE, POINTS).wavenumber[0] * np.exp(np.asarray(place, dtype=float) * STEP)
    return LineList("few", "O", wavenumber, wavenumber + 5e6, 5e6, 3.0, 1.0, 1e7)


def voigt(lines, wavenumber, strength, hwhm, sigma):
    gauss = sigma * lines.wavenumber
    z = (wavenumber[:, None] - lines.wavenumber + 1j * hwhm) / (np.sqrt(2) * gauss)
    return (wofz(z).real / (np.sqrt(2 * np.pi) * gauss)) @ strength


def test_broad_share_is_one_at_rest_and_nothing_at_the_end_of_the_coarse_grid():
    assert broad_share(0.0) == pytest.approx(1, rel=1e-12)
    assert 0 <= broad_share(np.pi) < 2e-9
    assert np.all(np.diff(broad_share(np.linspace(0, np.pi, 200))) <= 0)


@pytest.mark.parametrize("place", [0.0, 0.3, 0.9])
def test_kernel_carries_a_wave_of_any_used_frequency_to_its_place(place):
    phase = np.linspace(0, 0.6 * np.pi, 25)
    points = np.arange(KAISER_POINTS)
    values = kaiser(np.array([place]))[:, 0]
    wave = np.exp(-1j * phase[:, None] * points) @ values / kaiser_transform(phase)
    centre = KAISER_POINTS / 2 - place  # the fraction runs from the edge of the kernel to its first point
    assert np.abs(wave - np.exp(-1j * phase * centre)).max() < KERNEL


# Doppler sigma in steps, Lorentz width in sigmas: as narrow as the grid allows, narrow, both, wider than the
# coarse steps.
@pytest.mark.parametrize(("sigma", "ratio"), [(1.01, 0.01), (1.5, 0.1), (2.0, 0.03), (2.0, 1.0), (3.0, 10.0)])
@pytest.mark.parametrize("place", [4000.37, 3.5, -40.2, POINTS + 40.6])
def test_single_line_is_a_voigt_profile_from_core_to_wing(sigma, ratio, place):
    grid, lines = log_grid(RANGE, POINTS), list_of([place])
    spreader = prepare(lines, grid)
    assert spreader.sharp is not None
    hwhm = ratio * sigma * STEP * lines.wavenumber
    found = spread(spreader, np.array([2.0]), hwhm, sigma * STEP) / grid.wavenumber
    exact = voigt(lines, grid.wavenumber, np.array([2.0]), hwhm, sigma * STEP)
    peak = 2 * wofz(1j * ratio / np.sqrt(2)).real / np.sqrt(2 * np.pi) / (sigma * STEP * lines.wavenumber[0])
    # On a logarithmic axis the core of a profile leans, by no more than its widths in the wavenumber.
    lean = 3 * max(1.0, ratio) * sigma * STEP
    assert np.all(np.abs(found - exact) < CORE * peak + lean * exact)
    assert found.min() > -DARK * peak
    # Further off, images of the line itself, beside the other end of the grid, outshine its wing.
    distance = np.abs(np.arange(POINTS) - place)
    wing = (distance > 200) & (distance < POINTS / 2)
    assert found[wing] == pytest.approx(exact[wing], rel=WING_RTOL + lean, abs=0)


def test_few_lines_of_many_widths_are_those_of_a_list_too_long_for_windows():
    grid, count, copies = log_grid(RANGE, POINTS), 60, 30
    place = (np.arange(count) * 0.618034 % 1) * POINTS
    sigma = 2 * STEP
    strength = 1.0 + np.arange(count) % 7
    lines, many = list_of(place), list_of(np.repeat(place, copies))
    hwhm = sigma * lines.wavenumber * np.geomspace(0.03, 100, count)
    few, dense = prepare(lines, grid), prepare(many, grid)
    assert few.sharp is not None and dense.sharp is None
    found = spread(few, strength, hwhm, sigma)
    other = spread(dense, np.repeat(strength, copies) / copies, np.repeat(hwhm, copies), sigma)
    assert np.abs(found - other).max() < 1e-4 * found.max()  # what the width nodes of the long list keep
    assert found.sum() == pytest.approx(other.sum(), rel=1e-5, abs=0)


def test_a_narrow_range_keeps_the_wings_of_lines_beside_it():
    # 0.4 % wide: bins of the far wings must not reach over the padding, whose periodic images are singular.
    grid = log_grid((776e-9, 779e-9), 2500)
    wavenumber = 1 / np.linspace(760e-9, 800e-9, 4001)
    lines = LineList("band", "N2", wavenumber, wavenumber + 5e6, 5e6, 3.0, 1.0, 1e7)
    strength, hwhm, sigma = np.ones(4001), np.full(4001, 2.0), 4 * grid.step
    found = spread(prepare(lines, grid), strength, hwhm, sigma) / grid.wavenumber
    window = slice(None, None, 25)
    exact = voigt(lines, grid.wavenumber[window], strength, hwhm, sigma)
    assert found[window] == pytest.approx(exact, rel=1e-4, abs=0)
