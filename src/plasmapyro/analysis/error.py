"""The error that the gas causes in a ratio temperature, and the map of its 1 % limits."""

import numpy as np

from plasmapyro.checks import positive


def relative_error(apparent_temperature, object_temperature):
    r"""Relative measurement error, a fraction.

    .. math:: e = \frac{T_{app} - T_{obj}}{T_{obj}}

    Source: Fagnani et al., eq. 7. Deviation: a fraction, not percent.

    Parameters
    ----------
    apparent_temperature : (...) array [K], NaN where the instrument gives no reading
    object_temperature : (...) array [K], > 0; broadcasts

    Returns
    -------
    (...) ndarray [1], NaN where there is no reading

    Examples
    --------
    >>> float(relative_error(1320.0, 1200.0))
    0.1
    """
    object_temperature = positive("object_temperature", object_temperature, "K")
    return (np.asarray(apparent_temperature, dtype=float) - object_temperature) / object_temperature


def error_limit(object_temperature, error, level):
    """Lowest surface temperature above which the error does not exceed `level`.

    Walks down from the highest temperature to the last one at which ``error <= level``, then interpolates
    linearly between the two samples that enclose the crossing. No reading counts as an infinite error: next
    to it the limit is the first sample with a reading. The sign counts, as in the paper's curve ``e = 1 %``:
    in front of a surface hotter than the colour of the gas the reading is too low, which is no crossing.

    Source: Fagnani et al., sec. 4.4 (the curves e = 1 % of their fig. 8c). The interpolation error
    falls with the square of the temperature step.

    Parameters
    ----------
    object_temperature : (T,) array [K], strictly increasing
    error : (..., T) array [1]
        Relative error at each temperature; NaN where there is no reading.
    level : float [1], > 0

    Returns
    -------
    limit : (...) ndarray [K]
        NaN exactly where `status` is not 0.
    status : (...) int8 ndarray
        0 found, -1 within the level at all temperatures (limit lies below the lowest), +1 not within
        it even at the highest temperature.
    """
    temperature = np.asarray(object_temperature, dtype=float)
    error = np.where(np.isnan(error), np.inf, error)
    beyond = error > float(positive("level", level, "1"))
    count = temperature.size
    last = count - 1 - np.argmax(beyond[..., ::-1], axis=-1)
    status = np.where(beyond.any(axis=-1), 0, -1).astype("int8")
    status[beyond[..., -1]] = 1
    lower = np.minimum(last, count - 2)

    def pick(values, index):
        return np.take_along_axis(values, index[..., None], axis=-1)[..., 0]

    above, below = pick(error, lower), pick(error, lower + 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        part = np.where(np.isfinite(above), (above - level) / (above - below), 1.0)
    limit = temperature[lower] + part * (temperature[lower + 1] - temperature[lower])
    return np.where(status == 0, limit, np.nan), status
