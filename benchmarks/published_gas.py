r"""Transport properties that the published CF-ICP solutions were computed with, over ours.

    python benchmarks/published_gas.py FOLDER

FOLDER holds the files `heavy` and `electron` of plugins/MutationI/data/mutation/data/transport of COOLFluiD
(LGPL; not ours to ship). Writes docs/flow_published_gas.csv, which `flow_torch.py` and `flow_validation.py`
take: thermal conductivity, viscosity and electrical conductivity of equilibrium air.

The published torches are computed with the library Mutation as plug-in `MutationI` calls it: the conductivity
of reacting species without thermal diffusion (its files hold no C*), electrons at the third, the electrical
conductivity at the second order (`MutationLibrary.cxx`: `lambdaD`, `sigma`), and collision integrals

.. math:: Q = 10^{-20} e^{c_1 \ln^3 T + c_2 \ln^2 T + c_3 \ln T + c_4}

of neutral, ion-neutral and electron-neutral pairs. Here those stand in our own formulas and equilibrium.
Integrals of charged pairs are ours: theirs are not in these files.
"""

import argparse
import re
from dataclasses import replace
from pathlib import Path

import flow as bench  # first: it sets one thread
import numpy as np
import xarray as xr

from plasmapyro.constants import BOLTZMANN
from plasmapyro.gas import equilibrium, transport
from plasmapyro.gas.collisions import electron_integrals, heavy_integrals
from plasmapyro.gas.species import AIR, ELECTRON, HEAVY, SPECIES

TEMPERATURE = np.arange(500.0, 15001.0, 250.0)
PRESSURES = (7e3, 1e4)  # [Pa] of the two published solutions
TABLE = "flow_published_gas"
COLUMNS = {  # of the table
    "thermal_conductivity": "conductivity",
    "viscosity": "viscosity",
    "electrical_conductivity": "electrical",
}


def read_pairs(path):
    """Fits of a file of collision integrals: pair of our names -> four rows of four coefficients."""
    blocks = re.split(r"^\s*\.(\S+)\.\s*$", Path(path).read_text(encoding="latin-1"), flags=re.MULTILINE)
    pairs = {}
    for name, block in zip(blocks[1::2], blocks[2::2], strict=True):
        numbers = re.findall(r"[-+]?\d*\.\d+(?:[EeDd][-+]?\d+)?", block)[:16]
        ours = [re.sub("p$", "+", one).replace("em", "e-") for one in name.split("-")]
        pairs[frozenset(ours)] = np.array([float(n.replace("D", "E")) for n in numbers]).reshape(4, 4)
    return pairs


def fitted(row, temperature):
    return np.exp(np.polyval(row, np.log(temperature)))


def with_pairs(heavy, electron, temperature, pairs):
    """Our integrals with those of the files in their place."""
    heavy = replace(heavy, q11=heavy.q11.copy(), q22=heavy.q22.copy(), bstar=heavy.bstar.copy())
    electron = replace(electron, **{f"q1{s}": getattr(electron, f"q1{s}").copy() for s in range(1, 6)})
    for i, first in enumerate(SPECIES[HEAVY]):
        for k, second in enumerate(SPECIES[HEAVY]):
            if (rows := pairs.get(frozenset((first, second)))) is not None:
                q11, q22, bstar, _ = (fitted(row, temperature) for row in rows)
                heavy.q11[:, i, k], heavy.q22[:, i, k], heavy.bstar[:, i, k] = 1e-20 * q11, 1e-20 * q22, bstar
        if (rows := pairs.get(frozenset((first, "e-")))) is not None:
            q11, _, bstar, cstar = (fitted(row, temperature) for row in rows)
            q11 = 1e-20 * q11
            electron.q11[:, i], electron.q12[:, i] = q11, cstar * q11
            electron.q13[:, i] = electron.q14[:, i] = electron.q15[:, i] = (5 * cstar - bstar) / 4 * q11
    return replace(heavy, astar=heavy.q22 / heavy.q11), electron


def properties(pressure, pairs, thermal_diffusion):
    """Thermal conductivity, viscosity, electrical conductivity (second order) of air at `TEMPERATURE`."""
    enthalpy, capacity = (
        one(TEMPERATURE) for one in (equilibrium.species_enthalpy, equilibrium.species_heat_capacity)
    )
    x = equilibrium.composition(TEMPERATURE, pressure, AIR["N2"])
    slope, _ = equilibrium.composition_slope(TEMPERATURE, x, enthalpy)
    density = np.maximum(x[:, ELECTRON], np.finfo(float).tiny) * pressure / (BOLTZMANN * TEMPERATURE)
    heavy, electron = (one(TEMPERATURE, density) for one in (heavy_integrals, electron_integrals))
    if pairs:
        heavy, electron = with_pairs(heavy, electron, TEMPERATURE, pairs)
    diffusion = transport.diffusion(TEMPERATURE, heavy, electron)
    polarisation = transport.energy_polarisation(TEMPERATURE, x, heavy)
    ratio = transport.thermal_diffusion_ratio(x, polarisation, diffusion, heavy) * thermal_diffusion
    conductivity = (
        transport.heavy_conductivity(x, polarisation)
        + transport.electron_conductivity(TEMPERATURE, x, electron)
        + transport.internal_conductivity(x, capacity, diffusion)
        + transport.reactive_conductivity(TEMPERATURE, x, slope, enthalpy, diffusion, ratio)
    )
    matrix = transport.electron_matrix(x, electron)
    second, third = (np.linalg.inv(matrix[:, :order, :order])[:, 0, 0] for order in (2, 3))
    electrical = transport.electrical_conductivity(TEMPERATURE, x, electron) * second / third
    return conductivity, transport.viscosity(TEMPERATURE, x, heavy), electrical


def published_over_ours(gas, pressure, names=tuple(COLUMNS)):
    """Factors on properties of a gas table, as `flow.varied` takes them, at one of `PRESSURES`."""
    rows = [row for row in bench.read_table(bench.DOCS / f"{TABLE}.csv") if float(row["Pa"]) == pressure]
    known = [float(row["K"]) for row in rows]
    temperature = gas["temperature"]
    return {
        name: xr.DataArray(
            np.interp(temperature, known, [float(row[COLUMNS[name]]) for row in rows]),
            {"temperature": temperature},
            "temperature",
        )
        for name in names
    }


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    pairs = read_pairs(folder / "heavy") | read_pairs(folder / "electron")
    rows = []
    for pressure in PRESSURES:
        ours, without = (properties(pressure, {}, on) for on in (1.0, 0.0))
        theirs = properties(pressure, pairs, 0.0)
        third = ours[2]  # of the second order; ours is the third
        rows += [
            {
                "Pa": f"{pressure:g}",
                "K": f"{temperature:g}",
                "conductivity": f"{theirs[0][i] / ours[0][i]:.4f}",
                "without_thermal_diffusion": f"{without[0][i] / ours[0][i]:.4f}",
                "viscosity": f"{theirs[1][i] / ours[1][i]:.4f}",
                "electrical": f"{theirs[2][i] / third[i]:.4f}",
            }
            for i, temperature in enumerate(TEMPERATURE)
        ]
    bench.write_table(TABLE, rows)


if __name__ == "__main__":
    main()
