"""Writes the tables of docs/file-formats.md from the contracts that every file is checked against."""

from pathlib import Path

from plasmapyro.contracts import DATASETS, VARIABLES

PAGE = Path(__file__).resolve().parents[1] / "docs" / "file-formats.md"
MARK = "<!-- from here on written by workflow/formats.py -->\n"
FILES = {  # contract -> where a run leaves it; "" for files that only commands write or read
    "gas": "results/gas/{gas}.nc",
    "net_emission": "results/gas/emission/{gas}.nc",
    "flow": "results/flow/{condition}.nc",
    "probe_readings": "results/facility/{condition}.nc",
    "facility": "results/facility.nc",
    "sightline": "results/sightline/{condition}.nc",
    "surface_view": "results/surface_view/{condition}.nc",
    "radiometer_calibration": "",
    "radiation": "results/radiation/{condition}.nc",
    "spectrum": "",
    "reflected_radiance": "results/reflection/{condition}.nc",
    "gas_variations": "results/radiation_variations/{condition}.nc",
    "response": "results/instrument/response.nc",
    "ratio_curve": "results/instrument/ratio_curve.nc",
    "calibration_points": "results/instrument/calibration_points.nc",
    "calibration": "results/instrument/calibration.nc",
    "spectrometer_counts": "results/twin/spectrometer_counts.nc",
    "spectrometer_exposures": "results/instrument/spectrometer_exposures.nc",
    "spectrometer_calibration": "results/instrument/spectrometer_calibration.nc",
    "gas_signal": "results/analysis/gas_signal.nc",
    "surface_radiance": "results/analysis/surface_radiance.nc",
    "visibility": "results/analysis/visibility.nc",
    "apparent_temperature": "results/analysis/apparent_temperature.nc",
    "corrected_reading": "",
    "error_map": "results/analysis/error_map.nc",
    "transient": "results/analysis/transient.nc",
    "test": "results/experiment/{test}/test.nc",
    "pyrometer_correction": "results/experiment/{test}/pyrometer_correction.nc",
    "spectrometer_correction": "results/experiment/{test}/spectrometer_correction.nc",
    "joint_estimate": "results/experiment/{test}/joint_estimate.nc",
    "temperature": "results/experiment/{test}/temperature.nc",
    "truth": "results/twin/{test}/truth.nc",
    "emissivity_estimate": "",
    "correction": "",
    "simulations": "",
    "residual_map": "results/diagnosis/{test}/residual_map.nc",
    "diagnosis_temperature": "results/diagnosis/{test}/temperature.nc",
    "gas_spectra": "results/design/gas_spectra.nc",
    "band_design": "results/design/band_design.nc",
    "reflection": "results/design/reflection.nc",
    "trust": "results/design/trust.nc",
    "claims": "results/claims.nc",
    "study": "results/study.nc",
    "study_flow": "results/study/flow/{flow}.nc",
    "study_signal": "results/study/signal/{sight_line}.nc",
}


def describe(contract):
    """One section: the variables of a contract, by the dimensions they stand on."""
    groups = {}
    for key, dims in DATASETS[contract].items():
        name = key.rstrip("?")
        units = VARIABLES[name].units or "text"
        groups.setdefault(dims, []).append(
            f"`{name}` {units}" + (", optional" if key.endswith("?") and contract != "correction" else "")
        )
    where = f": `{FILES[contract]}`" if FILES[contract] else ""
    lines = [f"**{contract}**{where}", ""]
    lines += [f"- {', '.join(dims) or 'single values'}: {'; '.join(found)}" for dims, found in groups.items()]
    return "\n".join(lines) + "\n"


def tables():
    """All sections, in the order of the chain."""
    return "\n".join(describe(contract) for contract in FILES if contract in DATASETS)


if __name__ == "__main__":
    text = PAGE.read_text(encoding="utf-8").partition(MARK)[0]
    PAGE.write_text(f"{text}{MARK}\n{tables()}", encoding="utf-8")
