"""Multiplet structure and line strengths against the closed formulae of the textbooks."""

import numpy as np
import pytest

from plasmapyro.radiation.diatomic_lines import nuclear_weight, photon_coupling, rotational_shares
from plasmapyro.radiation.diatomic_rotation import ElectronicState, clebsch_gordan, parity, rotational_levels

FLOAT_RTOL = 1e-12  # ~ 5000 eps: eigenvalues of 3x3 matrices
B, D = 160.0, 6e-4  # [m-1], like N2
CASES = {
    "3Pi-3Sigma+": (ElectronicState(1, 1.0, 1, "g", 4224.0), ElectronicState(0, 1.0, 1, "u", 0.0, -133.0)),
    "3Sigma- -3Pi": (ElectronicState(0, 1.0, -1, "u", 0.0, 200.0), ElectronicState(1, 1.0, 1, "g", -900.0)),
    "2Pi-2Sigma+": (ElectronicState(1, 0.5, 1, "u", -7462.0), ElectronicState(0, 0.5, 1, "g")),
    "2Sigma+-2Sigma+": (ElectronicState(0, 0.5, 1, ""), ElectronicState(0, 0.5, 1, "")),
    "2Pi-2Pi": (ElectronicState(1, 0.5, 1, "", 3000.0), ElectronicState(1, 0.5, 1, "", 12300.0)),
    "1Pi-1Sigma+": (ElectronicState(1, 0.0, 1, "u"), ElectronicState(0, 0.0, 1, "g")),
}


def levels(state, count=40, b=B, d=D):
    number = np.arange(count + 4)
    turns = number * (number + 1.0)
    term = (b * turns - d * turns**2)[None]
    momentum = np.arange(count) + state.spin % 1
    return rotational_levels(state, momentum, term, np.ones_like(term, dtype=bool))


def test_without_fine_structure_the_levels_are_those_of_case_b_stretching_included():
    for spin, orbital in ((0.5, 0), (0.5, 1), (1.0, 0), (1.0, 1), (2.0, 0)):
        built = levels(ElectronicState(orbital, spin, 1, ""))
        number = built.quantum_number[10:, None] - spin + np.arange(2 * spin + 1)
        turns = number * (number + 1)
        np.testing.assert_allclose(built.energy[0, 10:], B * turns - D * turns**2, rtol=FLOAT_RTOL)


@pytest.mark.parametrize("spin_orbit", [-7462.0, 300.0, 12300.0])
def test_doublet_pi_levels_follow_hill_and_van_vleck(spin_orbit):
    """E. L. Hill, J. H. Van Vleck, Phys. Rev. 32 (1928) 250, with N^2 = R^2 + Lambda^2."""
    built = levels(ElectronicState(1, 0.5, 1, "", spin_orbit), d=0.0)
    half = built.quantum_number[1:] + 0.5
    ratio = spin_orbit / B
    root = np.sqrt(4 * half**2 + ratio * (ratio - 4)) / 2
    expected = B * np.stack([half**2 - root, half**2 + root], axis=1)
    np.testing.assert_allclose(built.energy[0, 1:], expected, rtol=1e-10)


@pytest.mark.parametrize("spin_spin", [-133.0, 200.0])
def test_triplet_sigma_splitting_follows_schlapp(spin_spin):
    """R. Schlapp, Phys. Rev. 51 (1937) 342: components of one N relative to the middle one."""
    built = levels(ElectronicState(0, 1.0, 1, "", 0.0, spin_spin), d=0.0)
    number = np.arange(2, 30)
    middle = built.energy[0, number, 1]

    def root(k):
        return np.sqrt(k**2 * B**2 + spin_spin**2 - 2 * spin_spin * B)

    first, third = 2 * number + 3, 2 * number - 1
    np.testing.assert_allclose(
        built.energy[0, number + 1, 0] - middle, first * B - spin_spin - root(first), atol=1e-6
    )
    np.testing.assert_allclose(
        built.energy[0, number - 1, 2] - middle, -third * B - spin_spin + root(third), atol=1e-6
    )


def test_triplet_pi_without_rotation_shows_the_spin_orbit_splitting():
    built = levels(ElectronicState(1, 1.0, 1, "", 4224.0), b=1e-3, d=0.0)
    np.testing.assert_allclose(np.diff(built.energy[0, 5]), 4224.0, rtol=1e-4)


def test_levels_that_cannot_exist_are_marked():
    triplet_pi, triplet_sigma = (levels(state) for state in CASES["3Pi-3Sigma+"])
    assert triplet_pi.exists[0, :4].sum(axis=1).tolist() == [1, 2, 3, 3]
    assert triplet_sigma.exists[0, :3].sum(axis=1).tolist() == [1, 3, 3]
    doublet = levels(CASES["2Pi-2Sigma+"][0])
    assert doublet.exists[0, :3].sum(axis=1).tolist() == [1, 2, 2]


def test_an_unbound_term_takes_its_levels_with_it():
    state = ElectronicState(0, 0.5, 1, "")
    number = np.arange(20.0)
    built = rotational_levels(state, np.arange(10) + 0.5, (number * (number + 1))[None], (number < 6)[None])
    np.testing.assert_array_equal(built.exists[0].all(axis=1), np.arange(10) + 1 < 6)


def test_parity_of_sigma_states_alternates_with_n():
    for reflection in (1, -1):
        built = levels(ElectronicState(0, 1.0, reflection, "", 0.0, 100.0))
        number = np.arange(5, 30)
        for component, offset in ((0, 1), (1, 0), (2, -1)):  # F1: J = N + 1, F2: J = N, F3: J = N - 1
            found = parity(built)[0, number + offset, component]
            np.testing.assert_array_equal(found, reflection * (-1.0) ** number)
    built = levels(ElectronicState(0, 0.5, 1, ""))
    number = np.arange(1, 30)
    np.testing.assert_array_equal(parity(built)[0, number, 0], (-1.0) ** number)  # J = N + 1/2
    np.testing.assert_array_equal(parity(built)[0, number - 1, 1], (-1.0) ** number)  # J = N - 1/2


@pytest.mark.parametrize("component", [-1, 0, 1])
@pytest.mark.parametrize("momentum", [0.5, 1.0, 2.0, 7.5])
def test_clebsch_gordan_coefficients_form_an_orthogonal_matrix(component, momentum):
    for below in np.arange(-momentum, momentum + 1):
        row = [clebsch_gordan(momentum, step, below + component, component) for step in (-1, 0, 1)]
        assert np.sum(np.square(row)) == pytest.approx(1.0, rel=FLOAT_RTOL)
        for other in (-1, 0, 1):
            if other != component and abs(below + component - other) <= momentum:
                column = [clebsch_gordan(momentum, step, below + component, other) for step in (-1, 0, 1)]
                assert np.dot(row, column) == pytest.approx(0.0, abs=FLOAT_RTOL)


def shares(case, step, count=40):
    upper, lower = CASES[case]
    high, low = levels(upper, count), levels(lower, count, b=145.0)
    momentum = low.quantum_number
    coupling = photon_coupling(upper, lower, momentum, step)
    found = rotational_shares(upper, high.vector[0], lower, low.vector[0], momentum, step, coupling)
    return high, low, found


def total_share(case, visible=lambda high, low, step: 1.0):
    """Sum of the shares of each upper level (J', F'), over the lower levels that `visible` admits."""
    total = 0.0
    for step in (-1, 0, 1):
        high, low, found = shares(case, step)
        partner = np.roll(found * visible(high, low, step), step, axis=0)
        total = total + partner.sum(axis=2)
    return high, total


@pytest.mark.parametrize("case", ["3Sigma- -3Pi", "2Sigma+-2Sigma+", "2Pi-2Pi"])
def test_shares_of_an_upper_level_sum_to_one(case):
    high, total = total_share(case)
    inner = slice(0, -2)
    np.testing.assert_allclose(total[inner][high.exists[0][inner]], 1.0, rtol=FLOAT_RTOL)


@pytest.mark.parametrize("case", ["3Pi-3Sigma+", "2Pi-2Sigma+", "1Pi-1Sigma+"])
@pytest.mark.parametrize("sign", [1, -1])
def test_shares_of_each_parity_of_a_pi_level_sum_to_one(case, sign):
    """A Pi level has both parities; each reaches the Sigma levels of the opposite one only."""

    def opposite(high, low, step):
        # e and f levels: the parity of the upper level is sign times (-1)^(J' - 1/2 or J').
        floor = np.floor(low.quantum_number + step)
        return (parity(low)[0] == -sign * (-1.0) ** floor[:, None])[:, None, :]

    high, total = total_share(case, opposite)
    inner = slice(0, -2)
    np.testing.assert_allclose(total[inner][high.exists[0][inner]], 1.0, rtol=FLOAT_RTOL)


def test_singlet_pi_to_sigma_shares_are_those_of_hoenl_and_london():
    """Herzberg, Spectra of Diatomic Molecules, IV,82: R (J'+1), Q (2J'+1), P J' over 2J'+1 per parity."""
    number = np.arange(1, 30)
    upper = {step: number - step for step in (-1, 0, 1)}  # lower J'' for each step
    for step, expected in (
        (1, (number + 1) / (2 * number + 1)),
        (0, np.ones(len(number))),
        (-1, number / (2 * number + 1)),
    ):
        _, _, found = shares("1Pi-1Sigma+", step)
        np.testing.assert_allclose(found[upper[step], 0, 0], expected, rtol=FLOAT_RTOL)


def test_sigma_to_sigma_lines_join_opposite_parities_only():
    for step in (-1, 0, 1):
        high, low, found = shares("2Sigma+-2Sigma+", step)
        above = np.roll(parity(high)[0], -step, axis=0)
        same = above[:, :, None] == parity(low)[0][:, None, :]
        assert found[2:-2][same[2:-2]].max() < FLOAT_RTOL


def test_main_branches_carry_almost_all_at_high_rotation():
    """Delta N = Delta J there: case (b) forgets the spin."""
    _, _, found = shares("3Pi-3Sigma+", 0, count=300)
    assert found[250, [0, 1, 2], [0, 1, 2]] == pytest.approx([1.0] * 3, abs=0.02)


def test_nuclear_weights_of_nitrogen_alternate_two_to_one():
    """N2 X1Sigma_g+: even J weigh 6 of 9, odd J 3 of 9."""
    ground = ElectronicState(0, 0.0, 1, "g")
    built = levels(ground, count=4)
    weight = nuclear_weight(ground, parity(built)[0, :, 0], 1)
    np.testing.assert_allclose(weight, [2 / 3, 1 / 3, 2 / 3, 1 / 3], rtol=FLOAT_RTOL)


def test_oxygen_has_odd_n_only_and_different_nuclei_all():
    ground = ElectronicState(0, 1.0, -1, "g", 0.0, 198.0)
    built = levels(ground, count=30)
    middle = nuclear_weight(ground, parity(built)[0, :, 1], 0)  # F2: N = J
    np.testing.assert_array_equal(middle[1:5], [1.0, 0.0, 1.0, 0.0])
    assert nuclear_weight(ElectronicState(0, 0.5, 1, ""), np.array([1, -1]), 1).tolist() == [1.0, 1.0]
