"""Composition and thermodynamics of mixtures of N2 and O2 in local thermodynamic equilibrium (LTE)."""

from functools import cache

import numpy as np

from plasmapyro.checks import positive, within
from plasmapyro.constants import BOLTZMANN
from plasmapyro.gas.species import AIR, CHARGE, MASS, NITROGEN_ATOMS, OXYGEN_ATOMS, SPECIES, oxygen_beside

REFERENCE_PRESSURE = 1e5
"""Pressure the NASA-9 polynomials refer to [Pa]: 1 bar (McBride, Zehe, Gordon, NASA/TP-2002-211556)."""

TEMPERATURE_RANGE = (200.0, 20000.0)
"""Validity of the NASA-9 polynomials [K]. Those of the ions start at 298.15 K; below that no ion is left."""


@cache
def phase():
    """Ideal-gas phase of the eleven species of air (`cantera.Solution`), thermodynamic data NASA-9.

    Deviation: Cantera's `airNASA9.yaml` states no reference pressure and Cantera then takes 1 atm,
    which makes every dissociation constant 1.3 % too large. The species are rebuilt at 1 bar.
    """
    import cantera as ct  # half a second, and no part of what corrects and diagnoses a test

    species = {one.name: one for one in ct.Species.list_from_file("airNASA9.yaml")}
    for one in species.values():
        data = one.thermo
        one.thermo = ct.Nasa9PolyMultiTempRegion(
            data.min_temp, data.max_temp, REFERENCE_PRESSURE, data.coeffs
        )
    return ct.Solution(thermo="ideal-gas", species=[species[name] for name in SPECIES])


def composition(temperature, pressure, nitrogen=AIR["N2"]):
    r"""Mole fractions of a mixture of N2 and O2 in chemical equilibrium.

    .. math:: x_s = \frac{p^\circ}{p}\exp\Big(-\frac{g_s^\circ(T)}{kT} + \sum_e a_{se}\pi_e\Big)

    with the potentials :math:`\pi_e` of N, O and charge such that the fractions add up to one, the
    elements are those of the cold gas, and the charge vanishes.

    Source: McBride, Zehe & Gordon, NASA/TP-2002-211556 (NASA-9 polynomials); element potentials as Reynolds,
    STANJAN (Stanford, 1986). ASSUME: no lowering of the ionisation energy (about 0.05 % of it at 0.05 bar).
    Deviation: Cantera's own `equilibrate` loses the charged species below about 2000 K: at 50 mbar it gives
    1e-3 of the electrons at 1500 K and 2e-12 of them at 1000 K, at 1 atm 0.8 of them at 1900 K. From 2250 K
    all species agree to 2e-7, from 2500 K to 1e-10; the neutral ones do everywhere from 1250 K.

    ValueError: temperature or nitrogen outside its range, or pressure not > 0. ArithmeticError: the iteration
    did not converge (never seen from 200 to 20000 K and 1 to 1e7 Pa).

    Parameters
    ----------
    temperature : array_like [K]
        200 to 20000.
    pressure : array_like [Pa]
        > 0; broadcasts against `temperature`.
    nitrogen : float [1]
        Mole fraction of N2 in the cold gas, the rest O2. Of an element that is not there no species are.

    Returns
    -------
    ndarray [1]
        Shape of the broadcast arguments + (11,), species in the order of `species.SPECIES`.
    """
    temperature = within("temperature", temperature, *TEMPERATURE_RANGE, "K")
    pressure = positive("pressure", pressure, "Pa")
    temperature, pressure = np.broadcast_arrays(temperature, pressure)
    gibbs = standard_state("standard_gibbs_RT", temperature.ravel())
    standard = -gibbs - np.log(pressure.ravel() / REFERENCE_PRESSURE)[:, None]
    nitrogen = float(within("nitrogen", nitrogen, 0.0, 1.0, "1"))
    oxygen = oxygen_beside(nitrogen)
    mixed = nitrogen > 0 and oxygen > 0
    if not mixed:
        standard[:, (NITROGEN_ATOMS if nitrogen == 0 else OXYGEN_ATOMS) > 0] = -np.inf
    # Start: no element may exceed the amount it has as a molecule, as an atom or as an ion.
    potential = np.stack(
        [_smallest(standard, "N2", "N", 2 * nitrogen), _smallest(standard, "O2", "O", 2 * oxygen)], axis=-1
    )
    for _ in range(MAXIMUM_ITERATIONS):
        logarithm = _log_fractions(standard, potential)
        fraction = np.exp(logarithm)
        total = fraction.sum(axis=-1)
        residual = np.stack([np.log(total), np.zeros_like(total)], axis=-1)
        if mixed:
            atoms = fraction @ NITROGEN_ATOMS, fraction @ OXYGEN_ATOMS
            residual[:, 1] = np.log(atoms[0] / atoms[1]) - np.log(nitrogen / oxygen)
        if np.abs(residual).max() < RESIDUAL:
            return fraction.reshape(*temperature.shape, len(SPECIES))
        slope = _slopes(fraction)
        gradient = np.einsum("ps,pse->pe", fraction, slope) / total[:, None]
        if mixed:
            ratio = np.einsum("ps,pse->pe", fraction * NITROGEN_ATOMS, slope) / atoms[0][:, None]
            ratio -= np.einsum("ps,pse->pe", fraction * OXYGEN_ATOMS, slope) / atoms[1][:, None]
        else:  # the potential of the element that is not there stays
            ratio = np.broadcast_to([float(nitrogen == 0), float(oxygen == 0)], gradient.shape)
        step = np.linalg.solve(np.stack([gradient, ratio], axis=1), residual[..., None])[..., 0]
        potential = potential - np.clip(step, -LARGEST_STEP, LARGEST_STEP)
    raise ArithmeticError(f"composition did not converge in {MAXIMUM_ITERATIONS} iterations")


MAXIMUM_ITERATIONS = 200
LARGEST_STEP = 2.0  # in ln(fraction): keeps Newton's method inside the convex region
RESIDUAL = 1e-13  # on ln(sum of fractions) and ln(N/O)


def _smallest(standard, molecule, atom, amount):
    """Potential at which molecule and atom hold no more than `amount` of the element each; 0 for none."""
    if amount == 0:
        return np.zeros(len(standard))
    by_molecule = (np.log(amount / 2) - standard[:, SPECIES.index(molecule)]) / 2
    by_atom = np.log(amount) - standard[:, SPECIES.index(atom)]
    return np.minimum(by_molecule, by_atom)


def _log_fractions(standard, potential):
    """ln x (points, species); the potential of charge follows in closed form from neutrality."""
    logarithm = standard + potential[:, :1] * NITROGEN_ATOMS + potential[:, 1:] * OXYGEN_ATOMS
    ions = logarithm[:, CHARGE > 0]
    largest = ions.max(axis=1)
    positive_charge = largest + np.log(np.exp(ions - largest[:, None]).sum(axis=1))
    charge = (logarithm[:, SPECIES.index("e-")] - positive_charge) / 2
    return logarithm + charge[:, None] * CHARGE


def _slopes(fraction):
    """d ln x/d potential (points, species, element), neutrality kept."""
    atoms = np.stack([NITROGEN_ATOMS, OXYGEN_ATOMS], axis=-1)
    ions = CHARGE > 0
    share = fraction[:, ions] / np.maximum(fraction[:, ions].sum(axis=1), np.finfo(float).tiny)[:, None]
    charge = -(share @ atoms[ions]) / 2
    return atoms + CHARGE[:, None] * charge[:, None, :]


def number_density(temperature, pressure, nitrogen=AIR["N2"]):
    """Number densities [m-3] of a mixture of N2 and O2 in chemical equilibrium, :math:`n_s = x_s p / k T`.

    Arguments, shape and ValueError as of `composition`.
    """
    mole_fraction = composition(temperature, pressure, nitrogen)
    total = np.asarray(pressure) / (BOLTZMANN * np.asarray(temperature))
    return mole_fraction * np.broadcast_to(total, mole_fraction.shape[:-1])[..., None]


def species_enthalpy(temperature):
    """Enthalpy (..., 11) [J] of one particle of each species, formation (at 298.15 K) included.

    Source: NASA-9 polynomials, as `composition`; 200 to 20000 K.
    """
    temperature = within("temperature", temperature, *TEMPERATURE_RANGE, "K")
    return standard_state("standard_enthalpies_RT", temperature) * (BOLTZMANN * temperature)[..., None]


def species_heat_capacity(temperature):
    """Heat capacity (..., 11) [1] at constant pressure of each species, over the Boltzmann constant.

    5/2 for a particle without internal energy. Source: NASA-9 polynomials, as `composition`; 200 to 20000 K.
    """
    temperature = within("temperature", temperature, *TEMPERATURE_RANGE, "K")
    return standard_state("standard_cp_R", temperature)


def standard_state(name, temperature):
    """One molar standard-state property of `phase` by its Cantera name, shape of `temperature` + (11,)."""
    gas = phase()
    rows = np.empty((temperature.size, len(SPECIES)))
    for row, one in zip(rows, temperature.flat, strict=True):
        gas.TP = one, REFERENCE_PRESSURE
        row[:] = getattr(gas, name)
    return rows.reshape(*temperature.shape, len(SPECIES))


def composition_slope(temperature, mole_fraction, enthalpy):
    r"""Derivative of the equilibrium mole fractions with temperature, at constant pressure and elements.

    Equilibrium means :math:`\ln x_s = -g_s/kT + \sum_e a_{se}\pi_e`, with one potential per element
    (N, O, charge). Its derivative, with :math:`d(g/kT)/dT = -h/kT^2`, is

    .. math:: \frac{d\ln n_s}{dT} = \frac{h_s}{k T^2} + \sum_e a_{se}\frac{d\pi_e}{dT} + \frac{d\ln n}{dT}

    and the four unknown derivatives follow from the conservation of N, O and charge and from
    :math:`n = \sum n_s`.

    Source: S. Gordon, B. J. McBride, NASA RP-1311 (1994), section 2.5 (derivatives from the
    equilibrium solution), in the notation of element potentials.

    Parameters
    ----------
    temperature : ndarray [K]
        Any shape.
    mole_fraction : ndarray [1]
        Shape of `temperature` + (11,), from `composition`.
    enthalpy : ndarray [J]
        Same shape, from `species_enthalpy`.

    Returns
    -------
    tuple of ndarray [K-1]
        dx/dT, shape of `mole_fraction`; and d ln n/dT of the number of particles of a fixed mass,
        shape of `temperature`.
    """
    temperature = np.asarray(temperature, dtype=float)
    # The charge row is scaled by the charged fraction, else it underflows in cold air.
    charged = np.maximum(mole_fraction @ np.abs(CHARGE), np.finfo(float).tiny)
    elements = np.stack([NITROGEN_ATOMS, OXYGEN_ATOMS, CHARGE, np.ones(len(SPECIES))])
    slope = enthalpy / (BOLTZMANN * temperature**2)[..., None]
    matrix = np.einsum("es,...s,fs->...ef", elements, mole_fraction, elements)
    matrix[..., -1, -1] = 0.0  # the row of the total: sum n dln(n_s) = n dln(n)
    for element in (0, 1):  # the potential of one that is not there does not change
        matrix[..., element, element] += matrix[..., element, element] == 0
    right = -np.einsum("es,...s,...s->...e", elements, mole_fraction, slope)
    scale = np.ones(matrix.shape[:-1])
    scale[..., 2] = 1 / np.sqrt(charged)
    matrix = matrix * scale[..., :, None] * scale[..., None, :]
    solution = np.linalg.solve(matrix, (right * scale)[..., None])[..., 0] * scale
    logarithmic = slope + solution[..., :3] @ elements[:3]  # d ln x
    return mole_fraction * logarithmic, solution[..., -1]


def density(temperature, pressure, mole_fraction):
    """Density (...) [kg m-3] of an ideal mixture (..., 11), rho = p m / k T with the mean mass m."""
    return pressure * (mole_fraction @ MASS) / (BOLTZMANN * temperature)


def enthalpy(mole_fraction, species_enthalpy):
    """Specific enthalpy (...) [J kg-1] of a mixture (..., 11), zero for cold air at 298.15 K.

    `species_enthalpy` (..., 11) [J] per particle.
    """
    return np.sum(mole_fraction * species_enthalpy, axis=-1) / (mole_fraction @ MASS)


def heat_capacity(temperature, mole_fraction, species_enthalpy, species_heat_capacity):
    r"""Equilibrium specific heat [J kg-1 K-1] at constant pressure, dh/dT with the composition following.

    .. math:: c_p = \Big[\sum_s x_s c_s + \sum_s x_s h_s \frac{d\ln n_s}{dT}\Big] \Big/ \sum_s x_s m_s

    Per particle, enthalpy [J] and heat capacity over k [1] of the species (..., 11). Source: S. Gordon, B. J.
    McBride, NASA RP-1311 (1994), section 2.5. Deviation: Cantera's own heat capacity is the frozen one, the
    first term.
    """
    slope, total = composition_slope(temperature, mole_fraction, species_enthalpy)
    amount = slope + mole_fraction * np.asarray(total)[..., None]
    frozen = np.sum(mole_fraction * species_heat_capacity, axis=-1) * BOLTZMANN
    return (frozen + np.sum(amount * species_enthalpy, axis=-1)) / (mole_fraction @ MASS)
