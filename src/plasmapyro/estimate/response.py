"""What signals owe to errors of a stated response that its calibration has not absorbed, over temperature."""

import numpy as np

from plasmapyro.estimate.instrument import TABLE_POINTS, TABLE_TEMPERATURES, from_straight
from plasmapyro.instrument.scale import scale_modes
from plasmapyro.radiation.planck import blackbody_derivatives

SHIFT = 0.5e-9  # [m] step of the derivative by the place of a response
# ASSUME: signals go as the light to the power of 1 within that, 0.12 % per decade. The response of a silicon
# diode keeps within 1 % over five decades of irradiance (J. Res. NIST 96, 143 (1991)); 1 % / sqrt(3) / 5.
LINEARITY = 5e-4  # [1]


class ResponseErrors:
    r"""D_ik(T), change of ln(signal) of band i per unit of error k, less its mean over the calibration.

    Between nodes of 1/T it is straight: a hundredth of it is what matters.
    """

    def __init__(self, change, seen, black, points):
        """`change`: of instruments and T (N,) [K] -> D (N, C, K); `seen`, `black`: those before the surface,
        and before the black body of the calibration, whose bands (C,) saw the `points` (P, C) [K]."""
        low, high = TABLE_TEMPERATURES
        self._inverse = np.linspace(1 / high, 1 / low, TABLE_POINTS)
        absorbed = [change(black, column)[:, band].mean(axis=0) for band, column in enumerate(points.T)]
        self._values = change(seen, 1 / self._inverse) - np.stack(absorbed)
        self.temperatures, self.number = TABLE_TEMPERATURES, self._values.shape[-1]

    def __call__(self, temperature):
        """D (n, C, K), and its derivative by the temperatures (n,) [K]."""
        inverse, nodes = 1 / np.asarray(temperature, dtype=float), self._inverse
        step = nodes[1] - nodes[0]
        piece = ((inverse - nodes[0]) / step).astype(int).clip(0, nodes.size - 2)
        rise = (self._values[piece + 1] - self._values[piece]) / step
        inverse = inverse[:, None, None]
        away = inverse - nodes[piece][:, None, None]
        return self._values[piece] + away * rise, -(inverse**2) * rise


class InverseErrors:
    """`ResponseErrors` over x of `instrument.InverseTable`."""

    def __init__(self, errors):
        self._errors = errors

    def __call__(self, x):
        """D (n, C, K), and its derivative by x (n,)."""
        kelvin, slope = from_straight(np.asarray(x, dtype=float))
        value, first = self._errors(np.clip(kelvin, *self._errors.temperatures))
        return value, first * slope[:, None, None]


def of_place(seen, black, points):
    """`ResponseErrors` per metre by which each band lies further to the red.

    `seen`, `black`: pairs of instruments, as they are and moved by `SHIFT`.
    """

    def change(pair, kelvin):
        plain, moved = (_signals(one, kelvin) for one in pair)
        return np.log(moved / plain)[:, :, None] / SHIFT * np.eye(plain.shape[1])

    return ResponseErrors(change, seen, black, points)


def of_course(seen, black, points):
    """`ResponseErrors` per standard deviation of modes, own ones of each band, of it over wavelength.

    ASSUME: it was measured against a detector that is as well known as a lamp, see `instrument.scale`.
    """
    modes = scale_modes(seen.wavelength)
    bands, number = len(seen.weight), modes.shape[1]

    def change(instrument, kelvin):
        light = _light(instrument, kelvin)
        mean = np.einsum("cb,nb,bm->ncm", instrument.weight, light, modes)
        mean /= _signals(instrument, kelvin)[:, :, None]
        found = np.zeros((len(kelvin), bands, bands, number))
        found[:, np.arange(bands), np.arange(bands)] = mean
        return found.reshape(len(kelvin), bands, bands * number)

    return ResponseErrors(change, seen, black, points)


def of_linearity(seen, black, points):
    """`ResponseErrors` per power of the signal by which a band is not linear."""

    def change(instrument, kelvin):
        logarithm = np.log(_signals(instrument, kelvin))
        return logarithm[:, :, None] * np.eye(logarithm.shape[1])

    return ResponseErrors(change, seen, black, points)


def _light(instrument, kelvin):
    return blackbody_derivatives(instrument.wavelength, np.asarray(kelvin)[:, None])[0]


def _signals(instrument, kelvin):
    return instrument.detect(_light(instrument, kelvin))
