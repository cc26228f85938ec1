"""The configuration of the design in SI, and the data tables it needs."""

import numpy as np

from plasmapyro import tables
from plasmapyro.quantities import in_si

TABLES = {
    "detectors": "instrument/detectors",
    "air": "instrument/air_bands",
    "filters": "instrument/filters",
    "pyrometers": "instrument/pyrometers",
}


def settings_from(keys, air_path_mm):
    """Settings of `stage.band_design` and `trust.trust` from the section `design` of the configuration.

    `air_path_mm`: from window to instrument.
    """
    return {
        **keys,
        "map_emittance": np.linspace(*keys["map_emittance"]),
        "receiver": in_si(keys["receiver"]),
        "uncertainties": in_si(keys["uncertainties"] | {"air_path_mm": air_path_mm}),
    }


def design_tables(silicon_table):
    """The data tables of the design: `detectors`, `air`, `filters`, `pyrometers` and `silicon`."""
    loaded = {name: tables.load(path) for name, path in TABLES.items()}
    return {**loaded, "silicon": tables.load(f"detector/{silicon_table}")}
