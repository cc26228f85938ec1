"""From a sight line to the spectral radiance of its gas and its signals in the pyrometer's bands."""

import numpy as np
import xarray as xr

from plasmapyro.checks import within
from plasmapyro.radiation.atoms import TABLE_RANGE
from plasmapyro.radiation.bandsignal import gridded_signal, gridless_signal, require_cover
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.path import gas_path, path_radiance
from plasmapyro.radiation.slit import slit_wavelengths, through_slit
from plasmapyro.radiation.systems import component_uncertainty, line_lists
from plasmapyro.tables import weakest

BANDS = ("wide", "narrow")


def line_of_sight_radiance(sightline, band_response, *, wavelength_range, grid_points, slit_fwhm):
    r"""Radiance of the gas along a sight line, by component, as seen from its far end.

    Parameters
    ----------
    sightline : Dataset, contract 'sightline'
        The light travels from the first path point (the surface) to the last (the instrument).
    band_response : Dataset, contract 'response'
    wavelength_range : (shortest, longest) [m]
        Vacuum, within 650-1250 nm (the line tables), covering both bands.
    grid_points : int
        Of the logarithmic wavenumber grid; refused when too few for the Doppler widths.
    slit_fwhm : float [m]
        Of the Gaussian slit function of the coarse view.

    Returns
    -------
    Dataset, contract 'radiation'
        `gas_radiance` and its components on the grid (the gas's own light only), the relative uncertainty of
        each component's strength, `optical_depth`, the view
        through the slit, and the band signals: of the spectrum, of the same spectrum without absorption
        (thin), and of the lines and continuum without a grid (gridless).

    Raises
    ------
    ValueError
        Range without line data; else see `gas_path`, `path_radiance`, `require_cover`.

    Notes
    -----
    Source: Fagnani et al., section on the radiation code.
    ASSUME: local thermal equilibrium.
    """
    wavelength_range = within("wavelength_range", wavelength_range, *TABLE_RANGE, "m")
    grid = log_grid(wavelength_range, grid_points)
    responses = [band_response[f"responsivity_{band}"].values for band in BANDS]
    response_wavelength = band_response["wavelength"].values
    for band, response in zip(BANDS, responses, strict=True):
        require_cover(wavelength_range, response_wavelength, response, band)
    species = [str(name) for name in sightline["species"].values]
    density = dict(zip(species, sightline["number_density"].values, strict=True))
    path = gas_path(sightline["path_distance"].values, sightline["temperature"].values, density)
    lists = line_lists(grid, path.number_density)
    result = path_radiance(path, lists, grid)

    wavelength = grid.wavelength[::-1]
    radiance, thin = result.radiance[:, ::-1], result.thin_radiance[::-1]
    total = radiance.sum(axis=0)
    view = slit_wavelengths(wavelength, slit_fwhm)
    seen = through_slit(wavelength, radiance, view, slit_fwhm)
    coarse = log_grid(wavelength_range, len(result.thin_continuum)).wavelength[::-1]
    lines = [(1 / lines.wavenumber, values) for lines, values in result.thin_lines]
    gridless = [
        gridless_signal(
            lines, coarse, result.thin_continuum[::-1], wavelength_range, response_wavelength, response
        )
        for response in responses
    ]

    def signal(spectrum):
        return ("band", [gridded_signal(wavelength, spectrum, response_wavelength, r) for r in responses])

    return xr.Dataset(
        {
            "gas_radiance": ("wavelength", total),
            "gas_radiance_component": (("component", "wavelength"), radiance),
            "component_uncertainty": ("component", component_uncertainty(result.components, lists)),
            "optical_depth": ("wavelength", result.optical_depth[::-1]),
            "gas_radiance_slit": ("wavelength_slit", seen.sum(axis=0)),
            "gas_radiance_component_slit": (("component", "wavelength_slit"), seen),
            "band_signal": signal(total),
            "band_signal_thin": signal(thin),
            "band_signal_gridless": ("band", gridless),
        },
        coords={
            "wavelength": wavelength,
            "wavelength_slit": view,
            "component": np.array(result.components, dtype=object),
            "band": np.array(BANDS, dtype=object),
        },
        attrs={
            "title": "Spectral radiance of the gas along the line of sight",
            "slit_fwhm": float(slit_fwhm),
            "neglected_radiance_bound": result.neglected_bound,
            "origin": weakest(["modelled", *(lines.origin for lines in lists)]),
        },
    )
