import numpy as np
import pytest

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.gas.partition import partition_function, two_temperature_partition_function
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.path import CONTINUA, gas_path, path_radiance
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.populations import Departure, absorption_excess, level_factors
from plasmapyro.radiation.systems import line_lists

ROUND_OFF = 1e-11  # exponents up to 30 with a few eps each, sums over 1e4 lines


@pytest.fixture(scope="module")
def grid():
    return log_grid((770e-9, 785e-9), 6000)


@pytest.fixture(scope="module")
def systems(grid):
    return [lines for lines in line_lists(grid) if lines.component in ("O I", "N2 1P", "N2+ Meinel")]


def layers(densities, temperature, excitation=None, length=0.1, **options):
    values = densities(8000.0)
    density = {name: np.full(2, float(n)) for name, n in values.items()}
    if excitation is not None:
        options["excitation_temperature"] = np.full(2, excitation)
    return gas_path([0.0, length], np.full(2, temperature), density, **options)


@pytest.mark.parametrize("species", SPECIES)
@pytest.mark.parametrize("temperature", [500.0, 4000.0, 12000.0])
def test_partition_function_of_equal_temperatures_is_that_of_one(species, temperature):
    two = two_temperature_partition_function(species, temperature, temperature)
    assert two == pytest.approx(float(partition_function(species, temperature)), rel=ROUND_OFF, abs=0)


def test_rotation_and_vibration_enter_the_partition_function_as_they_should():
    # N2, rigid rotor and harmonic oscillator: kT/2hcB times 1/(1 - exp(-we/kT)); B = 1.99, we = 2330 cm-1.
    rotor, oscillator = 1000.0 / (2 * 1.4388 * 1.990), 1 / (1 - np.exp(-1.4388 * 2330 / 3000.0))
    assert two_temperature_partition_function("N2", 1000.0, 3000.0) == pytest.approx(
        rotor * oscillator, rel=0.02, abs=0
    )  # anharmonicity and vibration-rotation coupling are some 1 % at v = 1


def test_atoms_know_the_excitation_temperature_only():
    cold = two_temperature_partition_function("N", 300.0, 9000.0)
    assert cold == pytest.approx(float(partition_function("N", 9000.0)), rel=ROUND_OFF, abs=0)


def test_equal_temperatures_give_equilibrium(systems, grid, equilibrium_densities, monkeypatch):
    # In equilibrium the faintest contributions may be left out; here none is.
    monkeypatch.setattr("plasmapyro.radiation.path.NEGLIGIBLE", 0.0)
    one = path_radiance(layers(equilibrium_densities, 8000.0), systems, grid)
    two = path_radiance(layers(equilibrium_densities, 8000.0, 8000.0), systems, grid)
    # a Fourier transform rounds to a share of the peak
    assert two.radiance == pytest.approx(one.radiance, rel=ROUND_OFF, abs=1e-14 * one.radiance.max())
    assert two.optical_depth == pytest.approx(one.optical_depth, rel=ROUND_OFF, abs=0)
    assert two.thin_radiance == pytest.approx(one.thin_radiance, rel=ROUND_OFF, abs=0)


def test_factors_of_one_change_nothing(systems, grid, equilibrium_densities, monkeypatch):
    monkeypatch.setattr("plasmapyro.radiation.path.NEGLIGIBLE", 0.0)
    one = path_radiance(layers(equilibrium_densities, 8000.0), systems, grid)
    unit = {"O I": Departure(), "N2 1P": Departure(np.ones(2), lambda energy, layer: np.ones_like(energy))}
    two = path_radiance(layers(equilibrium_densities, 8000.0, departures=unit), systems, grid)
    # a Fourier transform rounds to a share of the peak
    assert two.radiance == pytest.approx(one.radiance, rel=ROUND_OFF, abs=1e-14 * one.radiance.max())
    assert two.optical_depth == pytest.approx(one.optical_depth, rel=ROUND_OFF, abs=0)


def test_emission_and_absorption_scale_with_the_levels_they_come_from(systems, grid, equilibrium_densities):
    # Twice the atoms in the upper levels: twice the light; absorption loses one more stimulated emission.
    oxygen = [lines for lines in systems if lines.component == "O I"]
    thin, layer = 1e-6, slice(0, 1)
    plain = path_radiance(layers(equilibrium_densities, 8000.0, length=thin), oxygen, grid)
    double = {"O I": Departure(upper=2.0)}
    bright = path_radiance(
        layers(equilibrium_densities, 8000.0, length=thin, departures=double), oxygen, grid
    )
    assert bright.radiance[layer] == pytest.approx(2 * plain.radiance[layer], rel=1e-4, abs=0)
    continuum = plain.radiance[1:].sum(axis=0) / blackbody_radiance(grid.wavelength, 8000.0)
    ratio = (bright.optical_depth - continuum) / (plain.optical_depth - continuum)
    quantum = np.exp(-SECOND_RADIATION * grid.wavenumber / 8000.0)
    centre = np.argmax(plain.optical_depth)
    assert ratio[centre] == pytest.approx((1 - 2 * quantum[centre]) / (1 - quantum[centre]), rel=1e-4, abs=0)


def test_more_atoms_in_the_lower_levels_absorb_and_do_not_shine(systems, grid, equilibrium_densities):
    double = {"O I": Departure(lower=2.0)}
    plain = path_radiance(layers(equilibrium_densities, 8000.0), systems, grid)
    dark = path_radiance(layers(equilibrium_densities, 8000.0, departures=double), systems, grid)
    assert dark.thin_radiance == pytest.approx(plain.thin_radiance, rel=ROUND_OFF, abs=0)
    centre = np.argmax(plain.optical_depth)
    quantum = np.exp(-SECOND_RADIATION * grid.wavenumber[centre] / 8000.0)
    gain = dark.optical_depth[centre] / plain.optical_depth[centre]
    assert gain == pytest.approx((2 - quantum) / (1 - quantum), rel=1e-3, abs=0)  # continuum below 1e-3


def test_a_thick_slab_with_both_levels_doubled_stays_a_black_body(systems, grid, equilibrium_densities):
    both = {lines.component: Departure(2.0, 2.0) for lines in systems}
    result = path_radiance(layers(equilibrium_densities, 8000.0, length=1e12, departures=both), systems, grid)
    exact = blackbody_radiance(grid.wavelength, 8000.0)
    assert result.radiance.sum(axis=0) == pytest.approx(exact, rel=1e-9, abs=0)


def test_the_source_of_excited_atoms_is_the_black_body_of_their_excitation(
    systems, grid, equilibrium_densities
):
    oxygen = [lines for lines in systems if lines.component == "O I"]
    path = layers(equilibrium_densities, 2000.0, 9000.0, length=1e-3)
    result = path_radiance(path, oxygen, grid)
    source = result.thin_radiance / result.optical_depth
    assert source == pytest.approx(blackbody_radiance(grid.wavelength, 9000.0), rel=1e-10, abs=0)


def test_free_electrons_have_the_temperature_of_the_excitation(systems, grid, equilibrium_densities):
    # Stark widths and continua of hot electrons among cold atoms are those of gas hot altogether.
    oxygen = next(lines for lines in systems if lines.component == "O I")
    two = layers(equilibrium_densities, 2000.0, 9000.0, length=1e-5)
    hot = layers(equilibrium_densities, 9000.0, length=1e-5)
    stark = np.argmax(oxygen.stark_hwhm)
    assert two.hwhm(oxygen, 0)[stark] == pytest.approx(hot.hwhm(oxygen, 0)[stark], rel=2e-3, abs=0)
    continua = slice(-len(CONTINUA), None)
    found = path_radiance(two, [oxygen], grid).radiance[continua]
    expected = path_radiance(hot, [oxygen], grid).radiance[continua]
    assert found == pytest.approx(expected, rel=1e-3, abs=0)  # thin


def test_integrated_absorption_follows_from_the_level_populations(systems, equilibrium_densities):
    # A (n_l g_u/g_l - n_u)/8 pi c nu^2 with the populations typed out, against the engine's excess.
    lines = next(lines for lines in systems if lines.component == "N2 1P")
    rotation, vibration = 3000.0, 9000.0
    path = layers(equilibrium_densities, rotation, vibration)

    def per_state(energy, part):
        exponent = (energy - part) / vibration + part / rotation
        return np.exp(-1.438776877e-2 * exponent)

    upper = per_state(lines.upper_energy, lines.upper_rotation)
    lower = per_state(lines.lower_energy, lines.lower_rotation)
    number = path.number_density["N2"][0] / path.partition["N2"][0] * lines.upper_degeneracy
    kappa = lines.einstein_a / (8 * np.pi * 299792458.0 * lines.wavenumber**2) * number * (lower - upper)
    planck = np.expm1(1.438776877e-2 * lines.wavenumber / vibration)
    blackbody = 2 * 6.62607015e-34 * 299792458.0**2 * lines.wavenumber**3 / planck
    found = path.emission(lines, 0) * path.absorption_excess(lines, 0) / blackbody
    assert found == pytest.approx(kappa, rel=1e-6, abs=0)  # energies close with the wavenumber to 1e-9


def test_rotation_is_what_lies_above_the_band_origin(systems):
    lines = next(lines for lines in systems if lines.component == "N2 1P")
    band = np.unique(np.round(lines.upper_energy - lines.upper_rotation, 3))
    # B3Pi_g, v' = 0 ... 21: from 59307 cm-1 on in steps of 1704 cm-1 and less (Huber and Herzberg)
    assert len(band) <= 22
    assert band.min() > 5.9e6
    gaps = np.diff(band)
    assert np.all((gaps > 1.0e5) & (gaps < 1.75e5))
    # F1 of B3Pi lies about A = 42 cm-1 below the centre, hence a little negative for the lowest J.
    assert -6e3 < lines.upper_rotation.min() < 0


def test_cold_rotation_draws_a_band_together_at_its_head(systems, equilibrium_densities):
    fine = log_grid((770e-9, 785e-9), 11_000)
    molecules = [lines for lines in systems if lines.component == "N2 1P"]
    bright = {}
    for rotation in (1000.0, 8000.0):
        path = layers(equilibrium_densities, rotation, 8000.0)
        radiance = path_radiance(path, molecules, fine).radiance[0]
        head = np.abs(fine.wavelength - 774.5e-9) < 1.2e-9  # 2-0, degraded to the violet
        bright[rotation] = -np.trapezoid(radiance[head], fine.wavelength[head])
        bright[rotation] /= -np.trapezoid(radiance, fine.wavelength)
    assert bright[1000.0] > 1.5 * bright[8000.0]


def test_inverted_levels_amplify(systems, grid, equilibrium_densities):
    inverted = {"O I": Departure(lower=lambda energy, layer: np.zeros_like(energy))}
    path = layers(equilibrium_densities, 8000.0, departures=inverted, length=0.1)
    result = path_radiance(path, systems, grid)
    assert result.optical_depth.min() < 0
    assert result.radiance.sum(axis=0).max() > result.thin_radiance.max()


def test_single_levels_are_found_by_their_energy(atoms):
    oxygen = atoms[1]
    energy = oxygen.upper_energy[np.argmin(np.abs(1 / oxygen.wavenumber - 777.4e-9))]
    factor = level_factors([energy + 5.0], [3.0])(oxygen.upper_energy, 0)
    assert set(np.unique(factor)) == {1.0, 3.0}
    assert np.all(np.abs(oxygen.upper_energy[factor == 3.0] - energy) < 20.0)


def test_excess_is_one_in_equilibrium_to_the_last_bit(atoms):
    assert np.all(absorption_excess(atoms[0], 8000.0, 8000.0) == 1.0)


@pytest.mark.parametrize("excitation", [None, 6000.0])
def test_an_equilibrium_cavity_shows_planck_at_any_depth(systems, grid, equilibrium_densities, excitation):
    # A black wall at the temperature of the gas disappears behind it: thin, moderate and thick.
    exact = blackbody_radiance(grid.wavelength, 6000.0)
    for length in (1e-6, 30.0, 1e12):
        path = layers(equilibrium_densities, 6000.0, excitation, length=length)
        gas = path_radiance(path, systems, grid)
        found = gas.radiance.sum(axis=0) + exact * np.exp(-gas.optical_depth)
        assert found == pytest.approx(exact, rel=1e-6, abs=0)


@pytest.mark.parametrize(
    "options, message",
    [
        (
            {"excitation_temperature": [8000.0, -5.0]},
            r"excitation_temperature must lie in \[200, 15000\] K; got -5 K at index \(1,\)",
        ),
        (
            {"excitation_temperature": [8000.0]},
            r"excitation_temperature must have the path's shape \(2,\); got \(1,\)",
        ),
    ],
)
def test_bad_excitation_is_refused(equilibrium_densities, options, message):
    with pytest.raises(ValueError, match=message):
        layers(equilibrium_densities, 8000.0, **options)


@pytest.mark.parametrize(
    "departure, message",
    [
        (Departure(upper=0.0), "population factor of O I, upper levels must be > 0"),
        (Departure(lower=-1.0), "population factor of O I, lower levels must be >= 0"),
        (Departure(upper=np.nan), "population factor of O I, upper levels must be > 0; got nan"),
        (Departure(upper=np.ones(1)), r"of O I, upper levels must be a number or one per layer; got \(1,\)"),
        (Departure(upper=lambda energy, layer: np.ones(3)), "must have the shape of the energies"),
    ],
)
def test_bad_factors_are_refused(systems, grid, equilibrium_densities, departure, message):
    path = layers(equilibrium_densities, 8000.0, departures={"O I": departure})
    with pytest.raises(ValueError, match=message):
        path_radiance(path, systems, grid)


def test_factors_of_an_unknown_system_are_refused(systems, grid, equilibrium_densities):
    path = layers(equilibrium_densities, 8000.0, departures={"O III": Departure(2.0)})
    with pytest.raises(ValueError, match="departures must name components among O I, .*; got O III"):
        path_radiance(path, systems, grid)


def test_bad_levels_are_refused():
    with pytest.raises(ValueError, match="factor must have the shape of level_energy"):
        level_factors([1e6, 2e6], [1.0])
    with pytest.raises(ValueError, match="level_energy must be >= 0 m-1"):
        level_factors([-1.0], [1.0])
