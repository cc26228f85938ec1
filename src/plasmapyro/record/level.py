"""The level of the signals of a two-colour pyrometer against the temperature that their ratio tells."""

import numpy as np

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.instrument.pyrometer import blackbody_signals

EFFECTIVE = 1.0e-6  # [m] wavelength of silicon detectors for the slope of Planck's law
WIDEST = 1.5  # factor between emittances that no uncertainty needs to explain
FAR = 3.0  # combined standard uncertainties
NODES = 500  # of a table of black bodies
MOST = 0.5  # of the samples: beyond, it is the level of the test that is unlike, no sample's own


def emittance_of_level(signals, kelvin, uncertainty, attributes, calibration, response):
    r"""Emittance that signals ask for at the temperature of their ratio, and its relative uncertainty.

    .. math:: \varepsilon_i = \frac{S_i}{k_i S_i^{bb}(T)}, \qquad
              u^2 = \left(\frac{c_2}{\lambda T^2} u_T\right)^2 + (u_\varepsilon/\varepsilon)^2

    Parameters
    ----------
    signals : (2, t) array [A], of the surface
    kelvin, uncertainty : (t,) arrays [K]
    attributes : of the test
    calibration, response : Datasets of these contracts

    Returns
    -------
    asked : (2, t) ndarray [1]
    relative : (t,) ndarray [1]
    """
    sensitivity = calibration.absolute_sensitivity.values[:, None]
    asked = signals / (sensitivity * _black(kelvin, response))
    of_emittance = attributes["emittance_uncertainty"] / attributes["emittance"]
    return asked, np.hypot(SECOND_RADIATION / EFFECTIVE * uncertainty / kelvin**2, of_emittance)


def _black(kelvin, response):
    """Signals (2, t) of black bodies; of a long record from a table, in which ln S is a spline of 1/T.

    An integral over all wavelengths for each of two million samples takes a minute and more.
    """
    if kelvin.size <= NODES:
        return blackbody_signals(kelvin, response)
    from scipy.interpolate import CubicSpline

    node = np.linspace(0.999 / kelvin.max(), 1.001 / kelvin.min(), NODES)
    return np.exp(CubicSpline(node, np.log(blackbody_signals(1 / node, response)), axis=1)(1 / kelvin))


def leeway(relative, attributes, limit=FAR):
    """By how much the logarithm of an asked emittance may differ from that of the stated one.

    ASSUME: what stands in the light of the test may have stood in that of the calibration, or not.
    """
    return np.maximum(limit * relative, np.log(WIDEST)) - np.log(attributes["window_transmittance_pyrometer"])


def unlike_level(signals, kelvin, uncertainty, attributes, calibration, response):
    """Samples (t,) whose level is no light of the temperature of their ratio: a zero left in, a lamp.

    None where most are so: then window, gain or unit are of another test, as `quality` says. Arguments as of
    `emittance_of_level`.
    """
    unlike = np.zeros(kelvin.size, dtype=bool)
    known = np.flatnonzero(np.isfinite(kelvin) & np.isfinite(uncertainty) & (signals > 0).all(axis=0))
    rest = attributes, calibration, response
    asked, relative = emittance_of_level(signals[:, known], kelvin[known], uncertainty[known], *rest)
    off = np.abs(np.log(asked / attributes["emittance"]))
    unlike[known] = (off > leeway(relative, attributes)).any(axis=0)
    return unlike if unlike.sum() <= MOST * known.size else np.zeros_like(unlike)
