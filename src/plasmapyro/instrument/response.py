"""Modelled spectral responses of a two-colour pyrometer with a layered silicon detector."""

import numpy as np

from plasmapyro.checks import increasing, positive, within


def silicon_absorption(wavelength, table_wavelength, table_coefficient):
    r"""Absorption coefficient (...) [m-1] of silicon between the points (N,) of a table.

    Monotone cubic interpolation of :math:`\ln\alpha(\lambda)`: the coefficient falls by four decades over the
    bands, and its logarithm is smooth. ValueError if a wavelength lies outside the table (no extrapolation)
    or the table is not as stated.
    """
    from scipy.interpolate import PchipInterpolator

    nodes = increasing("table_wavelength", table_wavelength, "m")
    coefficient = positive("table_coefficient", table_coefficient, "m-1")
    wavelength = within("wavelength", wavelength, nodes[0], nodes[-1], "m")
    return np.exp(PchipInterpolator(nodes, np.log(coefficient))(wavelength))


def layered_efficiency(absorption_coefficient, top_thickness, bottom_thickness):
    r"""Share [1] of the entering photons that each layer of a sandwich detector absorbs, top and bottom.

    .. math:: \eta_1 = 1 - e^{-\alpha d_1}, \qquad \eta_2 = e^{-\alpha d_1}\,(1 - e^{-\alpha d_2})

    The top layer takes the short wavelengths; the bottom layer sees what the top layer lets through. Source:
    Beer-Lambert. ASSUME: every absorbed photon is collected in its layer, one pass, no reflection between the
    layers, no dependence of the surface reflectance on wavelength.
    """
    alpha = positive("absorption_coefficient", absorption_coefficient, "m-1")
    top = float(positive("top_thickness", top_thickness, "m"))
    bottom = float(positive("bottom_thickness", bottom_thickness, "m"))
    return -np.expm1(-alpha * top), -np.exp(-alpha * top) * np.expm1(-alpha * bottom)


def long_pass(wavelength, edge, edge_sigma):
    r"""Transmittance (...) [1] of a long-pass filter with an error-function edge.

    .. math:: \tau = \tfrac12\,[1 + \mathrm{erf}((\lambda - \lambda_e) / \sqrt2\,\sigma_e)]

    where half is transmitted at the edge [m]; 10 % to 90 % takes 2.56 of its standard deviation `edge_sigma`
    [m].
    """
    from scipy.special import ndtr

    edge = float(positive("edge", edge, "m"))
    return ndtr((np.asarray(wavelength, dtype=float) - edge) / float(positive("edge_sigma", edge_sigma, "m")))


def sandwich_response(
    wavelength, absorption_coefficient, *, top_thickness, bottom_thickness, edge, edge_sigma
):
    r"""Normalised responses (W,) [1], wide and narrow, to radiant power of the two layers behind a filter.

    .. math:: \tilde R_i \propto \tau(\lambda)\,\lambda\,\eta_i(\lambda), \qquad \max \tilde R_i = 1

    with the long-pass filter of `long_pass` and the layers of `layered_efficiency`, all lengths in [m].
    ValueError if a layer receives no light at all.

    Source: Fagnani et al., sec. 3.2 (sandwich silicon detector). Deviation: they use the maker's curves,
    which appear only in a figure; these are modelled. The factor wavelength turns photons into power: the
    current per watt is :math:`e \lambda \eta / h c`.
    """
    filtered = np.asarray(wavelength, dtype=float) * long_pass(wavelength, edge, edge_sigma)
    layers = layered_efficiency(absorption_coefficient, top_thickness, bottom_thickness)
    wide, narrow = (filtered * efficiency for efficiency in layers)
    for layer, curve in (("top", wide), ("bottom", narrow)):
        if not curve.max() > 0:
            raise ValueError(
                f"the {layer} layer receives no light: thinner layers or longer wavelengths needed;"
                f" got {top_thickness:g} and {bottom_thickness:g} m"
            )
    return wide / wide.max(), narrow / narrow.max()
