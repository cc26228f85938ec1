"""The SHA-256 that a workflow notes beside each result: whoever reads one sees whether it is whole."""

import hashlib
import os
from pathlib import Path

FOLDER = ".seals"  # of the digests, in the folder of results
SEALS = "PLASMAPYRO_SEALS"  # that folder, for the jobs of a workflow; unset outside of one


def seal(path):
    """Note the SHA-256 of a finished result, so that who reads it sees whether it still has those bytes.

    Does nothing outside of a workflow. The note of an older file goes first: a run cut off between the two
    leaves a result without note, never a note of other bytes. What lies in a hidden folder is no result yet.
    """
    if note := _note_to_write(path):
        note.parent.mkdir(parents=True, exist_ok=True)
        part = note.with_name(f"{note.name}.{os.getpid()}.part")
        part.write_text(digest(path), encoding="ascii")
        os.replace(part, note)


def unseal(path):
    """Forget the note of a result that is about to be replaced."""
    if note := _note_to_write(path):
        note.unlink(missing_ok=True)


def noted(path):
    """SHA-256 that a workflow noted of a file when it wrote it, None if nothing is noted.

    The folder of results is recognised by its notes, in a workflow or out of it.
    """
    path = Path(os.path.realpath(path))
    for folder in path.parents:
        note = _note_in(folder / FOLDER, path.relative_to(folder))
        if note.is_file():
            return note.read_text(encoding="ascii", errors="replace")
    return None


def _note_in(folder, path):
    """Where the note of a result stands, by its path inside of the folder of results."""
    return folder / path.with_name(path.name + ".sha256")


def _note_to_write(path):
    """Path of the note that this process keeps of a result, or None."""
    folder = os.environ.get(SEALS)
    if not folder:
        return None
    root, path = Path(os.path.realpath(folder)).parent, Path(os.path.realpath(path))
    inside = path.relative_to(root) if path.is_relative_to(root) else None
    if inside is None or any(part.startswith(".") for part in inside.parent.parts):
        return None
    return _note_in(Path(folder), inside)


def digest(path):
    """SHA-256 of a file, in hexadecimal."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
