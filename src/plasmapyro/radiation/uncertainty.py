"""How wrong the radiance of the gas may be: modes of its error, from the lines and bands that make it."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ive, voigt_profile

from plasmapyro.radiation.atoms import ATOMS
from plasmapyro.radiation.lines import BAND
from plasmapyro.radiation.planck import planck
from plasmapyro.radiation.slit import FWHM_PER_SIGMA

LEAST_STRENGTH = 0.08  # [1] floor of the relative error of a system of bands: spread of published moments
SCALE = 0.05  # [1] of all A values of an atom together: lifetimes that set the scale of a compilation
COMMON = 0.8  # [1] of the variance of an A value that its multiplet shares: LS coupling gives the rest;
# and of that of a width that all lines of an atom do: one theory, and the density of one gas
WIDTH = 0.3  # [1] of Stark widths (H. R. Griem, Spectral Line Broadening by Plasmas (1974): 20 to 30 %)
OF_SEQUENCE = 0.4  # of the stated error of a system: of one sequence of bands (v' - v'') against the others
OF_BAND = 0.3  # the same of one band against the others of its sequence
ROTATION = 0.05  # [1] of the shape of a band: perturbed lines, intensities between Hund's cases,
ROTATION_LENGTH = 3.0e-9  # [m] over which it persists
CONTINUUM = 0.1  # [1] of a continuum, per unit of the logarithm of the wavelength about its middle
MISSING = {"NO 11000 A": (970e-9, 1070e-9, 0.7)}
"""Systems without strengths, as light of one that is known: (first, last) [m], its integral over that light.
Bands 3d-3p of NO, by analogy with sodium (see `band_systems`): as at 5000 K, where most of NO radiates."""
FAINT = 2e-3  # [1] of the light at their brightest: fainter modes of one system and cause become one
STRENGTHS = ("strength", "multiplet", "sequence")  # causes that scale a system or groups of its lines
TINY = 1e-300  # of any light: none
SEEN = 1e-9  # of the brightest light of a component: below, nothing is shared out


@dataclass(frozen=True)
class ErrorModes:
    r"""Independent errors of a spectrum behind a slit, each of unit variance.

    .. math:: \mathrm{cov}(L_\lambda, L_{\lambda'})
              = \sum_j L_{c_j}(\lambda)\, s_j(\lambda)\, s_j(\lambda')\, L_{c_j}(\lambda')

    `share` s (M, K) [1], relative to the light of the component `system` (M,) of each; `cause` (M,): one of
    'strength', 'multiplet', 'line', 'width', 'sequence', 'band', 'rotation', 'slope', 'missing'.
    """

    share: np.ndarray
    system: tuple
    cause: tuple


def error_modes(path, thin_lines, wavelength, slit_fwhm, component, radiance, stated):
    """Modes of the error of the radiance of a path, as its tables state it.

    The light of a component is shared out between its lines as it would be without absorption. A values: the
    classes of NIST (A. Kramida et al., Atomic Spectra Database), per line. Bands: the certificates state the
    strength of a system; ASSUME: sequences and bands differ by 0.4 and 0.3 of that, the order of the spread
    between published sets for N2 1P (F. R. Gilmore, R. R. Laher & P. J. Espy, J. Phys. Chem. Ref. Data 21,
    1005 (1992); C. O. Laux & C. H. Kruger, J. Quant. Spectrosc. Radiat. Transfer 48, 9 (1992)).
    ASSUME: causes are independent; densities and temperatures are not among them.

    Parameters
    ----------
    path : GasPath
    thin_lines : list of (LineList, (L,) [W m-2 sr-1])
        Systems, and what each line would radiate if nothing were absorbed (`path.thin_lines`).
    wavelength : (K,) [m]
        Behind the slit.
    slit_fwhm : float [m]
    component : sequence of names (C,)
    radiance : (C, K) [W m-2 sr-1 m-1]
    stated : (C,) [1]
        Relative uncertainty of the strength of each component (`systems.component_uncertainty`).

    Returns
    -------
    ErrorModes
        The first mode of a component is its strength as a whole.
    """
    lines = {one.component: (one, values) for one, values in thin_lines}
    whole, sigma = np.maximum(radiance.sum(axis=0), TINY), slit_fwhm / FWHM_PER_SIGMA
    found = []
    for name, light, own in zip(component, radiance, stated, strict=True):
        if not light.any():
            continue
        if name in ATOMS:
            modes = [("strength", np.full((1, wavelength.size), SCALE))]
            modes += _of_lines(*lines[name], path, wavelength, sigma)
        elif name in lines:
            size = max(float(own), LEAST_STRENGTH)
            modes = [("strength", np.full((1, wavelength.size), size))]
            modes += _of_bands(*lines[name], wavelength, sigma, size)
        else:
            tilt = CONTINUUM * np.log(wavelength / np.sqrt(wavelength[0] * wavelength[-1]))
            modes = [("strength", np.full((1, wavelength.size), max(float(own), LEAST_STRENGTH)))]
            modes.append(("slope", tilt[None]))
        if name in MISSING:
            modes.append(("missing", _missing(wavelength, light, *MISSING[name])))
        bright = light / whole
        for cause, share in modes:
            share = np.where(light > SEEN * light.max(), share, 0.0)
            large = (np.abs(share) * bright).max(axis=1) > FAINT
            large |= cause == "strength"
            rest = np.sqrt(np.sum(share[~large] ** 2, axis=0, keepdims=True))
            kept = np.concatenate([share[large], rest[rest.any(axis=1)]])
            found += [(row, name, cause) for row in kept]
    share = np.array([row for row, *_ in found]).reshape(-1, wavelength.size)  # gas that is dark has none
    return ErrorModes(share, tuple(str(name) for _, name, _ in found), tuple(cause for *_, cause in found))


def _of_lines(lines, values, path, wavelength, sigma):
    """Modes of an atom by multiplet and line, and of the widths, all together and by multiplet.

    A wider line is lower behind the slit and, where its own gas absorbs it, brighter as a whole.
    """
    keep = values > SEEN * values.max()
    lines, values = lines.select(keep), values[keep]
    hwhm, depth = _profiles(path, lines)
    hwhm = hwhm / lines.wavenumber**2  # in wavelength
    away = wavelength - 1 / lines.wavenumber[:, None]
    light = values[:, None] * voigt_profile(away, sigma, hwhm[:, None])
    wider = values[:, None] * voigt_profile(away, sigma, (1 + WIDTH) * hwhm[:, None]) - light
    total = np.maximum(light.sum(axis=0), TINY)
    wider += WIDTH * gained_by_width(depth)[:, None] * light
    error = lines.strength_uncertainty[:, None] * light / total
    _, family = np.unique(lines.family, return_inverse=True)
    return [
        ("multiplet", np.sqrt(COMMON) * _summed(error, family)),
        ("line", np.sqrt(1 - COMMON) * error),
        ("width", np.sqrt(COMMON) * wider.sum(axis=0, keepdims=True) / total),
        ("width", np.sqrt(1 - COMMON) * _summed(wider / total, family)),
    ]


def gained_by_width(depth):
    r"""Relative change of a line's light per relative change of its Lorentz width: 0 if thin, 1/2 if thick.

    .. math:: \frac{d \ln W}{d \ln \gamma} = \frac{I_1(u)}{I_0(u) + I_1(u)}, \qquad u = \tau_0 / 2

    with the optical depth at the centre of a line of a uniform gas. Source: the equivalent width of R.
    Ladenburg & F. Reiche, Ann. Phys. 347, 181 (1913).
    """
    first, second = ive(0, np.asarray(depth) / 2), ive(1, np.asarray(depth) / 2)
    return second / (first + second)


def _profiles(path, lines):
    """Lorentz half widths (L,) [m-1], the mean over the path weighted by the emission of each line, and the
    optical depth (L,) [1] of the path at the centre of such a profile."""
    width, weight, absorbed = (np.zeros(len(lines)) for _ in range(3))
    for layer, thickness in enumerate(path.thickness):
        emission = thickness * path.emission(lines, layer)
        width += emission * path.hwhm(lines, layer)
        weight += emission
        # Kirchhoff's law, with the black body per wavenumber.
        wavelength = 1 / lines.wavenumber
        absorbed += emission / (planck(wavelength, path.temperature[layer]) * wavelength**2)
    width /= weight
    return width, absorbed / (np.pi * width)


def _of_bands(lines, values, wavelength, sigma, size):
    """Modes of a system of bands by sequence and band, and of the shapes of its bands."""
    step = (wavelength[-1] - wavelength[0]) / (wavelength.size - 1)
    place = np.rint((1 / lines.wavenumber - wavelength[0]) / step).astype(int)
    inside = (place >= 0) & (place < wavelength.size)
    if not inside.any():  # what reaches into the range are tails of lines beside it
        return []
    band, family = np.unique(lines.family[inside], return_inverse=True)
    flat = family * wavelength.size + place[inside]
    light = np.bincount(flat, values[inside], band.size * wavelength.size).reshape(band.size, -1)
    reach = np.arange(-int(5 * sigma / step), int(5 * sigma / step) + 1)
    slit = np.exp(-0.5 * (reach * step / sigma) ** 2)
    light = np.array([np.convolve(row, slit, mode="same") for row in light])
    share = light / np.maximum(light.sum(axis=0), SEEN * light.max())
    _, sequence = np.unique(band // BAND - band % BAND, return_inverse=True)
    return [
        ("sequence", OF_SEQUENCE * size * _summed(share, sequence)),
        ("band", OF_BAND * size * share),
        ("rotation", _local(wavelength, ROTATION, ROTATION_LENGTH)),
    ]


def _summed(rows, group):
    """Rows (L, K) added up by group (L,), numbered from 0."""
    found = np.zeros((group.max() + 1, rows.shape[1]))
    np.add.at(found, group, rows)
    return found


def _local(wavelength, size, length):
    """Bumps (M, K) of some length [m] whose squares add up to that of `size` everywhere."""
    centres = np.arange(wavelength[0], wavelength[-1] + length, length)
    bumps = np.exp(-0.5 * ((wavelength - centres[:, None]) / (0.7 * length)) ** 2)
    bumps[bumps < SEEN] = 0.0
    return size * bumps / np.sqrt(np.sum(bumps**2, axis=0))


def _missing(wavelength, light, first, last, size):
    """Light (1, K) of a system without strengths over that of another, of `size` times its integral."""
    middle, width = 0.5 * (first + last), 0.25 * (last - first)
    shape = np.exp(-0.5 * ((wavelength - middle) / width) ** 2)
    shape *= size * light.sum() / max(shape.sum(), SEEN)
    return (shape / np.maximum(light, SEEN * light.max()))[None]
