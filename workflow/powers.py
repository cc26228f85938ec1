"""Results of the main job that differ in nothing but the power, as the files themselves say."""

import xarray as xr

ELSE = ("chamber_pressure", "mass_flow_rate", "gas", "flow_settings")


def ladder(folder):
    """Power [W] -> path, rising, of the files in a folder: the most that share all but the power."""
    found = {}
    for path in sorted(folder.glob("[!.]*.nc")):
        with xr.open_dataset(path, decode_times=False) as one:
            facts = dict(one.attrs)
        if "numerical_power" in facts:
            same = found.setdefault(tuple(facts.get(name) for name in ELSE), {})
            same.setdefault(float(facts["numerical_power"]), path)
    return dict(sorted(max(found.values(), key=len, default={}).items()))
