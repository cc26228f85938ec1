"""Rules for the signals of the pyrometer alone."""

import numpy as np

from plasmapyro.quality.rule import BANDS, DOUBT, rule
from plasmapyro.quality.series import SIDE, SIGMA, blocks, longest_run, steps, widened
from plasmapyro.record import flags
from plasmapyro.record.record import gas_of

LARGE = 1.1  # a signal changes at all if it does by this factor
CLEAR = 10.0  # deviations of a step that stands out
SWITCH = 2.0  # [s] around injection and the end of the plasma, where signals jump as they should
BRIGHT = 0.2  # of the largest signal: where the surface rules


def _surface(case):
    """Signals (2, n) of the surface alone where it rules in both bands."""
    own = case.pair - gas_of(case.test, case.pair.T).T
    injected = case.test.time.values >= case.test.attrs["injection_time"]
    share = np.where(injected & (case.pair > 0), own / case.pair, 0.0)
    top = np.nanmax(np.where(injected, own, np.nan), axis=1, keepdims=True)
    return own[:, (share > 0.5).all(axis=0) & (own > BRIGHT / 10 * top).all(axis=0)]


@rule(
    "equal_channels",
    looks_at="ratio of both signals",
    needs=("pyrometer",),
    limit=1e-5,
    unit="1",
    reason="two amplifiers never agree to five digits while the light changes",
    says="both signals of the pyrometer are the same column: their ratio is {ratio:.6g} in all samples, while"
    " they change by a factor of {change:.3g}",
    remedy="name the column of each band in test.yaml",
)
def equal_channels(case, limit):
    good = (case.pair > 0).all(axis=0)
    if good.sum() < 3:
        return None
    wide, narrow = case.pair[:, good]
    ratio, change = wide / narrow, wide.max() / wide.min()
    if change < LARGE or np.ptp(ratio) > limit * ratio.mean():
        return None
    return {"ratio": float(ratio.mean()), "change": float(change)}


@rule(
    "swapped_bands",
    looks_at="slope of the ratio wide/narrow over the signals of the surface, both logarithmic",
    needs=("pyrometer", "plasma"),
    limit=-0.02,
    unit="1",
    reason="shorter wavelengths grow faster: the ratio rises by 0.06 to 0.1 per unit; noise and gas give less"
    " than 0.02 the other way",
    says="the ratio wide/narrow falls while both signals rise (slope {slope:.3f}, a heating surface gives"
    " +0.06 to +0.1)",
    remedy="exchange the columns of signal_wide and signal_narrow, or see which gain changed",
)
def swapped_bands(case, limit):
    own = _surface(case)
    if own.shape[1] < 10 or own.max() < 2 * own.min():
        return None
    wide, narrow = np.log(own)
    level = (wide + narrow) / 2
    centred = level - level.mean()
    if centred.std() < 0.2:
        return None
    slope = np.sum(centred * (wide - narrow)) / np.sum(centred**2)
    return {"slope": slope} if slope < limit else None


@rule(
    "negative_signal",
    looks_at="share of samples below zero after injection",
    needs=("pyrometer", "plasma"),
    limit=0.1,
    unit="1",
    reason="light is positive; offsets and noise bring single samples below zero",
    says="{band} is below zero in {share:.0%} of the samples after injection, the lowest is {lowest:.3g} A",
    remedy="reverse the sign (`scale: -1`) if the amplifier inverts, or take its offset off",
)
def negative_signal(case, limit):
    injected = case.test.time.values >= case.test.attrs["injection_time"]
    for band, row in zip(BANDS, case.pair[:, injected], strict=True):
        share = np.mean(row[np.isfinite(row)] < 0) if np.isfinite(row).any() else 0.0
        if share > limit:
            return {"band": f"signal_{band}", "share": float(share), "lowest": float(np.nanmin(row))}
    return None


@rule(
    "stuck",
    looks_at="runs of samples in which a signal stays what it was",
    needs=("pyrometer", "plasma"),
    limit=flags.LONGEST,
    unit="samples",
    reason="plasma flickers; a longer run, rarer by chance than 1 in a million, is a logger that waits",
    says="{what} exactly the same over {count} samples, from {begin:.6g} to {end:.6g} s",
    remedy="remove those lines: they repeat an old sample; see why the logger stopped",
)
def stuck(case, limit):
    alone = [
        flags.stuck(row[:, None], True) & ((row < np.nanmax(row)) | (row == np.nanmin(row)))
        for row in case.pair
    ]
    held = {"both signals stay": flags.stuck(case.pair.T, True)}
    held |= {f"signal_{band} stays": row for band, row in zip(BANDS, alone, strict=True)}
    for what, samples in held.items():
        begin, count = longest_run(samples)
        if count >= limit:
            time = case.test.time.values
            begin, end = max(begin - 1, 0), begin + count - 1  # the first of a run is a measurement
            return {"what": what, "count": count + 1, "begin": float(time[begin]), "end": float(time[end])}
    return None


@rule(
    "flat_top",
    looks_at="samples at exactly the highest value of a signal",
    needs=("pyrometer",),
    limit=5,
    unit="samples",
    reason="noise spreads the highest samples; a converter or an amplifier at its end does not. Rounding"
    " would"
    " fill the next value below as well: that must hold fewer than a third as many",
    says="signal_{band} stands at exactly its highest value, {top:.6g} A, in {count} samples, first at"
    " {begin:.6g} s: the amplifier or the converter is at its end",
    remedy="state `signal_saturation_{band}: {limit:.6g}` in test.yaml, so that these samples are left out",
)
def flat_top(case, limit):
    for band, row in zip(BANDS, case.pair, strict=True):
        values, counts = np.unique(row[np.isfinite(row)], return_counts=True)
        if values.size < 2 or counts[-1] < limit or counts[-1] <= 3 * counts[-2]:
            continue
        top = float(values[-1])
        if case.test.attrs.get(f"signal_saturation_{band}", np.inf) > top > 0:
            begin = float(case.test.time.values[np.argmax(row == top)])
            below = top * (1 - 1e-5)
            return {"band": band, "top": top, "count": int(counts[-1]), "begin": begin, "limit": below}
    return None


@rule(
    "rounded_top",
    looks_at="slope of one signal over the other at its top, both logarithmic and without the gas",
    needs=("pyrometer",),
    limit=flags.LEAST_SLOPE,
    unit="of the slope below",
    reason="the slopes of two bands change by some per cent over the range of a surface; a photodiode or an"
    " amplifier near its end gives less and less",
    says="signal_{band} bends away from the other one above {level:.3g} A, first at {begin:.6g} s: its"
    " detector or amplifier is near its end ({count} samples are left out)",
    remedy="lower its gain; see whether signal_saturation_{band} should be {level:.3g}",
)
def rounded_top(case, limit):
    beyond = flags.rounded(case.pair.T, gas_of(case.test, case.pair.T))
    for band, row, high in zip(BANDS, case.pair, beyond.T, strict=True):
        if high.any():
            return {
                "band": band,
                "level": float(row[high].min()),
                "begin": float(case.test.time.values[np.argmax(high)]),
                "count": int(high.sum()),
            }
    return None


@rule(
    "unit_of_signals",
    looks_at="largest signal",
    needs=("pyrometer",),
    limit=1.0,
    unit="A",
    reason="photodiodes give less than a milliampere",
    says="{band} reaches {top:.3g} A, more than a photodiode gives",
    remedy="see whether its unit is right (the ratio, and so the temperature, does not depend on a common"
    " one)",
    severity=DOUBT,
)
def unit_of_signals(case, limit):
    for band, row in zip(BANDS, case.pair, strict=True):
        top = np.nanmax(np.abs(row))
        if top > limit:
            return {"band": f"signal_{band}", "top": float(top)}
    return None


@rule(
    "unexplained_step",
    looks_at="steps of a signal, or of the ratio, away from injection and the end of the plasma",
    needs=("pyrometer", "plasma"),
    limit=0.02,
    unit="1",
    reason="2 % in a ratio are 30 K at 1600 K; a surface changes by seconds, an amplifier, a cable or a"
    " window"
    " at once. A step must also be ten times the scatter of such steps",
    says="{what} steps by {height:+.1%} at {moment:.6g} s, away from injection ({injection:g} s) and the"
    " end of the"
    " plasma ({off:g} s)",
    remedy="see whether a gain, the aim, the power or the window changed then; cut the record there, or"
    " correct"
    " the time that is wrong in test.yaml",
)
def unexplained_step(case, limit):
    attrs = case.test.attrs
    begin, off = attrs["injection_time"], attrs["plasma_off_time"]
    reach = (off - begin) / 4
    time, pair = blocks(case.test.time.values, case.pair, begin, off + reach)
    if time.size < 30 or not (pair > 0).all():
        return None
    step = float(np.median(np.diff(time)))
    near = np.minimum(np.abs(time - begin), np.abs(time - off)) < max(SWITCH, 8 * step)
    wide, narrow = np.log(pair)
    window = (time >= attrs["reference_window"][0]) & (time <= attrs["reference_window"][1])
    gas = pair[:, window].mean(axis=1, keepdims=True) if window.any() else np.zeros((2, 1))
    # Where there was only the light of the gas, a surface may come into view.
    rises = np.append((np.diff(pair, axis=1) > 0).all(axis=0), False)
    near |= widened(rises & (pair < 1.2 * gas).all(axis=0), SIDE)
    rows = {"the ratio wide/narrow": wide - narrow, "signal_wide": wide, "signal_narrow": narrow}
    for what, row in rows.items():
        height, deviations = steps(row)
        size = np.abs(height)
        around = np.lib.stride_tricks.sliding_window_view(np.pad(size, SIDE), 2 * SIDE + 1).max(axis=1)
        # A step is seen, smaller, in the lines beside it as well: its place is where it is largest.
        found = np.where(near | (np.abs(deviations) < CLEAR) | (size < around), 0.0, height)
        place = int(np.argmax(np.abs(found)))
        if abs(found[place]) > limit:
            return {
                "what": what,
                "height": float(np.expm1(found[place])),
                "moment": float(time[place : place + 2].mean()),
                "injection": begin,
                "off": off,
            }
    return None


@rule(
    "spikes",
    looks_at="single samples in the reference window far from their neighbours",
    needs=("pyrometer", "plasma"),
    limit=12.0,
    unit="standard deviations",
    reason="normal noise reaches 5 in a record of millions; pick-up from the arc goes far beyond, and shifts"
    " the mean that is subtracted",
    says="{band} has {count} samples in the reference window more than 12 standard deviations from their"
    " neighbours, the first at {moment:.6g} s",
    remedy="leave those cells empty, or choose another reference window",
)
def spikes(case, limit):
    low, high = case.test.attrs["reference_window"]
    time = case.test.time.values
    inside = np.flatnonzero((time >= low) & (time <= high))
    if inside.size < 20:
        return None
    for band, row in zip(BANDS, case.pair[:, inside], strict=True):
        rest = row[1:-1] - (row[:-2] + row[2:]) / 2
        noise = SIGMA * np.nanmedian(np.abs(rest))
        size = np.abs(rest)
        # The neighbours of a spike are half as far from theirs.
        highest = size >= np.maximum(np.append(size[1:], 0), np.append(0, size[:-1]))
        least = max(limit * noise, 0.02 * np.nanmedian(np.abs(row)))
        far = np.flatnonzero(highest & (size > least)) if noise > 0 else np.array([], dtype=int)
        if far.size:
            moment = float(time[inside[far[0] + 1]])
            return {"band": f"signal_{band}", "count": far.size, "moment": moment}
    return None


@rule(
    "scatter_of_signals",
    looks_at="scatter of the brightest samples from one to the next, relative",
    needs=("pyrometer",),
    limit=0.03,
    unit="1",
    reason="a correction takes each signal as known to 1 % (`--signal-uncertainty`); a surface does not"
    " flicker, hum of the mains and loose contacts do",
    says="signal_{band} scatters by {share:.1%} from sample to sample where it is brightest",
    remedy="see whether hum or a loose contact is in it, or state a larger --signal-uncertainty",
)
def scatter_of_signals(case, limit):
    for band, row in zip(BANDS, case.pair, strict=True):
        bright = row[row > BRIGHT * np.nanmax(row)] if np.isfinite(row).any() else row[:0]
        if bright.size < 20:
            continue
        rest = (bright[1:-1] - (bright[:-2] + bright[2:]) / 2) / bright[1:-1]
        share = float(SIGMA * np.median(np.abs(rest)) / np.sqrt(1.5))
        if share > limit:
            return {"band": band, "share": share}
    return None


@rule(
    "dark_reference",
    looks_at="light in the reference window over the dark before the record's first light",
    needs=("pyrometer", "plasma"),
    limit=1e-3,
    unit="1",
    reason="the light of the plasma is 1 % or more of the brightest surface in all conditions of the paper;"
    " a thousandth says that the plasma did not burn",
    says="in the reference window the signals are {share:.1g} of their highest: no light of a plasma",
    remedy="see whether injection_time and reference_window lie where the plasma burns, or say `condition:"
    " none`",
)
def dark_reference(case, limit):
    low, high = case.test.attrs["reference_window"]
    time = case.test.time.values
    inside = (time >= low) & (time <= high)
    share = np.nanmedian(case.pair[:, inside], axis=1) / np.nanmax(case.pair, axis=1)
    return {"share": float(np.abs(share).max())} if np.abs(share).max() < limit else None
