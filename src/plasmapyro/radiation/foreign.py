"""Light that the simulated gas lacks or has too much of: other lines, continuum, absorption, ripple."""

import numpy as np
import xarray as xr

from plasmapyro.checks import fraction
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.gas.argon import densities, species_of
from plasmapyro.gas.species import argon_of, nitrogen_of
from plasmapyro.radiation.bandsignal import BANDS, band_signal, respond, responsivities
from plasmapyro.radiation.path import CONTINUA
from plasmapyro.radiation.slit import through_slit
from plasmapyro.radiation.transfer import escape_fraction

OXYGEN = (776.5e-9, 778.8e-9)  # [m] around the triplet of O I, the yardstick of line strengths
RIPPLE = np.cos(np.pi * (np.arange(4) + 0.5) / 4)  # sines of equal weight: exact for powers up to 7
LINEAR = ("gas_radiance", "gas_radiance_component", "gas_radiance_slit", "gas_radiance_component_slit")
CONTINUUM_TEMPERATURE = 6000.0  # [K] of the free electrons
SIGNALS = ("band_signal", "band_signal_thin", "band_signal_gridless")


def oxygen_triplet(wavelength, radiance):
    """Light of the triplet of O I at 777 nm [W m-2 sr-1] in a spectrum behind a slit."""
    near = (wavelength > OXYGEN[0]) & (wavelength < OXYGEN[1])
    return float(np.trapezoid(radiance[near], wavelength[near]))


def with_lines(radiation, band_response, name, wavelength, strength, amount):
    r"""The light of a gas and, added to it, lines of a species that it does not hold.

    .. math:: L'_\lambda = L_\lambda + a\,L_{777} \sum_l f_l\,\delta(\lambda - \lambda_l)

    with the amount a [1] and the light of the triplet of O I in the simulation; `strength` (L,): shares f of
    all lines at vacuum wavelengths (L,) [m]; `name`: the species, a component of the result. `band_response`
    is None for a spectrum without bands. ASSUME: optically thin, and narrower than a step of the grid, on
    which a line keeps its light and place.
    """
    axis, slit = radiation["wavelength"].values, radiation["wavelength_slit"].values
    light = oxygen_triplet(slit, radiation["gas_radiance_slit"].values) * amount * np.asarray(strength)
    inside = (wavelength > axis[0]) & (wavelength < axis[-1])
    light, place = light[inside], np.asarray(wavelength)[inside]
    low = np.searchsorted(axis, place) - 1
    share = (place - axis[low]) / (axis[low + 1] - axis[low])
    lines = np.bincount(low, light * (1 - share), axis.size) + np.bincount(low + 1, light * share, axis.size)
    lines /= np.gradient(axis) * np.where(np.isin(np.arange(axis.size), [0, axis.size - 1]), 0.5, 1.0)
    return _with_light(radiation, band_response, name, lines)


def with_continuum(radiation, band_response, amount, own=0.0):
    r"""The light of a gas and, added to it, more continuum.

    .. math:: L'_\lambda = L_\lambda + a\,\langle L \rangle \left((1-s) \frac{c_\lambda}{\langle c \rangle} +
              s \frac{k_\lambda}{\langle k \rangle}\right), \qquad c_\lambda = \lambda^{-2} e^{-c_2/\lambda T}

    with the amount a [1] of the mean light behind the slit, of free electrons and, for the share s (`own`),
    of the simulated continua k; less than 0 takes light away, as far as there is any.
    """
    axis, slit = radiation["wavelength"].values, radiation["wavelength_slit"].values
    parts = radiation["gas_radiance_component_slit"]
    simulated = parts.values[np.isin(parts["component"].values, CONTINUA)].sum(axis=0)
    shape = (1 - own) * continuum(axis) / continuum(slit).mean()
    shape += own * np.interp(axis, slit, simulated) / (simulated.mean() or 1.0)
    level = amount * float(radiation["gas_radiance_slit"].mean())
    light = np.maximum(level * shape, -radiation["gas_radiance"].values)
    return _with_light(radiation, band_response, "more continuum", light)


def continuum(wavelength):
    r"""Light of free electrons at 6000 K (G,), flat in emission coefficient per frequency; any unit.

    .. math:: \lambda^{-2} e^{-c_2/\lambda T}
    """
    return wavelength**-2.0 * np.exp(-SECOND_RADIATION / (wavelength * CONTINUUM_TEMPERATURE))


def more_absorbed(radiation, band_response, depth):
    r"""The light of a gas whose lines absorb themselves more than simulated; components are weakened alike.

    .. math:: L'_\lambda = L_\lambda \frac{1 - e^{-x}}{x}, \qquad x = d\,\frac{\tau_\lambda}{\max \tau}

    with the further optical depth d >= 0 of the strongest line. Source: uniform slab, K. R. Lang,
    Astrophysical Formulae; ASSUME: emission and absorption are mixed evenly.
    """
    axis, slit = radiation["wavelength"].values, radiation["wavelength_slit"].values
    tau = radiation["optical_depth"].values
    factor = self_absorbed(np.ones_like(tau), tau, depth / tau.max())
    fine = {name: radiation[name] * factor for name in LINEAR[:2]}
    fwhm = float(radiation.attrs["slit_fwhm"])
    seen = {
        f"{name}_slit": radiation[f"{name}_slit"].copy(data=through_slit(axis, light.values, slit, fwhm))
        for name, light in fine.items()
    }
    more = fine["gas_radiance"] - radiation["gas_radiance"]
    return _with_signals(radiation.assign(fine | seen), band_response, radiation, more.values)


def self_absorbed(radiance, optical_depth, factor):
    r"""Spectrum (..., G) of a gas `factor` times as opaque: :math:`L (1 - e^{-x})/x`, :math:`x = f\tau`."""
    depth = factor * optical_depth
    return radiance * escape_fraction(np.where(depth > 0, depth, 0.0))


def _with_light(radiation, band_response, name, light):
    """The light of a gas and a component more, (G,) [W m-2 sr-1 m-1]."""
    axis, slit = radiation["wavelength"].values, radiation["wavelength_slit"].values
    seen = through_slit(axis, light, slit, float(radiation.attrs["slit_fwhm"]))
    before = radiation["gas_radiance_slit"]
    row = xr.Dataset(
        {
            "gas_radiance_component": (("component", "wavelength"), light[None]),
            "gas_radiance_component_slit": (("component", "wavelength_slit"), seen[None]),
            "component_uncertainty": ("component", [0.0]),
        },
        {"component": np.array([name], dtype=object)},
    )
    result = radiation.drop_dims("component").merge(xr.concat([radiation[list(row)], row], "component"))
    result["gas_radiance"] = radiation["gas_radiance"] + light
    result["gas_radiance_slit"] = before + seen
    if "error_share" in result:
        result["error_share"] = result["error_share"] * (before / result["gas_radiance_slit"])
    return _with_signals(result, band_response, radiation, light)


def _with_signals(result, band_response, radiation, more):
    """The result with the signals of a radiation and of further light (G,)."""
    if band_response is not None:
        axis, curves = radiation["wavelength"].values, responsivities(band_response)
        weights = [respond(axis, band_response["wavelength"].values, curve) for curve in curves]
        extra = xr.DataArray([band_signal(axis, weight, more) for weight in weights], {"band": list(BANDS)})
        for signal in SIGNALS:
            result[signal] = radiation[signal] + extra
    return result.assign_attrs(radiation.attrs)[list(radiation)]


def rippled(radiance, sightline, ripple):
    r"""Mean light of a gas whose temperature follows a sine, in equilibrium at its pressure.

    .. math:: \langle L(T (1 + a \sin\omega t)) \rangle

    `radiance`: sightline -> light; the errors that it states and the optical depth are those of the mean gas.
    """
    middle, size = radiance(sightline), fraction("ripple", ripple)
    parts = [radiance(warmer(sightline, size * phase)) for phase in RIPPLE]
    changed = [name for name in (*LINEAR, *SIGNALS) if name in middle]
    return middle.assign({name: sum(one[name] for one in parts) / len(parts) for name in changed})


def warmer(sightline, change):
    """A sight line at temperatures T (1 + change), its composition in equilibrium at its pressure."""
    argon = argon_of(sightline)
    names = list(species_of(argon))
    if "excitation_temperature" in sightline or set(sightline["species"].values) != set(names):
        raise ValueError("a ripple needs air or nitrogen in equilibrium along the line of sight")
    temperature = sightline["temperature"] * (1 + change)
    density = densities(temperature.values, sightline["pressure"].values, nitrogen_of(sightline), argon)
    density = xr.DataArray(density.T, {"species": names}, ("species", "path_distance"))
    density = density.sel(species=sightline["species"].values).variable
    return sightline.assign(temperature=temperature, number_density=density)
