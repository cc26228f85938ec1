"""A straight path from the stagnation point through the axisymmetric field."""

import numpy as np

from plasmapyro.checks import positive, within
from plasmapyro.sightline.trace import Ray


def towards(nose, angle):
    r"""Path upstream and outward from the stagnation point.

    .. math:: z = z_0 - \zeta\cos\theta, \qquad r = \zeta\sin\theta

    Source: Fagnani et al., fig. 5 and sec. 4.1. The path lies in a meridian plane, so it never
    crosses the axis again.

    ValueError: angle outside [0, pi/2].

    Parameters
    ----------
    nose : float [m]
        Axial position of the stagnation point, on the axis.
    angle : float [rad]
        Between the path and the axis (the surface normal), 0 to pi/2.

    Returns
    -------
    trace.Ray
    """
    angle = float(within("angle", angle, 0, np.pi / 2, "rad"))
    return Ray(np.array([nose, 0.0, 0.0]), np.array([-np.cos(angle), np.sin(angle), 0.0]), True)


def spread(path_distance, temperature, *, points, surface_length):
    r"""Nodes along the path, dense near the surface and where the temperature changes.

    The number of nodes per length is the mean of three densities, each of unit integral: uniform,
    :math:`1/(\zeta + \zeta_s)` and :math:`|d\ln T/d\zeta|`.

    ValueError: fewer than two points, or surface_length not > 0.

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
