"""From a sight line to the spectral radiance of its gas and its signals in the pyrometer's bands."""

from dataclasses import replace

import numpy as np
import xarray as xr

from plasmapyro import conditions
from plasmapyro.checks import within
from plasmapyro.radiation.atoms import WHOLE_RANGE
from plasmapyro.radiation.bandsignal import (
    band_signal,
    bands_of,
    gridless_signal,
    require_cover,
    respond,
    responsivities,
)
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.levels import departures
from plasmapyro.radiation.path import CONTINUA, gas_path, incident_path, path_radiance, require_any_resolution
from plasmapyro.radiation.slit import slit_wavelengths, through_slit
from plasmapyro.radiation.stored_table import table_of
from plasmapyro.radiation.systems import component_uncertainty, line_lists
from plasmapyro.radiation.table import table_path_radiance
from plasmapyro.radiation.uncertainty import error_modes
from plasmapyro.tables import weakest

REFLECTIONS = ("specular", "diffuse")


def line_of_sight_radiance(
    sightline, band_response, *, wavelength_range, grid_points, slit_fwhm, levels=None, table=None
):
    r"""Radiance of the gas along a sight line, by component, as seen from its far end.

    Source: Fagnani et al., sec. 4.2, second term of eq. 2.
    ASSUME: local thermal equilibrium, but for `levels`.

    ValueError: range without line data, a table on another grid; else see `gas_path`, `path_radiance`,
    `table_path_radiance`, `require_cover`.

    Parameters
    ----------
    sightline : Dataset, contract 'sightline'
        The light travels from the first path point (the surface) to the last (the instrument).
    band_response : Dataset, contract 'response', or None
        Without it the result has no band signals and honours the contract 'spectrum' instead.
    wavelength_range : (shortest, longest) [m]
        Vacuum, within 650-2500 nm (the line tables), covering both bands.
    grid_points : int
        Of the logarithmic wavenumber grid; refused when too few for the Doppler widths.
    slit_fwhm : float [m]
        Of the Gaussian slit function of the coarse view.
    levels : mapping with `excitation` or `vibration` [1], optional
        Relative changes of level temperatures, see `levels.departures`.
    table : Dataset, contract 'emission_table', optional
        Of the mixture and pressure, on the same grid, for a gas in equilibrium; without it line by line.
        Band signals agree within 1e-4.

    Returns
    -------
    Dataset, contract 'radiation'
        `gas_radiance` and its components on the grid (the gas's own light only), the relative uncertainty of
        each component's strength, the modes of its error (`uncertainty.ErrorModes`), `optical_depth`, the
        view through the slit, and the band signals: of the spectrum, of the same spectrum without absorption
        (thin), and of the lines and continuum without a grid (gridless). The attributes of the condition
        (`conditions.stated`) are those of the sight line.
    """
    wavelength_range = within("wavelength_range", wavelength_range, *WHOLE_RANGE, "m")
    grid = log_grid(wavelength_range, grid_points)
    response_wavelength, responses = _responses(band_response, wavelength_range)
    path = radiating_path(sightline, levels)
    # What needs no lines is refused before they are made, which takes seconds.
    wavelength = grid.wavelength[::-1]
    view = slit_wavelengths(wavelength, slit_fwhm)
    require_any_resolution(path, grid)
    if table is None:
        lists = line_lists(grid, path.number_density)
        shining = {lines.component for lines in lists}
        path = replace(path, departures={k: one for k, one in path.departures.items() if k in shining})
        result = path_radiance(path, lists, grid)
    else:
        made = _on(table_of(table), grid)
        lists, result = made.lines, table_path_radiance(made, path)

    radiance, thin = result.radiance[:, ::-1], result.thin_radiance[::-1]
    total = radiance.sum(axis=0)
    seen = through_slit(wavelength, radiance, view, slit_fwhm)
    coarse = log_grid(wavelength_range, len(result.thin_continuum)).wavelength[::-1]
    lines = [(1 / lines.wavenumber, values) for lines, values in result.thin_lines]
    gridless = [
        gridless_signal(
            lines, coarse, result.thin_continuum[::-1], wavelength_range, response_wavelength, response
        )
        for response in responses
    ]

    weights = [respond(wavelength, response_wavelength, response) for response in responses]
    stated = component_uncertainty(result.components, lists)
    errors = error_modes(path, result.thin_lines, view, slit_fwhm, result.components, seen, stated)

    def signal(spectrum):
        return ("band", [band_signal(wavelength, weight, spectrum) for weight in weights])

    radiation = xr.Dataset(
        {
            "gas_radiance": ("wavelength", total),
            "gas_radiance_component": (("component", "wavelength"), radiance),
            "component_uncertainty": ("component", stated),
            "error_share": (("error_mode", "wavelength_slit"), errors.share.astype(np.float32)),
            "error_system": ("error_mode", np.array(errors.system, dtype=object)),
            "error_cause": ("error_mode", np.array(errors.cause, dtype=object)),
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
            "band": np.array(bands_of(band_response) if responses else [], dtype=object),
        },
        attrs={
            "title": "Spectral radiance of the gas along the line of sight",
            "slit_fwhm": float(slit_fwhm),
            "neglected_radiance_bound": result.neglected_bound,
            "origin": weakest(["modelled", *(lines.origin for lines in lists)]),
            **conditions.carried(sightline),
        },
    )
    return radiation if responses else radiation.drop_dims("band")


def radiating_path(sightline, levels=None):
    """Layers of a sight line, with `levels` as of `line_of_sight_radiance`."""
    excitation, temperature = sightline.get("excitation_temperature"), sightline["temperature"].values
    species = [str(name) for name in sightline["species"].values]
    return gas_path(
        sightline["path_distance"].values,
        temperature,
        dict(zip(species, sightline["number_density"].values, strict=True)),
        excitation_temperature=None if excitation is None else excitation.values,
        departures=departures(temperature, **levels or {}),
    )


def reflected_radiance(view, band_response, *, wavelength_range, grid_points, slit_fwhm):
    r"""Radiance with which the gas lights the stagnation point, as a mirror or a matt surface returns it.

    .. math:: L^{g,s}_{specular} = L(\theta_m), \qquad
              L^{g,s}_{diffuse} = \frac{1}{\pi}\int L(\theta) \cos\theta\, d\Omega = \sum_i w_i L(\theta_i)

    A surface of emittance :math:`\varepsilon` sends :math:`(1 - \varepsilon) L^{g,s}` towards the instrument.

    Source: Fagnani et al., eq. 2, :math:`L^{g,s}` of the third term, which the paper neglects;
    Modest, Radiative Heat Transfer, 3rd ed., chapter 1.
    ASSUME: the rays start dark at the boundary of the field: torch and chamber walls do not glow.
    ASSUME: neighbours of the stagnation point within the measured spot see the same gas.

    ValueError if not exactly one ray has weight 0; else as `line_of_sight_radiance`.

    Parameters
    ----------
    view : Dataset, contract 'surface_view'
        Rays from the surface outward; the light travels the other way.
    band_response : Dataset, contract 'response'
    wavelength_range, grid_points, slit_fwhm
        As in `line_of_sight_radiance`.

    Returns
    -------
    Dataset, contract 'reflected_radiance'
        Specular and diffuse, by component, through the slit and in the bands, at the surface; and the band
        signals of every ray.
    """
    wavelength_range = within("wavelength_range", wavelength_range, *WHOLE_RANGE, "m")
    weights = view["ray_weight"].values
    if np.count_nonzero(weights == 0) != 1:
        raise ValueError(f"exactly one ray must have weight 0; got {np.count_nonzero(weights == 0)}")
    grid = log_grid(wavelength_range, grid_points)
    response_wavelength, responses = _responses(band_response, wavelength_range)
    lists = line_lists(grid, view["species"].values.astype(str))
    components = (*(lines.component for lines in lists), *CONTINUA)
    wavelength = grid.wavelength[::-1]
    seen = [respond(wavelength, response_wavelength, response) for response in responses]
    incident = np.zeros((len(REFLECTIONS), len(components), len(grid)))
    signals = []
    for ray, weight in enumerate(weights):
        radiance = path_radiance(incident_path(view.isel(ray=ray)), lists, grid).radiance[:, ::-1]
        incident[1 if weight else 0] += radiance * (weight or 1.0)
        total = radiance.sum(axis=0)
        signals.append([band_signal(wavelength, weight, total) for weight in seen])

    slit = slit_wavelengths(wavelength, slit_fwhm)
    both = incident.sum(axis=1)
    in_bands = [band_signal(wavelength, weight, both) for weight in seen]
    return xr.Dataset(
        {
            "incident_radiance": (("reflection", "wavelength"), both),
            "incident_radiance_component": (("reflection", "component", "wavelength"), incident),
            "incident_radiance_slit": (
                ("reflection", "wavelength_slit"),
                through_slit(wavelength, both, slit, slit_fwhm),
            ),
            "incident_signal": (("reflection", "band"), np.transpose(in_bands)),
            "ray_angle": view["ray_angle"].variable,
            "ray_weight": view["ray_weight"].variable,
            "ray_signal": (("ray", "band"), signals),
        },
        coords={
            "wavelength": wavelength,
            "wavelength_slit": slit,
            "component": np.array(components, dtype=object),
            "band": np.array(bands_of(band_response), dtype=object),
            "reflection": np.array(REFLECTIONS, dtype=object),
        },
        attrs={
            "title": "Radiance of the gas that lights the stagnation point",
            "slit_fwhm": float(slit_fwhm),
            "origin": weakest(["modelled", *(lines.origin for lines in lists)]),
        },
    )


def _on(table, grid):
    if not np.array_equal(table.grid.wavenumber, grid.wavenumber):
        raise ValueError(
            f"the table must be on the grid of the spectrum, {len(grid)} points; got {len(table.grid)}, or"
            " another range"
        )
    return table


def _responses(band_response, wavelength_range):
    """Wavelengths and responsivities of both bands, all of them within the range; none without a file."""
    if band_response is None:
        return None, []
    wavelength = band_response["wavelength"].values
    responses = responsivities(band_response)
    for band, response in zip(bands_of(band_response), responses, strict=True):
        require_cover(wavelength_range, wavelength, response, band)
    return wavelength, responses
