"""`plasmapyro calibrate`: from raw calibration files to what `plasmapyro correct` needs."""

import sys
from pathlib import Path

import numpy as np

from plasmapyro import io, progress
from plasmapyro.checks import counted
from plasmapyro.commands.options import told
from plasmapyro.commands.outputs import require_writable
from plasmapyro.instrument.bands import radiometer_calibration
from plasmapyro.instrument.line_lamp import find_lines
from plasmapyro.instrument.spectrometer import STATUS
from plasmapyro.instrument.stage import band_response, calibrate_exposures, pyrometer_calibration
from plasmapyro.quality.catalogue import OF_CALIBRATION
from plasmapyro.quality.rule import Case, look
from plasmapyro.readers.calibration import (
    check_calibration,
    instruments,
    read_bands,
    read_exposures,
    read_line_lamp,
    read_points,
)
from plasmapyro.readers.stage import sources
from plasmapyro.tables import weakest

RESPONSE = {  # the modelled MR1SB, as in config/config.yaml
    "silicon_table": "silicon_green_2008",
    "top_thickness": 200e-6,
    "bottom_thickness": 400e-6,
    "short_wavelength_edge": 750e-9,
    "edge_sigma": 5e-9,
    "long_wavelength_limit": 1150e-9,
    "wavelength_step": 0.5e-9,
}
LINE_SEARCH, LINE_TO_NOISE = 1e-9, 50.0  # [m] how far off a line may be; fainter lines are left out
CURVE = np.arange(400.0, 4001.0, 10.0)  # [K] where the curves are tabulated


def run(options):
    """Run `plasmapyro calibrate`: folder in, files out, and a summary."""
    out = Path(options.out)
    names = {"pyrometer": ["response.nc", "calibration.nc"], "spectrometer": ["spectrometer_calibration.nc"]}
    names["radiometer"] = ["radiometer_calibration.nc"]
    files = [] if check_calibration(options.folder) else instruments(options.folder)
    outputs = [out / name for instrument in files for name in names[instrument]]
    outputs += [options.plot] * bool(options.plot)
    require_writable(outputs, [options.folder, options.response])
    results, lines = calibrated(options), []
    io.write_labelled([(out / f"{name}.nc", dataset) for name, dataset in results.items()])
    if "calibration" in results:
        lines += _of_pyrometer(results["calibration"])
    if "spectrometer_calibration" in results:
        lines += _of_spectrometer(results["spectrometer_calibration"])
        lines += _of_lines(read_line_lamp(options.folder))
    if "radiometer_calibration" in results:
        lines += _of_radiometer(results["radiometer_calibration"])
    if options.plot:
        from plasmapyro.plots import instrument as plots  # matplotlib, which only pictures need

        if not {"calibration", "spectrometer_calibration"} & set(results):
            raise ValueError("--plot draws a pyrometer or a spectrometer; a radiometer has no picture")
        if "calibration" in results:
            plots.calibration(results["calibration"], [options.plot])
        else:
            plots.spectrometer_factor(results["spectrometer_calibration"], [options.plot])
    sys.stdout.write("\n".join(lines) + "\n")
    progress.say("done")


def calibrated(options):
    """The calibrations that options of the command ask for: mapping of contract -> Dataset, labelled."""
    progress.say(f"reading {options.folder}")
    found = check_calibration(options.folder)
    if found:
        raise ValueError("\n".join(found))
    results, present = {}, instruments(options.folder)
    if "pyrometer" in present:
        response = response_of(options.response)
        points = read_points(options.folder)
        result = _calibrated(
            response,
            points,
            options.source_temperature_uncertainty_k,
            options.signal_uncertainty,
            options.instrument_range_k,
        )
        result.attrs["origin"] = weakest([result.attrs["origin"], points.attrs["origin"]])
        results |= {"response": response, "calibration": result}
    if "spectrometer" in present:
        exposures = read_exposures(options.folder)
        results["spectrometer_calibration"] = calibrate_exposures(
            exposures,
            saturation_counts=options.saturation_counts,
            least_net_counts=options.least_net_counts,
            noise_block=50,
            fit_range=[edge * 1e-9 for edge in options.fit_range_nm] if options.fit_range_nm else None,
        ).assign_attrs(origin=exposures.attrs["origin"])
    if "radiometer" in present:
        bands, points = read_bands(options.folder)
        results["radiometer_calibration"] = radiometer_calibration(
            bands, points, source_temperature_uncertainty=options.source_temperature_uncertainty_k
        )
    said = [
        words
        for words in calibration_findings(options.folder, results.get("response"), results.get("calibration"))
        if not any(words.endswith(f"[{name}]") for name in options.accept)
    ]
    if said:
        raise ValueError(
            "\n".join([*said, "if that is as it should be, go on with --accept and the rule's name"])
        )
    read = [*sources(options.folder), *([options.response] if options.response else [])]
    config = {"calibrate": told(options, "folder", "response", "plot")}
    return {name: io.labelled(dataset, name, read, config) for name, dataset in results.items()}


def response_of(path=None):
    """Responses of both bands: of a file, or without one modelled, of the MR1SB."""
    return io.read(path, "response").sortby("wavelength") if path else band_response(**RESPONSE)


def calibration_findings(folder, response=None, result=None):
    """What contradicts itself in a calibration folder, in the words of the rules.

    `response` of the bands, by default that of the modelled MR1SB; without `result` ('calibration') one is
    made with the usual settings.
    """
    present, held = instruments(folder), {}
    if "pyrometer" in present:
        points = read_points(folder)
        response = response_of() if response is None else response
        held |= {"points": points, "response": response}
        held["calibration"] = result if result is not None else _calibrated(response, points)
    if "spectrometer" in present:
        held["exposures"] = read_exposures(folder)
    return [finding.words for finding in look(Case(place=Path(folder), **held), OF_CALIBRATION)]


def _calibrated(response, points, temperature_error=3.0, signal_error=0.01, span=(973.0, 2073.0)):
    return pyrometer_calibration(
        response,
        points,
        source_temperature_uncertainty=temperature_error,
        signal_uncertainty=signal_error,
        instrument_range=span,
        calibration_temperature=CURVE,
        draws=2000,
        seed=1,
    )


def _of_pyrometer(result):
    low, high = result.fit_range.values
    phi, own = float(result.sensitivity_ratio), float(result.sensitivity_ratio_uncertainty)
    return [
        f"pyrometer: {result.source_temperature.size} points, {low:g} to {high:g} K (beyond: extrapolated)",
        f"  phi {phi:.4g} +- {own:.2g}; residuals: modelled curve up to"
        f" {100 * float(np.abs(result.model_residual).max()):.2g} %, quadratic up to"
        f" {100 * float(np.abs(result.fit_residual).max()):.2g} %",
    ]


def _of_radiometer(result):
    names = ", ".join(
        f"{name} {value:.3g} ({100 * error:.2g} %)"
        for name, value, error in zip(
            result.band.values,
            result.band_sensitivity.values,
            result.band_sensitivity_uncertainty.values,
            strict=True,
        )
    )
    return [f"radiometer: {result.attrs['calibration']}, sensitivities {names}"]


def _of_lines(lamp):
    """What the lines of a Hg(Ar) lamp say about wavelengths and width."""
    if lamp is None:
        return []
    wavelength, net, width = lamp
    found = find_lines(
        wavelength, net, expected_fwhm=width, search=LINE_SEARCH, least_signal_to_noise=LINE_TO_NOISE
    )
    off = np.array([line.wavelength - line.certified for line in found]) * 1e9
    return [
        f"  wavelengths: {off.size} lines of Hg and Ar, off by {off.mean():+.3f} nm on average,"
        f" {np.abs(off).max():.3f} nm at worst; width {np.median([line.fwhm for line in found]) * 1e9:.2f} nm"
    ]


def _of_spectrometer(result):
    status = result.pixel_status.values
    noise, common = (
        100 * float(np.nanmedian(result[name]))
        for name in ("calibration_factor_uncertainty", "calibration_factor_common")
    )
    return [
        f"spectrometer: {status.size} pixels: {counted(status, STATUS)}",
        f"  uncertainty of the factor: {noise:.2g} % from noise, {common:.2g} % common to all (medians)",
    ]
