"""N2 first positive against published lifetimes, probabilities, band heads and band-level sums."""

from pathlib import Path

import numpy as np
import pytest

from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.partition import partition_function
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.band_systems import SYSTEMS, reduced_mass
from plasmapyro.radiation.diatomic_curves import kinetic_factor, potential_curve, vibrational_states
from plasmapyro.radiation.diatomic_lines import EINSTEIN_FACTOR, emission_weights, strong_enough
from plasmapyro.radiation.diatomic_states import (
    HIGHEST_ROTATION,
    RADIUS,
    rovibration,
    state_constants,
    transition_moments,
)

REFERENCE = Path(__file__).resolve().parents[1] / "reference"
PLANCK, LIGHT, BOLTZMANN = 6.62607015e-34, 299792458.0, 1.380649e-23
SECOND = PLANCK * LIGHT / BOLTZMANN
RANGE = (1 / 1250e-9, 1 / 650e-9)
FIRST_POSITIVE, MASS = SYSTEMS["N2 1P"], reduced_mass("N2")
TEMPERATURES = (3000.0, 5000.0, 7000.0, 10000.0)
LOST = 1e-4
LIFETIME_RTOL = 0.02  # the published ones are sums of published strengths, each given to three digits
HEAD_TOLERANCE = 1.1  # [Angstrom]; the 0-0 head is quoted to 1 Angstrom, Lambda doubling (1 cm-1) is left out
LEVEL_TOLERANCE = 100.0  # [m-1], 1 cm-1: first order of WKB and constants fitted to 1 cm-1
PARTITION_RTOL = 1e-3  # at 10000 K; the two sums treat quasi-bound levels and stretching differently
SANITY = 0.10  # of the rough band-level estimate


def reference(name):
    return np.loadtxt(REFERENCE / f"nitrogen_first_positive_{name}.csv", delimiter=",", skiprows=1)


def constants(name):
    return state_constants("gas/diatomic_nitrogen", "N2", name)


def states(name, highest, count):
    return rovibration(constants(name), MASS, highest, count)


def first_positive_states():
    return [FIRST_POSITIVE.levels(state)[1] for state in (FIRST_POSITIVE.upper, FIRST_POSITIVE.lower)]


@pytest.fixture(scope="module")
def full():
    return FIRST_POSITIVE.lines(RANGE)


@pytest.fixture(scope="module")
def listed():
    return FIRST_POSITIVE.line_list(RANGE, lost_fraction=LOST, reference_temperature=TEMPERATURES)


@pytest.fixture(scope="module")
def bands():
    """Terms (v, N), moments (v', v'', N) of the Q type and overlaps of the rotationless levels."""
    (upper, upper_wave, bound), (lower, lower_wave, _) = first_positive_states()
    moment = transition_moments(upper_wave, lower_wave, FIRST_POSITIVE.moments(RADIUS))
    overlap = transition_moments(upper_wave, lower_wave, np.ones(RADIUS.size))
    return {
        "upper": upper,
        "lower": lower,
        "bound": bound,
        "moment": moment[1],
        "overlap": overlap[1, :, :, 0],
        "einstein": EINSTEIN_FACTOR
        * np.maximum(upper[:, None, 0] - lower[None, :, 0], 0) ** 3
        * moment[1, :, :, 0] ** 2,
    }


def air_angstrom(wavenumber):
    """B. Edlen, Metrologia 2 (1966) 71, standard air; written here, the package works in vacuum."""
    square = (1e-6 * wavenumber) ** 2
    index = 1 + 1e-8 * (8342.13 + 2406030 / (130 - square) + 15997 / (38.9 - square))
    return 1e10 / wavenumber / index


def test_origin_of_the_zero_zero_band():
    """R. R. Laher, F. R. Gilmore (1991): 59306.8 - 49754.8 cm-1."""
    (upper, _, _), (lower, _, _) = first_positive_states()
    assert upper[0, 0] - lower[0, 0] == pytest.approx(955200.0, abs=1e-3)


@pytest.mark.parametrize("name, highest", [("A3Sigma_u+", 20), ("B3Pi_g", 21)])
def test_term_values_follow_the_constants_as_far_as_these_hold(name, highest):
    term, _, _ = states(name, highest, highest + 1)
    values = constants(name)
    x = np.arange(highest + 1) + 0.5
    ladder = sum(value * (x ** (k + 1) - 0.5 ** (k + 1)) for k, value in enumerate(values["vibration"]))
    np.testing.assert_allclose(term[:, 0] - values["origin"], ladder, atol=1e-3)
    rotation = sum(value * x**k for k, value in enumerate(values["rotation"]))
    # The potential at N = 1; near the end of the constants WKB and fit part by 0.3 %.
    np.testing.assert_allclose((term[:, 1] - term[:, 0]) / 2, rotation, rtol=3e-3)


def test_curves_carry_the_levels_of_the_constants_within_one_wavenumber():
    for name, highest, observed in (("A3Sigma_u+", 20, 14), ("B3Pi_g", 21, 20)):
        values = constants(name)
        ladder = np.polynomial.Polynomial([0.0, *values["vibration"]])
        depth = values["limit"] - values["origin"] + ladder(0.5)
        potential = potential_curve(RADIUS, values["vibration"], values["rotation"], MASS, highest, depth)
        energy, _, _ = vibrational_states(RADIUS, potential, MASS, [0], observed)
        np.testing.assert_allclose(energy[0], ladder(np.arange(observed) + 0.5), rtol=0, atol=LEVEL_TOLERANCE)


@pytest.mark.parametrize("name", ["B3Pi_g", "A3Sigma_u+"])
def test_centrifugal_stretching_is_that_of_kratzer(name):
    """D = 4 B^3 / we^2 (Herzberg, Spectra of Diatomic Molecules, III,118), for v = 0 within 2 %."""
    values = constants(name)
    term, _, _ = states(name, 20, 1)
    turns = np.array([20 * 21.0, 40 * 41.0])
    ratio = (term[0, [20, 40]] - term[0, 0]) / turns
    stretching = (ratio[0] - ratio[1]) / (turns[1] - turns[0])
    assert stretching == pytest.approx(4 * values["be"] ** 3 / values["we"] ** 2, rel=0.02)


def test_lifetimes_of_b(full):
    """C. O. Laux, C. H. Kruger, JQSRT 48 (1992) 9 [us], v' = 0 ... 12."""
    published = [13.48, 11.01, 9.39, 8.27, 7.45, 6.83, 6.36, 5.98, 5.69, 5.47, 5.30, 5.17, 5.09]
    _, decay = full
    np.testing.assert_allclose(1e6 / decay[:13], published, rtol=LIFETIME_RTOL)


def test_franck_condon_factors(bands):
    table = reference("laux")
    found = bands["overlap"][table[:, 0].astype(int), table[:, 1].astype(int)] ** 2
    np.testing.assert_allclose(found, table[:, 2], atol=0.004)
    assert 0.398 <= bands["overlap"][0, 0] ** 2 <= 0.401
    assert bands["overlap"][1, 0] ** 2 == pytest.approx(0.400, abs=1e-3)


def test_band_strengths(bands):
    table = reference("laux")
    found = 6 * bands["moment"][table[:, 0].astype(int), table[:, 1].astype(int), 0] ** 2
    for faintest, tolerance in ((0.03, 0.015), (0.01, 0.04), (0.003, 0.08)):  # cancellation in the weak ones
        strong = table[:, 3] > faintest
        np.testing.assert_allclose(found[strong], table[strong, 3], rtol=tolerance)


def test_einstein_coefficients(bands):
    published = {
        (0, 0): 4.27e4,
        (1, 0): 6.50e4,
        (2, 0): 3.68e4,
        (2, 1): 4.62e4,
        (3, 1): 6.45e4,
        (4, 2): 7.06e4,
        (5, 3): 5.89e4,
        (0, 1): 2.30e4,
    }
    for band, value in published.items():
        assert bands["einstein"][band] == pytest.approx(value, rel=0.02)
    assert bands["einstein"][1, 1] < 350.0  # near-null band, 2.5e2 published


def test_red_heads_stand_where_pearse_and_gaydon_saw_them(full):
    lines, _ = full
    main = (lines["upper_component"] == 0) & (lines["lower_component"] == 0)
    main &= (lines["lower_j"] - lines["upper_j"] == 1) & (lines["upper_j"] < 40)
    for upper, lower, head in reference("heads"):
        band = main & (lines["upper_v"] == upper) & (lines["lower_v"] == lower)
        assert air_angstrom(lines["wavenumber"][band]).max() == pytest.approx(head, abs=HEAD_TOLERANCE)


def test_heads_are_not_shifted_as_a_whole(full):
    """A shift of the rotational origin by B Lambda^2 (1.6 cm-1) would move all heads by more than 0.8 A."""
    lines, _ = full
    main = (lines["upper_component"] == 0) & (lines["lower_component"] == 0)
    main &= (lines["lower_j"] - lines["upper_j"] == 1) & (lines["upper_j"] < 40)
    shift = [
        air_angstrom(lines["wavenumber"][main & (lines["upper_v"] == u) & (lines["lower_v"] == w)]).max()
        - head
        for u, w, head in reference("heads")
    ]
    assert abs(np.median(shift)) < 0.3


def test_list_is_what_the_engine_asks_for(listed):
    assert (listed.component, listed.species, listed.origin) == ("N2 1P", "N2", "published")
    assert (np.diff(listed.wavenumber) >= 0).all()
    assert RANGE[0] <= listed.wavenumber[0] and listed.wavenumber[-1] <= RANGE[1]
    assert 1e5 < len(listed) < 4e5
    # Above the ground level: B lies at 59307 cm-1 less half its spin-orbit splitting, A at 49755.
    assert listed.upper_energy.min() == pytest.approx(59306.8e2, abs=60e2)
    assert 49754.8e2 - 1e2 < listed.lower_energy.min() < 49754.8e2 + 300e2


def test_two_lists_are_equal_to_the_last_bit(listed):
    again = FIRST_POSITIVE.line_list(RANGE, lost_fraction=LOST, reference_temperature=TEMPERATURES)
    for name in ("wavenumber", "einstein_a", "upper_energy", "natural_hwhm"):
        assert getattr(again, name).tobytes() == getattr(listed, name).tobytes()


@pytest.mark.parametrize("temperature", [3000.0, 4000.0, 6000.0, 8500.0, 10000.0])
def test_lost_emission_stays_below_its_bound_between_the_reference_temperatures(full, temperature):
    lines, _ = full
    keep = strong_enough(lines, TEMPERATURES, LOST)
    assert emission_weights(lines, temperature)[~keep].sum() < LOST


def test_rotation_is_followed_far_enough(full):
    lines, _ = full
    weight = emission_weights(lines, 10000.0)
    assert weight[lines["upper_j"] > HIGHEST_ROTATION - 10].sum() < 1e-4
    assert weight[lines["upper_v"] > 12].sum() < 0.03  # levels that would predissociate in the cold


def radiance_of(listed, temperature, window, density=1.0):
    """Emission coefficient integrated over a window [W m-3 sr-1]."""
    inside = (listed.wavenumber > window[0]) & (listed.wavenumber < window[1])
    upper = listed.upper_degeneracy * np.exp(-SECOND * listed.upper_energy / temperature)
    power = (upper * listed.einstein_a * PLANCK * LIGHT * listed.wavenumber)[inside].sum() / (4 * np.pi)
    return density * power / partition_function("N2", temperature)


WINDOW = (1 / 1.2e-6, 1 / 0.7e-6)


@pytest.mark.parametrize("temperature", [3000.0, 8000.0])
def test_emission_of_the_list_is_the_sum_over_vibration_and_rotation(listed, bands, temperature):
    """Without spin: 6 (2N+1) / 2 states of B at E_v(N), each decaying into A at equal N."""
    number = np.arange(1, 201)
    wavenumber = bands["upper"][:, None, number] - bands["lower"][None, :, number]
    population = 3 * (2 * number + 1) * np.exp(-SECOND * bands["upper"][:, number] / temperature)
    power = (population * bands["bound"][:, number])[:, None] * EINSTEIN_FACTOR * PLANCK * LIGHT
    power = power * np.maximum(wavenumber, 0) ** 4 * bands["moment"][:, :, number] ** 2
    power = power[(wavenumber > WINDOW[0]) & (wavenumber < WINDOW[1])].sum() / (4 * np.pi)
    expected = power / partition_function("N2", temperature)
    assert radiance_of(listed, temperature, WINDOW) == pytest.approx(expected, rel=0.01, abs=0)


@pytest.mark.parametrize(
    "temperature, estimate",
    [(5000.0, 18.22), (6000.0, 111.9), (7000.0, 93.41), (8000.0, 44.97), (9000.0, 20.95), (10000.0, 8.821)],
)
def test_emission_of_air_at_fifty_millibar(listed, bands, temperature, estimate):
    """Rough estimate n_v' A_v'v'' h c sigma of the rotationless bands [W m-3 sr-1].

    The lines of hot molecules lie to the blue of the origins and radiate as the fourth power of their
    wavenumber, which the estimate leaves out: the list must exceed it by 12 to 22 %.
    """
    density = number_density(temperature, 5000.0)[SPECIES.index("N2")]
    number = np.arange(1, 201)
    origin = bands["upper"][:, None, 0] - bands["lower"][None, :, 0]
    population = 3 * (2 * number + 1) * np.exp(-SECOND * bands["upper"][:, number] / temperature)
    population = (population * bands["bound"][:, number]).sum(axis=1) / partition_function("N2", temperature)
    inside = (origin > WINDOW[0]) & (origin < WINDOW[1])
    power = population[:, None] * bands["einstein"] * PLANCK * LIGHT * origin * inside
    rotationless = density * power.sum() / (4 * np.pi)
    assert rotationless == pytest.approx(estimate, rel=SANITY)
    assert 1.12 < radiance_of(listed, temperature, WINDOW, density) / rotationless < 1.22


def test_lines_from_odd_n_of_the_lower_state_are_the_strong_ones(full):
    """14N has spin 1: levels of A3Sigma_u+ weigh 6 of 9 for odd N, 3 for even N; F2 has N = J."""
    lines, _ = full
    middle = lines["lower_component"] == 1
    weight = lines["lower_degeneracy"][middle] / (2 * lines["lower_j"][middle] + 1)
    np.testing.assert_allclose(weight, np.where(lines["lower_j"][middle] % 2 == 1, 2 / 3, 1 / 3), rtol=1e-12)


def test_fine_structure_of_the_lower_state_has_its_sign(full):
    """A3Sigma_u+, N = 1, lies at 2B; J = 1 displaced by 2/3, J = 0 by -4/3 of lambda = -1.33."""
    lines, _ = full
    middle = 49754.8e2 + 2 * (1.45499e2 - 0.018385e2 / 2)
    for j, component, displacement in ((1, 1, -0.887e2), (0, 0, 1.773e2)):
        own = (lines["lower_v"] == 0) & (lines["lower_j"] == j) & (lines["lower_component"] == component)
        assert np.unique(lines["lower_energy"][own]) == pytest.approx([middle + displacement], abs=2.0)


def test_partition_function_of_nitrogen_counts_from_the_same_zero():
    """Own rovibronic sum: DVR levels of the eight states below 90000 cm-1, spin splitting left out."""
    temperature = np.array([1000.0, 3000.0, 6000.0, 10000.0])
    total = np.zeros(temperature.shape)
    electronic = {  # name: (electronic weight, Lambda, last v of the constants)
        "X1Sigma_g+": (1, 0, 20),
        "A3Sigma_u+": (3, 0, 20),
        "B3Pi_g": (6, 1, 20),
        "W3Delta_u": (6, 2, 20),
        "Bp3Sigma_u-": (3, 0, 15),
        "ap1Sigma_u-": (1, 0, 15),
        "a1Pi_g": (2, 1, 15),
        "w1Delta_u": (2, 2, 15),
    }
    for name, (weight, orbital, highest) in electronic.items():
        term, _, bound = states(name, highest, 50)
        number = np.arange(term.shape[1])
        level = weight / 2 * (2 * number + 1) * (bound & (number >= orbital))
        total += (level * np.exp(-SECOND * term / temperature[:, None, None])).sum(axis=(1, 2))
    np.testing.assert_allclose(partition_function("N2", temperature), total, rtol=PARTITION_RTOL)


def test_widths_are_those_of_the_lifetime_and_of_the_assumed_collisions(listed):
    """A lifetime of 13.48 us is a half width of 1 / (4 pi c tau); v' = 9 lives 5.47 us."""
    longest, shortest = 1 / (4 * np.pi * LIGHT * 13.48e-6), 1 / (4 * np.pi * LIGHT * 5.0e-6)
    assert listed.natural_hwhm.min() == pytest.approx(longest, rel=LIFETIME_RTOL)
    assert listed.natural_hwhm.max() == pytest.approx(shortest, rel=LIFETIME_RTOL)
    density = 101325.0 / (BOLTZMANN * 296.0)
    hwhm = listed.van_der_waals_hwhm * density * (296.0 / 1e4) ** 0.3
    np.testing.assert_allclose(hwhm, 5.0, rtol=1e-9)  # 0.05 cm-1 at one atmosphere


def test_rotation_changes_the_moment_as_first_order_perturbation_says(bands):
    """Mixing of vibrational levels by k N(N+1) / r^2, over the levels of N = 0 (Herman & Wallis, 1955)."""
    turns = 10 * 11.0
    inverse_square = kinetic_factor(MASS) / RADIUS**2
    moment, slope = bands["moment"][:, :, 0], 0.0
    for name, highest, count, axis in (("B3Pi_g", 21, 22, 0), ("A3Sigma_u+", 20, 30, 1)):
        term, wave, _ = states(name, highest, count)
        coupling = wave[0].T @ (inverse_square[:, None] * wave[0])
        gap = term[:, None, 0] - term[None, :, 0]
        mixing = coupling / np.where(gap == 0, np.inf, gap)
        slope = slope + (mixing @ moment if axis == 0 else moment @ mixing.T)
    for band in ((0, 0), (1, 0), (2, 1), (1, 1)):
        sign = np.sign(bands["moment"][*band, 10] * moment[band])  # each eigenvector has a sign of its own
        change = sign * bands["moment"][*band, 10] - moment[band]
        assert change == pytest.approx(slope[band] * turns, rel=0.03)


def test_moments_join_rotations_of_upper_and_lower_state():
    """P, Q and R moments differ: with one basis function per N, N' = N'' + step picks its own amplitude."""
    upper = np.arange(1.0, 6.0)[:, None, None] * np.ones((5, 3, 2))
    lower = np.ones((5, 3, 4))
    found = transition_moments(upper, lower, np.array([1.0, 2.0, 3.0]))
    assert found.shape == (3, 2, 4, 5)
    np.testing.assert_allclose(
        found[:, 1, 2, :], 6 * np.array([[0, 1, 2, 3, 4], [1, 2, 3, 4, 5], [2, 3, 4, 5, 0]])
    )
