"""What a file says of the power condition that its gas belongs to, and which conditions form a ladder.

Names of conditions mean nothing: `mine` is as good as `80kW`. A file that does not state its power is used as
it is and stands on no ladder.
"""

import json

import numpy as np

POWER = "numerical_power"  # [W]
STATE = ("chamber_pressure", "mass_flow_rate")  # [Pa], [kg s-1]
WORDS = ("gas", "flow_settings")
OF_FLOW = (  # attributes of a flow that fix its field besides the condition
    "torch",
    "coil_frequency",
    "wall_temperature",
    "probe_temperature",
    "swirl_angle",
    "radiation_factor",
    "mixing",
    "back_wall_temperature",
    "tube_wall_temperature",
    "chamber_wall_temperature",
    "adiabatic_walls",
    "mesh_factor",
    "viscosity_limiter",
)
SAME = 1e-6  # [1], relative difference of equal numbers
SAME_PRESSURE = 0.1  # [1] within which a simulation is taken as that of the pressure of a test
FLOW_PRESSURE = "flow_pressure"  # attribute [Pa]: of the flow that has the temperatures of a gas at another


def stated(*, gas, settings, numerical_power=None, chamber_pressure=None, mass_flow_rate=None):
    """Attributes that say which condition the gas of a file belongs to; None for what is not known.

    `gas`: such as 'air'; `settings`: all else that fixes the gas along the line of sight besides the power:
    geometry, wall temperatures, numerics; power [W], pressure [Pa], mass flow rate [kg s-1].
    """
    numbers = {POWER: numerical_power, **dict(zip(STATE, (chamber_pressure, mass_flow_rate), strict=True))}
    return {
        **{name: float(value) for name, value in numbers.items() if value is not None},
        "gas": gas,
        "flow_settings": json.dumps(settings, sort_keys=True, default=float),
    }


def carried(dataset):
    """The same attributes as far as a dataset has them, for what is made from it."""
    names = (POWER, *STATE, *WORDS)
    return {name: dataset.attrs[name] for name in names if name in dataset.attrs}


def number(dataset, name):
    """One of the numbers [SI] that a dataset states of its condition, NaN if it does not."""
    return float(dataset.attrs.get(name, np.nan))


def pressure_of(test):
    """Pressure [Pa] of the chamber in a test; NaN if it records none."""
    values = test["chamber_pressure"].values if "chamber_pressure" in test else np.array([])
    return float(np.nanmedian(values)) if np.isfinite(values).any() else float("nan")


def of_another_pressure(test, simulated):
    """Whether a test ran at another pressure than a dataset states; False where either does not say."""
    return bool(abs(pressure_of(test) / number(simulated, "chamber_pressure") - 1) > SAME_PRESSURE)


def ladder(condition, datasets):
    """Conditions that share all but the power with one of them, itself among them, by rising power.

    `datasets`: condition -> Dataset with the attributes of `stated`. Of several with one power (they differ
    in what the gas does not know of, such as the emittance) `condition` stands for all, or else the first by
    name; a condition without a power stands alone.
    """
    own = datasets[condition]
    if np.isnan(number(own, POWER)):
        return [condition]
    steps = []
    for name in (condition, *sorted(datasets)):
        power = number(datasets[name], POWER)
        if _alike(own, datasets[name]) and not any(_equal(power, known) for known, _ in steps):
            steps.append((power, name))
    return [name for _, name in sorted(steps)]


def _alike(one, other):
    """Whether two datasets differ at most in their power, which both state."""
    numbers = all(_equal(number(one, name), number(other, name)) for name in STATE)
    words = all(one.attrs.get(name) == other.attrs.get(name) for name in WORDS)
    return numbers and words and not np.isnan(number(other, POWER))


def _equal(first, second):
    return bool(np.isclose(first, second, rtol=SAME, atol=0.0, equal_nan=True))
