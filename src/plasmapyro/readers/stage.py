"""From a test folder to one dataset of the contract 'test', or to everything that is wrong with it."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from plasmapyro import contracts, io
from plasmapyro.readers import description, parts
from plasmapyro.readers.spectrometer import spectrometer
from plasmapyro.readers.text import Refusal, checked, fault, refuse
from plasmapyro.record import clock, inputs

INSTRUMENTS = {  # section of test.yaml -> its reader
    "pyrometer": parts.pyrometer,
    "spectrometer": spectrometer,
    "radiometer": parts.radiometer,
}
DIMS = {key.rstrip("?"): dims for key, dims in contracts.DATASETS["test"].items()}
OF_LAMP = {  # what need not be said of a record without plasma (`condition: none`)
    "emittance": 1.0,
    "emittance_uncertainty": 0.0,
    "window_transmittance_pyrometer": 1.0,
    "window_transmittance_spectrometer": 1.0,
    "window_transmittance_radiometer": 1.0,
    "radiometer_integration_time": 1e-3,
}
FROM_HEADERS = ("spectrometer_integration_time",)  # attributes that files of spectra bring
GUIDE = "see docs/your-own-data.md"


class Reading(NamedTuple):
    """A test and the files it was read from, for rules that look at both."""

    test: xr.Dataset
    files: dict  # instrument -> what its reader says of its files; empty for netCDF


def read_test(folder):
    """The test (contract 'test') in a folder of `test.nc`, or of `test.yaml` and its raw files.

    Or in a netCDF file. ContractError with one line per fault: file, line, what is wrong, what to do. ASSUME:
    spectrometers give wavelengths in air unless test.yaml says `wavelengths: vacuum`: makers calibrate them
    with the air wavelengths of line lamps.
    """
    return read_with_files(folder).test


def read_with_files(folder):
    """As `read_test`, with what is known of the files: a `Reading`."""
    reading, faults = _read(folder)
    if faults:
        raise Refusal(faults)
    return reading


def check_test(folder):
    """Everything that is wrong with a test folder, at once: sentences; none if it can be processed."""
    return _read(folder)[1]


def sources(folder):
    """Paths of the files that `read_test` would read, sorted: for a workflow to depend on."""
    folder = Path(folder)
    return sorted(path for path in folder.rglob("*") if path.is_file()) if folder.is_dir() else [folder]


def condition_of(folder):
    """Simulation that the test in a folder is to be compared with, as its file says; None if it does not."""
    described = Path(folder) / "test.yaml"
    try:
        if described.exists():
            found = description.load(described).get("attributes", {}).get("condition")
        else:
            found = io.attributes(Path(folder) / "test.nc").get("condition")
    except (contracts.ContractError, AttributeError):
        return None
    return found if isinstance(found, str) else None


def misplaced(tests):
    """What keeps files of tests (name -> values) from their data, as far as their folders tell at once."""
    for name, test in tests.items():
        folder = Path(test["data_folder"])
        described = folder / "test.yaml"
        if not described.exists() and not (folder / "test.nc").exists():
            lacking = f"{folder} holds neither test.nc nor test.yaml"
            yield f"data_folder of test {name}: {lacking}; {_renamed(folder) or GUIDE}"
        elif described.exists() and (lacking := set(test["instruments"]) - set(description.load(described))):
            yield f"instruments of test {name}: {described} describes no {' and no '.join(sorted(lacking))}"


# Absurd scales overflow to infinity, which the rules for a test then name.
@np.errstate(over="ignore", invalid="ignore")
def _read(folder):
    folder = Path(folder)
    try:
        if folder.name == "test.yaml" or folder.is_file() and (folder.parent / "test.yaml").exists():
            if not io.is_netcdf(folder):
                refuse(folder, "is one file of a test", f"name its folder, {folder.parent}")
        if folder.is_file():
            return _sound(io.read(folder, "test"), folder)
        if not folder.is_dir():
            refuse(folder, "no such folder", "check its name")
        stored, described = folder / "test.nc", folder / "test.yaml"
        if stored.exists() and described.exists():
            refuse(folder, "holds test.nc and test.yaml", "keep the one that is meant")
        if stored.exists():
            return _sound(io.read(stored, "test"), stored)
        if not described.exists():
            remedy = _renamed(folder) or f"describe the raw files in test.yaml; {GUIDE}"
            refuse(folder, "holds neither test.nc nor test.yaml", remedy)
        return _raw(folder, described)
    except contracts.ContractError as reason:
        return None, reason.messages if isinstance(reason, Refusal) else [str(reason)]
    except OSError as reason:
        return None, [fault(folder, f"cannot be read ({reason})", "check names and access rights")]


def _renamed(folder):
    """What to do with a file of a folder whose name is nearly the one that is looked for, or None."""
    for wanted in (folder / "test.yaml", folder / "test.nc"):
        if folder.is_dir() and (found := description.nearly(wanted)):
            return f"rename {found} to {wanted.name}"
    return None


def _sound(dataset, path, files=None):
    faults = [f"{path}: {what}" for what in inputs.faults(dataset)]
    return (None if faults else Reading(dataset, files or {})), faults


def _raw(folder, path):
    faults = []
    top = description.Section(description.load(path), path, "", faults)
    attributes = parts.attributes(top.section("attributes"))
    variables, files = {}, {}
    present = [name for name in INSTRUMENTS if name in top]
    if not present:
        faults.append(fault(path, "describes no pyrometer, spectrometer or radiometer", GUIDE))
    for name in present:
        try:
            found = INSTRUMENTS[name](folder, top.section(name))
            if name == "spectrometer" and found is not None:
                found, own, files[name] = found
                faults += _agree(path, attributes, own)
                attributes = {**own, **attributes}
            variables |= found or {}
        except Refusal as reason:
            faults += reason.messages
    if "tunnel" in top:
        faults += _tunnel(folder, top.section("tunnel"), variables)
    top.used |= {"attributes", *INSTRUMENTS, "tunnel"}
    top.close()
    if attributes.get("condition") == "none" and "reference_window" not in attributes:
        needed = {name for instrument in present for name in inputs.OF_INSTRUMENT[instrument]}
        attributes = {**{k: v for k, v in OF_LAMP.items() if k in {*inputs.ALWAYS, *needed}}, **attributes}
    if faults:  # what is wrong with the attributes is said in the same round
        return None, faults + _of_attributes(path, attributes, present, faults)
    dataset = xr.Dataset(
        {name: (DIMS[name], values) for name, values in variables.items() if DIMS[name] != (name,)},
        {name: values for name, values in variables.items() if DIMS[name] == (name,)},
        attributes,
    )
    dataset = checked(dataset, "test", path)
    left = files.get("spectrometer", {}).get("left_open", 0.0)
    if {"time", "spectrum_time"} <= dataset.sizes.keys() and left:
        dataset = _within_second(dataset, left)
    return _sound(dataset, path, files)


def _within_second(dataset, left):
    """The spectra moved within what their dates leave open [s], to where they fit the pyrometer."""
    try:
        moved = clock.within_second(dataset, left)
    except np.linalg.LinAlgError:
        moved = 0.0
    if not moved:
        return dataset
    axis = dataset.spectrum_time
    dataset = dataset.assign_coords(spectrum_time=axis.copy(data=axis.values + moved))
    return dataset.assign_attrs(spectra_moved=moved)


def _of_attributes(path, attributes, present, faults):
    """Faults of the attributes beside those of the files; what a header may still give is not missing."""
    given = {**dict.fromkeys(FROM_HEADERS, 1.0), **attributes}
    found = inputs.attribute_faults(xr.Dataset(attrs=given), present)
    said = "\n".join(faults)
    return [
        f"{path}: {what}" for what in found if f"attributes.{what.split(':')[0].split()[-1]} " not in said
    ]


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
