"""How much of what a band detects comes from the surface."""

import numpy as np

from plasmapyro.checks import fraction, non_negative, positive

BRACKET = (250.0, 6000.0)  # [K] where a temperature is looked for


def visibility_factor(object_signal, gas_signal):
    r"""Share of the surface in a band signal.

    .. math:: \nu_i = \frac{\int \tilde R_i\,\varepsilon L^{bb}(T_{obj})\,d\lambda}
                           {\int \tilde R_i\,[\varepsilon L^{bb}(T_{obj}) + L^{g,e}]\,d\lambda}

    Source: Fagnani et al., eq. 10 (after Sakuta & Boulos 1988). Deviation: the paper prints the
    integrals without the wavelength differential.

    ValueError if a signal is outside its range.

    Parameters
    ----------
    object_signal : (...) array [W m-2 sr-1]
        Band signal of the surface, emittance included, > 0.
    gas_signal : (...) array [W m-2 sr-1]
        Band signal of the gas along the line of sight, >= 0; broadcasts.

    Returns
    -------
    (...) ndarray [1], in (0, 1]

    Examples
    --------
    A surface nine times as bright as the gas in front of it:

    >>> float(visibility_factor(9.0, 1.0))
    0.9
    """
    object_signal = positive("object_signal", object_signal, "W m-2 sr-1")
    gas_signal = non_negative("gas_signal", gas_signal, "W m-2 sr-1")
    return object_signal / (object_signal + gas_signal)


def temperature_at_visibility(level, blackbody_signal, gas_signal, emittance):
    r"""Surface temperature at which the visibility factor reaches `level`.

    Solves :math:`\varepsilon B_i(T) = \frac{\nu}{1-\nu}\,G_i`, where :math:`B_i` is the blackbody band
    signal and :math:`G_i` that of the gas.

    Source: Fagnani et al., eq. 10 solved for the temperature, as in their fig. 7b.

    ValueError if an argument is outside its range.

    Parameters
    ----------
    level : float [1], in (0, 1)
    blackbody_signal : callable, temperature [K] -> band signal [W m-2 sr-1], increasing
    gas_signal : float [W m-2 sr-1], > 0
    emittance : float [1], in (0, 1]

    Returns
    -------
    float [K]; NaN if the level is not reached within `BRACKET`.
    """
    level = float(level)
    if not 0 < level < 1:
        raise ValueError(f"level must lie in (0, 1); got {level:g}")
    target = level / (1 - level) * float(positive("gas_signal", gas_signal, "W m-2 sr-1"))
    target /= fraction("emittance", emittance)

    def excess(temperature):
        return np.log(blackbody_signal(temperature) / target)

    if excess(BRACKET[0]) > 0 or excess(BRACKET[1]) < 0:
        return np.nan
    from scipy.optimize import brentq  # 0.4 s, which the other quantities of the analysis do not cost

    return brentq(excess, *BRACKET, xtol=1e-6, rtol=1e-12)
