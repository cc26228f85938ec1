"""Which line systems the engine knows, and their line lists for a grid."""

import numpy as np

from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.atoms import ATOMS, TABLE_RANGE, atomic_lines
from plasmapyro.radiation.band_systems import SYSTEMS
from plasmapyro.radiation.opacity import PADDING

LOST_FRACTION = 1e-4  # [1], of a molecular system's thin emission that its faintest, dropped lines may carry
FAINT_LOST_FRACTION = 1e-2  # [1], the same of faint systems
# e-ion: interpolated Gaunt factors; e-neutral: quantal tables against the cross-section formula; free-bound:
# TOPbase away from resonances; O-: newer experiments within 5 %, newer theory 40 % higher.
CONTINUA_UNCERTAINTY = {
    "e-ion free-free": 0.05,
    "e-neutral free-free": 0.3,
    "free-bound": 0.2,
    "O- detachment": 0.2,
}
ROUNDING = 1e-9  # [1], of the end of a grid
REFERENCE_TEMPERATURE = (3000.0, 5000.0, 8000.0, 12000.0)  # [K], where that is made sure


def _molecular_range(grid):
    """Wavenumbers of the padded grid [m-1]: lines beside the grid reach into it."""
    reach = np.exp(PADDING / 2 * grid.step * (len(grid) - 1))
    return grid.wavenumber[0] / reach, grid.wavenumber[-1] * reach


def line_lists(grid, species=SPECIES):
    """Line lists of all systems of the species of a gas, on a grid, atoms first.

    None for species that are not in the gas, nor systems without a line on the grid. Carbon's systems join
    where it holds carbon.
    """
    reach, species = _molecular_range(grid), set(species)
    infrared = grid.wavenumber[0] * TABLE_RANGE[1] < 1 - ROUNDING
    atoms = [atomic_lines(name, infrared) for name, atom in ATOMS.items() if atom.species in species]
    molecules = [
        system.line_list(
            reach,
            lost_fraction=FAINT_LOST_FRACTION if system.faint else LOST_FRACTION,
            reference_temperature=REFERENCE_TEMPERATURE,
        )
        for system in SYSTEMS.values()
        if system.species in species
    ]
    lowest, highest = grid.wavenumber[0], grid.wavenumber[-1]
    return [
        lines
        for lines in (*atoms, *molecules)
        if np.any((lines.wavenumber >= lowest) & (lines.wavenumber <= highest))
    ]


def component_uncertainty(components, line_lists):
    """Relative uncertainty (C,) [1] of the strength of radiating components, systems and continua.

    Of atoms NIST's classes weighed by emission (`atoms.line_uncertainty`); 0 for what is neither a system nor
    a continuum. Source: the certificates of the tables. They hold for the strength at given densities and
    temperature, errors of one system taken as common to all its lines; those of different systems are
    independent.
    """
    known = CONTINUA_UNCERTAINTY | {lines.component: lines.relative_uncertainty for lines in line_lists}
    return np.array([known.get(name, 0.0) for name in components])
