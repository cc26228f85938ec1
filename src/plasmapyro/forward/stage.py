"""Builds the model of both instruments from the files of the instrument and the radiance stages."""

import numpy as np

from plasmapyro.forward.bins import band_edges, bin_mean, pixel_bins, spectrometer_edges
from plasmapyro.forward.model import Instrument

BANDS = ("wide", "narrow")
SLIT_TOLERANCE = 0.02  # relative difference of two slit widths that passes as equal


def forward_model(response, calibration, radiations, pixels=None, slit_fwhm=None):
    """Model of the pyrometer and, given its pixels, of the spectrometer.

    Parameters
    ----------
    response : Dataset, contract 'response'
    calibration : Dataset, contract 'calibration'
        Its absolute sensitivities are the gains.
    radiations : mapping of numerical power [W] -> Dataset, contract 'radiation'
        May be empty: then the model knows surfaces, but no gas.
    pixels : (W,) array [m], optional
    slit_fwhm : float [m], optional
        Of the spectrometer; must be that of the slit-convolved radiances.

    Returns
    -------
    dict of Instrument, keys 'pyrometer' and, with pixels, 'spectrometer'

    Raises
    ------
    ValueError
        Radiances through another slit.
    """
    powers = np.array(sorted(radiations), dtype=float)
    ordered = [radiations[power] for power in sorted(radiations)]
    model = {"pyrometer": _pyrometer(response, calibration, powers, ordered)}
    if pixels is not None:
        model["spectrometer"] = _spectrometer(pixels, slit_fwhm, powers, ordered)
    return model


def _pyrometer(response, calibration, powers, radiations):
    wavelength = response.wavelength.values
    bands = np.stack([response[f"responsivity_{band}"].values for band in BANDS])
    edges = band_edges(wavelength, bands[0])
    gains = calibration.absolute_sensitivity.sel(band=list(BANDS)).values
    weight = gains[:, None] * bin_mean(wavelength, bands, edges) * np.diff(edges)
    return Instrument(
        "pyrometer",
        edges,
        np.array(BANDS),
        weight,
        powers,
        *(_binned(radiations, name, "wavelength", edges) for name in ("gas_radiance", "incident_radiance")),
    )


def _spectrometer(pixels, slit_fwhm, powers, radiations):
    for radiation in radiations:
        given = radiation.attrs.get("slit_fwhm", slit_fwhm)
        if slit_fwhm is not None and abs(given / slit_fwhm - 1) > SLIT_TOLERANCE:
            raise ValueError(
                f"the spectrometer's slit is {slit_fwhm * 1e9:g} nm, that of the radiance {given * 1e9:g} nm:"
                " set radiation.slit_fwhm_nm and compute the radiance again"
            )
    edges = spectrometer_edges(pixels)
    return Instrument(
        "spectrometer",
        edges,
        (edges[1:] + edges[:-1]) / 2,
        None,
        powers,
        *(
            _binned(radiations, name, "wavelength_slit", edges)
            for name in ("gas_radiance_slit", "incident_radiance_slit")
        ),
    )


def _binned(radiations, name, axis, edges):
    """Means (P, B) of a spectrum of each condition; None if one of them lacks it, or it has more axes."""
    if not radiations:
        return np.empty((0, len(edges) - 1))
    if any(name not in radiation or radiation[name].ndim != 1 for radiation in radiations):
        return None
    return np.stack([bin_mean(one[axis].values, one[name].values, edges) for one in radiations])


def bin_pixels(pixels, spectra, usable, edges):
    """Means of the usable pixels of each bin.

    Parameters
    ----------
    pixels : (W,) array [m]
    spectra : (S, W) array
    usable : (S, W) bool array
    edges : (C + 1,) array [m]

    Returns
    -------
    mean : (S, C) ndarray, NaN where a bin has lost a pixel that other exposures have
    count : (C,) ndarray
        Pixels that enter.
    """
    place = pixel_bins(pixels, edges)
    ever = usable.any(axis=0)
    total, lost = np.zeros((2, len(spectra), len(edges) - 1))
    for column in np.flatnonzero(ever):
        good = usable[:, column]
        total[:, place[column]] += np.where(good, spectra[:, column], 0.0)
        lost[:, place[column]] += ~good
    count = np.bincount(place[ever], minlength=len(edges) - 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where((lost == 0) & (count > 0), total / count, np.nan), count
