"""Rates of the reactions of air and the enthalpy of its species, smooth in temperature."""

from dataclasses import dataclass
from functools import cache

import cantera as ct
import numpy as np
from scipy.interpolate import CubicSpline

from plasmapyro import tables
from plasmapyro.constants import AVOGADRO, BOLTZMANN, MOLAR_GAS
from plasmapyro.gas import equilibrium
from plasmapyro.gas.species import MASS, SPECIES

TEMPERATURE_RANGE = (250.0, 15000.0)
RATES = ("kossyi", "gupta", "park")
NODES = 591  # every 25 K
MOLAR_MASS = MASS * AVOGADRO  # [kg mol-1]


@dataclass(frozen=True)
class _Mechanism:
    """Rate constants (reactions,) in mol, m, s and net coefficients (reactions, 11), partners (reactions, 3)
    and efficiencies of third particles; see `production`."""

    log_factor: np.ndarray
    exponent: np.ndarray
    activation_temperature: np.ndarray
    change: np.ndarray
    lost_partners: np.ndarray
    made_partners: np.ndarray
    collider: np.ndarray


@cache
def _mechanism(rates):
    if rates not in RATES:
        raise ValueError(f"rates must be one of {', '.join(RATES)}; got '{rates}'")
    whole = tables.load("facility/air_kinetics")
    rows = np.isin(whole["set"], (rates, "both"))
    table = {name: column[rows] for name, column in whole.columns.items()}
    parsed = [
        ct.Reaction(equation=equation, rate=ct.ArrheniusRate(1, 0, 0)) for equation in table["reaction"]
    ]

    def coefficients(side):
        return np.array([[getattr(one, side).get(name, 0.0) for name in SPECIES] for one in parsed])

    collider = np.zeros((len(parsed), len(SPECIES)))
    for row, one, words in zip(collider, parsed, table["colliders"], strict=True):
        if one.third_body is None:
            continue
        if one.third_body.name == "M":
            row[:] = 1.0
            for word in words.split():
                name, _, efficiency = word.rpartition(":")
                row[SPECIES.index(name)] = float(efficiency)
        else:  # Cantera takes a particle on both sides for the third
            row[SPECIES.index(one.third_body.name)] = 1.0
    two, three = table["two_body_factor"], table["three_body_factor"]
    return _Mechanism(
        np.log(np.where(np.isnan(two), three, two)),
        table["exponent"],
        table["activation_temperature"],
        coefficients("products") - coefficients("reactants"),
        _partners(coefficients("reactants")),
        _partners(coefficients("products")),
        collider,
    )


@cache
def _spline(name):
    # ASSUME: a spline through the polynomials, whose seams at 1000 and 6000 K are steps of 1e-4 of a rate.
    temperature = np.linspace(*TEMPERATURE_RANGE, NODES)
    return CubicSpline(temperature, equilibrium.standard_state(name, temperature))


def species_enthalpy(temperature):
    """Enthalpy of one particle of each species [J] at temperatures (...) [K]: shape (..., 11)."""
    return _spline("standard_enthalpies_RT")(temperature) * (BOLTZMANN * temperature)[..., None]


def species_heat_capacity(temperature):
    """Heat capacity per particle of each species over k [1] at temperatures (points,) [K]: (points, 11)."""
    return _spline("standard_cp_R")(temperature)


def production(temperature, pressure, mass_fraction, rates):
    r"""Mass that the reactions make of each species.

    .. math:: \dot\omega_i = M_i\sum_r(\nu''_{ir} - \nu'_{ir})\Big[\sum_s a_{sr}c_s\Big]\,
              A_r T^{n_r} e^{-T_r/T}\Big(\prod_s c_s^{\nu'_{sr}} - \frac{1}{K_r}\prod_s c_s^{\nu''_{sr}}\Big)

    with the bracket left out where no third particle takes part, and :math:`K_r` from the standard Gibbs
    functions of `gas.equilibrium`, so that the reactions rest where that equilibrium is.

    Parameters
    ----------
    temperature : (points,) ndarray [K]
    pressure : float [Pa]
    mass_fraction : (points, 11) ndarray [1]
    rates : str
        One of `RATES`.

    Returns
    -------
    (points, 11) ndarray [kg m-3 s-1]
        The sum over species vanishes.

    Notes
    -----
    Source: C. Park, J. Thermophys. Heat Transfer 7 (1993) 385; C. Park, R. L. Jaffe, H. Partridge, ibid. 15
    (2001) 76; R. N. Gupta et al., NASA RP-1232 (1990); I. A. Kossyi et al.,
    Plasma Sources Sci. Technol. 1 (1992) 207. ASSUME: one temperature.
    """
    m = _mechanism(rates)
    moles = mass_fraction / MOLAR_MASS
    gas = MOLAR_GAS * temperature[:, None]
    concentration = moles / moles.sum(axis=1, keepdims=True) * pressure / gas
    # Below zero, where an iteration may be for a while, two negative partners would react for ever.
    concentration = np.maximum(concentration, 0.0)
    partner = np.column_stack([concentration, np.ones(len(concentration))])
    gibbs = _spline("standard_gibbs_RT")(temperature)
    log_equilibrium = -gibbs @ m.change.T + np.log(equilibrium.REFERENCE_PRESSURE / gas) * m.change.sum(
        axis=1
    )
    log_forward = m.log_factor + m.exponent * np.log(temperature)[:, None]
    log_forward = log_forward - m.activation_temperature / temperature[:, None]
    # Forward and constant together: cold, each of them alone would leave the range of numbers.
    backward = np.exp(log_forward - log_equilibrium) * _product(partner, m.made_partners)
    rate = np.exp(log_forward) * _product(partner, m.lost_partners) - backward
    third = concentration @ m.collider.T
    rate = rate * np.where(m.collider.any(axis=1), third, 1.0)
    return rate @ m.change * MOLAR_MASS


def _product(concentration, partners):
    """Products of the concentrations (points, 12) of up to three partners (reactions, 3); the last is one."""
    return np.prod(concentration[:, partners], axis=2)


def _partners(coefficients):
    """Species of each side of a reaction, one index per particle, filled up with that of the dummy."""
    rows = [np.repeat(np.arange(len(SPECIES)), row.astype(int)) for row in coefficients]
    return np.array([np.pad(row, (0, 3 - len(row)), constant_values=len(SPECIES)) for row in rows])
