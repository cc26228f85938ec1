"""Number densities from whatever a file gives of the composition."""

import numpy as np

from plasmapyro.constants import BOLTZMANN
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import IONS, SPECIES, TRACE_IONS, TRACES, particle_mass

UNDERSHOOT = 1e-6  # negative shares down to this are rounding of a solver, and 0
DENSITY_RTOL = 0.1  # between the density of the file and that of its species
SUM_RTOL = 1e-3  # by which shares may exceed 1


def equilibrium(temperature, pressure):
    """Species and number densities (species, n) [m-3] of air in LTE; see `gas.equilibrium`."""
    return list(SPECIES), number_density(temperature, pressure).T


def from_shares(quantity, values, *, temperature, electron_temperature, pressure, density, missing_share):
    r"""Number densities from given ones, from partial densities, or from mole or mass fractions.

    .. math:: n_s = x_s n, \qquad n_s = Y_s \rho / m_s \; \text{or} \; Y_s / m_s \; n / \sum_r Y_r/m_r,
              \qquad p = k (n_h T + n_e T_e)

    ValueError: negative values, shares that do not add up to 1, or species whose mass or pressure is not that
    of the gas: then a unit or a name is wrong.

    Parameters
    ----------
    quantity : 'number_density', 'molar_density' (in particles), 'partial_density', 'mole_fraction' or
        'mass_fraction'
    values : mapping of species -> ndarray (n,), SI
        Electrons that are not given follow from the charge of the ions.
    temperature, electron_temperature : ndarray (n,) [K]
        The second where electrons have their own, else None.
    pressure : ndarray (n,) [Pa]
    density : ndarray (n,) [kg m-3], or None
    missing_share : float
        Largest share of the gas that the species may not account for.

    Returns
    -------
    tuple : names, number densities (species, n) [m-3]
        All species of air, then the traces that are given; 0 for those that are not.
    """
    names = [*SPECIES, *(name for name in TRACES if name in values)]
    share = np.zeros((len(names), len(temperature)))
    for name, value in values.items():
        share[names.index(name)] = value
    scale = np.abs(share).max()
    if share.min() < -UNDERSHOOT * scale:
        row, point = np.unravel_index(share.argmin(), share.shape)
        raise ValueError(
            f"{quantity} of {names[row]} must be >= 0; got {share[row, point]:g} at point {point} of the path"
        )
    share = np.maximum(share, 0.0)
    mass = np.array([particle_mass(name) for name in names])[:, None]
    electron = names.index("e-")
    if "e-" not in values:
        charged = [names.index(name) for name in (*IONS, *TRACE_IONS) if name in names]
        per_particle = np.where(quantity in ("partial_density", "mass_fraction"), mass, 1.0)
        share[electron] = (share[charged] / per_particle[charged]).sum(axis=0) * per_particle[electron]
    _check_shares(quantity, share, missing_share)
    hot = temperature if electron_temperature is None else electron_temperature
    if quantity in ("number_density", "molar_density"):
        result = share
    elif quantity == "partial_density":
        result = share / mass
    elif quantity == "mole_fraction":
        result = share * _total(share[electron], temperature, hot, pressure)
    elif density is not None:
        result = share * density / mass
    else:
        moles = share / mass
        moles /= moles.sum(axis=0)
        result = moles * _total(moles[electron], temperature, hot, pressure)
    _check_state(result, electron, temperature, hot, pressure, density, mass, missing_share)
    return names, result


def _total(electron_share, temperature, electron_temperature, pressure):
    """Number density of all particles [m-3]."""
    mean = (1 - electron_share) * temperature + electron_share * electron_temperature
    return pressure / (BOLTZMANN * mean)


def _check_shares(quantity, share, missing_share):
    if not quantity.endswith("fraction"):
        return
    total = share.sum(axis=0)
    if total.min() < 1 - missing_share - SUM_RTOL or total.max() > 1 + SUM_RTOL:
        worst = total[np.abs(total - 1).argmax()]
        raise ValueError(
            f"{quantity} must add up to 1; the species named add up to {worst:.4g}: name those that are"
            f" missing, correct the unit, or raise species.missing_share (now {missing_share:g})"
        )


def _check_state(result, electron, temperature, hot, pressure, density, mass, missing_share):
    """Refuse species that do not make up the pressure, or the density, of the gas."""
    heavy = result.sum(axis=0) - result[electron]
    own = {"pressure": (BOLTZMANN * (heavy * temperature + result[electron] * hot), pressure, "Pa")}
    if density is not None:
        own["density"] = ((result * mass).sum(axis=0), density, "kg m-3")
    for name, (found, stated, unit) in own.items():
        low, high = 1 - DENSITY_RTOL - missing_share, 1 + DENSITY_RTOL
        ratio = found / stated
        point = int(np.abs(np.log(np.maximum(ratio, 1e-300))).argmax())
        if not low <= ratio[point] <= high:
            raise ValueError(
                f"the species make a {name} of {found[point]:.4g} {unit} where the file says"
                f" {stated[point]:.4g} {unit}: check the units and names of species, pressure, temperature"
                " and density"
            )
