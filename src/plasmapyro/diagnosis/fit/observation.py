"""The data of one test as the diagnosis sees them: each instrument on its bins."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy import sparse
from scipy.special import ndtr

from plasmapyro.radiation.bandsignal import respond
from plasmapyro.radiation.slit import FWHM_PER_SIGMA
from plasmapyro.record import binning
from plasmapyro.record.inputs import has_plasma

NODE = 6e-9  # [m] of the quadrature over a band
NODE_MARGIN = 18e-9  # [m] beyond the response, so that its edges may shift
LEAST_SEEN = 0.9  # [1] of the weight about a pixel, for the mean of its neighbours to be that of its place
REACH = 3.0  # standard deviations
SHORTEST = 1e-6  # [s] of a bin
BEFORE_SHAPE = 0.1  # [1] ASSUME: of the gas in a channel before the injection over that after it, besides its
# brightness and power: the sight line then crosses the free jet, not the layer before a sample


@dataclass(frozen=True)
class Instrument:
    """One instrument on bins: C channels (bands, or P wavelength bins) seen through M wavelength nodes.

    `value` (n, C) measured means, NaN where none; `number` (n, C) of samples; `moment` (n, q) [s] the
    instants that stand for the times of a bin; `wavelength` (M,) [m] of the nodes; `weight` (C, M) from
    the radiance at the nodes to the channels, or None where each channel is its node; `gain` (C,) from there
    to the unit of the values; `gas_map` (M, K) from a spectrum of the library to the nodes.
    """

    kind: str
    moment: np.ndarray
    value: np.ndarray
    number: np.ndarray
    wavelength: np.ndarray
    weight: np.ndarray | None
    gain: np.ndarray
    gas_map: object
    node_edges: tuple  # of each band, (m + 1,) [m]; the nodes of the bands stand one after the other
    factor: np.ndarray | None  # spectrometer: radiance per count rate in each channel
    pixel_edges: np.ndarray | None  # first pixel of each bin
    raw: np.ndarray  # (t, C) samples in the unit of `value`
    raw_moment: np.ndarray  # (t, q)
    raw_bin: np.ndarray  # (t,)
    gas_error: np.ndarray  # (C,) prior standard deviation of the gas of a channel over its simulated light
    pattern: np.ndarray  # (C,) relative error of each channel, constant in time
    dark: np.ndarray  # (C,) error of the background of each channel, in the unit of the values
    band: tuple = ()  # names of the bands of a pyrometer or radiometer
    source: str = ""  # name in the record; `kind` is "pyrometer" for both of these
    relative: np.ndarray | None = None  # (M,) stated emissivity at the nodes over its level
    course: np.ndarray | None = None  # (M, K) shapes that ln(emissivity) may differ by
    known: np.ndarray | None = None  # (C,) relative errors of the sensitivities of a radiometer
    rounding: tuple = ()  # `Rounding` of each channel as recorded; none where noise is far larger
    recorded: float = 1.0  # samples as recorded in each of `raw`
    highest: float | None = None  # largest count rate of a pixel

    def rounded(self, level, number):
        """Variance (n, C) that rounding gives to means (n, C) of some `number` (n, C) of raw samples."""
        if not self.rounding:
            return np.zeros(level.shape)
        number = np.broadcast_to(number, level.shape) * self.recorded
        rows = [one.variance(*own) for one, *own in zip(self.rounding, level.T, number.T, strict=True)]
        return np.stack(rows, axis=1)

    @property
    def pixels(self):
        """Pixels (C,) of each channel; 1 of a band."""
        return np.ones(self.channels) if self.pixel_edges is None else np.diff(self.pixel_edges)

    @property
    def before_error(self):
        """Prior standard deviations (C,) of the gas of a channel before the injection, besides."""
        return np.full(self.channels, BEFORE_SHAPE * bool((self.moment[:, 0] < 0).any()))

    @property
    def channels(self):
        """Number of channels."""
        return self.value.shape[1]

    @property
    def middle(self):
        """Mean wavelength of each channel (C,) [m]."""
        if self.weight is None:
            return self.wavelength
        return self.weight @ self.wavelength / self.weight.sum(axis=1)

    def share_after(self, event, late):
        """Share (n, q) of each bin after an event [s], on a clock by which all happens `late` [s] later than
        stated; its samples are spread evenly over it."""
        if not late:
            return (self.moment >= event).astype(float)
        half = np.sqrt(3) * self.moment.std(axis=1, keepdims=True)
        begin = self.time[:, None] + late - half
        share = (begin + 2 * half - event) / np.maximum(2 * half, SHORTEST)
        return np.broadcast_to(np.clip(share, 0.0, 1.0), self.moment.shape)

    @property
    def time(self):
        """Middle of each bin (n,) [s]."""
        return self.moment.mean(axis=1)


FINE = 0.5  # [s] between the instants of an exposure: a sample heats by 100 K/s, by less each second
MOST_INSTANTS = 40


def nodes_of(integration_time):
    """Places (q,) of the instants of a bin about its mean time, in standard deviations; of equal weight.

    Two are exact for light that is cubic in time; a long exposure has more, `FINE` apart.
    """
    count = int(np.clip(np.ceil(integration_time / FINE), 2, MOST_INSTANTS))
    return np.sqrt(12 / (count**2 - 1)) * (np.arange(count) - (count - 1) / 2)


def instants(begin, finish, index, count, nodes):
    """Instants (count, q) with the mean and the variance of the times of the samples of each bin."""
    middle, half = (begin + finish) / 2, (finish - begin) / 2
    keep = index >= 0
    number = np.bincount(index[keep], minlength=count)
    safe = np.maximum(number, 1)
    mean = np.bincount(index[keep], middle[keep], count) / safe
    square = np.bincount(index[keep], middle[keep] ** 2 + half[keep] ** 2 / 3, count) / safe
    spread = np.sqrt(np.maximum(square - mean**2, 0))
    return mean[:, None] + spread[:, None] * nodes, number


def highest_of(rates):
    """Largest of rates (n, P) of pixels in successive bins of time; a hit in one of these counts not."""
    top = np.where(np.isfinite(rates), rates, -np.inf).max(axis=1)
    top = top[np.isfinite(top)]
    if top.size > 2:
        top = np.median(sliding_window_view(top, 3), axis=1)
    return float(top.max(initial=0.0))


def band_nodes(response_wavelength):
    """Edges (M+1,) and centres (M,) [m] of the nodes of the bands."""
    first, last = response_wavelength[0] - NODE_MARGIN, response_wavelength[-1] + NODE_MARGIN
    edges = np.linspace(first, last, int(np.ceil((last - first) / NODE)) + 1)
    return edges, (edges[1:] + edges[:-1]) / 2


def band_weights(edges, response_wavelength, responsivity):
    """Integral of a responsivity, linear between table points, over each node (M,) [m].

    Exact, so that it has no jumps as a response moves that does not end at zero.
    """
    step = np.diff(response_wavelength)
    whole = np.append(0.0, np.cumsum(step * (responsivity[1:] + responsivity[:-1]) / 2))
    place = np.clip(edges, response_wavelength[0], response_wavelength[-1])
    left = np.clip(np.searchsorted(response_wavelength, place, side="right") - 1, 0, step.size - 1)
    beyond = place - response_wavelength[left]
    rise = np.diff(responsivity)[left] / step[left]
    return np.diff(whole[left] + beyond * (responsivity[left] + beyond * rise / 2))


def band_gas_map(edges, wavelength, response_wavelength, responsivity):
    """Matrix (M, K) from a spectrum on equal steps to its weighted means over the nodes of a band.

    Weight times mean is the signal of the spectrum. Nodes that the band hardly sees hold the plain mean.
    """
    step, count = wavelength[1] - wavelength[0], edges.size - 1
    place = np.searchsorted(edges, wavelength, side="right") - 1
    inside = np.flatnonzero((place >= 0) & (place < count))
    place = place[inside]
    exact = band_weights(edges, response_wavelength, responsivity)
    seen = exact > 1e-3 * exact.max()
    weighted = respond(wavelength[inside], response_wavelength, responsivity) * step
    share = np.where(
        seen[place],
        weighted / np.where(seen, exact, 1.0)[place],
        1 / np.maximum(np.bincount(place, minlength=count), 1)[place],
    )
    return sparse.csr_array((share, (place, inside)), shape=(count, wavelength.size))


def pixel_gas_map(wavelength, pixels, edges):
    """Matrix (P, K) from a slit-convolved spectrum on equal steps to the means over bins of pixels.

    Interpolates with polynomials of degree five through six neighbours.
    """
    step = wavelength[1] - wavelength[0]
    place = (pixels - wavelength[0]) / step
    first = np.clip(place.astype(int) - 2, 0, wavelength.size - 6)
    x = place - first
    nodes = np.arange(6)
    weight = np.ones((pixels.size, 6))
    for i in nodes:
        for j in nodes[nodes != i]:
            weight[:, i] *= (x - j) / (i - j)
    owner = np.repeat(np.arange(edges.size - 1), np.diff(edges))
    weight /= np.diff(edges)[owner][:, None]
    rows = (first[:, None] + nodes).ravel()
    columns = np.repeat(owner, 6)
    return sparse.csr_array((weight.ravel(), (columns, rows)), shape=(edges.size - 1, wavelength.size))


def in_pixel_bins(values, edges):
    """Means (..., P) over the pixels of each bin, of what is finite."""
    finite = np.isfinite(values)
    total = np.add.reduceat(np.where(finite, values, 0.0), edges[:-1], axis=-1)
    number = np.add.reduceat(finite.astype(float), edges[:-1], axis=-1)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan), number


def as_through(slit, own, wavelength, values, saturated):
    """Spectra (t, P) of a slit of width `own` [m] as through the wider `slit` [m], and which pixels of them
    saturated ones (t, P) reach: of two spectra the finer one can be made as coarse as the other.

    NaN where too many neighbours of a pixel are missing, as at the ends.
    """
    sigma = np.sqrt(max(slit**2 - own**2, 0.0)) / FWHM_PER_SIGMA
    width = np.abs(np.gradient(wavelength))
    if not sigma > 0.5 * np.median(width):
        return values, saturated
    first, last = (np.searchsorted(wavelength, wavelength + end * REACH * sigma) for end in (-1, 1))
    count = last - first
    row = np.repeat(np.arange(wavelength.size), count)
    column = np.arange(count.sum()) + np.repeat(first - np.cumsum(count) + count, count)
    away = (wavelength[column] - wavelength[row]) / sigma
    share = np.exp(-(away**2) / 2) / np.sqrt(2 * np.pi) / sigma * width[column]
    kernel = sparse.csr_array((share, (row, column)), shape=(wavelength.size,) * 2)
    finite = np.isfinite(values)
    weight = finite.astype(float) @ kernel.T
    total = np.where(finite, values, 0.0) @ kernel.T
    reached = (saturated.astype(float) @ (kernel > 0).astype(float).T) > 0
    return np.where(weight > LEAST_SEEN, total / np.maximum(weight, LEAST_SEEN), np.nan), reached


def beside_saturation(saturated, index, edges):
    """Samples (t, C) of bins in which some pixel was saturated, and of those beside them in time.

    Of a pixel near its limit only the samples with low noise are left: their mean would be too low.

    Parameters
    ----------
    saturated : (t, P) bool
    index : (t,) bin in time of each sample, -1 for none
    edges : (C+1,) first pixel of each bin of pixels
    """
    hit = np.logical_or.reduceat(saturated, edges[:-1], axis=1)
    bins = np.zeros((index.max(initial=-1) + 1, hit.shape[1]), dtype=bool)
    np.logical_or.at(bins, index[index >= 0], hit[index >= 0])
    wide = bins.copy()
    wide[1:] |= bins[:-1]
    wide[:-1] |= bins[1:]
    return np.where((index >= 0)[:, None], wide[index], hit)


def without_lost(index, values):
    """Bins (t,) of the samples, -1 for those that are missing: in all channels, or in most."""
    return np.where(np.isfinite(values).mean(axis=1) > 0.5, index, -1)


def time_bins(record):
    """Edges (n+1,) [s] of the time bins of a test; without a plasma each series has its own, and the pauses
    between series (n, 2) [s]."""
    axes = [instrument.time for instrument in record.instruments]
    start, end = min(axis[0] for axis in axes) - 0.5, max(axis[-1] for axis in axes) + 0.5
    time = np.sort(np.concatenate(axes))
    first = [] if has_plasma(record.attributes) else np.flatnonzero(np.diff(binning.series(time))) + 1
    if not len(first):
        return binning.time_edges(start, end, 0.0, record.off), np.zeros((0, 2))
    parts = [(one[0] - 0.5, one[-1] + 0.5) for one in np.split(time, first)]
    own = [binning.time_edges(*part, part[0], part[1]) for part in parts]
    return np.unique(np.concatenate(own)), np.stack([time[first - 1], time[first]], axis=1)


def side_by_side(maps):
    """One matrix (M, K) out of those of the bands."""
    return sparse.csr_array(sparse.vstack(maps))


def line_shapes(centre, fwhm):
    """Shapes (C, b) of single lines behind a slit, at channels (C,) and between, and where they are (b,)."""
    edges = np.concatenate([centre[:1], (centre[1:] + centre[:-1]) / 2, centre[-1:]])
    where = np.sort(np.concatenate([centre, edges[1:-1]]))
    sigma = fwhm / FWHM_PER_SIGMA
    mean = np.diff(ndtr((edges[:, None] - where) / sigma), axis=0) / np.diff(edges)[:, None]
    return mean / mean.max(axis=0), where
