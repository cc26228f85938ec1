import cantera as ct
import numpy as np
import pytest

from plasmapyro.constants import BOLTZMANN, PLANCK, SECOND_RADIATION
from plasmapyro.gas import equilibrium
from plasmapyro.gas.partition import ATOMS, atomic_levels, diatomic_levels, partition_function
from plasmapyro.gas.species import CARBON, MASS, SPECIES, particle_mass

PRINTED_ATOL = 6e-4  # last printed digit of the reference, rounding of a 5 included
RIGID_ROTOR_RTOL = 5e-3  # first correction B/3kT, vibration of the colder gas, stretching: below 0.5 %

# Largest ln(Q) error against the Gibbs functions of NASA-9 (Gurvich's level sums) from 1000 to 6000 K.
# O2+: spin uncoupling is left out (0.4 % at 1000 K). N2+: rotation and vibration of quartets are estimated.
NASA_ATOL = {"N": 3e-4, "O": 3e-4, "N+": 3e-4, "O+": 3e-4, "N2": 2e-3, "O2": 2e-3, "NO": 2e-3, "NO+": 2e-3}
NASA_ATOL |= {"O2+": 5e-3, "N2+": 6e-3}
# Largest ln(Q) error against NASA-7 from 1000 to 6000 K; B and B' of C2 are not among the constants.
CARBON_ATOL = {"CN": 5e-3, "C2": 1.5e-2, "C": 1e-3, "C+": 1e-3}
CARBON_REFERENCE = 101325.0  # [Pa], which Cantera takes where a file states none


def nasa_logarithm(species, temperature):
    """ln Q by g/kT = h0/kT - ln(q_translation kT/p) - ln Q; h0 from the enthalpy at 1000 K and the sum."""
    first, step = 1000.0, 1e-4
    warmer, colder = (partition_function(species, first * (1 + s * step)) for s in (1, -1))
    internal = np.log(warmer / colder) / (2 * step)
    gas, i = equilibrium.phase(), SPECIES.index(species)
    h0 = equilibrium.species_enthalpy(first)[i] / BOLTZMANN - first * (2.5 + internal)
    gibbs = np.empty(temperature.size)
    for k, one in enumerate(temperature):
        gas.TP = one, 1e5
        gibbs[k] = gas.standard_gibbs_RT[i]
    kt = BOLTZMANN * temperature
    translation = (2 * np.pi * MASS[i] * kt / PLANCK**2) ** 1.5 * kt / 1e5
    return h0 / temperature - gibbs - np.log(translation)


def test_atoms_agree_with_an_independent_level_sum(published):
    for row in published("partition_functions_atoms"):
        found = partition_function(row["species"], float(row["temperature"]))
        assert found == pytest.approx(float(row["partition_function"]), abs=PRINTED_ATOL)


def test_cold_atoms_have_the_weight_of_their_ground_level():
    assert partition_function("N", 300.0) == pytest.approx(4, rel=1e-12)
    assert partition_function("O+", 300.0) == pytest.approx(4, rel=1e-12)
    # 3P of O: 5 + 3 exp(-158.265 c2/T) + exp(-226.977 c2/T), Boltzmann factors by hand
    assert partition_function("O", 300.0) == pytest.approx(5 + 3 * 0.46810 + 0.33671, rel=1e-4)


@pytest.mark.parametrize(
    "species, rotation, weight, lowest",
    # B(v=0) [m-1] of the spectroscopic literature; the lowest rotation of O2 is N = 1
    [("N2", 198.96, 1 / 2, 0), ("O2", 143.77, 3 / 2, 1), ("NO+", 198.78, 1.0, 0), ("N2+", 192.2, 1.0, 0)],
)
def test_cold_diatomics_are_rigid_rotors(species, rotation, weight, lowest):
    temperature = np.array([200.0, 300.0])
    reduced = SECOND_RADIATION * rotation / temperature
    expected = weight / reduced * np.exp(lowest * (lowest + 1) * reduced)
    assert partition_function(species, temperature) == pytest.approx(expected, rel=2 * RIGID_ROTOR_RTOL)


@pytest.mark.parametrize(
    "species, allowed",
    [("N2", 1e-2), ("O2", 2e-2), ("NO", 2e-2), ("NO+", 1e-3), ("N2+", 3e-2), ("O2+", 2e-2)],
)
def test_hot_molecules_stop_at_the_centrifugal_barrier(species, allowed):
    """Against NASA-9 from 1000 to 10000 K; all bound rotations of all J would be some per cent more."""
    temperature = np.array([1000.0, 10000.0])
    logarithm = np.log(partition_function(species, temperature))
    assert logarithm == pytest.approx(nasa_logarithm(species, temperature), abs=allowed)


def test_nitric_oxide_has_its_two_ladders():
    """121 cm-1 between them (Huber & Herzberg 1979), and 3 B between the lowest rotations."""
    energy, weight = diatomic_levels("NO")
    low = np.argsort(energy)[:40]
    assert (weight[low][:2] == [4, 8]).all()
    assert energy[low][1] == pytest.approx(3 * 169.6, rel=0.02)
    upper = energy[low][weight[low] == 8][1]
    assert upper == pytest.approx(12110, rel=0.04)


def test_excited_nitric_oxide_counts_from_the_lower_component():
    """T00 of A2Sigma+ is 44200 cm-1 from X2Pi1/2 (Huber & Herzberg 1979), not from the middle of X2Pi."""
    energy, weight = diatomic_levels("NO")
    assert np.abs(energy[weight == 1] - 44200.2e2).min() < 2e2


@pytest.mark.parametrize("species", CARBON_ATOL)
def test_carbon_gives_the_gibbs_functions_of_nasa(species):
    gas = ct.Solution(
        thermo="ideal-gas",
        species=[one for one in ct.Species.list_from_file("nasa_gas.yaml") if one.name == species],
    )
    temperature = np.array([1000.0, 2000.0, 3000.0, 4500.0, 6000.0])
    first, step = temperature[0], 1e-4
    warmer, colder = (partition_function(species, first * (1 + s * step)) for s in (1, -1))
    gas.TP = first, CARBON_REFERENCE
    h0 = first * (gas.standard_enthalpies_RT[0] - 2.5 - np.log(warmer / colder) / (2 * step))
    for one in temperature:
        gas.TP = one, CARBON_REFERENCE
        kt = BOLTZMANN * one
        translation = (2 * np.pi * particle_mass(species) * kt / PLANCK**2) ** 1.5 * kt / 1e5
        expected = h0 / one - gas.standard_gibbs_RT[0] - np.log(translation)
        assert np.log(partition_function(species, one)) == pytest.approx(expected, abs=CARBON_ATOL[species])


@pytest.mark.parametrize("theta, logarithm", [(0.8, 0.996), (1.0, 0.976), (1.4, 0.949)])
def test_silicon_has_the_partition_function_of_stellar_tables(theta, logarithm):
    """D. F. Gray, The Observation and Analysis of Stellar Photospheres, appendix D: log Q at 5040 K/theta."""
    assert np.log10(partition_function("Si", 5040.0 / theta)) == pytest.approx(logarithm, abs=0.002)


def test_electrons_have_two_spins():
    assert partition_function("e-", [300.0, 1e4]) == pytest.approx(2)


@pytest.mark.parametrize("species", NASA_ATOL)
def test_sums_give_the_gibbs_functions_of_nasa(species):
    temperature = np.array([1000.0, 2000.0, 3000.0, 4500.0, 6000.0])
    logarithm = np.log(partition_function(species, temperature))
    assert logarithm == pytest.approx(nasa_logarithm(species, temperature), abs=NASA_ATOL[species])


@pytest.mark.parametrize("species", [s for s in SPECIES + CARBON if s != "e-"])
def test_levels_count_from_zero_and_cannot_be_changed(species):
    energy, weight = (atomic_levels if species in ATOMS else diatomic_levels)(species)
    assert energy.min() == 0
    assert (weight > 0).all()
    with pytest.raises(ValueError, match="read-only"):
        energy[0] = 1.0


@pytest.mark.parametrize("species", [s for s in SPECIES + CARBON if s != "e-"])
def test_partition_functions_rise_with_temperature(species):
    assert (np.diff(partition_function(species, np.linspace(200, 15000, 60))) > -1e-12).all()


def test_blocks_do_not_change_the_sum():
    many = np.linspace(300, 15000, 900)
    assert partition_function("N2", many)[[0, 450]] == pytest.approx(
        partition_function("N2", many[[0, 450]]), rel=1e-12
    )


def test_unknown_species_and_bad_temperature_are_refused():
    with pytest.raises(ValueError, match="species must be one of N2, O2, .*; got 'Xe'"):
        partition_function("Xe", 300.0)
    with pytest.raises(ValueError, match="temperature must be > 0 K; got 0 K"):
        partition_function("N", 0.0)


@pytest.mark.parametrize("species", ["N2", "O2", "N2+", "NO", "CN", "N", "O"])
def test_many_temperatures_at_once_have_the_sums_of_each(species):
    many = np.geomspace(200.0, 15000.0, 240).reshape(12, 20)
    few = np.array([partition_function(species, row) for row in many])
    np.testing.assert_allclose(partition_function(species, many), few, rtol=3e-12)
    colder = np.geomspace(5.0, 15000.0, 240)
    few = np.concatenate([partition_function(species, part) for part in np.split(colder, 12)])
    np.testing.assert_allclose(partition_function(species, colder), few, rtol=3e-12)
    alike = partition_function(species, np.full(200, 3000.0))
    np.testing.assert_allclose(alike, partition_function(species, 3000.0), rtol=3e-12)
