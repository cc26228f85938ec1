"""How the scale of a spectrometer errs over wavelength: smoothly, as the noise of its pixels does not."""

import numpy as np

# [1] over each of two lengths, ASSUME: 1.1 % together. Lamps are certified to 1 to 2 % (k = 2), 0.5 to 1 % as
# a standard uncertainty; the rest is for the fit, orders and the transfer.
SCALE_ERROR = 0.008
SCALE_LENGTHS = 60e-9, 200e-9  # [m] over which that persists: as much of a wave as of a tilt
STEP = 10e-9  # [m] between knots, between which it is straight
LEAST = 1e-4  # variance of modes that are left out, of the largest


def alike(apart, parts):
    """Covariance of the scale at channels that lie `apart` (C, C) [m], from lengths [m] and their shares."""
    return sum(share * np.exp(-0.5 * (apart / length) ** 2) for length, share in parts)


def scale_modes(wavelength):
    """Modes (W, m) of the relative error of the scale at wavelengths (W,) [m], which rise: each times a
    standard normal number, by the eigenvectors of its covariance on knots."""
    number = int(np.ceil(np.ptp(wavelength) / STEP)) + 1
    knots = wavelength.min() + STEP * np.arange(number)
    covariance = alike(np.subtract.outer(knots, knots), [(one, 1.0) for one in SCALE_LENGTHS])
    value, vector = np.linalg.eigh(covariance)
    kept = value > LEAST * value.max()
    root = SCALE_ERROR * vector[:, kept] * np.sqrt(value[kept])
    return np.array([np.interp(wavelength, knots, column) for column in root.T]).T


def scale_draws(wavelength, draws, generator):
    """Draws (draws, W) of the relative error of the scale at wavelengths (W,) [m], which rise."""
    modes = scale_modes(wavelength)
    return generator.standard_normal((draws, modes.shape[1])) @ modes.T
