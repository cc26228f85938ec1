"""Stages of the instrument: responses, calibration of the pyrometer, calibration of the spectrometer."""

import numpy as np
import xarray as xr

from plasmapyro import tables
from plasmapyro.instrument.response import sandwich_response, silicon_absorption


def band_response(
    *,
    silicon_table,
    top_thickness,
    bottom_thickness,
    short_wavelength_edge,
    edge_sigma,
    long_wavelength_limit,
    wavelength_step,
):
    """Modelled responses of the two bands of a sandwich silicon pyrometer.

    The grid runs from six edge widths below the long-pass edge to the long limit, beyond which both
    responses are taken as zero.

    Parameters
    ----------
    silicon_table : str
        Table in `data/detector`, e.g. 'silicon_green_2008'.
    top_thickness, bottom_thickness : float [m]
        Layers of the detector; the top one sets where the narrow band begins.
    short_wavelength_edge, edge_sigma : float [m]
        Position and width of the long-pass filter.
    long_wavelength_limit : float [m]
        End of both bands.
    wavelength_step : float [m]
        Spacing of the samples, at most; the last sample falls on the limit.

    Returns
    -------
    Dataset, contract 'response', origin 'modelled'

    Notes
    -----
    Source: Fagnani et al., sec. 3.2 (bands 0.75 to 1.15 um and 0.95 to 1.15 um). Deviation: the
    maker's manual (MR1S rev. E2) ends both bands at 1.1 um; the paper's limit is the default here.
    ASSUME: the printed band limits are feet of the curves, about a tenth of the peak: with the top
    layer that puts the foot of the narrow band at 0.95 um, the silicon tail reaches a tenth of the
    peak near the printed long limit as well, which half-height limits would not.
    """
    table = tables.load(f"detector/{silicon_table}")
    start = short_wavelength_edge - 6 * edge_sigma
    if not start < long_wavelength_limit:
        raise ValueError(
            f"long_wavelength_limit must exceed the long-pass edge; got {long_wavelength_limit:g} m"
            f" against {short_wavelength_edge:g} m"
        )
    count = int(np.ceil((long_wavelength_limit - start) / wavelength_step * (1 - 1e-9))) + 1
    wavelength = np.linspace(start, long_wavelength_limit, count)
    wide, narrow = sandwich_response(
        wavelength,
        silicon_absorption(wavelength, table["wavelength"], table["absorption_coefficient"]),
        top_thickness=top_thickness,
        bottom_thickness=bottom_thickness,
        edge=short_wavelength_edge,
        edge_sigma=edge_sigma,
    )
    return xr.Dataset(
        {"responsivity_wide": ("wavelength", wide), "responsivity_narrow": ("wavelength", narrow)},
        {"wavelength": wavelength},
        {
            "origin": tables.weakest(["modelled", table.origin]),
            "references": f"Modelled layered silicon detector; absorption: {table.source}",
        },
    )
