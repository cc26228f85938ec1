"""First guess of a cold start."""

import numpy as np

from plasmapyro.flow.physics import AXIAL, GAUGE_PRESSURE, LOG_TEMPERATURE

HOT = 9000.0  # [K]
SHEATH = 0.0065  # [m]: cold jet along the tube wall
SHEATH_SPEED, CORE_SPEED = 120.0, 200.0  # [m/s]


def hot_torch(problem):
    """State with a hot torch, a cold wall jet and gas already streaming to the probe.

    The torch is hot down to its back wall: with a cold back a dense vortex forms there, the wall jet
    detaches and blows the plasma out (the coil current then runs away at constant power).
    """
    torch, wall = problem.torch, problem.wall_temperature
    z, r = problem.space.points(LOG_TEMPERATURE)
    behind = np.maximum(z - torch.length, 0.0)
    edge = 0.8 * torch.radius - 0.01 * np.clip(behind / 0.2, 0, 1)
    clearance = torch.probe_clearance(z, r)
    shape = (
        np.clip(z / 0.012, 0, 1)
        * 0.5
        * (1 - np.tanh((r - edge) / 0.005))
        * np.clip(clearance / 0.01, 0, 1)
        * np.clip(1 - behind / 1.2, 0.5, 1)
    )
    temperature = wall + (HOT - wall) * shape
    z, r = problem.space.points(AXIAL)
    across = (r - (torch.radius - SHEATH / 2)) / (SHEATH / 2)
    sheath = np.where(z < torch.length, SHEATH_SPEED * np.clip(1 - across**2, 0, 1), 0.0)
    core = (
        CORE_SPEED
        * np.clip(1 - (r / (0.75 * torch.radius)) ** 2, 0, 1)
        * np.clip((z - 0.1) / 0.2, 0, 1)
        * np.clip(torch.probe_clearance(z, r) / 0.02, 0, 1)
    )
    axial = np.maximum(sheath, core)
    gauge = np.zeros(problem.space.points(GAUGE_PRESSURE).shape[1])
    return problem.state_of(axial, np.zeros_like(axial), temperature, gauge)
