"""Directions in which a surface looks into the gas, and what each is worth in the mean over them."""

import numpy as np

from plasmapyro.checks import within

FEWEST_DIRECTIONS = 4
CORE_RANGE = (0.01, 60.0)  # [deg]


def directions(count, core_angle):
    r"""Polar angles [rad], rising, and weights, sum 1, of the view-factor weighted mean over a hemisphere.

    .. math:: \bar L = \frac{1}{\pi}\int L \cos\theta\, d\Omega
              = \int_0^{\pi/2} L(\theta)\, \sin 2\theta\, d\theta \approx \sum_i w_i L(\theta_i)

    by Gauss-Legendre quadrature in :math:`\theta` up to the core angle and in :math:`\ln\theta` beyond,
    `count` >= 4 each. About the normal of an axisymmetric field at its stagnation point the radiance does not
    depend on the azimuth. `core_angle` [rad]: half angle under which the stagnation point sees the bright
    core of the torch. Its edge is sharp: the quadrature converges fast when the angle is right to a tenth.

    Source: Modest, Radiative Heat Transfer, 3rd ed., chapter 1 (irradiation of a surface). ValueError: too
    few directions or core angle out of range.
    """
    if int(count) != count or count < FEWEST_DIRECTIONS:
        raise ValueError(f"directions must be a whole number >= {FEWEST_DIRECTIONS}; got {count}")
    core_angle = np.radians(within("core_angle", np.degrees(core_angle), *CORE_RANGE, "deg"))
    node, weight = np.polynomial.legendre.leggauss(int(count))
    share = (node + 1) / 2
    inner = core_angle * share
    stretch = np.log(np.pi / 2 / core_angle)
    outer = core_angle * np.exp(stretch * share)
    angle = np.concatenate([inner, outer])
    measure = np.concatenate([np.broadcast_to(core_angle, inner.shape), stretch * outer])
    weight = np.tile(weight / 2, 2) * measure * np.sin(2 * angle)
    # The sum is 1 to 5e-3 with four directions, 3e-6 with eight; made exact, an isotropic field
    # returns itself.
    return angle, weight / weight.sum()
