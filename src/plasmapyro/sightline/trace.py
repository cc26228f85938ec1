"""A straight ray through simplices: where it is inside, and what it meets there."""

from dataclasses import dataclass

import numpy as np

CRACK = 0.1  # gaps shorter than this part of the median crossing of a cell are cracks between cells
STRAIGHT = 1e-9  # of its length: what lies nearer to a straight ray may touch it
TOUCH = 1e-12  # barycentric coordinate that still counts as inside
ROWS = 400  # samples located at a time
EDGES = {  # corners of a simplex -> those that each middle node lies between
    3: ((0, 1), (1, 2), (2, 0)),
    4: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
}


@dataclass(frozen=True)
class Field:
    """Simplices with values at their nodes, in SI.

    `points` (N, d) [m], `simplices` (M, d + 1), `middles` (M, edges) with -1 for cells without middle nodes,
    `values` name -> (N,).
    """

    points: np.ndarray
    simplices: np.ndarray
    middles: np.ndarray
    values: dict


@dataclass(frozen=True)
class Ray:
    """Origin [m] and unit direction in space; `axisymmetric`: mesh coordinates are (axial, radial)."""

    origin: np.ndarray
    direction: np.ndarray
    axisymmetric: bool

    def at(self, distance):
        """Mesh coordinates (S, d) [m] at distances (S,) [m] from the origin."""
        point = self.origin + np.multiply.outer(np.asarray(distance, dtype=float), self.direction)
        if not self.axisymmetric:
            return point
        return np.stack([point[..., 0], np.hypot(point[..., 1], point[..., 2])], axis=-1)


@dataclass(frozen=True)
class Crossings:
    """Cells (K,) that a ray crosses, and the distances (K,) [m] at which it enters and leaves each."""

    simplex: np.ndarray
    enter: np.ndarray
    leave: np.ndarray


def crossings(field, ray, reach):
    r"""Every simplex that the ray crosses up to `reach` [m], in the order of the distance of entry.

    A barycentric coordinate along the ray is :math:`\lambda(t) = a + b t + c\,r(t)` with the distance from
    the axis :math:`r(t)` in an axisymmetric field and c = 0 otherwise; the cell is crossed where all are >=
    0.
    """
    near = _near(field, ray, reach)
    matrix = _barycentric(field, near)
    if not ray.axisymmetric:
        dimension = field.points.shape[1]
        start = matrix[:, :, :dimension] @ ray.origin[:dimension] + matrix[:, :, dimension]
        slope = matrix[:, :, :dimension] @ ray.direction[:dimension]
        index, enter, leave = _straight(start, slope, 0.0, reach)
    else:
        index, enter, leave = _around(matrix, ray, reach)
    order = np.argsort(enter, kind="stable")
    return Crossings(near[index][order], enter[order], leave[order])


def _near(field, ray, reach):
    """Indices of simplices that may touch the ray: their circumscribed ball about the centroid does."""
    corners = field.points[field.simplices]
    if ray.axisymmetric:
        first, _, last = ends = ray.at([0.0, reach / 2, reach])
        aside = np.array([first[1] - last[1], last[0] - first[0]]) / reach
        if np.abs((ends - first) @ aside).max() <= TOUCH * reach:  # a straight line in these coordinates
            side = ((field.points - first) @ aside)[field.simplices]
            touch = STRAIGHT * reach
            return np.flatnonzero((side.min(axis=1) <= touch) & (side.max(axis=1) >= -touch))
        along = ray.at(np.linspace(0, reach, 200))
        apart = reach / 199
        low, high = along.min(axis=0) - apart, along.max(axis=0) + apart
        return np.flatnonzero(
            (corners.max(axis=1) >= low).all(axis=1) & (corners.min(axis=1) <= high).all(axis=1)
        )
    centre = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
    dimension = field.points.shape[1]
    offset = centre - ray.origin[:dimension]
    direction = ray.direction[:dimension]
    across = offset - np.multiply.outer(offset @ direction, direction)
    return np.flatnonzero(np.linalg.norm(across, axis=1) <= radius * (1 + 1e-9))


def _barycentric(field, index):
    """Rows (K, d + 1, d + 1): coordinate k is row k times (x, 1)."""
    corners = field.points[field.simplices[index]]
    columns = np.concatenate([corners, np.ones((*corners.shape[:2], 1))], axis=2).transpose(0, 2, 1)
    return np.linalg.inv(columns)


def _straight(start, slope, first, last):
    """Intervals within [first, last] where all `start + slope t` are >= 0: index, enter, leave."""
    start = start + TOUCH  # a ray along a face crosses the cells on both sides
    with np.errstate(divide="ignore", invalid="ignore"):
        root = -start / slope
    enter = np.where(slope > 0, root, -np.inf).max(axis=1).clip(min=first)
    leave = np.where(slope < 0, root, np.inf).min(axis=1).clip(max=last)
    outside = ((slope == 0) & (start < 0)).any(axis=1)
    index = np.flatnonzero((leave > enter) & ~outside)
    return index, enter[index], leave[index]


def _around(matrix, ray, reach):
    """The same for a path whose second coordinate is the distance from the axis."""
    across, sideways = ray.origin[1:], ray.direction[1:]
    square, mixed, constant = sideways @ sideways, sideways @ across, across @ across
    start = matrix[:, :, 0] * ray.origin[0] + matrix[:, :, 2]
    slope = matrix[:, :, 0] * ray.direction[0]
    radial = matrix[:, :, 1]
    impact = np.sqrt(max(constant - mixed**2 / square, 0.0)) if square > 0 else np.sqrt(constant)
    if square == 0:
        return _straight(start + radial * impact, slope, 0.0, reach)
    if impact <= TOUCH * np.sqrt(constant + reach**2):
        # In a plane through the axis the distance from it is linear before and after the axis.
        turn, pace = -mixed / square, np.sqrt(square)
        parts = [
            _straight(start - sign * radial * pace * turn, slope + sign * radial * pace, first, last)
            for sign, first, last in ((-1, 0.0, min(turn, reach)), (1, max(turn, 0.0), reach))
            if last > first
        ]
        return tuple(np.concatenate(part) for part in zip(*parts, strict=True))
    start = start + TOUCH
    a = slope**2 - radial**2 * square
    b = start * slope - radial**2 * mixed
    c = start**2 - radial**2 * constant
    # b^2 - a c, with the terms that cancel for an edge along the radius left out beforehand.
    spread = start**2 * square - 2 * start * slope * mixed + slope**2 * constant
    discriminant = radial**2 * (spread - radial**2 * (square * constant - mixed**2))
    with np.errstate(divide="ignore", invalid="ignore"):
        q = -(b + np.copysign(np.sqrt(discriminant), b))
        roots = np.concatenate([q / a, c / q], axis=1)
    roots = np.where(np.isfinite(roots), roots, 0.0).clip(0.0, reach)
    outer = np.broadcast_to([0.0, reach], (len(roots), 2))
    ends = np.sort(np.concatenate([roots, outer], axis=1), axis=1)
    middle = (ends[:, 1:] + ends[:, :-1]) / 2
    distance = np.sqrt(np.maximum(square * middle**2 + 2 * mixed * middle + constant, 0))
    value = start[:, :, None] + slope[:, :, None] * middle[:, None] + radial[:, :, None] * distance[:, None]
    inside = (value.min(axis=1) >= 0) & (np.diff(ends, axis=1) > 0)
    index, piece = np.nonzero(inside)
    return index, ends[index, piece], ends[index, piece + 1]


def stretches(found):
    """First and last distance (stretches, 2) [m] of the ray inside the field, cracks between cells closed."""
    furthest = np.maximum.accumulate(found.leave)
    crack = CRACK * np.median(found.leave - found.enter)
    breaks = np.flatnonzero(found.enter[1:] - furthest[:-1] > crack)
    first = np.concatenate([[0], breaks + 1])
    last = np.concatenate([breaks, [len(furthest) - 1]])
    return np.stack([found.enter[first], furthest[last]], axis=1)


def values_along(field, ray, found, distance, names):
    r"""Fields (S,) along the ray by their names, linear in simplices, quadratic with middle nodes.

    .. math:: f = \sum_i \lambda_i f_i + \sum_{i<j} 4\lambda_i\lambda_j\,(f_{ij} - (f_i + f_j)/2)

    at distances (S,) [m] inside the stretches of the crossings found. Source: Zienkiewicz & Taylor, The
    Finite Element Method, 5th ed., chapter 8.
    """
    chosen = np.empty(len(distance), dtype=np.int64)
    for start in range(0, len(distance), ROWS):
        part = distance[start : start + ROWS, None]
        depth = np.minimum(part - found.enter, found.leave - part)
        chosen[start : start + ROWS] = depth.argmax(axis=1)
    simplex = found.simplex[chosen]
    point = ray.at(distance)[:, : field.points.shape[1]]
    matrix = _barycentric(field, simplex)
    weight = np.einsum("skd,sd->sk", matrix[:, :, :-1], point) + matrix[:, :, -1]
    # In a crack between cells, and by rounding on a face, a coordinate is below 0.
    weight = np.maximum(weight, 0.0)
    weight /= weight.sum(axis=1, keepdims=True)
    corner, middle = field.simplices[simplex], field.middles[simplex]
    edges = EDGES[corner.shape[1]]
    result = {}
    for name in names:
        value = field.values[name]
        with np.errstate(invalid="ignore"):  # infinite values of the file; the caller looks for them
            total = (weight * value[corner]).sum(axis=1)
            for k, (i, j) in enumerate(edges):
                bulge = value[middle[:, k]] - (value[corner[:, i]] + value[corner[:, j]]) / 2
                total += np.where(middle[:, k] >= 0, 4 * weight[:, i] * weight[:, j] * bulge, 0.0)
        result[name] = total
    return result
