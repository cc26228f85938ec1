"""First values of the gas: how bright it is, before and after the injection, and in which channels."""

import numpy as np

from plasmapyro.record.binning import finite_mean

EARLY = 3.0  # [s] after injection: few surfaces shine yet; or the first exposure, if that is longer
RISEN = 1.5  # times the faintest light of that time: an ablator shines after a second
SHAPE = 0.3  # [1] by which the simulated light of a channel errs, for its weight
LEAST, MOST = 1e-3, 1e3  # of a brightness over the simulated one


def guess(model):
    """First values (V,) of the parameters and errors of the gas, one (C,) per instrument.

    From the means before the injection and in the first seconds after it; the centres of the priors where
    there are none.
    """
    values = np.array([parameter.first for parameter in model.parameters])
    early, ratio = [], None
    for which, one in enumerate(model.instruments):
        time = one.moment.mean(axis=1)
        level, simulated = model.gas_level(which)
        first = min(time[time > 0], default=EARLY)
        before = finite_mean(one.value[time < 0])
        after = finite_mean(_dark(one.value[(time > 0) & (time <= max(EARLY, first))]))
        known = np.isfinite(before) & np.isfinite(after)
        if ratio is None and known.any():
            weight = _weight(one, after)[known]
            ratio = (weight @ (before * after)[known]) / max(weight @ after[known] ** 2, 1e-300)
        early.append((level, simulated, after, before))
    if ratio is not None:
        values[model.index["before_injection"]] = np.log(np.clip(ratio, LEAST, MOST))
    fading = np.exp(-values[model.index["before_injection"]])
    seen = [np.where(np.isfinite(after), after, before * fading) for _, _, after, before in early]
    level, simulated, _, _ = early[-1]
    known = np.isfinite(seen[-1])
    brightness = 1.0
    if known.any():
        weight = _weight(model.instruments[-1], seen[-1])[known]
        light = simulated[known]
        brightness = np.clip((weight * light) @ seen[-1][known] / ((weight * light) @ light), LEAST, MOST)
        values[model.index["gas"]] = np.log(brightness)
    errors = [
        np.where(np.isfinite(light), (light / brightness - simulated) / level, 0.0)
        for light, (level, simulated, _, _) in zip(seen, early, strict=True)
    ]
    return values, tuple(np.nan_to_num(row) for row in errors)


def none(model):
    """As `guess`, for a test without a gas: the centres of the priors."""
    values = np.array([parameter.first for parameter in model.parameters])
    return values, tuple(np.zeros(one.channels) for one in model.instruments)


def _weight(one, light):
    """Weights (C,) of the channels of an instrument: inverse variances of noise and of a wrong shape."""
    step = np.nanmedian(np.abs(np.diff(one.value, axis=0)), axis=0) if len(one.value) > 1 else 0.0
    return 1 / np.maximum(np.nan_to_num(step) ** 2 + (SHAPE * np.nan_to_num(light)) ** 2, 1e-300)


def _dark(rows):
    """Those of the rows (n, C) in which light has not risen yet."""
    whole = finite_mean(rows.T)
    least = np.nanmin(whole, initial=np.inf)
    return rows[whole <= max(RISEN * least, least)]
