"""Rules for the signals of the pyrometer alone."""

import numpy as np

from plasmapyro.instrument.spectrometer import NORMAL_MAD
from plasmapyro.quality.rule import rule
from plasmapyro.quality.series import SIDE, blocks, longest_run, steps, widened
from plasmapyro.radiation.bandsignal import BANDS
from plasmapyro.record import flags
from plasmapyro.record.record import gas_of

LARGE = 1.1  # a signal changes at all if it does by this factor
CLEAR = 10.0  # deviations of a step that stands out
SWITCH = 2.0  # [s] around injection and the end of the plasma, where signals jump as they should
SURE = 3.0  # standard errors of a slope, or deviations of noise
BRIGHT = 0.2  # of the largest signal: where the surface rules


def _surface(case):
    """Signals (2, n) of the surface alone where it rules in both bands."""
    own = case.pair - gas_of(case.test, case.pair.T).T
    injected = case.test.time.values >= case.test.attrs["injection_time"]
    share = np.where(injected & (case.pair > 0), own / case.pair, 0.0)
    top = np.nanmax(np.where(injected, own, np.nan), axis=1, keepdims=True)
    return own[:, (share > 0.5).all(axis=0) & (own > BRIGHT / 10 * top).all(axis=0)]


@rule()
def equal_channels(case, limit):
    good = (case.pair > 0).all(axis=0)
    if good.sum() < 3:
        return None
    wide, narrow = case.pair[:, good]
    ratio, change = wide / narrow, wide.max() / wide.min()
    if change < LARGE or np.ptp(ratio) > limit * ratio.mean():
        return None
    return {"ratio": float(ratio.mean()), "change": float(change)}


@rule()
def swapped_bands(case, limit):
    own = _surface(case)
    if own.shape[1] < 10 or own.max() < 2 * own.min():
        return None
    wide, narrow = np.log(own)
    level = (wide + narrow) / 2
    centred = level - level.mean()
    if centred.std() < 0.2:
        return None
    ratio = wide - narrow - np.mean(wide - narrow)
    slope = np.sum(centred * ratio) / np.sum(centred**2)
    # Noise of one band is in level and ratio, which tilts one over the other by half its variance at most.
    scatter = np.std(ratio - slope * centred) / centred.std()
    error = scatter**2 / 2 + SURE * scatter / np.sqrt(level.size)
    return {"slope": slope} if slope + error < limit else None


@rule()
def negative_signal(case, limit):
    injected = case.test.time.values >= case.test.attrs["injection_time"]
    for band, row in zip(BANDS, case.pair[:, injected], strict=True):
        row = row[np.isfinite(row)]
        below = row[row < 0]  # of which noise about zero makes some
        scatter = NORMAL_MAD * np.median(np.abs(np.diff(below, 2))) / np.sqrt(6) if below.size > 2 else 0.0
        least = max(SURE * scatter, flags.STEPS * float(flags.least_change(row)))
        share = np.mean(row < -least) if row.size else 0.0
        if share > limit:
            return {"band": f"signal_{band}", "share": float(share), "lowest": float(np.nanmin(row))}
    return None


@rule(limit=flags.LONGEST)
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


@rule(limit=flags.REPEATED)
def asked_too_often(case, limit):
    again = flags.asked_again(case.pair.T)
    if not again.any():
        return None
    step = np.median(np.diff(case.test.time.values[~again]))
    return {"share": float(again.mean()), "step": float(step)}


@rule(limit=flags.LONGEST)
def end_of_display(case, limit):
    if "radiometer_reading" not in case.test:
        return None
    shown = case.test.radiometer_reading.values[:, 0]
    shown = np.where(shown > 0, shown, np.nan)
    least = np.nanmin(shown) if np.isfinite(shown).any() else np.nan
    begin, count = longest_run(shown == least)
    if count < limit or count == np.isfinite(shown).sum():
        return None
    begin = float(case.test.radiometer_time.values[begin])
    return {"count": count, "begin": begin, "least": float(least)}


@rule()
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


@rule(limit=flags.LEAST_SLOPE)
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


@rule()
def unit_of_signals(case, limit):
    for band, row in zip(BANDS, case.pair, strict=True):
        top = np.nanmax(np.abs(row))
        if top > limit:
            return {"band": f"signal_{band}", "top": float(top)}
    return None


@rule()
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
    # Where there was only the light of the gas, a surface may come into view; in the window it must not.
    rises = np.append((np.diff(pair, axis=1) > 0).all(axis=0), False)
    near |= widened(rises & (pair < 1.2 * gas).all(axis=0) & ~window, SIDE)
    near |= widened(np.append(np.diff(time) > 1.5 * step, False), SIDE)  # missing samples hide how it rose
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


@rule(limit=flags.SPIKE)
def spikes(case, limit):
    far = flags.spiked(case.pair.T).T
    if not far.any():
        return None
    time, band = case.test.time.values, int(np.argmax(far.any(axis=1)))
    words = " and ".join(f"signal_{name}" for name, row in zip(BANDS, far, strict=True) if row.any())
    return {"band": words, "count": int(far.any(axis=0).sum()), "moment": float(time[np.argmax(far[band])])}


@rule()
def scatter_of_signals(case, limit):
    for band, row in zip(BANDS, case.pair, strict=True):
        bright = row[row > BRIGHT * np.nanmax(row)] if np.isfinite(row).any() else row[:0]
        if bright.size < 20:
            continue
        rest = (bright[1:-1] - (bright[:-2] + bright[2:]) / 2) / bright[1:-1]
        share = float(NORMAL_MAD * np.median(np.abs(rest)) / np.sqrt(1.5))
        if share > limit:
            return {"band": band, "share": share}
    return None


@rule()
def dark_reference(case, limit):
    low, high = case.test.attrs["reference_window"]
    time = case.test.time.values
    inside = (time >= low) & (time <= high)
    share = np.nanmedian(case.pair[:, inside], axis=1) / np.nanmax(case.pair, axis=1)
    return {"share": float(np.abs(share).max())} if np.abs(share).max() < limit else None
