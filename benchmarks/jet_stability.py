r"""Linear stability of a parallel round jet of hot gas: growth in time and in space, absolute instability.

Disturbances :math:`\hat q(r)\,e^{i(\alpha z + m\theta - \omega t)}` of velocity, temperature and pressure
on a parallel flow U(r), T(r) at low Mach number, with the properties of an equilibrium gas; ' = d/dT:

.. math::
    \rho\,(D\hat u + \hat u_r U_r\,e_z) = -\nabla\hat p + \nabla\cdot\hat\tau, \qquad
    \hat\tau = \mu\,(\nabla\hat u + \nabla\hat u^T - \tfrac23 I\,\nabla\cdot\hat u)
    + \mu'\hat T\,(\nabla U + \nabla U^T)

    \rho c_p\,(D\hat T + \hat u_r T_r) = \nabla^2(\kappa\hat T), \qquad
    \nabla\cdot\hat u + \frac{\rho'}{\rho}\,(D\hat T + \hat u_r T_r) = 0, \qquad D = -i\omega + i\alpha U

These are the equations of `physics` without what sets the steady flow (heating, force, spreading) and without
radiation. Chebyshev collocation in r, folded at the axis by parity (Trefethen, Spectral Methods in
MATLAB, ch. 11); at the outer boundary a cold wall at rest.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgWarning, eig, lu_factor, lu_solve

POINTS = 120
UNKNOWNS = 5  # velocities u_z, u_r, u_theta, temperature, pressure
TOLERANCE, LARGEST_COUNT = 1e-9, 40
ASIDE = 1e-12  # relative: at an eigenvalue itself the matrix has no inverse
RISE_STEPS = 12
STEP_LIMIT = 0.2  # of the wave number, per step of Newton's method, in wave numbers of one over the radius


class NotFound(ValueError):
    """No mode near the guess."""


@dataclass(frozen=True)
class Grid:
    """Points `r` (n,), the first at the outer boundary, and d/dr (n, n) of even and odd fields."""

    r: np.ndarray
    even: np.ndarray
    odd: np.ndarray

    def slope(self, field, parity):
        """d/dr of rows (..., n, k) that are even (1) or odd (-1) in r."""
        return (self.even if parity > 0 else self.odd) @ field


def grid(outer, scale, points=POINTS):
    r"""Grid on 0 < r <= outer, half of it within some 0.7 of `scale`.

    .. math:: r = s\,\xi / (1 + s/r_{out} - \xi^2)
    """
    angle = np.pi * np.arange(2 * points) / (2 * points - 1)
    xi = np.cos(angle)
    weight = (-1.0) ** np.arange(2 * points)
    weight[[0, -1]] *= 2
    apart = xi[:, None] - xi + np.eye(2 * points)
    whole = np.outer(weight, 1 / weight) / apart
    whole -= np.diag(whole.sum(axis=1))
    rest = 1 + scale / outer - xi[:points] ** 2
    stretch = scale * (1 + scale / outer + xi[:points] ** 2) / rest**2  # dr / dxi
    near, far = whole[:points, :points], whole[:points, ::-1][:, :points]
    return Grid(scale * xi[:points] / rest, (near + far) / stretch[:, None], (near - far) / stretch[:, None])


@dataclass(frozen=True)
class BaseFlow:
    """Parallel flow on a Grid; arrays (n,) in any consistent units.

    `speed`, `shear` = dU/dr, `temperature_slope` = dT/dr, `density`, `expansion` = (d rho/dT)/rho,
    `capacity` = rho c_p, `viscosity`, `viscosity_slope` = d mu/dT, `conductivity`.
    """

    grid: Grid
    speed: np.ndarray
    shear: np.ndarray
    temperature_slope: np.ndarray
    density: np.ndarray
    expansion: np.ndarray
    capacity: np.ndarray
    viscosity: np.ndarray
    viscosity_slope: np.ndarray
    conductivity: np.ndarray


@dataclass(frozen=True)
class Mode:
    """Eigenvalue: `omega` at `alpha`, group velocity d omega / d alpha, and the disturbance (5 n,)."""

    alpha: complex
    omega: complex
    group_velocity: complex
    disturbance: np.ndarray


class Waves:
    """Modes of azimuthal number `m` on a BaseFlow."""

    def __init__(self, flow, m):
        self.flow, self.m = flow, int(m)
        self._a, self._b = _operators(flow, self.m)

    def _matrices(self, alpha):
        a0, a1, a2 = self._a
        return a0 + alpha * (a1 + alpha * a2), a1 + 2 * alpha * a2

    def unstable(self, alpha, near, count=2):
        """Modes that grow fastest in time at a wave number, at most `count`, the fastest first.

        `near` is a frequency within ten times of whose size they lie: collocation also leaves waves of the
        grid at very large frequencies.
        """
        a, _ = self._matrices(alpha)
        values, vectors = eig(np.linalg.solve(a - near * self._b, self._b))
        kept = np.flatnonzero(np.abs(values) > 0.1 / max(abs(near), 1e-30))
        omega = near + 1 / values[kept]
        order = np.argsort(-omega.imag)[:count]
        fastest = [(omega[k], vectors[:, kept[k]]) for k in order if omega[k].imag > 0]
        return [self.mode(alpha, one, start) for one, start in fastest]

    def mode(self, alpha, omega, start=None):
        """Mode near a guess, by two-sided Rayleigh quotients; NotFound where they lead nowhere."""
        a, slope = self._matrices(alpha)
        right = np.ones(len(a), complex) if start is None else start
        left = self._b @ right
        for _ in range(LARGEST_COUNT):
            with warnings.catch_warnings():
                warnings.simplefilter("error", LinAlgWarning)
                try:
                    factors = lu_factor(a - omega * (1 + ASIDE) * self._b)
                except LinAlgWarning:  # a pivot of nought: a little further aside
                    factors = lu_factor(a - omega * (1 + 3 * ASIDE) * self._b)
            right = lu_solve(factors, self._b @ right)
            left = lu_solve(factors, self._b.conj().T @ left, trans=2)
            right, left = right / np.abs(right).max(), left / np.abs(left).max()
            weight = left.conj() @ self._b @ right
            found = left.conj() @ a @ right / weight
            change, omega = abs(found - omega), found
            if change < TOLERANCE * max(abs(omega), 1e-3 * np.abs(self.flow.speed).max()):
                return Mode(alpha, omega, left.conj() @ slope @ right / weight, right)
        raise NotFound(f"no mode near omega = {omega:.4g} at alpha = {alpha:.4g}")

    def at_frequency(self, frequency, start):
        """Spatial mode: the complex alpha at which omega is `frequency`, from a Mode nearby."""
        return self._newton(start, lambda mode: (frequency - mode.omega) / mode.group_velocity)

    def saddle(self, start):
        """Mode of zero group velocity near a Mode; see `pinches` for what it means."""
        before = self.mode(start.alpha + 1e-3 / self._radius, start.omega, start.disturbance)

        def step(mode):
            nonlocal before
            change = (mode.alpha - before.alpha) / (mode.group_velocity - before.group_velocity)
            before = mode
            return -mode.group_velocity * change

        return self._newton(start, step)

    def pinches(self, saddle, fastest):
        """Whether the two waves that meet in a saddle come from both sides: the flow is absolutely unstable
        where Im omega of such a saddle is positive.

        omega is raised along the imaginary axis above `fastest`, the largest growth in time of any real wave
        number; the two wave numbers must end in different halves of the plane (Briggs' criterion).
        """
        apart = 1e-2 / self._radius
        beside = self.mode(saddle.alpha + apart, saddle.omega, saddle.disturbance)
        curvature = (beside.group_velocity - saddle.group_velocity) / apart
        rise = np.linspace(0.02, 1.0, RISE_STEPS) * (1.1 * fastest - saddle.omega.imag)
        ends = []
        for sign in (1, -1):
            step = sign * np.sqrt(2j * rise[0] / curvature)
            omega = saddle.omega + 1j * rise[0]
            mode = self.mode(saddle.alpha + step, omega, saddle.disturbance)
            for one in rise:
                mode = self.at_frequency(saddle.omega + 1j * one, mode)
            ends.append(mode.alpha.imag)
        return min(ends) < 0 < max(ends)

    @property
    def _radius(self):
        return self.flow.grid.r[np.argmax(np.abs(self.flow.shear))]

    def _newton(self, mode, step):
        for _ in range(LARGEST_COUNT):
            change = step(mode)
            size = abs(change) * self._radius
            if not np.isfinite(size):
                break
            change *= min(1.0, STEP_LIMIT / max(size, 1e-30))
            mode = self.mode(mode.alpha + change, mode.omega + change * mode.group_velocity, mode.disturbance)
            if size < 1e-7:
                return mode
        raise NotFound(f"no mode reached from alpha = {mode.alpha:.4g}")


def _operators(flow, m):
    """A (3, 5n, 5n), coefficients of alpha^0, 1, 2, and B with A q = omega B q."""
    r, n = flow.grid.r[:, None], len(flow.grid.r)
    scalar = 1 if m % 2 == 0 else -1  # parity of u_z, T, p; that of u_r, u_theta is the opposite
    eye = np.zeros((UNKNOWNS, 3, n, UNKNOWNS * n), complex)
    for k in range(UNKNOWNS):
        eye[k, 0, :, k * n : (k + 1) * n] = np.eye(n)
    uz, ur, ut, t, p = eye
    names = ("speed", "shear", "temperature_slope", "density", "expansion", "capacity")
    speed, shear, t_r, rho, expansion, capacity = (getattr(flow, name)[:, None] for name in names)
    mu, mu_slope, kappa = (
        getattr(flow, name)[:, None] for name in ("viscosity", "viscosity_slope", "conductivity")
    )

    def d(field, parity):
        return flow.grid.slope(field, parity)

    def along(field):
        shifted = np.zeros_like(field)
        shifted[1:] = 1j * field[:-1]
        return shifted

    def around(field):
        return 1j * m * field / r

    divergence = d(ur, -scalar) + ur / r + around(ut) + along(uz)
    bulk = 2 / 3 * mu * divergence
    rz = mu * (d(uz, scalar) + along(ur)) + mu_slope * shear * t
    tz = mu * (along(ut) + around(uz))
    rt = mu * (around(ur) + d(ut, -scalar) - ut / r)
    zz, rr = 2 * mu * along(uz) - bulk, 2 * mu * d(ur, -scalar) - bulk
    tt = 2 * mu * (around(ut) + ur / r) - bulk
    heat = kappa * t
    conduction = d(d(heat, scalar), -scalar) + d(heat, scalar) / r + around(around(heat)) + along(along(heat))
    carried = speed * along(t) + t_r * ur
    rows = [
        rho * (speed * along(uz) + shear * ur)
        + along(p)
        - (d(rz, -scalar) + rz / r + around(tz) + along(zz)),
        rho * speed * along(ur) + d(p, scalar) - (d(rr, scalar) + (rr - tt) / r + around(rt) + along(rz)),
        rho * speed * along(ut) + around(p) - (d(rt, scalar) + 2 * rt / r + around(tt) + along(tz)),
        capacity * carried - conduction,
        divergence + expansion * carried,
    ]
    inertia = [rho * uz, rho * ur, rho * ut, capacity * t, expansion * t]
    a, b = np.concatenate(rows, axis=1), 1j * np.concatenate(inertia, axis=1)[0]
    for k in range(UNKNOWNS - 1):  # the wall: the first point
        a[:, k * n], b[k * n] = eye[k][:, 0], 0.0
    return a, b
