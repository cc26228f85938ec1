"""Emission tables as datasets, with their line lists, so that many jobs share one."""

import numpy as np
import xarray as xr

from plasmapyro.radiation.atoms import ATOMS, atomic_lines
from plasmapyro.radiation.band_systems import OF_LINES, SYSTEMS
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.path import CONTINUA, Continuum
from plasmapyro.radiation.table import EmissionTable, equilibrium_table


def stored_table(*, wavelength_range, grid_points, pressure, nitrogen):
    """The emission table (contract 'emission_table') of a mixture of N2 and O2 in equilibrium.

    As `table.EmissionTable`; the lines of the molecules one system after the other. Wavelengths in vacuum,
    within 650-2500 nm (the line tables); the pressure [Pa] sets the widths of lines, densities are those of
    the paths.
    """
    table = equilibrium_table(log_grid(wavelength_range, grid_points), pressure, nitrogen)
    molecules = [lines for lines in table.lines if lines.component in SYSTEMS]
    columns = {
        f"line_{name}": ("line", np.concatenate([getattr(lines, name) for lines in molecules]))
        for name in OF_LINES
    }
    count = [len(lines) if lines.component in SYSTEMS else 0 for lines in table.lines]
    return xr.Dataset(
        {
            "log_emission": (("component", "node_temperature", "wavenumber"), table.emission),
            "emission_shift": ("component", table.shift),
            "log_whole_emission": (("component", "node_temperature"), table.whole),
            "log_continuum": (("continuum_part", "node_temperature", "coarse_wavenumber"), table.continuum),
            "line_count": ("component", count),
            **columns,
        },
        {
            "component": np.array(table.components, dtype=object),
            "node_temperature": table.temperature,
            "wavenumber": table.grid.wavenumber,
        },
        {
            "title": "Emission per particle on temperature nodes",
            "origin": "modelled",
            "chamber_pressure": float(pressure),
            "wavelength_range": [float(edge) for edge in wavelength_range],
        },
    )


def table_of(dataset):
    """The EmissionTable of a dataset of contract 'emission_table'."""
    grid = log_grid(dataset.attrs["wavelength_range"], dataset.sizes["wavenumber"])
    ends = np.cumsum(dataset.line_count.values)
    columns = {name: dataset[f"line_{name}"].values for name in OF_LINES}
    lines = [
        atomic_lines(name)
        if name in ATOMS
        else SYSTEMS[name].assembled({key: column[end - count : end] for key, column in columns.items()})
        for name, end, count in zip(
            map(str, dataset.component.values), ends, dataset.line_count.values, strict=True
        )
    ]
    return EmissionTable(
        grid,
        tuple(lines),
        dataset["node_temperature"].values,
        dataset["log_emission"].values,
        dataset["emission_shift"].values,
        dataset["log_whole_emission"].values,
        CONTINUA,
        dataset["log_continuum"].values,
        Continuum(grid),
    )
