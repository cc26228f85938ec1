"""The configuration of the design in SI, and the data tables it needs."""

import numpy as np

from plasmapyro import tables

TABLES = {
    "detectors": "instrument/detectors",
    "air": "instrument/air_bands",
    "filters": "instrument/filters",
    "pyrometers": "instrument/pyrometers",
}


def settings_from(keys, air_path_mm):
    """Settings of `stage.band_design` and `trust.trust` from the keys of the configuration.

    Parameters
    ----------
    keys : mapping, the section `design`
    air_path_mm : float [mm], from window to instrument

    Returns
    -------
    dict
    """
    receiver, sizes = keys["receiver"], keys["uncertainties"]
    return {
        **keys,
        "map_emittance": np.linspace(*keys["map_emittance"]),
        "receiver": {
            "throughput": receiver["throughput_m2_sr"],
            "area": receiver["area_mm2"] * 1e-6,
            "bandwidth": receiver["bandwidth_hz"],
            "amplifier_noise": receiver["amplifier_noise_a_per_root_hz"],
        },
        "uncertainties": {
            "signal": sizes["signal"],
            "source_temperature": sizes["source_temperature_k"],
            "source_reference": sizes["source_reference_k"],
            "emittance": sizes["emittance"],
            "emittance_slope": sizes["emittance_slope_per_um"] * 1e6,
            "window_slope": sizes["window_slope_per_um"] * 1e6,
            "air_path": air_path_mm * 1e-3,
        },
    }


def design_tables(silicon_table):
    """The data tables of the design: `detectors`, `air`, `filters`, `pyrometers` and `silicon`."""
    loaded = {name: tables.load(path) for name, path in TABLES.items()}
    return {**loaded, "silicon": tables.load(f"detector/{silicon_table}")}
