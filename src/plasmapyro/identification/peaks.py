"""Peaks of a spectrum: where they are, how strong, how wide, and what would not have been seen."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import (
    gaussian_filter1d,
    maximum_filter1d,
    median_filter,
    minimum_filter1d,
    percentile_filter,
    uniform_filter1d,
)

DETECTED = 4.0  # standard deviations of a peak; one so faint tells nothing yet, see `evidence.BELIEVED`
NOISE_WINDOW = 151  # channels
DEAD_WINDOW = 15  # channels, of which a third at the lowest value are clipped
SMOOTH = np.array([1.0, 2.0, 1.0]) / 4
SMOOTH_GAIN = np.sqrt(2)  # of third differences of noise that was smoothed so: sums of squares 12/16 and 6/16
WING = 25  # channels to either side within which a peak must stand out
BEND = 0.1  # of the highest signal around: least height of a shoulder; profiles bend themselves
PLAIN = 15.0  # standard deviations above the lowest around, which noise does not reach
OUT = 1.25  # of a peak, deviations above the lowest around over those above the mean of what is beside it
WIDTHS = (1.0, 3.0, 8.0)  # of a slit, that a line may have
NARROW = 0.6  # of a slit: what bends are sought with; wider ones lose a line beside a stronger one
APART = 0.75  # of a slit: least distance of a shoulder from a peak
DETECTORS = 1.4  # ratio of the steps of two detectors
SHAPED = 5.0  # standard deviations of the peaks that tell a slit
FEW = 8  # of them in a detector
SHARPEST = 0.15  # of these peaks are as narrow as the slit; those of air are three times as wide
IRREGULAR = 0.25  # of a step, by which steps from channel to channel differ where two detectors overlap


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


def one_detector(axis, *records):
    """Channels of two detectors that overlap, made as coarse as the coarser: interleaved, lines are noise.

    Parameters
    ----------
    axis : ndarray (N,) [m]
        Ascending.
    records : ndarray (N,)
        On it, averaged with it.

    Returns
    -------
    list of ndarray (M,)
        Axis and records; as they were where the steps are even.
    """
    step = np.diff(axis)
    uneven = np.abs(np.diff(step)) > IRREGULAR * np.maximum(step[1:], step[:-1])
    # Many of them: one channel that is left out makes two.
    uneven = np.convolve(uneven, np.ones(2 * WING + 1), mode="same") > WING / 2
    bins = np.arange(axis.size)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], uneven.astype(int), [0]])))
    for first, last in edges.reshape(-1, 2):
        coarse = max(
            np.median(step[max(first - WING, 0) : first + 1]), np.median(step[last : last + WING + 1])
        )
        inside = slice(first + 1, last + 1)
        bins[inside] = axis.size + ((axis[inside] - axis[first]) / coarse).astype(int)
    own = np.concatenate([[0], np.cumsum(np.diff(bins) != 0)])
    count = np.bincount(own)
    return [np.bincount(own, record) / count for record in (axis, *records)]


def find(axis, signal, noise=None, slit=None):
    """`Peaks` of a spectrum.

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
    """
    signal = np.asarray(signal, dtype=float)
    dead = uniform_filter1d((signal == signal.min()).astype(float), DEAD_WINDOW) > 0.3
    # Lines are wider than a channel: a pattern of odd and even channels goes, and most of the noise.
    signal = np.convolve(np.pad(signal, 1, mode="edge"), SMOOTH, mode="valid")
    own = noise_of(signal, SMOOTH_GAIN)
    noise = own if noise is None else np.maximum(own, np.sqrt(np.sum(SMOOTH**2)) * noise)
    step = np.gradient(axis)
    from scipy.signal import find_peaks, peak_widths  # half a second; reading a table of lines costs none

    wide = 2 * WING + 1  # a plateau as wide (a full converter) stands out of nothing in it
    found, facts = find_peaks(signal, prominence=DETECTED * noise, wlen=wide, plateau_size=(None, wide - 2))
    channels, _, left, right = peak_widths(signal, found, rel_height=0.5, wlen=wide)
    prominence = facts["prominences"]
    if slit is None:
        shaped = prominence > SHAPED * noise[found]
        slit = np.maximum(_sharp(step, found[shaped], channels[shaped]), 2.0) * step
    slit = np.broadcast_to(slit, signal.shape)
    channels = 2 * np.minimum(found - left, right - found)  # a neighbour widens one side
    # Noise stands out of the lowest around it by ten deviations; out of its mean a line does.
    out = np.where(prominence > PLAIN * noise[found], np.inf, 0.0)
    for width in WIDTHS:
        bend, own = _bend(signal, noise, width * slit / step, 1.0)
        out = np.maximum(out, OUT * maximum_filter1d(bend / own, 3)[found])
    sure = out > DETECTED
    found, channels = found[sure], channels[sure]
    height, place = _vertex(signal, found)
    height = prominence[sure] + height
    width = np.maximum(channels * step[found], slit[found])
    snr = np.minimum(height / noise[found], out[sure])
    beside, *shoulders = _shoulders(signal, found, noise, slit / step)
    found = np.concatenate([found, beside])
    order = np.argsort(found, kind="stable")
    found = found[order]
    place, height, snr, width = (
        np.concatenate([one, more])[order]
        for one, more in zip((place, height, snr, width), (*shoulders, slit[beside]), strict=True)
    )
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
        snr,
    )


def _sharp(step, found, channels):
    """Width (N,) of a sharp line in channels: of the sharpest quarter of the peaks of each detector, which
    are told by their steps."""
    smooth = median_filter(step, 2 * WING + 1)
    jump = np.abs(np.log(smooth[2 * WING :] / smooth[: -2 * WING])) > np.log(DETECTORS)
    begins = WING + 1 + np.flatnonzero(np.diff(np.concatenate([[0], jump.astype(int)])) == 1) + WING // 2
    detector = np.searchsorted(begins, np.arange(step.size), side="right")
    sharp = np.full(begins.size + 1, np.quantile(channels, SHARPEST) if found.size else 3.0)
    for one in range(sharp.size):
        own = channels[detector[found] == one]
        if own.size >= FEW:
            sharp[one] = np.quantile(own, SHARPEST)
    return sharp[detector]


def _bend(signal, noise, slit, narrow):
    """Height (N,) of a line of the `slit` (N,) [channels] in each channel, and its standard deviation.

    A filter without area, as the second derivative of a Gaussian `narrow` times as wide: a slope gives
    nothing, and what is beside a line takes nothing off for being lower by chance.
    """
    bend, own = np.zeros((2, signal.size))
    slit = np.exp(np.round(20 * np.log(slit)) / 20)  # to 5 %
    for width in np.unique(slit):
        sigma = width / 2.355
        half = int(np.ceil(4 * sigma))
        reach = np.arange(-half, half + 1) / sigma
        kernel = (1 - (reach / narrow) ** 2) * np.exp(-((reach / narrow) ** 2) / 2)
        kernel -= kernel.mean()
        kernel /= kernel @ np.exp(-(reach**2) / 2)
        here = slit == width
        bend[here] = np.convolve(np.pad(signal, half, mode="edge"), kernel, mode="valid")[here]
        # the noise before the smoothing is that of independent channels
        own[here] = np.sqrt(np.sum(np.convolve(kernel, SMOOTH) ** 2) / np.sum(SMOOTH**2))
    return bend, own * noise


def _shoulders(signal, found, noise, slit):
    """Channels, places in them, heights and SNR of lines on the flank of another: no maximum, but a bend."""
    bend, noise = _bend(signal, noise, slit, NARROW)
    reach = 2 * round(3 * np.median(slit)) + 1
    near = maximum_filter1d(signal - minimum_filter1d(signal, 2 * WING + 1), reach)
    most = (bend[1:-1] > bend[:-2]) & (bend[1:-1] >= bend[2:])
    at = 1 + np.flatnonzero(most & (bend > np.maximum(DETECTED * noise, BEND * near))[1:-1])
    if found.size and at.size:
        at = at[np.abs(at[:, None] - found).min(axis=1) > APART * slit[at]]
    higher, place = _vertex(bend, at)
    return at, place, bend[at] + higher, (bend[at] + higher) / noise[at]


def _vertex(signal, found):
    """Height above the highest channel and place of the parabola through three channels."""
    left, mid, right = signal[found - 1], signal[found], signal[found + 1]
    bend = np.minimum(left + right - 2 * mid, -1e-30)
    place = np.clip((left - right) / (2 * bend), -0.5, 0.5)
    return (right - left) * place / 4, place
