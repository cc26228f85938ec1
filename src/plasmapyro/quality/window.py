"""Rules for the reference window: what is subtracted as gas must be gas, and steady."""

import numpy as np

from plasmapyro.quality.rule import rule
from plasmapyro.record import onset
from plasmapyro.record.flags import WIDEST

MOST_HIDDEN = 0.9  # of a window: the brightest samples of the rest tell its light
CLEAR = 10.0  # changes from one sample to the next: less light lies in the noise, and darkness tells nothing


@rule(limit=onset.SIGNIFICANT)
def surface_in_window(case, limit):
    found, names = case.window
    if found["seen_reference_verdict"] != onset.SHOWS:
        return None
    begin, end = case.test.attrs["reference_window"]
    first, second = (100 * float(share) for share in found["seen_reference_bias"])
    low, high = found.get("seen_proposed_window", (None, None))
    return {
        "begin": float(begin),
        "end": float(end),
        "first": first,
        "second": second,
        "one": names[0],
        "other": names[1],
        "advice": f"try --reference-window {low:g} {high:.3g}"
        if high and high < end
        else "let it begin or end earlier",
    }


@rule(limit=onset.SIGNIFICANT)
def gas_drifts(case, limit):
    if case.window[0]["seen_reference_verdict"] != onset.DRIFTS:
        return None
    begin, end = (float(edge) for edge in case.test.attrs["reference_window"])
    return {"begin": begin, "end": end}


@rule()
def frames_in_window(case, limit):
    begin, end = (float(edge) for edge in case.test.attrs["reference_window"])
    inside = (case.test.spectrum_time.values >= begin) & (case.test.spectrum_time.values <= end)
    if "pyrometer" in case.holds or not 2 <= inside.sum() < onset.LEAST_SAMPLES:
        return None  # `surface_in_window` judges more of them
    rows = case.net[inside]
    if not np.isfinite(rows).any(axis=1).all():
        return None
    light = np.nanmedian(rows, axis=1)  # between the lines, where a surface stands out
    if not (light > 0).all() or (change := light.max() / light.min() - 1) <= limit:
        return None
    noise = np.nanstd(np.diff(rows), axis=1).max() / np.sqrt(rows.shape[1])
    if light.min() < CLEAR * noise:
        return None
    return {"begin": begin, "end": end, "count": int(inside.sum()), "change": float(change)}


@rule()
def dark_in_window(case, limit):
    time = case.test.time.values
    begin, end = case.test.attrs["reference_window"]
    inside = (time >= begin) & (time <= end)
    time, light = time[inside], case.pair[:, inside]
    if not np.isfinite(light).all(axis=0).sum() > WIDEST:
        return None
    usual = np.nanquantile(light, MOST_HIDDEN, axis=1, keepdims=True)
    steps = np.nanmedian(np.abs(np.diff(light)), axis=1, keepdims=True)
    dark = (light < limit * usual).all(axis=0)
    if dark.sum() <= WIDEST or (usual < CLEAR * steps).any():
        return None
    first, last = time[dark][[0, -1]]
    runs = np.flatnonzero(np.diff(np.concatenate([[True], dark, [True]]))).reshape(-1, 2)
    longest = runs[np.argmax(np.diff(runs, axis=1))]
    return {
        "begin": float(begin),
        "end": float(end),
        "first": float(first),
        "last": float(last),
        "share": float(dark.mean()),
        "low": float(time[longest[0]]) + 0.0,  # -0.0 is 0
        "high": float(time[longest[1] - 1]),
    }
