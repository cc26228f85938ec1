"""The scene of a test of the main job, with the effects that its configuration hides."""

from dataclasses import replace
from functools import partial

import numpy as np

from twin import gas, hidden, incident, light
from twin.campaign import Scene

BOLTZMANN = 1.380649e-23
STATE = ("chamber_pressure", "mass_flow_rate")  # of a gas, that its test records
POWER = "power"  # hidden in the gas itself: its power over that of the simulation, less 1


def faults_of(tests, folder):
    """What is wrong with the effects that tests hide, by file and place; empty if nothing is."""
    lines = []
    for name, case in tests.items():
        found = []
        for place, one in enumerate(case.get("twin", {}).get("effects", [])):
            fault = power_fault if one["effect"] == POWER else partial(hidden.fault_of, one["effect"])
            if words := fault(one["amplitude"], one.get("shape")):
                found.append(f"  twin.effects.{place}: {words}")
        lines += [f"{folder}/{name}.yaml:", *found] if found else []
    return "\n".join(lines)


def power_fault(change, shape=None):
    """What is wrong with a power that is to be hidden, as `hidden.fault_of`."""
    if shape:
        return f"{POWER}: shape has no {', '.join(sorted(shape))}; it takes none"
    return "" if change > -1 else f"{POWER}: amplitude must lie above -1, no power at all; got {change:g}"


def true_gas(effects, weighted, beside=()):
    """The true gas: that of the simulations, or that of another power if this is what is hidden.

    `weighted`, and what is returned: pairs of a weight and a Dataset, radiance by component; `beside`:
    Datasets alike at other powers; `effects` as for `scene`.
    """
    change = sum(one["amplitude"] for one in effects if one["effect"] == POWER)
    return [(weight, at_power(change, one, beside)) for weight, one in weighted] if change else weighted


def at_power(change, own, beside):
    r"""Light of the gas at :math:`P = P_0 (1 + a)`, between that at :math:`P_0` and at the next power:

    .. math:: \ln L_k(P) = (1 - s) \ln L_k(P_0) + s \ln L_k(P_1), \qquad
              s = \frac{\ln P/P_0}{\ln P_1/P_0}

    for each radiating system k. `own` and `beside` as in `true_gas`. ValueError: a power that does not lie
    between simulated ones.
    """
    shares = [(np.log1p(change) / np.log(_power(one) / _power(own)), one) for one in beside]
    share, other = max(shares, key=lambda pair: pair[0] if pair[0] <= 1 else -1.0)
    if not 0 <= share <= 1:
        raise ValueError(
            f"no simulation lies beyond {_power(own) / 1e3 * (1 + change):g} kW of the power hidden at"
            f" {_power(own) / 1e3:g} kW"
        )
    own_light, others = own["gas_radiance_component"], other["gas_radiance_component"].values
    found = light.between(share, own_light, others)
    return own.assign(gas_radiance_component=found, gas_radiance=found.sum("component"))


def _power(dataset):
    return float(dataset.attrs["numerical_power"])


def scene(condition, effects, weighted, profile, **facts):
    """A scene of a condition that the laboratory compares with, the plain one if nothing is hidden.

    `effects`: `effect`, `amplitude` and, if wanted, `shape`, as for `hidden.hide`; and the power of the gas.
    `weighted`: pairs of a weight and a Dataset, the true gas, radiance by component. `profile`: (sightline,
    composition), and flow if a surface scatters, or empty if nothing is hidden. `facts`: other fields of the
    scene.
    """
    true = {name: float(weighted[0][1].attrs[name]) for name in STATE if name in weighted[0][1].attrs}
    told = Scene(condition=condition, centred_exposures=True, **true | facts)
    if not effects:
        return told
    plasma = _gas(weighted, told.chamber_pressure, *profile)
    for one in effects:
        if one["effect"] == POWER:
            note = {"effect": POWER, "amplitude": one["amplitude"], "shape": {}}
            told = replace(told, hidden=(*told.hidden, note))
        else:
            told = hidden.hide(told, one["effect"], one["amplitude"], plasma, one.get("shape"))
    return told


def _gas(weighted, pressure, sightline, composition, flow=None):
    kept = [gas.spectra([dataset], [1.0]) for _, dataset in weighted]
    radiance = sum(weight * one.radiance[0] for (weight, _), one in zip(weighted, kept, strict=True))
    at = composition.sel(pressure=pressure, method="nearest")
    number = float(at.pressure) / (BOLTZMANN * at.temperature.values)
    return gas.Gas(
        kept[0].centres,
        kept[0].systems,
        radiance,
        sightline.path_distance.values,
        sightline.temperature.values,
        at.temperature.values,
        {str(name): number * at.mole_fraction.sel(species=name).values for name in at.species.values},
        view=None if flow is None else incident.view(flow, at.temperature.values),
    )
