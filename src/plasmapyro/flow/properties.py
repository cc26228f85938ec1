"""Gas properties at one pressure as functions of temperature, with exact derivatives.

Newton's method needs the property and its slope from one and the same function. Each property is a smooth
spline through the table of the gas stage, resampled once onto a fine uniform grid as cubic Hermite pieces,
so that a look-up costs a few array operations whatever the size of the table.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from plasmapyro.checks import positive, within

FINE_POINTS = 6001  # 2.5 K over 200-15000 K: Hermite error below 1e-9 of a 25 K spline
EMISSION_FLOOR = 1e-3  # [W m-3]: keeps the logarithm finite in cold gas
CONDUCTIVITY_FLOOR = 1e-4  # [S m-1]: keeps ln(sigma) finite in cold gas; nothing couples there


class OutsideTable(ValueError):
    """A temperature outside the property table; the message names it and the table's range."""


@dataclass(frozen=True)
class HermiteTable:
    """Piecewise cubic f(T) on a uniform grid: `values` [unit of f] and `slopes` [per grid step]."""

    low: float
    step: float
    values: np.ndarray
    slopes: np.ndarray

    def __call__(self, temperature):
        """Return f and df/dT at `temperature` [K]; raise OutsideTable beyond the grid."""
        position = (np.asarray(temperature) - self.low) / self.step
        last = len(self.values) - 1
        if not np.all((position >= 0) & (position <= last)):
            found = np.asarray(temperature)
            bad = found[~((position >= 0) & (position <= last))].flat[0]
            high = self.low + self.step * last
            raise OutsideTable(f"temperature {bad:g} K outside the property table {self.low:g}..{high:g} K")
        index = np.minimum(position.astype(np.int64), last - 1)
        x = position - index
        f0, f1 = self.values[index], self.values[index + 1]
        d0, d1 = self.slopes[index], self.slopes[index + 1]
        quadratic = 3 * (f1 - f0) - 2 * d0 - d1
        cubic = 2 * (f0 - f1) + d0 + d1
        value = f0 + x * (d0 + x * (quadratic + x * cubic))
        slope = (d0 + x * (2 * quadratic + 3 * x * cubic)) / self.step
        return value, slope


@dataclass(frozen=True)
class GasProperties:
    """Tables of T [K] at one pressure, SI units; `enthalpy` is zero at `reference_temperature`.

    `heat_flux_potential` is the integral of the thermal conductivity from the lowest temperature [W m-1].
    `density_slope` is d rho/dT and `heat_capacity` is dh/dT of the same spline as `enthalpy`: the convective
    and the conservative form of the energy equation then agree to round-off.
    """

    pressure: float
    density: HermiteTable
    density_slope: HermiteTable
    enthalpy: HermiteTable
    heat_capacity: HermiteTable
    viscosity: HermiteTable
    thermal_conductivity: HermiteTable
    heat_flux_potential: HermiteTable
    electrical_conductivity: HermiteTable
    low: float
    high: float
    net_emission: HermiteTable | None = None

    def temperature_of(self, potential):
        """Temperature [K] where the heat-flux potential is `potential` [W m-1]; the nearest in the table."""
        table = self.heat_flux_potential
        grid = table.low + table.step * np.arange(len(table.values))
        # Just inside the table, whatever the rounding of its last temperature.
        guess = np.interp(potential, table.values, grid).clip(table.low, grid[-1] - 1e-9 * table.step)
        # One step of Newton's method: round-off from 0.01 K.
        value, slope = table(guess)
        return np.clip(guess - (value - potential) / slope, guess - table.step, guess + table.step).clip(
            self.low, self.high
        )


def gas_properties(gas, pressure, reference_temperature, emission=None, radiation_factor=0.0):
    """Property tables at `pressure` from the dataset of the gas stage.

    ValueError: a radiation factor without `emission`; `pressure` outside the table, or a table with fewer
    than four temperatures.

    Parameters
    ----------
    gas : Dataset, contract 'gas'
    pressure : float [Pa]
        Inside the pressures of `gas`. ASSUME: between two table pressures every property is linear in ln p,
        rho and sigma through their logarithm (rho ~ p at fixed composition is then exact).
    reference_temperature : float [K]
        Where the enthalpy is zero (the wall temperature).

    emission : Dataset, contract 'net_emission', optional
        Power that the gas radiates per volume.
    radiation_factor : float [1]
        Multiplies it; at 0 nothing is radiated.
    """
    pressure = float(positive("chamber_pressure", pressure, "Pa"))
    nodes = gas.pressure.values
    within("chamber_pressure", pressure, nodes.min(), nodes.max(), "Pa")
    temperature = gas.temperature.values.astype(float)
    if len(temperature) < 4:
        raise ValueError(f"the gas table needs at least 4 temperatures; got {len(temperature)}")

    def column(name, transform=lambda values: values):
        table = transform(gas[name].transpose("pressure", "temperature").values)
        return _at_log_pressure(nodes, table, pressure)

    fine = np.linspace(temperature[0], temperature[-1], FINE_POINTS)
    fine[-1] = temperature[-1]
    log_density = CubicSpline(temperature, column("density", np.log))
    enthalpy = CubicSpline(temperature, column("enthalpy"))
    log_kappa = CubicSpline(temperature, column("thermal_conductivity", np.log))
    viscosity = CubicSpline(temperature, column("viscosity"))
    # Monotone: sigma spans ten decades and a cubic spline would ring at the cold end.
    log_sigma = PchipInterpolator(
        temperature, column("electrical_conductivity", lambda sigma: np.log(sigma + CONDUCTIVITY_FLOOR))
    )
    rho, log_slope, log_curvature = np.exp(log_density(fine)), log_density(fine, 1), log_density(fine, 2)
    sigma, kappa = np.exp(log_sigma(fine)), np.exp(log_kappa(fine))
    step = (temperature[-1] - temperature[0]) / (FINE_POINTS - 1)
    kappa_slope = kappa * log_kappa(fine, 1)
    # Integral of each cubic piece of kappa.
    pieces = step * (kappa[1:] + kappa[:-1]) / 2 + step**2 * (kappa_slope[:-1] - kappa_slope[1:]) / 12
    potential = np.concatenate([[0.0], np.cumsum(pieces)])

    def table(values, slopes):
        return HermiteTable(float(temperature[0]), float(step), values, slopes * step)

    return GasProperties(
        pressure=pressure,
        density=table(rho, rho * log_slope),
        density_slope=table(rho * log_slope, rho * (log_slope**2 + log_curvature)),
        enthalpy=table(enthalpy(fine) - enthalpy(reference_temperature), enthalpy(fine, 1)),
        heat_capacity=table(enthalpy(fine, 1), enthalpy(fine, 2)),
        viscosity=table(viscosity(fine), viscosity(fine, 1)),
        thermal_conductivity=table(kappa, kappa_slope),
        heat_flux_potential=table(potential, kappa),
        electrical_conductivity=table(
            np.maximum(sigma - CONDUCTIVITY_FLOOR, 0.0), sigma * log_sigma(fine, 1)
        ),
        low=float(temperature[0]),
        high=float(temperature[-1]),
        net_emission=_radiation(emission, pressure, float(radiation_factor), fine, step),
    )


def _radiation(emission, pressure, factor, fine, step):
    """Net emission times `factor` as a table on the fine grid; None for no loss."""
    if factor == 0.0:
        return None
    if emission is None:
        raise ValueError(f"radiation_factor {factor:g} needs a table of net emission; none was given")
    temperature, nodes = emission.temperature.values.astype(float), emission.pressure.values
    within("chamber_pressure", pressure, nodes.min(), nodes.max(), "Pa")
    table = np.log(emission.net_emission.transpose("pressure", "temperature").values + EMISSION_FLOOR)
    logarithm = PchipInterpolator(temperature, _at_log_pressure(nodes, table, pressure))
    inside = np.clip(fine, temperature[0], temperature[-1])
    values = np.exp(logarithm(inside))
    slopes = np.where(inside == fine, values * logarithm(inside, 1), 0.0)
    return HermiteTable(
        float(fine[0]), float(step), factor * np.maximum(values - EMISSION_FLOOR, 0.0), factor * slopes * step
    )


def _at_log_pressure(nodes, table, pressure):
    """Row of `table` (P, T) at `pressure`, linear in ln p; the row itself at a node."""
    exact = np.flatnonzero(np.isclose(nodes, pressure, rtol=1e-9, atol=0))
    if len(exact):
        return table[exact[0]]
    upper = int(np.searchsorted(nodes, pressure))
    share = np.log(pressure / nodes[upper - 1]) / np.log(nodes[upper] / nodes[upper - 1])
    return (1 - share) * table[upper - 1] + share * table[upper]
