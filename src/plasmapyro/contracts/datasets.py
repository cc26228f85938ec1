"""Which variables a netCDF file holds, on which dimensions. The register itself is `datasets.csv`.

A row names variables of one contract that stand on the same dimensions; a name that ends in '?' is optional.
A contract may hold all of others, see `AS_IN`.
"""

from plasmapyro.tables import rows

# Files of the gas of one condition may say which, in attributes: numbers, or text (see `conditions`).
OF_A_CONDITION = ("sightline", "spectrum", "radiation", "gas_variations")
CONDITION = ("numerical_power", "chamber_pressure", "mass_flow_rate", "gas", "flow_settings")
# Conditions of a study that have no flow are NaN, whatever the variable allows elsewhere.
WITH_GAPS = {"study_signal", "study"}


AS_IN = "as in"  # of a row, in place of dimensions: its names are contracts further up, all of them optional


def _register():
    found = {}
    for row in rows("contracts/datasets.csv"):
        names, of_contract = row["variables"].split(), found.setdefault(row["contract"], {})
        if row["dimensions"] == AS_IN:
            others = [pair for name in names for pair in found[name].items()]
            of_contract.update((f"{name.rstrip('?')}?", dims) for name, dims in others)
        else:
            of_contract.update(dict.fromkeys(names, tuple(row["dimensions"].split())))
    return found


DATASETS = _register()
