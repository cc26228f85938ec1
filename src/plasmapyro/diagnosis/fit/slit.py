"""How wide the slit of a spectrometer is: what lines of atoms say, pixel by pixel."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.ndimage import gaussian_filter1d

from plasmapyro.diagnosis.gas.library import OF_SLIT
from plasmapyro.radiation.atoms import ATOMS
from plasmapyro.radiation.slit import FWHM_PER_SIGMA
from plasmapyro.record.binning import LEAVE_OUT_BEFORE

SLIT = "lsf"  # the effect that is a wider slit
ATOMIC, OTHER = "atomic_radiance", "other_radiance"  # variables of a spectrum as it is without a slit
MOST_LINES, FEWEST_LINES = 30, 3
CLEAR = 1.0  # [1] of the other light behind the slit: an atomic line that stands out
FAINTEST = 0.02  # [1] of the brightest line
SLITS, PIXELS = 2.5, 4.0  # to either side of a line that are looked at, the larger of the two
WIDEST = 5.0  # slits
NUMBERS = 5  # of a line: three brightnesses, its place, the width
MOVED = 0.3  # slits by which a line may be off, and the steps in which a scale is looked for
FARTHEST = 3e-9  # [m] by which that may be off
STEPS = 40  # of a slit
WIDTHS = np.array([0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 1, 1.05, 1.1, 1.2, 1.35, 1.5, 1.75, 2, 2.5, 3, 4, 5])
"""Of slits, over the stated one [1]."""
SEEN = 100.0  # chi-squared that a line must bring: ten standard errors of its brightness
EXACT = 0.01  # [1] error of a frame where too few tell it: what a line leaves then says how large it is
NANOMETRE = 1e-9


@dataclass(frozen=True)
class SeenSlit:
    """What so many `lines` say of a slit: `extra` [nm2] variance of the slit function over that of the stated
    one, `stated` [nm2], and its standard error."""

    extra: float
    error: float
    stated: float
    lines: int

    @property
    def ratio(self):
        """Width over the stated one [1]."""
        return float(np.sqrt(max(1 + self.extra / self.stated, 0.0)))

    @property
    def ratio_error(self):
        """Standard error of `ratio` [1]."""
        return self.error / self.stated / (2 * max(self.ratio, 0.1))

    def misfit(self, settings):
        """Standard errors by which the wider slit of some settings (none without one) is off."""
        wider = sum(one.amplitude**2 for one in settings if one.id == SLIT)
        return (wider - self.extra) / self.error


def with_lines(radiation, variables):
    """Some variables of a spectrum (Dataset, contract 'radiation') and its light of atoms and of the rest
    as no slit has seen them, where it holds that."""
    kept = radiation[variables].assign_attrs(radiation.attrs)
    if "gas_radiance_component" not in radiation:
        return kept
    atomic = np.isin(radiation["component"].values.astype(str), list(ATOMS))
    light = radiation["gas_radiance_component"]
    lines = {ATOMIC: light[atomic].sum("component"), OTHER: light[~atomic].sum("component")}
    return kept.assign({name: one.astype(np.float32) for name, one in lines.items()})


def seen_slit(record, radiation):
    r"""The slit of the spectrometer of a record by the atomic lines of its gas before the injection.

    .. math:: L(\lambda) = \int (a\, L_{atoms} + b\, L_{rest} + c)(\lambda' + d)\,
              g_w(\lambda - \lambda')\, d\lambda'

    in the pixels about each line that stands out, with a, b, c and d of its own and one width w of the
    Gaussian slit function g for all: that strengths, bands beneath and the scale are not known costs nothing.
    What a fit leaves of a line, and what lines contradict each other by, make it less certain (R. T. Birge,
    Phys. Rev. 40, 207 (1932)).

    Parameters
    ----------
    record : Record
    radiation : Dataset of `with_lines`

    Returns
    -------
    SeenSlit, or None without a spectrometer, its light before the injection, or three lines.
    """
    frames = record.instrument("spectrometer")
    if frames is None or ATOMIC not in radiation:
        return None
    before = frames.time + frames.integration_time / 2 < -LEAVE_OUT_BEFORE
    if not before.any():
        return None
    sound = frames.sound[before]
    fine = radiation["wavelength"].values
    usable = np.isfinite(sound).all(axis=0)
    usable &= (frames.wavelength > fine[0] + FARTHEST) & (frames.wavelength < fine[-1] - FARTHEST)
    if usable.sum() <= NUMBERS:
        return None
    light = sound[:, usable].mean(axis=0)
    error = np.full(light.size, EXACT * np.median(np.abs(light)))
    if len(sound) > 2:
        error = sound[:, usable].std(axis=0, ddof=1) / np.sqrt(len(sound))
        error = np.maximum(error, 0.1 * np.median(error))
    emitted = np.stack([radiation[name].values.astype(float) for name in (ATOMIC, OTHER)])
    fwhm = float(record.attributes["spectrometer_fwhm"])
    lines = [one for one in _lines(frames.wavelength[usable], light, error, fine, emitted, fwhm) if one.seen]
    return _together(lines, fwhm) if len(lines) >= FEWEST_LINES else None


def _lines(wavelength, light, error, fine, emitted, fwhm):
    """Each `_Line` that stands out, the brightest first, none within the reach of another."""
    reach = max(SLITS * fwhm, PIXELS * float(np.median(np.diff(wavelength))))
    margin = reach + WIDEST * fwhm
    step = fwhm / STEPS
    inside = max(fine[0], wavelength[0] - margin), min(fine[-1], wavelength[-1] + margin)
    edges = np.arange(*inside, step)
    if edges.size < 2 * margin / step:
        return
    whole = cumulative_trapezoid(emitted, fine, axis=1, initial=0.0)
    even = np.stack([np.diff(np.interp(edges, fine, row)) / step for row in whole])
    axis, sigma = (edges[1:] + edges[:-1]) / 2, STEPS / FWHM_PER_SIGMA
    seen = gaussian_filter1d(even, sigma, axis=1)
    wavelength = wavelength + _moved(wavelength, light, axis, seen, fwhm)
    atoms, rest = (np.interp(wavelength, axis, row) for row in seen)
    stands = (atoms > CLEAR * rest) & (atoms > FAINTEST * atoms.max())
    stands &= (wavelength > axis[0] + margin) & (wavelength < axis[-1] - margin)
    stands &= (wavelength > wavelength[0] + reach) & (wavelength < wavelength[-1] - reach)
    found = []
    for place in np.argsort(-atoms, kind="stable"):
        centre = wavelength[place]
        if not stands[place] or any(abs(centre - one) < 2 * reach for one in found):
            continue
        near = np.abs(wavelength - centre) <= reach
        if near.sum() <= NUMBERS:
            continue
        found.append(centre)
        own = np.abs(axis - centre) < margin
        yield _Line(wavelength[near], light[near], error[near], axis[own], even[:, own], fwhm)
        if len(found) == MOST_LINES:
            return


def _moved(wavelength, light, axis, seen, fwhm):
    """Shift [m] of a wavelength scale by which some light looks most like the one that is simulated."""
    left = {}
    for moved in np.arange(-FARTHEST, FARTHEST + fwhm, MOVED * fwhm):
        rows = np.array([np.interp(wavelength + moved, axis, row) for row in (*seen, np.ones(axis.size))])
        rows /= np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-300)
        left[moved] = np.linalg.lstsq(rows.T, light, rcond=None)[1].sum()
    return min(left, key=left.get)


@dataclass(frozen=True)
class _Line:
    """Pixels about a line: their light and its error (p,), and what is emitted there, on even steps."""

    wavelength: np.ndarray
    light: np.ndarray
    error: np.ndarray
    axis: np.ndarray
    emitted: np.ndarray
    fwhm: float

    def misfit(self, ratio):
        """Least chi-squared with a slit so many times as wide as stated, at any place and brightness."""
        sigma = ratio * STEPS / FWHM_PER_SIGMA
        seen = gaussian_filter1d(self.emitted, sigma, axis=1, mode="nearest", truncate=5.0)
        found = np.inf
        for moved in np.linspace(-MOVED, MOVED, 13) * self.fwhm:
            rows = np.array([np.interp(self.wavelength + moved, self.axis, row) for row in seen])
            rows = np.vstack([rows, np.full(self.wavelength.size, rows[1].mean())]) / self.error
            factor, *_ = np.linalg.lstsq(rows.T, self.light / self.error, rcond=None)
            if factor[0] > 0:
                found = min(found, float(np.sum((self.light / self.error - factor @ rows) ** 2)))
        return found

    @cached_property
    def coarse(self):
        """`misfit` of each of `WIDTHS`."""
        return np.array([self.misfit(ratio) for ratio in WIDTHS])

    @property
    def seen(self):
        """Whether its light is another than that of the rest: the slit has not drowned it."""
        rows = np.array([np.interp(self.wavelength, self.axis, self.emitted[1]), np.ones(self.light.size)])
        rows, light, least = rows / self.error, self.light / self.error, self.coarse.min()
        factor, *_ = np.linalg.lstsq(rows.T, light, rcond=None)
        without = float(np.sum((light - factor @ rows) ** 2))
        return without > least + SEEN * max(least / self.freedom, 1.0)

    @property
    def freedom(self):
        """Pixels beyond the numbers of a fit."""
        return self.wavelength.size - NUMBERS


def _together(lines, fwhm):
    """The `SeenSlit` of lines: the common width, first on a coarse axis, then on a finer one about it."""
    ratio, curves, apart, best = WIDTHS, np.array([line.coarse for line in lines]), 1.0, 0
    for finer in (False, True):
        if finer:
            ratio = np.linspace(ratio[best - 1], ratio[best + 1], 9)
            curves = np.array([[line.misfit(one) for one in ratio] for line in lines])
        scale = np.maximum(curves.min(axis=1) / [line.freedom for line in lines], 1.0)
        curves = (curves - curves.min(axis=1, keepdims=True)) / scale[:, None]
        best = int(np.argmin(curves.sum(axis=0)))
        if best in (0, ratio.size - 1):
            return None
        apart = max(apart, float(curves[:, best].sum()) / (len(lines) - 1))
    variance = (fwhm / NANOMETRE / FWHM_PER_SIGMA) ** 2
    extra = variance * (ratio**2 - 1)
    near = slice(best - 1, best + 2)
    bend, slope, _ = np.polyfit(extra[near] - extra[best], curves.sum(axis=0)[near], 2)
    if not bend > 0:  # or not a number, where some width fits no line
        return None
    value = float(extra[best] - slope / (2 * bend))
    error = np.hypot(np.sqrt(apart / bend), OF_SLIT * variance)
    return SeenSlit(value, float(error), float(variance), len(lines))
