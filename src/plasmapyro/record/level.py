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


def leeway(relative, attributes, limit=FAR, instrument="pyrometer"):
    """By how much the logarithm of an asked emittance may differ from that of the stated one.

    ASSUME: what stands in the light of the test may have stood in that of the calibration, or not.
    """
    through = attributes[f"window_transmittance_{instrument}"]
    return np.maximum(limit * relative, np.log(WIDEST)) - np.log(through)


def unlike(off, allowed):
    """Samples (t,) whose level is no light of the temperature of their colour: a zero left in, a lamp.

    `off` (t,): logarithm of the emittance asked for over the stated one, NaN where it is not known; `allowed`
    (t,): see `leeway`. None where most are so: then window, gain or unit are of another test, as `quality`
    says, or the surface is another one.
    """
    far = np.abs(off) > allowed
    return far if far.sum() <= MOST * np.isfinite(off).sum() else np.zeros_like(far)


def unlike_level(signals, kelvin, uncertainty, attributes, calibration, response):
    """Samples (t,) of a pyrometer that are `unlike`. Arguments as of `emittance_of_level`."""
    off, allowed = np.full(kelvin.size, np.nan), np.zeros(kelvin.size)
    known = np.isfinite(kelvin) & np.isfinite(uncertainty) & (signals > 0).all(axis=0)
    rest = attributes, calibration, response
    asked, relative = emittance_of_level(signals[:, known], kelvin[known], uncertainty[known], *rest)
    off[known] = np.abs(np.log(asked / attributes["emittance"])).max(axis=0, initial=0.0)
    allowed[known] = leeway(relative, attributes)
    return unlike(off, allowed)


def kelvin_of(off, kelvin, wavelength=EFFECTIVE):
    r"""By how much [K] the temperature of a level differs from that of the colour, at most.

    .. math:: \Delta T = \frac{\lambda T^2}{c_2} \left|\ln\frac{\varepsilon}{\varepsilon_0}\right|

    Parameters
    ----------
    off : (t,) array [1], logarithm of the emittance asked for over the stated one
    kelvin : (t,) array [K]
    wavelength : float [m]

    Notes
    -----
    First order of Wien's law.
    """
    return np.abs(off) * wavelength * kelvin**2 / SECOND_RADIATION
