"""What every netCDF file between two stages must contain: names, dims, units, ranges.

`VARIABLES` (variables.csv) says once what a name means, `DATASETS` (datasets.csv) which names a file holds.
"""

from plasmapyro.contracts.check import ContractError, check, label
from plasmapyro.contracts.datasets import DATASETS
from plasmapyro.contracts.variables import VARIABLES, Variable

__all__ = ["DATASETS", "VARIABLES", "ContractError", "Variable", "check", "label"]
