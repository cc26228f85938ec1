"""Potential curves of diatomic molecules from their spectroscopic constants, and the vibration in them."""

import numpy as np

from plasmapyro.checks import increasing, positive
from plasmapyro.constants import LIGHT_SPEED, PLANCK

WALL_EXPONENT = 12  # [1], of the repulsive wall inside the innermost turning point
# the Klein integrands are smooth after the substitution; 40 nodes already agree to 1e-12
QUADRATURE_NODES = 80
BASIS, NEIGHBOURS = 80, 20  # states of one N that make those of the N around it, and how many N share them
TURNING_POINTS = 160  # per limb; halving them moves no level by more than 1e-3 cm-1


def kinetic_factor(reduced_mass):
    r"""Factor [m-1 m2] of -d2/dr2 in the Schroedinger equation, :math:`\hbar^2 / (2\mu h c)`; mass [kg].

    The rotational constant at separation r is this over r squared.
    """
    return PLANCK / (8 * np.pi**2 * LIGHT_SPEED * positive("reduced_mass", reduced_mass, "kg"))


def turning_points(vibration, rotation, reduced_mass, action):
    r"""Classical turning points by the Rydberg-Klein-Rees (RKR) inversion.

    .. math::

        f(x) &= \sqrt{k} \int_0^x \frac{dy}{\sqrt{G(x) - G(y)}}, \qquad
        g(x) = \frac{1}{\sqrt{k}} \int_0^x \frac{B(y)\,dy}{\sqrt{G(x) - G(y)}}, \\
        r_\pm &= \sqrt{f^2 + f/g} \pm f, \qquad k = \hbar^2 / (2 \mu h c)

    Source: R. Rydberg, Z. Phys. 73 (1931) 376; O. Klein, Z. Phys. 76 (1932) 226; A. L. G. Rees,
    Proc. Phys. Soc. 59 (1947) 998, with :math:`y = x(1 - t^2)`, which removes the endpoint singularity.

    Parameters
    ----------
    vibration : (n,) [m-1]
        Ascending coefficients of G(x), x = v + 1/2, without constant term: (we, -wexe, weye, ...).
    rotation : (m,) [m-1]
        Ascending coefficients of B(x): (Be, -alphae, gammae, ...).
    reduced_mass : float [kg]
    action : (K,) [1]
        Values of x = v + 1/2, > 0.

    Returns
    -------
    inner, outer : (K,) [m]
    """
    action = positive("action", action, "1")[:, None]
    nodes, weights = np.polynomial.legendre.leggauss(QUADRATURE_NODES)
    nodes, weights = (nodes + 1) / 2, weights / 2
    inner_action = action * (1 - nodes**2)
    energy = np.polynomial.Polynomial(np.concatenate(([0.0], vibration)))
    gap = energy(action) - energy(inner_action)
    measure = weights * 2 * action * nodes / np.sqrt(gap)
    root = np.sqrt(kinetic_factor(reduced_mass))
    f = root * measure.sum(axis=1)
    g = (measure * np.polynomial.Polynomial(rotation)(inner_action)).sum(axis=1) / root
    mean = np.sqrt(f**2 + f / g)
    return mean - f, mean + f


def potential_curve(radius, vibration, rotation, reduced_mass, highest_level, well_depth):
    r"""Potential energy above the minimum: RKR curve, repulsive wall, attractive tail.

    Inside the innermost turning point :math:`U = a + b\,r^{-12}`, outside the outermost
    :math:`U = D_e - C\,r^{-n}`; value and slope are continuous.

    ASSUME: the wall exponent 12 and the power-law tail; they matter only for levels above `highest_level`
    and for rotation beyond the spectroscopic range.

    ValueError: turning points that fold back (constants used beyond their range) or a well depth below the
    curve.

    Parameters
    ----------
    radius : (R,) [m]
    vibration, rotation, reduced_mass
        As in `turning_points`.
    highest_level : float [1]
        Vibrational quantum number up to which the constants hold.
    well_depth : float [m-1]
        Dissociation limit above the minimum.

    Returns
    -------
    (R,) [m-1]
    """
    radius = positive("radius", radius, "m")
    # Steps even in sqrt(x) are nearly even in r around the minimum, where the spline needs them.
    action = (highest_level + 0.5) * (np.arange(1, TURNING_POINTS + 1) / TURNING_POINTS) ** 2
    inner, outer = turning_points(vibration, rotation, reduced_mass, action)
    energy = np.polynomial.Polynomial(np.concatenate(([0.0], vibration)))(action)
    bottom = np.sqrt(kinetic_factor(reduced_mass) / rotation[0])
    points = increasing("turning points", np.concatenate((inner[::-1], [bottom], outer)), "m")
    from scipy.interpolate import CubicSpline  # 0.4 s, which light from a table does not cost

    spline = CubicSpline(points, np.concatenate((energy[::-1], [0.0], energy)))
    top = energy[-1]
    if well_depth <= top:
        raise ValueError(
            f"well_depth must exceed the highest turning point, {top:g} m-1; got {well_depth:g} m-1"
        )

    first, last = points[0], points[-1]
    wall = -spline(first, 1) * first / WALL_EXPONENT
    exponent = last * spline(last, 1) / (well_depth - top)
    core = spline(np.clip(radius, first, last))
    inside = top + wall * ((first / np.minimum(radius, first)) ** WALL_EXPONENT - 1)
    outside = well_depth - (well_depth - top) * (last / np.maximum(radius, last)) ** exponent
    return np.where(radius < first, inside, np.where(radius > last, outside, core))


def vibrational_states(radius, potential, reduced_mass, rotation_number, count, *, waves=True):
    r"""Levels and wave functions of the radial equation, rotation included, by sinc-DVR.

    .. math::

        \left[-k \frac{d^2}{dr^2} + U(r) + \frac{k}{r^2} N(N+1)\right] \psi_{vN} = E_{vN} \psi_{vN}

    on an even grid, with the kinetic matrix
    :math:`T_{ij} = k (-1)^{i-j} / \Delta^2 \times \{\pi^2/3,\ 2/(i-j)^2\}`.

    Source: D. T. Colbert, W. H. Miller, J. Chem. Phys. 96 (1992) 1982, eq. 2.1; contraction to the lowest
    states of one N in `NEIGHBOURS` (Z. Bacic, J. C. Light, Annu. Rev. Phys. Chem. 40 (1989) 469), which moves
    levels by less than 1e-3 m-1. Beyond the barrier the potential is held at the barrier's height, so that a
    level behind it appears once, as a bound level.

    Parameters
    ----------
    radius : (R,) [m]
        Even grid; its step must resolve the shortest half wave, its ends must lie well inside the walls.
    potential : (R,) [m-1]
    reduced_mass : float [kg]
    rotation_number : (N,) [1]
        Rotational quantum numbers N >= 0.
    count : int
        Number of levels wanted per N, the lowest first.
    waves : bool
        Whether wave functions are wanted: they take half of the time.

    Returns
    -------
    energy : (N, count) [m-1]
        Above the minimum of `potential`.
    wave : (N, R, count) [1] or None
        Amplitudes with unit sum of squares: matrix elements are sums over the grid.
    bound : (N, count) bool
        Below the top of the centrifugal barrier (or the dissociation limit when there is none).
    """
    radius = increasing("radius", radius, "m")
    rotation_number = np.asarray(rotation_number)
    factor = kinetic_factor(reduced_mass)
    step = (radius[-1] - radius[0]) / (len(radius) - 1)
    offset = np.subtract.outer(np.arange(len(radius)), np.arange(len(radius)))
    with np.errstate(divide="ignore"):
        kinetic = np.where(offset == 0, np.pi**2 / 3, 2.0 / offset**2) * (-1.0) ** offset * factor / step**2

    barriers = factor / radius**2 * (rotation_number * (rotation_number + 1))[:, None]
    effective = np.array([_closed_at_barrier(potential + one) for one in barriers])
    size = min(len(radius), max(BASIS, 2 * count))
    energy = np.empty((len(rotation_number), min(count, len(radius))))
    wave = np.empty((len(rotation_number), len(radius), energy.shape[1])) if waves else None
    ends = np.flatnonzero(np.diff(rotation_number // NEIGHBOURS)) + 1
    for part in np.split(np.arange(len(rotation_number)), ends):
        middle = effective[part[len(part) // 2]]
        level, basis = (found[..., :size] for found in np.linalg.eigh(kinetic + np.diag(middle)))
        matrix = basis.T @ ((effective[part] - middle)[:, :, None] * basis) + np.diag(level)
        if waves:
            energies, share = np.linalg.eigh(matrix)
            wave[part] = basis @ share[:, :, : energy.shape[1]]
        else:
            energies = np.linalg.eigvalsh(matrix)
        energy[part] = energies[:, : energy.shape[1]]
    return energy, wave, energy < effective[:, -1:]


def _closed_at_barrier(effective):
    """Effective potential with everything beyond the first barrier raised to the barrier's top."""
    rising = np.diff(effective) > 0
    if not rising.any():
        return effective
    well = int(np.argmax(rising))
    falling = ~rising[well:]
    barrier = well + int(np.argmax(falling)) if falling.any() else len(effective) - 1
    return np.where(np.arange(len(effective)) < barrier, effective, effective[barrier])
