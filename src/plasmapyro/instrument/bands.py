"""Calibration of a radiometer: the sensitivity of each of its bands."""

import numpy as np
import xarray as xr

from plasmapyro.instrument.pyrometer import blackbody_signal

LEAST_POINTS = 1


def radiometer_calibration(response, points, *, source_temperature_uncertainty):
    r"""Sensitivity of each band from signals in front of a black body.

    .. math:: \ln k_i = \frac1N \sum_n \ln \frac{S_{i,n}}{\int R_i B_\lambda(T_n)\,d\lambda}, \qquad
              u^2(\ln k_i) = \frac{u_S^2}{N}, \qquad \bar T_i = \left(\frac1N \sum_n T_n^{-2}\right)^{-1/2}

    An error of the source by one amount at all points moves ln k by :math:`-c_2 u_T/(\lambda \bar T^2)`; it
    is common to all bands, and kept apart.

    ValueError: a band without a point.

    Parameters
    ----------
    response : Dataset, contract 'response', of `readers.instrument.read_instrument`
    points : mapping
        `source_temperature` (N,) [K] and signals (N,) by band, NaN where a band was dark or saturated; empty
        for an instrument that shows temperatures, whose signals are those of a black body.
    source_temperature_uncertainty : float [K]

    Returns
    -------
    Dataset, contract 'radiometer_calibration'
    """
    names, own = list(response.band.values), float(response.attrs["signal_uncertainty"])
    wavelength, factor, error, source = response.wavelength.values, [], [], []
    for name, curve in zip(names, response.responsivity.values, strict=True):
        if not points:
            factor, error, source = [*factor, 1.0], [*error, own], [*source, 1e4]
            continue
        good = np.isfinite(points[name]) & np.isfinite(points["source_temperature"])
        if good.sum() < LEAST_POINTS:
            raise ValueError(f"band {name!r} has no calibration point")
        kelvin = points["source_temperature"][good]
        ratio = np.log(points[name][good] / blackbody_signal(kelvin, wavelength, curve))
        factor.append(np.exp(ratio.mean()))
        # What scatters more than one signal may has another cause, and is believed.
        scatter = ratio.std(ddof=1) if ratio.size > 1 else 0.0
        error.append(max(own, scatter) / np.sqrt(ratio.size))
        source.append(np.mean(kelvin**-2.0) ** -0.5)
    return xr.Dataset(
        {
            "responsivity": response.responsivity,
            "band_sensitivity": ("band", factor),
            "band_sensitivity_uncertainty": ("band", error),
            "band_source_temperature": ("band", source),
            "source_temperature_uncertainty": float(source_temperature_uncertainty) if points else 0.0,
            "instrument_range": ("bound", np.asarray(response.attrs["instrument_range"])),
        },
        {"wavelength": wavelength, "band": names},
        {key: response.attrs[key] for key in ("instrument", "calibration", "signal_uncertainty", "origin")},
    )
