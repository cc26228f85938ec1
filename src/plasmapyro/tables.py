"""Loader of the data tables in `plasmapyro/data`; a table without a valid certificate is refused.

Registers of words and limits, beside the modules that use them, need none: see `rows`.
"""

import csv
import hashlib
import io
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
import yaml

from plasmapyro.constants import ELECTRON_VOLT

ORIGINS = ("measured", "published", "digitised", "modelled", "synthetic")  # strongest first
CERTIFICATE_KEYS = {"title", "source", "origin", "obtained", "licence", "valid", "uncertainty", "sha256"}


def rows(name):
    """Rows of a register of the package, such as 'claims/claims.csv', as mappings by names of columns."""
    return list(csv.DictReader((files("plasmapyro") / name).read_text(encoding="utf-8").splitlines()))


# Unit of a column -> factor to SI: cm4 dyn-1 (absorption per neutral density and electron pressure) is
# 1e-8 m4 over 1e-5 N; transition moments, e a0, stay in atomic units.
TO_SI = {row["unit"]: float(row["factor"]) for row in rows("tables.csv")} | {"eV": ELECTRON_VOLT}


@dataclass(frozen=True)
class Table:
    """Columns of a data table in SI (name -> array; text columns as object arrays) and its origin."""

    columns: dict
    origin: str
    source: str

    def __getitem__(self, name):
        return self.columns[name]


def weakest(origins):
    """The weakest of several origins (see `ORIGINS`); 'measured' for none."""
    return max(origins, key=ORIGINS.index, default=ORIGINS[0])


def load(name):
    """Load `data/<name>.csv` (header cells 'column [unit]', unit 'text' for words) with its certificate.

    ValueError: missing certificate or key, digest that differs, unknown unit or origin, ragged row.
    """
    folder = files("plasmapyro") / "data"
    content = (folder / f"{name}.csv").read_bytes()
    try:
        certificate = (folder / f"{name}.yml").read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ValueError(f"table {name} has no certificate {name}.yml") from None
    return _parsed(name, content, certificate)


@cache
def arrays(name):
    """The arrays (name -> array) of `data/<name>.npz`; ValueError where its certificate says other bytes."""
    folder = files("plasmapyro") / "data"
    content = (folder / f"{name}.npz").read_bytes()
    certificate = yaml.safe_load((folder / f"{name}.yml").read_text(encoding="utf-8"))
    if hashlib.sha256(content).hexdigest() != certificate["sha256"]:
        raise ValueError(f"arrays {name} were changed: their sha256 is not that of the certificate")
    with np.load(io.BytesIO(content)) as found:
        return dict(found)


@cache  # kernels ask for the same table at every layer, and YAML is slow
def _parsed(name, content, certificate):
    """The Table of the bytes of a file and the text of its certificate; its columns cannot be written to."""
    certificate = yaml.safe_load(certificate)
    missing = CERTIFICATE_KEYS - set(certificate)
    if missing:
        raise ValueError(f"certificate of table {name} lacks {', '.join(sorted(missing))}")
    if certificate["origin"] not in ORIGINS:
        raise ValueError(f"certificate of table {name}: unknown origin {certificate['origin']!r}")
    found = hashlib.sha256(content).hexdigest()
    if found != certificate["sha256"]:
        raise ValueError(f"table {name} was changed: sha256 is {found}, certificate says otherwise")
    header, *rows = csv.reader(content.decode("utf-8").splitlines())
    columns = {}
    for index, cell in enumerate(header):
        label, _, unit = cell.rstrip("]").partition(" [")
        try:
            words = [row[index] for row in rows]
        except IndexError:
            raise ValueError(f"table {name}: a row has fewer than {len(header)} cells") from None
        if unit == "text":
            columns[label] = np.array(words, dtype=object)
        elif unit in TO_SI:
            columns[label] = np.array([float(w) if w else np.nan for w in words]) * TO_SI[unit]
        else:
            raise ValueError(f"table {name}: column {label!r} has unknown unit {unit!r}")
        columns[label].setflags(write=False)
    return Table(columns, certificate["origin"], certificate["source"])
