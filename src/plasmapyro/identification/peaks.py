"""Peaks of a spectrum: where they are, how strong, how wide, and what would not have been seen."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import (
    gaussian_filter1d,
    maximum_filter1d,
    minimum_filter1d,
    percentile_filter,
    uniform_filter1d,
)

DETECTED = 5.0  # standard deviations of a peak
NOISE_WINDOW = 151  # channels
DEAD_WINDOW = 15  # channels, of which a third at the lowest value are clipped
SMOOTH = np.array([1.0, 2.0, 1.0]) / 4
SMOOTH_GAIN = np.sqrt(2)  # of third differences of noise that was smoothed so: sums of squares 12/16 and 6/16
WING = 25  # channels to either side within which a peak must stand out


@dataclass(frozen=True)
class Peaks:
    """Peaks (P,) of a spectrum (N,) and the least one that would have been found in each channel.

    Attributes
    ----------
    axis : ndarray (N,) [m]
    above : ndarray (N,)
        Signal above what is broad.
    limit : ndarray (N,)
        Light of a line below which it would not stand out, in units of `light`; infinite where a record is
        clipped and tells nothing.
    slit : ndarray (N,) [m]
        Full width at half maximum of a sharp line.
    wavelength : ndarray (P,) [m]
    light : ndarray (P,)
        Height times width over the width of a sharp line.
    width : ndarray (P,) [m]
    snr : ndarray (P,) [1]
    """

    axis: np.ndarray
    above: np.ndarray
    limit: np.ndarray
    slit: np.ndarray
    wavelength: np.ndarray
    light: np.ndarray
    width: np.ndarray
    snr: np.ndarray


def noise_of(signal, gain=20**0.5):
    """Standard deviation (N,) of the noise of a spectrum, from its third differences around each channel.

    The lower quartile of their size is taken: lines make them larger in few channels. A record that was
    clipped at zero is given that of the channels around. `gain`: rms of the third differences of noise over
    that of the noise, the root of 20 if it is independent.
    """
    third = np.abs(np.convolve(signal, [1, -3, 3, -1], mode="same"))
    third[:2] = third[-2:] = np.median(third)
    quartile = percentile_filter(third, 25, NOISE_WINDOW)  # of |normal|: 0.3186 sigma
    sigma = gaussian_filter1d(quartile, NOISE_WINDOW / 4) / (0.3186 * gain)
    if not (third > 0).any():
        raise ValueError("the spectrum is flat: there is nothing to name")
    typical = np.median(sigma[sigma > 0]) if (sigma > 0).any() else third.max()
    return np.maximum(sigma, 0.3 * typical)


def find(axis, signal, noise=None, slit=None):
    """Peaks of a spectrum.

    Parameters
    ----------
    axis : ndarray (N,) [m]
        Wavelengths in air, ascending.
    signal : ndarray (N,)
        In any unit that is proportional to spectral radiance.
    noise : ndarray (N,), optional
        Standard deviation of the signal; from its own scatter by default.
    slit : float [m], optional
        Full width at half maximum of a line; that of the sharpest quarter of the peaks by default.

    Returns
    -------
    Peaks
    """
    signal = np.asarray(signal, dtype=float)
    dead = uniform_filter1d((signal == signal.min()).astype(float), DEAD_WINDOW) > 0.3
    # Lines are wider than a channel: a pattern of odd and even channels goes, and most of the noise.
    signal = np.convolve(np.pad(signal, 1, mode="edge"), SMOOTH, mode="valid")
    own = noise_of(signal, SMOOTH_GAIN)
    noise = own if noise is None else np.maximum(own, np.sqrt(np.sum(SMOOTH**2)) * noise)
    step = np.gradient(axis)
    from scipy.signal import (
        find_peaks,
        peak_widths,
    )  # half a second, which reading a table of lines does not cost

    found, facts = find_peaks(signal, prominence=DETECTED * noise, wlen=2 * WING + 1)
    channels = peak_widths(signal, found, rel_height=0.5, wlen=2 * WING + 1)[0]
    if slit is None:
        sharp = np.quantile(channels, 0.25) if found.size else 3.0
        slit = max(sharp, 2.0) * step
    slit = np.broadcast_to(slit, signal.shape)
    height, place = _vertex(signal, found)
    height = facts["prominences"] + height
    width = np.maximum(channels * step[found], slit[found])
    floor = gaussian_filter1d(minimum_filter1d(signal, 2 * WING + 1), WING)
    above = np.maximum(signal - floor, 0.0)
    # What a line must rise above to be a peak of its own: by how much the rest changes over its width.
    beside = 2 * round(np.median(slit / step)) + 1
    change = maximum_filter1d(signal, beside) - minimum_filter1d(signal, beside)
    return Peaks(
        axis,
        above,
        np.where(dead, np.inf, DETECTED * noise + change),
        slit,
        np.interp(found + place, np.arange(axis.size), axis),
        height * width / slit[found],
        width,
        height / noise[found],
    )


def _vertex(signal, found):
    """Height above the highest channel and place of the parabola through three channels."""
    left, mid, right = signal[found - 1], signal[found], signal[found + 1]
    bend = np.minimum(left + right - 2 * mid, -1e-30)
    place = np.clip((left - right) / (2 * bend), -0.5, 0.5)
    return (right - left) * place / 4, place
