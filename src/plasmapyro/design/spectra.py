"""Spectra of the gas in equal bins of wavelength, from one emission table for many paths."""

import numpy as np

from plasmapyro.checks import increasing, positive, within
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.atoms import WHOLE_RANGE
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.path import gas_path
from plasmapyro.radiation.systems import component_uncertainty, line_lists
from plasmapyro.radiation.table import emission_table, table_nodes, table_radiance, table_total

COLDEST_NODE = 1500.0  # [K]; colder gas neither emits nor absorbs in the range
HOTTEST = 15000.0  # [K], of the composition and of the partition functions


def bin_edges(wavelength_range, bin_width):
    """Edges (B + 1,) [m] of equal bins, at most `bin_width` wide, that fill a wavelength range exactly.

    ValueError outside 650-2500 nm, where the line tables end, or for a width not > 0.
    """
    first, last = increasing(
        "wavelength_range", within("wavelength_range", wavelength_range, *WHOLE_RANGE, "m"), "m"
    )
    # A hair less than the quotient: 500 nm in bins of 1 nm are 500, whatever the last digit of the floats.
    count = int(np.ceil((last - first) / float(positive("bin_width", bin_width, "m")) - 1e-6))
    return np.linspace(first, last, count + 1)


def binned(wavelength, radiance, edges):
    r"""Mean of a spectrum (..., G) in each bin (..., B); the integral over every bin is that of the spectrum.

    .. math:: \bar L_b = \frac{1}{\Delta\lambda}\int_b L_\lambda\,d\lambda

    Of the trapezoidal rule; linear in the running integral between grid points (G,) [m].
    """
    running = np.zeros_like(radiance)
    pieces = np.diff(wavelength) * (radiance[..., 1:] + radiance[..., :-1]) / 2
    np.cumsum(pieces, axis=-1, out=running[..., 1:])
    rows = running.reshape(-1, wavelength.size)
    at_edges = np.stack([np.interp(edges, wavelength, row) for row in rows])
    return (np.diff(at_edges, axis=-1) / np.diff(edges)).reshape(*running.shape[:-1], -1)


class AirSpectra:
    """Emission of equilibrium air at one pressure, tabulated once, and the binned spectra of paths
    through it."""

    def __init__(self, pressure, hottest, *, wavelength_range, grid_points, nodes, bin_width):
        """Tabulate, for paths nowhere hotter than `hottest` [K]; ValueError as `bin_edges`, `emission_table`.

        The pressure [Pa] is for the widths of lines; densities are those of the paths. `grid_points`: of the
        engine, `nodes`: temperatures of the table.
        """
        self.edges = bin_edges(wavelength_range, bin_width)
        self.grid = log_grid(wavelength_range, grid_points)
        self.wavelength = self.grid.wavelength[::-1]
        lists = line_lists(self.grid)
        temperature = table_nodes(COLDEST_NODE, hottest, nodes)
        density = number_density(temperature, pressure)
        self.table = emission_table(lists, self.grid, temperature, dict(zip(SPECIES, density.T, strict=True)))
        self.components = (*self.table.components, *self.table.continua)
        self.uncertainty = component_uncertainty(self.components, lists)

    def radiance(self, path_distance, temperature, density, *, apart=True):
        """Mean radiance in the bins [W m-2 sr-1 m-1] at the end of a path, by component (C, B) or not (B,).

        The light travels from the first point (S,) to the last; density (species, S) [m-3].
        """
        eleven = dict(zip(SPECIES, density, strict=False))  # traces are left out
        path = gas_path(path_distance, temperature, eleven)
        found = table_radiance(self.table, path)[0] if apart else table_total(self.table, path)
        return binned(self.wavelength, found[..., ::-1], self.edges)


def heated(temperature, pressure, factor, nitrogen):
    """Temperatures (S,) [K] of a path times a factor, as far as they emit, and densities (species, S) [m-3].

    The composition is that of equilibrium; `nitrogen` is the mole fraction of N2 in the cold gas, the rest
    O2. ASSUME: pressure stays; cold gas below `COLDEST_NODE`, which does not shine, is left as it is.
    """
    changed = np.where(temperature > COLDEST_NODE, np.minimum(temperature * factor, HOTTEST), temperature)
    return changed, number_density(changed, pressure, nitrogen).T
