"""The command `plasmapyro`: one data set at a time, without a workflow."""

import argparse
import sys
import time
import traceback
from pathlib import Path

from plasmapyro import __doc__ as PACKAGE
from plasmapyro import io
from plasmapyro.diagnosis import command
from plasmapyro.radiation.spectrum_text import compose_spectrum
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.readers.stage import read_test
from plasmapyro.sightline import neqair
from plasmapyro.tables import weakest

DONE, FAULT_OF_OURS, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
MOST_GRID_POINTS = 5_000_000  # 2 GB of memory
NANOMETRE = 1e-9

RADIANCE = """\
Compute the spectral radiance of the gas along a sight line, line by line and by component, with
its optical depth and its view through a slit, and write it as netCDF.

SIGHTLINE is a netCDF file (path_distance [m], species, temperature [K], pressure [Pa],
number_density [m-3]) or a line-of-sight text file as NEQAIR reads it (x [cm], densities [cm-3],
temperatures [K]; versions 14 and 15). The light travels from its first point to its last."""
RADIANCE_EXAMPLE = """\
example:
  plasmapyro radiance LOS.dat --out radiance.nc --wavelength-nm 760 900 --grid-points 80000

exit status: 0 done, 2 bad input or usage (one message, nothing written), 1 a fault of ours"""


DIAGNOSE = """\
Compare a test with the simulation of its condition: where they depart, which effect of a catalogue explains
it
(or that none does), what that costs in kelvin, and the temperature with the effect in the model.

TEST is a netCDF file (contract 'test') or a folder with test.nc, or with raw files and test.yaml."""
DIAGNOSE_EXAMPLE = """\
example:
  plasmapyro diagnose results/twin/csic_160kW --radiance results/radiation \\
      --instrument results/instrument --out diagnosis

writes diagnosis.json, residual_map.nc, temperature.nc and index.html, all or none.
exit status: 0 done, 2 bad input or usage (one message, nothing written), 1 a fault of ours; with
--fail-on-finding also 3 a cause was named, 4 something is wrong that no known cause explains"""


class Progress:
    """Steps of a run with the time they end at, on a terminal only."""

    def __init__(self, stream):
        self.stream, self.start = stream, time.monotonic()

    def step(self, message):
        if self.stream.isatty():
            self.stream.write(f"[{time.monotonic() - self.start:5.1f} s] {message}\n")


def radiance(options, progress):
    """Run `plasmapyro radiance`: file in, files out."""
    outputs = [options.out, options.spectrum_text, options.line_of_sight_text]
    _require_writable([Path(path) for path in outputs if path], [options.sightline, options.response])
    progress.step(f"reading {options.sightline}")
    sightline = _read_sightline(options.sightline)
    response = io.read(options.response, "response") if options.response else None
    progress.step(
        f"computing {sightline.sizes['path_distance']} layers on {options.grid_points} wavelengths,"
        " some 0.05 s each per 100 000 wavelengths"
    )
    result = line_of_sight_radiance(
        sightline,
        response,
        wavelength_range=[edge * NANOMETRE for edge in options.wavelength_nm],
        grid_points=options.grid_points,
        slit_fwhm=options.slit_fwhm_nm * NANOMETRE,
    )
    result.attrs["origin"] = weakest([result.attrs["origin"], sightline.attrs.get("origin", "modelled")])
    progress.step(f"writing {options.out}")
    sources = [path for path in (options.sightline, options.response) if path]
    settings = {name: getattr(options, name) for name in ("wavelength_nm", "grid_points", "slit_fwhm_nm")}
    contract = "radiation" if response is not None else "spectrum"
    io.write(result, options.out, contract, sources=sources, config={"radiation": settings})
    if options.spectrum_text:
        text = compose_spectrum(result["wavelength"].values, result["gas_radiance"].values)
        io.write_text(text, options.spectrum_text)
    if options.line_of_sight_text:
        io.write_text(neqair.compose(sightline), options.line_of_sight_text)
    progress.step("done")


def diagnose(options, progress):
    """Run `plasmapyro diagnose`: test in, four files out."""
    out = Path(options.out)
    if out.exists() and not out.is_dir():
        raise ValueError(f"{out}: is a file; name a folder")
    progress.step(f"reading {options.test}")
    path = Path(options.test)
    test = path / "test.nc" if path.is_dir() and not (path / "test.yaml").exists() else path
    data = io.read(test, "test") if test.is_file() else read_test(test)
    inputs = command.load_inputs(options.radiance, options.instrument, options.variations)
    progress.step("fitting the base model, screening the catalogue, measuring the gain: some 10 s")
    digest = io.digest(test) if test.is_file() else None
    result = command.diagnose_test(data, inputs, without=tuple(options.without), digest=digest)
    progress.step(f"writing {out}")
    command.write_all(result, out, sources=[test] if test.is_file() else [], page=command.page_writer())
    sys.stdout.write(result.report["verdict"]["sentences"][0] + "\n")
    progress.step("done")
    return command.exit_status(result.report, options.fail_on_finding)


def _read_sightline(path):
    """Dataset of contract 'sightline' from netCDF or NEQAIR-style text."""
    if io.is_netcdf(path):
        return io.read(path, "sightline")
    try:
        return neqair.parse(io.read_text(path))
    except io.contracts.ContractError:
        raise
    except ValueError as fault:
        raise ValueError(f"{path}: {fault}") from None


def _require_writable(outputs, inputs):
    """Refuse before the work begins what could not be written after it."""
    taken = {Path(path).resolve() for path in inputs if path}
    for path in outputs:
        if path.is_dir():
            raise ValueError(f"{path}: is a folder; name a file")
        if path.resolve() in taken:
            raise ValueError(f"{path}: is an input or another output; nothing is overwritten")
        taken.add(path.resolve())
        if path.parent.exists() and not path.parent.is_dir():
            raise ValueError(f"{path.parent}: is not a folder")


def _grid_points(word):
    number = int(word)
    if not 0 < number <= MOST_GRID_POINTS:
        raise argparse.ArgumentTypeError(f"must lie in [1, {MOST_GRID_POINTS}]; got {number}")
    return number


def parser():
    """The argument parser of all subcommands; each sets `run`, a function (options, progress)."""
    top = argparse.ArgumentParser(prog="plasmapyro", description=PACKAGE)
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    _add_radiance(commands)
    _add_diagnose(commands)
    return top


def _add_diagnose(commands):
    one = commands.add_parser(
        "diagnose",
        help="what a simulation gets wrong",
        description=DIAGNOSE,
        epilog=DIAGNOSE_EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    one.set_defaults(run=diagnose)
    one.add_argument("test", metavar="TEST", help="test folder or netCDF file")
    one.add_argument(
        "--radiance", required=True, metavar="FOLDER", help="spectra of all conditions, {condition}.nc"
    )
    one.add_argument(
        "--instrument",
        required=True,
        metavar="FOLDER",
        help="response.nc, calibration.nc, spectrometer_calibration.nc",
    )
    one.add_argument(
        "--variations",
        metavar="FOLDER",
        help="varied spectra, {condition}.nc (default: radiation_variations beside the spectra)",
    )
    one.add_argument("--out", required=True, metavar="FOLDER", help="where the four files go")
    one.add_argument(
        "--without",
        nargs="*",
        default=[],
        metavar="EFFECT",
        help="effects to leave out",
    )
    one.add_argument(
        "--fail-on-finding",
        action="store_true",
        help="exit status 3 or 4 for a finding",
    )


def _add_radiance(commands):
    command = commands.add_parser(
        "radiance",
        help="spectral radiance of the gas along a sight line",
        description=RADIANCE,
        epilog=RADIANCE_EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=radiance)
    command.add_argument("sightline", metavar="SIGHTLINE", help="sight line, netCDF or NEQAIR-style text")
    command.add_argument("--out", required=True, metavar="FILE.nc", help="where the spectrum goes")
    command.add_argument(
        "--wavelength-nm",
        nargs=2,
        type=float,
        default=[700.0, 1200.0],
        metavar=("FIRST", "LAST"),
        help="range in vacuum, within 650 to 1250 nm (default: 700 1200)",
    )
    command.add_argument(
        "--grid-points",
        type=_grid_points,
        default=160_000,
        metavar="N",
        help="points of the logarithmic wavenumber grid; too few for the line widths are refused with the"
        " number that would do (default: 160000, enough for 700 to 1200 nm)",
    )
    command.add_argument(
        "--slit-fwhm-nm",
        type=float,
        default=0.75,
        metavar="WIDTH",
        help="full width at half maximum of the Gaussian slit (default: 0.75 nm)",
    )
    command.add_argument(
        "--response",
        metavar="FILE.nc",
        help="responses of two pyrometer bands (wavelength [m], responsivity_wide, responsivity_narrow [1]),"
        " as results/instrument/response.nc; without it the result holds no band signals",
    )
    command.add_argument(
        "--spectrum-text",
        metavar="FILE",
        help="write the spectrum also as text: wavelength [Angstrom], radiance [W cm-2 sr-1 um-1] and its"
        " integral",
    )
    command.add_argument(
        "--line-of-sight-text",
        metavar="FILE",
        help="write the sight line also as NEQAIR 15 reads it (LOS.dat)",
    )


def main(arguments=None):
    """Run the command line.

    Parameters
    ----------
    arguments : list of str, optional
        Those of the process by default.

    Returns
    -------
    int
        Exit status: 0 done, 2 bad input or usage, 1 a fault of ours.
    """
    options = parser().parse_args(arguments)
    try:
        status = options.run(options, Progress(sys.stderr))
    except (ValueError, OSError) as fault:
        sys.stderr.write(f"plasmapyro: {fault}\n")
        return BAD_INPUT
    except KeyboardInterrupt:
        sys.stderr.write("plasmapyro: stopped; nothing was written\n")
        return INTERRUPTED
    except Exception:
        traceback.print_exc()
        sys.stderr.write("plasmapyro: this is a fault of the program, not of your input; please report it\n")
        return FAULT_OF_OURS
    return status or DONE
