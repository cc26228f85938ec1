"""What crosses sections of torch and chamber: momentum, pressure force and enthalpy along the axis."""

import json

import numpy as np

from plasmapyro.flow.properties import gas_properties
from plasmapyro.sightline.stage import on_line

SECTIONS, POINTS = 80, 161
EDGE = 1e-6  # [m] off the walls, so that points lie inside
NAMES = ("temperature", "axial_velocity", "pressure", "joule_heating")
HOT = 3000.0  # [K]: gas of the jet, not of the cold sheath


def sections(flow, gas):
    r"""Integrals over cross-sections from the back wall to the nose of the probe.

    .. math:: \dot M = \int\rho u^2\,dA, \quad F = \int(p - p_0)\,dA, \quad \dot H = \int\rho u h\,dA, \quad
              Q = \int_0^z\!\int q\,dA\,dz

    `flow`, `gas`: Datasets of these contracts. Returns a dict of arrays (80,): `position` [m]; `momentum`,
    `hot_momentum` (gas above 3000 K) and `pressure_force` [N]; `enthalpy` (zero at the wall temperature) and
    `heating` [W]; and the position of the `exit` [m].
    """
    pressure = float(flow.chamber_pressure)
    properties = gas_properties(gas, pressure, float(flow.attrs["wall_temperature"]))
    end = float(flow.attrs["stagnation_point_z"])
    found = {"position": np.linspace(EDGE, end - EDGE, SECTIONS)}
    node_z, node_r = flow.node_z.values, flow.node_r.values
    found["exit"] = length = float(json.loads(flow.attrs["torch"])["length"])
    inner, outer = node_r[node_z < length - EDGE].max(), node_r.max()
    rows = []
    for z in found["position"]:
        r = np.linspace(0.0, inner if z < length else outer, POINTS)
        inside = np.clip(r, EDGE, r[-1] - EDGE)
        kelvin, speed, there, heating = on_line(flow, np.full_like(r, z), inside, NAMES).values()
        flux = properties.density(kelvin)[0] * speed
        columns = (
            flux * speed,
            np.where(kelvin > HOT, flux * speed, 0.0),
            there - pressure,
            flux * properties.enthalpy(kelvin)[0],
            heating,
        )
        rows.append([np.trapezoid(2 * np.pi * r * column, r) for column in columns])
    names = ("momentum", "hot_momentum", "pressure_force", "enthalpy", "heating")
    found |= dict(zip(names, np.array(rows).T, strict=True))
    steps = np.diff(found["position"]) * (found["heating"][1:] + found["heating"][:-1]) / 2
    found["heating"] = np.concatenate([[0.0], np.cumsum(steps)])
    return found
