"""`plasmapyro heat-flux`: what a calorimeter takes in the jet where a Pitot probe reads so much."""

import sys

from plasmapyro import io
from plasmapyro.commands.options import settings
from plasmapyro.commands.outputs import require_writable
from plasmapyro.facility.causes import causes, sentences
from plasmapyro.facility.prediction import predict

COLUMNS = {  # column -> quantity, factor from SI, digits
    "heat_flux_kw_m2": ("heat_flux", 1e-3, 0),
    "temperature_k": ("temperature", 1.0, 0),
    "enthalpy_mj_kg": ("enthalpy", 1e-6, 1),
    "speed_m_s": ("speed", 1.0, 0),
    "power_kw": ("numerical_power", 1e-3, 0),
}
DRAWS = 2000  # of each cause
ODD = 3.0  # times off that ask for a second look at units


def run(options):
    """Run `plasmapyro heat-flux`: Pitot pressures in, a table out."""
    measured = options.measured_kw_m2 or []
    if measured and len(measured) != len(options.pitot):
        raise ValueError(
            f"--measured-kw-m2: a heat flux for each PITOT; got {len(measured)} for {len(options.pitot)}"
        )
    if options.csv:
        require_writable([options.csv], [])
    nose = [1e-3 * one for one in options.pitot_radius_mm]
    pressure = 100 * options.pressure_mbar
    found = predict(options.pitot, pressure, **settings(options, predict) | {"nose": nose})
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
    if any(row[-1] == "*" for row in rows):
        lines.append("*: most draws lie beyond the jets that were computed")
    for k, flux in enumerate(measured):
        lines += named(options, nose, found, k, 1e3 * flux)
    sys.stdout.write("\n".join(lines) + "\n")
    if options.csv:
        io.write_text("\n".join(",".join(_split(row)) for row in rows) + "\n", options.csv)


def named(options, nose, found, k, flux):
    """Lines that name the causes of a measured pair: the k-th Pitot pressure and a heat flux [W m-2]."""
    known = settings(options, causes) | {"nose": nose, "admissible": options.recombination, "draws": DRAWS}
    said = sentences(causes(flux / found["share"][k], options.pitot[k], **known))
    low, _, high = found["heat_flux"][:, k]
    ratio = max(low / flux, flux / high)
    if ratio > ODD:
        said.append(f"{ratio:.3g} times off what is foretold: is it in kW/m2, and Pa above the chamber's?")
    return [f"{1e-3 * flux:g} kW/m2 at {options.pitot[k]:g} Pa:", *(f"  {one}" for one in said)]


def _split(row):
    """Cells of a row of the file: low, median and high in columns of their own."""
    if row[0] == "pitot_pa":
        ends = ("low", "median", "high")
        return [row[0], *(f"{name}_{end}" for name in COLUMNS for end in ends), row[-1]]
    return [word for cell in row[:-1] for word in cell.split()] + [row[-1]]
