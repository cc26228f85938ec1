"""Table of the properties of air plasma in local thermodynamic equilibrium."""

import numpy as np
import xarray as xr

from plasmapyro.checks import increasing, positive, within
from plasmapyro.constants import BOLTZMANN
from plasmapyro.gas import equilibrium, transport
from plasmapyro.gas.collisions import electron_integrals, heavy_integrals
from plasmapyro.gas.species import ELECTRON, SPECIES

TEMPERATURE_RANGE = (200.0, 15000.0)
PRESSURE_RANGE = (100.0, 1e6)


def air_table(*, temperature, pressure):
    """Composition, thermodynamics and transport coefficients of equilibrium air.

    Parameters
    ----------
    temperature : array_like [K]
        Shape (temperature,), strictly increasing, 200 to 15000.
    pressure : array_like [Pa]
        Shape (pressure,), strictly increasing, 100 to 1e6.

    Returns
    -------
    Dataset
        Contract 'gas'.

    Raises
    ------
    ValueError
        An axis that does not increase strictly or leaves its range.
    """
    temperature = within("temperature", increasing("temperature", temperature, "K"), *TEMPERATURE_RANGE, "K")
    pressure = within("pressure", increasing("pressure", pressure, "Pa"), *PRESSURE_RANGE, "Pa")
    enthalpy = equilibrium.species_enthalpy(temperature)
    heat_capacity = equilibrium.species_heat_capacity(temperature)
    rows = [properties(temperature, one, enthalpy, heat_capacity) for one in pressure]
    dims = ("pressure", "temperature")
    variables = {
        name: (dims + ("species",) * (name == "mole_fraction"), np.stack([row[name] for row in rows]))
        for name in rows[0]
    }
    coordinates = {"pressure": pressure, "temperature": temperature, "species": list(SPECIES)}
    return xr.Dataset(variables, coordinates, attrs={"origin": "modelled"})


def properties(temperature, pressure, enthalpy, heat_capacity):
    """All properties at one pressure.

    Parameters
    ----------
    temperature : ndarray [K]
        Shape (points,).
    pressure : float [Pa]
    enthalpy : ndarray [J]
        Per particle of each species, shape (points, 11).
    heat_capacity : ndarray [1]
        Per particle of each species over k, shape (points, 11).

    Returns
    -------
    dict of ndarray
        Named as in the contract 'gas', SI, shape (points,) or (points, 11).
    """
    pressure = positive("pressure", pressure, "Pa")
    x = equilibrium.composition(temperature, pressure)
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
        "electrical_conductivity": transport.electrical_conductivity(temperature, x, electron),
    }
