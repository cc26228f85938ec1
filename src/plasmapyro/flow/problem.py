"""The discrete problem of a torch on a mesh: residual, Jacobian and induction coupling."""

from copy import copy
from dataclasses import replace
from functools import cached_property, partial
from types import MappingProxyType

import numpy as np

from plasmapyro.flow.boundary import OPEN, fixed_values
from plasmapyro.flow.conduction import Conduction
from plasmapyro.flow.coupled import coupled_solution
from plasmapyro.flow.elements import Space
from plasmapyro.flow.geometry import WALLS, flow_mesh
from plasmapyro.flow.gradient import Graded, derivatives, gradient
from plasmapyro.flow.induction import Induction, ring_potential
from plasmapyro.flow.linear import Factorised, dissection
from plasmapyro.flow.physics import (
    AXIAL,
    GAUGE_PRESSURE,
    INPUTS,
    LOG_TEMPERATURE,
    RADIAL,
    REFERENCE_PRESSURE,
    REFERENCE_VELOCITY,
    SMALL_SPEED,
    Points,
    backflow_densities,
    densities,
    limited_viscosity,
    property_lines,
)
from plasmapyro.flow.swirl import Swirl

CHUNK = 1000  # elements per pass: the temporaries of the pointwise physics stay in the cache
SIGNAL_SPEED = 200.0  # [m/s]: added to |u| in the local pseudo-time step
VON_KARMAN = 0.41  # growth of the mixing length with the distance from a wall
LIMITER_RAMP = 0.04  # [m] behind the torch exit over which the viscosity limiter sets in


class Problem:
    """Flow unknowns on the triangles of the flow domain, electric field on those and the box.

    Parameters
    ----------
    mesh : MeshTri from `geometry.build_mesh`
    torch : Torch
    properties : GasProperties
    frequency : float [Hz]
    mass_flow_rate : float [kg s-1]
    wall_temperature : float [K]
        Of the gas that enters, and of the walls that are not among `walls`.
    walls : mapping of `geometry.WALLS` -> temperature [K]
    swirl_angle : float [rad]
        Between the gas that enters and the axis.
    mixing : float [1]
        Mixing length over the radius of the torch (`physics`); 0 for a laminar flow.
    adiabatic_walls : sequence of str, of `geometry.WALLS`
    limiter : float [1]
        Coefficient C of the viscosity limiter in the chamber (`physics.limited_viscosity`); 0 for none.
    order : int
        1: P1 for all fields with pressure stabilisation; 2: Taylor-Hood, P2 for velocity and ln T, P1 for
        pressure.
    """

    def __init__(
        self,
        mesh,
        torch,
        properties,
        *,
        frequency,
        mass_flow_rate,
        wall_temperature,
        order,
        limiter=0.0,
        walls=MappingProxyType({}),
        swirl_angle=0.0,
        mixing=0.0,
        adiabatic_walls=(),
    ):
        self.torch, self.order, self.limiter = torch, order, limiter
        self.wall_temperature = wall_temperature
        self.mesh = flow_mesh(mesh, torch)
        self.space = Space(self.mesh, (order, order, order, 1))
        coil = partial(ring_potential, ring_radius=torch.coil_radius, ring_positions=torch.coil_positions)
        self.induction = Induction(mesh, frequency, coil, order)
        self.swirl_angle, self.mixing, self.walls = swirl_angle, mixing, walls
        self.adiabatic_walls = adiabatic_walls
        self._rank = dissection(self.mesh)
        self._set_gas(properties, mass_flow_rate)
        self._set_free()
        self._open = self.space.facets(OPEN)
        self._conduction = Conduction(self.space)
        cells = self.space.cells
        area = (cells.weight / (2 * np.pi * cells.r)).sum(axis=1)
        # Edge of the equilateral triangle of the same area, halved where a quadratic element resolves half
        # of it.
        self._size = np.repeat((np.sqrt(4 * area / np.sqrt(3)) / order)[:, None], cells.z.shape[1], axis=1)
        self._clearance = torch.wall_clearance(cells.z, cells.r)
        ramp = np.clip((cells.z - torch.length) / LIMITER_RAMP, 0, 1)
        self._limiter_blend = ramp * ramp * (3 - 2 * ramp)

    def _set_gas(self, properties, mass_flow_rate):
        self.properties, self.mass_flow_rate = properties, mass_flow_rate
        self.fixed, self.values = fixed_values(
            self.space,
            self.torch,
            properties,
            mass_flow_rate,
            self.wall_temperature,
            {name: self.wall_temperature for name in WALLS} | dict(self.walls),
            self.adiabatic_walls,
        )
        self._outside = (
            float(properties.density(self.wall_temperature)[0]),
            float(properties.heat_capacity(self.wall_temperature)[0]),
            self.wall_temperature,
        )

    def _set_free(self):
        self.free = np.flatnonzero(~self.fixed)
        self._factorised = Factorised(self.space.nodes()[self.free], self.free, self._rank)

    def at(self, properties, *, mass_flow_rate, frequency, **others):
        """The same problem at another condition; mesh, bases and orderings are shared.

        `others`: swirl angle, mixing, temperatures of walls, adiabatic walls that change.
        """
        other = copy(self)
        other.induction = self.induction.at_frequency(frequency)
        for name, value in others.items():
            setattr(other, name, value)
        other._set_gas(properties, mass_flow_rate)
        if other.adiabatic_walls != self.adiabatic_walls:
            other._set_free()
        return other

    def with_limiter(self, limiter):
        """The same problem with another coefficient of the viscosity limiter."""
        other = copy(self)
        other.limiter = limiter
        return other

    def temperature_at_points(self, state):
        """Temperature (E, Q) at the quadrature points [K]."""
        return np.exp(self.space.field_inputs(self.space.cells, LOG_TEMPERATURE, state)[0])

    def couple(self, state, power):
        """Induction coupling at Joule power `power` [W]; returns Coupling and coil amplitude [A].

        The centrifugal force of a swirl is part of `force_radial`.
        """
        conductivity, _ = self.properties.electrical_conductivity(self.temperature_at_points(state))
        unit = self.induction.solve(np.maximum(conductivity, 0.0))
        square = power / unit.power
        scaled = replace(
            unit,
            power=power,
            joule_heating=square * unit.joule_heating,
            force_axial=square * unit.force_axial,
            force_radial=square * unit.force_radial,
        )
        if self.swirl_angle:
            density = self.properties.density(self.temperature_at_points(state))[0]
            turning = self.azimuthal_velocity(state)[1]
            centrifugal = density * turning**2 / self.space.cells.r
            scaled = replace(scaled, force_radial=scaled.force_radial + centrifugal)
        return scaled, float(np.sqrt(square))

    @cached_property
    def _swirl(self):
        return Swirl(self.mesh, self.order, OPEN)

    def azimuthal_velocity(self, state):
        """Azimuthal velocity at the dofs of the axial one and at the quadrature points [m s-1]."""
        cells = self.space.cells
        axial, radial, temperature = self._velocity_and_temperature(cells, state)
        density = self.properties.density(temperature)[0]
        viscosity = self.properties.viscosity(temperature)[0]
        speed = np.sqrt(axial**2 + radial**2 + SMALL_SPEED**2)
        limiter = self.limiter * self._limiter_blend
        viscosity = viscosity + limited_viscosity(limiter, self._size, density, speed, viscosity)
        axial_edge, radial_edge, _ = self._velocity_and_temperature(self._open, state)
        outward = axial_edge * self._open.normal[0] + radial_edge * self._open.normal[1]
        entering = self._outside[0] * np.maximum(-outward, 0.0)
        inlet = self._swirl.inlet_values(
            REFERENCE_VELOCITY * self.values[self.space.field(AXIAL)], self.swirl_angle
        )
        return self._swirl.solve(axial, radial, density, viscosity, self._size, inlet, entering)

    def _velocity_and_temperature(self, patch, state):
        inputs = self.space.inputs(patch, state)
        return (
            REFERENCE_VELOCITY * inputs[3 * AXIAL],
            REFERENCE_VELOCITY * inputs[3 * RADIAL],
            np.exp(inputs[3 * LOG_TEMPERATURE]),
        )

    def radiated_power(self, state):
        """Net emission of the whole gas [W]; zero without a table."""
        if self.properties.net_emission is None:
            return 0.0
        emission = self.properties.net_emission(self.temperature_at_points(state))[0]
        return float((emission * self.space.cells.weight).sum())

    def points(self, state, coupling, courant):
        """Frozen data of one pseudo-time step from `state`; `courant` = inf gives the steady equations."""
        inputs = self.space.inputs(self.space.cells, state)
        axial, radial = REFERENCE_VELOCITY * inputs[3 * AXIAL], REFERENCE_VELOCITY * inputs[3 * RADIAL]
        return Points(
            radius=self.space.cells.r,
            element_size=self._size,
            inverse_step=(np.hypot(axial, radial) + SIGNAL_SPEED) / (courant * self._size),
            old_axial=axial,
            old_radial=radial,
            old_temperature=np.exp(inputs[3 * LOG_TEMPERATURE]),
            joule_heating=coupling.joule_heating,
            force_axial=coupling.force_axial,
            force_radial=coupling.force_radial,
            viscosity_limiter=self.limiter * self._limiter_blend,
            mixing_length=self._limiter_blend
            * np.minimum(self.mixing * self.torch.radius, VON_KARMAN * self._clearance),
            equal_order=1.0 if self.order == 1 else 0.0,
        )

    def residual(self, state, points):
        """Residual of all equations (size,); on fixed rows it is the reaction of the wall."""
        cells = self.space.cells
        inputs = self.space.inputs(cells, state)
        lines = property_lines(self.properties, np.exp(inputs[3 * LOG_TEMPERATURE]))
        inner = self.space.residual(cells, np.stack(densities(inputs, lines, points)))
        rows = self._backflow(self.space.inputs(self._open, state))
        conducted = self._conduction.residual(state, self.properties)
        return inner + conducted + self.space.residual(self._open, np.stack(rows))

    def rest_residual(self, coupling):
        """Norm of the free steady residual of gas at rest at wall temperature and chamber pressure.

        Boundary values are imposed, Joule heating and Lorentz force are those of `coupling`: feed, heating
        and force with nothing to balance them. It is the scale that makes other residuals relative.
        """
        rest = np.zeros(self.space.size)
        rest[self.space.field(LOG_TEMPERATURE)] = np.log(self.wall_temperature)
        rest[self.fixed] = self.values[self.fixed]
        residual = self.residual(rest, self.points(rest, coupling, np.inf))
        return float(np.linalg.norm(residual[self.free]))

    def _backflow(self, inputs):
        return backflow_densities(inputs, self._open.normal, *self._outside)

    def jacobian(self, state, points):
        """Sparse Jacobian of `residual` (size, size)."""
        cells = self.space.cells
        inputs = self.space.inputs(cells, state)
        local_size = cells.dofs.shape[1]
        matrices = np.empty((len(cells.dofs), local_size, local_size))
        for first in range(0, len(cells.z), CHUNK):
            part = slice(first, first + CHUNK)
            some = list(np.ascontiguousarray(inputs[:, part].transpose(0, 2, 1)))
            lines = property_lines(self.properties, np.exp(some[3 * LOG_TEMPERATURE]))
            forms = partial(densities, lines=lines, points=points.part(part))
            matrices[part] = self.space.cell_matrices(part, partial(gradient, forms, some))
            heat = self._conduction.columns
            matrices[part, heat, heat] += self._conduction.element_matrices(state, self.properties, part)
        data = self.space.gathered(cells, matrices)
        backflow = derivatives(self._backflow, list(self.space.inputs(self._open, state)))
        data += self.space.gathered(self._open, self.space.element_matrices(self._open, backflow))
        return self.space.matrix(data)

    def factors(self, state, points):
        """Factors of the Jacobian of the free unknowns at a state."""
        return self._factorised.system(self.jacobian(state, points)).factors(single=True)

    def newton_update(self, state, points, coupling=None, linear_tolerance=0.0, factors=None):
        """Full Newton correction (size,), zero on fixed dofs, and the norm of the free residual.

        With a `linear_tolerance` the correction is Newton's for flow and induction together (see `coupled`),
        `coupling` being the result of `couple` at `state`; otherwise heating and forces stay as they are.
        `factors` of a state close by may take the place of those at `state`.
        """
        residual = self.residual(state, points)[self.free]
        factors = factors or self.factors(state, points)
        update = np.zeros(self.space.size)
        if linear_tolerance:
            induced = self._induced(state, points, coupling)
            update[self.free] = coupled_solution(factors.solve_roughly, induced, -residual, linear_tolerance)
        else:
            update[self.free] = factors.solve(-residual)
        return update, float(np.linalg.norm(residual))

    def _induced(self, state, points, coupling):
        """Function: change of the free unknowns -> change of the free residual through heating and forces."""
        cells = self.space.cells
        inputs = self.space.inputs(cells, state)
        temperature = np.exp(inputs[3 * LOG_TEMPERATURE])
        lines = property_lines(self.properties, temperature)
        slope = self.properties.electrical_conductivity(temperature)[1] * temperature
        # Heating and forces enter linearly: their factors, once, in the rows where they have any.
        names = ("joule_heating", "force_axial", "force_radial")
        sources = {name: Graded(getattr(points, name), {name: 1.0}) for name in names}
        found = [getattr(row, "slopes", {}) for row in densities(inputs, lines, replace(points, **sources))]
        factors = [
            {row: slopes[name] for row, slopes in enumerate(found) if np.any(slopes.get(name, 0.0))}
            for name in names
        ]
        unit = self.induction_power(coupling)

        def induced(change):
            full = np.zeros(self.space.size)
            full[self.free] = change
            parts = coupling.tangent(slope * self.space.field_inputs(cells, LOG_TEMPERATURE, full)[0])
            growth = (parts[0] * cells.weight).sum() / unit
            scale = coupling.power / unit
            now = (coupling.joule_heating, coupling.force_axial, coupling.force_radial)
            sources = [scale * part - growth * held for part, held in zip(parts, now, strict=True)]
            rows = np.zeros((INPUTS, *cells.r.shape))
            for factor, source in zip(factors, sources, strict=True):
                for row, share in factor.items():
                    rows[row] += share * source
            return self.space.residual(cells, rows)[self.free]

        return induced

    def induction_power(self, coupling):
        """Joule power of 1 A of coil amplitude [W]."""
        tangent = coupling.tangent
        heating = 0.5 * tangent.conductivity * np.abs(tangent.electric) ** 2
        return float((heating * self.space.cells.weight).sum())

    def physical(self, state):
        """Fields in SI at their own dofs: u_z, u_r [m/s], T [K], p - chamber pressure [Pa]."""
        field = self.space.field
        return (
            REFERENCE_VELOCITY * state[field(AXIAL)],
            REFERENCE_VELOCITY * state[field(RADIAL)],
            np.exp(state[field(LOG_TEMPERATURE)]),
            REFERENCE_PRESSURE * state[field(GAUGE_PRESSURE)],
        )

    def joule_heating_at_nodes(self, state, coupling, current):
        """Joule heating at the nodes of ln T [W m-3], from the coupling at coil amplitude `current` [A]."""
        temperature = np.exp(state[self.space.field(LOG_TEMPERATURE)])
        conductivity = self.properties.electrical_conductivity(temperature)[0]
        field = current * self.induction.field_at(*self.space.points(LOG_TEMPERATURE), coupling.scattered)
        return 0.5 * np.maximum(conductivity, 0.0) * np.abs(field) ** 2

    def state_of(self, axial, radial, temperature, gauge):
        """Dof vector of SI fields at their own dofs, boundary values imposed."""
        state = np.concatenate(
            [
                axial / REFERENCE_VELOCITY,
                radial / REFERENCE_VELOCITY,
                np.log(temperature),
                gauge / REFERENCE_PRESSURE,
            ]
        )
        state[self.fixed] = self.values[self.fixed]
        return state
