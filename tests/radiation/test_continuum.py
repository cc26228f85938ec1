import cantera as ct
import numpy as np
import pytest

from plasmapyro.constants import BOLTZMANN, LIGHT_SPEED, SECOND_RADIATION
from plasmapyro.gas.partition import partition_function
from plasmapyro.radiation.continuum import (
    BoundFree,
    bound_free,
    electron_atom_absorption,
    electron_ion_absorption,
    electron_nitrogen_molecule_absorption,
    free_bound_absorption,
    gaunt_factor,
    negative_oxygen_density,
    photodetachment_absorption,
    photodetachment_cross_section,
)
from plasmapyro.radiation.planck import blackbody_radiance

WAVENUMBER = np.linspace(1 / 1.2e-6, 1 / 0.7e-6, 1500)
KRAMERS = 3.69e8  # cgs: kappa = 3.69e8 n_e n_i T^-1/2 nu^-3 g (1 - e^-x) [cm-1]; Rybicki and Lightman 5.18b
AFFINITY_RTOL = 0.025  # NASA's data hold an older electron affinity; 4 meV are 2.3 % at 2000 K
PRINTED_RTOL = 0.002  # three printed digits
LEVEL_SHIFT_RTOL = 0.25  # observed against calculated term energies: exp(600 cm-1/kT) is 15 % at 6000 K


def thin_emission(absorption, temperature):
    """Integral of kappa B over 0.7-1.2 um [W m-3 sr-1]."""
    radiance = absorption * blackbody_radiance(1 / WAVENUMBER, temperature)
    return -np.trapezoid(radiance, 1 / WAVENUMBER)


def test_gaunt_factor_takes_the_tabulated_values():
    # gamma2 = 10 and u = 1: 1.200; u = 10: 1.129 (de Avillez and Breitschwerdt 2015)
    temperature = 157887.5 / 10
    wavenumber = np.array([1.0, 10.0]) * temperature / SECOND_RADIATION
    assert gaunt_factor(wavenumber, temperature) == pytest.approx([1.200, 1.129], rel=1e-3, abs=0)


def test_gaunt_factor_outside_its_table_is_refused():
    with pytest.raises(ValueError):
        gaunt_factor(np.array([1.4e6]), 10.0)


def test_electron_ion_absorption_is_kramers_with_the_gaunt_factor():
    temperature, electrons, ions = 8000.0, 2e20, 3e20
    expected = KRAMERS * electrons * ions * 1e-12 / np.sqrt(temperature) / (LIGHT_SPEED * WAVENUMBER) ** 3
    expected *= 100 * gaunt_factor(WAVENUMBER, temperature)
    expected *= 1 - np.exp(-SECOND_RADIATION * WAVENUMBER / temperature)
    found = electron_ion_absorption(WAVENUMBER, temperature, electrons, ions)
    assert found == pytest.approx(expected, rel=PRINTED_RTOL, abs=0)


def test_electron_ion_emission_of_air_is_the_rough_estimate(published):
    for row in published("lte_air_emission"):
        temperature, electrons = float(row["temperature"]), float(row["electron_density"])
        found = thin_emission(
            electron_ion_absorption(WAVENUMBER, temperature, electrons, electrons), temperature
        )
        # the estimate took 1.2 for the Gaunt factor, the table has 1.1 to 1.18
        assert found == pytest.approx(float(row["electron_ion"]), rel=0.1, abs=0), temperature


@pytest.mark.parametrize(
    "species, temperature, wavelength, coefficient",  # k_ff [1e-26 cm4/dyn] as printed by the sources
    [
        ("N", 6300.0, 759.709e-9, 1.20),
        ("N", 8400.0, 1012.878e-9, 0.778),
        ("O", 7500.0, 1000.274e-9, 0.0647),
        ("O", 5000.0, 750.207e-9, 0.0396),
    ],
)
def test_atoms_absorb_as_the_tables_print(species, temperature, wavelength, coefficient):
    electrons, atoms = 1e20, 3e22
    pressure = electrons * BOLTZMANN * temperature * 10  # dyn cm-2
    expected = coefficient * 1e-26 * atoms * 1e-6 * pressure * 100  # cm-1 -> m-1
    found = electron_atom_absorption(species, np.array([1 / wavelength]), temperature, electrons, atoms)
    assert found == pytest.approx([expected], rel=1e-5, abs=0)


def test_electron_neutral_beats_electron_ion_below_8500_kelvin(published):
    neutral_light, ion_light = {}, {}
    for row in published("lte_air_emission"):
        temperature, electrons = float(row["temperature"]), float(row["electron_density"])
        atoms = float(row["nitrogen"]) * 5000 / (BOLTZMANN * temperature)
        ions = electron_ion_absorption(WAVENUMBER, temperature, electrons, electrons)
        neutral = electron_atom_absorption("N", WAVENUMBER, temperature, electrons, atoms)
        neutral_light[temperature] = thin_emission(neutral, temperature)
        ion_light[temperature] = thin_emission(ions, temperature)
    assert neutral_light[8000.0] > ion_light[8000.0]
    assert neutral_light[10000.0] < ion_light[10000.0]
    assert 90 * 0.8 < neutral_light[8000.0] < 190 * 1.2  # the estimate is 90-190 W m-3 sr-1


def test_molecule_formula_gives_the_table_of_oxygen_from_its_cross_section():
    # Momentum-transfer collision integral of O at 5000 K: 3.20e-20 m2; of N2: pi 3.80e-20 (Wright et al.)
    wavenumber = np.array([1 / 1.2e-6, 1 / 0.75e-6])
    formula = electron_nitrogen_molecule_absorption(wavenumber, 5000.0, 1e20, 1e22)
    formula *= 3.20e-20 / (np.pi * 3.80e-20)
    assert formula == pytest.approx(
        electron_atom_absorption("O", wavenumber, 5000.0, 1e20, 1e22), rel=0.25, abs=0
    )


@pytest.mark.parametrize("wavelength", [0.9e-6, 1e-3])
def test_molecule_formula_is_the_average_over_maxwellian_electrons(wavelength):
    temperature, electrons, molecules = 6000.0, 1e19, 1e22
    cross_section = np.pi * 3.93e-20  # Wright et al. (2005) at 6000 K
    mass, charge, epsilon = 9.1093837e-31, 1.602176634e-19, 8.8541878e-12
    planck, light = 6.62607015e-34, 299792458.0
    photon = planck * light / wavelength
    speed = np.linspace(np.sqrt(2 * photon / mass), 6e6, 400_001)
    maxwell = 4 * np.pi * speed**2 * (mass / (2 * np.pi * BOLTZMANN * temperature)) ** 1.5
    maxwell *= np.exp(-mass * speed**2 / (2 * BOLTZMANN * temperature))
    per_collision = 4 * charge**2 / (4 * np.pi * epsilon) * speed**2 / (3 * np.pi * light**3)
    share = 2 * photon / (mass * speed**2)
    per_collision *= (1 - share / 2) * np.sqrt(np.maximum(1 - share, 0))
    power = electrons * molecules * np.trapezoid(maxwell * speed * cross_section * per_collision, speed)
    emission = 2 * np.pi * power / (4 * np.pi) * light / wavelength**2  # per circular frequency -> wavelength
    wavenumber = np.array([1 / wavelength])
    found = electron_nitrogen_molecule_absorption(wavenumber, temperature, electrons, molecules)
    assert found * blackbody_radiance(wavelength, temperature) == pytest.approx([emission], rel=1e-3, abs=0)


def test_molecules_absorb_in_proportion_to_both_densities():
    single = electron_nitrogen_molecule_absorption(WAVENUMBER, 6000.0, 1e19, 1e22)
    both = electron_nitrogen_molecule_absorption(WAVENUMBER, 6000.0, 2e19, 3e22)
    assert both == pytest.approx(6 * single, rel=1e-12, abs=0)


def test_bound_free_sums_agree_with_those_of_stellar_atmospheres(published):
    for row in published("bound_free_marcs"):
        temperature, wavelength = float(row["temperature"]), float(row["wavelength"]) * 1e-10
        levels = bound_free(row["species"], WAVENUMBER)
        found = free_bound_absorption(levels, WAVENUMBER, temperature, 1.0, 1.0)
        found /= 1 - np.exp(-SECOND_RADIATION * WAVENUMBER / temperature)
        here = np.interp(1 / wavelength, WAVENUMBER, found)
        assert here == pytest.approx(float(row["cross_section"]) * 1e-4, rel=LEVEL_SHIFT_RTOL, abs=0), row


def test_bound_free_levels_sit_at_observed_energies():
    # NIST: N I 3d 4F 104664-104767 cm-1, mean 104719.6; TOPbase puts it 47 cm-1 off.
    levels = bound_free("N", WAVENUMBER)
    assert np.abs(levels.energy - 10471958.0).min() < 100.0
    # O I 3d 5D: 97420.75 cm-1
    assert np.abs(bound_free("O", WAVENUMBER).energy - 9742075.0).min() < 100.0


def test_photoionisation_starts_where_the_observed_series_crowds():
    # O I 3d 5D: TOPbase's threshold lies 9850 m-1 below the observed one; the data start 0.007954 Ry lower.
    levels = bound_free("O", WAVENUMBER)
    level = np.argmin(np.abs(levels.energy - 9742075.0))
    first = WAVENUMBER[np.flatnonzero(levels.cross_section[level])[0]]
    assert first == pytest.approx(10983702.0 - 9742075.0 - 0.007954 * 10973731.568, abs=800.0)


def test_stimulated_emission_counts_as_negative_absorption():
    wavenumber, temperature = np.array([9e5, 1.1e6]), 9000.0
    one = BoundFree("N", np.array([1e7]), np.array([6.0]), np.full((1, 2), 3e-22))
    found = free_bound_absorption(one, wavenumber, temperature, 1e22, 5.0)
    population = 1e22 * 6 / 5 * np.exp(-SECOND_RADIATION * 1e7 / temperature)
    expected = population * 3e-22 * (1 - np.exp(-SECOND_RADIATION * wavenumber / temperature))
    assert found == pytest.approx(expected, rel=1e-12, abs=0)


def test_free_bound_is_several_times_electron_ion_at_8000_kelvin(published):
    row = next(r for r in published("lte_air_emission") if r["temperature"] == "8000")
    temperature, electrons = 8000.0, float(row["electron_density"])
    total = 5000 / (BOLTZMANN * temperature)
    recombination = sum(
        thin_emission(
            free_bound_absorption(
                bound_free(species, WAVENUMBER),
                WAVENUMBER,
                temperature,
                float(row[name]) * total,
                partition_function(species, temperature),
            ),
            temperature,
        )
        for species, name in (("N", "nitrogen"), ("O", "oxygen"))
    )
    bremsstrahlung = thin_emission(
        electron_ion_absorption(WAVENUMBER, temperature, electrons, electrons), temperature
    )
    assert 3 < recombination / bremsstrahlung < 7


def test_wavelengths_without_photoionisation_data_are_refused():
    with pytest.raises(ValueError, match="wavelength must lie in .* the photoionisation tables"):
        bound_free("N", np.linspace(1 / 2.6e-6, 1 / 0.7e-6, 10))


@pytest.mark.parametrize("temperature", [2000.0, 4000.0, 6000.0])
def test_negative_oxygen_is_as_abundant_as_nasa_has_it(temperature):
    """Mass action O + e- = O- with the Gibbs functions of NASA-7, which refer to 1 bar."""
    wanted = ("O", "O-", "Electron")
    species = {one.name: one for one in ct.Species.list_from_file("nasa_gas.yaml") if one.name in wanted}
    gas = ct.Solution(thermo="ideal-gas", species=[species[name] for name in wanted])
    gas.TP = temperature, gas.reference_pressure
    atom, ion, electron = gas.standard_gibbs_RT
    expected = np.exp(atom + electron - ion) * BOLTZMANN * temperature / 1e5
    found = negative_oxygen_density(temperature, 1.0, 1.0, float(partition_function("O", temperature)))
    assert found == pytest.approx(expected, rel=AFFINITY_RTOL, abs=0)


def test_detachment_cross_section_meets_other_experiments():
    # [eV], [Mb]: Hlavenka et al., J. Chem. Phys. 130 (2009) 061105; Branscomb et al. (1965), from a figure
    for photon, others, allowed in ((1.87187, 5.98, 0.05), (1.68634, 5.03, 0.10), (1.79996, 5.62, 0.10)):
        wavenumber = np.array([photon * 1.602176634e-19 / (6.62607015e-34 * LIGHT_SPEED)])
        assert photodetachment_cross_section(wavenumber) * 1e22 == pytest.approx(others, rel=allowed)
    assert not photodetachment_cross_section(1 / np.array([848.7e-9, 1.2e-6])).any()
    assert (photodetachment_cross_section(1 / np.array([848.4e-9, 650e-9])) > 0).all()


def test_detachment_beyond_its_table_is_refused():
    with pytest.raises(ValueError, match=r"wavelength must be >= 6.408e-07 m"):
        photodetachment_cross_section(np.array([1 / 600e-9]))


def test_detachment_absorbs_less_than_its_ions_by_stimulated_emission():
    temperature, partition = 6000.0, float(partition_function("O", 6000.0))
    wavenumber = np.array([1 / 700e-9])
    found = photodetachment_absorption(wavenumber, temperature, 1e20, 1e22, partition)
    ions = negative_oxygen_density(temperature, 1e20, 1e22, partition)
    ratio = SECOND_RADIATION * wavenumber / temperature
    expected = ions * photodetachment_cross_section(wavenumber) * (1 - np.exp(-ratio))
    assert found == pytest.approx(expected, rel=1e-12)
