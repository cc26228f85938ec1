"""Table of the properties of a plasma of N2, O2 and a trace of argon in local thermodynamic equilibrium."""

import numpy as np
import xarray as xr

from plasmapyro.checks import increasing, positive, within
from plasmapyro.constants import BOLTZMANN
from plasmapyro.gas import argon as trace
from plasmapyro.gas import equilibrium, transport
from plasmapyro.gas.collisions import electron_integrals, heavy_integrals
from plasmapyro.gas.species import AIR, ELECTRON, SPECIES, gas_name

TEMPERATURE_RANGE = (200.0, 15000.0)
PRESSURE_RANGE = (100.0, 1e6)


def gas_table(*, temperature, pressure, nitrogen=AIR["N2"], argon=0.0):
    """Composition, thermodynamics and transport coefficients of a mixture of N2 and O2 in equilibrium.

    ValueError: an axis that does not increase strictly or leaves its range, or a fraction that does.

    Parameters
    ----------
    temperature : array_like [K]
        Shape (temperature,), strictly increasing, 200 to 15000.
    pressure : array_like [Pa]
        Shape (pressure,), strictly increasing, 100 to 1e6.
    nitrogen : float [1]
        Mole fraction of N2 in the cold N2 and O2, 0 to 1.
    argon : float [1]
        Mole fraction of argon in the cold gas, 0 to 0.02: a trace, see `gas.argon`.

    Returns
    -------
    Dataset
        Contract 'gas'; its attribute `gas` names the mixture.
    """
    temperature = within("temperature", increasing("temperature", temperature, "K"), *TEMPERATURE_RANGE, "K")
    pressure = within("pressure", increasing("pressure", pressure, "Pa"), *PRESSURE_RANGE, "Pa")
    enthalpy = equilibrium.species_enthalpy(temperature)
    heat_capacity = equilibrium.species_heat_capacity(temperature)
    rows = []
    for one in pressure:
        shared = one
        if argon:
            density = trace.densities(temperature, one, nitrogen, argon)
            shared = one * (1 - trace.particle_share(density[:, : len(SPECIES)], argon))
        row = properties(temperature, shared, enthalpy, heat_capacity, nitrogen)
        if argon:
            row = trace.joined(row, temperature, argon, nitrogen)
            row["mole_fraction"] = density / density.sum(axis=1, keepdims=True)
        rows.append(row)
    dims = ("pressure", "temperature")
    variables = {
        name: (dims + ("species",) * (name == "mole_fraction"), np.stack([row[name] for row in rows]))
        for name in rows[0]
    }
    coordinates = {"pressure": pressure, "temperature": temperature, "species": list(trace.species_of(argon))}
    return xr.Dataset(variables, coordinates, attrs={"origin": "modelled", "gas": gas_name(nitrogen, argon)})


def properties(temperature, pressure, enthalpy, heat_capacity, nitrogen):
    """All properties at one pressure, named as in the contract 'gas', SI, (points,) or (points, 11).

    Of each species (points, 11), per particle: enthalpy [J], heat capacity over k [1].
    """
    pressure = positive("pressure", pressure, "Pa")
    x = equilibrium.composition(temperature, pressure, nitrogen)
    slope, _ = equilibrium.composition_slope(temperature, x, enthalpy)
    electrons = np.maximum(x[:, ELECTRON], np.finfo(float).tiny) * pressure / (BOLTZMANN * temperature)
    heavy = heavy_integrals(temperature, electrons)
    electron = electron_integrals(temperature, electrons)
    diffusion = transport.diffusion(temperature, heavy, electron)
    polarisation = transport.energy_polarisation(temperature, x, heavy)
    thermal_ratio = transport.thermal_diffusion_ratio(x, polarisation, diffusion, heavy)
    conductivity = (
        transport.heavy_conductivity(x, polarisation)
        + transport.electron_conductivity(temperature, x, electron)
        + transport.internal_conductivity(x, heat_capacity, diffusion)
        + transport.reactive_conductivity(temperature, x, slope, enthalpy, diffusion, thermal_ratio)
    )
    return {
        "mole_fraction": x,
        "density": equilibrium.density(temperature, pressure, x),
        "enthalpy": equilibrium.enthalpy(x, enthalpy),
        "heat_capacity": equilibrium.heat_capacity(temperature, x, enthalpy, heat_capacity),
        "viscosity": transport.viscosity(temperature, x, heavy),
        "thermal_conductivity": conductivity,
        # Where no electrons are left, round-off may leave -1e-180.
        "electrical_conductivity": np.maximum(
            transport.electrical_conductivity(temperature, x, electron), 0.0
        ),
    }
