"""Surface temperature of a sample after injection into the plasma."""

import numpy as np

from plasmapyro.checks import positive


def step_response(time, initial_temperature, gain, natural_frequency):
    r"""Step response of a critically damped second-order system.

    .. math:: T_{obj}(t) = T_0 + g\,[1 - (1 + \omega_0 t)\,e^{-\omega_0 t}] \quad (t > 0)

    and :math:`T_0` before.

    Source: Fagnani et al., eq. 11, there with T_0 = 350 K, g = 1250 K, omega_0 = 0.1 s-1.

    ValueError if a parameter is not > 0.

    Parameters
    ----------
    time : (...) array [s], 0 at injection
    initial_temperature : float [K], > 0
    gain : float [K], > 0
    natural_frequency : float [s-1], > 0

    Returns
    -------
    (...) ndarray [K]

    Examples
    --------
    Steady at 1600 K after 80 s, as the paper says of these values:

    >>> f"{step_response(80.0, 350.0, 1250.0, 0.1):.1f} K"
    '1596.2 K'
    """
    start = float(positive("initial_temperature", initial_temperature, "K"))
    gain = float(positive("gain", gain, "K"))
    phase = float(positive("natural_frequency", natural_frequency, "s-1")) * np.maximum(time, 0.0)
    return start + gain * (1 - (1 + phase) * np.exp(-phase))
