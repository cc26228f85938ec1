"""Rules for times: what the signals say of injection, end of the plasma and clocks."""

import numpy as np

from plasmapyro.quality.rule import rule
from plasmapyro.quality.series import blocks, fall
from plasmapyro.record import flags
from plasmapyro.record.clock import lag
from plasmapyro.record.inputs import OF_PLASMA
from plasmapyro.record.phases import unlit

BLOCK = 1.0  # [s] mean of the pyrometer in which its fall is looked for
FARTHEST = 12.0  # [s] clocks are compared up to this
FRAMES = 8  # fewer spectra do not tell a lag
MISSED = 1.5  # usual steps: a sample is missing
GAPS = 10  # times the usual step, or the second it may be


def _span(case, axis):
    """Usual step and least tolerance [s] of an axis."""
    time = case.test[axis].values
    least = case.exposure if axis == "spectrum_time" else 1.0
    return max(least, 2 * float(np.median(np.diff(time))) if time.size > 1 else least)


def _axes(case):
    axes = ("time", "radiometer_time", "spectrum_time")
    return [axis for axis in axes if axis in case.test.variables and case.test[axis].size]


@rule()
def record_begins_late(case, limit):
    begin = case.test.attrs["injection_time"]
    for axis in _axes(case):
        first = float(case.test[axis].values[0])
        if first > begin + _span(case, axis) / 2 * limit:
            return {"axis": axis, "first": first, "begin": begin}
    return None


@rule()
def record_ends_early(case, limit):
    off = case.test.attrs["plasma_off_time"]
    for axis in _axes(case):
        last = float(case.test[axis].values[-1])
        if last < off - _span(case, axis) / 2 * limit:
            return {"axis": axis, "last": last, "off": off}
    return None


@rule()
def few_in_plasma(case, limit):
    for axis in _axes(case):
        time, count = case.test[axis].values, int(case.shining(axis).sum())
        if count < limit:
            attrs = case.test.attrs
            return {
                "axis": axis,
                "count": count,
                "begin": attrs["injection_time"],
                "off": attrs["plasma_off_time"],
                "first": float(time[0]),
                "last": float(time[-1]),
            }
    return None


@rule(limit=GAPS)
def gaps(case, limit):
    for axis in _axes(case):
        time = case.test[axis].values
        holes = np.flatnonzero(np.diff(time) > limit * _span(case, axis))
        if holes.size:
            begin, end = float(time[holes[0]]), float(time[holes[0] + 1])
            return {"axis": axis, "count": holes.size, "begin": begin, "end": end}
    return None


@rule()
def integration_longer_than_step(case, limit):
    time = case.test.time.values
    step = float(np.median(np.diff(time))) if time.size > 1 else np.inf
    stated = case.test.attrs["pyrometer_integration_time"]
    return {"stated": stated, "step": step} if stated > limit * step else None


def _falls(case):
    """Instrument -> span of time in which its signal begins to fall for good, and by how much in a step."""
    attrs = case.test.attrs
    begin = attrs["reference_window"][1]
    found = {}
    if "pyrometer" in case.holds:
        time, (narrow,) = blocks(case.test.time.values, case.pair[1:], begin, np.inf, BLOCK)
        found["pyrometer"] = fall(time, narrow, BLOCK)
    if "radiometer_signal" in case.test:
        longest = case.test.radiometer_signal.values.T[-1:]
        time, (light,) = blocks(case.test.radiometer_time.values, longest, begin, np.inf, BLOCK)
        found["radiometer"] = fall(time, light, BLOCK)
    if "spectrometer" in case.holds:
        time = case.test.spectrum_time.values
        held = (time >= begin) & np.isfinite(case.light)
        found["spectrometer"] = fall(time[held], case.light[held], case.exposure)
    return {name: span for name, span in found.items() if span is not None}


@rule()
def plasma_off_time(case, limit):
    off = case.test.attrs["plasma_off_time"]
    for name, (first, last, drop) in _falls(case).items():
        if not first - limit <= off <= last + limit:
            return {"name": name, "first": first, "last": last, "drop": drop, "off": off}
    return None


def _seen(case):
    """Instrument -> axis and light (t, C) of what a test holds."""
    seen = {}
    if "pyrometer" in case.holds:
        seen["pyrometer"] = "time", case.pair.T
    if "radiometer_signal" in case.test:
        seen["radiometer"] = "radiometer_time", case.test.radiometer_signal.values
    if "spectrometer" in case.holds:
        seen["spectrometer"] = "spectrum_time", case.light[:, None]
    return seen


def of_other_tests(case):
    """Instrument -> axis and samples (t,) of what pauses part from the test: other tests in the same log."""
    if "plasma" not in case.holds:
        return {}
    attrs, found = case.test.attrs, {}
    begin, window = attrs["injection_time"], np.array(attrs["reference_window"])
    for name, (axis, light) in _seen(case).items():
        time = case.test[axis].values
        parted = np.flatnonzero(flags.pauses(time)) + 1
        later = flags.relit(time, light, attrs["plasma_off_time"])
        earlier = unlit(time - begin, light, window - begin)
        gas = light[(time >= window[0]) & (time <= window[1])]
        earlier &= np.nanmax(light[earlier], initial=0.0) > np.nanmax(gas, initial=0.0)  # not the dark alone
        other = (later & np.isin(np.argmax(later), parted)) | (earlier & np.isin(earlier.sum(), parted))
        if other.any():
            found[name] = axis, other
    return found


@rule(limit=flags.PAUSE)
def another_test(case, limit):
    for name, (axis, other) in (of_other_tests(case.whole) if case.whole else {}).items():
        time = case.whole.test[axis].values[other]
        span = {"first": float(time[0]), "last": float(time[-1])}
        return {"name": name, "count": int(other.sum())} | span
    return None


@rule(limit=flags.GROWN)
def light_after_end(case, limit):
    off = case.test.attrs["plasma_off_time"]
    for name, (axis, light) in _seen(case).items():
        time = case.test[axis].values
        again = flags.relit(time, light, off)
        if again.any():
            return {"name": name, "begin": float(time[again][0]), "count": int(again.sum()), "off": off}
    return None


@rule()
def two_clocks(case, limit):
    time, pair = blocks(case.test.time.values, case.pair, -np.inf, np.inf, 0.05)
    moments, light = case.test.spectrum_time.values, case.light
    if time.size < 30:
        return None
    reach = min(FARTHEST, (time[-1] - time[0]) / 8)
    top = np.nanmax(light) if np.isfinite(light).any() else np.nan
    held = (light > 0.02 * top) & (moments > time[0] + reach) & (moments < time[-1] - reach - case.exposure)
    usual = float(np.median(np.diff(time)))
    # Where samples lack at a switch they do not say what an exposure saw of it: `clocks_apart` needs none.
    for switch in (case.test.attrs[name] for name in OF_PLASMA if name in case.test.attrs):
        near = (time[1:] > switch - usual) & (time[:-1] < switch + usual)
        if np.diff(time)[near].max(initial=0.0) > MISSED * usual:
            return None
    if held.sum() < FRAMES:
        return None
    step = max(0.1, usual / 2)
    lags = np.arange(-np.floor(reach / step), np.floor(reach / step) + 1) * step
    bends = "counts" in case.test.variables
    rest = lag(time, pair, moments[held], light[held], case.exposure, lags, bends)
    if np.isnan(rest).all():
        return None
    best, now = int(np.nanargmin(rest)), int(np.argmin(np.abs(lags)))
    tolerance = max(limit, case.exposure, usual)
    # Normal noise makes the residual 1.3 times as small at another lag once in 1000 cases of 30 spectra;
    # below 1 % flicker within an exposure may, a clock must then be far better, and 0.3 % harms nothing.
    better = 1.5 if rest[now] >= 0.01 else 3.0
    if abs(lags[best]) <= tolerance or rest[now] < max(better * rest[best], 0.003):
        return None
    return {"lag": float(lags[best]), "best": 100 * float(rest[best]), "now": 100 * float(rest[now])}
