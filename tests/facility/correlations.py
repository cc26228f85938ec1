"""Published correlations of stagnation-point probes, to hold the computed stagnation line against."""

import numpy as np

from plasmapyro.checks import positive


def fay_riddell(
    *, edge_density, edge_viscosity, wall_density, wall_viscosity, gradient, enthalpy, prandtl=0.71,
    lewis=1.0, dissociation_share=0.0,
):  # fmt: skip
    r"""Heat flux of an equilibrium boundary layer at the stagnation point of a sphere.

    .. math:: q = 0.763\,Pr^{-0.6}(\rho_e\mu_e)^{0.4}(\rho_w\mu_w)^{0.1}\sqrt{\beta}\,(h_e - h_w)
              \Big[1 + (Le^{0.52} - 1)\frac{h_D}{h_e}\Big]

    Parameters
    ----------
    edge_density, wall_density : float [kg m-3]
    edge_viscosity, wall_viscosity : float [Pa s]
    gradient : float [s-1]
        beta, of the speed along the wall at the edge.
    enthalpy : float [J kg-1]
        h_e - h_w.
    prandtl, lewis : float [1]
    dissociation_share : float [1]
        h_D / h_e, enthalpy that recombination sets free over the whole.

    Returns
    -------
    float [W m-2]

    Notes
    -----
    Source: J. A. Fay, F. R. Riddell, J. Aeronaut. Sci. 25 (1958) 73, eq. 63.
    """
    positive("gradient", gradient, "s-1")
    layer = (edge_density * edge_viscosity) ** 0.4 * (wall_density * wall_viscosity) ** 0.1
    heat = 0.763 * prandtl**-0.6 * layer * np.sqrt(gradient) * enthalpy
    return heat * (1 + (lewis**0.52 - 1) * dissociation_share)


def goulard_factor(
    *, recombination, atom_speed, wall_density, edge_density, edge_viscosity, gradient, schmidt=0.5
):
    r"""Share of the diffusive heat flux of a frozen boundary layer that a catalytic wall receives.

    .. math:: \varphi = \Big[1 + \frac{0.47\,Sc^{-2/3}\sqrt{2\beta\rho_e\mu_e}}{\rho_w k_w}\Big]^{-1}, \qquad
              k_w = \frac{2\gamma}{2-\gamma}\sqrt{\frac{kT_w}{2\pi m}}

    Parameters
    ----------
    recombination : float [1]
        gamma, > 0.
    atom_speed : float [m s-1]
        sqrt(k T_w / 2 pi m) of the atoms.
    wall_density, edge_density : float [kg m-3]
    edge_viscosity : float [Pa s]
    gradient : float [s-1]
    schmidt : float [1]

    Returns
    -------
    float [1]

    Notes
    -----
    Source: R. Goulard, Jet Propulsion 28 (1958) 737, eq. 24, with 2/(2 - gamma) as in `catalysis`.
    """
    rate = wall_density * 2 * recombination / (2 - recombination) * atom_speed
    supply = 0.47 * schmidt ** (-2 / 3) * np.sqrt(2 * gradient * edge_density * edge_viscosity)
    return 1 / (1 + supply / positive("catalytic rate", rate, "kg m-2 s-1"))


def homann_factor(reynolds):
    r"""What friction adds to the stagnation pressure of a sphere: pressure over :math:`\rho U^2/2`.

    .. math:: C_p = 1 + \frac{6}{Re + 0.455\sqrt{Re}}

    Parameters
    ----------
    reynolds : float [1]
        With the radius of the sphere, > 0; the formula holds from some 10.

    Returns
    -------
    float [1]

    Notes
    -----
    Source: F. Homann, ZAMM 16 (1936) 153 (NACA TM 1334, 1952); P. L. Chambre, S. A. Schaaf, in Physical
    Measurements in Gas Dynamics and Combustion (Princeton, 1954) 111.
    """
    reynolds = positive("reynolds", reynolds, "1")
    return 1 + 6 / (reynolds + 0.455 * np.sqrt(reynolds))
