"""Band strengths, weights and the choice of lines that are strong enough."""

import numpy as np
import pytest

from plasmapyro.radiation.diatomic_lines import (
    EINSTEIN_FACTOR,
    STEPS,
    emission_weights,
    strong_enough,
    transition_lines,
)
from plasmapyro.radiation.diatomic_rotation import ElectronicState, rotational_levels

FLOAT_RTOL = 1e-10  # sums of some hundred lines
ORIGIN = 1.2e6  # [m-1]
MOMENT = 0.15  # [e a0]
MOMENTUM = np.arange(60)
WIDE = (1e5, 1e7)  # [m-1]
PI = ElectronicState(1, 1.0, 1, "g", 4224.0)
SIGMA = ElectronicState(0, 1.0, 1, "u", 0.0, -133.0)


def levels(state, origin, b, half=0.0):
    number = np.arange(len(MOMENTUM) + 3)
    term = origin + b * (number * (number + 1.0))[None]
    return rotational_levels(state, MOMENTUM + half, term, np.ones_like(term, dtype=bool))


def pi_sigma(wavenumber_range=WIDE, moment=MOMENT):
    return transition_lines(levels(PI, ORIGIN, 160.0), levels(SIGMA, 0.0, 145.0), moment, wavenumber_range, 1)


def test_einstein_factor_is_the_one_of_the_literature():
    """A = 2.0261e-6 sigma^3 R^2 with sigma in cm-1 (C. Laux, C. Kruger, JQSRT 48 (1992) 9)."""
    assert EINSTEIN_FACTOR * 1e6 == pytest.approx(2.0261e-6, rel=5e-5, abs=0)


def test_lines_are_sorted_lie_in_the_range_and_close_their_energies():
    lines = pi_sigma((1.19e6, 1.21e6))
    assert (np.diff(lines["wavenumber"]) >= 0).all()
    assert 1.19e6 <= lines["wavenumber"][0] and lines["wavenumber"][-1] <= 1.21e6
    np.testing.assert_allclose(lines["upper_energy"] - lines["lower_energy"], lines["wavenumber"], rtol=1e-12)
    assert len(lines["wavenumber"]) < len(pi_sigma()["wavenumber"])


def test_every_one_of_the_27_branches_is_there():
    lines = pi_sigma()
    step = lines["upper_j"] - lines["lower_j"]
    branches = set(zip(step, lines["upper_component"], lines["lower_component"], strict=True))
    assert len(branches) == 27


def test_a_level_of_each_parity_decays_at_the_rate_of_its_band():
    """Cubes of the wavenumbers taken out, the lines of one upper level add to K R^2, whatever its J and F."""
    lines = pi_sigma()
    reduced = lines["einstein_a"] / lines["wavenumber"] ** 3
    symmetric = lines["upper_degeneracy"] / (2 * lines["upper_j"] + 1) > 0.5
    for j in (0, 1, 2, 17, 40):
        for component in range(min(3, j + 1)):
            own = (lines["upper_j"] == j) & (lines["upper_component"] == component)
            for kind in (symmetric, ~symmetric):
                total = reduced[own & kind].sum()
                assert total == pytest.approx(EINSTEIN_FACTOR * MOMENT**2, rel=FLOAT_RTOL, abs=0)


def test_weights_conserve_the_nuclear_symmetry_and_add_up_to_one_per_pair():
    lines = pi_sigma()
    upper = lines["upper_degeneracy"] / (2 * lines["upper_j"] + 1)
    lower = lines["lower_degeneracy"] / (2 * lines["lower_j"] + 1)
    np.testing.assert_allclose(upper, lower, rtol=1e-12)
    assert set(np.round(upper, 9)) == {round(1 / 3, 9), round(2 / 3, 9)}


def test_odd_n_of_the_lower_state_is_the_strong_one():
    """A3Sigma_u+ of nitrogen: odd N has weight 6, even N 3; F2 has N = J."""
    lines = pi_sigma()
    middle = lines["lower_component"] == 1
    weight = lines["lower_degeneracy"][middle] / (2 * lines["lower_j"][middle] + 1)
    np.testing.assert_allclose(weight, np.where(lines["lower_j"][middle] % 2 == 1, 2 / 3, 1 / 3))


def test_emission_of_a_band_is_population_times_probability_times_photon():
    """Six substates over two for equal nuclei, each level decaying at the rate of its band."""
    temperature = 3000.0
    lines = pi_sigma()
    boltzmann = np.exp(-1.438776877e-2 * (lines["upper_energy"] - ORIGIN) / temperature)
    reduced = lines["upper_degeneracy"] * lines["einstein_a"] / lines["wavenumber"] ** 3 * boltzmann
    number = np.arange(1, len(MOMENTUM))
    # Half of 2 x 3 (2N + 1) levels: equal nuclei. Spin-orbit splitting averages out to second order.
    population = 3 * np.sum(
        (2 * number + 1) * np.exp(-1.438776877e-2 * 160.0 * number * (number + 1) / temperature)
    )
    expected = population * EINSTEIN_FACTOR * MOMENT**2
    assert reduced.sum() == pytest.approx(expected, rel=0.01)


def test_moments_are_taken_by_branch_and_rotation():
    moment = np.zeros((3, 1, 1, len(MOMENTUM)))
    moment[STEPS.index(-1), :, :, 7] = MOMENT
    lines = pi_sigma(moment=moment)
    emitting = lines["einstein_a"] > 0
    assert set(lines["lower_j"][emitting]) == {7} and set(lines["upper_j"][emitting]) == {6}


def test_sigma_to_pi_counts_both_orientations_of_the_lower_state():
    """Absorption and emission see the same moment: A g' of the whole band is that of the mirrored one."""
    pi, sigma = ElectronicState(1, 0.5, 1, "", 100.0), ElectronicState(0, 0.5, 1, "")
    down = transition_lines(levels(pi, ORIGIN, 160.0, 0.5), levels(sigma, 0.0, 160.0, 0.5), MOMENT, WIDE, 0)
    up = transition_lines(levels(sigma, ORIGIN, 160.0, 0.5), levels(pi, 0.0, 160.0, 0.5), MOMENT, WIDE, 0)

    def rate(lines):
        inner = (lines["upper_j"] < 40) & (lines["lower_j"] < 40)
        reduced = lines["upper_degeneracy"] * lines["einstein_a"] / lines["wavenumber"] ** 3
        return reduced[inner].sum() / EINSTEIN_FACTOR / MOMENT**2

    assert rate(up) == pytest.approx(rate(down), rel=1e-6)


def test_pi_to_pi_lines_carry_the_weight_of_both_parities():
    for inversion, weight in (("g", 1.0), ("", 2.0)):
        upper, lower = (ElectronicState(1, 0.5, 1, inversion, 100.0) for _ in range(2))
        lines = transition_lines(
            levels(upper, ORIGIN, 160.0, 0.5), levels(lower, 0.0, 145.0, 0.5), MOMENT, WIDE, 1
        )
        np.testing.assert_allclose(lines["upper_degeneracy"], weight * (2 * lines["upper_j"] + 1))


def test_a_range_without_lines_gives_an_empty_list():
    assert all(len(column) == 0 for column in pi_sigma((5e6, 6e6)).values())


@pytest.mark.parametrize("lost", [1e-2, 1e-4])
def test_dropped_lines_carry_no_more_than_stated(lost):
    lines = pi_sigma()
    temperatures = (500.0, 3000.0)
    keep = strong_enough(lines, temperatures, lost)
    assert not keep.all()
    for temperature in temperatures:
        weight = emission_weights(lines, temperature)
        assert weight.sum() == pytest.approx(1.0)
        assert weight[~keep].sum() <= lost


def test_bad_requests_are_refused():
    with pytest.raises(ValueError, match="wavenumber_range must increase strictly"):
        pi_sigma((2e6, 1e6))
    with pytest.raises(ValueError, match=r"lost_fraction must lie in \(0, 1\]; got 0"):
        strong_enough(pi_sigma(), (300.0,), 0.0)
    with pytest.raises(ValueError, match="temperature must be > 0 K"):
        emission_weights(pi_sigma(), -1.0)
