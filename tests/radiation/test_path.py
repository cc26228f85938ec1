import numpy as np
import pytest

from plasmapyro.gas.partition import partition_function
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.continuum import (
    electron_atom_absorption,
    electron_ion_absorption,
    electron_nitrogen_molecule_absorption,
)
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.lines import LineList
from plasmapyro.radiation.path import (
    NEGLIGIBLE,
    Continuum,
    coldest_that_counts,
    gas_path,
    layers_that_matter,
    path_radiance,
    thin_lines,
)
from plasmapyro.radiation.planck import blackbody_radiance

PLANCK_RTOL = 1e-4  # the bar; exp(-tau) and nothing else separates the slab from a black body
FLOAT_RTOL = 1e-10  # sums over layers
SANITY = 0.10  # of the rough table


@pytest.fixture(scope="module")
def grid():
    return log_grid((770e-9, 785e-9), 6000)  # O I 777 and neighbours


def uniform(densities, temperature, length, layers=2):
    distance = np.linspace(0.0, length, layers)
    values = densities(temperature)
    return gas_path(
        distance,
        np.full(layers, temperature),
        {name: np.full(layers, float(n)) for name, n in values.items()},
    )


def test_lines_of_equilibrium_air_emit_what_a_rough_estimate_says(published, atoms):
    for row in published("lte_air_emission"):
        temperature, pressure = float(row["temperature"]), 5000.0
        total = pressure / (1.380649e-23 * temperature)
        density = {name: np.zeros(2) for name in SPECIES}
        density["N"] += float(row["nitrogen"]) * total
        density["O"] += float(row["oxygen"]) * total
        path = gas_path([0.0, 1.0], np.full(2, temperature), density)
        found = 0.0
        for lines in atoms:
            wavelength = 1 / lines.wavenumber
            inside = lines.select((wavelength > 0.7e-6) & (wavelength < 1.2e-6))
            found += thin_lines(path, inside)[0].sum()
        assert found == pytest.approx(float(row["lines"]), rel=SANITY, abs=0), temperature


@pytest.mark.parametrize("temperature", [7000.0, 10000.0])
def test_an_opaque_slab_is_a_black_body(atoms, grid, equilibrium_densities, temperature):
    result = path_radiance(uniform(equilibrium_densities, temperature, 1e12), atoms, grid)
    assert result.optical_depth.min() > 20
    total = result.radiance.sum(axis=0)
    assert total == pytest.approx(blackbody_radiance(grid.wavelength, temperature), rel=PLANCK_RTOL, abs=0)


def test_a_thin_slab_radiates_in_proportion_to_its_length(atoms, grid, equilibrium_densities):
    short = path_radiance(uniform(equilibrium_densities, 7000.0, 1e-7), atoms, grid).radiance
    long = path_radiance(uniform(equilibrium_densities, 7000.0, 3e-7), atoms, grid).radiance
    assert long == pytest.approx(3 * short, rel=1e-5, abs=0)


def test_the_number_of_layers_of_uniform_gas_does_not_matter(atoms, grid, equilibrium_densities):
    few = path_radiance(uniform(equilibrium_densities, 8000.0, 2.0, 2), atoms, grid)
    many = path_radiance(uniform(equilibrium_densities, 8000.0, 2.0, 5), atoms, grid)
    assert many.radiance == pytest.approx(few.radiance, rel=1e-6, abs=0)
    assert many.optical_depth == pytest.approx(few.optical_depth, rel=FLOAT_RTOL, abs=0)


def test_every_component_obeys_kirchhoff(atoms, grid, equilibrium_densities):
    # One system at a time: thin radiance over optical depth is the black body at every wavelength.
    path = uniform(equilibrium_densities, 7500.0, 0.1)
    result = path_radiance(path, atoms, grid)
    source = result.thin_radiance / result.optical_depth
    assert source == pytest.approx(blackbody_radiance(grid.wavelength, 7500.0), rel=FLOAT_RTOL, abs=0)


def test_absorption_integrates_to_the_einstein_coefficients(atoms, grid, equilibrium_densities):
    # Integral of kappa over wavenumber, from B_lu and stimulated emission instead of Kirchhoff's law.
    temperature, oxygen = 7000.0, atoms[1]
    density = equilibrium_densities(temperature)
    zero = {name: np.full(2, float(n) if name == "O" else 0.0) for name, n in density.items()}
    path = gas_path([0.0, 1.0], np.full(2, temperature), zero)
    kappa = path_radiance(path, [oxygen], grid)
    continuum = kappa.thin_continuum.mean() / blackbody_radiance(777.5e-9, temperature)
    triplet = oxygen.select(np.abs(1 / oxygen.wavenumber - 777.55e-9) < 0.3e-9)
    beta = 1.438776877e-2 / temperature
    partition = partition_function("O", temperature)
    lower = float(density["O"]) * triplet.lower_degeneracy * np.exp(-beta * triplet.lower_energy) / partition
    weights = triplet.upper_degeneracy / triplet.lower_degeneracy * (1 - np.exp(-beta * triplet.wavenumber))
    expected = (
        triplet.einstein_a / (8 * np.pi * 299792458.0 * triplet.wavenumber**2) * lower * weights
    ).sum()
    near = np.abs(grid.wavelength - 777.55e-9) < 2e-9
    found = np.trapezoid(kappa.optical_depth[near] - continuum, grid.wavenumber[near])
    assert found == pytest.approx(expected, rel=1e-3, abs=0)  # wings beyond 2 nm, curvature of the continuum


def test_continua_of_a_layer_are_the_sums_over_their_partners(grid, equilibrium_densities):
    temperature = 7500.0
    path = uniform(equilibrium_densities, temperature, 1.0)
    density = {name: float(n) for name, n in equilibrium_densities(temperature).items()}
    continuum = Continuum(grid)
    axis, electrons = continuum.axis.wavenumber, density["e-"]
    ion_part, neutral_part, recombination, detachment = continuum.absorption(path, 0)
    # the ions balance the electrons
    assert ion_part == pytest.approx(
        electron_ion_absorption(axis, temperature, electrons, electrons), rel=1e-9, abs=0
    )
    oxygen = electron_atom_absorption("O", axis, temperature, electrons, density["O"])
    nitrogen = electron_atom_absorption("N", axis, temperature, electrons, density["N"])
    molecule = electron_nitrogen_molecule_absorption(axis, temperature, electrons, density["N2"])
    assert neutral_part == pytest.approx(oxygen + nitrogen + molecule, rel=1e-12, abs=0)
    assert recombination.min() > 0


def test_continua_are_linear_between_the_points_of_their_axis():
    fine = log_grid((750e-9, 850e-9), 9001)
    continuum = Continuum(fine)
    found = continuum.on_grid(np.log(continuum.axis.wavenumber)[None])
    assert found[0] == pytest.approx(np.log(fine.wavenumber), rel=1e-14)


def test_the_bound_of_a_cold_layer_is_its_light_in_terms_of_the_hottest(atoms, equilibrium_densities):
    triplet = atoms[1].select(np.abs(1 / atoms[1].wavenumber - 777.55e-9) < 0.3e-9)
    temperature = np.array([8000.0, 4000.0])
    states = [equilibrium_densities(t) for t in temperature]
    density = {name: np.array([float(s[name]) for s in states]) for name in SPECIES}
    _, light, bound = thin_lines(gas_path([0.0, 1.0], temperature, density), triplet)
    hot, cold = blackbody_radiance(777.55e-9, temperature)
    assert bound[0] == pytest.approx(light[0], rel=1e-12, abs=0)
    assert bound[1] == pytest.approx(light[1] * hot / cold, rel=1e-3, abs=0)  # three lines at one wavelength


def test_cold_gas_in_front_absorbs_what_its_levels_can(atoms, grid, equilibrium_densities):
    # Dense gas at 7000 K before a layer at 9000 K: the line centres darken.
    hot, cold = equilibrium_densities(9000.0), equilibrium_densities(7000.0, 1e5)
    density = {name: np.array([float(hot[name]), float(cold[name])]) for name in SPECIES}
    both = path_radiance(gas_path([0.0, 1.0], np.array([9000.0, 7000.0]), density), atoms, grid)
    alone = {name: np.array([float(hot[name]), 0.0]) for name in SPECIES}
    single = path_radiance(gas_path([0.0, 1.0], np.array([9000.0, 7000.0]), alone), atoms, grid)
    centre = np.argmax(single.radiance.sum(axis=0))
    assert both.radiance.sum(axis=0)[centre] < 0.9 * single.radiance.sum(axis=0)[centre]
    assert np.all(both.radiance.sum(axis=0) <= blackbody_radiance(grid.wavelength, 9000.0) * (1 + 1e-9))


def test_what_is_left_out_is_bounded_and_small(atoms, grid, jet_sightline):
    density = dict(zip(SPECIES, jet_sightline.number_density.values, strict=True))
    path = gas_path(jet_sightline.path_distance.values, jet_sightline.temperature.values, density)
    result = path_radiance(path, atoms, grid)
    emerging = -np.trapezoid(result.radiance.sum(axis=0), grid.wavelength)
    assert 0 < result.neglected_bound <= NEGLIGIBLE * emerging


def test_gas_at_room_temperature_is_dark(atoms, grid, equilibrium_densities):
    result = path_radiance(uniform(equilibrium_densities, 300.0, 1.0), atoms, grid)
    assert result.radiance.max() < 1e-30
    assert result.optical_depth.max() < 1e-12


def test_layers_are_kept_until_the_rest_is_within_the_allowance():
    keep = layers_that_matter(np.array([1.0, 0.01, 5.0, 0.02]), 0.03)
    assert keep.tolist() == [True, False, True, False]
    assert layers_that_matter(np.array([1.0, 0.01]), 0.0).all()


def test_the_resolution_is_asked_where_light_arises():
    temperature = np.array([300.0, 7000.0, 4000.0])
    assert coldest_that_counts(temperature, np.array([0.0, 1.0, 0.001])) == 7000.0
    assert coldest_that_counts(temperature, np.array([0.0, 1.0, 0.5])) == 4000.0


def test_a_grid_too_coarse_for_the_lines_is_refused(atoms, equilibrium_densities):
    coarse = log_grid((770e-9, 785e-9), 1000)
    with pytest.raises(ValueError, match=r"grid points must be >= \d+ for O I at 7000 K .* got 1000"):
        path_radiance(uniform(equilibrium_densities, 7000.0, 0.1), atoms, coarse)


def test_a_faint_system_does_not_dictate_the_grid(atoms, equilibrium_densities):
    between = log_grid((770e-9, 785e-9), 3600)  # enough for O, not for the heavier NO
    path = uniform(equilibrium_densities, 7000.0, 0.1)

    def nitric_oxide(einstein_a):
        return LineList("NO X", "NO", np.array([1.287e6]), 2e6, 2e6 - 1.287e6, 2.0, 2.0, einstein_a)

    faint = path_radiance(path, [atoms[1], nitric_oxide(1e3)], between)
    assert 0 < thin_lines(path, nitric_oxide(1e3))[0].sum() < 1e-3 * faint.thin_lines[0][1].sum()
    with pytest.raises(ValueError, match="for NO X at 7000 K"):
        path_radiance(path, [atoms[1], nitric_oxide(1e8)], between)


@pytest.mark.parametrize(
    "change, message",
    [
        (
            {"temperature": [7000.0, np.nan]},
            r"temperature must lie in \[200, 15000\] K; got nan K at index \(1,\)",
        ),
        ({"temperature": [7000.0, 16000.0]}, "temperature must lie in .* got 16000 K"),
        ({"path_distance": [0.0, -1.0]}, "path_distance must increase strictly"),
        ({"N": [1e20, -1.0]}, "number_density of N must be >= 0 m-3; got -1 m-3"),
        ({"e-": [np.nan, 1e18]}, "number_density of e- must be >= 0 m-3; got nan"),
        ({"Xe": [1e20, 1e20]}, "unknown: Xe, missing: none"),
        ({"N2": None}, "unknown: none, missing: N2"),
        ({"O": [1e20]}, r"O must have the path's shape \(2,\); got \(1,\)"),
    ],
)
def test_bad_sight_lines_are_refused(equilibrium_densities, change, message):
    density = {name: np.full(2, float(n)) for name, n in equilibrium_densities(7000.0).items()}
    temperature = change.pop("temperature", [7000.0, 7000.0])
    distance = change.pop("path_distance", [0.0, 1.0])
    density |= {name: np.array(values) for name, values in change.items() if values is not None}
    for name in [name for name, values in change.items() if values is None]:
        del density[name]
    with pytest.raises(ValueError, match=message):
        gas_path(distance, temperature, density)
