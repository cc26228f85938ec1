"""Stage: what the light of the gas would be if something in the gas were not as simulated."""

import numpy as np
import xarray as xr

from plasmapyro import conditions
from plasmapyro.diagnosis.gas import variations as vary
from plasmapyro.gas.species import nitrogen_of
from plasmapyro.radiation.foreign import self_absorbed
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.path import incident_path
from plasmapyro.radiation.slit import through_slit
from plasmapyro.radiation.stored_table import table_of
from plasmapyro.radiation.systems import line_lists
from plasmapyro.radiation.table import equilibrium_table, table_total
from plasmapyro.radiation.transfer import layer_thickness

CORE = 0.06 * np.arange(-6, 8)  # a ripple of 0.25 at a power five standard deviations off, and back
EXCITATION = (-0.1, -0.05, 0.0, 0.05, 0.1)
VIBRATION = (-0.3, -0.15, 0.0, 0.15, 0.3)
DEPTHS = (0.0, 0.25, 0.5, 1.0, 2.0)
WALL = 1600.0  # [K]
CARBON_SHARE = 0.01  # CN per particle at the wall, for a spectrum that is scaled afterwards
CARBON_DEPTH = 5e-3  # [m]
LINE_GRID_POINTS = 160_000  # 2.7 pm at 800 nm, a fifth of the Doppler width of O I in the core


def gas_variations(sightline, view, radiation, table=None, *, pressure, boundary_layer_depth):
    r"""Spectra of the gas as a slit shows them, varied one property at a time.

    Each is the simulated spectrum times the ratio of two spectra of optically thin gas; what adds light is
    given as that light. The light that falls on the surface is absorbed on its way: seen end on, the core of
    the torch keeps half of its strong lines.

    ASSUME: away from the wall a change of temperature leaves the gas in equilibrium at its pressure.

    Parameters
    ----------
    sightline : Dataset, contract 'sightline'
    view : Dataset, contract 'surface_view'
        For the light that the surface reflects.
    radiation : Dataset, contract 'radiation'
    table : Dataset, contract 'emission_table', optional
        Of the mixture and pressure over the wavelengths of the radiation; made where it is not given.
    pressure : float [Pa]
        Of the gas in the field.
    boundary_layer_depth : float [m]

    Returns
    -------
    Dataset, contract 'gas_variations'
        `core_radiance` (core_change, wavelength_slit) of hotter and colder gas; `varied_radiance` (variation,
        level, wavelength_slit) at `variation_amplitude` (variation, level): temperature of excitation of the
        atoms and of vibration of N2 (relative), optical depth of the strongest line; and `added_radiance`
        (addition, wavelength_slit): reflected as by a mirror and a matt surface per 1 - emittance, a wall of
        1600 K, CN at the wall.
    """
    slit, fwhm = radiation["wavelength_slit"].values, float(radiation.attrs["slit_fwhm"])
    fine = radiation["wavelength"].values
    base = radiation["gas_radiance_slit"].values
    nitrogen = nitrogen_of(sightline)
    if table is None:
        made = equilibrium_table(log_grid((fine[0], fine[-1]), LINE_GRID_POINTS), pressure, nitrogen)
    else:
        made = table_of(table)
    distance, temperature = sightline["path_distance"].values, sightline["temperature"].values
    thickness = layer_thickness(distance)

    gas = vary.GasEmission(made.lines, slit, fwhm, pressure, nitrogen)

    def tabulated(**change):
        return vary.Emission(gas.temperature, gas.varied(**change))

    plain = tabulated()
    thin = plain.along(temperature, thickness)

    def relative(spectrum):
        return base * spectrum / thin

    rows = {
        "excitation": (
            EXCITATION,
            [relative(tabulated(excitation=1 + x).along(temperature, thickness)) for x in EXCITATION],
        ),
        "vibration": (
            VIBRATION,
            [relative(tabulated(vibration=1 + x).along(temperature, thickness)) for x in VIBRATION],
        ),
    }
    depth = radiation["optical_depth"].values
    strongest = depth.max()
    total = radiation["gas_radiance"].values
    spectra = np.stack([self_absorbed(total, depth, x / strongest) for x in DEPTHS])
    seen = through_slit(fine, spectra, slit, fwhm)
    rows["optical_depth"] = (DEPTHS, list(base * seen / seen[0]))

    mirrored, scattered = _falling(view, made, slit, fwhm)
    warm = vary.warmer_wall(distance, temperature, WALL, boundary_layer_depth)
    wall = relative(plain.along(warm, thickness)) - base
    additions = {
        "reflected_specular": mirrored,
        "reflected_diffuse": scattered,
        "warm_wall": wall,
        "cyanogen": _cyanogen(slit, fwhm, fine, distance, temperature, thickness, pressure),
    }
    names = list(rows)
    return xr.Dataset(
        {
            "core_radiance": (
                ("core_change", "wavelength_slit"),
                np.array([relative(plain.along(temperature * (1 + x), thickness)) for x in CORE]),
            ),
            "variation_amplitude": (("variation", "level"), np.array([rows[n][0] for n in names])),
            "varied_radiance": (
                ("variation", "level", "wavelength_slit"),
                np.array([rows[n][1] for n in names]),
            ),
            "added_radiance": (("addition", "wavelength_slit"), np.array(list(additions.values()))),
        },
        {
            "core_change": CORE,
            "variation": np.array(names, dtype=object),
            "addition": np.array(list(additions), dtype=object),
            "wavelength_slit": slit,
        },
        {
            "title": "Light of the gas with one property varied",
            "slit_fwhm": fwhm,
            "optical_depth_simulated": float(strongest),
            "origin": "modelled",
            **conditions.carried(radiation),
        },
    )


def _falling(view, table, slit, fwhm):
    """Radiance (2, K) [W m-2 sr-1 m-1] behind the slit of what falls on the stagnation point: from where a
    mirror shows it, and the mean over the half space that a matt surface scatters."""
    light = np.zeros((2, len(table.grid)))
    for ray, weight in enumerate(view["ray_weight"].values):
        path = incident_path(view.isel(ray=ray))
        light[1 if weight else 0] += (weight or 1.0) * table_total(table, path)
    return through_slit(table.grid.wavelength[::-1], light[:, ::-1], slit, fwhm)


def _cyanogen(slit, fwhm, fine, distance, temperature, thickness, pressure):
    """Red system of CN from a layer at the wall (K,) [W m-2 sr-1 m-1]."""
    species = ("CN",)
    (lines,) = [
        found
        for found in line_lists(log_grid((fine[0], fine[-1]), LINE_GRID_POINTS), species)
        if found.component == "CN red"
    ]
    histogram = vary.SlitHistogram(1 / lines.wavenumber, slit, fwhm)
    layers = np.flatnonzero((distance < 4 * CARBON_DEPTH) & (temperature > vary.NODE_RANGE[0]))
    strength = sum(
        thickness[layer]
        * vary.excited_lines(
            lines,
            temperature[layer],
            CARBON_SHARE
            * np.exp(-distance[layer] / CARBON_DEPTH)
            * vary.particle_density(pressure, temperature[layer]),
        )
        for layer in layers
    )
    return np.maximum(histogram(strength), 0)
