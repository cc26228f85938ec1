"""Behind `import plasmapyro`: what its commands do, with datasets instead of files; see docs/python.md."""

import json
import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import xarray as xr

from plasmapyro import cli, contracts, io, shipped
from plasmapyro import pictures as pictures  # the accessor `.pyro`
from plasmapyro.commands.options import check as check_options
from plasmapyro.readers.stage import read_test

Place = str | os.PathLike[str]
Test = Place | xr.Dataset
Calibration = Place | xr.DataTree
NANOMETRES = 1e9  # per metre: options of commands are in nm


def read(place: Place) -> xr.Dataset:
    """A test, from raw files or netCDF, or any result of ours.

    Parameters
    ----------
    place : path
        Folder with `test.yaml` and the raw files it describes, or with `test.nc`; or a netCDF file.

    Returns
    -------
    Dataset
        SI units, wavelengths in vacuum.

    Raises
    ------
    ValueError
        With one line per fault: file, line, what is wrong, what to do.
    """
    path = Path(place)
    contract = io.attributes(path).get("contract", "test") if path.is_file() else "test"
    if contract not in contracts.DATASETS:
        raise contracts.ContractError(f"{path}: says that it is {contract!r}, which is nothing of ours")
    found: xr.Dataset = read_test(path) if contract == "test" else io.read(path, contract)
    return found


def check(test: Test, calibration: Calibration | None = None) -> list[str]:
    """What contradicts itself in the data of a test, the worst first; an empty list if nothing does.

    Parameters
    ----------
    test : path or Dataset, contract 'test'
    calibration : path or DataTree, optional
        As for `correct`; with it a trial correction is made, so that pyrometer and spectrometer are compared.

    Raises
    ------
    ValueError
        With one line per fault, if the data cannot be processed.
    """
    from plasmapyro.commands.check import checked
    from plasmapyro.page.words import without_folders

    with _files(test, calibration) as (place, folder):
        _, found, failed = checked(place, folder)
    if failed:
        raise failed
    words = [finding.words for finding in found]
    return without_folders(words) if isinstance(test, xr.Dataset) else words


def calibrate(
    folder: Place,
    *,
    response: Place | None = None,
    source_temperature_uncertainty: float = 3.0,
    signal_uncertainty: float = 0.01,
    least_net_counts: float = 50.0,
    saturation_counts: float = 65000.0,
    fit_range: tuple[float, float] | None = None,
    instrument_range: tuple[float, float] = (973.0, 2073.0),
    accept: Collection[str] = (),
) -> xr.DataTree:
    """The calibration of a pyrometer, a spectrometer, or both.

    Parameters
    ----------
    folder : path
        Holds `calibration.yaml`, which names the raw files (docs/your-own-data.md).
    response : path of a file of contract 'response', optional
        Responses of both bands; those modelled for the MR1SB if left out.
    source_temperature_uncertainty : float [K]
        Of the black body before the pyrometer, standard.
    signal_uncertainty : float [1]
        Of one pyrometer signal, relative, standard.
    least_net_counts, saturation_counts : float [count]
        Net counts up to the one are no signal, raw counts from the other on are saturated.
    fit_range : (2,) floats [m], optional
        Pixels of the spectrometer to which Planck's law is fitted, in vacuum; all usable if left out.
    instrument_range : (2,) floats [K]
        Lowest and highest temperature that the pyrometer reads.
    accept : names of rules
        Contradictions that are as they should be.

    Returns
    -------
    DataTree
        `response` and `calibration` (pyrometer) and `spectrometer_calibration`, as far as described.

    Raises
    ------
    ValueError
        Everything that is wrong with the files, or contradicts itself.
    """
    from plasmapyro.commands.calibrate import calibrated

    options = _options(
        ["calibrate", str(folder), "--out", "."],
        response=response,
        source_temperature_uncertainty_k=source_temperature_uncertainty,
        signal_uncertainty=signal_uncertainty,
        least_net_counts=least_net_counts,
        saturation_counts=saturation_counts,
        fit_range_nm=fit_range and [edge * NANOMETRES for edge in fit_range],
        instrument_range_k=list(instrument_range),
        accept=list(accept),
    )
    return xr.DataTree.from_dict(calibrated(options))


def correct(
    test: Test,
    calibration: Calibration | None = None,
    *,
    estimator: str | None = None,
    reference_window: tuple[float, float] | None = None,
    keep_window: bool = False,
    signal_uncertainty: float = 0.01,
    gas_variation: float = 0.03,
    detection_level: float = 2.0,
    least_surface_share: float = 0.5,
    least_signal_to_noise: float = 10.0,
    reference_time: float | None = None,
    normalisation_wavelength: float | None = None,
    normalisation_half_width: float | None = None,
    temperature_range: tuple[float, float] = (600.0, 3500.0),
    saturation_counts: float = 65000.0,
    noise_block_pixels: int = 50,
    draws: int | None = None,
    seed: int = 2,
) -> xr.Dataset:
    """Surface temperatures with standard uncertainty and, for each sample, whether to trust it.

    Parameters
    ----------
    test : path or Dataset, contract 'test'
    calibration : path or DataTree, optional
        As from `calibrate`, the folder it was saved in, or raw files with `calibration.yaml`; the folder
        `calibration` in the test's or beside it if left out.
    estimator : 'reference', 'joint' or 'emissivity'; that of the command for such data by default
        What both instruments see in the reference window is subtracted, as in the paper; or one temperature
        is inferred from all signals, and the gas followed through the test.
    reference_window : (2,) floats [s], optional
        Instead of the one that the test states.
    keep_window : bool
        Go on although the surface already shows in the reference window.
    signal_uncertainty, gas_variation : float [1]
        Relative standard uncertainty of one signal, and of the gas about that of the reference window.
    detection_level : float
        Uncertainties that a corrected signal must exceed.
    least_surface_share : float [1]
        Of the surface in a signal, else `gas_dominated`.
    least_signal_to_noise : float
        Of a spectrum at the pivot.
    reference_time : float [s], optional
        The exposure nearest to it is the reference spectrum; middle of the window by default.
    normalisation_wavelength, normalisation_half_width : float [m], optional
        Pivot of the normalised fit in vacuum (1030 nm, or where the surface stands out most if no pixel is
        there), and how near pixels are averaged there (half the FWHM).
    temperature_range : (2,) floats [K]
        Where fits to spectra look.
    saturation_counts : float [count]
        Raw counts from here on are saturated.
    noise_block_pixels : int
        Pixels per estimate of the noise.
    draws, seed : int
        Monte Carlo draws (400 of the pyrometer, 100 of spectra by default); the same seed, the same result.

    Returns
    -------
    Dataset, contract 'correction' or 'joint_estimate'
        Times are those of the test; the attribute `findings` says what speaks against the data.

    Raises
    ------
    ValueError
        A test that cannot be processed, with every reason.
    """
    given = {key: value for key, value in locals().items() if key not in ("test", "calibration")}
    from plasmapyro.commands.correct import corrected

    half, pivot = given.pop("normalisation_half_width"), given.pop("normalisation_wavelength")
    given |= {
        "reference_window": reference_window and list(reference_window),
        "temperature_range_k": list(given.pop("temperature_range")),
        "normalisation_nm": pivot and pivot * NANOMETRES,
        "normalisation_half_width_nm": half and half * NANOMETRES,
    }
    with _files(test, calibration, needed=True) as (place, folder):
        result: xr.Dataset = corrected(_options(["correct", str(place)], instrument=folder, **given))[1]
    return result


def diagnose(
    test: Test,
    calibration: Calibration | None = None,
    *,
    simulations: Place | None = None,
    variations: Place | None = None,
    without: Collection[str] = (),
    saturation_counts: float = 65000.0,
) -> xr.DataTree:
    """Compare a test with the simulation of its condition.

    Where and when they depart, which effect of a catalogue explains it (or that none does), what that costs
    in kelvin, and the temperature with the effect in the model.

    Parameters
    ----------
    test : path or Dataset, contract 'test'
        Its attribute `condition` names the simulation.
    calibration : path or DataTree, optional
        As for `correct`.
    simulations : path, optional
        Folder of spectra, `{condition}.nc`, as results/radiation of the workflow; those shipped by default.
    variations : path, optional
        Folder of varied spectra; `radiation_variations` beside the spectra by default.
    without : names of effects that are not looked for
    saturation_counts : float [count]
        Raw counts from here on are saturated.

    Returns
    -------
    DataTree
        `temperature` (contract 'diagnosis_temperature') and `residual_map`; the attribute `report` is the
        JSON text of `diagnosis.schema.json`, with the answer in `verdict`.

    Raises
    ------
    ValueError
        A test that cannot be processed, with every reason; a condition without simulation.
    """
    from plasmapyro.commands.diagnose import diagnosed

    with _files(test, calibration, needed=True) as (place, folder):
        options = _options(
            ["diagnose", str(place)],
            instrument=folder,
            radiance=simulations,
            variations=variations,
            without=list(without),
            saturation_counts=saturation_counts,
        )
        found, _ = diagnosed(options)
        tree = xr.DataTree.from_dict(
            {
                "temperature": io.labelled(found.temperature, "diagnosis_temperature"),
                "residual_map": io.labelled(found.residual_map, "residual_map"),
            }
        )
    tree.attrs["report"] = json.dumps(found.report, allow_nan=False)
    return tree


def radiance(
    sightline: Place | xr.Dataset,
    response: Place | None = None,
    *,
    wavelength_range: tuple[float, float] = (700e-9, 1200e-9),
    grid_points: int = 160_000,
    slit_fwhm: float = 0.75e-9,
) -> xr.Dataset:
    """Spectral radiance of the gas, line by line and by radiating system, and its view through a slit.

    Parameters
    ----------
    sightline : path or Dataset, contract 'sightline'
        Or a line-of-sight text file as NEQAIR 14 and 15 read it. The light travels from its first point
        to its last.
    response : path of a file of contract 'response', optional
        Adds the signals of two pyrometer bands.
    wavelength_range : (2,) floats [m]
        In vacuum, within 650 to 2500 nm.
    grid_points : int
        Of a logarithmic wavenumber grid; too few are refused with the number that would do.
    slit_fwhm : float [m]
        Full width at half maximum of the Gaussian slit.

    Returns
    -------
    Dataset, contract 'spectrum', or 'radiation' with a response

    Raises
    ------
    ValueError
        A sight line that cannot be read, a range without data, a grid too coarse.
    """
    from plasmapyro.commands.radiance import radiated

    with _file(sightline, "sightline") as place:
        options = _options(
            ["radiance", str(place), "--out", "x.nc"],
            response=response,
            wavelength_nm=[round(edge * NANOMETRES, 9) for edge in wavelength_range],
            grid_points=grid_points,
            slit_fwhm_nm=round(slit_fwhm * NANOMETRES, 9),
        )
        result: xr.Dataset = radiated(options)
    return result


def simulations() -> xr.DataTree:
    """Light of the gas between torch and probe for nine powers, computed by this package.

    Air at 50 mbar and 16 g/s, 50 to 130 kW in the gas, along the paper's line of sight; made from a run of
    the workflow and rounded to 8e-6.

    Returns
    -------
    DataTree
        For each condition (`50kW` to `130kW`) a Dataset: spectral radiance through a slit of 0.75 nm, by
        radiating system; spectra of varied gas, as a diagnosis needs them; signals of the two bands.
    """
    return xr.DataTree.from_dict(shipped.by_condition())


def save(result: xr.Dataset | xr.DataTree, place: Place) -> None:
    """Store a result as its command does.

    Parameters
    ----------
    result : Dataset or DataTree
        As a function of this package returned it, with the attributes that say what it was made from.
    place : path
        Of a netCDF file for a Dataset, of a folder for a DataTree (one file per part).

    Raises
    ------
    ValueError
        No function of this package made it (`to_netcdf` stores anything), or it breaches its contract.
    """
    parts = {Path(place): result} if isinstance(result, xr.Dataset) else {}
    if isinstance(result, xr.DataTree):
        parts = {Path(place) / f"{name}.nc": node.to_dataset() for name, node in result.children.items()}
    held = {part.attrs.get("contract") for part in parts.values()}
    if not held or not held <= set(contracts.DATASETS):
        raise ValueError(
            "only results of calibrate, correct, diagnose and radiance can be saved; use to_netcdf"
        )
    for part in parts.values():
        contracts.check(part, part.attrs["contract"])
    io.write_labelled(list(parts.items()))


def _options(words: list[str], **given: object) -> Any:
    """Options of a command: its defaults but for those given, which it would take as words too."""
    check_options(words[0], given)
    options = cli.parser(words[:1]).parse_args(words)
    vars(options).update(given)
    return options


@contextmanager
def _file(data: Place | xr.Dataset, contract: str) -> Iterator[Path]:
    """A path of data that may be a Dataset; its file, named by no message, lasts as long as the context."""
    if not isinstance(data, xr.Dataset):
        yield _path(data, contract, xr.Dataset)
        return
    labelled = contracts.label(data, contract)
    for name, stated in ((name, one.attrs.get("units")) for name, one in data.variables.items()):
        if stated is not None and stated != (unit := labelled[name].attrs["units"]):
            raise ValueError(f"{name} of the {contract} is in {stated!r}; give it in {unit!r}")
    with TemporaryDirectory() as folder:
        try:
            io.write(data, Path(folder) / f"{contract}.nc", contract)
            yield Path(folder) / f"{contract}.nc"
        except ValueError as fault:
            raise ValueError(str(fault).replace(f"{folder}{os.sep}", "")) from None


def _path(data: Any, what: str, other: type) -> Path:
    """A path; TypeError for what is neither a path nor the `other` that may be given."""
    if not isinstance(data, str | os.PathLike):
        raise TypeError(f"the {what} is a path or a {other.__name__}; got a {type(data).__name__}")
    return Path(data)


@contextmanager
def _files(
    test: Test, calibration: Calibration | None, needed: bool = False
) -> Iterator[tuple[Path, Path | None]]:
    """Paths of a test and a calibration that may be datasets; a needed calibration may lie beside a path."""
    if needed and calibration is None and isinstance(test, xr.Dataset):
        raise ValueError("name the calibration: a folder, or what `calibrate` returned")
    with _file(test, "test") as place, TemporaryDirectory() as folder:
        if isinstance(calibration, xr.DataTree):
            save(calibration, folder)
            yield place, Path(folder)
        else:
            yield place, None if calibration is None else _path(calibration, "calibration", xr.DataTree)
