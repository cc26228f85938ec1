"""Where instruments and calibrations contradict each other: nothing is averaged over that."""

import numpy as np

from plasmapyro.estimate.observations import PyrometerData
from plasmapyro.tables import rows

# All constants; `stated`: of what calibrations and statements say, the gas is left to the data.
REGISTER = rows("estimate/constants.csv")
STATED = {row["name"]: row["stated"] for row in REGISTER if row["stated"]}
LARGEST_PULL = 5.0  # standard deviations; sound data pull by 1.2 at most, a gain that is 5 % off by 18
LARGEST_RESIDUAL = {True: 20.0, False: 10.0}  # [1] of the pyrometer, of a spectrum; sound ones reach 10 and 2
STRAINED = 3.0  # standard deviations beyond which a statement is as uncertain as it is off (Birge's ratio)
NEAR = 1.0  # [s] over which residuals of the pyrometer are averaged


def contradicted(time, observations, fixed, found):
    """Which samples of the chain contradict one another, and why.

    Parameters
    ----------
    time : (n,) array [s]
    observations : list of PyrometerData and SpectrometerData
        With the noise that their residuals show.
    fixed : Constants
    found : result of `smoother.fit`

    Returns
    -------
    where : (n,) bool ndarray
        All samples if what a calibration states is pulled by more than `LARGEST_PULL` of its standard
        deviations; else those around residuals beyond `LARGEST_RESIDUAL`.
    words : list of str

    Notes
    -----
    Not in the paper. A pull is (value - stated) / uncertainty; one of 5 is no chance.
    """
    words = pulled(observations, fixed, found, LARGEST_PULL)
    if words:
        return np.ones(time.size, dtype=bool), words
    where = np.zeros(time.size, dtype=bool)
    for data in observations:
        of_bands = isinstance(data, PyrometerData)
        moments, size = _sizes(data, data.residual(found.path, found.values, fixed.where), time)
        far = size > LARGEST_RESIDUAL[of_bands]
        for moment in moments[far]:
            where |= np.abs(time - moment) <= NEAR
        if far.any():
            words.append(
                f"the {data.name} lies up to {size[far].max():.0f} times its noise off the common"
                f" temperature, first at {moments[far][0]:.5g} s after the injection"
            )
    return where, words


def pulls(fixed, found):
    """By how many of its standard deviations (p,) each constant is off what is stated."""
    return np.abs(found.values - fixed.mean) / fixed.deviation


def pulled(observations, fixed, found, least):
    """What is pulled by more than `least` standard deviations, in words, one each."""
    size, leading = pulls(fixed, found), observations[0].name if observations else "pyrometer"
    largest = {name: size[fixed.where(name)].max(initial=0.0) for name in STATED}
    return [
        f"the data pull {STATED[name].format(leading=leading)} by {pull:.0f} standard"
        " uncertainties away from what is stated"
        for name, pull in largest.items()
        if pull > least
    ]


def stretched(fixed, found):
    """Factors (p,) by which what is stated is less certain than it says: its pull, where that is `STRAINED`.

    Source: R. T. Birge, Phys. Rev. 40 (1932) 207, for a single statement.
    """
    size = pulls(fixed, found)
    said = np.isin(np.array(fixed.names), list(STATED))
    return np.where(said & (size > STRAINED), size, 1.0)


def _sizes(data, residual, time):
    """Times and root mean squares of the whitened residuals: over `NEAR` of the bands, or over a spectrum."""
    square = residual**2
    if isinstance(data, PyrometerData):
        square, count = np.nansum(square, axis=0), np.isfinite(square).sum(axis=0)
        total, number = (np.concatenate([[0.0], np.cumsum(row)]) for row in (square, count))
        first, last = (np.searchsorted(time, time + shift) for shift in (-NEAR / 2, NEAR / 2))
        return time, np.sqrt((total[last] - total[first]) / np.maximum(number[last] - number[first], 1))
    moments = time[data.place] + data.offset
    return moments, np.sqrt(np.nansum(square, axis=1) / np.maximum(np.isfinite(square).sum(axis=1), 1))
