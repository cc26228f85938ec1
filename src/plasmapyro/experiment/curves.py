"""Planck fits of many noisy copies of one spectrum, by a table of the curves around its temperature."""

from typing import NamedTuple

import numpy as np

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.experiment.spectra import CONVERGED, STEP_LIMIT, STEPS
from plasmapyro.radiation.planck import blackbody_radiance

ORDER = 14  # Chebyshev polynomials; with REACH 2 they leave 2 (REACH/2)^14 / 14! = 2e-11
REACH = 2.0  # half the change of ln(L / L_0) between the ends of the table, at the ends of the spectrum
WIDEST = 0.4  # half width of the table over the inverse temperature in its middle
EDGE = 0.98  # of the half width: what settles beyond is not trusted
DERIVATIVE = np.array([np.polynomial.chebyshev.chebder(row, 1) for row in np.eye(ORDER)[1:]])
DERIVATIVE = np.pad(DERIVATIVE, ((1, 0), (0, 1)))  # (K, K): derivatives of T_k in terms of T_j


class LocalCurves(NamedTuple):
    """Black bodies over their radiance at one wavelength, as Chebyshev series in inverse temperature."""

    coefficient: np.ndarray  # (K, W) [1]
    centre: float  # [K-1]
    half: float  # [K-1]
    anchor: float  # [m] the wavelength at which every curve is 1

    def place(self, temperature):
        """Position in the table, -1 to 1, of temperatures [K]."""
        return (1 / temperature - self.centre) / self.half

    def temperature(self, place):
        """Temperatures [K] of positions in the table."""
        return 1 / (self.centre + self.half * place)


def local_curves(wavelength, temperature):
    r"""Table of Planck curves around a temperature [K], at rising wavelengths (W,) [m].

    .. math:: \frac{L_\lambda(\beta)}{L_{\lambda_0}(\beta)} = \sum_k C_{k\lambda}\,T_k(x), \qquad
              x = \frac{\beta - \beta_0}{h}, \quad \beta = 1/T

    In the limit of Wien the curves are exp(-c_2 (1/lambda - 1/lambda_0) beta) but for a factor, whose
    Chebyshev series falls as (a/2)^k / k!; the width of the table keeps a at `REACH`.
    """
    ends = 1 / np.array([wavelength[-1], wavelength[0]])
    anchor = float(2 / ends.sum())
    centre = 1 / float(temperature)
    half = float(min(REACH / (SECOND_RADIATION * (ends[1] - ends[0]) / 2), WIDEST * centre))
    angle = np.pi * (np.arange(ORDER) + 0.5) / ORDER
    bodies = 1 / (centre + half * np.cos(angle))[:, None]
    shape = blackbody_radiance(wavelength, bodies) / blackbody_radiance(anchor, bodies)
    transform = 2 / ORDER * np.cos(np.arange(ORDER)[:, None] * angle)
    transform[0] /= 2
    return LocalCurves(np.einsum("kn,nw->kw", transform, shape), centre, half, anchor)


def fit_normalised_near(curves, radiance, usable, pivot, start):
    """`spectra.fit_normalised` (D,) [K] of many spectra with the same usable pixels, within a table.

    `radiance` (D, W) is finite also where not usable, a usable pixel in the pivot. NaN where the fit does not
    settle within the table, or where the pivot is not > 0.
    """
    basis = np.where(usable, curves.coefficient, 0.0)
    chosen = usable & pivot
    at_pivot = basis[:, chosen].mean(axis=1)
    gram = np.einsum("kw,lw->kl", basis, basis)
    height = radiance[:, chosen].mean(axis=1)
    lit = height > 0
    seen = np.einsum("dw,kw->dk", radiance, basis) / np.where(lit, height, 1.0)[:, None]

    def step(series, slope):
        mean, mean_slope = (np.einsum("dk,k->d", part, at_pivot) for part in (series, slope))
        here, there = (np.einsum("dk,kl->dl", part, gram) for part in (series, slope))
        own, mixed, steep = _dot(here, series), _dot(here, slope), _dot(there, slope)
        along = (_dot(seen, slope) - _dot(seen, series) * mean_slope / mean) / mean
        along -= (mixed - own * mean_slope / mean) / mean**2
        return along / ((steep - 2 * mixed * mean_slope / mean + own * (mean_slope / mean) ** 2) / mean**2)

    place = _settle(step, curves, radiance.shape[0], start)
    return np.where(lit, curves.temperature(place), np.nan)


def fit_scaled_near(curves, radiance, noise, usable, start):
    """`spectra.fit_scaled` of many spectra with the same noise and usable pixels, within a table.

    `radiance` (D, W) is finite also where not usable, the noise (W,) > 0 where usable. NaN where the fit does
    not settle within the table.
    """
    weight = np.where(usable, 1 / np.where(usable, noise, 1.0), 0.0)
    basis = curves.coefficient * weight
    gram = np.einsum("kw,lw->kl", basis, basis)
    seen = np.einsum("dw,kw->dk", radiance, basis * weight)

    def step(series, slope):
        here, there = (np.einsum("dk,kl->dl", part, gram) for part in (series, slope))
        own, mixed, steep = _dot(here, series), _dot(here, slope), _dot(there, slope)
        height = _dot(seen, series)
        # A change of scale takes `share` of the curve out of its derivative.
        share = mixed / own
        return (_dot(seen, slope) - share * height) / (height / own * (steep - share * mixed))

    place = _settle(step, curves, radiance.shape[0], start)
    temperature = curves.temperature(place)
    series = _series(np.nan_to_num(place))
    own = _dot(np.einsum("dk,kl->dl", series, gram), series)
    anchored = blackbody_radiance(curves.anchor, np.where(np.isfinite(temperature), temperature, start))
    scale = np.where(np.isfinite(place), _dot(seen, series) / own, np.nan) / anchored
    return temperature, scale


def _dot(left, right):
    return np.einsum("dk,dk->d", left, right)


def _series(place):
    return np.polynomial.chebyshev.chebvander(place, ORDER - 1)


def _settle(step, curves, rows, start):
    """Positions (D,) at which the Gauss-Newton step vanishes; NaN where it does not within the table."""
    place = np.full(rows, curves.place(start))
    limit = STEP_LIMIT * curves.centre / curves.half
    settled = np.zeros(rows, dtype=bool)
    for _ in range(STEPS):
        series = _series(place)
        with np.errstate(divide="ignore", invalid="ignore"):
            change = step(series, np.einsum("dk,lk->dl", series, DERIVATIVE))
        change = np.clip(np.nan_to_num(change, nan=np.inf), -limit, limit)
        place = np.clip(place + change, -1.0, 1.0)
        settled = np.abs(change) * curves.half < CONVERGED * curves.centre
        if (settled | (np.abs(place) == 1.0)).all():
            break
    return np.where(settled & (np.abs(place) < EDGE), place, np.nan)
