"""The gas that the sample itself reflects into the instrument."""

from plasmapyro.checks import non_negative, within


def reflected(emittance, specular, diffuse, roughness):
    r"""What an opaque surface returns of the gas that lights it.

    .. math:: (1 - \varepsilon)\,[(1 - m)\, L^{g,s}_{specular} + m\, L^{g,s}_{diffuse}]

    Source: Fagnani et al., eq. 2, third term, :math:`(1-\varepsilon) L^{g,s}`;
    Modest, Radiative Heat Transfer, 3rd ed., chapters 1 and 5 (diffuse plus specular reflectance).
    ASSUME: the gas in front absorbs nothing on the way back, as the paper does.

    ValueError if an argument is outside its range.

    Parameters
    ----------
    emittance : (...) [1], 0 to 1; opaque, so that the reflectance is the rest
    specular, diffuse : (...) arrays of one unit (radiance or band signal), >= 0
        Of the mirrored ray, and the mean over the hemisphere weighted with the cosine.
    roughness : (...) [1], share m of the diffuse part: 0 for a mirror, 1 for a matt surface

    Returns
    -------
    (...) ndarray, the unit of the incident light; 0 for emittance 1

    Examples
    --------
    A sample of emittance 0.85, half rough, in light of 2 from the mirrored ray and 10 from all around:

    >>> f"{reflected(0.85, 2.0, 10.0, 0.5):.2f}"
    '0.90'
    """
    emittance = within("emittance", emittance, 0, 1, "1")
    roughness = within("roughness", roughness, 0, 1, "1")
    specular = non_negative("specular", specular, "W m-2 sr-1")
    diffuse = non_negative("diffuse", diffuse, "W m-2 sr-1")
    return (1 - emittance) * ((1 - roughness) * specular + roughness * diffuse)
