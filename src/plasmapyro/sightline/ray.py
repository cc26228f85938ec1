"""A straight path from the stagnation point through the axisymmetric field."""

import numpy as np

from plasmapyro.checks import positive, within

TOUCH = 1e-9  # [m]: a boundary met nearer than this is the one the path starts on


def position(path_distance, nose, angle):
    r"""Cylindrical coordinates along the path, upstream and outward from the stagnation point.

    .. math:: z = z_0 - \zeta\cos\theta, \qquad r = \zeta\sin\theta

    Parameters
    ----------
    path_distance : array_like [m]
        zeta >= 0.
    nose : float [m]
        Axial position of the stagnation point, on the axis.
    angle : float [rad]
        Between the path and the axis (the surface normal), 0 to pi/2.

    Returns
    -------
    tuple of ndarray [m]
        Axial position and distance from the axis, shape of `path_distance`.

    Raises
    ------
    ValueError
        Angle outside [0, pi/2].

    Notes
    -----
    Source: Fagnani et al., fig. 5 and sec. 4.1. The path lies in a meridian plane, so it never
    crosses the axis again.
    """
    angle = within("angle", angle, 0, np.pi / 2, "rad")
    path_distance = np.asarray(path_distance, dtype=float)
    return nose - path_distance * np.cos(angle), path_distance * np.sin(angle)


def boundary_edges(face_node):
    """Edges of the mesh that belong to one triangle only.

    Parameters
    ----------
    face_node : ndarray of int
        Vertices of the triangles, shape (face, 3).

    Returns
    -------
    (edge, 2) ndarray of int
    """
    edges = np.concatenate([face_node[:, [k, (k + 1) % 3]] for k in range(3)])
    low, high = np.sort(edges, axis=1).astype(np.int64).T
    _, first, count = np.unique(low * (high.max() + 1) + high, return_index=True, return_counts=True)
    return edges[np.sort(first[count == 1])]


def exit_distance(node_z, node_r, face_node, nose, angle):
    """Distance at which the path first meets the boundary of the mesh.

    Parameters
    ----------
    node_z, node_r : (node,) ndarray [m]
    face_node : (face, 3) ndarray of int
    nose, angle : float [m], [rad]
        As in `position`.

    Returns
    -------
    float [m]

    Raises
    ------
    ValueError
        If the angle lies outside [0, pi/2] or the path meets no boundary.
    """
    angle = float(within("angle", angle, 0, np.pi / 2, "rad"))
    edges = boundary_edges(face_node)
    step_z, step_r = -np.cos(angle), np.sin(angle)
    start_z, start_r = node_z[edges[:, 0]] - nose, node_r[edges[:, 0]]
    along_z, along_r = np.diff(node_z[edges], axis=1)[:, 0], np.diff(node_r[edges], axis=1)[:, 0]
    determinant = along_z * step_r - along_r * step_z
    crossing = np.abs(determinant) > TOUCH * np.hypot(along_z, along_r)
    start_z, start_r, along_z, along_r, determinant = (
        array[crossing] for array in (start_z, start_r, along_z, along_r, determinant)
    )
    # start + share * along = distance * step
    share = (start_r * step_z - start_z * step_r) / determinant
    distance = (along_z * start_r - along_r * start_z) / determinant
    met = (share >= -TOUCH) & (share <= 1 + TOUCH) & (distance > TOUCH)
    if not met.any():
        raise ValueError(
            f"the path at {np.degrees(angle):g} deg from z = {nose:g} m meets no boundary of the mesh"
        )
    return float(distance[met].min())


def spread(path_distance, temperature, *, points, surface_length):
    r"""Nodes along the path, dense near the surface and where the temperature changes.

    The number of nodes per length is the mean of three densities, each of unit integral: uniform,
    :math:`1/(\zeta + \zeta_s)` and :math:`|d\ln T/d\zeta|`.

    Parameters
    ----------
    path_distance : ndarray [m]
        Fine samples, increasing, from 0 to the end of the path.
    temperature : ndarray [K]
        At the samples.
    points : int
        Number of nodes, >= 2.
    surface_length : float [m]
        zeta_s: within it the nodes are nearly equidistant.

    Returns
    -------
    (points,) ndarray [m]
        Increasing strictly, both ends included.

    Raises
    ------
    ValueError
        Fewer than two points, or surface_length not > 0.
    """
    if points < 2:
        raise ValueError(f"points must be >= 2; got {points}")
    surface_length = float(positive("surface_length", surface_length, "m"))
    logarithmic = np.log1p(path_distance / surface_length)
    change = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(np.log(temperature))))])
    parts = [path_distance, logarithmic, change]
    parts = [part / part[-1] for part in parts if part[-1] > 0]
    cumulative = sum(parts) / len(parts)
    nodes = np.interp(np.linspace(0, 1, points), cumulative, path_distance)
    nodes[0], nodes[-1] = path_distance[0], path_distance[-1]
    return nodes
