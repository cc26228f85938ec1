"""What persists: gains and a gas that wander, a scale that is smoothly wrong over wavelength."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.diagnosis.fit.parameter import Parameter
from plasmapyro.instrument.scale import SCALE_ERROR, SCALE_LENGTHS, alike
from plasmapyro.instrument.wander import MEMORY, WANDER, wandering

GAIN_STEP = 3.0  # [s] between knots of gains and gas: noise of 1/f is not followed by knots 8 s apart
GAS_TIME = 20.0  # [s] correlation time of half of the gas; of its other half as of the gains
GAS_WANDER = 0.005  # [1] of the brightness of the gas, ASSUME: mains and cooling water wander by a tenth
# of a per cent, and lines follow the power by its third to sixth power
ROUGH_LENGTH = 10e-9  # [m]
OF_SERIES = ROUGH_LENGTH, SCALE_LENGTHS[0]  # [m] over which that of a series changes
COURSE_WANDER = WANDER["ratio"]  # [1] ASSUME: one pixel beside another as bands of a pyrometer
COURSE_LENGTHS = 25e-9, *SCALE_LENGTHS  # [m] ASSUME: gratings and fibres change over less than lamps err
COURSE_KNOTS = 12  # of it in time; what is faster is noise
COURSE = 3e-3  # [1] ASSUME: how far the course of the scale wanders: as far as its level
STRAY_LIGHT = 0.003  # [1] ASSUME: of the mean count rate, as in the estimate with an emissivity
STRAY_COURSE = 0.3  # [1] ASSUME: of it, from one end of a spectrum to the other
LEAST_COURSE = 1e-3  # variance of shapes of a course that are left out, of the largest
LEAST_WANDER = 1e-2  # variance of shapes over wavelength that are left out, of the largest
# Variance of modes over wavelength that are left out [1], of the largest. At 1e-2 the temperature seems twice
# as sure, because what is left out is what a wrong temperature looks like.
LEAST = 1e-4
SCALE_STEP = 10e-9  # [m]: the scale of a spectrometer is stated between the first and last multiple of it


@dataclass(frozen=True)
class Persistent:
    r"""Relative errors :math:`\sum_j v_j T_j(t) S_j(\lambda)` of one instrument, v standard normal times
    `sizes` (m,).

    `time` (K, m) at the knots, constant beyond them, and `channel` (C, m).
    """

    knots: np.ndarray  # (K,) [s]
    time: np.ndarray
    channel: np.ndarray
    parameters: tuple
    lengths: tuple = ()  # ((length [m], share), ...) over which the scale of a spectrometer persists

    def basis(self, time):
        """T (n, m) at the times (n,) [s] and S (C, m)."""
        rows = [np.interp(time, self.knots, column) for column in self.time.T]
        return np.array(rows).reshape(len(rows), -1).T, self.channel


def persistent(instrument, start, end, rough=0.0, pauses=()):
    """Persistent errors of an instrument of a record from `start` to `end` [s].

    `rough` [1]: of the scale of a spectrometer, from one `ROUGH_LENGTH` to the next; its course then wanders
    in time as well. Between `pauses` (n, 2) [s] each series has a roughness of its own besides: slit and
    response leave another one at another temperature.

    Gains are Ornstein-Uhlenbeck processes, linear between knots; the scale over wavelength is a Gaussian
    process, by the modes of its covariance; the modes of `course_shapes` wander in time.

    Notes
    -----
    Source: C. E. Rasmussen and C. K. I. Williams, Gaussian Processes (2006), eq. 4.9 and B.29.
    """
    knots, root = wandering(start, end, MEMORY * (end - start), more=np.ravel(pauses), step=GAIN_STEP)
    kinds = {"pyrometer": np.ones(instrument.channels), "ratio": [0.5, -0.5]}
    if instrument.channels != 2:
        del kinds["ratio"]
    if instrument.kind == "spectrometer":
        kinds = {"spectrometer": np.ones(instrument.channels)}
    time, channel, parameters, lengths = [], [], [], ()
    for kind, row in kinds.items():
        time.append(root)
        channel.append(np.outer(row, np.ones(knots.size)))
        name = f"wandering gain of the {kind}" if kind != "ratio" else "wandering ratio of the bands"
        parameters += [Parameter(f"wander_{kind}", name, WANDER[kind])] * knots.size
    for place, band in enumerate(instrument.band if instrument.known is not None else ()):
        row = np.eye(instrument.channels)[place]
        time.append(np.column_stack([root, np.ones(knots.size)]))
        channel.append(np.outer(row, np.ones(knots.size + 1)))
        own = [
            Parameter(f"wander_{band}", f"wandering gain of {band}", WANDER["ratio"] / np.sqrt(2))
        ] * knots.size
        parameters += [*own, Parameter(f"gain_{band}", f"sensitivity of {band}", instrument.known[place])]
    if instrument.kind == "spectrometer":
        apart = np.subtract.outer(instrument.wavelength, instrument.wavelength)
        parts = [(one, 1.0) for one in SCALE_LENGTHS] + [(ROUGH_LENGTH, (rough / SCALE_ERROR) ** 2)]
        lengths = tuple(parts)
        value, vector = np.linalg.eigh(alike(apart, parts))
        name = "scale of the spectrometer over wavelength"
        kept = value > LEAST * value.max()
        if not rough:  # as many in every test of a laboratory, whatever the bins of its spectra
            kept = np.arange(value.size) >= value.size - _modes(instrument.wavelength, parts)
        time.append(np.ones((knots.size, kept.sum())))
        channel.append(vector[:, kept] * np.sqrt(value[kept]))
        parameters += [Parameter("smooth_spectrometer", name, SCALE_ERROR)] * int(kept.sum())
        if not rough:
            span = end - start
            own, root = wandering(start, end, MEMORY * span, step=span / COURSE_KNOTS)
            root = np.array([np.interp(knots, own, column) for column in root.T]).T
            for row in course_shapes(instrument.wavelength):
                time.append(root)
                channel.append(np.outer(row, np.ones(own.size)))
                parameters += [Parameter("wander_course", f"wandering {name}", COURSE_WANDER)] * own.size
        if rough:
            like = np.exp(-0.5 * (apart / max(SCALE_LENGTHS)) ** 2)
            value, vector = np.linalg.eigh(like)
            for size, row in zip(value, vector.T, strict=True):
                if size > LEAST_WANDER * value.max():
                    time.append(root)
                    channel.append(np.outer(row * np.sqrt(size), np.ones(knots.size)))
                    parameters += [Parameter("wander_smooth", f"wandering {name}", COURSE)] * knots.size
            middles = np.mean(pauses, axis=1) if len(pauses) else []
            series = np.searchsorted(middles, knots)
            own = np.searchsorted(middles, instrument.moment.mean(axis=1))
            between = sum(np.exp(-0.5 * (apart / one) ** 2) for one in OF_SERIES) / len(OF_SERIES)
            for one in np.unique(series):
                share = _stray_share(instrument, own == one)
                stray = like * np.outer(share, share)
                parts = [("smooth_stray", "stray light over wavelength", stray, STRAY_COURSE, LEAST)]
                if len(middles):
                    parts.append(("smooth_series", f"{name} in a series", between, rough, LEAST_WANDER))
                for identity, words, covariance, sigma, least in parts:
                    value, vector = np.linalg.eigh(covariance)
                    kept = value > least * value.max()
                    time.append(np.repeat((series == one)[:, None].astype(float), kept.sum(), axis=1))
                    channel.append(vector[:, kept] * np.sqrt(value[kept]))
                    parameters += [Parameter(identity, words, sigma)] * int(kept.sum())
    return Persistent(knots, np.hstack(time), np.hstack(channel), tuple(parameters), lengths)


def course_shapes(wavelength):
    """Shapes (m, C) by which the scale of a spectrometer over its wavelengths (C,) [m] wanders, of unit
    variance together."""
    apart = np.subtract.outer(wavelength, wavelength)
    value, vector = np.linalg.eigh(alike(apart, [(one, 1 / len(COURSE_LENGTHS)) for one in COURSE_LENGTHS]))
    kept = value > LEAST_COURSE * value.max()
    return (vector[:, kept] * np.sqrt(value[kept])).T


def unresolved(errors, length):
    r"""Variances (n,) [1] of what gains do between their knots, in the mean of bins of some length L (n,)
    [s]: of the gain of all channels, of that of each band, and of the course over wavelength.

    .. math:: \frac{2\sigma^2}{\tau}\,\frac{h}{6}\,\frac{1}{1 + L/h}

    A straight line between knots h apart misses a Brownian bridge: h/6 of its rate in the mean over time,
    half of that in the mean over h.

    Parameters
    ----------
    errors : Persistent
    length : (n,) [s]
    """
    span, length = np.ptp(errors.knots), np.asarray(length)
    steps = float(np.median(np.diff(errors.knots))), span / (COURSE_KNOTS - 1)
    rate, slow = (2 / (MEMORY * span) * step / 6 / (1 + length / step) for step in steps)
    sigma = {one.id: one.sigma for one in errors.parameters if one.id.startswith("wander_")}
    of_all = max(sigma.pop(f"wander_{kind}", 0.0) for kind in ("pyrometer", "spectrometer"))
    sigma.pop("wander_smooth", None)
    course = sigma.pop("wander_course", 0.0)
    own = max(sigma.pop("wander_ratio", 0.0) / 2, *sigma.values(), 0.0)  # of bands that are known one by one
    return of_all**2 * rate, own**2 * rate, course**2 * slow


def scale_at(wavelength, channels, modes, lengths):
    r"""Modes of the scale at other wavelengths.

    .. math:: S_j(\lambda) = \sum_c K(\lambda, c)\,S_j(c) / |S_j|^2

    Parameters
    ----------
    wavelength : (n,) [m]
    channels : (C,) [m]
        Where the modes (C, m) stand; there they come back, and pixels that a test lost leave no gap.
    modes : (C, m)
    lengths : tuple
        Of `Persistent`, which K is made of.

    Returns
    -------
    array, (n, m)

    Notes
    -----
    Source: Rasmussen and Williams (2006), eq. 4.44 (Nystroem's method).
    """
    return alike(np.subtract.outer(wavelength, channels), lengths) @ (modes / np.sum(modes**2, axis=0))


def scale_ends(wavelength):
    """First and last multiple (2,) [m] of `SCALE_STEP` within the wavelengths of some channels [m]."""
    return SCALE_STEP * np.array(
        [np.ceil(wavelength.min() / SCALE_STEP), np.floor(wavelength.max() / SCALE_STEP)]
    )


def _modes(wavelength, parts):
    """Number of modes of the scale above `LEAST` on even steps over the wavelengths of some channels [m]."""
    first, last = scale_ends(wavelength)
    even = np.arange(first, last + SCALE_STEP / 2, SCALE_STEP)
    value = np.linalg.eigvalsh(alike(np.subtract.outer(even, even), parts))
    return int(np.sum(value > LEAST * value.max()))


def _stray_share(instrument, chosen):
    """Share (C,) of even stray light in the counts of each channel of some bins, at most 1."""
    counts = np.nanmean(instrument.value[chosen], axis=0)
    counts = counts if instrument.factor is None else counts / instrument.factor
    return np.minimum(STRAY_LIGHT * np.nanmean(counts) / np.maximum(counts, 1e-300), 1.0)


def wandering_gas(start, end):
    """Parameters of a brightness of the gas that wanders over a record from `start` to `end` [s]."""
    knots, root = wandering(start, end, GAS_TIME, MEMORY * (end - start), step=GAIN_STEP)
    name = "wandering brightness of the gas"
    return tuple(
        Parameter("gas_wander", name, GAS_WANDER, history=(tuple(knots), tuple(column))) for column in root.T
    )
