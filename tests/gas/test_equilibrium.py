import numpy as np
import pytest
import xarray as xr

from plasmapyro.constants import AVOGADRO, BOLTZMANN, ELECTRON_MASS, PLANCK
from plasmapyro.gas import equilibrium
from plasmapyro.gas.partition import partition_function
from plasmapyro.gas.species import (
    AIR,
    CHARGE,
    MASS,
    NITROGEN_ATOMS,
    OXYGEN_ATOMS,
    SPECIES,
    gas_name,
    nitrogen_of,
)

FLOAT_RTOL = 1e-12  # thousands of eps: sums of eleven terms after an iteration to 1e-13
ATOM_SUMS_RTOL = 3e-3  # 100 J/mol in an energy is 0.3 % at 4000 K; 1 atm for 1 bar would be 1.3 %
SOLVER_RTOL = 1e-9  # of every species, however rare; reached: 2e-13 (rtol of both solvers is 1e-12)
RAREST = 1e-13
SLOPE_RTOL = 1e-6  # central difference over 0.2 K: (0.1/300)^2 and rounding

TEMPERATURE = np.array([300.0, 1000, 2000, 3500, 5000, 7000, 9000, 12000, 15000])
PRESSURE = np.array([[1500.0], [5000.0], [101325.0]])


def index(name):
    return SPECIES.index(name)


def test_charge_elements_and_sum_are_conserved():
    x = equilibrium.composition(TEMPERATURE, PRESSURE)
    assert x.shape == (3, 9, 11)
    assert (x >= 0).all()
    assert x.sum(axis=-1) == pytest.approx(1, rel=FLOAT_RTOL)
    charged = x[..., index("e-")]
    assert np.abs(x @ CHARGE) == pytest.approx(0 * charged, abs=FLOAT_RTOL)
    positive = np.where(CHARGE > 0, x, 0).sum(axis=-1)
    assert positive / charged == pytest.approx(np.ones((3, 9)), rel=FLOAT_RTOL)
    assert (x @ NITROGEN_ATOMS) / (x @ OXYGEN_ATOMS) == pytest.approx(
        np.full((3, 9), 79 / 21), rel=FLOAT_RTOL
    )


@pytest.mark.parametrize("nitrogen", [AIR["N2"], 1.0, 0.0, 0.3])
def test_composition_is_that_of_canteras_solver_where_it_converges(nitrogen):
    gas = equilibrium.phase()
    for temperature in (2500.0, 4000.0, 7500.0, 11000.0):
        gas.TPX = temperature, 5000.0, {"N2": nitrogen, "O2": 1 - nitrogen}
        gas.equilibrate("TP", rtol=1e-12)
        found = equilibrium.composition(temperature, 5000.0, nitrogen)
        # In pure nitrogen Cantera keeps the charged species of 2500 K to 4e-8 only, here rarer than 1e-13.
        assert found == pytest.approx(gas.X, rel=SOLVER_RTOL, abs=RAREST * (nitrogen in (0, 1)))


@pytest.mark.parametrize("nitrogen, gone", [(1.0, OXYGEN_ATOMS), (0.0, NITROGEN_ATOMS)])
def test_a_pure_gas_has_one_element_and_is_the_limit_of_mixtures(nitrogen, gone):
    pure = equilibrium.composition(TEMPERATURE, PRESSURE, nitrogen)
    assert not pure[..., gone > 0].any()
    trace = 1e-9
    near = equilibrium.composition(TEMPERATURE, PRESSURE, abs(nitrogen - trace))
    main = pure > 1e-3
    assert near[main] == pytest.approx(pure[main], rel=10 * trace)  # two atoms, and their electrons


@pytest.mark.parametrize("nitrogen", [AIR["N2"], 1.0, 0.0, 0.123456789])
def test_the_name_of_a_gas_says_its_composition(nitrogen):
    dataset = xr.Dataset(attrs={"gas": gas_name(nitrogen)})
    assert nitrogen_of(dataset) == nitrogen
    assert nitrogen_of(xr.Dataset()) == AIR["N2"]
    with pytest.raises(ValueError, match="mixture of N2 and O2; got 'Ar'"):
        nitrogen_of(xr.Dataset(attrs={"gas": "Ar"}))


def test_cold_air_obeys_the_law_of_mass_action_for_electrons():
    temperature, pressure = 1000.0, 5000.0
    x = equilibrium.composition(temperature, pressure)
    gas = equilibrium.phase()
    gas.TP = temperature, equilibrium.REFERENCE_PRESSURE
    gibbs = gas.standard_gibbs_RT
    change = gibbs[index("NO+")] + gibbs[index("e-")] - gibbs[index("NO")]
    found = x[index("NO+")] * x[index("e-")] / x[index("NO")] * pressure / 1e5
    assert found == pytest.approx(np.exp(-change), rel=1e-9, abs=0)


def translation(mass, temperature):
    """Translational partition function per volume [m-3]."""
    return (2 * np.pi * mass * BOLTZMANN * temperature / PLANCK**2) ** 1.5


@pytest.mark.parametrize("molecule, atom", [("N2", "N"), ("O2", "O")])
def test_dissociation_constants_follow_from_partition_sums(published, molecule, atom):
    rows = {row["species"]: float(row["energy"]) for row in published("dissociation_ionisation")}
    temperature = np.array([4000.0, 5000.0, 6000.0])
    n = equilibrium.number_density(temperature, 5000.0)
    found = n[:, index(atom)] ** 2 / n[:, index(molecule)]
    atoms = translation(MASS[index(atom)], temperature) * partition_function(atom, temperature)
    molecules = translation(MASS[index(molecule)], temperature) * partition_function(molecule, temperature)
    energy = 2 * rows[atom] / AVOGADRO
    expected = atoms**2 / molecules * np.exp(-energy / (BOLTZMANN * temperature))
    assert found == pytest.approx(expected, rel=ATOM_SUMS_RTOL)


@pytest.mark.parametrize("atom", ["N", "O"])
def test_ionisation_follows_the_saha_equation(published, atom):
    rows = {row["species"]: float(row["energy"]) for row in published("dissociation_ionisation")}
    temperature = np.array([6000.0, 8000.0, 10000.0])
    n = equilibrium.number_density(temperature, 5000.0)
    found = n[:, index(atom + "+")] * n[:, index("e-")] / n[:, index(atom)]
    ratio = 2 * partition_function(atom + "+", temperature) / partition_function(atom, temperature)
    mass = MASS[index(atom + "+")] / MASS[index(atom)]
    energy = rows[atom + "+"] / AVOGADRO
    expected = (
        translation(ELECTRON_MASS, temperature)
        * mass**1.5
        * ratio
        * np.exp(-energy / (BOLTZMANN * temperature))
    )
    assert found == pytest.approx(expected, rel=ATOM_SUMS_RTOL)


def test_number_densities_obey_the_ideal_gas_law():
    n = equilibrium.number_density(TEMPERATURE, PRESSURE)
    assert n.sum(axis=-1) * BOLTZMANN * TEMPERATURE == pytest.approx(
        np.broadcast_to(PRESSURE, (3, 9)), rel=FLOAT_RTOL
    )


@pytest.mark.parametrize("nitrogen", [AIR["N2"], 1.0, 0.0])
def test_composition_slope_is_the_derivative_of_the_composition(nitrogen):
    temperature, step = np.array([2500.0, 3500.0, 6500.0, 11000.0]), 0.1
    x = equilibrium.composition(temperature, 5000.0, nitrogen)
    slope, total = equilibrium.composition_slope(temperature, x, equilibrium.species_enthalpy(temperature))
    after, before = (equilibrium.composition(temperature + s * step, 5000.0, nitrogen) for s in (1, -1))
    scale = np.abs(slope).max(axis=-1, keepdims=True)
    assert slope / scale == pytest.approx((after - before) / (2 * step) / scale, abs=SLOPE_RTOL)
    particles = [-np.log(state @ MASS) for state in (after, before)]  # particles of a fixed mass
    assert total == pytest.approx((particles[0] - particles[1]) / (2 * step), rel=SLOPE_RTOL, abs=1e-12)


def test_heat_capacity_is_the_derivative_of_the_enthalpy():
    temperature, step = np.array([500.0, 3500.0, 6500.0, 11000.0]), 0.1

    def enthalpy(at):
        return equilibrium.enthalpy(equilibrium.composition(at, 5000.0), equilibrium.species_enthalpy(at))

    found = equilibrium.heat_capacity(
        temperature,
        equilibrium.composition(temperature, 5000.0),
        equilibrium.species_enthalpy(temperature),
        equilibrium.species_heat_capacity(temperature),
    )
    expected = (enthalpy(temperature + step) - enthalpy(temperature - step)) / (2 * step)
    assert found == pytest.approx(expected, rel=SLOPE_RTOL)


def test_masses_are_those_of_the_thermodynamic_data():
    weights = equilibrium.phase().molecular_weights / AVOGADRO * 1e-3
    assert MASS == pytest.approx(weights, rel=1e-8, abs=0)


def test_a_point_does_not_depend_on_the_points_beside_it():
    together = equilibrium.composition(TEMPERATURE, 5000.0)
    for row, temperature in zip(together, TEMPERATURE, strict=True):
        assert equilibrium.composition(temperature, 5000.0) == pytest.approx(row, rel=1e-11, abs=0)


@pytest.mark.parametrize("temperature, pressure", [(20.0, 1.0), (20000.0, 1e7), (200.0, 1e7)])
def test_the_corners_of_the_range_converge_or_are_refused(temperature, pressure):
    if temperature < 200:
        with pytest.raises(ValueError, match=r"temperature must lie in \[200, 20000\] K; got 20 K"):
            equilibrium.composition(temperature, pressure)
    else:
        assert equilibrium.composition(temperature, pressure).sum() == pytest.approx(1, rel=FLOAT_RTOL)


def test_bad_pressure_is_refused():
    with pytest.raises(ValueError, match="pressure must be > 0 Pa; got -1 Pa"):
        equilibrium.composition(300.0, -1.0)
