import numpy as np
import pytest
from scipy.special import wofz

from plasmapyro.gas.species import MASS, SPECIES
from plasmapyro.radiation.broadening import doppler_sigma
from plasmapyro.radiation.grid import log_grid, points_for
from plasmapyro.radiation.lines import LineList
from plasmapyro.radiation.opacity import prepare, require_resolution, spread
from plasmapyro.radiation.path import gas_path

RANGE = (700e-9, 1200e-9)
POINTS = 150_000
RMS = 1e-3  # of the window's peak, the bar
CLOSE_RMS = 3e-4  # what is reached where the Doppler sigma spans 1.6 grid steps
INTEGRAL_RTOL = 2e-3
# Centre and half width [nm]: strong lines, their wings, between lines, near the ends of the grid.
WINDOWS = [
    (868.3, 0.3),
    (777.5, 0.4),
    (746.8, 0.3),
    (844.8, 0.3),
    (939.5, 0.3),
    (1011.5, 0.5),
    (800.0, 0.4),
    (891.2, 0.3),
    (990.0, 0.5),
    (1050.8, 0.5),
    (1150.0, 0.5),
    (701.5, 0.3),
    (1198.0, 0.5),
]


def direct_sum(lines, wavenumber, strength, hwhm, sigma):
    """Sum of Voigt profiles in wavenumber, line by line, by the Faddeeva function."""
    gauss = sigma * lines.wavenumber
    z = (wavenumber[:, None] - lines.wavenumber + 1j * hwhm) / (np.sqrt(2) * gauss)
    return (wofz(z).real / (np.sqrt(2 * np.pi) * gauss)) @ strength


@pytest.fixture(scope="module")
def grid():
    return log_grid(RANGE, POINTS)


@pytest.fixture(scope="module")
def spreaders(atoms, grid):
    return [prepare(lines, grid) for lines in atoms]


@pytest.fixture(scope="module", params=[6200.0, 9000.0])
def gas_state(request, spreaders, equilibrium_densities):
    """Strength, widths and sigma of both atoms, at Doppler- and at Stark-dominated widths."""
    temperature = request.param
    density = {name: np.full(2, n) for name, n in equilibrium_densities(temperature).items()}
    path = gas_path([0.0, 1.0], np.full(2, temperature), density)
    return [
        (
            path.emission(s.lines, 0),
            path.hwhm(s.lines, 0),
            doppler_sigma(temperature, MASS[SPECIES.index(s.lines.species)]),
        )
        for s in spreaders
    ]


def test_spectrum_agrees_with_the_direct_sum_in_every_window(grid, spreaders, gas_state):
    spectrum = sum(spread(s, *state) for s, state in zip(spreaders, gas_state, strict=True)) / grid.wavenumber
    for centre, half_width in WINDOWS:
        window = np.flatnonzero(np.abs(grid.wavelength * 1e9 - centre) < half_width)
        exact = sum(
            direct_sum(s.lines, grid.wavenumber[window], *state)
            for s, state in zip(spreaders, gas_state, strict=True)
        )
        error = spectrum[window] - exact
        assert np.sqrt(np.mean(error**2)) < CLOSE_RMS * exact.max(), centre
        assert error.sum() == pytest.approx(0, abs=INTEGRAL_RTOL * exact.sum()), centre


def many_lines(count=20_000):
    """A dense band of equal widths, as molecules have: positions and strengths without order."""
    k = np.arange(count)
    wavenumber = 1 / (780e-9 + 40e-9 * ((k * 0.6180339887) % 1))
    return LineList(
        component="band",
        species="N2",
        wavenumber=wavenumber,
        upper_energy=wavenumber + 5e6,
        lower_energy=np.full(count, 5e6),
        upper_degeneracy=1 + k % 7,
        lower_degeneracy=1.0,
        einstein_a=1e4 * (1 + k % 11),
        van_der_waals_hwhm=2e-24,
    )


# [m-1] of 20 000 lines; sigma is 5 m-1. Widths of one list and of several systems, small and great.
BAND_WIDTHS = {
    "one, small": 0.1,
    "nearly one, small": 0.1 * (1 + 0.004 * np.sin(np.arange(20_000))),
    "several, small": 0.1 * (1 + np.arange(20_000) % 7 / 15),
    "one, great": 5.0,
    "several, great": 5.0 * (1 + np.arange(20_000) % 7 / 6),
}


@pytest.mark.parametrize("widths", BAND_WIDTHS)
def test_dense_band_at_the_coarsest_grid_allowed_stays_within_the_bar(widths):
    lines, sigma, hwhm = many_lines(), 4e-6, np.broadcast_to(BAND_WIDTHS[widths], 20_000)
    grid = log_grid((770e-9, 830e-9), points_for((770e-9, 830e-9), sigma))
    require_resolution(grid, sigma, "band")
    strength = lines.einstein_a * lines.upper_degeneracy
    spectrum = spread(prepare(lines, grid), strength, hwhm, sigma) / grid.wavenumber
    for centre in (773.0, 780.0, 790.0, 801.0, 829.0):
        window = np.flatnonzero(np.abs(grid.wavelength * 1e9 - centre) < 0.1)
        exact = direct_sum(lines, grid.wavenumber[window], strength, hwhm, sigma)
        error = spectrum[window] - exact
        # Beyond the ends of the band only wings remain, 1e-5 of its peak, on which the coarsest grid ripples.
        peak = exact.max() if 779 < centre < 821 else spectrum.max()
        assert np.sqrt(np.mean(error**2)) < RMS * peak
        assert error.sum() == pytest.approx(0, abs=INTEGRAL_RTOL * exact.sum())


def test_integral_over_the_grid_is_the_sum_of_the_strengths(grid):
    lines = many_lines()
    strength = lines.einstein_a * lines.upper_degeneracy
    profile = spread(prepare(lines, grid), strength, np.full(len(lines), 0.1), 5e-6)
    beyond = 0.1 * 8e-7 / np.pi * (1 / 0.1 + 1 / 0.36)  # share of the Lorentz wings outside the grid
    assert profile.sum() * grid.step == pytest.approx(strength.sum(), rel=2 * beyond, abs=0)
    assert profile.sum() * grid.step < strength.sum()


def test_spectrum_is_linear_in_the_strengths(grid, spreaders, gas_state):
    strength, hwhm, sigma = gas_state[0]
    even = np.where(np.arange(len(strength)) % 2, strength, 0)
    parts = spread(spreaders[0], even, hwhm, sigma) + spread(spreaders[0], strength - even, hwhm, sigma)
    whole = spread(spreaders[0], strength, hwhm, sigma)
    assert parts == pytest.approx(whole, abs=1e-12 * whole.max())


def test_equal_widths_take_the_same_way_as_slightly_different_ones(grid, spreaders, gas_state):
    strength, hwhm, sigma = gas_state[1]
    relative = np.full(len(strength), 3e-7)
    wavenumber = spreaders[1].lines.wavenumber
    equal = spread(spreaders[1], strength, relative * wavenumber, sigma)
    uneven = spread(
        spreaders[1], strength, relative * (1 + 1e-9 * np.arange(len(strength))) * wavenumber, sigma
    )
    assert uneven == pytest.approx(equal, rel=1e-5, abs=0)


def test_grid_too_coarse_is_refused_with_the_number_that_does():
    sigma = 5e-6
    with pytest.raises(ValueError, match=r"grid points must be >= 107801 for N2 1P") as fault:
        require_resolution(log_grid(RANGE, 50_000), sigma, "N2 1P")
    assert "got 50000" in str(fault.value)
    require_resolution(log_grid(RANGE, 107_801), sigma, "N2 1P")
    with pytest.raises(ValueError):
        require_resolution(log_grid(RANGE, 107_800), sigma, "N2 1P")


@pytest.mark.parametrize("bad", [(1e-6, 7e-7), (0.0, 1e-6), (np.nan, 1e-6)])
def test_bad_ranges_are_refused(bad):
    with pytest.raises(ValueError, match="wavelength_range must"):
        log_grid(bad, 1000)


@pytest.mark.parametrize("points", [3, 100.5])
def test_bad_point_numbers_are_refused(points):
    with pytest.raises(ValueError, match="grid points must be a whole number >= 16"):
        log_grid(RANGE, points)


def test_a_list_without_lines_on_the_grid_is_refused(atoms):
    with pytest.raises(ValueError, match="no line of O I within"):
        prepare(atoms[1], log_grid((800.5e-9, 801e-9), 1000))
