"""Light of the gas in both bands at some powers, for tests that need a table of it."""

import numpy as np
import xarray as xr

# Band signals of the gas at 60 to 130 kW, 50 mbar [W m-2 sr-1], typed from a run.
POWERS = {"60kW": (1.988, 0.590), "90kW": (10.52, 2.179), "110kW": (21.88, 3.606), "130kW": (87.07, 11.57)}


def gas(powers=POWERS, factor=1.0):
    return xr.Dataset(
        {
            "gas_signal": (("condition", "band"), np.array(list(powers.values())) * factor),
            "numerical_power": ("condition", [1e3 * float(name[:-2]) for name in powers]),
            "sample_emittance": ("condition", np.full(len(powers), 0.85)),
        },
        {"condition": list(powers), "band": ["wide", "narrow"]},
    )
