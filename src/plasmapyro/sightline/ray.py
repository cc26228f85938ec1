"""A straight path from the stagnation point through the axisymmetric field."""

import numpy as np

from plasmapyro.checks import positive, within
from plasmapyro.sightline.trace import Ray

FINE_SAMPLES = 4000  # where the nodes are chosen from; not a resolution of the result


def towards(nose, angle):
    r"""Path upstream and outward from the stagnation point at `nose` [m], at an angle [rad] to the axis.

    .. math:: z = z_0 - \zeta\cos\theta, \qquad r = \zeta\sin\theta

    Source: Fagnani et al., fig. 5 and sec. 4.1. The path lies in a meridian plane, so it never crosses the
    axis again. ValueError: angle outside [0, pi/2].
    """
    angle = float(within("angle", angle, 0, np.pi / 2, "rad"))
    return Ray(np.array([nose, 0.0, 0.0]), np.array([-np.cos(angle), np.sin(angle), 0.0]), True)


def fine_samples(start, end, surface_length):
    r"""Distances (n,) [m] from `start` to `end` that resolve the layer on the probe as well as the jet.

    .. math:: \zeta_i = \zeta_0 + \zeta_s\,[(1 + (\zeta_{n-1} - \zeta_0)/\zeta_s)^{i/(n-1)} - 1]

    with `surface_length` :math:`\zeta_s` [m].
    """
    logarithm = np.linspace(0, np.log1p((end - start) / surface_length), FINE_SAMPLES)
    distance = start + surface_length * np.expm1(logarithm)
    distance[-1] = end
    return distance


def spread(path_distance, temperature, *, points, surface_length):
    r"""Nodes (points,) [m] along the path, dense near the surface and where the temperature changes.

    The number of nodes per length is the mean of three densities, each of unit integral: uniform,
    :math:`1/(\zeta + \zeta_s)` and :math:`|d\ln T/d\zeta|`, of fine samples from 0 to the end of the path;
    both ends are nodes. Within `surface_length` :math:`\zeta_s` [m] they are nearly equidistant. ValueError:
    fewer than two points, or surface_length not > 0.
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
