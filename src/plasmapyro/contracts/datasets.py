"""Which variables a netCDF file holds, on which dimensions. The register itself is `datasets.csv`.

A row names variables of one contract that stand on the same dimensions; a name that ends in '?' is optional.
"""

from plasmapyro.tables import rows

# Files of the gas of one condition may say which, in attributes: numbers, or text (see `conditions`).
OF_A_CONDITION = ("sightline", "spectrum", "radiation", "gas_variations")
CONDITION = ("numerical_power", "chamber_pressure", "mass_flow_rate", "gas", "flow_settings")
# Conditions of a study that have no flow are NaN, whatever the variable allows elsewhere.
WITH_GAPS = {"study_signal", "study"}


def _register():
    found = {}
    for row in rows("contracts/datasets.csv"):
        dims = tuple(row["dimensions"].split())
        found.setdefault(row["contract"], {}).update(dict.fromkeys(row["variables"].split(), dims))
    return found


DATASETS = _register()


def _optional(*contracts):
    return {f"{name.rstrip('?')}?": dims for one in contracts for name, dims in DATASETS[one].items()}


# A study holds a flow or only the word that there is none.
DATASETS["study_flow"] = _optional("flow") | DATASETS["study_flow"]
for _name in ("joint_estimate", "emissivity_estimate"):
    DATASETS[_name] = _optional("temperature") | DATASETS[_name]
# What `plasmapyro correct` writes: of each instrument that the test holds, and what to take away.
DATASETS["correction"] = _optional(
    "pyrometer_correction", "spectrometer_correction", "joint_estimate", "emissivity_estimate", "temperature"
)
