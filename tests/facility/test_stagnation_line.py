"""The stagnation line against Navier-Stokes, published correlations and its own limits."""

import numpy as np
import pytest
from correlations import fay_riddell, goulard_factor, homann_factor

from plasmapyro.constants import BOLTZMANN
from plasmapyro.facility.jet import Jet, potential_edge
from plasmapyro.facility.kinetics import MOLAR_MASS
from plasmapyro.facility.probes import Calorimeter, density, enthalpy, heat_flux, pitot_pressure
from plasmapyro.facility.rebuild import rebuild
from plasmapyro.facility.stagnation_line import Edge, solve
from plasmapyro.gas import equilibrium, transport
from plasmapyro.gas.collisions import heavy_integrals
from plasmapyro.gas.species import MASS, SPECIES

RADIUS, WALL = 0.025, 350.0
NAVIER_STOKES = 0.05  # the ansatz knows the jet by three numbers; found: 2.4 % (60 kW), 2.0 %, 1.3 %
PRESSURE = 0.035  # found: 2.8 %, 1.0 %, 1.5 %
REBUILT = 0.05  # found: 0.5 % (Num-2), 1.0 % (ZU1)
CORRELATION = 0.10  # fits to self-similar layers, themselves good to some per cent
JET = Jet(5700.0, 5000.0, 85.0, 1.5)


def edge_of(row):
    values = [float(row[name]) for name in ("temperature", "normal_speed", "gradient")]
    return Edge(values[0], 5000.0, 0.015, values[1], values[2])


def line(edge, recombination=1.0, chemistry="equilibrium", radius=RADIUS):
    return solve(edge, radius, wall_temperature=WALL, recombination=recombination, chemistry=chemistry)


@pytest.fixture(scope="module")
def hot():
    """Heat flux of one edge for chemistries and recombinations, each solved once."""
    known = {}

    def flux(chemistry, recombination):
        key = chemistry, recombination
        if key not in known:
            known[key] = line(potential_edge(JET, RADIUS), recombination, chemistry).heat_flux
        return known[key]

    return flux


def test_an_equilibrium_wall_takes_what_navier_stokes_gives_it(published):
    for row in published("stagnation_flow"):
        found = line(edge_of(row))
        assert found.heat_flux == pytest.approx(float(row["heat_flux"]) * 1e3, rel=NAVIER_STOKES)
        assert found.pressure_rise == pytest.approx(float(row["pressure_rise"]), rel=PRESSURE)


def test_a_fully_catalytic_wall_takes_nearly_as_much_with_any_rates(published):
    row = published("stagnation_flow")[1]
    for chemistry in ("kossyi", "park", "frozen"):
        found = line(edge_of(row), 1.0, chemistry)
        assert found.heat_flux == pytest.approx(float(row["heat_flux"]) * 1e3, rel=0.07)


def test_less_recombination_gives_less_heat_between_equilibrium_and_frozen(hot):
    falling = [hot("kossyi", gamma) for gamma in (1.0, 0.03, 0.0)]
    assert hot("equilibrium", 1.0) > falling[0] > falling[1] > falling[2] > hot("frozen", 0.0)


def test_a_frozen_wall_without_recombination_takes_the_sensible_heat_only(hot):
    """Without reactions the share of heat is that of the enthalpy that the frozen gas gives off."""
    temperatures = np.array([JET.temperature, WALL])
    x = equilibrium.composition(temperatures, JET.pressure)[0]
    particle = equilibrium.species_enthalpy(temperatures) @ x / (x @ MASS)
    share = (particle[0] - particle[1]) / enthalpy(JET)
    # Light atoms conduct better than they carry enthalpy: Fay & Riddell's h_D at Le = 1.4 is a tenth off.
    assert hot("frozen", 0.0) / hot("frozen", 1.0) == pytest.approx(share, rel=0.15)


def test_a_frozen_line_that_goes_round_in_a_cycle_comes_to_rest():
    """With 0.6 of each new transport coefficient to the end it does not, within all its steps."""
    radius, jet = 0.0129, Jet(8570.0, 11648.0, 46.5, 0.0)
    wall = {"wall_temperature": 700.0, "recombination": 0.0366}
    edge = potential_edge(jet, radius)
    found = solve(edge, radius, **wall, chemistry="frozen").heat_flux
    assert 0.3 < found / solve(edge, radius, **wall, chemistry="equilibrium").heat_flux < 1.0


def test_goulards_factor_gives_the_fall_with_recombination_of_a_frozen_layer(hot):
    rho, mu = density(JET), viscosity(JET.temperature)
    speed = np.sqrt(BOLTZMANN * WALL / (2 * np.pi * MASS[SPECIES.index("O")]))
    for gamma in (0.1, 0.01):
        expected = goulard_factor(
            recombination=gamma,
            atom_speed=speed,
            wall_density=rho * JET.temperature / WALL,  # of the dissociated gas
            edge_density=rho,
            edge_viscosity=mu,
            gradient=1.5 * JET.speed / RADIUS,
        )
        base, whole = hot("frozen", 0.0), hot("frozen", 1.0)
        assert (hot("frozen", gamma) - base) / (whole - base) == pytest.approx(expected, abs=0.1)


def viscosity(temperature):
    point = np.array([temperature])
    x = equilibrium.composition(point, 5000.0)
    electrons = np.maximum(x[:, -1], 1e-12) * 5000.0 / (BOLTZMANN * point)
    return float(transport.viscosity(point, x, heavy_integrals(point, electrons))[0])


def test_a_thin_layer_takes_what_fay_and_riddell_say():
    # A sphere twenty times as large, as fast: the layer is a fiftieth of the radius.
    jet = Jet(3500.0, 5000.0, 600.0, 0.0)
    radius = 1.0
    expected = fay_riddell(
        edge_density=density(jet),
        edge_viscosity=viscosity(jet.temperature),
        wall_density=density(Jet(WALL, 5000.0, 1.0, 0.0)),
        wall_viscosity=viscosity(WALL),
        gradient=1.5 * jet.speed / radius,
        enthalpy=enthalpy(jet) - enthalpy(Jet(WALL, 5000.0, 1.0, 0.0)),
        lewis=1.4,
        dissociation_share=0.45,
    )
    found = line(potential_edge(jet, radius), radius=radius).heat_flux
    assert found == pytest.approx(expected, rel=CORRELATION)


@pytest.mark.parametrize("reynolds", [10.0, 100.0])
def test_friction_adds_to_the_pressure_what_homann_found(reynolds):
    temperature, wall = 400.0, 395.0
    still = Jet(temperature, 5000.0, 1.0, 0.0)
    speed = reynolds * viscosity(temperature) / (density(still) * RADIUS)
    jet = Jet(temperature, 5000.0, float(speed), 0.0)
    reading = pitot_pressure(jet, RADIUS, wall_temperature=wall)
    assert reading / (0.5 * density(jet) * speed**2) == pytest.approx(homann_factor(reynolds), rel=0.05)


def test_a_pitot_probe_as_large_as_the_model_reads_its_stagnation_pressure(published):
    for row in published("stagnation_flow"):
        values = [float(row[f"jet_{name}"]) for name in ("temperature", "speed", "pressure")]
        found = pitot_pressure(Jet(values[0], 5000.0, values[1], values[2]), RADIUS)
        assert found == pytest.approx(float(row["pressure"]), rel=0.07)  # 6 % (60 kW), 1 %, 2 %


def test_a_smaller_pitot_probe_reads_more():
    readings = [pitot_pressure(JET, radius) for radius in (0.025, 0.010, 0.005)]
    assert readings[0] < readings[1] < readings[2]


# Pairs of AblaNTIS (doi 10.5281/zenodo.15938723) as its authors rebuilt them, with the assumption found here.
@pytest.mark.parametrize(
    "flux, dynamic, recombination, temperature, theirs, speed",
    [(500e3, 14.98, 1.0, 4454.6, 9.7235e6, 92.5), (288e3, 16.0, 0.01, 3469.8, 7.339e6, 82.7)],
    ids=["Num-2", "ZU1"],
)
def test_the_authors_pairs_give_their_edges(flux, dynamic, recombination, temperature, theirs, speed):
    calorimeter = Calorimeter(RADIUS, recombination=recombination)
    found = rebuild(flux, dynamic, 5000.0, calorimeter, chemistry="kossyi", pitot_factor=1.1)
    cold_air = 0.30e6  # [J kg-1] from 0 to 298.15 K, which their enthalpy includes
    assert found.temperature == pytest.approx(temperature, rel=REBUILT)
    assert found.enthalpy + cold_air == pytest.approx(theirs, rel=REBUILT)
    assert found.speed == pytest.approx(speed, rel=REBUILT)


def test_what_was_computed_is_rebuilt():
    calorimeter = Calorimeter(RADIUS, recombination=0.02)
    flux, _ = heat_flux(JET, calorimeter, "kossyi")
    dynamic = 0.5 * density(JET) * JET.speed**2
    found = rebuild(flux, 1.3 * dynamic, 5000.0, calorimeter, chemistry="kossyi", pitot_factor=1.3)
    assert found.temperature == pytest.approx(JET.temperature, rel=2e-3)
    assert found.speed == pytest.approx(JET.speed, rel=2e-3)


def test_what_no_edge_can_give_is_said():
    with pytest.raises(ValueError, match="no edge of 1200 to 9000 K gives 9e"):
        rebuild(9e6, 15.0, 5000.0, Calorimeter(RADIUS), chemistry="equilibrium", pitot_factor=1.1)


def test_arguments_out_of_range_are_refused():
    with pytest.raises(ValueError, match="gradient must be > 0"):
        Edge(5000.0, 5000.0, 0.01, 50.0, -1.0)
    with pytest.raises(ValueError, match="recombination"):
        line(potential_edge(JET, RADIUS), 1.5)
    with pytest.raises(ValueError, match="chemistry must be one of"):
        line(potential_edge(JET, RADIUS), 1.0, "slow")
    with pytest.raises(ValueError, match="shape must be one of"):
        Calorimeter(RADIUS, "cone")


def test_elements_demix_and_mass_fractions_add_up_to_one():
    found = line(potential_edge(JET, RADIUS), 0.03, "kossyi")
    assert np.allclose(found.mass_fraction.sum(axis=1), 1.0, atol=1e-6)
    nitrogen = found.mass_fraction @ (np.array([2, 0, 1, 1, 0, 2, 0, 1, 1, 0, 0]) / MOLAR_MASS) * 0.014007
    assert 0.0 < np.ptp(nitrogen) < 0.1


def test_a_line_that_went_round_with_kept_slopes_ends():
    """A computed flow at 200 mbar, 95 kW: changes stayed at 3e-4 while slopes were kept."""
    edge = Edge(6629.874864455058, 20000.0, 0.015, 36.48468145660782, 413.1634575466702)
    lines = [
        solve(edge, 0.025, wall_temperature=350.0, recombination=0.1, chemistry=one)
        for one in ("park", "kossyi")
    ]
    assert lines[0].heat_flux == pytest.approx(lines[1].heat_flux, rel=0.01)  # at 0.1 rates hardly matter
