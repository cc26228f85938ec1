"""From a test folder to one dataset of the contract 'test', or to everything that is wrong with it."""

from pathlib import Path

import numpy as np
import xarray as xr

from plasmapyro import contracts, io
from plasmapyro.experiment import inputs
from plasmapyro.readers import description, parts
from plasmapyro.readers.text import Refusal, fault, refuse, regular_file

DIMS = {key.rstrip("?"): dims for key, dims in contracts.DATASETS["test"].items()}
LARGEST = 2_000_000_000  # [byte] of a netCDF file
GUIDE = "see docs/your-own-data.md"


def read_test(folder):
    """The test in a folder, as one dataset.

    Parameters
    ----------
    folder : path
        Of a folder that holds `test.nc`, or `test.yaml` and the raw files it describes; or of a netCDF file.

    Returns
    -------
    Dataset, contract 'test'
        SI, wavelengths in vacuum, time 0 at the zero the description states.

    Raises
    ------
    ContractError
        With one line per fault: file, line, what is wrong, what to do.

    Notes
    -----
    ASSUME: spectrometers give wavelengths in air unless test.yaml says `wavelengths: vacuum`: makers
    calibrate them with the air wavelengths of line lamps.
    """
    dataset, faults = _read(folder)
    if faults:
        raise Refusal(faults)
    return dataset


def check_test(folder):
    """Everything that is wrong with a test folder, at once.

    Parameters
    ----------
    folder : path, as in `read_test`

    Returns
    -------
    list of str, empty if the test can be read and processed
    """
    return _read(folder)[1]


def sources(folder):
    """Paths of the files that `read_test` would read, sorted: for a workflow to depend on.

    Parameters
    ----------
    folder : path

    Returns
    -------
    list of Path; empty if the folder does not exist
    """
    folder = Path(folder)
    return sorted(path for path in folder.rglob("*") if path.is_file()) if folder.is_dir() else [folder]


def _read(folder):
    # Absurd scales overflow to infinity, which the rules for a test then name.
    with np.errstate(over="ignore", invalid="ignore"):
        return _read_folder(Path(folder))


def _read_folder(folder):
    try:
        if folder.is_file():
            return _sound(_stored(folder), folder)
        if not folder.is_dir():
            refuse(folder, "no such folder", "check its name")
        stored, described = folder / "test.nc", folder / "test.yaml"
        if stored.exists() and described.exists():
            refuse(folder, "holds test.nc and test.yaml", "keep the one that is meant")
        if stored.exists():
            return _sound(_stored(stored), stored)
        if not described.exists():
            refuse(
                folder, "holds neither test.nc nor test.yaml", f"describe the raw files in test.yaml; {GUIDE}"
            )
        return _raw(folder, described)
    except contracts.ContractError as reason:
        return None, reason.messages if isinstance(reason, Refusal) else [str(reason)]
    except OSError as reason:
        return None, [fault(folder, f"cannot be read ({reason})", "check names and access rights")]


def _stored(path):
    return io.read(regular_file(path, LARGEST), "test", largest=LARGEST)


def _sound(dataset, path):
    faults = [f"{path}: {what}" for what in inputs.faults(dataset)]
    return (None if faults else dataset), faults


def _raw(folder, path):
    faults = []
    top = description.Section(description.load(path), path, "", faults)
    attributes = parts.attributes(top.section("attributes"))
    variables = {}
    present = [name for name in ("pyrometer", "spectrometer") if name in top]
    if not present:
        faults.append(fault(path, "describes neither a pyrometer nor a spectrometer", GUIDE))
    for name in present:
        try:
            found = getattr(parts, name)(folder, top.section(name))
            if name == "spectrometer" and found is not None:
                found, own = found
                faults += _agree(path, attributes, own)
                attributes = {**own, **attributes}
            variables |= found or {}
        except Refusal as reason:
            faults += reason.messages
    if "tunnel" in top:
        faults += _tunnel(folder, top.section("tunnel"), variables)
    top.used |= {"attributes", "pyrometer", "spectrometer", "tunnel"}
    top.close()
    if faults:
        return None, faults
    dataset = xr.Dataset(
        {name: (DIMS[name], values) for name, values in variables.items() if DIMS[name] != (name,)},
        {name: values for name, values in variables.items() if DIMS[name] == (name,)},
        attributes,
    )
    try:
        dataset = contracts.check(contracts.label(dataset, "test"), "test")
    except contracts.ContractError as reason:
        return None, [f"{path}: {reason}"]
    return _sound(dataset, path)


def _tunnel(folder, section, variables):
    if "time" not in variables:
        return [
            fault(
                section.path,
                "tunnel channels need the pyrometer's times",
                "read that first, or remove `tunnel`",
            )
        ]
    try:
        variables |= parts.tunnel(folder, section, variables["time"])
    except Refusal as reason:
        return reason.messages
    return []


def _agree(path, stated, found):
    """Faults where the description contradicts the headers of the files."""
    for name in set(stated) & set(found):
        if not np.isclose(stated[name], found[name], rtol=1e-6):
            yield fault(
                path,
                f"attributes.{name} is {stated[name]:g}, the headers of the spectra say {found[name]:g}",
                "correct the one that is wrong, or leave it out here",
            )
