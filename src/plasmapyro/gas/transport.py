"""Transport coefficients of the eleven-species air plasma: Chapman-Enskog method.

Arrays of points: `temperature` (points,) [K]; `mole_fraction` (points, 11) [1] in the order of
`species.SPECIES`; `polarisation` a (points, 10) [W m-1 K-1] of `energy_polarisation`, the conductivity of
each heavy species, screened by the others; `diffusion` n D (points, 11, 11) [m-1 s-1]; `integrals` of
`collisions`; coefficients (points,).
"""

import numpy as np

from plasmapyro.constants import BOLTZMANN, ELECTRON_MASS, ELEMENTARY_CHARGE
from plasmapyro.gas.species import CHARGE, ELECTRON, HEAVY, MASS

HEAVY_MASS = MASS[HEAVY]
MASS_SUM = HEAVY_MASS[:, None] + HEAVY_MASS
REDUCED_MASS = HEAVY_MASS[:, None] * HEAVY_MASS / MASS_SUM


def pair_viscosity(temperature, q22):
    r"""Viscosity (points, 10, 10) [Pa s] of an imaginary gas of each pair of heavy species; q22 [m2].

    .. math:: \mu_{ij} = \frac{5}{16}\frac{\sqrt{2\pi m_{ij} k T}}{Q^{(2,2)}_{ij}},
              \quad m_{ij} = \frac{m_i m_j}{m_i + m_j}

    Source: Hirschfelder, Curtiss & Bird (1954), eq. 8.2-21.
    """
    return 5 / 16 * np.sqrt(2 * np.pi * REDUCED_MASS * BOLTZMANN * temperature[:, None, None]) / q22


def viscosity(temperature, mole_fraction, integrals):
    r"""Viscosity [Pa s] of the mixture, first Chapman-Enskog approximation.

    .. math:: \mu = \sum_i x_i \alpha_i, \qquad \sum_j H_{ij}\alpha_j = x_i

    .. math:: H_{ii} = \frac{x_i^2}{\mu_i} + \sum_{k \ne i}\frac{2 x_i x_k}{\mu_{ik}}
              \frac{m_i m_k}{(m_i+m_k)^2}\Big(\frac{5}{3A^*_{ik}} + \frac{m_k}{m_i}\Big), \quad
              H_{ij} = -\frac{2 x_i x_j}{\mu_{ij}}\frac{m_i m_j}{(m_i+m_j)^2}\Big(\frac{5}{3A^*_{ij}} - 1\Big)

    Source: Hirschfelder, Curtiss & Bird (1954), eqs. 8.2-22 to 25. Each row is divided by its mole
    fraction, so that absent species do no harm. The electrons carry no momentum worth mention.
    """
    x = mole_fraction[:, HEAVY]
    base = 2 / pair_viscosity(temperature, integrals.q22) * (REDUCED_MASS / MASS_SUM)
    ratio = HEAVY_MASS / HEAVY_MASS[:, None]  # m_j / m_i at (i, j)
    off_diagonal = -base * (5 / (3 * integrals.astar) - 1) * x[:, None, :]
    exchange = base * (5 / (3 * integrals.astar) + ratio) * x[:, None, :]
    matrix = _assemble(off_diagonal, exchange, x / _diagonal(pair_viscosity(temperature, integrals.q22)))
    return np.einsum("pi,pi->p", x, _solve(matrix, np.ones_like(x)))


def energy_polarisation(temperature, mole_fraction, integrals):
    r"""Response a (points, 10) [W m-1 K-1] of the heavy species to a temperature gradient, second order.

    .. math:: \sum_j L_{ij} a_j = 4 x_i

    .. math:: L_{ii} = \frac{4x_i^2}{\lambda_i} + \sum_{k \ne i} 2 x_i x_k
              \frac{\tfrac{15}{2}m_i^2 + \tfrac{25}{4}m_k^2 - 3 m_k^2 B^*_{ik} + 4 m_i m_k A^*_{ik}}
              {(m_i+m_k)^2 A^*_{ik}\lambda_{ik}}, \quad
              L_{ij} = -\frac{2 x_i x_j m_i m_j}{(m_i+m_j)^2 A^*_{ij}\lambda_{ij}}
              \Big(\tfrac{55}{4} - 3B^*_{ij} - 4A^*_{ij}\Big)

    with :math:`\lambda_{ij} = \tfrac{15}{4} k \mu_{ij} / 2m_{ij}`.

    Source: Muckenfuss & Curtiss, J. Chem. Phys. 29 (1958) 1273; Hirschfelder, Curtiss & Bird (1954),
    eqs. 8.2-36 to 40.
    """
    x = mole_fraction[:, HEAVY]
    pair = 15 / 4 * BOLTZMANN * pair_viscosity(temperature, integrals.q22) / (2 * REDUCED_MASS)
    astar, bstar = integrals.astar, integrals.bstar
    own, other = HEAVY_MASS[:, None] ** 2, HEAVY_MASS**2
    product = HEAVY_MASS[:, None] * HEAVY_MASS
    base = 2 / (MASS_SUM**2 * astar * pair)
    off_diagonal = -base * product * (55 / 4 - 3 * bstar - 4 * astar) * x[:, None, :]
    exchange = base * (7.5 * own + 6.25 * other - 3 * other * bstar + 4 * product * astar) * x[:, None, :]
    matrix = _assemble(off_diagonal, exchange, 4 * x / _diagonal(pair))
    return _solve(matrix, np.full_like(x, 4.0))


def heavy_conductivity(mole_fraction, polarisation):
    r"""Translational thermal conductivity [W m-1 K-1] of the heavy species, :math:`\lambda = \sum_i x_i a_i`.

    Source: Hirschfelder, Curtiss & Bird (1954), eq. 8.2-33 with the diffusive part left out, which
    `reactive_conductivity` holds.
    """
    return np.einsum("pi,pi->p", mole_fraction[:, HEAVY], polarisation)


def thermal_diffusion_ratio(mole_fraction, polarisation, diffusion, integrals):
    r"""Thermal diffusion ratios (points, 11) [1] of the heavy species over their mole fractions.

    .. math:: \frac{\chi_i}{x_i} = \frac{1}{10k}\sum_{j \ne i}
              \frac{x_j (12 C^*_{ij} - 10)}{n D_{ij}}\,\frac{m_i a_j - m_j a_i}{m_i + m_j}

    A positive ratio drives a species to the cold side; 0 for electrons, whose thermal diffusion only changes
    the field that keeps the current zero (ASSUME). Source: Magin & Degrez, J. Comput. Phys. 198 (2004) 424
    (heavy-particle thermal diffusion ratios); for two species the same as Hirschfelder, Curtiss & Bird
    (1954), eq. 8.2-50.
    """
    strength = (12 * integrals.cstar - 10) * mole_fraction[:, None, HEAVY] / diffusion[:, HEAVY, HEAVY]
    share = HEAVY_MASS[:, None] * polarisation[:, None, :] - HEAVY_MASS * polarisation[:, :, None]
    ratio = np.zeros_like(mole_fraction)
    ratio[:, HEAVY] = np.sum(strength * share / MASS_SUM, axis=2) / (10 * BOLTZMANN)
    return ratio


def _diagonal(matrix):
    return np.einsum("pii->pi", matrix)


def _assemble(off_diagonal, exchange, own):
    """Matrix with the pair terms off and their exchange sums on the diagonal (points, n, n)."""
    matrix = off_diagonal.copy()
    # A pair of a species with itself is not a term of the sums over k != i.
    index = np.arange(matrix.shape[1])
    matrix[:, index, index] = own + exchange.sum(axis=2) - _diagonal(exchange)
    return matrix


def _solve(matrix, right):
    return np.linalg.solve(matrix, right[..., None])[..., 0]


def diffusion(temperature, heavy, electron):
    r"""Binary diffusion coefficients times the number density, first approximation.

    .. math:: n D_{ij} = \frac{3}{16}\frac{\sqrt{2\pi k T / m_{ij}}}{Q^{(1,1)}_{ij}}

    Infinite between electrons (no friction). Source: Hirschfelder, Curtiss & Bird (1954), eq. 8.2-44.
    """
    result = np.full((temperature.size, ELECTRON + 1, ELECTRON + 1), np.inf)
    thermal = 2 * np.pi * BOLTZMANN * temperature
    result[:, HEAVY, HEAVY] = 3 / 16 * np.sqrt(thermal[:, None, None] / REDUCED_MASS) / heavy.q11
    reduced = ELECTRON_MASS * HEAVY_MASS / (ELECTRON_MASS + HEAVY_MASS)
    with_electrons = 3 / 16 * np.sqrt(thermal[:, None] / reduced) / electron.q11
    result[:, HEAVY, ELECTRON] = result[:, ELECTRON, HEAVY] = with_electrons
    return result


def internal_conductivity(mole_fraction, heat_capacity, diffusion):
    r"""Thermal conductivity [W m-1 K-1] by internal energy of the heavy species (Eucken's correction).

    .. math:: \lambda_{int} = \sum_i \frac{x_i (c_i/k - 5/2) k}{\sum_j x_j / (n D_{ij})}

    with the heat capacities c (points, 11) of a particle at constant pressure, given over k. Source:
    Hirschfelder, J. Chem. Phys. 26 (1957) 282. ASSUME: internal energy diffuses with the particle (elastic D,
    no inelastic correction); that includes electronic energy of atoms.
    """
    x = mole_fraction[:, HEAVY]
    resistance = np.einsum("pj,pij->pi", x, 1 / diffusion[:, HEAVY, HEAVY])
    return BOLTZMANN * np.sum(x * (heat_capacity[:, HEAVY] - 2.5) / resistance, axis=1)


def diffusion_matrix(mole_fraction, diffusion):
    r"""Number fluxes (points, 11, 11) [m-1 s-1] per driving force, without electric current.

    Solves the Stefan-Maxwell equations for :math:`F_i = \sum_j M_{ij} d_j`:

    .. math:: \sum_j \frac{x_i F_j - x_j F_i}{D_{ij}} = d_i - \frac{q_i x_i}{kT} E, \quad
              \sum_i m_i F_i = 0, \quad \sum_i q_i F_i = 0

    Source: Magin & Degrez, J. Comput. Phys. 198 (2004) 424 (Stefan-Maxwell system).

    Driving forces are gradients of the mole fractions, which must add up to zero.
    """
    size = mole_fraction.shape[1]
    matrix = _stefan_maxwell(mole_fraction, diffusion)
    return np.linalg.solve(matrix, np.eye(size + 1)[:, :size])[:, :size]


def _stefan_maxwell(mole_fraction, diffusion):
    """Matrix (points, 12, 12) of the equations of `diffusion_matrix`; the last unknown is the field."""
    points, size = mole_fraction.shape
    resistance = 1 / diffusion
    matrix = np.zeros((points, size + 1, size + 1))
    pairs = mole_fraction[:, :, None] * resistance
    matrix[:, :size, :size] = pairs
    index = np.arange(size)
    friction = np.einsum("pj,pij->pi", mole_fraction, resistance) - mole_fraction * _diagonal(resistance)
    matrix[:, index, index] = -friction
    # The equations add up to 0 = 0; the mass balance, weighted with x, makes them independent.
    scale = friction.mean(axis=1)
    matrix[:, :size, :size] -= (scale[:, None] * mole_fraction)[:, :, None] * (MASS / MASS.max())
    # The unknown is E x_e/kT, which stays of order one where nothing is ionised.
    electrons = np.maximum(mole_fraction[:, ELECTRON], np.finfo(float).tiny)
    matrix[:, :size, size] = scale[:, None] * CHARGE * mole_fraction / electrons[:, None]
    matrix[:, ELECTRON, size] = -scale  # also where there is no electron at all
    matrix[:, size, :size] = CHARGE * scale[:, None]
    return matrix


def reactive_conductivity(temperature, mole_fraction, slope, enthalpy, diffusion, thermal_ratio):
    r"""Thermal conductivity [W m-1 K-1] by diffusion of the reacting species, without electric current.

    The species fluxes :math:`F_i = x_i V_i` per unit temperature gradient solve the Stefan-Maxwell
    equations with the driving force of the equilibrium composition, of thermal diffusion and of the
    electric field E that keeps the current zero:

    .. math:: \sum_j \frac{x_i F_j - x_j F_i}{D_{ij}} = \frac{dx_i}{dT} + \frac{\chi_i}{T}
              - \frac{q_i x_i}{kT} E, \quad
              \sum_i m_i F_i = 0, \quad \sum_i q_i F_i = 0

    .. math:: \lambda_r = -\sum_i n F_i \Big(h_i + kT\frac{\chi_i}{x_i}\Big)

    Source: Magin & Degrez, J. Comput. Phys. 198 (2004) 424 (Stefan-Maxwell system); the same heat flux as
    Butler & Brokaw, J. Chem. Phys. 26 (1957) 1636, except that theirs forbids the diffusion of
    elements. ASSUME: elements stay uniform (no demixing), as in the LTE code of the paper.

    `slope` dx/dT (points, 11) [K-1] at equilibrium and uniform elements; `enthalpy` (points, 11) [J] of
    a particle.
    """
    force = slope + mole_fraction * thermal_ratio / temperature[:, None]
    matrix = _stefan_maxwell(mole_fraction, diffusion)
    flux = _solve(matrix, np.concatenate([force, np.zeros((len(force), 1))], axis=1))[:, :-1]
    carried = enthalpy + BOLTZMANN * temperature[:, None] * thermal_ratio
    return -np.einsum("pi,pi->p", flux, carried)


def electron_matrix(mole_fraction, integrals):
    r"""Matrix (points, 3, 3) [m2] of the electron gas, order 3, over :math:`(64 x_e/75k)\sqrt{m_e/2\pi kT}`.

    Source: Devoto, Phys. Fluids 10 (1967) 2105 (elements q^mp), in the notation of Magin & Degrez, J. Comput.
    Phys. 198 (2004) 424: electrons are decoupled from heavy particles by their mass.
    """
    x, electrons = mole_fraction[:, HEAVY], mole_fraction[:, ELECTRON]

    def heavy(*weights):
        terms = zip(
            weights, (integrals.q11, integrals.q12, integrals.q13, integrals.q14, integrals.q15), strict=False
        )
        return np.einsum("pi,pi->p", x, sum(weight * q for weight, q in terms))

    own = np.sqrt(2) * electrons
    q22, q23, q24 = integrals.q22_electrons, integrals.q23_electrons, integrals.q24_electrons
    matrix = np.empty((electrons.size, 3, 3))
    matrix[:, 0, 0] = heavy(1)
    matrix[:, 0, 1] = matrix[:, 1, 0] = heavy(5 / 2, -3)
    matrix[:, 1, 1] = heavy(25 / 4, -15, 12) + own * q22
    matrix[:, 0, 2] = matrix[:, 2, 0] = heavy(35 / 8, -21 / 2, 6)
    matrix[:, 1, 2] = heavy(175 / 16, -315 / 8, 57, -30) + own * (7 / 4 * q22 - 2 * q23)
    matrix[:, 2, 1] = matrix[:, 1, 2]
    matrix[:, 2, 2] = heavy(1225 / 64, -735 / 8, 399 / 2, -210, 90) + own * (
        77 / 16 * q22 - 7 * q23 + 5 * q24
    )
    return matrix


def electron_conductivity(temperature, mole_fraction, integrals):
    r"""Thermal conductivity [W m-1 K-1] of the electrons, third approximation.

    .. math:: \lambda_e = \frac{75 k}{64}\sqrt{\frac{2\pi kT}{m_e}}
              \frac{x_e \Lambda_{22}}{\Lambda_{11}\Lambda_{22} - \Lambda_{12}^2}

    Source: Devoto, Phys. Fluids 10 (1967) 2105 (simplified expressions, third order).
    """
    matrix = electron_matrix(mole_fraction, integrals)
    share = matrix[:, 2, 2] / (matrix[:, 1, 1] * matrix[:, 2, 2] - matrix[:, 1, 2] ** 2)
    speed = np.sqrt(2 * np.pi * BOLTZMANN * temperature / ELECTRON_MASS)
    return 75 / 64 * BOLTZMANN * speed * mole_fraction[:, ELECTRON] * share


def electrical_conductivity(temperature, mole_fraction, integrals):
    r"""Electrical conductivity [S m-1], third approximation.

    .. math:: \sigma = \frac{n_e e^2}{kT}\,D_e, \qquad
              n D_e = \frac{3}{16}\sqrt{\frac{2\pi kT}{m_e}}\,(\Lambda^{-1})_{00}

    Source: Devoto, Phys. Fluids 10 (1967) 2105 (simplified expressions, third order). ASSUME: the current of
    the ions is neglected.
    """
    inverse = np.linalg.inv(electron_matrix(mole_fraction, integrals))[:, 0, 0]
    thermal = BOLTZMANN * temperature
    speed = np.sqrt(2 * np.pi * thermal / ELECTRON_MASS)
    return mole_fraction[:, ELECTRON] * ELEMENTARY_CHARGE**2 / thermal * 3 / 16 * speed * inverse
