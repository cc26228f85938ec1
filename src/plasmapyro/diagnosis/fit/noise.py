"""How noisy each instrument is: what neighbours in time do not share beside the base model."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from plasmapyro.diagnosis.fit.coloured import CLIP as OUTLYING
from plasmapyro.diagnosis.fit.coloured import OVERLAP, THIRD, Coloured, coloured, flickering
from plasmapyro.diagnosis.fit.persistent import COURSE_KNOTS, course_shapes
from plasmapyro.diagnosis.fit.weights import Noise
from plasmapyro.record import binning

CLIP = 4.5  # standard deviations beyond which a sample is left out
ROUNDS = 3
LEVELS, LEAST_IN_GROUP = 6, 6  # groups of samples of a band by signal, and samples that make a variance
MOST_LEVELS, LEAST_IN_LEVEL = 60, 30  # the same of all channels of a spectrometer: a law for all
LARGEST_MEMORY = 0.9  # autocorrelation of neighbours that is believed
LEAST_REMEMBERED = 40  # neighbours that tell of one
LEAST_MEMORY = 0.04  # smaller ones count as none
FLICKER_MARGIN = 1.3  # [1]: the variance is known from some 50 samples, to 20 to 30 %
FLICKER_FRAMES = 20  # frames that the expectation from the other instrument counts for
LEAST_NOISE = 1e-6  # [1] of a value: no sample is exact
FAINTEST = 1e-3  # [1] of the mean of a channel: darker light has no shot noise that a fit could know
# [s] over which a gain is told from the temperature: the bins of the steady state are 8 s long
LONGEST_LAG = 6.0
LONGEST_FLICKER = 20.0  # [s] over which the gas flickers, not drifts
SEEN_GAS = 0.03  # [1] error of the brightness of the gas of a frame that still tells of it
SEEN = 0.1  # [1], of the noise of a band: what the flicker of the gas may add to tell how gains flicker
SEEN_GAIN = 0.01  # [1] error of the gain of a frame that still tells of it
BRIGHT, LITTLE = 0.6, 0.3  # [1], of the gas in the light: samples that tell how it flickers, how gains do
CLEAR = 0.02  # [1], of the gas in the light: samples that show none of its flicker
HIDDEN = 0.5  # [1], of what bands do not share: the most that the flicker of the gas may make of it
OF_HIGHEST = 0.1  # of a signal: samples that tell how gains flicker, fainter ones how amplifiers rustle
OF_FAINTEST = 0.01  # of a signal: fainter samples tell the noise that is there without light
OWN = 0.05  # [1], of the variance that bands share: the least that each has besides
SHAPES = 3  # of a course over wavelength, the longest, that tell how it flickers
OCTAVE = 1e-4  # [1] ASSUME: flicker of the gain of a band in each octave of time, to a factor of `LOOSE`
OF_SHAPE = OCTAVE / 2  # [1] ASSUME: the same of each of some shapes of a course over wavelength
CORNER = 0.3  # [Hz] ASSUME: below it an amplifier flickers more than it rustles, to a factor of `LOOSE`
# [s] ASSUME: of samples, which electronics times, and frames, which a computer starts and dates by ticks of
# 10 to 16 ms (Microsoft, GetTickCount); of so many degrees of freedom
JITTER = {"pyrometer": 5e-4, "spectrometer": 1e-2}
JITTER_FREEDOM, OF_PERIOD = 2.0, 0.1  # and at most so much of the time between two
LEAST_JITTER, JITTER_ROUNDS = 0.1, 5  # [1] of the usual one; rounds of weights by what was found
START_RELATIVE = 0.004  # [1] noise of the first fit: of the value
START_CONSTANT = 0.05  # [1] and of the gas
START_FLICKER = 0.01
START_GAIN = 3e-3  # with less, the temperature follows the gain, and no residual shows it


@dataclass(frozen=True)
class NoiseModel:
    r"""Variance of one sample :math:`a f^2/N + b f S/N + c S^2` of N pixels with the factor f, its memory
    from sample to sample (lag-1), `flicker` of the brightness of the gas, `gain` of all light; `tail`: the
    samples beyond 4 standard deviations over what a normal law has. `laws` (S, 3): a, b, c of each series of
    a furnace, whose exposures differ; a, b and c are then those of the last. `zero`: what is more than a of
    the constant part, over a, and lasts, as 1/f noise of an amplifier does; `own`: 1/f noise of the gain of
    each band [1], and `course` of the scale over wavelength; `late` [s]: standard deviation of the times of
    samples."""

    constant: float | np.ndarray  # of each band its own: amplifiers have ranges of their own
    linear: float
    quadratic: float
    memory: float
    flicker: Coloured
    tail: float
    gain: Coloured = Coloured()
    laws: np.ndarray | None = None
    zero: Coloured = Coloured()
    own: Coloured = Coloured()
    course: Coloured = Coloured()
    late: float = 0.0

    def variance(self, series, level, factor, pixels):
        """Variance (t, C) of single samples of some level, of series (t,)."""
        law = self.constant, self.linear, self.quadratic
        law = law if self.laws is None else self.laws[series].T[..., None]
        return sample_variance(*law, level, factor, pixels)


NONE = Coloured()


def first_guess(model, gas):
    """Noise for the first fit, from round numbers and from what neighbouring bins differ by."""
    result = []
    for instrument, own in zip(model.instruments, gas, strict=True):
        lit = own[own.max(axis=1) > 0]  # none where an offset hides a faint gas
        level = np.median(lit, axis=0) if len(lit) else np.nanmax(np.abs(instrument.value), axis=0)
        variance = (START_RELATIVE * np.nan_to_num(instrument.value)) ** 2 + (START_CONSTANT * level) ** 2
        if len(instrument.value) > 1:
            variance += np.nan_to_num(clipped_variance(np.diff(instrument.value, axis=0), axis=0)) / 2
        variance = np.where(np.isfinite(instrument.value), variance, np.inf)
        bins = instrument.value.shape[0]
        result.append(Noise(variance, np.full(bins, START_FLICKER**2), np.full(bins, START_GAIN**2)))
    return result


def differences(values, chosen):
    """Differences over one and two steps of consecutive chosen samples (t, ...), and where they begin."""
    one = np.flatnonzero(chosen[1:] & chosen[:-1])
    two = np.flatnonzero(chosen[2:] & chosen[1:-1] & chosen[:-2])
    return values[one + 1] - values[one], values[two + 2] - values[two], one


def memory_beside_trend(values, chosen):
    r"""Autocorrelation of neighbours among consecutive chosen samples (t, C), NaN of fewer than five.

    By second differences over one and two steps, which see no trend; where samples k steps apart correlate
    by :math:`\rho^k`, the ratio of their variances is :math:`(3-\rho^2)(1+\rho)/(3-\rho)`.
    """
    five = np.flatnonzero(np.convolve(chosen, np.ones(5), "valid") > 4.5) if chosen.size > 4 else chosen[:0]
    if not five.size:
        return np.nan
    near, far = (values[five + 2 - k] - 2 * values[five + 2] + values[five + 2 + k] for k in (1, 2))
    memory = np.linspace(-0.5, LARGEST_MEMORY, 141)
    ratio = (3 - memory**2) * (1 + memory) / (3 - memory)
    return float(np.interp(clipped_variance(far) / clipped_variance(near), ratio, memory))


def clipped_variance(values, axis=None):
    """Variance about zero of what lies within `CLIP` robust standard deviations; NaN-aware."""
    centre = np.nanmedian(np.abs(values), axis=axis, keepdims=True) * 1.4826
    kept = np.where(np.abs(values) <= CLIP * np.maximum(centre, 1e-300), values, np.nan)
    return np.nanmean(kept**2, axis=axis)


def estimate(instrument, residual, prediction, gas, phase, other_flicker=None, series=None):
    """Noise model of one instrument from residuals of its samples.

    Parameters
    ----------
    instrument : Instrument
    residual, prediction, gas : (t, C) of the raw samples; NaN where not used
    phase : (t,) int
        Differences are not taken across phases.
    other_flicker : Coloured, of the gas as a faster instrument saw it, optional
    series : (t,) int, optional
        Those of a spectrometer each have a law of their own.

    Returns
    -------
    NoiseModel, and residuals with the flicker of the gas taken out (t, C).
    """
    laws, zero, each = None, Coloured(), Coloured()
    used = (instrument.raw_bin >= 0) & np.isfinite(residual).any(axis=1)
    same = np.zeros(used.size, dtype=bool)
    same[1:] = phase[1:] == phase[:-1]
    pixels = instrument.pixels
    factor = np.ones(instrument.channels) if instrument.factor is None else instrument.factor
    if instrument.kind == "pyrometer":
        rounded = instrument.rounded(prediction, 1) / factor**2
        law, memory, flicker, gain, left = _of_bands(
            residual / factor, prediction / factor, gas / factor, used, phase, period_of(instrument), rounded
        )
        left = left * factor
        own = (row / factor for row in (residual, prediction, gas))
        exposure = 2 * np.sqrt(3) * float(np.median(instrument.raw_moment.std(axis=1)))
        zero = _zero(*own, used, phase, period_of(instrument), exposure)
        each = _gains(residual, prediction, gas, used, phase, period_of(instrument), flicker)
    elif series is not None and series.max() > 0:
        apart = [series == one for one in range(series.max() + 1)]
        given = residual, prediction, gas, used, phase
        parts = [_many(instrument, *(a[own] for a in given), factor, pixels, other_flicker) for own in apart]
        series_laws, memories, flickers, gains, lefts = zip(*parts, strict=True)
        flicker, gain = (max(them, key=lambda one: one.total) for them in (flickers, gains))
        laws, law, memory = np.array(series_laws), series_laws[-1], float(np.mean(memories))
        left = np.concatenate(lefts)
    else:
        law, memory, flicker, gain, left = _many(
            instrument, residual, prediction, gas, used, phase, factor, pixels, other_flicker
        )
    one, _, place = differences(left, used)
    level = prediction[place]
    found = NoiseModel(*law, memory, flicker, 1.0, gain, laws, zero, each)
    furnace = series is not None
    series = series if furnace else np.zeros(used.size, dtype=int)
    sigma = np.sqrt(np.maximum(found.variance(series[place], level, factor, pixels), 1e-300))
    scaled = (one / (np.sqrt(2 * (1 - memory)) * sigma))[same[place + 1]]
    tail = np.mean(np.abs(scaled[np.isfinite(scaled)]) > 4) / 6.334e-5 if np.isfinite(scaled).any() else 1.0
    weight = 1 / np.maximum(found.variance(series, prediction, factor, pixels), 1e-300)
    late = _late(residual, prediction, gas, used, phase, instrument, weight, found)
    course = NONE if furnace else _course(left, prediction, used, phase, instrument, weight)
    return replace(found, tail=float(tail), late=late, course=course), left


def period_of(instrument):
    """Time [s] from sample to sample."""
    return float(np.median(np.diff(instrument.raw_moment[:, 0])))


def _unchanged(phase):
    """(t,) bool: samples in the phase of the one before."""
    return np.append(False, phase[1:] == phase[:-1])


def _lit(share, used):
    """Bands whose gas outshines the surface longest, two at least: as many that their samples times the root
    of their number, by which their noise falls, are most."""
    bright = share[used] > BRIGHT
    order = np.argsort(-bright.sum(axis=0), kind="stable")
    both = np.logical_and.accumulate(bright[:, order], axis=1).sum(axis=0) * np.sqrt(
        np.arange(1, order.size + 1)
    )
    number = max(int(both.argmax()) + 1, min(2, order.size))
    return np.sort(order[:number])


def _halves(values):
    """Means (t, 2) over every other band of values (t, C); twice the same of one band."""
    if values.shape[1] == 1:
        return np.repeat(values, 2, axis=1)
    return np.stack([values[:, ::2].mean(axis=1), values[:, 1::2].mean(axis=1)], axis=1)


def _of_bands(residual, prediction, gas, used, phase, period, rounded=0.0):
    """Law of the noise of C bands, from what they do not share, and what their halves do; at least what
    rounding makes of samples, a variance (t, C): those that stand still show no noise.

    All that one band shows without gas is its own noise, and its gas flickers by what there is besides.
    """
    same, bands = _unchanged(phase), residual.shape[1]
    alone = bands == 1
    share = gas / np.maximum(prediction, 1e-30)
    relative = residual / np.maximum(prediction, 1e-30)
    bright = used & (share.min(axis=1) > BRIGHT)
    clear = used & (share.max(axis=1) < CLEAR)
    of_gas, light = relative / np.maximum(share, 1e-9), Coloured()
    each = _halves(of_gas)
    lit = _lit(share, used)
    longer, halves = used & (share[:, lit].min(axis=1) > BRIGHT), _halves(of_gas[:, lit])
    enough = np.count_nonzero(longer[1:] & longer[:-1] & same[1:]) >= 8
    if enough and not alone:
        plain = np.zeros(used.size), longer, phase, period, LONGEST_FLICKER
        light = coloured(*halves.T, *plain)
        if not light.remembers:  # a noisy half hides a memory that the quiet one alone may show
            quiet = halves[:, np.argmin(clipped_variance(differences(halves, longer)[0], axis=0))]
            light = light.with_memory_of(coloured(quiet, quiet, *plain))
    rows, variances, counts, memories = [], [], [], []
    logarithm = np.log(np.maximum(prediction, 1e-30)) + relative
    little = used & (share.max(axis=1) < LITTLE)
    both = _halves(share).prod(axis=1)
    gain = Coloured()
    if not alone:
        for chosen in (clear, little):  # a gas that flickers hides what light without it shows
            gain = coloured(*_halves(logarithm).T, (both, light), chosen, phase, period, LONGEST_LAG)
            if gain.remembers:
                break
    # What bands share is a gain, or a temperature that falls faster than the knots can follow.
    apart = relative if alone else relative - relative.mean(axis=1, keepdims=True)
    rounded = np.broadcast_to(rounded, relative.shape) / np.maximum(prediction, 1e-30) ** 2
    mixed = np.eye(bands) if alone else (np.eye(bands) * (1 - 2 / bands) + bands**-2.0) / (1 - 1 / bands)
    told, rest = np.zeros_like(clear), 1.0 if alone else 1 - 1 / bands
    one, _, place = differences(apart, clear if alone or not enough else little)
    own = same[place + 1]
    unlike = (share - share.mean(axis=1, keepdims=True)) ** 2 / rest * light.between(period)
    for group in _level_groups(prediction[place, 0], own):
        parts = clipped_variance(one[group], axis=0) / 2 / rest
        flickers = unlike[place[group]].mean(axis=0)
        if not clear[place[group]].all() and (flickers > HIDDEN * parts).any():
            continue
        told[place[group]] = told[place[group] + 1] = True
        for band in range(bands):
            rows.append((*mixed[band] * np.mean(prediction[place[group]] ** -2.0, axis=0), 1.0))
            least = max(OWN * gain.between(period), np.mean(rounded[place[group], band]))
            variances.append(max(parts[band] - flickers[band], least))
            counts.append(group.size)
    number = np.count_nonzero(told[1:] & told[:-1] & same[1:])
    if number > LEAST_REMEMBERED and not gain.remembers:
        memories.append((memory_beside_trend(apart, told), number))
    # Faint light that falls by decades tells no relative noise, but the constant one.
    top = np.nanmax(prediction, axis=0)
    faint = clear[:, None] & (prediction < OF_FAINTEST * top)
    for band in range(0 if alone else bands):
        one, _, place = differences(residual[:, band], faint[:, band])
        own = same[place + 1]
        if own.sum() >= LEAST_IN_GROUP:
            place = place[own]
            level = np.mean(prediction[place, band] ** 2) / top[band] ** 2
            rows.append((*np.eye(bands)[band] / top[band] ** 2, level))
            least = np.mean((rounded * prediction**2)[place, band])
            variances.append(max(clipped_variance(one[own]) / 2, least) / top[band] ** 2)
            counts.append(own.sum())
    one, _, place = differences(of_gas, bright)
    own = same[place + 1]
    if own.sum() >= 8 and not alone:
        for band in range(bands):  # of each its own: what it does not share with the mean of the others
            mine, others = one[own, band], np.delete(one[own], band, axis=1).mean(axis=1)
            both, left, right = (clipped_variance(row) for row in (mine - others, mine, others))
            rows.append((*np.eye(bands)[band] * np.mean(prediction[place[own]] ** -2.0, axis=0), 1.0))
            least = np.mean((rounded / np.maximum(share, 1e-9) ** 2)[place[own], band])
            variances.append(max((both + left - right) / 4, least, OWN * both / 4))
            counts.append(max(own.sum() // LEVELS, LEAST_IN_GROUP))
    if not rows:  # too few samples of either kind, or none
        return (0.0, 0.0, START_RELATIVE**2), 0.0, light, gain, residual
    rows, variances = np.array(rows), np.maximum(variances, LEAST_NOISE**2)
    scale = np.maximum(rows.max(axis=0), 1e-300)
    told = np.sqrt(counts)  # a variance of n samples is known to the root of 2/n
    weight = told / np.maximum(variances, 1e-300)
    for _ in range(ROUNDS):
        solution, _ = nnls(rows / scale * weight[:, None], variances * weight)
        weight = told / np.maximum(rows / scale @ solution, 1e-3 * variances)
    constant, quadratic = np.split(solution / scale, [bands])
    quadratic = float(quadratic[0])
    memory = np.nan_to_num(memories[0][0]) if memories else 0.0
    memory = memory if memory > _least_memory(memories[0][1] if memories else 0) else 0.0
    if enough and alone:  # bright light, which tells little of a constant, must not make one of flicker
        most = clipped_variance(differences(relative, longer)[0]) / 2 - quadratic
        constant = np.minimum(constant, max(most, 0.0) / np.mean(prediction[longer] ** -2.0))
        error = (constant / np.maximum(prediction, 1e-30) ** 2 + quadratic) / np.maximum(share, 1e-9) ** 2
        error = error[:, 0]
        light = coloured(*each.T, error, bright, phase, period, LONGEST_FLICKER)
    swell = 1 / (1 - memory)
    return (constant * swell, 0.0, quadratic * swell), memory, light, gain, residual


def _zero(residual, prediction, gas, used, phase, period, exposure):
    """What lasts of the constant noise of the two bands whose gas outshines the surface longest, over its
    variance between neighbours: the flicker of the gas is in both alike, and nothing else is bright."""
    share = gas / np.maximum(prediction, 1e-30)
    pair = _lit(share, used)[:2]
    if pair.size < 2:
        return Coloured()
    apart = np.subtract(*(residual[:, pair] / np.maximum(gas[:, pair], 1e-30)).T)
    chosen = used & (share[:, pair].min(axis=1) > BRIGHT) & np.isfinite(apart)
    return flickering(apart[chosen], phase[chosen], period, 2 * np.log(2) * CORNER * exposure)


def _gains(residual, prediction, gas, used, phase, period, flicker=NONE):
    """1/f noise of the gain of each band, by itself, as long as a temperature or a wandering gain does not
    follow it: from what bands do not share of light that is bright and in which the gas does not flicker."""
    bands = residual.shape[1]
    if bands == 1:
        return Coloured()
    bright = (prediction > OF_HIGHEST * np.nanmax(prediction, axis=0)).all(axis=1)
    relative = residual / np.maximum(prediction, 1e-30)
    share = gas / np.maximum(prediction, 1e-30)
    unlike = (share - share.mean(axis=1, keepdims=True)).max(axis=1) ** 2 / (1 - 1 / bands)
    bright &= used & np.isfinite(relative).all(axis=1)
    apart = (relative - relative.mean(axis=1, keepdims=True)) / np.sqrt(1 - 1 / bands)
    chosen = bright & (share < CLEAR).all(axis=1)
    if flicker.total and np.count_nonzero(bright) > 1:
        usual = clipped_variance(np.diff(apart[bright], axis=0), axis=0).min() / 2
        chosen |= bright & (unlike * flicker.total < SEEN * usual)
    if np.count_nonzero(chosen) < THIRD.size:
        return Coloured()
    apart = apart[chosen]
    rough = np.maximum(clipped_variance(np.diff(apart, axis=0), axis=0) / 2, LEAST_NOISE**2)
    laws = [
        flickering(row, phase[chosen], period, OCTAVE**2 / size, LONGEST_LAG).scaled(size)
        for row, size in zip(apart.T, rough, strict=True)
    ]
    of_all = [law for law in laws if law.remembers]
    if not of_all:
        return Coloured()
    return replace(of_all[0], variance=np.mean([law.variance for law in of_all], axis=0))


def _course(residual, prediction, used, phase, instrument, weight):
    """Noise of the scale of a spectrometer over wavelength, by the amplitudes (t,) of the longest of its
    shapes in frames that tell them: 1/f noise as long as knots do not follow it, and what errors leave of the
    rest."""
    if instrument.kind != "spectrometer":
        return Coloured()
    shapes = course_shapes(instrument.wavelength)[-SHAPES:]
    rows = prediction[:, None] * shapes  # (t, m, C)
    weight = np.where(np.isfinite(residual), weight, 0.0)
    size = (rows * weight[:, None]) @ rows.transpose(0, 2, 1) + np.eye(len(rows[0]))
    error = np.diagonal(np.linalg.inv(size), axis1=1, axis2=2)
    told = used & (error < SEEN_GAIN**2).all(axis=1)
    if np.count_nonzero(told) < THIRD.size:
        return Coloured()
    pull = np.sum(rows * (weight * np.nan_to_num(residual))[:, None], axis=2)
    amplitude = np.linalg.solve(size[told], pull[told][..., None])[..., 0]
    rough = np.maximum(clipped_variance(np.diff(amplitude, axis=0), axis=0) / 2, LEAST_NOISE**2)
    white = np.maximum(rough - np.median(error[told], axis=0), 0.0)
    longest, period = np.ptp(instrument.raw_moment) / COURSE_KNOTS, period_of(instrument)
    parts = list(zip(amplitude.T, rough, strict=True))[:-1]  # the last is a gain, and taken out
    laws = [
        flickering(row, phase[told], period, OF_SHAPE**2 / own, longest).scaled(own) for row, own in parts
    ]
    plain, of_all = Coloured(float(white[:-1].mean())), [law for law in laws if law.remembers]
    if not of_all:
        return plain
    variance = np.mean([law.variance for law in of_all], axis=0)
    return replace(plain, variance=variance, time=of_all[0].time)


def slope_of(light, time, phase):
    """How fast light (t, C) changes, each phase for itself [1/s of its unit]."""
    slope = np.zeros(light.shape)
    for one in np.unique(phase):
        own = np.flatnonzero(phase == one)
        if own.size > 1:
            slope[own] = np.gradient(light[own], time[own], axis=0)
    return slope


def _late(residual, prediction, gas, used, phase, instrument, weight, law):
    r"""Standard deviation [s] of the times of samples: by how much more their light as a whole scatters where
    it changes fast.

    Third differences d of it over consecutive samples have the variance :math:`b + \sigma^2 s`, b of noise,
    gain and flicker, s of the squares of the rates; the mean of :math:`(d^2 - b)/s` is pooled with `JITTER`.
    """
    usual = min(JITTER[instrument.kind], OF_PERIOD * period_of(instrument))
    weight = np.where(np.isfinite(residual), weight, 0.0)
    whole = np.maximum(np.sum(weight * prediction**2, axis=1), 1e-300)
    slope = slope_of(prediction, instrument.raw_moment.mean(axis=1), phase)
    level, rate, share = (
        np.sum(weight * prediction * row, axis=1) / whole for row in (np.nan_to_num(residual), slope, gas)
    )
    variance = 1 / whole + law.gain.total + law.flicker.total * share**2 + law.own.total / prediction.shape[1]
    chosen = used & (phase == np.roll(phase, 3))
    four = np.flatnonzero(np.convolve(chosen, np.ones(4), "valid") > 3.5) + np.arange(4)[:, None]
    if not four.size:
        return usual
    square, base, fast = (THIRD @ level[four]) ** 2, THIRD**2 @ variance[four], THIRD**2 @ rate[four] ** 2
    fast, found = np.maximum(fast, 1e-300), usual**2
    for _ in range(JITTER_ROUNDS):
        told = (fast * found / (fast * found + base)) ** 2
        scaled = square / (base + fast * found)
        told = np.where(scaled <= OUTLYING * np.median(scaled), told, 0.0) / OVERLAP
        excess = JITTER_FREEDOM * usual**2 + np.sum(told * (square - base) / fast)
        found = max(excess / (JITTER_FREEDOM + told.sum()), (LEAST_JITTER * usual) ** 2)
    return float(np.sqrt(found))


def _least_memory(count):
    """Autocorrelation below which `count` neighbours cannot tell it from none."""
    return max(LEAST_MEMORY, 2.5 / np.sqrt(max(count, 1)))


def _level_groups(level, chosen):
    """Index arrays of chosen samples in groups of alike level."""
    place = np.flatnonzero(chosen)
    levels = min(LEVELS, place.size // LEAST_IN_GROUP)
    if levels < 2:
        return
    edges = np.quantile(level[place], np.linspace(0, 1, levels + 1))
    for low, high in zip(edges[:-1], edges[1:], strict=True):
        group = place[(level[place] >= low) & (level[place] <= high)]
        # Where light falls by decades in one, its variance is of the bright, its mean of 1/S^2 of the faint.
        octave = np.floor(np.log2(np.maximum(level[group], 1e-30) / max(low, 1e-30)))
        for one in np.unique(octave):
            if (octave == one).sum() >= LEAST_IN_GROUP:
                yield group[octave == one]


def _many(instrument, residual, prediction, gas, used, phase, factor, pixels, other_flicker):
    """Law of the noise of a spectrometer, the brightness of gas and of all light of each frame taken out."""
    same, gain = _unchanged(phase), Coloured()
    law = np.array([1.0, 0.0, 0.0])
    left, flicker, memory = residual, Coloured(), 0.0
    exposure = 2 * np.sqrt(3) * float(np.median(instrument.raw_moment.std(axis=1)))
    period = period_of(instrument)
    for last in range(ROUNDS):
        one, _, place = differences(left, used)
        whole = same[place + 1]
        level = (prediction[place + 1] + prediction[place])[whole] / 2
        law = _fit_variance(one[whole], level, factor, pixels)
        memory = _memory(left, prediction, used, law, factor, pixels)
        variance = sample_variance(*law, prediction, factor, pixels) / (1 - memory)
        if last < ROUNDS - 1:
            weight = np.where(np.isfinite(residual), 1 / np.maximum(variance, 1e-300), 0.0)
            shared = np.stack([gas, prediction], axis=1)
            size = (shared * weight[:, None]) @ shared.transpose(0, 2, 1)  # (t, 2, 2)
            pull = np.sum(shared * (weight * np.nan_to_num(residual))[:, None], axis=2)
            # Each with the other as uncertain as was found in the round before.
            level, error = _beside(size, pull, 0, gain.total)
            bright = used & (error < SEEN_GAS**2)
            flicker = coloured(level, level, error, bright, phase, period, LONGEST_FLICKER)
            if other_flicker is not None and not flicker.remembers:
                own = _frame_flicker(level, error, bright, same)
                flicker = _pooled(*own, other_flicker.seen_over(exposure))
            level, error = _beside(size, pull, 1, flicker.total)
            seen = used & (error < SEEN_GAIN**2)
            whole = prediction @ np.median((weight * prediction)[seen], axis=0) if seen.any() else level
            level = np.log(np.maximum(whole, 1e-300)) + level
            gain = coloured(level, level, error, seen, phase, period, LONGEST_LAG)
            inner = np.linalg.inv(size + np.diag(1 / np.maximum([flicker.total, gain.total], 1e-12)))
            pair = inner @ pull[..., None]
            left = residual - (pair.transpose(0, 2, 1) @ shared)[:, 0]
    swell = 1 / (1 - memory)
    return tuple(law * swell), memory, flicker, gain, left


def _beside(size, pull, which, variance):
    """Level (t,) of one of two factors common to a frame and its error, the other one of some variance."""
    other = 1 - which
    there = size[:, other, other] + 1 / max(variance, 1e-12)
    information = np.maximum(size[:, which, which] - size[:, 0, 1] ** 2 / there, 1e-300)
    return (pull[:, which] - size[:, 0, 1] / there * pull[:, other]) / information, 1 / information


def _frame_flicker(level, error, chosen, same):
    """Variance of the brightness from frame to frame, and the number of pairs of frames behind it."""
    one, _, place = differences(level, chosen)
    own = same[place + 1]
    one, noise = one[own], (error[place] + error[place + 1])[own]
    if one.size < 4:
        return 0.0, 0
    weight = 1.0 / (noise + 2e-4) ** 2
    kept = np.abs(one) < CLIP * 1.4826 * np.median(np.abs(one))
    value = np.sum((weight * (one**2 - noise))[kept]) / np.sum(weight[kept]) / 2
    return max(float(value), 0.0), int(own.sum())


def _pooled(own, count, expected):
    """Flicker of exposures: what `count` pairs of frames show [1], a variance, pooled with what a faster
    instrument makes expect."""
    pooled = (count * own + FLICKER_FRAMES * expected.total) / (count + FLICKER_FRAMES)
    return expected.scaled(pooled / expected.total) if expected.total else Coloured(white=pooled)


def sample_variance(constant, linear, quadratic, level, factor, pixels):
    """Variance (t, C) of single samples of some level; of one that is not above 0, that of a faint one."""
    faint = FAINTEST * np.mean(np.maximum(level, 0.0), axis=0)
    level = np.where(level > 0, level, faint)
    return (constant * factor**2 + linear * factor * level) / pixels + quadratic * level**2


def _fit_variance(difference, level, factor, pixels):
    """Non-negative a, b, c of `NoiseModel` from differences of neighbours (d, C), in groups of alike level:
    in counts, of which channels of unlike sensitivity have the same noise."""
    there = np.isfinite(difference)
    one = factor / np.sqrt(pixels)  # the mean of a channel, in its unit, that is uncertain by one count
    difference, whole, level = (
        (rows / scale)[there] for rows, scale in ((difference, one), (level, one), (level, factor))
    )
    if difference.size < LEAST_IN_LEVEL:
        return np.array([0.0, 0.0, START_RELATIVE**2])
    groups = np.array_split(np.argsort(level), min(MOST_LEVELS, difference.size // LEAST_IN_LEVEL))
    rows = np.array([(1.0, level[own].mean(), np.mean(whole[own] ** 2)) for own in groups])
    variances = np.array([clipped_variance(difference[own]) / 2 for own in groups])
    variances = np.maximum(variances, LEAST_NOISE**2 * rows[:, 2])
    rows[:, 1] = np.maximum(rows[:, 1], 0.0)
    scale = np.maximum(rows.max(axis=0), 1e-300)
    weight = 1 / np.maximum(variances, 1e-300)
    for _ in range(ROUNDS):
        solution, _ = nnls(rows / scale * weight[:, None], variances * weight)
        weight = 1 / np.maximum(rows / scale @ solution, 1e-3 * variances)
    return solution / scale


def _memory(residual, prediction, used, law, factor, pixels):
    """Autocorrelation of neighbours, from steps of one and two samples."""
    sigma = np.sqrt(sample_variance(*law, prediction, factor, pixels))
    one, two, _ = differences(residual / sigma, used)
    if not np.isfinite(two).any():
        return 0.0
    first, second = clipped_variance(one), clipped_variance(two)
    memory = float(np.clip(second / first - 1, -0.5, LARGEST_MEMORY))
    return memory if memory > LEAST_MEMORY else 0.0


def on_bins(model_noise, instrument, prediction, phase, unresolved=(0.0, 0.0, 0.0)):
    """`Noise` of the bins of an instrument in phases (n,), from that of its samples; at least what is
    `unresolved` of the gains (n,) of all channels, of each, and of the course over wavelength."""
    factor = np.ones(instrument.channels) if instrument.factor is None else instrument.factor
    pixels = instrument.pixels
    own = instrument.raw_bin >= 0
    series = np.zeros(len(prediction), dtype=int)
    series[instrument.raw_bin[own]] = binning.series(instrument.raw_moment.mean(axis=1))[own]
    one = model_noise.variance(series, prediction, factor, pixels)
    samples = np.maximum(instrument.number, 1)
    variance = one / samples * (1 + model_noise.memory) / (1 - model_noise.memory)
    if model_noise.zero.remembers:
        lasting = model_noise.zero.of_mean(samples.ravel(), period_of(instrument)).reshape(samples.shape)
        variance += sample_variance(model_noise.constant, 0.0, 0.0, prediction, factor, pixels) * lasting
    own_gain = model_noise.own.of_mean(samples.ravel(), period_of(instrument)).reshape(samples.shape)
    variance += prediction**2 * np.maximum(own_gain, np.reshape(unresolved[1], (-1, 1)))
    variance += instrument.rounded(prediction, samples)
    mean_samples = np.maximum(instrument.number.max(axis=1), 1)
    flicker, gain = (
        FLICKER_MARGIN * law.of_mean(mean_samples, period_of(instrument))
        for law in (model_noise.flicker, model_noise.gain)
    )
    gain = np.maximum(gain, unresolved[0])
    course, shapes = course_on_bins(model_noise, instrument, unresolved[2]), ()
    if np.any(course):
        shapes = course_shapes(instrument.wavelength)
    late = 0.0
    if model_noise.late:
        of_mean = model_noise.late / np.sqrt(mean_samples)[:, None]
        late = of_mean * slope_of(prediction, instrument.time, phase)
    variance = np.where(np.isfinite(instrument.value), variance, np.inf)
    return Noise(variance, flicker, gain, late, course, shapes)


def course_on_bins(model_noise, instrument, unresolved):
    """Variance (n,) [1] of the course over wavelength in the bins of an instrument, at least what is
    `unresolved` of it; 0 for one without."""
    if not np.any(unresolved):
        return 0.0
    samples = np.maximum(instrument.number.max(axis=1), 1)
    return np.maximum(model_noise.course.of_mean(samples, period_of(instrument)), unresolved)
