"""CN red and the systems of C2: heads, symmetry, strengths, and a path that holds carbon."""

import numpy as np
import pytest

from plasmapyro.gas.partition import partition_function
from plasmapyro.gas.species import CARBON, IONS, SPECIES
from plasmapyro.radiation.band_systems import MOLECULES, SYSTEMS, bands, reduced_mass
from plasmapyro.radiation.diatomic_states import state_constants
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.path import Continuum, gas_path, path_radiance
from plasmapyro.radiation.systems import line_lists

PLANCK, LIGHT, BOLTZMANN = 6.62607015e-34, 299792458.0, 1.380649e-23
SECOND = PLANCK * LIGHT / BOLTZMANN
WIDE = (2e5, 3e6)  # [m-1], holds whole systems
REFRACTION = 1.000274  # of standard air in the near infrared
HEAD_ATOL = 1.0  # [Angstrom]
NAMES = ("CN red", "C2 Phillips", "C2 Ballik-Ramsay", "C2 Swan")
SPIN_RTOL = 0.01  # spin, N' - N'' = 1 and the coldest rotations


@pytest.fixture(scope="module")
def systems():
    return {name: SYSTEMS[name].lines(WIDE) for name in NAMES}


@pytest.mark.parametrize(
    "upper_v, lower_v, head",  # R. W. B. Pearse, A. G. Gaydon, The Identification of Molecular Spectra (1976)
    [(2, 0, 8750.8), (3, 1, 8980.5), (3, 0, 7714.6), (4, 1, 7907.7)],
)
def test_phillips_bands_have_their_heads(systems, upper_v, lower_v, head):
    lines, _ = systems["C2 Phillips"]
    own = (lines["upper_v"] == upper_v) & (lines["lower_v"] == lower_v) & (lines["upper_degeneracy"] > 0)
    found = 1e10 / lines["wavenumber"][own].max() / REFRACTION
    assert found == pytest.approx(head, abs=HEAD_ATOL)


@pytest.mark.parametrize(
    "system, origin, atol",  # nu00 of Huber & Herzberg (1979) [cm-1]
    [
        ("CN red", 9117.4, 0.5),
        ("C2 Phillips", 8268.3, 1.0),
        ("C2 Ballik-Ramsay", 5632.7, 1.0),
        ("C2 Swan", 19378.4, 1.0),
    ],
)
def test_origins_of_the_bands(system, origin, atol):
    own = SYSTEMS[system]
    terms = [own.levels(state, 2)[1][0] for state in (own.upper, own.lower)]
    assert (terms[0][0, 0] - terms[1][0, 0]) / 100 == pytest.approx(origin, abs=atol)


@pytest.mark.parametrize(
    "species, state, published",  # re of Huber & Herzberg (1979) [Angstrom]
    [
        ("CN", "X2Sigma+", 1.1718),
        ("CN", "A2Pi", 1.2333),
        ("C2", "X1Sigma_g+", 1.2425),
        ("C2", "a3Pi_u", 1.3119),
    ],
)
def test_distances_follow_from_masses(species, state, published):
    rotation = state_constants(MOLECULES[species][1], species, state)["be"]
    factor = PLANCK / (8 * np.pi**2 * LIGHT * reduced_mass(species))
    assert 1e10 * np.sqrt(factor / rotation) == pytest.approx(published, abs=5e-4)


def test_half_the_levels_of_equal_nuclei_without_spin_do_not_exist(systems):
    """12C2 X1Sigma_g+ has even J only; in Pi states each J keeps one of its two components."""
    lines, _ = systems["C2 Phillips"]
    even = lines["lower_j"] % 2 == 0
    assert (lines["lower_degeneracy"][even] == 2 * lines["lower_j"][even] + 1).all()
    assert not lines["lower_degeneracy"][~even].any()
    pairs, _ = systems["C2 Swan"]
    assert (pairs["lower_degeneracy"] == 2 * pairs["lower_j"] + 1).all()
    kept = SYSTEMS["C2 Phillips"].line_list((8e5, 1.5e6), lost_fraction=1e-3, reference_temperature=(5000.0,))
    assert (kept.upper_degeneracy > 0).all()
    assert (kept.component, kept.species) == ("C2 Phillips", "C2")


@pytest.mark.parametrize("system", NAMES)
def test_a_level_decays_at_the_tabulated_rate(systems, system):
    """Cubes of the origin put back, lines from one level into one v'' add to the probability of the band."""
    lines, decay = systems[system]
    own = SYSTEMS[system]
    table = bands(own.moments)[1]
    assert decay[0] == pytest.approx(table[0].sum(), rel=1e-9)
    terms = [own.levels(state, n)[1][0] for state, n in zip((own.upper, own.lower), table.shape, strict=True)]
    v_upper, v_lower = (0, 0) if system != "C2 Ballik-Ramsay" else (2, 0)
    origin = terms[0][v_upper, 0] - terms[1][v_lower, 0]
    spin = own.levels(own.upper, 1)[0].spin % 1
    picked = (lines["upper_v"] == v_upper) & (lines["lower_v"] == v_lower) & (lines["upper_degeneracy"] > 0)
    # Levels of one upper J and component that exist; each Lambda component reaches its own lower levels.
    picked &= (lines["upper_j"] == 20 + spin) & (lines["upper_component"] == 0)
    assert picked.any()
    total = (lines["einstein_a"] * origin**3 / lines["wavenumber"] ** 3)[picked]
    weight = lines["upper_degeneracy"][picked]
    # Nuclei that differ keep both Lambda components of a Pi level, each with its own lines.
    if own.species == "CN":
        expected = table[v_upper, v_lower] * 2
    else:
        expected = table[v_upper, v_lower]
    assert total.sum() == pytest.approx(expected, rel=1e-6)
    assert (weight == weight[0]).all()


@pytest.mark.parametrize("system", ["CN red", "C2 Phillips", "C2 Swan"])
def test_emission_is_population_times_probability_times_photon(systems, system):
    """Without spin: (2N+1) states of each component, each decaying at equal N with its own cube."""
    lines, _ = systems[system]
    own, temperature = SYSTEMS[system], 4000.0
    table = bands(own.moments)[1]
    upper, lower = (
        own.levels(state, n)[1] for state, n in zip((own.upper, own.lower), table.shape, strict=True)
    )
    number = np.arange(1, 200)
    weight = 2 * (2 * own.levels(own.upper, 1)[0].spin + 1) / (2 if own.species == "C2" else 1)
    level = weight * (2 * number + 1) * np.exp(-SECOND * upper[0][:, number] / temperature)
    level = level * upper[2][:, number]
    photon = np.maximum(upper[0][:, None, number] - lower[0][None, :, number], 0)
    origin = np.abs(upper[0][:, None, :1] - lower[0][None, :, :1])
    inside = (photon > WIDE[0]) & (photon < WIDE[1])
    expected = (level[:, None] * table[:, :, None] * photon**4 / origin**3 * inside).sum()
    power = lines["upper_degeneracy"] * lines["einstein_a"] * lines["wavenumber"]
    found = (power * np.exp(-SECOND * lines["upper_energy"] / temperature)).sum()
    assert found == pytest.approx(expected, rel=SPIN_RTOL)


def carbon_path(densities, carbon, temperature=6000.0):
    density = {name: np.full(2, float(n)) for name, n in densities(temperature).items()}
    density |= {name: np.full(2, n) for name, n in carbon.items()}
    return gas_path([0.0, 0.05], np.full(2, temperature), density)


def test_carbon_joins_where_the_path_has_it_and_only_there(equilibrium_densities):
    grid = log_grid((780e-9, 800e-9), 6000)
    air = carbon_path(equilibrium_densities, {})
    assert set(air.number_density) == set(SPECIES)
    lists = line_lists(grid, air.number_density)
    assert not {lines.species for lines in lists} & set(CARBON)
    mixed = carbon_path(equilibrium_densities, {"CN": 1e20, "C": 1e19})
    names, before = (
        [lines.component for lines in line_lists(grid, path.number_density)] for path in (mixed, air)
    )
    assert names == [*before[:4], "C I", *before[4:], "CN red"]
    few = [lines for lines in line_lists(grid, mixed.number_density) if lines.component in ("O I", "CN red")]
    result = path_radiance(mixed, few, grid)
    cyanogen = result.radiance[result.components.index("CN red")]
    lines = next(lines for lines in few if lines.component == "CN red")
    inside = lines.select((lines.wavenumber > grid.wavenumber[0]) & (lines.wavenumber < grid.wavenumber[-1]))
    energy = inside.upper_degeneracy * inside.einstein_a * inside.wavenumber
    energy = (energy * np.exp(-SECOND * inside.upper_energy / 6000.0)).sum() * PLANCK * LIGHT / (4 * np.pi)
    expected = 0.05 * 1e20 * energy / float(partition_function("CN", 6000.0))
    assert -np.trapezoid(cyanogen, grid.wavelength) == pytest.approx(expected, rel=0.02)  # absorption, edges


def test_carbon_ions_count_as_ions_and_carbon_as_a_collider(equilibrium_densities):
    air = carbon_path(equilibrium_densities, {})
    mixed = carbon_path(equilibrium_densities, {"C": 3e21, "C+": 1e21})
    grid = log_grid((780e-9, 800e-9), 5000)
    ions = sum(float(air.number_density[name][0]) for name in IONS)
    free = [Continuum(grid).absorption(path, 0)[0] for path in (mixed, air)]
    assert free[0] / free[1] == pytest.approx((ions + 1e21) / ions, rel=1e-9)
    lists = line_lists(grid)
    oxygen = next(lines for lines in lists if lines.component == "O I")
    wider = mixed.hwhm(oxygen, 0) - air.hwhm(oxygen, 0)
    assert wider == pytest.approx(oxygen.van_der_waals_hwhm * 3e21 * 0.6**0.3, rel=1e-6)
    with pytest.raises(ValueError, match=r"may be CN, C2, C, C\+.*unknown: Xe"):
        carbon_path(equilibrium_densities, {"Xe": 1e20})
