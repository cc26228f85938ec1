"""What a two-colour ratio pyrometer makes of a spectrum: band signals, their ratio, a temperature."""

import numpy as np

from plasmapyro.checks import increasing
from plasmapyro.radiation.bandsignal import band_signal, responsivities
from plasmapyro.radiation.planck import blackbody_radiance

GREY_STEPS = 12  # of Gauss and Newton; five give 1 mK within a table


def blackbody_signal(temperature, wavelength, responsivity):
    """Band signal (...) [W m-2 sr-1] of a black body [K], on the wavelengths (R,) [m] of the response."""
    radiance = blackbody_radiance(wavelength, np.asarray(temperature, dtype=float)[..., None])
    return band_signal(wavelength, responsivity, radiance)


def blackbody_signals(temperature, response):
    """Signals (band, ...) [W m-2 sr-1] of a black body in all bands of a dataset of contract 'response'."""
    wavelength = response.wavelength.values
    return np.stack([blackbody_signal(temperature, wavelength, curve) for curve in responsivities(response)])


def signal_ratio(signal_wide, signal_narrow):
    """Ratio of the band signals, NaN where either is not > 0 (a ratio of noise is no ratio).

    Source: Fagnani et al., eq. 4, left side.
    """
    wide, narrow = np.broadcast_arrays(
        np.asarray(signal_wide, dtype=float), np.asarray(signal_narrow, dtype=float)
    )
    good = (wide > 0) & (narrow > 0)
    return np.divide(wide, narrow, out=np.full(wide.shape, np.nan), where=good)


def measured_ratio(sensitivity_ratio, emittance, blackbody, gas):
    r"""Signal ratio (...) [1] of a grey surface behind gas.

    .. math:: \rho_m = \varphi\, \frac{\int \tilde R_1\, [\varepsilon L^{bb}(T_{obj}) + L^{g,e}]\, d\lambda}
                                     {\int \tilde R_2\, [\varepsilon L^{bb}(T_{obj}) + L^{g,e}]\, d\lambda}

    with the sensitivity ratio :math:`\varphi` of the wide band over the narrow one. `blackbody` and `gas` are
    the signals, wide and narrow, of a black body at the temperature of the surface and of the gas, as from
    `band_signal`. Source: Fagnani et al., eq. 4; the window cancels, being uniform.

    Gas that is relatively brighter in the wide band makes the surface look hotter:

    >>> f"{measured_ratio(0.315, 0.85, (4.0, 1.0), (1.7, 0.17)):.3f}"
    '1.575'
    """
    (wide, narrow), (gas_wide, gas_narrow) = blackbody, gas
    return sensitivity_ratio * (emittance * wide + gas_wide) / (emittance * narrow + gas_narrow)


def calibration_ratio(sensitivity_ratio, blackbody):
    r"""Signal ratio of a black body without gas: the calibration curve at its temperature.

    .. math:: \rho_c = \varphi\, \frac{\int \tilde R_1\, L^{bb}(T_{obj})\, d\lambda}
                                     {\int \tilde R_2\, L^{bb}(T_{obj})\, d\lambda} = H_c(T_{obj})

    Source: Fagnani et al., eq. 5, which is eq. 4 (`measured_ratio`) with emittance 1 and no gas.

    >>> f"{calibration_ratio(0.315, (4.0, 1.0)):.2f}"
    '1.26'
    """
    return measured_ratio(sensitivity_ratio, 1.0, blackbody, (0.0, 0.0))


def invert_ratio(ratio, calibration_temperature, calibration_ratio):
    r"""Temperature (...) [K] a pyrometer would report for ratios, :math:`H_c^{-1}(\rho)`, and its status.

    Interpolates 1/T linearly in ln(ratio), which is exact in the Wien limit for two narrow bands, and never
    extrapolates. Status (...) is 0 within the calibration, -1 below it, +1 above it, where the temperature is
    NaN; NaN stays NaN, with status 0. ValueError if a calibration array (C,) does not increase strictly.
    Source: Fagnani et al., eq. 6.

    Half way in the logarithm of the ratio is half way in 1/T:

    >>> temperature, status = invert_ratio(2.0, [1000.0, 2000.0], [1.0, 4.0])
    >>> f"{temperature:.1f} K", int(status)
    ('1333.3 K', 0)
    """
    temperature = increasing("calibration_temperature", calibration_temperature, "K")
    nodes = increasing("calibration_ratio", calibration_ratio, "1")
    ratio = np.asarray(ratio, dtype=float)
    status = np.where(ratio < nodes[0], -1, np.where(ratio > nodes[-1], 1, 0)).astype("int8")
    inside = np.where(status == 0, ratio, np.nan)
    return 1 / np.interp(np.log(inside), np.log(nodes), 1 / temperature), status


def invert_grey(signal, temperature, blackbody):
    r"""Temperature (...) [K] an instrument of N bands reads from a surface taken as grey, and its status.

    .. math:: \min_{T, \varepsilon} \sum_i [\ln S_i - \ln\varepsilon - \ln S_i^{bb}(T)]^2

    One band alone has no emissivity to tell: :math:`S = S^{bb}(T)`. Two give what `invert_ratio` gives. The
    signals of a black body, `blackbody` (N, C), stand at rising temperatures (C,) [K]; status as of
    `invert_ratio`. NaN also where a signal is not > 0.

    Source: least squares; Gauss-Newton steps in 1/T, in which ln(S) is straight in Wien's limit.
    """
    inverse = 1 / np.asarray(temperature, dtype=float)[::-1]
    table = np.log(np.asarray(blackbody, dtype=float))[:, ::-1]
    slopes = np.gradient(table, inverse, axis=1)
    shape = np.broadcast_shapes(*(np.shape(one) for one in signal))
    stacked = np.stack([np.broadcast_to(one, shape).ravel() for one in signal])
    good = (stacked > 0).all(axis=0)
    for one, other in ((0, 1), (1, 0)) if len(table) == 2 else ():
        curve = np.asarray(blackbody[one]) / blackbody[other]
        if (np.diff(curve) > 0).all():
            ratio = np.where(good, stacked[one] / np.where(good, stacked[other], 1.0), np.nan).reshape(shape)
            return invert_ratio(ratio, temperature, curve)
    log = np.log(np.where(good, stacked, 1.0))
    at = np.full(log.shape[1], inverse[inverse.size // 2])
    for _ in range(GREY_STEPS):
        off = log - np.array([np.interp(at, inverse, row) for row in table])
        slope = np.array([np.interp(at, inverse, row) for row in slopes])
        if len(table) > 1:
            off, slope = off - off.mean(axis=0), slope - slope.mean(axis=0)
        move = np.sum(slope * off, axis=0) / np.sum(slope**2, axis=0)
        beyond = np.where(at + move < inverse[0], 1, np.where(at + move > inverse[-1], -1, 0))
        at = np.clip(at + move, inverse[0], inverse[-1])
    status = np.where(good, beyond, 0).astype("int8").reshape(shape)
    reading = np.where(good & (beyond == 0), 1 / at, np.nan)
    return reading.reshape(shape), status
