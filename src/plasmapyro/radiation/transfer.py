"""Radiative transfer along one path: layers of uniform gas, each solved exactly."""

import numpy as np

from plasmapyro.checks import increasing


def layer_thickness(path_distance):
    """Thickness (S,) [m] of the layer each path point stands for: half the way to either neighbour.

    They sum to the length of the path; the trapezoidal rule of the emission of thin gas. ASSUME: the gas is
    uniform within a layer; second order in the spacing of the path points. ValueError if the path does not
    increase strictly.
    """
    path_distance = increasing("path_distance", path_distance, "m")
    if path_distance.size < 2:
        raise ValueError(f"path_distance must hold at least 2 points; got {path_distance.size}")
    middle = (path_distance[1:] + path_distance[:-1]) / 2
    return np.diff(np.concatenate([path_distance[:1], middle, path_distance[-1:]]))


def escape_fraction(optical_depth):
    r"""Part [1] of a uniform layer's emission that leaves the layer, by its optical depth [1].

    .. math:: \eta(\tau) = \frac{1 - e^{-\tau}}{\tau}, \qquad \eta(0) = 1

    Less than 0 where stimulated emission outweighs absorption. Source: formal solution of the transfer
    equation in a uniform layer.
    """
    depth = np.asarray(optical_depth, dtype=float)
    absorbed = np.asarray(-depth)
    np.negative(np.expm1(absorbed, out=absorbed), out=absorbed)
    return np.divide(absorbed, depth, out=np.ones_like(depth), where=depth != 0)


def cross_layer(radiance, emission_coefficient, absorption_coefficient, thickness):
    r"""Radiance behind a uniform layer, given the radiance before it.

    .. math:: L_c \leftarrow L_c e^{-\tau} + j_c\, \Delta s\, \eta(\tau), \qquad
              \tau = \kappa\, \Delta s

    The emission of each component is attenuated by the absorption of all, so components add up to
    the total; a thick layer at one temperature emits :math:`j/\kappa`, its source function.

    Source: formal solution of the transfer equation in a uniform layer.

    Parameters
    ----------
    radiance : (C, G) [any spectral radiance]
        By component, before the layer.
    emission_coefficient : (C, G) [radiance m-1]
    absorption_coefficient : (G,) [m-1]
        Of all components together, stimulated emission counted as negative absorption.
    thickness : float [m]

    Returns
    -------
    tuple of ndarray : radiance behind the layer (C, G) and optical depth of the layer (G,)
    """
    depth = absorption_coefficient * thickness
    escape = escape_fraction(depth)
    # 1 - tau eta is exp(-tau) to the rounding of 1, without another exponential.
    transmitted = depth * escape
    behind = radiance * np.subtract(1, transmitted, out=transmitted)
    escape *= thickness
    added = np.empty_like(escape)
    for row, emission in zip(behind, emission_coefficient, strict=True):  # row by row: within the cache
        row += np.multiply(emission, escape, out=added)
    return behind, depth
