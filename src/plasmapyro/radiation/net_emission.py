r"""Power that an optically thin gas radiates per volume, from the tables of the lines of sight.

.. math:: q_{rad}(T, p) = 4\pi \int_{\lambda_1}^{\lambda_2} \left(\sum_l \varepsilon_l\,\phi_l(\lambda)
    + \kappa_c B_\lambda(T)\right) d\lambda

Only the wavelengths of our line tables count: the strong red lines of N and O, N2 first positive, and the
continuum. The visible lines and the vacuum ultraviolet, of which the gas reabsorbs a part, are missing: the
result is a LOWER BOUND of the loss.
"""

import numpy as np
import xarray as xr

from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES, gas_name, nitrogen_of
from plasmapyro.radiation.atoms import TABLE_RANGE
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.path import Continuum, gas_path
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.systems import line_lists
from plasmapyro.tables import weakest

GRID_POINTS = 2000  # of the continuum; lines are summed without a grid
STEP = 10  # the emission is given at every tenth temperature of the gas table


def net_emission(gas):
    """Net emission of the gas of a table in equilibrium within the line tables, by pressure and temperature.

    Parameters
    ----------
    gas : Dataset, contract 'gas'
        Gives the axes: its pressures, and every tenth of its temperatures.

    Returns
    -------
    Dataset, contract 'net_emission'

    Notes
    -----
    Source: definition, Kirchhoff's law. ASSUME: optically thin, local thermal equilibrium.
    """
    temperature = gas.temperature.values[::STEP].astype(float)
    grid = log_grid(TABLE_RANGE, GRID_POINTS)
    lists = line_lists(grid)
    single = _path(temperature, {name: np.ones_like(temperature) for name in SPECIES})
    per_particle = {}
    for lines in lists:
        emitted = [single.emission(lines, layer).sum() for layer in range(temperature.size)]
        per_particle[lines.species] = per_particle.get(lines.species, 0.0) + np.array(emitted)
    continuum = Continuum(grid)
    blackbody = blackbody_radiance(continuum.axis.wavelength, temperature[:, None])
    rows = []
    for pressure in gas.pressure.values:
        density = dict(zip(SPECIES, number_density(temperature, pressure, nitrogen_of(gas)).T, strict=True))
        path = _path(temperature, density)
        absorption = [continuum.absorption(path, layer).sum(axis=0) for layer in range(temperature.size)]
        smooth = -np.trapezoid(np.array(absorption) * blackbody, continuum.axis.wavelength, axis=-1)
        discrete = sum(density[name] * emitted for name, emitted in per_particle.items())
        rows.append(4 * np.pi * (discrete + smooth))
    return xr.Dataset(
        {"net_emission": (("pressure", "temperature"), np.array(rows))},
        {"pressure": gas.pressure.values, "temperature": temperature},
        attrs={
            "gas": gas_name(nitrogen_of(gas)),
            "title": "Net emission of thin equilibrium gas: lower bound, only the wavelengths given",
            "wavelength_range": [float(edge) for edge in TABLE_RANGE],
            "origin": weakest(["modelled", *(lines.origin for lines in lists)]),
        },
    )


def _path(temperature, density):
    return gas_path(np.arange(temperature.size, dtype=float), temperature, density)
