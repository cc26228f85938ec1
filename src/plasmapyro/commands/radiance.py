"""`plasmapyro radiance`: the gas's light along a sight line."""

import sys

from plasmapyro import contracts, io, progress
from plasmapyro.commands.outputs import require_writable
from plasmapyro.quality.catalogue import OF_SIGHTLINE
from plasmapyro.quality.rule import Case, look
from plasmapyro.radiation.atoms import WHOLE_RANGE
from plasmapyro.radiation.slit import FWHM_PER_SIGMA, REACH
from plasmapyro.radiation.spectrum_text import compose_spectrum
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.readers.text import read_lines
from plasmapyro.sightline import neqair
from plasmapyro.tables import weakest

NANOMETRE = 1e-9
UNITS = "; NEQAIR's text has x in cm, densities in cm-3, temperatures in K"


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
    low, high = (round(edge / NANOMETRE) for edge in WHOLE_RANGE)
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
    lines, _ = read_lines(path, io.LARGEST_TEXT)
    try:
        return contracts.check(contracts.label(neqair.parse("\n".join(lines)), "sightline"), "sightline")
    except ValueError as fault:
        units = UNITS if isinstance(fault, contracts.ContractError) else ""
        raise ValueError(f"{path}: {fault}{units}") from None
