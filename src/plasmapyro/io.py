"""Reading and writing files, whole or not at all. The only module that opens or creates netCDF."""

import json
import logging
import os
import shutil
import sys
from contextlib import suppress
from pathlib import Path

import xarray as xr

from plasmapyro import contracts, cost, foreign, progress, seals
from plasmapyro.tables import ORIGINS, weakest
from plasmapyro.versions import told, versions

REMEDY = "free space or give write permission and call again: finished files are kept"
LICENCE = "BSD-3-Clause"  # of a result, unless the data it was made from bring a `license` of their own
LARGEST, LARGEST_TEXT = 2_000_000_000, 200_000_000  # [byte] of a netCDF file, packed or not, and of a text
SMALL = 1000  # numbers; not worth packing
_digests = {}  # of the results that this process has read, so that it need not digest them again as sources
NETCDF_SIGNATURES = {b"\x89HDF", b"CDF\x01", b"CDF\x02", b"CDF\x05"}


class StorageError(OSError):
    """A file could not be written; the message says which, why, and what to do."""


def read(path, contract):
    """Load a stage file and check it against its contract, a name in `contracts.DATASETS`.

    ContractError if the file cannot be read as netCDF, is damaged, says that it holds far more than it has
    bytes, keeps data in other files, or breaches the contract; the message names the file.
    """
    sealed = intact(path, LARGEST)
    try:
        with foreign.memory_for(path):
            if not sealed and (found := foreign.elsewhere(path)):
                raise ValueError("; ".join(found))
            with xr.open_dataset(path, engine="netcdf4", decode_times=False) as stored:
                if found := foreign.claim(path, stored.nbytes):
                    raise ValueError(f"{found}; {foreign.PACKED}")
                dataset = stored.load()
    except (OSError, ValueError, RuntimeError, TypeError, LookupError, AttributeError, MemoryError) as fault:
        words = "it asks for more memory than its size allows" if isinstance(fault, MemoryError) else fault
        raise contracts.ContractError(f"{path}: not a readable netCDF file ({words})") from fault
    try:
        return contracts.check(dataset, contract)
    except contracts.ContractError as fault:
        raise contracts.ContractError(f"{path}: {fault}") from None


def intact(path, largest=LARGEST):
    """Whether a workflow noted the bytes of a file when it wrote it; they are compared at this moment.

    False if nothing was noted: it is not a result of a workflow. ContractError: no plain file of up to
    `largest` bytes, or other bytes than were noted.
    """
    if found := foreign.unfit(path, largest):
        raise contracts.ContractError(f"{path}: {'; '.join(found)}")
    noted = seals.noted(path)
    if noted is not None:
        as_read, found = _file(path), seals.digest(path)
        _require_noted(path, found, noted)
        _digests[as_read] = found
    return noted is not None


def _file(path):
    """What tells a file, as it stands, from another or from itself written anew."""
    found = os.stat(path)
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns


def _require_noted(path, found, noted):
    if found != noted:
        raise contracts.ContractError(
            f"{path}: damaged or replaced since the workflow wrote it (SHA-256 {found[:12]}..., noted"
            f" {noted[:12]}...); call snakemake again: it is computed anew"
        )


def write(dataset, path, contract, *, sources=(), config=None):
    """Label, check and store a stage file, whole or not at all.

    The attribute `origin` (default 'modelled') is weakened to the weakest origin of the `sources`, files
    whose SHA-256 are stored; other attributes are kept. `config`: values of the configuration it depends on,
    stored as JSON.
    """
    write_labelled([(path, labelled(dataset, contract, sources, config))])


def write_labelled(ready):
    """Store labelled datasets, all of them or none: list of (path, Dataset as `labelled` returns it)."""

    def store_from(index):
        path, dataset = ready[index]

        def writer(part):
            dataset.to_netcdf(part, engine="netcdf4", format="NETCDF4")
            if index + 1 < len(ready):  # no part takes its place before the last one is written
                store_from(index + 1)

        store(path, writer)

    store_from(0)


def write_packed(dataset, path, contract, *, bits, bits_of=None, sources=()):
    """Store a stage file for shipping: spectra compressed, in single precision, mantissas rounded to `bits`.

    A number of theirs moves by at most 2**-(bits + 1) of itself; `bits_of` {variable: bits} names others. See
    `write`.
    """
    dataset = labelled(dataset, contract, sources)
    for name, variable in ((name, one) for name, one in dataset.data_vars.items() if one.size > SMALL):
        packed = {"dtype": "f4", "zlib": True, "complevel": 9, "shuffle": True}
        variable.encoding |= packed | {
            "significant_digits": (bits_of or {}).get(name, bits),
            "quantize_mode": "BitRound",
        }
    write_labelled([(path, dataset)])


def labelled(dataset, contract, sources=(), config=None):
    """A checked copy of a dataset with the attributes of a stage file, as `write` stores it."""
    dataset = contracts.check(contracts.label(dataset, contract), contract)
    origins = [dataset.attrs.get("origin", "modelled"), *(_origin(source) for source in sources)]
    dataset.attrs = {
        "Conventions": "CF-1.10",
        "license": LICENCE,
        **dataset.attrs,
        "contract": contract,
        "origin": weakest(origin for origin in origins if origin),
        "plasmapyro_version": dict(versions())["plasmapyro"],
        "versions": told(),
        "configuration": json.dumps(config or {}, sort_keys=True, default=str),
        "sources": "\n".join(f"{digest(source)}  {told_path(source)}" for source in sources),
    }
    for variable in dataset.variables.values():
        fill = None if variable.dtype.kind != "f" else float("nan")
        variable.encoding = {"_FillValue": fill, "fletcher32": True}  # the format's own check at every read
    return dataset


def told_path(path):
    """A path as a file that travels may hold it: from the folder of the call on, or the bare name."""
    path = Path(path)
    if not path.is_absolute():
        return path
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else Path(path.name)


def write_text(text, path):
    """Store a text file, whole or not at all (errors as for `store`)."""
    store(path, lambda part: part.write_text(text, encoding="utf-8"))


def store(path, writer):
    """Store a file of any kind, whole or not at all; its folder is made.

    `writer` writes to the path it is given, a neighbour of `path` with the same suffix. StorageError if the
    file cannot be written; the message says what to do, and an older file is as it was.
    """
    path = Path(path)
    if path.exists() and not path.is_file():
        raise StorageError(f"{path}: is not a plain file and is not replaced; name another")
    part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        writer(part)
        seals.unseal(path)
        os.replace(part, path)
    except StorageError:
        raise
    except (OSError, RuntimeError) as fault:
        raise StorageError(f"{path}: could not be written ({_reason(fault, path)}); {REMEDY}") from fault
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
    seals.seal(path)


def store_folder(folder, writer):
    """Store a folder of results, all of its files or none: the old folder stays until the new one is whole.

    `writer` writes into the folder that it is given, a neighbour of `folder`, whose content goes.
    StorageError as for `store`.
    """
    folder = Path(os.path.realpath(folder))
    part, aside = (folder.with_name(f".{folder.name}.{os.getpid()}.part{k}") for k in ("", "-old"))
    try:
        part.mkdir(parents=True)
        writer(part)
        if folder.exists():
            for path in folder.iterdir():
                seals.unseal(path)
            os.rename(folder, aside)
        try:
            os.rename(part, folder)
        except OSError:
            if aside.exists():
                os.rename(aside, folder)
            raise
    except StorageError:
        raise
    except OSError as fault:
        raise StorageError(f"{folder}: could not be written ({_reason(fault, folder)}); {REMEDY}") from fault
    finally:
        shutil.rmtree(part, ignore_errors=True)
        if folder.exists():
            shutil.rmtree(aside, ignore_errors=True)
    for path in sorted(folder.iterdir()):
        seals.seal(path)


def _reason(fault, path):
    """What the system says of a failed write; the netCDF library only says 'HDF error'."""
    try:
        free = shutil.disk_usage(path.parent).free
    except OSError:
        return fault
    return f"{fault}; {free / 1e6:.1f} MB are free there"


def write_texts(texts, paths):
    """Store text files one after the other, each whole or not at all (errors as for `store`)."""
    for text, path in zip(texts, paths, strict=True):
        write_text(text, path)


def read_text(path):
    """Read a text file.

    ContractError if there is no such file, it is too large, damaged or not text; the message names it.
    """
    try:
        words = read_bytes(path, LARGEST_TEXT).decode("utf-8")
        return words.replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError:
        raise contracts.ContractError(f"{path}: not a text file") from None


def read_bytes(path, largest=LARGEST):
    """Read a file of any kind (errors as for `read_text`)."""
    intact(path, largest)
    try:
        return Path(path).read_bytes()
    except OSError as fault:
        raise contracts.ContractError(f"{path}: {fault.strerror}") from None


def is_netcdf(path):
    """Whether a file begins like netCDF (classic or HDF5); False if it cannot be read."""
    if foreign.unfit(path, LARGEST):
        return False
    try:
        with open(path, "rb") as file:
            return file.read(4) in NETCDF_SIGNATURES
    except OSError:
        return False


def attributes(path):
    """Attributes of a netCDF file; ContractError if it cannot be read as such."""
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as dataset:
            return dict(dataset.attrs)
    except (OSError, ValueError, RuntimeError) as fault:
        raise contracts.ContractError(f"{path}: not a readable netCDF file ({fault})") from None


def _origin(path):
    origin = attributes(path).get("origin") if Path(path).suffix == ".nc" else None
    return origin if origin in ORIGINS else None


def digest(path):
    """SHA-256 of a file, in hexadecimal; a result must still have the one that was noted (see `intact`)."""
    found = _digests.get(_file(path)) or seals.digest(path)
    _require_noted(path, found, seals.noted(path) or found)
    return found


def log_to(path):
    """Send log records, warnings and last words of this process to `path`; note its cost at its end.

    On a terminal the steps of a long stage are drawn as well (see `progress`). Faults that the package
    itself foresees end with their message alone, all others with a traceback.
    """
    logging.basicConfig(filename=path, level=logging.INFO, format="%(levelname)s %(name)s: %(message)s")
    logging.getLogger("skfem").setLevel(logging.WARNING)  # it reports every basis it makes
    logging.captureWarnings(True)
    progress.show(sys.stderr)
    cost.note_at_end(path)
    sys.excepthook = _last_words


def _last_words(kind, fault, trace):
    foreseen = kind.__module__.partition(".")[0] == "plasmapyro"
    logging.critical("%s", fault, exc_info=None if foreseen else (kind, fault, trace))
    if foreseen:
        sys.stderr.write(f"plasmapyro: {fault}\n")
    else:
        sys.__excepthook__(kind, fault, trace)
