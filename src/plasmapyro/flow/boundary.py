"""Boundary values of the flow: walls, axis, inlet profile, open boundaries.

* inlet slot: plug profile u_z = U (1 - s^8), s from -1 to 1 over the slot, u_r = 0, wall temperature; U
  makes the discrete mass flow exact;
* walls: no slip; each its own temperature (350 K in the CF-ICP cases), or adiabatic: no heat is conducted,
  the natural condition of the weak form. A warm wall is as cold as the feed where it meets the inlet; the
  lip of the torch is the tube's;
* axis: u_r = 0;
* top of the chamber: no axial velocity, so that entrained gas comes in radially (free tangential inflow lets
  vortices cross the boundary, and the solution diverges);
* top and outlet: no traction at chamber pressure, no conduction, gas that enters is at wall temperature.
"""

import numpy as np

from plasmapyro.flow.geometry import WALLS
from plasmapyro.flow.physics import AXIAL, LOG_TEMPERATURE, RADIAL, REFERENCE_VELOCITY

OPEN = ("top", "outlet")
COLD_EDGE = 12  # power with which a hot back or tube wall falls to the temperature of the inlet beside it
PROFILE_EXPONENT = 8  # nearly a plug, with a boundary layer of a tenth of the slot


def fixed_values(space, torch, properties, mass_flow_rate, feed_temperature, walls, adiabatic_walls=()):
    """Dirichlet conditions of the four fields: where unknowns (size,) are fixed, and their values.

    `walls`: of `geometry.WALLS` -> temperature [K]; that of `adiabatic_walls` is free but where they meet the
    inlet or a wall that is not among them.
    """
    fixed, values = np.zeros(space.size, bool), np.zeros(space.size)

    def fix(field, names):
        fixed[space.offsets[field] + space.boundary_dofs(field, names)] = True

    fix(AXIAL, (*WALLS, "inlet", "top"))
    fix(RADIAL, (*WALLS, "inlet", "axis"))
    held = tuple(name for name in (*WALLS, "inlet") if name not in adiabatic_walls)
    fix(LOG_TEMPERATURE, held)
    values[space.field(LOG_TEMPERATURE)] = np.where(
        fixed[space.field(LOG_TEMPERATURE)], np.log(feed_temperature), 0.0
    )
    z, r = space.points(LOG_TEMPERATURE)
    beside_inlet = {"back_wall": r / torch.slot_inner_radius, "tube_wall": 1 - z / torch.length}
    for name in ("back_wall", "chamber_wall", "tube_wall", "probe"):
        if name in held and len(dofs := space.boundary_dofs(LOG_TEMPERATURE, (name,))):
            share = 1 - beside_inlet[name][dofs] ** COLD_EDGE if name in beside_inlet else 1.0
            excess = np.maximum(share, 0.0) * (walls[name] - feed_temperature)
            values[space.offsets[LOG_TEMPERATURE] + dofs] = np.log(feed_temperature + excess)
    slot = space.boundary_dofs(AXIAL, ("inlet",))
    across = (
        2
        * (space.points(AXIAL)[1, slot] - torch.slot_inner_radius)
        / (torch.radius - torch.slot_inner_radius)
    )
    profile = 1 - np.abs(across - 1) ** PROFILE_EXPONENT
    # The slot ends on walls: exactly at rest there, whatever the rounding of the profile.
    profile[np.isin(slot, space.boundary_dofs(AXIAL, WALLS))] = 0.0
    values[space.offsets[AXIAL] + slot] = profile
    inlet = space.facets(("inlet",))
    density, _ = properties.density(feed_temperature)
    flux = float((inlet.weight * REFERENCE_VELOCITY * space.inputs(inlet, values)[3 * AXIAL]).sum() * density)
    values[space.offsets[AXIAL] + slot] *= mass_flow_rate / flux
    return fixed, values


def inlet_mach_number(torch, properties, mass_flow_rate, temperature):
    """Mean velocity in the slot over the speed of sound there, at the chamber pressure [1].

    With a^2 = gamma p / rho and gamma = c_p / (c_p - p / (rho T)) for the gas at `temperature` [K], an ideal
    gas. The equations are those of a small one; above 1 a real slot chokes.
    """
    density, heat_capacity = properties.density(temperature)[0], properties.heat_capacity(temperature)[0]
    gas_constant = properties.pressure / (density * temperature)
    ratio = heat_capacity / (heat_capacity - gas_constant)
    area = np.pi * (torch.radius**2 - torch.slot_inner_radius**2)
    velocity = mass_flow_rate / (density * area)
    return float(velocity / np.sqrt(ratio * gas_constant * temperature))
