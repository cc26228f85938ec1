"""`plasmapyro heat-flux`: what a calorimeter takes in the jet where a Pitot probe reads so much."""

import sys

from plasmapyro import io
from plasmapyro.commands.options import count, option, positive, seed, share
from plasmapyro.commands.outputs import require_writable
from plasmapyro.facility.prediction import predict

DESCRIPTION = """\
Predict the heat flux of a cold copper calorimeter in the air jet of the Plasmatron (16 g/s, probe 385 mm
behind the exit) where a cooled Pitot probe reads PITOT above the chamber pressure, and the jet there, with
95 % intervals. Computed jets with radiation loss and mixing are used with whatever mixing meets a measured
pair, for every recombination and Pitot nose that is admitted. (*): half of the draws or more lie beyond the
computed flows. Enthalpy from cold air at 298 K."""
EXAMPLE = """\
example:
  plasmapyro heat-flux 5 15 50 --pressure-mbar 100 --pitot-radius-mm 12.5 12.5"""
COLUMNS = {  # column -> quantity, factor from SI, digits
    "heat_flux_kw_m2": ("heat_flux", 1e-3, 0),
    "temperature_k": ("temperature", 1.0, 0),
    "enthalpy_mj_kg": ("enthalpy", 1e-6, 1),
    "speed_m_s": ("speed", 1.0, 0),
    "power_kw": ("numerical_power", 1e-3, 0),
}


def add(command):
    """Add the arguments to the subcommand's parser."""
    command.add_argument("pitot", metavar="PITOT", nargs="+", type=positive, help="Pitot pressures [Pa]")
    option(command, "--pressure-mbar", positive, 50.0, "of the chamber, 50 to 100")
    option(command, "--radius-mm", positive, 25.0, "of the calorimeter")
    command.add_argument(
        "--shape",
        choices=("hemisphere", "blunt"),
        default="hemisphere",
        help="of the calorimeter; blunt: a flat face with a shoulder",
    )
    pair(command, "--pitot-radius-mm", (5.0, 25.0), "of the Pitot nose, between 5 and 25")
    pair(command, "--recombination", (0.01, 0.1), "admitted of the calorimeter, between 0.01 and 1")
    command.add_argument("--pair", default="Num-2", help="measured pair that is met (default: Num-2)")
    option(command, "--flux-uncertainty", share, 0.1, "of its heat flux, relative")
    option(command, "--pressure-uncertainty", share, 0.05, "of its Pitot pressure, relative")
    option(command, "--draws", count, 400, "draws of the interval")
    option(command, "--seed", seed, 1, "of the draws")
    command.add_argument("--csv", metavar="FILE.csv", help="write the table there, too")


def pair(command, name, default, words):
    """Add an option with a low and a high end."""
    words = f"{words} (default: {default[0]:g} {default[1]:g})"
    command.add_argument(name, nargs=2, type=positive, default=default, metavar=("LOW", "HIGH"), help=words)


def run(options):
    """Run `plasmapyro heat-flux`: Pitot pressures in, a table out."""
    if options.csv:
        require_writable([options.csv], [])
    found = predict(
        options.pitot,
        100 * options.pressure_mbar,
        radius=1e-3 * options.radius_mm,
        shape=options.shape,
        pair=options.pair,
        recombination=options.recombination,
        nose=[1e-3 * one for one in options.pitot_radius_mm],
        flux_uncertainty=options.flux_uncertainty,
        pressure_uncertainty=options.pressure_uncertainty,
        draws=options.draws,
        seed=options.seed,
    )
    rows = [["pitot_pa", *COLUMNS, "beyond"]]
    for k, pitot in enumerate(options.pitot):
        cells = [
            [f"{factor * value:.{digits}f}" for value in found[name][:, k]]
            for name, factor, digits in COLUMNS.values()
        ]
        rows.append(
            [f"{pitot:g}", *(" ".join(cell) for cell in cells), "*" if found["inside"][k] < 0.5 else ""]
        )
    low, middle, high = found["mixing"]
    lines = [
        f"{options.pair}: {100 * found['explained']:.0f} % of the draws meet it, with a mixing length of"
        f" {low:.3f} to {high:.3f} (median {middle:.3f}) of the torch radius",
        "low, median, high:",
        *("  ".join(f"{cell:>17}" for cell in row).rstrip() for row in rows),
    ]
    sys.stdout.write("\n".join(lines) + "\n")
    if options.csv:
        io.write_text("\n".join(",".join(_split(row)) for row in rows) + "\n", options.csv)


def _split(row):
    """Cells of a row of the file: low, median and high in columns of their own."""
    if row[0] == "pitot_pa":
        ends = ("low", "median", "high")
        return [row[0], *(f"{name}_{end}" for name in COLUMNS for end in ends), row[-1]]
    return [word for cell in row[:-1] for word in cell.split()] + [row[-1]]
