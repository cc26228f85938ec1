"""Temperature of a ceramic disc in a probe holder: two thermal nodes, heated by the plasma."""

from dataclasses import dataclass

import numpy as np
import scipy

STEFAN_BOLTZMANN = 5.670374419e-8


@dataclass(frozen=True)
class Sample:
    """A 3 mm C/SiC disc (node 1) before an insulating holder (node 2)."""

    initial_temperature: float = 350.0  # [K]
    surroundings: float = 300.0  # [K]
    emittance: float = 0.85
    areal_heat_capacity: float = 9.5e3  # [J m-2 K-1] of the disc at 1000 K
    heat_capacity_slope: float = 0.35  # relative change of it per 1000 K
    holder_heat_capacity: float = 9.0e3  # [J m-2 K-1]
    contact: float = 45.0  # [W m-2 K-1] disc to holder
    holder_loss: float = 25.0  # [W m-2 K-1] holder to the cooled probe
    cold_wall_heat_flux: float = 4.5e5  # [W m-2]
    recovery_temperature: float = 6500.0  # [K] at which the plasma would no longer heat
    rise_time: float = 1.5  # [s] to full heating after injection


def history(sample, time, plasma_off_time):
    """Surface temperature (t,) [K] at the times (t,) [s]; injection at 0 s."""

    def flux(moment, surface):
        if moment >= plasma_off_time or moment < 0:
            return 0.0
        start = 1 - np.exp(-moment / sample.rise_time)
        return sample.cold_wall_heat_flux * start * (1 - surface / sample.recovery_temperature)

    def rate(moment, state):
        surface, holder = state
        capacity = sample.areal_heat_capacity * (1 + sample.heat_capacity_slope * (surface / 1000 - 1))
        radiated = sample.emittance * STEFAN_BOLTZMANN * (surface**4 - sample.surroundings**4)
        inward = sample.contact * (surface - holder)
        lost = sample.holder_loss * (holder - sample.initial_temperature)
        return [
            (flux(moment, surface) - radiated - inward) / capacity,
            (inward - lost) / sample.holder_heat_capacity,
        ]

    state = np.full(2, sample.initial_temperature)
    surface = np.full(time.shape, sample.initial_temperature)
    # Phase by phase, so that no step of the integrator straddles a switch of the plasma.
    for begin, end in ((0.0, plasma_off_time), (plasma_off_time, max(time[-1], plasma_off_time) + 1.0)):
        run = scipy.integrate.solve_ivp(
            rate, (begin, end), state, method="LSODA", rtol=1e-8, atol=1e-5, dense_output=True
        )
        inside = (time >= begin) & (time <= end)
        if inside.any():
            surface[inside] = run.sol(time[inside])[0]
        state = run.y[:, -1]
    return surface
