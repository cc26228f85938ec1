"""N2+ Meinel and NO 11000 Angstrom: origins, symmetry, strengths and emission."""

import numpy as np
import pytest

from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.partition import partition_function
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.band_systems import SYSTEMS, bands, reduced_mass
from plasmapyro.radiation.diatomic_curves import kinetic_factor
from plasmapyro.radiation.diatomic_lines import EINSTEIN_FACTOR, emission_weights, strong_enough
from plasmapyro.radiation.diatomic_states import RADIUS, rovibration, state_constants, transition_moments

PLANCK, LIGHT, BOLTZMANN = 6.62607015e-34, 299792458.0, 1.380649e-23
SECOND = PLANCK * LIGHT / BOLTZMANN
RANGE = (1 / 1250e-9, 1 / 650e-9)
WIDE = (1e5, 5e6)  # [m-1], holds whole systems
TEMPERATURES = (3000.0, 5000.0, 8000.0, 12000.0)
LOST = 1e-4
NAMES = ("N2 1P", "N2+ Meinel", "NO 11000 A")


@pytest.fixture(scope="module")
def lists():
    return {
        name: SYSTEMS[name].line_list(RANGE, lost_fraction=LOST, reference_temperature=TEMPERATURES)
        for name in NAMES
    }


@pytest.fixture(scope="module")
def meinel():
    return SYSTEMS["N2+ Meinel"].lines(WIDE)


@pytest.fixture(scope="module")
def infrared():
    return SYSTEMS["NO 11000 A"].lines(WIDE)


def states(table, species, name, mass, count):
    return rovibration(state_constants(table, species, name), mass, count - 1, count)


def test_lists_carry_their_names_and_count_from_the_ground_level(lists):
    lowest = {"N2 1P": 49754.6e2, "N2+ Meinel": 0.0, "NO 11000 A": 44200.0e2}
    for name, lines in lists.items():
        assert (lines.component, lines.species) == (name, name.split()[0])
        assert lines.lower_energy.min() == pytest.approx(lowest[name], abs=100.0)
        assert (np.diff(lines.wavenumber) >= 0).all()
        assert RANGE[0] <= lines.wavenumber[0] and lines.wavenumber[-1] <= RANGE[1]


def test_origins_of_the_bands():
    """N2+ 0-0: Laher & Gilmore (1991). NO: Te and we of Huber & Herzberg (1979), 0-0 near 11000 Angstrom."""
    upper = states("gas/diatomic_nitrogen", "N2+", "A2Pi_u", reduced_mass("N2"), 1)[0]
    lower = states("gas/diatomic_nitrogen", "N2+", "X2Sigma_g+", reduced_mass("N2"), 1)[0]
    assert upper[0, 0] - lower[0, 0] == pytest.approx(9015.6e2, abs=1.0)
    upper = states("gas/diatomic_oxygen", "NO", "D2Sigma+", reduced_mass("NO"), 6)[0]
    lower = states("gas/diatomic_oxygen", "NO", "A2Sigma+", reduced_mass("NO"), 9)[0]
    assert 1e10 / (upper[0, 0] - lower[0, 0]) == pytest.approx(10998.0, abs=3.0)
    assert lower[0, 0] == pytest.approx(44200.2e2, abs=2e2)  # gamma 0-0, from X2Pi1/2


def test_equilibrium_distances_follow_from_masses_and_rotational_constants():
    """K. P. Huber, G. Herzberg (1979), re [Angstrom]."""
    nitrogen_pair = reduced_mass("N2")
    for table, species, name, mass, published in (
        ("gas/diatomic_nitrogen", "N2", "A3Sigma_u+", nitrogen_pair, 1.2866),
        ("gas/diatomic_nitrogen", "N2", "B3Pi_g", nitrogen_pair, 1.2126),
        ("gas/diatomic_nitrogen", "N2+", "X2Sigma_g+", nitrogen_pair, 1.1164),
        ("gas/diatomic_oxygen", "NO", "A2Sigma+", reduced_mass("NO"), 1.0634),
    ):
        rotation = state_constants(table, species, name)["be"]
        assert 1e10 * np.sqrt(kinetic_factor(mass) / rotation) == pytest.approx(published, abs=5e-4)


def test_meinel_strengths_come_from_one_smooth_moment():
    """Tabulated for v' <= 8 of another author's wave functions, they give R(r) on ours with 2 % scatter."""
    table = bands("molecules/nitrogen_ion_meinel_moment")[1]
    mass = reduced_mass("N2")
    upper = states("gas/diatomic_nitrogen", "N2+", "A2Pi_u", mass, table.shape[0])[1]
    lower = states("gas/diatomic_nitrogen", "N2+", "X2Sigma_g+", mass, table.shape[1])[1]
    powers = np.array(
        [transition_moments(upper[:2], lower[:2], (1e10 * RADIUS - 1.15) ** k)[1, :9, :, 0] for k in range(4)]
    )
    strong = table[:9] > 0.02
    start = np.tensordot([0.25, -0.2, 0.0, 0.0], powers, 1)[strong]
    design, wanted = powers[:, strong].T, np.sign(start) * table[:9][strong]
    fitted = design @ np.linalg.lstsq(design, wanted, rcond=None)[0]
    assert np.sqrt(np.mean((fitted / wanted - 1) ** 2)) < 0.03


def test_ion_alternates_by_six_and_three_with_even_n_strong(meinel):
    """N2+ X2Sigma_g+: even N symmetric, J = N + 1/2 for F1."""
    lines, _ = meinel
    first = lines["lower_component"] == 0
    number = lines["lower_j"][first] - 0.5
    weight = lines["lower_degeneracy"][first] / (2 * lines["lower_j"][first] + 1)
    np.testing.assert_allclose(weight, np.where(number % 2 == 0, 2 / 3, 1 / 3), rtol=1e-12)


def test_upper_state_of_the_ion_is_inverted(meinel):
    """A2Pi_u has A = -74.62 cm-1: J = 3/2 of 2Pi3/2 lies below J = 1/2, which exists in 2Pi1/2 only."""
    lines, _ = meinel
    level = {
        j: np.unique(lines["upper_energy"][(lines["upper_v"] == 0) & (lines["upper_j"] == j)])
        for j in (0.5, 1.5)
    }
    assert len(level[0.5]) == 1 and len(level[1.5]) == 2
    assert level[1.5][1] - level[1.5][0] == pytest.approx(74.62e2, rel=0.05)
    assert level[1.5][0] < level[0.5][0] < level[1.5][1]


@pytest.mark.parametrize("system", ["meinel", "infrared"])
def test_a_level_decays_at_the_rate_of_its_bands(system, request):
    """Cubes taken out, lines from one (J', F') of one parity into one v'' add to K R^2."""
    lines, _ = request.getfixturevalue(system)
    table = {
        "meinel": "molecules/nitrogen_ion_meinel_moment",
        "infrared": "molecules/nitric_oxide_11000_moment",
    }
    moment = bands(table[system])[1]
    reduced = lines["einstein_a"] / lines["wavenumber"] ** 3
    weight = lines["upper_degeneracy"] / (2 * lines["upper_j"] + 1)
    for v_upper, v_lower in ((0, 0), (2, 1)):
        for j, component in ((1.5, 0), (1.5, 1), (20.5, 0), (60.5, 1)):
            own = (lines["upper_v"] == v_upper) & (lines["lower_v"] == v_lower)
            own &= (lines["upper_j"] == j) & (lines["upper_component"] == component)
            for kind in np.unique(np.round(weight[own], 9)):
                total = reduced[own & np.isclose(weight, kind)].sum()
                expected = EINSTEIN_FACTOR * moment[v_upper, v_lower] ** 2
                assert total == pytest.approx(expected, rel=1e-9, abs=0)


def test_nitric_oxide_has_the_weights_of_different_nuclei_and_strong_p_and_r_branches(infrared):
    lines, decay = infrared
    np.testing.assert_array_equal(lines["upper_degeneracy"], 2 * lines["upper_j"] + 1)
    weight = emission_weights(lines, 6000.0)
    assert weight[lines["upper_j"] == lines["lower_j"]].sum() < 0.01
    assert decay[0] == pytest.approx(2.0261e-6 * 9092.2**3 * 3.055**2, rel=1e-3)


@pytest.mark.parametrize("system", ["meinel", "infrared"])
@pytest.mark.parametrize("temperature", [3000.0, 7000.0, 10000.0])
def test_lost_emission_stays_below_its_bound(system, temperature, request):
    lines, _ = request.getfixturevalue(system)
    keep = strong_enough(lines, TEMPERATURES, LOST)
    assert emission_weights(lines, temperature)[~keep].sum() < LOST


def emission(lines, temperature):
    """Emission coefficient of air at 50 mbar, 0.7-1.2 um [W m-3 sr-1]."""
    density = number_density(temperature, 5000.0)[SPECIES.index(lines.species)]
    inside = (lines.wavenumber > 1 / 1.2e-6) & (lines.wavenumber < 1 / 0.7e-6)
    power = lines.upper_degeneracy * lines.einstein_a * PLANCK * LIGHT * lines.wavenumber
    power = power * np.exp(-SECOND * lines.upper_energy / temperature)
    return density * power[inside].sum() / (4 * np.pi) / partition_function(lines.species, temperature)


def test_emission_of_the_ion_is_population_times_probability_times_photon(lists):
    """Without spin: 4 (2N+1) / 2 states of A2Pi_u at E_v(N), each decaying into X at equal N."""
    temperature, mass = 7000.0, reduced_mass("N2")
    moment = bands("molecules/nitrogen_ion_meinel_moment")[1]
    upper, _, bound = states("gas/diatomic_nitrogen", "N2+", "A2Pi_u", mass, moment.shape[0])
    lower, _, _ = states("gas/diatomic_nitrogen", "N2+", "X2Sigma_g+", mass, moment.shape[1])
    number = np.arange(1, 200)
    wavenumber = upper[:, None, number] - lower[None, :, number]
    population = 2 * (2 * number + 1) * np.exp(-SECOND * upper[:, number] / temperature) * bound[:, number]
    power = population[:, None] * EINSTEIN_FACTOR * PLANCK * LIGHT * np.maximum(wavenumber, 0) ** 4
    power = (power * moment[:, :, None] ** 2)[(wavenumber > 1 / 1.2e-6) & (wavenumber < 1 / 0.7e-6)].sum()
    density = number_density(temperature, 5000.0)[SPECIES.index("N2+")]
    expected = density * power / (4 * np.pi) / partition_function("N2+", temperature)
    assert emission(lists["N2+ Meinel"], temperature) == pytest.approx(expected, rel=0.01)


def test_the_ion_outshines_first_positive_above_some_6400_kelvin(lists):
    for temperature, brighter in ((6000.0, False), (7000.0, True)):
        ratio = emission(lists["N2+ Meinel"], temperature) / emission(lists["N2 1P"], temperature)
        assert (ratio > 1) == brighter


@pytest.mark.parametrize("temperature", [1000.0, 2500.0, 4000.0])
def test_partition_function_of_the_ion_counts_from_the_same_zero(temperature):
    """Own sum over X, A and B with DVR levels; quartets are below 0.1 % up to 4000 K."""
    total = 0.0
    electronic = {"X2Sigma_g+": (2, 0, 22, 30), "A2Pi_u": (4, 1, 28, 40), "B2Sigma_u+": (2, 0, 8, 20)}
    for name, (weight, orbital, known, count) in electronic.items():
        values = state_constants("gas/diatomic_nitrogen", "N2+", name)
        term, _, bound = rovibration(values, reduced_mass("N2"), known - 1, count)
        number = np.arange(term.shape[1])
        level = weight / 2 * (2 * number + 1) * (bound & (number >= orbital))
        total += (level * np.exp(-SECOND * term / temperature)).sum()
    assert partition_function("N2+", temperature) == pytest.approx(total, rel=0.005)


@pytest.mark.parametrize("name", ["NO 11000 A"])
def test_bad_requests_are_refused(name):
    with pytest.raises(ValueError, match="wavenumber_range must increase strictly"):
        SYSTEMS[name].line_list(RANGE[::-1], lost_fraction=LOST, reference_temperature=TEMPERATURES)
    with pytest.raises(ValueError, match=r"lost_fraction must lie in \(0, 1\]; got 2"):
        SYSTEMS[name].line_list(RANGE, lost_fraction=2.0, reference_temperature=TEMPERATURES)
