r"""The stagnation line of a sphere in a hot, slow stream: flow, heat and eleven reacting species.

On the axis the flow past a sphere depends on the distance :math:`\xi` from its centre alone:
:math:`u_\xi = u\cos\vartheta`, :math:`u_\vartheta = v\sin\vartheta`,
:math:`p = p_0 + P\cos^2\vartheta` (Kao, AIAA J. 2 (1964) 1892), at small Mach number:

.. math:: (\xi^2 \rho u)' + 2\xi\rho v = 0, \qquad P' = -\rho\big(u u' + v(u+v)/\xi\big)

.. math:: \rho\big(u v' + v(u+v)/\xi\big) = 2P/\xi + \tau' + 3\tau/\xi - 2\mu(u+v)/\xi^2
          + \tfrac{2}{3}\mu D/\xi, \quad \tau = \mu\big(v' - (u+v)/\xi\big), \quad D = \nabla\cdot u

.. math:: \rho u Y_i' + \xi^{-2}(\xi^2 J_i)' = \dot\omega_i, \qquad
          \rho u h' + \xi^{-2}(\xi^2 q)' = 0

.. math:: J_i = m_i\sum_j M_{ij}\Big(x_j' + \frac{\chi_j}{T}T'\Big), \qquad
          q = -\lambda T' + \sum_i \frac{J_i}{m_i}\Big(h_i + kT\frac{\chi_i}{x_i}\Big)

Transport coefficients are those of the flow solver (`gas.transport`), so that with the composition held in
equilibrium the wall takes what that solver's energy equation gives it.
"""

import logging
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import solve_banded

from plasmapyro.checks import positive, within
from plasmapyro.constants import BOLTZMANN, MOLAR_GAS
from plasmapyro.facility.catalysis import wall_flux
from plasmapyro.facility.kinetics import (
    MOLAR_MASS,
    RATES,
    TEMPERATURE_RANGE,
    production,
    species_enthalpy,
    species_heat_capacity,
)
from plasmapyro.gas import equilibrium, transport
from plasmapyro.gas.collisions import electron_integrals, heavy_integrals
from plasmapyro.gas.species import AIR, CHARGE, ELECTRON, MASS, SPECIES

log = logging.getLogger(__name__)

CHEMISTRIES = (*RATES, "frozen", "equilibrium")
COUNT = len(SPECIES)
TEMPERATURE, TANGENTIAL, FLUX, PRESSURE = range(COUNT, COUNT + 4)
UNKNOWNS = COUNT + 4
POINTS, STRETCHING = 90, 4.0
FIRST_STEP, LEAST_STEP, LARGEST_STEP, GROWTH = 3e-5, 1e-9, 1.0, 10.0  # [s]: pseudo-time
NEAR = 300  # times the first step, from a solution nearby
LEAST = 1e-9  # mole fraction below which transport does not follow a species
HEAT_CAPACITY = 2e3  # [J kg-1 K-1]: scale of the energy equation
PROBE = 3e-5  # relative change for slopes: 0.2 K, wider than the seams of the polynomials at 1000 and 6000 K
RENEWED, PATIENCE = 0.6, 50  # share of new transport coefficients per step, halved after so many steps
STEPS, CONVERGED = 200, 1e-5  # largest relative change of the last step
# relative change of a step, also over the one before, below which slopes are kept
SETTLED, SHRINKING = 3e-3, 0.9


class NotConverged(ArithmeticError):
    """No steady stagnation line was found."""


@dataclass(frozen=True)
class Edge:
    """State of the gas at the outer end of the line.

    `temperature` [K] in equilibrium at `pressure` [Pa]; `distance` [m] from the wall; `normal_speed` [m s-1]
    towards the wall and `gradient` [s-1] of the speed away from the axis, both there;
    `nitrogen` is the mole fraction of N2 in the cold gas.
    """

    temperature: float
    pressure: float
    distance: float
    normal_speed: float
    gradient: float
    nitrogen: float = AIR["N2"]

    def __post_init__(self):
        within("edge temperature", self.temperature, 400.0, TEMPERATURE_RANGE[1], "K")
        units = {"pressure": "Pa", "distance": "m", "normal_speed": "m s-1", "gradient": "s-1"}
        for name, unit in units.items():
            positive(name, getattr(self, name), unit)


@dataclass(frozen=True)
class StagnationLine:
    """Solution: `distance` [m] from the wall, (points,) temperature [K], speeds, (points, 11) mass fractions.

    `heat_flux` [W m-2] is what the wall takes, recombination on it included; `pressure_rise` [Pa] is the
    pressure at the wall above that at the edge.
    """

    distance: np.ndarray
    temperature: np.ndarray
    normal_speed: np.ndarray
    gradient: np.ndarray
    mass_fraction: np.ndarray
    heat_flux: float
    pressure_rise: float


@dataclass(frozen=True)
class _Coefficients:
    """Transport between the nodes (points - 1, ...), viscosity at the nodes (points,)."""

    diffusion: np.ndarray
    thermal_ratio: np.ndarray
    conductivity: np.ndarray
    face_viscosity: np.ndarray
    viscosity: np.ndarray

    def towards(self, other, share):
        """Means with a share of those of the next step: taken whole, they go round in a cycle."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return _Coefficients(*((1 - share) * one + share * two for one, two in pairs))


def solve(edge, radius, *, wall_temperature, recombination, chemistry="kossyi", start=None):
    """The `StagnationLine` of a sphere.

    Parameters
    ----------
    edge : Edge
    radius : float [m]
        Of the sphere.
    wall_temperature : float [K]
    recombination : float [1]
        Probability that an atom which meets the wall leaves it in a molecule, 0 to 1; see `catalysis`.
    chemistry : str
        One of `CHEMISTRIES`: a set of reaction rates (see `kinetics`), none, or infinitely fast ones; in
        'equilibrium' the composition follows the temperature up to the wall.
    start : StagnationLine, optional
        A solution nearby to begin with.

    Raises
    ------
    ValueError
        An argument out of range.
    NotConverged
    """
    problem = _Problem(edge, radius, wall_temperature, recombination, chemistry)
    state = problem.first_guess() if start is None else problem.state_of(start)
    step = FIRST_STEP if start is None else NEAR * FIRST_STEP
    coefficients, slopes, before = problem.coefficients(state), None, np.inf
    for number in range(STEPS):
        share = RENEWED * 0.5 ** (number // PATIENCE)
        coefficients = coefficients.towards(problem.coefficients(state), share)
        if slopes is None:
            slopes = problem.slopes(state, coefficients, step)
        change = problem.newton_change(state, coefficients, step, slopes)
        while not problem.possible(state, change) and step > LEAST_STEP:
            step /= 10
            slopes = problem.slopes(state, coefficients, step)
            change = problem.newton_change(state, coefficients, step, slopes)
        damping = problem.damping(state, change)
        state = state + damping * change
        relative = damping * problem.relative(state, change)
        log.debug("step %g s, change %g, damping %g", step, relative, damping)
        if relative < CONVERGED and step >= LARGEST_STEP:
            return problem.solution(state)
        if step < LARGEST_STEP or relative > min(SETTLED, SHRINKING * before):
            slopes = None
        before = relative
        step = min(step * GROWTH, LARGEST_STEP) if damping > 0.5 and relative < 0.5 else step / 3
    raise NotConverged(
        f"no steady stagnation line: T {edge.temperature:g} K, {edge.pressure:g} Pa, gradient "
        f"{edge.gradient:g} s-1, recombination {recombination:g}; last change {relative:.1e}"
    )


class _Problem:
    def __init__(self, edge, radius, wall_temperature, recombination, chemistry):
        if chemistry not in CHEMISTRIES:
            raise ValueError(f"chemistry must be one of {', '.join(CHEMISTRIES)}; got '{chemistry}'")
        self.edge, self.chemistry = edge, chemistry
        self.radius = float(positive("radius", radius, "m"))
        self.wall = float(within("wall_temperature", wall_temperature, *TEMPERATURE_RANGE, "K"))
        self.recombination = float(within("recombination", recombination, 0.0, 1.0, "1"))
        part = np.linspace(0, 1, POINTS)
        self.distance = edge.distance * np.expm1(STRETCHING * part) / np.expm1(STRETCHING)
        self.xi = self.radius + self.distance
        self.face = (self.xi[1:] + self.xi[:-1]) / 2
        self.size = np.diff(self.xi)
        ends = np.concatenate([[self.xi[0]], self.face, [self.xi[-1]]])
        self.volume = np.diff(ends**3) / 3
        grid = np.arange(TEMPERATURE_RANGE[0], 15000.1, 25.0)
        self.equilibrium = CubicSpline(
            grid, _mass_fraction(equilibrium.composition(grid, edge.pressure, edge.nitrogen))
        )
        self.outer = self.equilibrium(edge.temperature)

    def first_guess(self):
        part = np.tanh(3 * self.distance / min(self.edge.distance, 0.3 * self.radius))
        part /= part[-1]
        state = np.empty((POINTS, UNKNOWNS))
        state[:, TEMPERATURE] = self.wall + (self.edge.temperature - self.wall) * part
        state[:, :COUNT] = self.equilibrium(state[:, TEMPERATURE])
        if self.chemistry != "equilibrium":  # its neutrals stay, its ions do not reach a cold wall
            ions = part[:, None] * self.outer * (CHARGE != 0)
            neutral = self.outer * (CHARGE == 0)
            state[:, :COUNT] = ions + neutral / neutral.sum() * (1 - ions.sum(axis=1, keepdims=True))
        speed = self.edge.gradient * self.xi[-1] + self.edge.normal_speed
        state[:, TANGENTIAL] = speed * part
        density, _ = self._density(state)
        state[:, FLUX] = -density * self.edge.normal_speed * part**2
        state[:, PRESSURE] = 0.5 * density[-1] * (speed**2 - self.edge.normal_speed**2 * part**2)
        return state

    def state_of(self, line):
        state = np.empty((POINTS, UNKNOWNS))
        part, known = self.distance / self.distance[-1], line.distance / line.distance[-1]
        for i in range(COUNT):
            state[:, i] = np.interp(part, known, line.mass_fraction[:, i])
        state[:, TEMPERATURE] = np.interp(part, known, line.temperature)
        state[[0, -1], TEMPERATURE] = self.wall, self.edge.temperature
        state[-1, :COUNT] = self.outer
        normal = np.interp(part, known, line.normal_speed) * self.edge.normal_speed / line.normal_speed[-1]
        gradient = np.interp(part, known, line.gradient) * self.edge.gradient / line.gradient[-1]
        state[:, TANGENTIAL] = gradient * self.xi + normal
        density, _ = self._density(state)
        state[:, FLUX] = -density * normal
        state[:, PRESSURE] = 0.5 * density[-1] * (state[-1, TANGENTIAL] ** 2 - normal**2)
        return state

    def _density(self, state):
        """Density [kg m-3] and mole fractions."""
        moles = state[..., :COUNT] / MOLAR_MASS
        total = moles.sum(axis=-1)
        return self.edge.pressure / (total * MOLAR_GAS * state[..., TEMPERATURE]), moles / total[..., None]

    def _enthalpy(self, state):
        return np.sum(state[..., :COUNT] * species_enthalpy(state[..., TEMPERATURE]) / MASS, axis=-1)

    def coefficients(self, state):
        _, x = self._density(state)
        x = np.maximum(x, LEAST)
        x[:, ELECTRON] = x @ np.maximum(CHARGE, 0.0)
        temperature = state[:, TEMPERATURE]
        middle, xm = (temperature[1:] + temperature[:-1]) / 2, (x[1:] + x[:-1]) / 2
        both = np.concatenate([middle, temperature]), np.concatenate([xm, x])
        heavy, electron = self._integrals(*both)
        at_nodes = _rows(heavy, slice(len(middle), None))
        heavy, electron = (_rows(one, slice(len(middle))) for one in (heavy, electron))
        diffusion = transport.diffusion(middle, heavy, electron)
        polarisation = transport.energy_polarisation(middle, xm, heavy)
        capacity = species_heat_capacity(middle)
        conductivity = (
            transport.heavy_conductivity(xm, polarisation)
            + transport.electron_conductivity(middle, xm, _regular(electron))
            + transport.internal_conductivity(xm, capacity, diffusion)
        )
        return _Coefficients(
            transport.diffusion_matrix(xm, diffusion),
            transport.thermal_diffusion_ratio(xm, polarisation, diffusion, heavy),
            conductivity,
            transport.viscosity(middle, xm, heavy),
            transport.viscosity(temperature, x, at_nodes),
        )

    def _integrals(self, temperature, x):
        tiny = np.finfo(float).tiny
        electrons = np.maximum(x[:, ELECTRON], tiny) * self.edge.pressure / (BOLTZMANN * temperature)
        return heavy_integrals(temperature, electrons), electron_integrals(temperature, electrons)

    def fluxes(self, state, c):
        """Mass fluxes [kg m-2 s-1] and heat flux [W m-2] between the nodes, away from the wall."""
        _, x = self._density(state)
        temperature = state[..., TEMPERATURE]
        middle = _mid(temperature)
        slope = np.diff(temperature) / self.size
        force = np.diff(x, axis=-2) / self.size[:, None]
        force += _mid(x.mT).mT * c.thermal_ratio * (slope / middle)[..., None]
        flux = np.einsum("pij,...pj->...pi", c.diffusion, force)
        carried = species_enthalpy(middle) + BOLTZMANN * middle[..., None] * c.thermal_ratio
        return flux * MASS, -c.conductivity * slope + np.sum(flux * carried, axis=-1)

    def residual(self, state, c, old, step):
        """Residual (..., points, 15) of states, scaled to changes per second of order one."""
        y, temperature = state[..., :COUNT], state[..., TEMPERATURE]
        v, m, pressure = state[..., TANGENTIAL], state[..., FLUX], state[..., PRESSURE]
        density, _ = self._density(state)
        density_change = (density - self._density(old)[0]) / step
        u = m / density
        xi, face, inner = self.xi, self.face, slice(1, -1)
        flux, heat = self.fluxes(state, c)
        enthalpy = self._enthalpy(state)
        warming = density * (enthalpy - self._enthalpy(old)) / step
        made = 0 * y
        if self.chemistry in RATES:
            made = production(temperature.ravel(), self.edge.pressure, y.reshape(-1, COUNT), self.chemistry)
            made = made.reshape(y.shape)
        out = np.empty_like(state)

        def divergence(values, order=2):
            scale = self.volume[inner] * xi[inner] ** (order - 2)
            return np.diff(values * face**order) / scale

        gain = m[..., inner, None] * self._slope(y.mT).mT + divergence(flux.mT).mT - made[..., inner, :]
        change = (state - old) / step
        out[..., inner, :COUNT] = (density[..., None] * change[..., :COUNT])[..., inner, :] + gain
        wall = wall_flux(y[..., 0, :] * density[..., :1] / MASS, self.wall, self.recombination) * MASS
        stored = density[..., :1] * change[..., 0, :COUNT] - made[..., 0, :]
        out[..., 0, :COUNT] = stored + (flux[..., 0, :] * face[0] ** 2 - wall * xi[0] ** 2) / self.volume[0]
        out[..., -1, :COUNT] = y[..., -1, :] - self.outer
        # The fluxes carry neither mass nor charge: two of the balances would say 0 = 0.
        out[..., 0] = y.sum(axis=-1) - 1
        out[..., ELECTRON] = y @ (CHARGE / MASS) * MASS[ELECTRON]
        if self.chemistry == "equilibrium":
            out[..., :COUNT] = y - self.equilibrium(temperature)
        hot = m[..., inner] * self._slope(enthalpy) + divergence(heat)
        out[..., inner, TEMPERATURE] = (warming[..., inner] + hot) / HEAT_CAPACITY
        out[..., [0, -1], TEMPERATURE] = temperature[..., [0, -1]] - (self.wall, self.edge.temperature)
        shear = c.face_viscosity * (np.diff(v) / self.size - _mid(u + v) / face)
        expansion = self._slope(u) + 2 * ((u + v) / xi)[..., inner]
        forces = (
            2 * pressure[..., inner] / xi[inner]
            + divergence(shear, 3)
            + c.viscosity[inner] / xi[inner] * (2 / 3 * expansion - 2 * ((u + v) / xi)[..., inner])
        )
        inertia = m[..., inner] * self._slope(v) + (density * v * (u + v) / xi)[..., inner]
        out[..., inner, TANGENTIAL] = (density * change[..., TANGENTIAL])[..., inner] + inertia - forces
        outer_speed = self.edge.gradient * xi[-1] + self.edge.normal_speed
        out[..., [0, -1], TANGENTIAL] = v[..., [0, -1]] - (0.0, outer_speed)
        out[..., 0, FLUX] = m[..., 0]
        out[..., 1:, FLUX] = np.diff(m * xi**2) / (self.size * face**2) + 2 * _mid(density * v / xi)
        out[..., 1:, FLUX] += _mid(density_change)
        out[..., :-1, PRESSURE] = (np.diff(pressure) + _mid(m) * np.diff(u)) / self.size + _mid(
            density * v * (u + v) / xi
        )
        out[..., -1, PRESSURE] = u[..., -1] + self.edge.normal_speed
        return out

    def _slope(self, values):
        """Second-order derivative at the inner nodes, along the last axis."""
        left, right = self.size[:-1], self.size[1:]
        a, b = (-right / left, left / right) / (left + right)
        return a * values[..., :-2] - (a + b) * values[..., 1:-1] + b * values[..., 2:]

    def slopes(self, state, c, step):
        """Derivatives of the residual in banded form, from nodes that move three apart and all at once."""
        band = 2 * UNKNOWNS - 1
        matrix = np.zeros((2 * band + 1, POINTS * UNKNOWNS))
        scale = self.scales(state)
        rows = np.arange(POINTS * UNKNOWNS).reshape(POINTS, UNKNOWNS)
        moved = np.repeat(state[None], 3 * UNKNOWNS + 1, axis=0)
        for k in range(UNKNOWNS):
            for colour in range(3):
                moved[3 * k + colour, colour::3, k] += PROBE * scale[k]
        found = self.residual(moved, c, state, step)
        slope = (found[:-1] - found[-1]).reshape(UNKNOWNS, 3, POINTS, UNKNOWNS)
        slope /= (PROBE * scale)[:, None, None, None]
        for offset in (-1, 0, 1):
            nodes = np.arange(max(-offset, 0), POINTS - max(offset, 0))
            row, column = rows[nodes + offset], rows[nodes].T[..., None]
            matrix[band + row - column, column] = slope[:, nodes % 3, nodes + offset]
        return matrix

    def newton_change(self, state, c, step, slopes):
        """Newton's change with the `slopes` of this state or of one nearby."""
        band = 2 * UNKNOWNS - 1
        residual = self.residual(state, c, state, step)
        return solve_banded((band, band), slopes, -residual.ravel()).reshape(POINTS, UNKNOWNS)

    def scales(self, state):
        scale = np.ones(UNKNOWNS)
        scale[:COUNT] = np.maximum(np.abs(state[:, :COUNT]).max(axis=0), 1e-4)
        for k in (TEMPERATURE, TANGENTIAL, FLUX, PRESSURE):
            scale[k] = np.abs(state[:, k]).max()
        return scale

    def relative(self, state, change):
        scale = self.scales(state)
        scale[:COUNT] = np.maximum(scale[:COUNT], 1e-3)
        return float(np.max((np.abs(change) / scale)[:, : TANGENTIAL + 1]))

    def possible(self, state, change):
        """Whether a step keeps the sum of particles within a factor of what it was."""
        if not np.all(np.isfinite(change)):
            return False
        there = state + self.damping(state, change) * change
        ratio = (there[:, :COUNT] @ (1 / MOLAR_MASS)) / (state[:, :COUNT] @ (1 / MOLAR_MASS))
        return bool(np.all((ratio > 0.6) & (ratio < 1.7)))

    def damping(self, state, change):
        """Part of a step by which temperatures change by 0.3 of themselves and fractions by 0.3 at most."""
        temperature, move = state[:, TEMPERATURE], change[:, TEMPERATURE]
        most = max(np.max(np.abs(move) / temperature), np.max(np.abs(change[:, :COUNT])))
        return min(1.0, 0.3 / max(most, 1e-12))

    def solution(self, state):
        density, _ = self._density(state)
        c = self.coefficients(state)
        _, heat = self.fluxes(state, c)
        u, v, xi = state[:, FLUX] / density, state[:, TANGENTIAL], self.xi
        return StagnationLine(
            self.distance,
            state[:, TEMPERATURE],
            -u,
            (v + u) / xi,
            state[:, :COUNT],
            float(-heat[0]),
            self._pressure_rise(state, u, v, c),
        )

    def _pressure_rise(self, state, u, v, c):
        r"""Pressure on the axis at the wall above that at the edge [Pa].

        .. math:: p' = -\rho u u' + \xi^{-2}(\xi^2\tau_{rr})' + 2(\tau - \tau_{\vartheta\vartheta})/\xi
        """
        xi = self.xi
        slope = np.gradient(u, xi, edge_order=2)
        spread = (u + v) / xi
        expansion = slope + 2 * spread
        along = c.viscosity * (2 * slope - 2 / 3 * expansion)
        across = c.viscosity * (2 * spread - 2 / 3 * expansion)
        shear = c.viscosity * (np.gradient(v, xi, edge_order=2) - spread)
        force = -state[:, FLUX] * slope + 2 * (along + shear - across) / xi
        return float(along[-1] - along[0] + np.trapezoid(force, xi)) * -1


def _mid(values):
    return (values[..., 1:] + values[..., :-1]) / 2


def _rows(integrals, rows):
    """Collision integrals of some of the points."""
    return type(integrals)(*(values[rows] for values in vars(integrals).values()))


def _regular(integrals):
    """Electron integrals with all orders of each neutral like the first.

    With the tabulated ones the conductivity has poles where electrons meet neutrals more than charges. No gas
    in equilibrium is there, but one that carries electrons into a cold layer; what they conduct is little.
    """
    neutral = np.flatnonzero(CHARGE == 0)
    orders = {name: getattr(integrals, name).copy() for name in ("q12", "q13", "q14", "q15")}
    for values in orders.values():
        values[:, neutral] = integrals.q11[:, neutral]
    return replace(integrals, **orders)


def _mass_fraction(mole_fraction):
    mass = mole_fraction * MOLAR_MASS
    return mass / mass.sum(axis=-1, keepdims=True)
