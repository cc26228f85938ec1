"""Argon as a trace: against Saha's equation by hand, Cantera's equilibrium, and what must be kept."""

import cantera as ct
import numpy as np
import pytest

from plasmapyro import tables
from plasmapyro.constants import BOLTZMANN
from plasmapyro.gas.argon import densities, species_of
from plasmapyro.gas.equilibrium import number_density, phase
from plasmapyro.gas.species import (
    NITROGEN_ATOMS,
    OXYGEN_ATOMS,
    argon_of,
    gas_name,
    nitrogen_of,
    particle_mass,
)
from plasmapyro.gas.stage import gas_table
from plasmapyro.radiation.atoms import atomic_lines
from plasmapyro.refraction import vacuum_wavelength

AIR_ARGON = 0.0093
PRESSURE = 5e3
HOT = np.array([4000.0, 6000.0, 8000.0, 10000.0, 12000.0])


def by_cantera(temperature):
    """Air with argon by Cantera's minimiser, species of NASA-9 and its own argon."""
    argon = next(one for one in ct.Species.list_from_file("nasa_gas.yaml") if one.name == "Ar")
    data = argon.thermo
    argon.thermo = ct.NasaPoly2(data.min_temp, data.max_temp, 1e5, data.coeffs)
    gas = ct.Solution(thermo="ideal-gas", species=[*phase().species(), argon])
    cold = {"N2": 0.79 * (1 - AIR_ARGON), "O2": 0.21 * (1 - AIR_ARGON), "Ar": AIR_ARGON}
    gas.TPX = temperature, PRESSURE, cold
    gas.equilibrate("TP", rtol=1e-12)
    return gas


@pytest.mark.parametrize("temperature", [3000.0, 4000.0, 5500.0])
def test_composition_and_thermodynamics_are_those_of_cantera(temperature):
    """Up to 6000 K, where its polynomials of argon end: air and argon in one equilibrium."""
    gas = by_cantera(temperature)
    found = densities(temperature, PRESSURE, argon=AIR_ARGON)
    expected = np.array([gas[name].X[0] for name in species_of(AIR_ARGON)[:12]])
    assert found[:12] / found.sum() == pytest.approx(expected, rel=1e-4, abs=1e-9)
    table = gas_table(temperature=[temperature], pressure=[PRESSURE], argon=AIR_ARGON)
    assert float(table.density[0, 0]) == pytest.approx(gas.density_mass, rel=1e-4)
    cold = by_cantera(298.15)
    assert float(table.enthalpy[0, 0]) == pytest.approx(gas.enthalpy_mass - cold.enthalpy_mass, rel=2e-4)


def test_ions_follow_saha():
    """By hand: 2.41468e21 m-3 K-1.5 times 2 Q+/Q, I = 15.75961 eV, Q+ = 4 + 2 exp(-2059.7 K/T), Q = 1."""
    found = densities(HOT, PRESSURE, argon=AIR_ARGON)
    weights = 2 * (4 + 2 * np.exp(-2059.7 / HOT))
    ratio = weights * 2.41468e21 * HOT**1.5 * np.exp(-15.75961 / 8.617333e-5 / HOT)
    assert found[:, 12] * found[:, 10] / found[:, 11] == pytest.approx(ratio, rel=2e-3)
    # What the trace leaves out: the electrons that it would add.
    assert (found[:, 12] < 0.006 * found[:, 10]).all()


def test_pressure_and_nuclei_are_kept():
    temperature = np.array([300.0, 2500.0, *HOT])
    found = densities(temperature, PRESSURE, argon=AIR_ARGON)
    assert found.sum(axis=1) * BOLTZMANN * temperature == pytest.approx(PRESSURE, rel=1e-5)
    molecules = found[:, :11] @ (NITROGEN_ATOMS + OXYGEN_ATOMS) / 2
    argon = found[:, 11:].sum(axis=1)
    assert argon / (argon + molecules) == pytest.approx(AIR_ARGON, rel=1e-9)
    assert np.array_equal(densities(temperature, PRESSURE), number_density(temperature, PRESSURE))


def test_heat_capacity_is_the_slope_of_the_enthalpy():
    temperature = 7000.0 + np.array([-1.0, 0.0, 1.0])
    table = gas_table(temperature=temperature, pressure=[PRESSURE], argon=0.02)
    slope = float(table.enthalpy[0, 2] - table.enthalpy[0, 0]) / 2
    # Its share of the pressure, and with it the state of the others, hardly changes with temperature.
    assert float(table.heat_capacity[0, 1]) == pytest.approx(slope, rel=5e-4)


def test_the_name_says_it():
    table = gas_table(temperature=[300.0], pressure=[PRESSURE], nitrogen=0.9, argon=0.01)
    assert table.attrs["gas"] == "N2:0.9 O2:0.1 Ar:0.01" == gas_name(0.9, 0.01)
    assert (nitrogen_of(table), argon_of(table)) == (0.9, 0.01)
    with pytest.raises(ValueError, match="argon"):
        gas_table(temperature=[300.0], pressure=[PRESSURE], argon=0.05)


def test_lines_are_those_of_the_lamp():
    """Wavelengths of the brightest lines against the certified ones of an argon lamp (NIST)."""
    lines = atomic_lines("Ar I")
    bright = np.argsort(-lines.einstein_a * lines.upper_degeneracy * (lines.upper_energy < 1.1e7))[:10]
    lamp = vacuum_wavelength(tables.load("lamp/argon_nist")["wavelength_air"])
    off = np.abs(1 / lines.wavenumber[bright, None] - lamp).min(axis=1)
    assert (off < 2e-12).all()
    assert particle_mass("Ar") == pytest.approx(39.948 * 1.66053907e-27, rel=1e-6)
