import numpy as np
import pytest

from plasmapyro.radiation import table as table_module
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.path import NEGLIGIBLE, gas_path, path_radiance
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.systems import line_lists
from plasmapyro.radiation.table import NODES, emission_table, table_nodes, table_radiance

BAND_RTOL = 1e-4  # the bar for band signals; reached: 3e-5
FLOAT_RTOL = 1e-12
MEMORY = 1e9  # bytes, the bar


@pytest.fixture(scope="module")
def grid():
    return log_grid((755e-9, 800e-9), 18_000)


@pytest.fixture(scope="module")
def systems(grid):
    return line_lists(grid)


@pytest.fixture(scope="module")
def table(systems, grid, equilibrium_densities):
    nodes = table_nodes(1500.0, 11000.0)
    return emission_table(systems, grid, nodes, equilibrium_densities(nodes))


def jet(densities, top, pressure=5000.0):
    """Cold edge, hot core, cold tail: 40 layers."""
    distance = np.concatenate([np.linspace(0, 0.01, 10), np.linspace(0.015, 0.18, 30)])
    temperature = 350 + (top - 350) * np.tanh(distance / 0.003) / (1 + np.exp((distance - 0.11) / 0.008))
    return gas_path(distance, temperature, densities(temperature, pressure))


def band(grid, radiance):
    """Integral under a triangular response (..., ) [W m-2 sr-1]."""
    response = np.clip(1 - np.abs(grid.wavelength - 777e-9) / 20e-9, 0, None)
    return -np.trapezoid(radiance * response, grid.wavelength, axis=-1)


@pytest.mark.parametrize("top", [5200.0, 7300.0, 9700.0])
def test_table_conserves_the_energy_of_the_slabs(table, systems, grid, equilibrium_densities, top):
    path = jet(equilibrium_densities, top)
    exact = path_radiance(path, systems, grid)
    radiance, depth, bound = table_radiance(table, path)
    signal = band(grid, exact.radiance.sum(axis=0))
    assert band(grid, radiance.sum(axis=0)) == pytest.approx(signal, rel=BAND_RTOL, abs=0)
    for found, expected in zip(band(grid, radiance), band(grid, exact.radiance), strict=True):
        assert found == pytest.approx(expected, rel=3e-4, abs=BAND_RTOL * signal)
    assert depth.max() == pytest.approx(exact.optical_depth.max(), rel=1e-3, abs=0)
    error = np.sqrt(np.mean((radiance.sum(axis=0) - exact.radiance.sum(axis=0)) ** 2))
    assert error < 1e-4 * exact.radiance.sum(axis=0).max()
    assert 0 < bound < NEGLIGIBLE * signal  # a hundredth of the bar on the band signal


def test_the_nodes_return_the_slabs_themselves(table, systems, grid, equilibrium_densities):
    temperature = np.full(2, table.temperature[20])
    path = gas_path([0.0, 0.05], temperature, equilibrium_densities(temperature))
    exact = path_radiance(path, systems, grid).radiance.sum(axis=0)
    assert table_radiance(table, path)[0].sum(axis=0) == pytest.approx(
        exact, rel=1e-5, abs=0
    )  # what slabs neglect


def test_more_nodes_come_closer(systems, grid, equilibrium_densities):
    path = jet(equilibrium_densities, 8000.0)
    few = [lines for lines in systems if lines.component in ("O I", "NO 11000 A")]
    exact = band(grid, path_radiance(path, few, grid).radiance.sum(axis=0))
    errors = []
    for count in (8, 16):
        nodes = table_nodes(1500.0, 11000.0, count)
        coarse = emission_table(few, grid, nodes, equilibrium_densities(nodes))
        errors.append(abs(band(grid, table_radiance(coarse, path)[0].sum(axis=0)) / exact - 1))
    assert errors[1] < errors[0] / 4


def test_densities_are_the_path_s_own(table, systems, grid, equilibrium_densities):
    # Air at another pressure, and no equilibrium composition at all: only Stark widths belong to the table.
    path = jet(equilibrium_densities, 6000.0, pressure=6000.0)
    path.number_density["NO"][:] *= 3.0
    exact = path_radiance(path, systems, grid).radiance
    found = table_radiance(table, path)[0]
    assert band(grid, found.sum(axis=0)) == pytest.approx(band(grid, exact.sum(axis=0)), rel=3e-4, abs=0)


def test_a_layer_does_not_know_of_the_others(table, equilibrium_densities):
    # Where the second path only adds transparent gas, the light is the same to the last bit.
    temperature = np.array([6000.0, 7000.0])
    density = equilibrium_densities(temperature)
    short = gas_path([0.0, 0.1], temperature, density)
    empty = {name: np.append(n, 0.0) for name, n in density.items()}
    long = gas_path([0.0, 0.1, 0.1 + 1e-12], np.append(temperature, 5000.0), empty)
    object.__setattr__(long, "thickness", np.append(short.thickness, 1.0))
    assert np.array_equal(table_radiance(table, long)[0], table_radiance(table, short)[0])


def test_a_thick_path_is_a_black_body(table, grid, equilibrium_densities):
    temperature = np.full(2, 7777.0)
    path = gas_path([0.0, 1e12], temperature, equilibrium_densities(temperature))
    radiance, depth, _ = table_radiance(table, path)
    assert depth.min() > 30
    exact = blackbody_radiance(grid.wavelength, 7777.0)
    assert radiance.sum(axis=0) == pytest.approx(exact, rel=1e-9, abs=0)


def test_what_is_left_out_stays_below_the_bound_that_is_told(table, grid, equilibrium_densities, monkeypatch):
    path = jet(equilibrium_densities, 7300.0)
    found, _, bound = table_radiance(table, path)
    monkeypatch.setattr(table_module, "NEGLIGIBLE", 0.0)
    whole, _, cold = table_radiance(table, path)
    change = -np.trapezoid(np.abs(found - whole).sum(axis=0), grid.wavelength)
    assert 0 < change < bound - cold  # something is left out, and less than is told


def test_continua_may_be_left_out(systems, grid, equilibrium_densities, table):
    few = [lines for lines in systems if lines.component == "O I"]
    nodes = table.temperature[:8]
    lines_only = emission_table(few, grid, nodes, equilibrium_densities(nodes), continua=())
    path = jet(equilibrium_densities, 3000.0)
    assert len(table_radiance(lines_only, path)[0]) == 1


def test_memory_stays_small(table):
    per_point = table.emission.nbytes / len(table.grid)
    assert per_point * 160_000 < MEMORY / 2  # the rest is the lists and the path at work
    assert NODES in range(16, 33)


def test_block_size_does_not_matter(table, equilibrium_densities, monkeypatch):
    path = jet(equilibrium_densities, 7000.0)
    whole = table_radiance(table, path)[0]
    monkeypatch.setattr(table_module, "BLOCK", 5000)
    assert table_radiance(table, path)[0] == pytest.approx(whole, rel=FLOAT_RTOL, abs=0)


def test_a_path_hotter_than_the_table_is_refused(table, equilibrium_densities):
    temperature = np.array([300.0, 12000.0])
    path = gas_path([0.0, 1.0], temperature, equilibrium_densities(temperature))
    with pytest.raises(ValueError, match=r"path temperature must lie in \[0, 11000\] K; got 12000 K"):
        table_radiance(table, path)


def test_two_temperatures_are_refused(table, equilibrium_densities):
    temperature = np.full(2, 6000.0)
    path = gas_path(
        [0.0, 1.0], temperature, equilibrium_densities(temperature), excitation_temperature=temperature
    )
    with pytest.raises(ValueError, match="path must be in equilibrium for a table"):
        table_radiance(table, path)


@pytest.mark.parametrize(
    "arguments, message",
    [
        ((1500.0, 16000.0), r"table temperatures must lie in \[200, 15000\] K; got 16000 K"),
        ((5000.0, 1500.0), "table temperatures must increase strictly"),
        ((1500.0, 9000.0, 3), "table nodes must be a whole number >= 4; got 3"),
    ],
)
def test_bad_nodes_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        table_nodes(*arguments)


def test_bad_tables_are_refused(systems, grid, equilibrium_densities, table):
    nodes = np.array([2000.0, 3000.0, 4000.0])
    with pytest.raises(ValueError, match="table nodes must be a whole number >= 4; got 3"):
        emission_table(systems, grid, nodes, equilibrium_densities(nodes))
    nodes = np.append(nodes, 5000.0)
    with pytest.raises(ValueError, match="continua must be among e-ion free-free, .*; got bremsstrahlung"):
        emission_table(systems, grid, nodes, equilibrium_densities(nodes), continua=("bremsstrahlung",))
