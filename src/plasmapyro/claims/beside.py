"""What the paper claims of a simulated gas, beside the same of the gas that a test has measured."""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from plasmapyro.analysis import stage
from plasmapyro.claims.analysis import error_claims, visibility_claims
from plasmapyro.quantities import in_si, steps

SHOWN = (  # those that one gas alone has
    "transition_begins",
    "transition_ends",
    "interference_up_to",
    "error_below_1500K",
    "error_over_the_range",
    "transient_falls",
    "transient_turns",
)


@dataclass(frozen=True)
class Beside:
    """Of several gases: `claims`, rows (statement, value of each gas), and `errors` (G, E, T) [K] of the
    reading over emittance and surface temperature, NaN without a reading within the instrument's range."""

    claims: tuple
    errors: np.ndarray


def beside(signals, response, curve, *, emittance, analysis):
    """Claims and error map of several gases before one surface of an emittance [1].

    `signals`: name -> (2,) [W m-2 sr-1], of the gas in the bands; `analysis`: that section of the
    configuration.
    """
    names = list(signals)
    gas = xr.Dataset(
        {
            "gas_signal": (("condition", "band"), list(signals.values())),
            "sample_emittance": ("condition", np.full(len(names), emittance)),
        },
        {"condition": names, "band": ["wide", "narrow"]},
    )
    given = in_si(analysis)
    heating = in_si(given["transient"]) | {"conditions": names}
    temperature = steps(*given["error_temperature"])
    made = [
        stage.visibility(
            gas,
            response,
            object_temperature=steps(*given["visibility_temperature"]),
            visibility_level=given["visibility_level"],
        ),
        stage.apparent_temperature(
            gas, response, curve, object_temperature=steps(*given["apparent_temperature"])
        ),
        stage.error_map(
            gas,
            response,
            curve,
            object_temperature=temperature,
            emittance=np.geomspace(*given["error_emittance"]),
            error_level=given["error_level"],
        ),
        stage.transient(gas, response, curve, **heating | {"time": steps(*heating["time"])}),
    ]
    found = []
    for place, name in enumerate(names):
        seen, *others = (one.isel(condition=[place]) for one in made)
        claims = [*visibility_claims(seen), *error_claims(*others)]
        found.append({claim.key.removesuffix(f"_{name}"): claim for claim in claims})
    rows = tuple((_said(found[0][key], names[0]), [one[key].value for one in found]) for key in SHOWN)
    kelvin = made[2]["relative_error"].values * temperature
    low, high = curve["instrument_range"].values
    inside = (kelvin + temperature >= low) & (kelvin + temperature <= high)
    return Beside(rows, np.where(inside, kelvin, np.nan))


def _said(claim, name):
    """Statement and unit of a claim, without the name of a gas."""
    words = claim.statement.replace(f" ({name})", "").replace(f"({name}; ", "(")
    return f"{words} [{claim.unit}]"


def of_tests(predictions, tests, response, curve, analysis):
    """`Beside` of the base, the extended and the measured gas of each test, by its name.

    `predictions`: name -> (base, extended) `diagnosis.simulation.predicted.Prediction`; the rest as of
    `beside`.
    """
    return {
        name: beside(
            {"base": base.bands[0], "extended": extended.bands[0], "measured": base.bands[1]},
            response,
            curve,
            emittance=float(tests[name].attrs["emittance"]),
            analysis=analysis,
        )
        for name, (base, extended) in predictions.items()
    }
