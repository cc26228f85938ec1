"""Rules for results: instruments against each other, and each against what is known of its light."""

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter

from plasmapyro.quality import late
from plasmapyro.quality.rule import rule
from plasmapyro.quality.series import medians
from plasmapyro.radiation.bandsignal import BANDS
from plasmapyro.record import status
from plasmapyro.record.budget import NORMAL_95
from plasmapyro.record.level import emittance_of_level, leeway

GOOD = (status.VALID, status.EXTRAPOLATED)
MOST_COMPARED = 5000  # samples: the signals of as many black bodies take 0.1 GB
FITS = "scaled_temperature", "spectrometer_temperature"  # of Planck's law to a spectrum
NEAR = 0.5  # [s] of a spectrum are samples of the pyrometer that it is compared with
BRIGHT = 0.2  # of the highest corrected signal
CLEAR = 10.0  # of its noise: the fitted light of a pixel that tells the shape
MOST_GAS = 0.5  # of the light of the window over that of the surface
PIXELS = 25  # means over this many tell the shape of a spectrum from its noise
GAS_LEFT = 0.1  # [1] standard, of the light of the window that a spectrum still holds: drift and flicker


def compared(result):
    """Differences of the two instruments of a correction where both are valid.

    Moments (n,) [s], pyrometer minus spectrometer (n,) [K], both uncertainties combined (n,) [K]. Each
    spectrum is compared with the mean of the valid samples of the pyrometer within a second, or with the two
    next to it; the temperature of the spectrum is that of the fit with a free scale.
    """
    held = np.isin(result.corrected_status.values, GOOD) & np.isfinite(
        result.corrected_temperature_uncertainty.values
    )
    time, value, error = (
        result[name].values[held]
        for name in ("time", "corrected_temperature", "corrected_temperature_uncertainty")
    )
    good = result.spectrum_status.values == status.VALID
    good &= np.isfinite(result.scaled_temperature_uncertainty.values)
    found = []
    for index in np.flatnonzero(good):
        moment = result.spectrum_time.values[index]
        near = np.abs(time - moment) <= NEAR
        if not near.any():
            continue
        other = result.scaled_temperature.values[index], result.scaled_temperature_uncertainty.values[index]
        # ASSUME: the pyrometer's error is common to neighbours: its mean is as uncertain as one of them.
        found.append((moment, value[near].mean() - other[0], np.hypot(error[near].mean(), other[1])))
    return tuple(np.array(found).T) if found else (np.empty(0),) * 3


def disagreeing(result, limit):
    """Of what `compared` gives, that where the two differ by more than `limit` uncertainties."""
    moment, difference, uncertainty = compared(result)
    far = np.abs(difference) > limit * uncertainty
    return moment[far], difference[far], uncertainty[far]


@rule()
def instruments_disagree(case, limit):
    total = compared(case.result)[0].size
    moment, difference, uncertainty = disagreeing(case.result, limit)
    if not moment.size:
        return None
    worst = int(np.argmax(np.abs(difference) / uncertainty))
    return {
        "count": moment.size,
        "all": total,
        "moment": float(moment[worst]),
        "difference": float(difference[worst]),
        "uncertainty": float(uncertainty[worst]),
    }


def unlike_grey(result, estimate, limit):
    """Spectra (S,) whose Planck fits, which hold the surface to be grey and alone, differ by more than
    `limit` combined uncertainties from temperature and emissivity of the same light; differences (S,) [K] of
    the fit that is farther off, and their uncertainties (S,) [K]."""
    other, own = (estimate[f"spectral_temperature{end}"].values for end in ("", "_uncertainty"))
    difference = np.array([result[name].values - other for name in FITS])
    error = np.array([np.hypot(result[f"{name}_uncertainty"].values, own) for name in FITS])
    pull = np.nan_to_num(np.abs(difference) / error)
    farther = pull.argmax(axis=0), np.arange(other.size)
    known = np.isin(estimate.spectral_status.values, GOOD) & (result.spectrum_status.values == status.VALID)
    return known & (pull[farther] > limit), difference[farther], error[farther]


@rule()
def spectra_not_grey(case, limit):
    if "spectral_temperature" not in case.estimate:
        return None
    far, difference, error = unlike_grey(case.result, case.estimate, limit)
    if not far.any():
        return None
    worst = np.argmax(np.where(far, np.abs(difference) / error, 0.0))
    return {
        "count": int(far.sum()),
        "moment": float(case.result.spectrum_time.values[worst]),
        "difference": float(difference[worst]),
        "uncertainty": float(error[worst]),
    }


@rule()
def clocks_apart(case, limit):
    found = late.clocks(case, limit)
    if found is None:
        return None
    worst = int(np.argmax(np.abs(found.moved)))
    return {
        "late": found.late,
        "size": abs(found.late),
        "way": "late" if found.late > 0 else "early",
        "back": -found.late,
        "kelvin": abs(float(found.moved[worst])),
        "moment": float(found.moments[worst]),
    }


@rule()
def estimate_contradicted(case, limit):
    words = case.estimate.attrs.get("contradictions")
    return {"words": words} if words else None


@rule()
def throughput_in_doubt(case, limit):
    about = case.estimate.attrs
    chance, ratio = about.get("throughput_chance", 0.0), about.get("ratio_chance", 0.0)
    if chance + ratio <= limit:
        return None
    factor, width = about["throughput"], np.exp(NORMAL_95 * about["throughput_uncertainty"])
    grey = "a surface less grey than stated, a gain of one band"
    other = f"with one of {ratio:.0%} its ratio is not as stated ({grey})" if ratio else f"or {grey}"
    within = {"least": factor / width, "most": factor * width}
    return {"chance": chance, "factor": factor, "other": other} | within


@rule()
def lamp_in_view(case, limit):
    about = case.estimate.attrs
    if about.get("lamp_odds", 0.0) <= limit:
        return None
    cost = about.get("lamp_cost")
    words = "" if cost is None else f"; without it the temperature would be {cost:+.1f} K off this one"
    return {"kind": about["lamp"], "place": about["lamp_wavelength"] * 1e9, "cost": words}


@rule()
def ratio_outside_calibration(case, limit):
    signal, state = case.result.corrected_signal.values, case.result.corrected_status.values
    share = case.result.surface_share.values
    top = np.nanmax(np.where(share > 0.5, signal, np.nan), axis=1, keepdims=True, initial=-np.inf)
    bright = ((signal > BRIGHT * top) & (share > 0.5)).all(axis=0)
    if bright.sum() < 5:
        return None
    outside = np.isin(state[bright], (status.BELOW, status.ABOVE))
    if outside.mean() <= limit:
        return None
    low, high = case.calibration.instrument_range.values
    curve = case.calibration.fitted_ratio.values
    ratio = signal[0, bright] / signal[1, bright]
    return {
        "share": float(outside.mean()),
        "low": float(low),
        "high": float(high),
        "ratio": float(np.median(ratio)),
        "least": float(np.nanmin(curve)),
        "most": float(np.nanmax(curve)),
    }


@rule()
def level_against_ratio(case, limit):
    good = np.isin(case.result.corrected_status.values, GOOD)
    good &= (case.result.surface_share.values > 0.7).all(axis=0)
    if good.sum() < 5:
        return None
    good = np.flatnonzero(good)[:: max(1, int(good.sum()) // MOST_COMPARED)]  # of a median
    kelvin, error = (case.result[f"corrected_temperature{end}"].values[good] for end in ("", "_uncertainty"))
    level = case.result.corrected_signal.values[:, good]
    asked, relative = emittance_of_level(
        level, kelvin, error, case.test.attrs, case.calibration, case.response
    )
    stated, width = case.test.attrs["emittance"], leeway(np.nanmedian(relative), case.test.attrs, limit)
    for band, found in zip(BANDS, np.median(asked, axis=1), strict=True):
        if not abs(np.log(found / stated)) <= width:
            return {
                "kelvin": float(np.median(kelvin)),
                "band": band,
                "found": float(found),
                "stated": stated,
                "least": float(np.exp(-width)),
                "most": float(np.exp(width)),
            }
    return None


@rule()
def emittance_of_spectra(case, limit):
    good = case.result.spectrum_status.values == status.VALID
    values, errors = (case.result[f"apparent_emittance{end}"].values[good] for end in ("", "_uncertainty"))
    known = errors < 0.3 * values
    values, errors = values[known], errors[known] / values[known]
    if values.size < 3:
        return None
    attrs = case.test.attrs
    found, stated = float(np.median(values)), attrs["emittance"]
    own = 3 * np.hypot(float(np.median(errors)), attrs["emittance_uncertainty"] / stated)
    width = max(own, np.log(limit)) - np.log(attrs["window_transmittance_spectrometer"])
    if abs(np.log(found / stated)) <= width:
        return None
    return {"found": found, "count": values.size, "stated": stated, "error": attrs["emittance_uncertainty"]}


def level_steps(result):
    r"""Factor at all wavelengths alike of the light of each valid spectrum over that of the one before.

    .. math:: \ln\frac{L_{j+1}}{L_j} = s + \frac{c_2}{\lambda}\left(\frac{1}{T_j} - \frac{1}{T_{j+1}}\right)
              + g L^{g} \left(\frac{1}{L_{j+1}} - \frac{1}{L_j}\right) + b \frac{\bar\lambda^2}{\lambda^2}

    by least squares over the pixels (Wien's law). The calibration drops out, and a temperature changes the
    second term alone; g, of the light of the window, has a standard deviation of `GAS_LEFT`; b, of
    temperatures that change within exposures, one of :math:`x^2/24`, half the variance of a ramp over x, the
    largest change of the logarithm between neighbours.

    Returns
    -------
    place : (n, 2) int ndarray of spectra
    step, error : (n,) ndarrays [1], s and its standard error, which the misfit widens
    """
    good, found = np.flatnonzero(result.spectrum_status.values == status.VALID), []
    light, noise = result.corrected_radiance.values, result.radiance_noise.values
    inverse = result.wavelength.values.mean() / result.wavelength.values
    gas = result.reference_radiance.values
    # By its neighbours: a pixel that is chosen by its own light is one that noise made bright.
    around = median_filter(np.nan_to_num(light), (1, PIXELS))
    clear = (around > CLEAR * noise) & (around > gas / MOST_GAS) & (light > 0)
    seen = clear[good[:-1]] & clear[good[1:]]
    first, second = (np.where(seen, light[at], 1.0) for at in (good[:-1], good[1:]))
    change = np.log(second / first)
    steps = np.abs(change.sum(axis=1)) / np.maximum(seen.sum(axis=1), 1)
    ramp = maximum_filter1d(steps, 3) if steps.size else steps
    for place, both, ratio, steep in zip(
        zip(good[:-1], good[1:], strict=True), seen, change, ramp, strict=True
    ):
        if both.sum() < PIXELS:
            continue
        error = np.hypot(*(noise[at, both] / around[at, both] for at in place))
        left = GAS_LEFT * gas[both] * (1 / around[place[1], both] - 1 / around[place[0], both])
        bent = steep**2 / 24 * inverse[both] ** 2
        design = np.stack([np.ones(error.size), inverse[both], left, bent], axis=1) / error[:, None]
        covariance = np.linalg.inv(design.T @ design + np.diag([0.0, 0.0, 1.0, 1.0]))
        step = covariance @ design.T @ (ratio[both] / error)
        scatter = max(1.0, float(np.std(ratio[both] / error - design @ step)))
        found.append((*place, step[0], scatter * np.sqrt(covariance[0, 0])))
    *place, step, error = np.array(found).reshape(-1, 4).T
    return np.stack(place, axis=1).astype(int), step, error


def level_jumps(result, limit):
    """Spectra (n, 2) between which the level jumps, and logarithms (n,) of the factors."""
    place, step, error = level_steps(result)
    far = np.abs(step) > np.maximum(limit, 5 * error)
    return place[far], step[far]


@rule()
def emittance_jumps(case, limit):
    place, step = level_jumps(case.result, limit)
    if not step.size:
        return None
    worst = int(np.argmax(np.abs(step)))
    first, second = (float(case.result.spectrum_time.values[at]) for at in place[worst])
    return {"first": first, "second": second, "factor": float(np.exp(step[worst])), "count": step.size}


@rule()
def shape_of_spectra(case, limit):
    good = np.flatnonzero(case.result.spectrum_status.values == status.VALID)
    measured, fitted = (case.result[name].values[good] for name in ("normalised_radiance", "normalised_fit"))
    level = case.result.corrected_radiance.values[good]
    if good.size < 1 or measured.shape[1] < 2 * PIXELS:
        return None
    bright = np.nanmedian(level, axis=1) > BRIGHT * np.nanmedian(level, axis=1).max()
    rest = (measured / fitted - 1)[bright]
    used = np.isfinite(rest).any(axis=0)
    # Far in the blue a surface of 1600 K gives less than the last digit of its dark: no shape is seen there.
    clear = (fitted / measured * level / case.result.radiance_noise.values[good])[bright][:, used]
    used[used] = np.nanmedian(np.abs(clear), axis=0) > CLEAR
    if not used.any():
        return None
    parts = np.array_split(np.flatnonzero(used), max(used.sum() // PIXELS, 1))
    means = np.array([medians(rest[:, part]) for part in parts if part.size])
    seen = np.isfinite(means).any(axis=0)  # not of a spectrum that is saturated there
    worst = float(np.median(np.sqrt(np.nanmean(means[:, seen] ** 2, axis=0))))
    return {"worst": worst} if worst > limit else None
