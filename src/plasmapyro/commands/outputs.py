"""What a command may write, decided before its work begins."""

import os
from pathlib import Path

from plasmapyro import io
from plasmapyro.contracts import ContractError
from plasmapyro.readers.stage import sources


def beside(test, ending):
    """Name of a result of a test that nobody named; a dot in the name of a folder begins no ending.

    In the folder of the call, or beside the test's where that folder is read.
    """
    path, here = _real(test), _real(".")
    name = Path(f"{path.name if path.is_dir() else path.stem}{ending}")
    within = path.is_dir() and path in (here, *here.parents)
    return Path(os.path.relpath(path.parent / name)) if within else name


def require_of_test(result, test):
    """Refuse (ValueError) a name that nobody gave where it is that of another test's result (netCDF).

    Folders of tests may share a name. A result is of this test if it says so by a path with its folders, or
    by the digest of one of its data files.
    """
    try:
        said = io.attributes(result).get("sources", "") if Path(result).is_file() else ""
    except ContractError:
        return
    held = dict(reversed(line.split("  ", 1)) for line in said.splitlines() if "  " in line)
    if not held or not Path(test).exists():
        return
    own = {str(io.told_path(one)): one for one in sources(test)}
    # Descriptions and calibrations are copied from one test to the next.
    data = [one for one in own.values() if one.suffix != ".yaml" and one.parent.name != "calibration"]
    here = any(os.sep in name for name in held.keys() & own.keys())
    if not here and not any(io.digest(one) in held.values() for one in data):
        raise ValueError(
            f"{result}: holds the result of another test, of {next(iter(held))}; name yours with --out"
        )


def require_writable(outputs, inputs):
    """Refuse (ValueError) before the work begins what could not be written after it.

    An output that is a folder, a device or a pipe, is an input or another output, lies in an input folder, or
    below a file.
    """
    taken = {_real(path) for path in inputs if path}
    folders = {path for path in taken if path.is_dir()}
    for path in map(Path, outputs):
        real = _real(path)
        if path.is_dir():
            raise ValueError(f"{path}: is a folder; name a file")
        if os.path.lexists(path) and not path.is_file():
            raise ValueError(f"{path}: is a device or a pipe, not a plain file (or a dead link); name a file")
        if real in taken:
            raise ValueError(f"{path}: is an input or another output; nothing is overwritten")
        for folder in folders & set(real.parents):
            other = os.path.relpath(folder.parent / real.name)
            raise ValueError(f"{path}: lies in a folder that is read; results go elsewhere, such as {other}")
        taken.add(real)
        _require_place(real)


def require_folder(folder, names, inputs):
    """Refuse (ValueError) before the work begins a folder of results that could not be replaced as a whole.

    It is a file, holds or is an input, lies in an input folder, is the folder of the call, or holds anything
    but `names`, what a command of this kind may have left there.
    """
    real = _real(folder)
    if real.exists() and not real.is_dir():
        raise ValueError(f"{folder}: is no folder; name one")
    if real == _real(".") or real in _real(".").parents:
        raise ValueError(f"{folder}: is replaced as a whole, and you stand in it; name another folder")
    for path in map(_real, filter(None, inputs)):
        if real == path or real in path.parents or (path.is_dir() and path in real.parents):
            raise ValueError(f"{folder}: is or holds an input, or lies in one; results go elsewhere")
    others = sorted({path.name for path in real.iterdir()} - set(names)) if real.exists() else []
    if others:
        raise ValueError(
            f"{folder}: is replaced as a whole, and holds other files ({others[0]}); name another folder"
        )
    _require_place(real)


def _real(path):
    # `Path.resolve` raises where links go round in a circle.
    return Path(os.path.realpath(path))


def _require_place(path):
    above = next(parent for parent in path.parents if parent.exists())
    if not above.is_dir():
        raise ValueError(f"{above}: is not a folder")
    if not os.access(above, os.W_OK | os.X_OK):
        raise ValueError(f"{above}: no right to write there; name another folder, or change its rights")
