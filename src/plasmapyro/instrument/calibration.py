"""Calibration of a two-colour pyrometer: sensitivities, quadratic fit of the ratio, their uncertainty."""

import numpy as np

from plasmapyro.checks import positive

# Status of a reading; only VALID and EXTRAPOLATED have a value.
BELOW, VALID, ABOVE, EXTRAPOLATED = -1, 0, 1, 2
LEAST_POINTS = 4  # different temperatures; three meet any quadratic


def fit_sensitivity(measured, modelled, covariance):
    r"""Factor between a measured and a modelled quantity that are proportional, and its standard uncertainty.

    .. math:: \ln\varphi = \frac1N \sum_n \ln\frac{\rho_n}{M_n}, \qquad
              u^2(\ln\varphi) = \frac1{N^2}\sum_{nm} V_{nm}

    with the `covariance` V (N, N) [1] of the relative errors of `measured` against `modelled` (N,), both > 0.
    Least squares of the relative residuals with equal weights: the errors are of equal relative size.

    Source: Fagnani et al., eq. 5 and the fit of sec. 3.2 (ratio); the same serves one band.
    """
    logarithm = np.log(positive("measured", measured, "1") / positive("modelled", modelled, "1"))
    factor = float(np.exp(logarithm.mean()))
    return factor, factor * float(np.sqrt(np.sum(covariance))) / logarithm.size


def point_covariance(log_slope, source_temperature_uncertainty, signal_uncertainty, signals):
    r"""Covariance (N, N) [1] of the relative errors of what the calibration points measure.

    .. math:: V_{nm} = n_s\,u_S^2\,\delta_{nm} + g_n\,g_m\,u_T^2, \qquad g = \frac{d\ln M}{dT}

    with the logarithmic slope g (N,) [K-1] of the modelled quantity M at the points, and `signals` that
    enter: 1 for a band, 2 for a ratio.

    Source: Fagnani et al., sec. 3.2 (3 K, 1 %). ASSUME: the signals err independently of each other and from
    point to point (resolution, repeatability); the source errs by the same amount at all points (its
    reference sensor), so more points do not average it away. The coverage of the printed uncertainties is not
    stated: what goes in as standard uncertainty comes out as standard uncertainty.
    """
    slope = np.asarray(log_slope, dtype=float)
    own = signals * signal_uncertainty**2 * np.eye(slope.size)
    return own + source_temperature_uncertainty**2 * np.outer(slope, slope)


def scaled(temperature, fit_range):
    """Temperature mapped linearly so that the fit range becomes [-1, 1]."""
    low, high = fit_range
    return (2 * np.asarray(temperature, dtype=float) - (low + high)) / (high - low)


def fit_quadratic(temperature, ratio, covariance):
    r"""Quadratic function through the signal ratios (N,) of the calibration points at temperatures (N,) [K].

    .. math:: \rho(T) = c_0 + c_1 x + c_2 x^2, \qquad x = \frac{2T - T_{lo} - T_{hi}}{T_{hi} - T_{lo}}

    Least squares of the relative residuals, whose errors have the `covariance` (N, N) [1]. Returns the
    coefficients (3,) [1], their covariance (3, 3), and the fit range (2,) [K]: lowest and highest temperature
    of the points. ValueError if there are fewer than four different temperatures: three would be met exactly
    by any data.

    Source: Fagnani et al., sec. 3.2 (quadratic function of the calibration points).
    """
    temperature = positive("temperature", temperature, "K")
    ratio = positive("ratio", ratio, "1")
    if np.unique(temperature).size < LEAST_POINTS:
        raise ValueError(
            f"a quadratic fit needs four different temperatures; got {np.unique(temperature).size}"
        )
    fit_range = np.array([temperature.min(), temperature.max()])
    design = np.vander(scaled(temperature, fit_range), 3, increasing=True) / ratio[:, None]
    solve = np.linalg.pinv(design)
    return solve.sum(axis=1), solve @ covariance @ solve.T, fit_range


def quadratic_ratio(temperature, coefficient, fit_range):
    """Ratio of the quadratic fit, its equation in `fit_quadratic`, at temperatures (...) [K]."""
    return np.polynomial.polynomial.polyval(scaled(temperature, fit_range), coefficient)


def require_rising(coefficient, fit_range, instrument_range):
    """Raise ValueError unless the quadratic fit rises over the whole range of the instrument."""
    ends = scaled(np.asarray(instrument_range, dtype=float), fit_range)
    slope = coefficient[1] + 2 * coefficient[2] * ends
    if not (slope > 0).all():
        worst = int(np.argmin(slope))
        raise ValueError(
            "the quadratic fit of the signal ratio must rise over the instrument range; it does not at"
            f" {instrument_range[worst]:g} K: check the calibration points or narrow the range"
        )


def invert_quadratic_freely(ratio, coefficient, fit_range):
    r"""Rising branch (...) [K] of the inverse of the quadratic fit, without regard to any range.

    .. math:: x = \frac{2(\rho - c_0)}{c_1 + \sqrt{c_1^2 + 4 c_2 (\rho - c_0)}}

    For Monte Carlo draws, where a draw beyond the range must keep its place in the ranking: infinite where
    the parabola does not reach the ratio (sign as the side), NaN for NaN. Leading axes of `coefficient` (...,
    3) broadcast against `ratio`.
    """
    zeroth, first, second = np.moveaxis(np.asarray(coefficient, dtype=float), -1, 0)
    rise = np.asarray(ratio, dtype=float) - zeroth
    discriminant = first**2 + 4 * second * rise
    reached = discriminant >= 0
    root = 2 * rise / (first + np.sqrt(np.where(reached, discriminant, 1.0)))
    low, high = fit_range
    temperature = (low + high) / 2 + (high - low) / 2 * root
    beyond = np.where(np.isnan(rise), np.nan, np.copysign(np.inf, rise))
    return np.where(reached, temperature, beyond)


def invert_quadratic(ratio, coefficient, fit_range, instrument_range):
    """Temperature (...) [K] read from ratios with the quadratic fit, and how far to trust it: a status (...).

    `BELOW` (-1) and `ABOVE` (1) the instrument range, where the temperature is NaN, `VALID` (0),
    `EXTRAPOLATED` (2): within the instrument range but outside the calibration points. NaN stays NaN, with
    status 0. The fit must rise over the instrument range (`require_rising`).

    Source: Fagnani et al., sec. 3.2: fit between 973 and 1773 K, extrapolated to 2073 K. Deviation: an
    extrapolated reading says so. With the modelled responses the extrapolated parabola lies 0.8 % above the
    true ratio at 2073 K, so that it reads about 18 K low there.
    """
    temperature = invert_quadratic_freely(ratio, coefficient, fit_range)
    lowest, highest = instrument_range
    status = np.full(temperature.shape, VALID, dtype="int8")
    status[(temperature < fit_range[0]) | (temperature > fit_range[1])] = EXTRAPOLATED
    status[temperature < lowest] = BELOW
    status[temperature > highest] = ABOVE
    readable = (status == VALID) | (status == EXTRAPOLATED)
    return np.where(readable, temperature, np.nan), status


def spread(draws):
    """Standard uncertainty (...) of Monte Carlo draws (D, ...): half the width of their central 68.27 %.

    Equal to the standard deviation for normal draws, and finite as long as fewer than 15.87 % of them are
    infinite on either side; NaN where a draw is NaN.
    """
    draws = np.sort(draws, axis=0)  # NaN sorts last and so reaches the upper edge only if frequent
    count = draws.shape[0]
    low, high = draws[int(0.158655 * count)], draws[int(0.841345 * count)]
    with np.errstate(invalid="ignore"):
        half = (high - low) / 2
    return np.where(np.isfinite(half) & ~np.isnan(draws[-1]), half, np.nan)


def reading_uncertainty(
    temperature, coefficient, covariance, fit_range, signal_uncertainty, draws, generator
):
    """Standard uncertainty (T,) [K] of temperatures (T,) [K] read from one pair of signals, by Monte Carlo.

    Draws the coefficients of the fit from their covariance and the two signals from theirs,
    `signal_uncertainty` [1] each, relative. NaN where the draws do not reach the parabola. Source: Fagnani et
    al., sec. 3.2 (Monte Carlo sampling; about 1.5 % of the temperature).
    """
    fits = generator.multivariate_normal(coefficient, covariance, size=draws)[:, None, :]
    errors = 1 + signal_uncertainty * generator.standard_normal((2, draws, 1))
    ratio = quadratic_ratio(temperature, coefficient, fit_range) * errors[0] / errors[1]
    return spread(invert_quadratic_freely(ratio, fits, fit_range))
