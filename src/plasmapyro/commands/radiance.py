"""`plasmapyro radiance`: the gas's light along a sight line."""

import argparse
import sys

from plasmapyro import contracts, io, progress
from plasmapyro.commands.options import plot_option
from plasmapyro.commands.outputs import require_writable
from plasmapyro.quality.catalogue import OF_SIGHTLINE
from plasmapyro.quality.rule import Case, look
from plasmapyro.radiation.atoms import TABLE_RANGE
from plasmapyro.radiation.slit import FWHM_PER_SIGMA, REACH
from plasmapyro.radiation.spectrum_text import compose_spectrum
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.sightline import neqair
from plasmapyro.tables import weakest

MOST_GRID_POINTS = 5_000_000  # 2 GB of memory
NANOMETRE = 1e-9

DESCRIPTION = """\
Compute the spectral radiance of the gas along a sight line, line by line and by component, with
its optical depth and its view through a slit, and write it as netCDF.

SIGHTLINE is a netCDF file (path_distance [m], species, temperature [K], pressure [Pa],
number_density [m-3]) or a line-of-sight text file as NEQAIR reads it (x [cm], densities [cm-3],
temperatures [K]; versions 14 and 15). The light travels from its first point to its last."""
EXAMPLE = """\
example:
  plasmapyro radiance LOS.dat --out radiance.nc --wavelength-nm 760 900 --grid-points 80000"""


def add(command):
    """Add the arguments to the subcommand's parser."""
    command.add_argument("sightline", metavar="SIGHTLINE", help="sight line, netCDF or NEQAIR-style text")
    command.add_argument("--out", required=True, metavar="FILE.nc", help="where the spectrum goes")
    plot_option(command, "the spectrum and its brightest components")
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


def _grid_points(word):
    number = int(word)
    if not 0 < number <= MOST_GRID_POINTS:
        raise argparse.ArgumentTypeError(f"must lie in [1, {MOST_GRID_POINTS}]; got {number}")
    return number


def run(options):
    """Run `plasmapyro radiance`: file in, files out."""
    outputs = [options.out, options.spectrum_text, options.line_of_sight_text, options.plot]
    require_writable([path for path in outputs if path], [options.sightline, options.response])
    result = radiated(options)
    progress.say(f"writing {options.out}")
    io.write_labelled([(options.out, result)])
    if options.spectrum_text:
        text = compose_spectrum(result["wavelength"].values, result["gas_radiance"].values)
        io.write_text(text, options.spectrum_text)
    if options.line_of_sight_text:
        io.write_text(neqair.compose(_read_sightline(options.sightline)), options.line_of_sight_text)
    if options.plot:
        from plasmapyro.plots import radiation as plots  # matplotlib, which only pictures need

        plots.spectrum(result, [options.plot])
    sys.stdout.write(summary(result))
    progress.say("done")


def radiated(options):
    """The spectrum that options of the command ask for, labelled."""
    _check_units(options)
    progress.say(f"reading {options.sightline}")
    sightline = _read_sightline(options.sightline)
    for finding in look(Case(options.sightline, sightline=sightline), OF_SIGHTLINE):
        progress.warn(finding.words)
    response = io.read(options.response, "response") if options.response else None
    progress.say(
        f"computing {sightline.sizes['path_distance']} layers on {options.grid_points} wavelengths,"
        " without those too dark to count"
    )
    result = line_of_sight_radiance(
        sightline,
        response,
        wavelength_range=[edge * NANOMETRE for edge in options.wavelength_nm],
        grid_points=options.grid_points,
        slit_fwhm=options.slit_fwhm_nm * NANOMETRE,
    )
    result.attrs["origin"] = weakest([result.attrs["origin"], sightline.attrs.get("origin", "modelled")])
    sources = [path for path in (options.sightline, options.response) if path]
    settings = {name: getattr(options, name) for name in ("wavelength_nm", "grid_points", "slit_fwhm_nm")}
    contract = "radiation" if response is not None else "spectrum"
    return io.labelled(result, contract, sources, {"radiation": settings})


def summary(result):
    """What came out, in two lines: how much light, where most; of which components, what the bands see."""
    light, slit = result["gas_radiance"], result["gas_radiance_slit"]
    brightest = int(slit.values.argmax())
    whole = float(light.integrate("wavelength"))
    parts = result["gas_radiance_component"].integrate("wavelength")
    parts = (parts / parts.sum()).sortby(-parts).isel(component=slice(3)) if float(parts.sum()) else parts[:0]
    said = ["mostly " + ", ".join(f"{str(one.component.values)} {float(one):.2g}" for one in parts)]
    if "band_signal" in result:
        wide, narrow = result["band_signal"].values
        said.append(f"band signals {wide:.4g} (wide), {narrow:.4g} (narrow) W m-2 sr-1")
    ends = light.wavelength.values[[0, -1]] / NANOMETRE
    return (
        f"spectrum: {ends[0]:.5g} to {ends[1]:.5g} nm, {whole:.4g} W m-2 sr-1, highest"
        f" {float(slit[brightest]) * 1e-6:.4g} W m-2 sr-1 um-1 at"
        f" {float(slit.wavelength_slit[brightest]) / NANOMETRE:.5g} nm\n  {'; '.join(said)}\n"
    )


def _check_units(options):
    """Refuse, in the unit of the option, what no spectrum is needed to see."""
    first, last = options.wavelength_nm
    low, high = (round(edge / NANOMETRE) for edge in TABLE_RANGE)
    if not low <= first < last <= high:
        raise ValueError(
            f"--wavelength-nm takes two rising wavelengths within {low} to {high} nm; got {first:g} {last:g}"
        )
    widest = (last - first) * FWHM_PER_SIGMA / (2 * REACH)
    if not 0 < options.slit_fwhm_nm < widest:
        raise ValueError(
            f"--slit-fwhm-nm must lie between 0 and {widest:.3g} nm for this range;"
            f" got {options.slit_fwhm_nm:g}"
        )


def _read_sightline(path):
    """Dataset of contract 'sightline' from netCDF or NEQAIR-style text."""
    if io.is_netcdf(path):
        return io.read(path, "sightline")
    try:
        return neqair.parse(io.read_text(path))
    except contracts.ContractError:
        raise
    except ValueError as fault:
        raise ValueError(f"{path}: {fault}") from None
