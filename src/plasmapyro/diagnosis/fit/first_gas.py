"""First values of the gas: how bright it is, before and after the injection, and in which channels."""

import numpy as np

EARLY = 3.0  # [s] after injection: the surface does not shine yet
LEAST, MOST = 1e-3, 1e3  # of a brightness over the simulated one


def guess(model):
    """First values (V,) of the parameters and errors of the gas, one (C,) per instrument.

    From the means before the injection and in the first seconds after it; the centres of the priors where
    there are none.
    """
    values = np.array([parameter.centre for parameter in model.parameters])
    early, ratios = [], []
    for which, one in enumerate(model.instruments):
        time = one.moment.mean(axis=1)
        level, simulated = model.gas_level(which)
        before, after = (_mean(one.value[rows]) for rows in (time < 0, (time > 0) & (time < EARLY)))
        if np.isfinite(before).any() and np.isfinite(after).any():
            ratios.append(np.nansum(before) / max(np.nansum(after), 1e-300))
        early.append((level, simulated, after, before))
    if ratios:
        values[model.index["before_injection"]] = np.log(np.clip(ratios[-1], LEAST, MOST))
    fading = np.exp(-values[model.index["before_injection"]])
    seen = [np.where(np.isfinite(after), after, before * fading) for _, _, after, before in early]
    level, simulated, _, _ = early[-1]
    known = np.isfinite(seen[-1])
    brightness = 1.0
    if known.any():
        brightness = np.clip(seen[-1][known].sum() / simulated[known].sum(), LEAST, MOST)
        values[model.index["gas"]] = np.log(brightness)
    errors = [
        np.where(np.isfinite(light), (light / brightness - simulated) / level, 0.0)
        for light, (level, simulated, _, _) in zip(seen, early, strict=True)
    ]
    return values, tuple(np.nan_to_num(row) for row in errors)


def _mean(rows):
    """Mean over the first axis of what is finite; NaN without any."""
    good = np.isfinite(rows)
    with np.errstate(invalid="ignore"):
        return np.where(good, rows, 0.0).sum(axis=0) / good.sum(axis=0)
