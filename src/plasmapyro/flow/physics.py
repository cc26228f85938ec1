r"""Pointwise equations of the plasma flow: from values and gradients to weak-form densities.

Low-Mach, axisymmetric, local thermodynamic equilibrium; a swirl acts through its centrifugal force (see
`swirl`). With D = d/dt + u . grad and ' = d/dT:

.. math::
    \rho\,D u = -\nabla p + \nabla\cdot\tau + F, \qquad
    \tau = \mu\,(\nabla u + \nabla u^T - \tfrac23 I\,\nabla\cdot u)

    \rho c_p\,D T = \nabla\cdot(\kappa\nabla T) + q - q_{rad}

    R_c = \nabla\cdot u + \frac{\rho'}{\rho}\,D T = 0

q is the Joule heating, F the Lorentz (and centrifugal) force per volume, q_rad(T) the net emission. rho, mu,
kappa, c_p are functions of T at the chamber pressure (ASSUME: low Mach; with rho ~ p the temperatures change
by 2 K, the Mach number is 0.1 in the plasma). kappa holds the reactive part and c_p the heat of reaction, so
the energy equation needs no source for them; the term div(kappa grad T) itself is in `conduction`, only the
conduction that the limiter adds is here. What radiation takes is the net emission,
self-absorption in it; without a table nothing is lost.

The unknown is theta = ln T, not T: upwind undershoots at the cold sheath then stay positive, and ln rho ~
-theta is nearly linear. The pseudo-time derivative of rho stays in R_c: without it the step freezes T in the
mass balance, the saddle point becomes ill-posed and velocities of 1e3 m/s appear that Newton never recovers
from.

Stabilisation (h: element size, half of it for P2; all terms differentiated):

.. math::
    \tau_m = [(2\rho|u|/h)^2 + (12\mu/h^2)^2 + (2\rho/\Delta t)^2]^{-1/2}

streamline upwinding  (tau_m rho u . grad v, R_m)  and, with rho c_p and kappa in place of rho and mu,
(tau_T rho c_p u . grad w, R_T);  ``(rho |u| h/2 R_c, div v)``  on continuity; for equal-order elements also
(tau_m rho grad q, R_m). The term  (w, h_T rho R_c)  with the enthalpy h_T makes the energy equation
conservative: without it the global balance is off by 2-7 % on the meshes in use.

Mixing that a steady flow lacks is an eddy viscosity with Prandtl's mixing length l: a number C (the free one,
0 for none) times the radius of the torch, at most 0.41 times the distance from the nearest wall, behind the
torch exit only (with 0.01 in the torch, too, the one run tried diverged):

.. math:: \mu_t = \rho\,l^2\sqrt{2 S:S}, \qquad \kappa_t = c_p \mu_t/0.7

(B. E. Launder, D. B. Spalding, Mathematical Models of Turbulence (1972): l of a round jet is 0.075 of its
width, turbulent Prandtl number 0.7). Neither its memory nor what density does to it is modelled.

Source: Fagnani et al., sec. 4.1 (LTE CF-ICP model, same equations); SUPG/PSPG after Tezduyar, Adv. Appl.
Mech. 28 (1991) 1. Deviation: finite elements for VKI's finite volumes.
"""

from dataclasses import dataclass

import numpy as np

AXIAL, RADIAL, LOG_TEMPERATURE, GAUGE_PRESSURE = range(4)
FIELDS = 4
INPUTS = 3 * FIELDS  # value, d/dz, d/dr of each field
REFERENCE_VELOCITY = 100.0  # [m/s]: unit of the velocity unknowns
REFERENCE_PRESSURE = 100.0  # [Pa]: unit of the gauge-pressure unknown
# Row scales bring momentum [N m-3], energy [W m-3] and mass [kg m-3 s-1] to order one for the factorisation.
ROW_SCALE = np.repeat([1e-1, 1e-1, 1e-6, 1e2], 3)
SMALL_SPEED = 0.1  # [m/s]: smooths |u| at rest, so that its derivative exists
LIMITER_ONSET = 0.3  # excess of C Re over 1 at which the limiter adds half of it
TURBULENT_PRANDTL = 0.7  # of a round jet (Launder and Spalding 1972)
LEAST_SHEAR = 1.0  # [s-2]: the root has a slope in gas at rest
PROPERTY_NAMES = (
    "density",
    "density_slope",
    "enthalpy",
    "heat_capacity",
    "viscosity",
    "thermal_conductivity",
)


@dataclass(frozen=True)
class Points:
    """What the equations need at each quadrature point besides the unknowns; arrays (E, Q), SI.

    `inverse_step`: 1/(pseudo-time step), zero for the steady residual; `old_*`: state at the start of the
    step; `viscosity_limiter`: C blended to zero inside the torch, see `limited_viscosity`;
    `mixing_length` [m]; `equal_order`: 1 for P1 pressure with P1 velocity, 0 for Taylor-Hood.
    """

    radius: np.ndarray
    element_size: np.ndarray
    inverse_step: np.ndarray
    old_axial: np.ndarray
    old_radial: np.ndarray
    old_temperature: np.ndarray
    joule_heating: np.ndarray
    force_axial: np.ndarray
    force_radial: np.ndarray
    viscosity_limiter: np.ndarray
    mixing_length: np.ndarray
    equal_order: float

    def part(self, elements):
        """The same for a slice of elements, quadrature points first: arrays (Q, e)."""
        arrays = {
            name: np.ascontiguousarray(getattr(self, name)[elements].T)
            for name in self.__dataclass_fields__
            if name != "equal_order"
        }
        return type(self)(**arrays, equal_order=self.equal_order)


def property_lines(properties, temperature):
    """Tangents (value, slope, temperature) of the properties at real `temperature`, by name.

    A derivative sees a function only through its value and slope; one look-up then serves all of them.
    """
    names = PROPERTY_NAMES if properties.net_emission is None else (*PROPERTY_NAMES, "net_emission")
    return {name: (*getattr(properties, name)(temperature), temperature) for name in names}


def _on_line(line, temperature):
    value, slope, base = line
    return value + slope * (temperature - base)


def limited_viscosity(limiter, size, density, speed, viscosity):
    """Viscosity added where the cell Reynolds number exceeds 1/C, C = `limiter`: with e = C Re - 1,

        mu e^2 / (e + 0.3)  for e > 0, else exactly 0;

    its slope is continuous, and far above the threshold it is the whole excess mu e.

    Only for the cold annular sheath that enters the chamber at Re ~ 2e4, the one part that is physically
    unsteady.
    """
    excess = limiter * density * speed * size / viscosity - 1
    # The sign is decided by the real part, so that derivatives go through.
    positive = excess * (np.real(excess) > 0)
    return viscosity * positive * positive / (positive + LIMITER_ONSET)


def densities(inputs, lines, points):
    """Weak-form densities of momentum (z, r), energy and mass.

    Parameters
    ----------
    inputs : sequence of 12 arrays (E, Q), real or complex
        Value, d/dz, d/dr of the unknowns u_z/100 m/s, u_r/100 m/s, ln(T/K), (p - chamber pressure)/100 Pa.
    lines : result of `property_lines` at the real part of the temperature
    points : Points

    Returns
    -------
    list of 12 arrays (E, Q)
        Factors of v, dv/dz, dv/dr in the weak forms of the four equations [scaled by ROW_SCALE].
    """
    uz, uz_z, uz_r, ur, ur_z, ur_r = (REFERENCE_VELOCITY * field for field in inputs[:6])
    temperature = np.exp(inputs[6])
    t_z, t_r = temperature * inputs[7], temperature * inputs[8]
    p, p_z, p_r = (REFERENCE_PRESSURE * field for field in inputs[9:])

    density, density_slope, enthalpy, heat_capacity, viscosity, conductivity = (
        _on_line(lines[name], temperature) for name in PROPERTY_NAMES
    )
    h, rate, radius = points.element_size, points.inverse_step, points.radius
    speed = np.sqrt(uz * uz + ur * ur + SMALL_SPEED**2)
    added = limited_viscosity(points.viscosity_limiter, h, density, speed, viscosity)
    shear = (uz_r + ur_z) ** 2 + 2 * (uz_z**2 + ur_r**2 + (ur / radius) ** 2)
    eddy = density * points.mixing_length**2 * np.sqrt(shear + LEAST_SHEAR)
    viscosity = viscosity + added + eddy
    added_conductivity = (added + eddy / TURBULENT_PRANDTL) * heat_capacity

    divergence = uz_z + ur_r + ur / radius
    acceleration_z = (uz - points.old_axial) * rate + uz * uz_z + ur * uz_r
    acceleration_r = (ur - points.old_radial) * rate + uz * ur_z + ur * ur_r
    heating_rate = (temperature - points.old_temperature) * rate + uz * t_z + ur * t_r
    continuity = divergence + density_slope / density * heating_rate

    inertia_z = density * acceleration_z - points.force_axial
    inertia_r = density * acceleration_r - points.force_radial
    momentum_z, momentum_r = inertia_z + p_z, inertia_r + p_r
    capacity = density * heat_capacity
    energy = capacity * heating_rate - points.joule_heating
    if "net_emission" in lines:
        energy = energy + _on_line(lines["net_emission"], temperature)

    tau_momentum = stabilisation_time(density, speed, viscosity, h, rate)
    tau_energy = stabilisation_time(capacity, speed, conductivity + added_conductivity, h, rate)
    compression = density * speed * h / 2 * continuity

    bulk = 2 / 3 * viscosity * divergence
    stress_zz = 2 * viscosity * uz_z - bulk
    stress_rr = 2 * viscosity * ur_r - bulk
    stress_hoop = 2 * viscosity * ur / radius - bulk
    stress_zr = viscosity * (uz_r + ur_z)
    upwind_z, upwind_r = tau_momentum * density * uz, tau_momentum * density * ur
    heat_upwind = tau_energy * capacity * energy
    pressure_upwind = points.equal_order * tau_momentum * density
    rows = (
        inertia_z,
        stress_zz - p + upwind_z * momentum_z + compression,
        stress_zr + upwind_r * momentum_z,
        inertia_r + (stress_hoop - p + compression) / radius,
        stress_zr + upwind_z * momentum_r,
        stress_rr - p + upwind_r * momentum_r + compression,
        energy + enthalpy * density * continuity,
        added_conductivity * t_z + heat_upwind * uz,
        added_conductivity * t_r + heat_upwind * ur,
        density * continuity,
        pressure_upwind * momentum_z,
        pressure_upwind * momentum_r,
    )
    return [scale * row for scale, row in zip(ROW_SCALE, rows, strict=True)]


def stabilisation_time(inertia, speed, diffusivity, h, rate):
    """tau of the module docstring [s per unit inertia]."""
    return 1 / np.sqrt(
        (2 * inertia * speed / h) ** 2 + (12 * diffusivity / h**2) ** 2 + (2 * inertia * rate) ** 2
    )


def backflow_densities(inputs, normal, density, heat_capacity, temperature):
    """Densities on the open boundaries, which act only where gas enters.

    With m = min(u . n, 0):  -1/2 rho m u . v  removes the kinetic energy that a traction-free boundary would
    feed in; -rho c_p m (T - T_in) w  sets the temperature of the gas that enters.

    Parameters
    ----------
    inputs : as in `densities`
    normal : (2, E, Q) outward unit normal
    density, heat_capacity, temperature : floats
        Of the gas outside [kg m-3, J kg-1 K-1, K].
    """
    uz, ur = REFERENCE_VELOCITY * inputs[0], REFERENCE_VELOCITY * inputs[3]
    outward = uz * normal[0] + ur * normal[1]
    entering = -outward * (np.real(outward) < 0)
    rows = [0.0 * uz] * INPUTS
    rows[0] = 0.5 * density * entering * uz
    rows[3] = 0.5 * density * entering * ur
    rows[6] = density * heat_capacity * entering * (np.exp(inputs[6]) - temperature)
    return [scale * row for scale, row in zip(ROW_SCALE, rows, strict=True)]
