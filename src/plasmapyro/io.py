"""Reading and writing files, whole or not at all. The only module that opens or creates netCDF."""

import hashlib
import json
import logging
import os
import shutil
import sys
from contextlib import suppress
from pathlib import Path

import xarray as xr

from plasmapyro import contracts, progress, workspace
from plasmapyro.tables import ORIGINS, weakest
from plasmapyro.versions import versions

REMEDY = "free space or give write permission and call again: finished files are kept"
LICENCE = "BSD-3-Clause"  # of a result, unless the data it was made from bring a `license` of their own
NETCDF_SIGNATURES = {b"\x89HDF", b"CDF\x01", b"CDF\x02", b"CDF\x05"}


class StorageError(OSError):
    """A file could not be written; the message says which, why, and what to do."""


def read(path, contract, *, largest=None):
    """Load a stage file and check it against its contract.

    Parameters
    ----------
    path : path of the netCDF file
    contract : name in `contracts.DATASETS`
    largest : int [byte], or None
        Refuse a file whose variables, unpacked, are larger; for files of unknown origin.

    Raises
    ------
    ContractError
        If the file cannot be read as netCDF or breaches the contract; the message names the file.
    """
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as stored:
            if largest is not None and stored.nbytes > largest:
                raise ValueError(f"holds {stored.nbytes / 1e6:.0f} MB, the limit is {largest / 1e6:.0f} MB")
            dataset = stored.load()
    except FileNotFoundError:
        raise contracts.ContractError(f"{path}: no such file") from None
    except (OSError, ValueError, RuntimeError, TypeError, LookupError, AttributeError) as fault:
        raise contracts.ContractError(f"{path}: not a readable netCDF file ({fault})") from fault
    try:
        return contracts.check(dataset, contract)
    except contracts.ContractError as fault:
        raise contracts.ContractError(f"{path}: {fault}") from None


def write(dataset, path, contract, *, sources=(), config=None):
    """Label, check and store a stage file, whole or not at all.

    Parameters
    ----------
    dataset : Dataset
        Its attribute `origin` (default 'modelled') is weakened to the weakest origin of the sources;
        other attributes are kept.
    path : path of the netCDF file
    contract : name in `contracts.DATASETS`
    sources : paths of the files it was made from; their SHA-256 are stored
    config : mapping of the configuration values it depends on, stored as JSON
    """
    write_together({contract: (dataset, path)}, sources=sources, config=config)


def write_together(datasets, *, sources=(), config=None):
    """Store several stage files of one origin, all of them or none (see `write`).

    Parameters
    ----------
    datasets : mapping of contract -> (Dataset, path)
    sources, config : as in `write`
    """
    ready = [
        (path, _labelled(dataset, contract, sources, config))
        for contract, (dataset, path) in datasets.items()
    ]

    def store_from(index):
        path, dataset = ready[index]

        def writer(part):
            dataset.to_netcdf(part, engine="netcdf4", format="NETCDF4")
            if index + 1 < len(ready):  # no part takes its place before the last one is written
                store_from(index + 1)

        store(path, writer)

    store_from(0)


def _labelled(dataset, contract, sources, config):
    """A checked copy of a dataset with the attributes of a stage file."""
    dataset = contracts.check(contracts.label(dataset, contract), contract)
    origins = [dataset.attrs.get("origin", "modelled"), *(_origin(source) for source in sources)]
    dataset.attrs = {
        "Conventions": "CF-1.10",
        "license": LICENCE,
        **dataset.attrs,
        "contract": contract,
        "origin": weakest(origin for origin in origins if origin),
        "plasmapyro_version": dict(versions())["plasmapyro"],
        "versions": ", ".join(f"{name} {number}" for name, number in versions()),
        "configuration": json.dumps(config or {}, sort_keys=True, default=str),
        "sources": "\n".join(f"{digest(source)}  {source}" for source in sources),
    }
    for variable in dataset.variables.values():
        variable.encoding = (
            {"_FillValue": None} if variable.dtype.kind != "f" else {"_FillValue": float("nan")}
        )
    return dataset


def write_text(text, path):
    """Store a text file, whole or not at all (errors as for `store`)."""
    store(path, lambda part: part.write_text(text, encoding="utf-8"))


def store(path, writer):
    """Store a file of any kind, whole or not at all.

    Parameters
    ----------
    path : path of the file; its folder is made
    writer : callable
        Writes to the path it is given, a neighbour of `path` with the same suffix.

    Raises
    ------
    StorageError
        If the file cannot be written; the message says what to do, and an older file is as it was.
    """
    path = Path(path)
    part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        writer(part)
        workspace.unseal(path)
        os.replace(part, path)
    except (OSError, RuntimeError) as fault:
        raise StorageError(f"{path}: could not be written ({_reason(fault, path)}); {REMEDY}") from fault
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
    workspace.seal(path)


def _reason(fault, path):
    """What the system says of a failed write; the netCDF library only says 'HDF error'."""
    try:
        free = shutil.disk_usage(path.parent).free
    except OSError:
        return fault
    return f"{fault}; {free / 1e6:.1f} MB are free there"


def read_text(path):
    """Read a text file.

    Raises
    ------
    ContractError
        If there is no such file or it is not text; the message names it.
    """
    try:
        return Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as fault:
        reason = fault.strerror if isinstance(fault, OSError) else "not a text file"
        raise contracts.ContractError(f"{path}: {reason}") from None


def is_netcdf(path):
    """Whether a file begins like netCDF (classic or HDF5); False if it cannot be read."""
    try:
        with open(path, "rb") as file:
            return file.read(4) in NETCDF_SIGNATURES
    except OSError:
        return False


def _origin(path):
    if Path(path).suffix != ".nc":
        return None
    with xr.open_dataset(path, engine="netcdf4", decode_times=False) as dataset:
        origin = dataset.attrs.get("origin")
    return origin if origin in ORIGINS else None


def digest(path):
    """SHA-256 of a file, in hexadecimal."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def log_to(path):
    """Send the log records, warnings and the last words of this process to `path`.

    On a terminal the steps of a long stage are drawn as well (see `progress`). Faults that the package
    itself foresees end with their message alone, all others with a traceback.
    """
    logging.basicConfig(filename=path, level=logging.INFO, format="%(levelname)s %(name)s: %(message)s")
    logging.getLogger("skfem").setLevel(logging.WARNING)  # it reports every basis it makes
    logging.captureWarnings(True)
    progress.show(sys.stderr)
    sys.excepthook = _last_words


def _last_words(kind, fault, trace):
    foreseen = kind.__module__.partition(".")[0] == "plasmapyro"
    logging.critical("%s", fault, exc_info=None if foreseen else (kind, fault, trace))
    if foreseen:
        sys.stderr.write(f"plasmapyro: {fault}\n")
    else:
        sys.__excepthook__(kind, fault, trace)
