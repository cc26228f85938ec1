"""How strong the gas is, over large changes: a first guess from the spectra before the sample shines, and
which term could stand behind strengths that a fit has moved."""

import warnings

import numpy as np
from scipy.ndimage import median_filter

EARLY = 3.0  # [s] after injection: the surface does not shine yet
POWERS = np.linspace(-0.8, 0.8, 33)  # of ln P
ERROR = 0.01  # [1] of a channel, in the first guess
NEIGHBOURS = 9  # channels whose scatter is alike: few frames tell it badly for each alone
LARGEST = 0.4  # [1] of ln of a group, in the first guess
LADDER = 25  # amplitudes that are looked at
SPREAD = 0.01  # [1] of ln of the strength of a group, as the data know it
BEHIND = {  # terms of the gas as a whole, what of the library they follow, and the amplitudes looked at
    "P_eff": ("core_temperature", -0.11, 0.11),
    "ripple": ("ripple", 0.0, 0.18),
    "T_exc": ("excitation", -0.09, 0.09),
}


def guess(model):
    """First values (V,) of the parameters of the base model: power, brightness and strengths of the gas.

    Ridge regression of the mean spectrum before the injection on the groups of lines, at each of some powers;
    the centres of the priors without a spectrometer or without such spectra.
    """
    values = np.array([parameter.centre for parameter in model.parameters])
    which = len(model.instruments) - 1
    one, index, library = model.instruments[which], model.index, model.library
    time = one.moment.mean(axis=1)
    early = [time < 0, (time > 0) & (time < EARLY)]
    if one.weight is not None or not all(rows.any() for rows in early):
        return values
    before, after = (np.nanmean(one.value[rows], axis=0) for rows in early)
    known = np.isfinite(before) & np.isfinite(after)
    before, after = before[known], after[known]
    places = model.strengths
    sigma = np.array([model.parameters[place].sigma for place in places])
    weight = 1 / np.hypot(
        ERROR * np.maximum(before, 0.1 * np.mean(before)), _scatter(one.value[early[0]][:, known])
    )
    best = np.inf
    for power in POWERS:
        light = (one.gas_map @ (library.group * library.power_factor(power)).T).T[:, known]
        level = np.sum(before * weight**2 * light.sum(axis=0)) / np.sum((weight * light.sum(axis=0)) ** 2)
        if not level > 0:
            continue
        columns = level * (model.acts_on @ light) * weight * sigma[:, None]
        rest = (before - level * light.sum(axis=0)) * weight
        step = np.linalg.solve(columns @ columns.T + np.eye(sigma.size), columns @ rest)
        left = rest - step @ columns
        cost = left @ left + step @ step + (power / model.parameters[index["power"]].sigma) ** 2
        cost += (np.log(level) - values[index["before_injection"]]) ** 2 / (
            model.parameters[index["before_injection"]].sigma ** 2 + model.parameters[index["gas"]].sigma ** 2
        )
        if cost < best:
            best = cost
            found = values.copy()
            found[index["power"]] = power
            found[places] = np.clip(np.log(np.maximum(1 + step * sigma, 0.1)), -LARGEST, LARGEST)
            fitted = before - (rest - step @ columns) / weight
            fainter = np.log(max(np.median(after / np.maximum(fitted, 1e-300)), 1e-3))
            found[index["gas"]] = np.log(level) + fainter
            found[index["before_injection"]] = -fainter
    return values if np.isinf(best) else found


def _scatter(frames):
    """Standard error (C,) of the mean of frames (n, C), like that of its neighbours; 0 for one frame."""
    if len(frames) < 2:
        return np.zeros(frames.shape[1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a channel with one sample
        error = np.nan_to_num(np.nanstd(frames, axis=0, ddof=1)) / np.sqrt(len(frames))
    return median_filter(error, NEIGHBOURS, mode="nearest")


def behind(model, values, terms=tuple(BEHIND)):
    """Terms that would bring the strengths of the gas back to what the base model expects.

    Parameters
    ----------
    model : Model
    values : (V,) parameters as fitted
    terms : ids of `BEHIND`

    Returns
    -------
    list of (gain, id, amplitude, values (V,)), best first: by how much the squares of the priors fall, and
    where a fit with the term should start.

    Notes
    -----
    The strengths of the groups are compared by their logarithms, so that factors of ten are no trouble; their
    shapes within a group are left to the fit.
    """
    library, index = model.library, model.index
    places, acts = model.strengths, model.acts_on
    variance = np.array([model.parameters[place].sigma for place in places]) ** 2
    known = np.linalg.inv(acts.T @ (variance[:, None] * acts) + SPREAD**2 * np.eye(acts.shape[1]))
    power, gas = index["power"], index["gas"]
    pull = np.array([1 / model.parameters[place].sigma for place in (power, gas)])

    def means(logarithm):
        return (library.group @ logarithm) / np.maximum(library.group.sum(axis=1), 1e-300)

    def of_power(change):
        return means(np.log(library.power_factor(change)))

    whole = values[places] @ acts + of_power(values[power]) + values[gas]
    step = values[power] if abs(values[power]) > 0.05 else 0.05
    slopes = np.stack([of_power(step) / step, np.ones(acts.shape[1])], axis=1)

    def rest(wanted):
        found = np.linalg.solve(slopes.T @ known @ slopes + np.diag(pull**2), slopes.T @ known @ wanted)
        left = wanted - slopes @ found
        cost = left @ known @ left + np.sum((pull * found) ** 2)
        return float(cost), found, variance * (acts @ known @ left)

    plain = rest(whole)[0]
    result = []
    for term in terms:
        name, low, high = BEHIND[term]
        if not library.varies(name):
            continue
        best = None
        for amplitude in np.linspace(low, high, LADDER):
            cost, found, left = rest(whole - means(np.log(library.factor(name, amplitude))))
            if best is None or cost < best[0]:
                start = values.copy()
                start[[power, gas]], start[places] = found, left
                best = (cost, term, float(amplitude), start)
        result.append((plain - best[0], *best[1:]))
    return sorted(result, key=lambda one: -one[0])
