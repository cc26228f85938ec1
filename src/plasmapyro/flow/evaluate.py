"""Values of a finite-element solution at any points, and its transfer to another mesh."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from plasmapyro.flow.physics import LOG_TEMPERATURE

NEAREST, MORE = 16, 240  # triangles around a point among which the one that holds it is looked for
INSIDE = -1e-9  # smallest area coordinate of a point inside a triangle, but for rounding
CONTINUED = -0.5  # a point this far outside takes the value at the edge of its triangle


@dataclass(frozen=True)
class Place:
    """Where points lie in a mesh: `triangle` (N,) and area coordinates `area` (3, N)."""

    triangle: np.ndarray
    area: np.ndarray


def place_in(mesh, points):
    """Place of points (2, N) in a triangle mesh.

    A point just outside (on the chord of a finer outline) belongs to the nearest triangle, with a negative
    area coordinate; a point far outside takes the nearest edge of it.
    """
    tree = cKDTree(mesh.p[:, mesh.t].mean(axis=1).T)
    triangle, area = _best(mesh, tree, points, NEAREST)
    # Where small triangles meet a large one its centre is not among the nearest.
    lost = np.flatnonzero(area.min(axis=0) < INSIDE)
    if len(lost):
        triangle[lost], area[:, lost] = _best(mesh, tree, points[:, lost], MORE)
    far = area.min(axis=0) < CONTINUED
    area[:, far] = np.maximum(area[:, far], 0.0)
    area[:, far] /= area[:, far].sum(axis=0)
    return Place(triangle, area)


def _best(mesh, tree, points, count):
    _, near = tree.query(points.T, k=min(count, mesh.nelements))
    (z0, z1, z2), (r0, r1, r2) = mesh.p[:, mesh.t[:, near]]  # each (N, count)
    z, r = points[0][:, None], points[1][:, None]
    twice = (z1 - z0) * (r2 - r0) - (z2 - z0) * (r1 - r0)
    second = ((z - z0) * (r2 - r0) - (z2 - z0) * (r - r0)) / twice
    third = ((z1 - z0) * (r - r0) - (z - z0) * (r1 - r0)) / twice
    area = np.stack([1 - second - third, second, third])
    best = area.min(axis=0).argmax(axis=1)
    rows = np.arange(len(best))
    return near[rows, best], area[:, rows, best]


def values_at(space, field, values, place):
    """Field `field` with dof values `values` (its own dofs only) at a Place (N,); linear or quadratic."""
    nodal = values[space.element_dofs(field)[:, place.triangle]]
    a, b, c = place.area
    if len(nodal) == 3:
        shape = (a, b, c)
    else:
        shape = (a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * a * c)
    return sum(weight * value for weight, value in zip(shape, nodal, strict=True))


def temperature_at(problem, state, points):
    """Temperature [K] of a state of a Problem at any points (2, N), through the heat-flux potential.

    It is interpolated between the nodes, being the quantity the conduction is computed with:
    nearly linear across a cell on a cold wall, where the temperature rises tenfold.
    """
    properties = problem.properties
    nodal = np.exp(state[problem.space.field(LOG_TEMPERATURE)])
    potential = properties.heat_flux_potential(nodal)[0]
    place = place_in(problem.mesh, points)
    return properties.temperature_of(values_at(problem.space, LOG_TEMPERATURE, potential, place))


def transfer(state, source, target):
    """State of problem `source` as a first guess for problem `target` (another mesh, order or condition).

    The temperature goes through the heat-flux potential, within its range in `source`: interpolated as ln T
    it would be too low by thousands of kelvin in the new cells on a cold wall.
    """
    guess = carried(state, source, target)
    heat = target.space.field(LOG_TEMPERATURE)
    here, there = source.space.points(LOG_TEMPERATURE), target.space.points(LOG_TEMPERATURE)
    if not (here.shape == there.shape and np.array_equal(here, there)):
        known = np.exp(state[source.space.field(LOG_TEMPERATURE)])
        guess[heat] = np.log(temperature_at(source, state, there).clip(known.min(), known.max()))
    guess[target.fixed] = target.values[target.fixed]
    return guess


def carried(state, source, target):
    """Dof vector of `target` with the fields that dof vector `state` of `source` describes."""
    fields, places = [], {}
    for index in range(len(source.space.orders)):
        order, values = target.space.orders[index], state[source.space.field(index)]
        here, there = source.space.points(index), target.space.points(index)
        if here.shape == there.shape and np.array_equal(here, there):
            fields.append(values)
            continue
        if order not in places:
            places[order] = place_in(source.mesh, there)
        fields.append(values_at(source.space, index, values, places[order]))
    return np.concatenate(fields)
