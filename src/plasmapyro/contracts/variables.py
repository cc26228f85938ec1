"""What a name means in every netCDF file: unit, words, range. The register itself is `variables.csv`."""

from dataclasses import dataclass
from math import inf

from plasmapyro.tables import rows


@dataclass(frozen=True)
class Variable:
    """Unit ("" for text), words and range of a variable; `nan_allowed`: values may be missing."""

    units: str
    long_name: str
    low: float = -inf
    high: float = inf
    nan_allowed: bool = False
    standard_name: str = ""


def _register():
    for row in rows("contracts/variables.csv"):
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
