"""What a computed flow gives a probe: the gas on the axis ahead of it, and what its own probe takes."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.checks import positive
from plasmapyro.facility.stagnation_line import Edge
from plasmapyro.flow.properties import gas_properties
from plasmapyro.gas.species import AIR, nitrogen_of
from plasmapyro.sightline.stage import on_line

EDGE_RADII = 0.6  # distance of the edge of a stagnation line, in radii of the probe
JET_RADII = 2.0  # distance at which the jet no longer knows of the probe, likewise
OFF_AXIS = 0.04  # radii of the probe: where the gradient of the radial speed is taken


@dataclass(frozen=True)
class Jet:
    """Gas on the axis: temperature [K], chamber pressure [Pa], speed [m s-1], own pressure above it [Pa], and
    the mole fraction of N2 in the cold gas."""

    temperature: float
    pressure: float
    speed: float
    gauge_pressure: float
    nitrogen: float = AIR["N2"]


def jet_ahead(flow, radius):
    """The `Jet` two radii ahead of the nose of a probe of some radius [m] in a flow (contract 'flow')."""
    state = _on_axis(flow, JET_RADII * positive("radius", radius, "m"))
    return Jet(
        state["temperature"],
        float(flow.chamber_pressure),
        state["axial_velocity"],
        state["gauge"],
        nitrogen_of(flow),
    )


def edge_ahead(flow, radius):
    """`Edge` of the stagnation line of the probe in a computed flow, 0.6 radii ahead; as `jet_ahead`."""
    distance = EDGE_RADII * positive("radius", radius, "m")
    state = _on_axis(flow, distance)
    beside = OFF_AXIS * radius
    gradient = _value(flow, "radial_velocity", distance, beside) / beside
    return Edge(
        state["temperature"],
        float(flow.chamber_pressure),
        distance,
        state["axial_velocity"],
        gradient,
        nitrogen_of(flow),
    )


def potential_edge(jet, radius):
    r"""`Edge` of the stagnation line of a sphere in a uniform stream without friction.

    .. math:: u = U(1 - R^3/\xi^3), \qquad \frac{\partial v_r}{\partial r} = \frac{3U}{2}\frac{R^3}{\xi^4}

    `jet`: a `Jet`; `radius` [m]: of the sphere; the edge lies 0.6 of it ahead.
    """
    distance = EDGE_RADII * float(positive("radius", radius, "m"))
    part = (radius / (radius + distance)) ** 3
    return Edge(
        jet.temperature,
        jet.pressure,
        distance,
        jet.speed * (1 - part),
        1.5 * jet.speed * part / (radius + distance),
        jet.nitrogen,
    )


def own_heat_flux(flow, gas):
    """Heat flux [W m-2] at the stagnation point of the probe of a computed flow, dS/dn of its gas.

    `flow`, `gas`: Datasets of these contracts.
    """
    properties = gas_properties(gas, float(flow.chamber_pressure), float(flow.attrs["wall_temperature"]))
    first = _axis_nodes(flow)[:3]
    distance = flow.attrs["stagnation_point_z"] - flow.node_z.values[first]
    potential = properties.heat_flux_potential(flow.temperature.values[first])[0]
    return float(np.polyfit(distance, potential, 2)[1])


def own_pressure(flow):
    """Pressure [Pa] at the stagnation point of the probe of a computed flow above that of the chamber."""
    return float(flow.pressure.values[_axis_nodes(flow)[0]] - flow.chamber_pressure)


def _axis_nodes(flow):
    """Nodes on the axis ahead of the nose, the nearest first."""
    ahead = flow.attrs["stagnation_point_z"] - flow.node_z.values
    found = np.flatnonzero((flow.node_r.values < 1e-9) & (ahead > -1e-9))
    return found[np.argsort(ahead[found])]


def _on_axis(flow, distance):
    names = ("temperature", "axial_velocity", "pressure")
    values = {name: _value(flow, name, distance, 0.0) for name in names}
    return {**values, "gauge": values["pressure"] - float(flow.chamber_pressure)}


def _value(flow, name, distance, r):
    place = flow.attrs["stagnation_point_z"] - distance
    return float(on_line(flow, place, r, [name])[name][0])
