"""Quadratic interpolation of nodal fields on the triangles of a flow file."""

from dataclasses import dataclass

import numpy as np

TOGETHER = 32  # points located at once
BESIDE = 1e-6  # [1], of the line's length
INSIDE = 1e-9  # smallest area coordinate that still counts as inside, for points on an edge


@dataclass(frozen=True)
class Location:
    """Triangle (points,) and area coordinates (points, 3) of points in the mesh."""

    face: np.ndarray
    area: np.ndarray


def locate(node_z, node_r, face_node, z, r):
    """Find the triangle that holds each point.

    Parameters
    ----------
    node_z, node_r : (node,) ndarray [m]
    face_node : (face, 3) ndarray of int
    z, r : ndarray [m]
        Points on one straight line, shape (points,).

    Returns
    -------
    Location

    Raises
    ------
    ValueError
        A point lies outside the mesh (the message names the first).
    """
    z, r = np.asarray(z, dtype=float), np.asarray(r, dtype=float)
    near = _near_line(node_z, node_r, face_node, z, r)
    corners_z, corners_r = node_z[face_node[near]], node_r[face_node[near]]
    # Row k of `gradient` and `offset`: area coordinate k as an affine function of (z, r).
    next_z, next_r = np.roll(corners_z, -1, axis=1), np.roll(corners_r, -1, axis=1)
    last_z, last_r = np.roll(corners_z, 1, axis=1), np.roll(corners_r, 1, axis=1)
    twice_area = np.sum(corners_z * (next_r - last_r), axis=1, keepdims=True)
    by_z, by_r = (next_r - last_r) / twice_area, (last_z - next_z) / twice_area
    offset = (next_z * last_r - last_z * next_r) / twice_area
    # Places along the line: a few points at a time, against the triangles beside these.
    unit_z, unit_r = z[-1] - z[0], r[-1] - r[0]
    place, corners = z * unit_z + r * unit_r, corners_z * unit_z + corners_r * unit_r
    low, high = (
        bound(bound(corners[:, 0], corners[:, 1]), corners[:, 2]) for bound in (np.minimum, np.maximum)
    )
    slack = BESIDE * np.ptp(place)
    face, found = np.empty(z.size, dtype=near.dtype), np.empty((z.size, 3))
    for first in range(0, z.size, TOGETHER):
        part = slice(first, first + TOGETHER)
        beside = np.flatnonzero((high >= place[part].min() - slack) & (low <= place[part].max() + slack))
        # One coordinate at a time, (points, faces): a reduction over an axis of three is slow.
        area = [
            by_z[beside, k] * z[part, None] + by_r[beside, k] * r[part, None] + offset[beside, k]
            for k in range(3)
        ]
        smallest = np.minimum(np.minimum(area[0], area[1]), area[2])
        index = np.arange(len(smallest))
        best = smallest.argmax(axis=1) if beside.size else index
        outside = smallest[index, best] < -INSIDE if beside.size else index >= 0
        if outside.any():
            at = first + int(np.argmax(outside))
            raise ValueError(
                f"point z = {z[at]:.6g} m, r = {r[at]:.6g} m at index {at} lies outside the flow field"
            )
        face[part] = near[beside[best]]
        found[part] = np.stack([one[index, best] for one in area], axis=1)
    return Location(face, found)


def _near_line(node_z, node_r, face_node, z, r):
    """Triangles that touch the line through the first and the last point."""
    along_z, along_r = z[-1] - z[0], r[-1] - r[0]
    side = (node_z - z[0]) * along_r - (node_r - r[0]) * along_z
    reach = INSIDE * max(np.hypot(along_z, along_r), np.finfo(float).tiny)
    first, second, third = side[face_node].T
    lowest, highest = (bound(bound(first, second), third) for bound in (np.minimum, np.maximum))
    touched = np.flatnonzero((lowest <= reach) & (highest >= -reach))
    if touched.size == 0:
        raise ValueError(f"the line from z = {z[0]:.6g} m, r = {r[0]:.6g} m misses the flow field")
    return touched


def interpolate(values, face_node, face_midnode, location):
    r"""Value of a quadratic (P2) nodal field at located points.

    .. math:: f = \sum_k f_k \lambda_k(2\lambda_k - 1) + \sum_k 4 f_{k,k+1}\lambda_k\lambda_{k+1}

    Parameters
    ----------
    values : (node,) ndarray
    face_node, face_midnode : (face, 3) ndarray of int
        Middle node k lies on the edge from corner k to corner k + 1 (mod 3).
    location : Location

    Returns
    -------
    (points,) ndarray
        Unit of `values`.

    Notes
    -----
    Source: Zienkiewicz & Taylor, The Finite Element Method, 5th ed., chapter 8 (triangles).
    Exact for quadratic fields.
    """
    area = location.area
    corner = values[face_node[location.face]] * area * (2 * area - 1)
    middle = 4 * values[face_midnode[location.face]] * area * np.roll(area, -1, axis=1)
    return (corner + middle).sum(axis=1)
