"""What a name means in every netCDF file: unit, words, range. The register itself is `variables.csv`."""

import csv
from dataclasses import dataclass
from importlib.resources import files
from math import inf


@dataclass(frozen=True)
class Variable:
    """Unit ("" for text), words and range of a variable; `nan_allowed`: values may be missing."""

    units: str
    long_name: str
    low: float = -inf
    high: float = inf
    nan_allowed: bool = False
    standard_name: str = ""


def rows_of(name):
    """Rows of a register beside this module, as mappings by the names of its columns."""
    with (files("plasmapyro") / "contracts" / name).open(encoding="utf-8", newline="") as table:
        return list(csv.DictReader(table))


def _register():
    for row in rows_of("variables.csv"):
        yield (
            row["name"],
            Variable(
                "" if row["unit"] == "text" else row["unit"],
                row["meaning"],
                float(row["lowest"] or -inf),
                float(row["highest"] or inf),
                row["may be missing"] == "yes",
                row["standard name"],
            ),
        )


VARIABLES = dict(_register())
