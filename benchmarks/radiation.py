"""Time and accuracy of the radiation engine beside RADIS, and how its cost grows.

    python benchmarks/radiation.py --radis ENVIRONMENT/bin/python

with an environment made from benchmarks/requirements.txt (`python -m venv ENVIRONMENT`, then
`ENVIRONMENT/bin/pip install -r benchmarks/requirements.txt`). Both codes get the same lines (500 000 of
0.7-1.2 um: all of N2 first positive, the strongest of N2+ Meinel, the lines of N and O), one thread, the
same slabs; times are CPU seconds, for a slab the least of several runs, ours before and after those of RADIS,
since other work on the machine slows either. Without --radis only this engine is
timed. Writes docs/radiation_cost.md and docs/radiation_cost.png.
"""

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"

import argparse
import concurrent.futures
import multiprocessing
import resource
import subprocess
import tempfile
from pathlib import Path
from time import perf_counter, process_time

import matplotlib
import numpy as np
from scipy.special import wofz

matplotlib.use("agg")
import matplotlib.pyplot as plt

from plasmapyro.constants import AVOGADRO, BOLTZMANN, FIRST_RADIATION, SECOND_RADIATION
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.partition import partition_function
from plasmapyro.gas.species import MASS, SPECIES
from plasmapyro.radiation.atoms import atomic_lines
from plasmapyro.radiation.band_systems import SYSTEMS
from plasmapyro.radiation.broadening import doppler_sigma
from plasmapyro.radiation.diatomic_states import COLLISION_HWHM
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.lines import WIDTH_REFERENCE_TEMPERATURE, LineList
from plasmapyro.radiation.opacity import prepare, spread
from plasmapyro.radiation.path import gas_path, path_radiance
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.systems import line_lists
from plasmapyro.radiation.table import emission_table, table_nodes, table_radiance
from plasmapyro.radiation.transfer import cross_layer

RANGE = (700e-9, 1200e-9)
POINTS = 160_000
LINES = 500_000
PRESSURE = 5000.0
SLABS = 150
SLAB_TEMPERATURE = 8000.0
REPEATS = 15
WINDOWS = (868.3, 777.5, 746.8, 939.5, 800.0, 891.2, 990.0, 1050.8, 1150.0, 775.3)  # nm, each 0.6 nm wide
WINDOW_SAMPLES = 40
WARM_EDGE = 4000.0  # [K]; in a gas of one species the cold edge would shine and ask for a finer grid
TABLE_RANGE = (1500.0, 11000.0)
BARS = {"slab": 25, "path": 200, "nine": 30.0, "memory": 1000.0}
DOCS = Path(__file__).parents[1] / "docs"


def timed(work, repeats=1):
    """Least CPU seconds of several runs, and the last result."""
    seconds = []
    for _ in range(repeats):
        start = process_time()
        result = work()
        seconds.append(process_time() - start)
    return min(seconds), result


def density(temperature, pressure=PRESSURE):
    return dict(zip(SPECIES, np.moveaxis(number_density(temperature, pressure), -1, 0), strict=True))


def one_gas(temperature):
    """All particles are the radiating species: widths then follow p and T alone, as RADIS has them."""
    total = PRESSURE / (BOLTZMANN * np.asarray(temperature, dtype=float))
    return {name: total * (name == "N2") for name in SPECIES}


def benchmark_lists():
    """Bands and atomic lines as two lists of one species, `LINES` together.

    The atoms have the mass of N2 and the strengths and widths they have in air at 8000 K and 50 mbar;
    all widths fall as T^-0.7, the law of RADIS's line tables.
    """
    names = (
        "wavenumber",
        "upper_energy",
        "lower_energy",
        "upper_degeneracy",
        "lower_degeneracy",
        "einstein_a",
    )
    span = (1 / RANGE[1], 1 / RANGE[0])
    air = {name: np.full(2, n) for name, n in density(SLAB_TEMPERATURE).items()}
    path = gas_path([0.0, 1.0], np.full(2, SLAB_TEMPERATURE), air)
    atoms, widths = [], []
    for lines in (atomic_lines("N I"), atomic_lines("O I")):
        lines = lines.select((lines.wavenumber > span[0]) & (lines.wavenumber < span[1]))
        share = path.number_density[lines.species][0] / path.partition[lines.species][0]
        share /= path.number_density["N2"][0] / path.partition["N2"][0]
        columns = {name: getattr(lines, name) for name in names}
        for side in ("upper", "lower"):
            columns[f"{side}_degeneracy"] = columns[f"{side}_degeneracy"] * share
        columns["lower_energy"] = columns["upper_energy"] - columns["wavenumber"]
        atoms.append(columns)
        widths.append(path.hwhm(lines, 0))
    atoms = {name: np.concatenate([columns[name] for columns in atoms]) for name in names}
    width = np.concatenate(widths)
    bands, ions = (SYSTEMS[name].lines(span)[0] for name in ("N2 1P", "N2+ Meinel"))
    missing = LINES - len(width) - len(bands["wavenumber"])
    strength = ions["upper_degeneracy"] * ions["einstein_a"]
    strength = strength * np.exp(-SECOND_RADIATION * ions["upper_energy"] / SLAB_TEMPERATURE)
    strongest = np.argsort(strength)[::-1][:missing]
    bands = {name: np.concatenate([bands[name], ions[name][strongest]]) for name in names}
    order = np.argsort(bands["wavenumber"])
    bands = {name: values[order] for name, values in bands.items()}
    bands["lower_energy"] = np.maximum(bands["lower_energy"], 0.0)
    total = PRESSURE / (BOLTZMANN * SLAB_TEMPERATURE)
    per_density = width / total / (SLAB_TEMPERATURE / WIDTH_REFERENCE_TEMPERATURE) ** 0.3
    return [
        LineList("bands", "N2", **bands, van_der_waals_hwhm=COLLISION_HWHM),
        LineList("atoms", "N2", **atoms, van_der_waals_hwhm=per_density),
    ]


def slab_lines(spreaders, path, layer, grid):
    """Emission coefficient of one layer (G,), from populations to spectrum."""
    mass = MASS[SPECIES.index("N2")]
    total = np.zeros(len(grid))
    for spreader in spreaders:
        sigma = doppler_sigma(path.temperature[layer], mass)
        lines = spreader.lines
        total += spread(spreader, path.emission(lines, layer), path.hwhm(lines, layer), sigma)
    total *= grid.wavenumber
    return total


def slab(spreaders, path, layer, grid):
    """Radiance and optical depth of one layer, as RADIS returns them of a slab."""
    emission = slab_lines(spreaders, path, layer, grid)
    absorption = emission / blackbody_radiance(grid.wavelength, path.temperature[layer])
    return cross_layer(np.zeros((1, len(grid))), emission[None], absorption, path.thickness[layer])


def voigt_sum(wavenumber, lines, strength, hwhm, sigma):
    """Sum over all lines by the Faddeeva function (window,), in pieces that fit the memory."""
    total = np.zeros(len(wavenumber))
    for first in range(0, len(lines), 20_000):
        part = slice(first, first + 20_000)
        gauss = sigma * lines.wavenumber[part]
        z = (wavenumber[:, None] - lines.wavenumber[part] + 1j * hwhm[part]) / (np.sqrt(2) * gauss)
        total += (wofz(z).real / (np.sqrt(2 * np.pi) * gauss)) @ strength[part]
    return total


def window_errors(wavenumber, spectrum, lists, strengths, path):
    """Worst and mean over the windows of rms error over the peak of the exact sum, and of the integral's."""
    sigma = doppler_sigma(path.temperature[0], MASS[SPECIES.index("N2")])
    rms, integral = [], []
    for centre in WINDOWS:
        inside = np.flatnonzero(np.abs(1e9 / wavenumber - centre) < 0.3)
        inside = inside[:: max(1, len(inside) // WINDOW_SAMPLES)]
        exact = sum(
            voigt_sum(wavenumber[inside], lines, strength, path.hwhm(lines, 0), sigma)
            for lines, strength in zip(lists, strengths, strict=True)
        )
        error = spectrum[inside] - exact
        rms.append(np.sqrt(np.mean(error**2)) / exact.max())
        integral.append(abs(error.sum() / exact.sum()))
    return max(rms), float(np.mean(rms)), max(integral)


def sight_line(top, edge, slabs=SLABS):
    """Boundary layer, jet and tail of a torch: distance along the path and temperature."""
    distance = np.linspace(0, 1, slabs) ** 1.5 * 0.18
    rise = np.tanh((distance + 1e-4) / 3e-3) / (1 + np.exp((distance - 0.11) / 0.008))
    return distance, edge + (top - edge) * rise


def path_of(top, composition, slabs=SLABS, edge=1600.0):
    distance, temperature = sight_line(top, edge, slabs)
    return gas_path(distance, temperature, composition(temperature))


def compare(lists, grid, radis_python, radis_slabs):
    """Both codes on the same lines; rows of the report."""
    state = {name: np.full(2, n) for name, n in one_gas(SLAB_TEMPERATURE).items()}
    uniform = gas_path([0.0, 1.0], np.full(2, SLAB_TEMPERATURE), state)
    spreaders = [prepare(lines, grid) for lines in lists]
    seconds, _ = timed(lambda: slab(spreaders, uniform, 0, grid), REPEATS)
    lines_seconds, spectrum = timed(lambda: slab_lines(spreaders, uniform, 0, grid), REPEATS)
    emitted = [uniform.emission(lines, 0) for lines in lists]
    errors = window_errors(grid.wavenumber, spectrum / grid.wavenumber**2, lists, emitted, uniform)

    jet = path_of(9000.0, one_gas, edge=WARM_EDGE)
    nodes = table_nodes(*TABLE_RANGE)
    build, table = timed(lambda: emission_table(lists, grid, nodes, one_gas(nodes), continua=()))
    cross, tabulated = timed(lambda: table_radiance(table, jet), 5)
    by_slabs, exact = timed(lambda: path_radiance(jet, lists, grid))
    light = exact.radiance[: len(lists)]
    report = {
        "own": {
            "slab": seconds,
            "lines": lines_seconds,
            "errors": errors,
            "path": cross,
            "build": build,
            "path_slabs": by_slabs,
        },
        "table_rms": np.sqrt(np.mean((tabulated[0].sum(0) - light.sum(0)) ** 2)) / light.sum(0).max(),
        "table_integral": abs(
            np.trapezoid(tabulated[0].sum(0), grid.wavelength) / np.trapezoid(light.sum(0), grid.wavelength)
            - 1
        ),
    }
    if radis_python is None:
        return report
    # int kappa over wavenumber per particle, at the temperature of the slab
    strengths = []
    for emission, lines in zip(emitted, lists, strict=True):
        excess = np.expm1(SECOND_RADIATION * lines.wavenumber / SLAB_TEMPERATURE)
        strengths.append(emission * excess / (FIRST_RADIATION * lines.wavenumber**3))
    number = uniform.number_density["N2"][0]
    joined = {
        name: np.concatenate([getattr(lines, name) for lines in lists])
        for name in ("wavenumber", "lower_energy", "einstein_a", "upper_degeneracy", "lower_degeneracy")
    }
    order = np.argsort(joined["wavenumber"], kind="stable")
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "case.npz", Path(folder) / "result.npz"
        distance, temperature = sight_line(9000.0, WARM_EDGE)
        partition_temperature = np.linspace(1000.0, 12000.0, 400)
        np.savez(
            source,
            **{name: values[order] for name, values in joined.items()},
            strength=np.concatenate(strengths)[order] / number,
            hwhm=np.concatenate([uniform.hwhm(lines, 0) for lines in lists])[order],
            range=np.array([1 / RANGE[1], 1 / RANGE[0]]),
            reference_temperature=SLAB_TEMPERATURE,
            slab_temperature=SLAB_TEMPERATURE,
            pressure=PRESSURE,
            molar_mass=MASS[SPECIES.index("N2")] * AVOGADRO * 1e3,
            temperature=temperature,
            thickness=jet.thickness,
            partition_temperature=partition_temperature,
            partition=partition_function("N2", partition_temperature),
            repeats=REPEATS,
            radis_slabs=radis_slabs,
        )
        script = Path(__file__).with_name("radis_side.py")
        subprocess.run([radis_python, script, source, target], check=True)
        own = report["own"]
        own["slab"] = min(own["slab"], timed(lambda: slab(spreaders, uniform, 0, grid), REPEATS)[0])
        own["lines"] = min(own["lines"], timed(lambda: slab_lines(spreaders, uniform, 0, grid), REPEATS)[0])
        found = dict(np.load(target))
    errors = window_errors(found["wavenumber"], found["absorption"], lists, strengths, uniform)
    report["radis"] = {
        "version": str(found["version"]),
        "slab": float(found["slab_seconds"].min()),
        "lines": float(found["lines_seconds"].min()),
        "errors": errors,
        "path": float(found["path_seconds"]) * SLABS / radis_slabs,
        "points": int(found["points"]),
        "slabs": radis_slabs,
    }
    return report


def one_sight_line(top):
    """One power of the full physics through a table that the process inherited."""
    return table_radiance(SHARED["table"], path_of(top, density, 250))[0].sum()


SHARED = {}


def children_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def nine_sight_lines():
    """Lists, table and nine paths of 250 points with all systems, on two processes.

    Wall seconds; CPU seconds of the build and, spread over the two, of the paths; bytes of the table.
    """
    start, cpu = perf_counter(), process_time()
    grid = log_grid(RANGE, POINTS)
    nodes = table_nodes(*TABLE_RANGE)
    SHARED["table"] = emission_table(line_lists(grid), grid, nodes, density(nodes))
    building, before = process_time() - cpu, children_seconds()
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("fork")) as pool:
        list(pool.map(one_sight_line, np.linspace(5500.0, 10000.0, 9)))
    whole = perf_counter() - start
    size = SHARED.pop("table").nbytes
    return whole, building, (children_seconds() - before) / 2, size


def growth(lists):
    """Rows (what, value, CPU seconds of a slab or path): lines, grid, slabs, powers.

    Powers are not run: building the table once plus that many paths of 150 slabs.
    """
    rows = []
    grid = log_grid(RANGE, POINTS)
    state = {name: np.full(2, n) for name, n in one_gas(SLAB_TEMPERATURE).items()}
    uniform = gas_path([0.0, 1.0], np.full(2, SLAB_TEMPERATURE), state)
    bands = lists[0]
    for count in (10_000, 30_000, 100_000, 300_000, len(bands)):
        part = bands.select(np.linspace(0, len(bands) - 1, count).astype(int))
        spreaders = [prepare(part, grid)]
        rows.append(("lines", count, timed(lambda s=spreaders: slab_lines(s, uniform, 0, grid), 3)[0]))
    for points in (110_000, 160_000, 300_000, 600_000):
        finer = log_grid(RANGE, points)
        spreaders = [prepare(lines, finer) for lines in lists]
        seconds = timed(lambda s=spreaders, g=finer: slab_lines(s, uniform, 0, g), 3)[0]
        rows.append(("grid points", points, seconds))
    nodes = table_nodes(*TABLE_RANGE)
    full = line_lists(grid)
    build, table = timed(lambda: emission_table(full, grid, nodes, density(nodes)))
    for slabs in (30, 75, 150, 300):
        path = path_of(9000.0, density, slabs)
        rows.append(("slabs (table)", slabs, timed(lambda p=path: table_radiance(table, p), 2)[0]))
    for slabs in (30, 75, 150):
        path = path_of(9000.0, density, slabs)
        seconds = timed(lambda p=path: path_radiance(p, full, grid))[0]
        rows.append(("slabs (slab by slab)", slabs, seconds))
    single = next(seconds for what, value, seconds in rows if (what, value) == ("slabs (table)", 150))
    for powers in (1, 3, 9, 27):
        rows.append(("powers (building + paths)", powers, build + powers * single))
    return rows


def write_report(lines, rows):
    """docs/radiation_cost.md and .png."""
    table = ["| grows with | value | CPU seconds |", "|---|---|---|"]
    table += [f"| {what} | {value} | {seconds:.3g} |" for what, value, seconds in rows]
    text = ["# Cost of the radiation engine", "", "Made by `benchmarks/radiation.py`.", "", *lines, ""]
    (DOCS / "radiation_cost.md").write_text("\n".join([*text, *table, ""]), encoding="utf-8")
    kinds = list(dict.fromkeys(what for what, _, _ in rows))
    figure, axes = plt.subplots(-(-len(kinds) // 3), 3, figsize=(7.2, 4.6), layout="constrained")
    [axis.remove() for axis in axes.flat[len(kinds) :]]
    for axis, kind in zip(axes.flat, kinds, strict=False):
        values = np.array([(value, seconds) for what, value, seconds in rows if what == kind])
        axis.plot(*values.T, "o-")
        axis.set(xlabel=kind, ylabel="CPU time [s]", ylim=(0, None))
        axis.locator_params(axis="x", nbins=4)
        axis.grid(alpha=0.3)
    figure.savefig(DOCS / "radiation_cost.png", dpi=150, metadata={"Software": None})


def describe(report, nine, peak):
    """Lines of the comparison, as a table."""
    own = report["own"]
    lines = [
        f"{LINES} lines in 0.7-1.2 um at {SLAB_TEMPERATURE:g} K and 50 mbar; one thread, CPU seconds.",
        "Errors against the direct sum of Voigt profiles in ten windows: worst and mean rms over the window's"
        " peak, worst error of a window's integral.",
        "",
        "| | this engine | RADIS | ratio | bar |",
        "|---|---|---|---|---|",
    ]
    radis = report.get("radis")
    if radis and radis["slabs"] < SLABS:
        lines[0] += f" RADIS crossed {radis['slabs']} slabs of the path; its time is scaled to {SLABS}."

    def row(name, mine, other, bar):
        ratio = "" if other is None else f"{other / mine:.0f}"
        shown = "" if other is None else f"{other:.3g}"
        lines.append(f"| {name} | {mine:.3g} | {shown} | {ratio} | {bar} |")

    row("one slab: sum of its lines [s]", own["lines"], radis and radis["lines"], f"{BARS['slab']}")
    row("one slab: lines, depth and radiance [s]", own["slab"], radis and radis["slab"], f"{BARS['slab']}")
    row(f"path of {SLABS} slabs, table [s]", own["path"], radis and radis["path"], f"{BARS['path']}")
    with_build = own["path"] + own["build"]
    row("the same with building of the table [s]", with_build, radis and radis["path"], "")
    per_slab = own["path"] / SLABS
    row("slab of a path, table [s]", per_slab, radis and radis["path"] / SLABS, "")
    row("path slab by slab, no table [s]", own["path_slabs"], radis and radis["path"], "")
    for index, name in enumerate(("worst rms", "mean rms", "worst integral")):
        row(f"{name} [1]", own["errors"][index], radis and radis["errors"][index], "> 1")
    lines += [
        "",
        f"Grid: {POINTS} points here"
        + (f", {radis['points']} in RADIS {radis['version']}." if radis else "."),
        f"Table against slab by slab: rms {report['table_rms']:.1e} of the peak, integral"
        f" {report['table_integral']:.1e}.",
        f"Nine sight lines of 250 slabs, all systems and continua, two processes: {nine[1] + nine[2]:.1f} s"
        f" of CPU on either ({nine[1]:.1f} s for line lists and table), {nine[0]:.1f} s of wall time on this"
        f" machine, shared with others (bar {BARS['nine']:g} s); table {nine[3] / 1e6:.0f} MB.",
        f"Largest memory of a process: {peak:.0f} MB (bar {BARS['memory']:g} MB).",
    ]
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--radis", help="python of the environment that holds RADIS")
    parser.add_argument(
        "--radis-slabs", type=int, default=SLABS, help="slabs RADIS crosses; the time is scaled"
    )
    arguments = parser.parse_args()
    nine = nine_sight_lines()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    peak = max(peak, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e3)
    lists = benchmark_lists()
    report = compare(lists, log_grid(RANGE, POINTS), arguments.radis, arguments.radis_slabs)
    lines = describe(report, nine, peak)
    print("\n".join(lines))
    rows = growth(lists)
    write_report(lines, rows)
    for what, value, seconds in rows:
        print(f"{what:36s} {value:8d} {seconds:8.3f} s")


if __name__ == "__main__":
    main()
