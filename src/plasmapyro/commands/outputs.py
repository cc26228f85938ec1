"""What a command may write, decided before its work begins."""

from pathlib import Path


def require_writable(outputs, inputs):
    """Refuse before the work begins what could not be written after it.

    Parameters
    ----------
    outputs, inputs : lists of paths
        Files to be written; files or folders that are read.

    Raises
    ------
    ValueError
        An output is a folder, is an input or another output, lies in an input folder, or below a file.
    """
    taken = {Path(path).resolve() for path in inputs if path}
    folders = {path for path in taken if path.is_dir()}
    for path in map(Path, outputs):
        if path.is_dir():
            raise ValueError(f"{path}: is a folder; name a file")
        if path.resolve() in taken:
            raise ValueError(f"{path}: is an input or another output; nothing is overwritten")
        if folders & set(path.resolve().parents):
            raise ValueError(f"{path}: lies in a folder that is read; results go elsewhere")
        taken.add(path.resolve())
        above = next(parent for parent in path.resolve().parents if parent.exists())
        if not above.is_dir():
            raise ValueError(f"{above}: is not a folder")
