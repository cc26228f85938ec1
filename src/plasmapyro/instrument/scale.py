"""How the scale of a spectrometer errs over wavelength: smoothly, as the noise of its pixels does not."""

import numpy as np

# [1] over each of two lengths, ASSUME: 1.1 % together. Lamps are certified to 1 to 2 % (k = 2), 0.5 to 1 % as
# a standard uncertainty; the rest is for the fit, orders and the transfer.
SCALE_ERROR = 0.008
SCALE_LENGTHS = 60e-9, 200e-9  # [m] over which that persists: as much of a wave as of a tilt
STEP = 10e-9  # [m] between knots, between which it is straight


def alike(apart, parts):
    """Covariance of the scale at channels that lie `apart` (C, C) [m], from lengths [m] and their shares."""
    return sum(share * np.exp(-0.5 * (apart / length) ** 2) for length, share in parts)


def scale_draws(wavelength, draws, generator):
    """Draws (draws, W) of the relative error of the scale at wavelengths (W,) [m]."""
    number = int(np.ceil(np.ptp(wavelength) / STEP)) + 1
    knots = wavelength.min() + STEP * np.arange(number)
    covariance = alike(np.subtract.outer(knots, knots), [(one, 1.0) for one in SCALE_LENGTHS])
    value, vector = np.linalg.eigh(covariance)
    root = vector * np.sqrt(np.maximum(value, 0.0))
    rows = SCALE_ERROR * generator.standard_normal((draws, number)) @ root.T
    return np.array([np.interp(wavelength, knots, row) for row in rows])
