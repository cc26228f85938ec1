"""How wrong the simulated spectrum of the gas may be: modes of its error, each of unit variance."""

import numpy as np

from plasmapyro.diagnosis.gas.templates import ATOMS, BANDS_OF, line_groups

LEAST_STRENGTH = 0.08  # [1] floor of the relative error of a radiating system: spread of published moments
OF_MULTIPLET = 0.05  # [1] of one multiplet against the others of its atom: class B of compiled A values
OF_SEQUENCE = 0.04  # [1] of one sequence of bands against the others: sets of moments differ by it
OF_BANDS = 0.05  # [1] of the shape of a molecular system: Franck-Condon factors, rotational structure,
BAND_LENGTHS = (3.0e-9, 25.0e-9)  # [m] over which it persists: within a band, and from band to band
OF_LINES = 0.02  # [1] of the profile of atomic lines: widths, lines within a multiplet,
LINE_LENGTH = 0.5e-9  # [m] over which it persists
FAINT = 1e-4  # of the brightest mode of a kind: fainter ones are left out


def error_modes(wavelength, component, radiance, stated):
    r"""Modes of the error of a simulated spectrum.

    .. math:: \mathrm{cov}(L_\lambda, L_{\lambda'}) = \sum_j m_j(\lambda)\, m_j(\lambda')

    Parameters
    ----------
    wavelength : (K,) [m]
        Equal steps, behind a slit.
    component : sequence of names (C,)
    radiance : (C, K) [W m-2 sr-1 m-1]
    stated : (C,) [1]
        Relative uncertainty of the strength of each component, as its data state it.

    Returns
    -------
    strength, shape : (M, K) ndarrays [W m-2 sr-1 m-1]
        Of whole systems and their groups of lines; and over short stretches of the wavelength within them.
    system : tuple of names (M,)
        Whose strength each of the first is.

    Notes
    -----
    ASSUME: systems err independently of one another, and the numbers above are of the order of the accuracy
    classes of NIST (A. Kramida et al., Atomic Spectra Database) and of the spread between published sets for
    the bands of N2 (F. R. Gilmore, R. R. Laher & P. J. Espy, J. Phys. Chem. Ref. Data 21, 1005 (1992), and
    C. O. Laux & C. H. Kruger, J. Quant. Spectrosc. Radiat. Transfer 48, 9 (1992)); they are not derived line
    by line.
    """
    strength, shape, system = [], [], []
    for name, light, sigma in zip(component, radiance, stated, strict=True):
        if not light.any():
            continue
        strength.append(max(float(sigma), LEAST_STRENGTH) * light[None])
        _, groups = line_groups(wavelength, [name], light[None])
        if len(groups) > 2:
            strength.append((OF_SEQUENCE if name == BANDS_OF else OF_MULTIPLET) * groups)
        system += [str(name)] * (sum(map(len, strength)) - len(system))
        if name in ATOMS:
            shape.append(_local(wavelength, OF_LINES * light, LINE_LENGTH))
        else:
            shape += [_local(wavelength, OF_BANDS * light, length) for length in BAND_LENGTHS]
    return np.concatenate(strength), np.concatenate(shape), tuple(system)


def _local(wavelength, size, length):
    """Bumps (M, K) of some length whose squares add up to that of `size` (K,); the faintest are left out."""
    centres = np.arange(wavelength[0], wavelength[-1] + length, length)
    bumps = np.exp(-0.5 * ((wavelength - centres[:, None]) / (0.7 * length)) ** 2)
    bumps *= size / np.sqrt(np.sum(bumps**2, axis=0))
    largest = np.abs(bumps).max(axis=1)
    return bumps[largest > FAINT * largest.max()]
