r"""Light of a lamp of the room beside that of a hot surface.

.. math:: y_c = s_c + a\,\ell_c\,(z_0 + 0.7\,z_c), \qquad \mathrm{cov}(z_c, z_{c'}) =
          \exp[-(\lambda_c - \lambda_{c'})^2 / 2\,(30\,\mathrm{nm})^2], \qquad a \ge 0

with the spectrum :math:`\ell` of each of four kinds of lamps, as walls and windows change it. What speaks for
one is the ratio of the probabilities of the light with and without it, over sizes a of equal chance in ln(a).
"""

from typing import NamedTuple

import numpy as np
from scipy.special import log_ndtr, logsumexp

from plasmapyro.estimate.emissivity import infer, modes
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record.emittance import smooth

CHANGED, LENGTH = 0.7, 30e-9  # [1], [m] ASSUME: how far a lamp's spectrum is from that of its kind, and over
# which wavelengths that changes
SIZES = 3.0 ** np.arange(1, 8)  # standard deviations that noise alone leaves of a
ALIKE = 0.01  # [1] relative change of temperature within which samples are averaged
SURE = 6.9  # of the logarithm of the odds: a thousand to one. Invented sound light reaches 0.3, furnaces 5.3
FWHM = 1 / np.sqrt(8 * np.log(2))
# Peaks (wavelength, width [nm], strength over the strongest).
# ASSUME: after CIE 15:2004, F11: three bands of phosphors over Hg; Ar of the filling (NIST).
FLUORESCENT = (
    *((405, 3, 0.1), (436, 3, 0.4), (488, 12, 0.25), (545, 8, 1.0), (587, 15, 0.3), (611, 7, 0.9)),
    *((630, 10, 0.2), (652, 8, 0.06), (709, 8, 0.08), (763, 2, 0.1), (811, 2, 0.15), (842, 2, 0.06)),
    *((912, 2, 0.1), (966, 2, 0.03)),
)
# ASSUME: after Ohno, Opt. Eng. 44, 111302 (2005): a blue diode and its phosphor.
DIODE = (450, 20, 1.0), (560, 130, 0.5)


class Lamp(NamedTuple):
    """Light of a lamp: its kind, the logarithm of its odds, its shapes (C, K) per coefficient, in units of
    which it is normal with variance 1, and the `radiance` [W m-2 sr-1 m-1] that they were made with."""

    kind: str
    odds: float
    columns: np.ndarray
    most: float  # [m] where it stands out most of noise
    radiance: float


def spectra(wavelength, slit):
    """Spectra (C,) of lamps by kind, largest 1, at wavelengths (C,) [m] through a slit [m]."""
    found = {
        "an incandescent lamp": blackbody_radiance(wavelength, 2856.0),  # CIE standard illuminant A
        "daylight": blackbody_radiance(wavelength, 6500.0),
    }
    for name, peaks in (("a fluorescent lamp", FLUORESCENT), ("a white diode", DIODE)):
        total = 0.0
        for place, width, strength in peaks:
            own = np.hypot(width * 1e-9, slit)
            off = (wavelength - place * 1e-9) / (own * FWHM)
            total = total + strength * width * 1e-9 / own * np.exp(-(off**2) / 2)
        found[name] = total
    return {name: one / one.max() for name, one in found.items()}


def shapes_of(kind, wavelength, slit):
    """Light (C, K) of a kind of lamp at wavelengths (C,) [m] through a slit [m], per coefficient: each is
    normal with variance 1."""
    changed = modes(1.0 + CHANGED**2 * smooth(wavelength, LENGTH))
    return spectra(wavelength, slit)[kind][:, None] * changed


def lamp(channels, prior, middle, seen, error, linear, slit):
    """The likeliest `Lamp` beside the light of a surface, or None if the light speaks against any.

    Parameters
    ----------
    channels, prior : as in `emissivity.infer`
    middle : (C,) array [m]
    seen, error : (C,) arrays
        Light and its standard uncertainty, independent between channels.
    linear : (C, M) array, other light that may add.
    slit : float [m]
    """
    plain = infer(channels, prior, seen[None], error[None], linear[None])
    good, tried = np.isfinite(seen), []
    for kind, spectrum in spectra(middle, slit).items():
        unit = 1 / np.sqrt(np.sum((spectrum / error)[good] ** 2))
        columns = unit * shapes_of(kind, middle, slit)
        own = np.stack([np.column_stack([linear, size * columns]) for size in SIZES])
        rows = (np.repeat(one[None], SIZES.size, axis=0) for one in (seen, error))
        both = infer(channels, prior, *rows, own)
        state, covariance = (one[..., -columns.shape[1] :] for one in (both.state, both.covariance))
        covariance = covariance[:, -columns.shape[1] :]
        size = state @ columns.T
        spread = np.sqrt(np.einsum("ck,nkl,cl->nc", columns, covariance, columns))
        # Where the light is least likely positive tells how much of the prior, half of which is, is left.
        positive = log_ndtr(np.min((size / spread)[:, good], axis=1))
        odds = both.evidence - plain.evidence + np.log(2) + positive
        odds = np.where(both.converged, odds, -np.inf)
        best = int(np.argmax(odds))
        brightest = np.argmax(np.where(good, size[best] / error, -np.inf))
        found = SIZES[best] * columns, float(middle[brightest]), float(SIZES[best] * unit)
        tried.append(Lamp(kind, float(logsumexp(odds) - np.log(SIZES.size)), *found))
    likeliest = max(tried, key=lambda one: one.odds)
    whole = logsumexp([one.odds for one in tried]) - np.log(len(tried))
    return likeliest._replace(odds=float(whole)) if np.isfinite(whole) else None
