"""Stages of the paper's section 4: what the gas along the line of sight does to the reading.

All of them start from the band signals of the gas, one pair per power condition (`gather`).
"""

import numpy as np
import xarray as xr

from plasmapyro.analysis.error import error_limit, relative_error
from plasmapyro.analysis.reflection import reflected
from plasmapyro.analysis.transient import step_response
from plasmapyro.analysis.visibility import temperature_at_visibility, visibility_factor
from plasmapyro.checks import fraction, increasing
from plasmapyro.conditions import ladder, number
from plasmapyro.instrument.pyrometer import blackbody_signals, calibration_ratio, invert_grey, invert_ratio
from plasmapyro.radiation.bandsignal import bands_of, respond, responsivities
from plasmapyro.radiation.planck import blackbody_radiance


def gather(radiation, *, emittance):
    """Band signals of the gas of all conditions, side by side (contract 'gas_signal'), sorted by power.

    Of the light of each condition, whose attributes say power and pressure (`conditions.stated`, NaN if they
    do not), and the emittance of the surface in it.
    """
    if not radiation:
        raise ValueError("no power condition: at least one radiation file is needed")
    names = list(map(str, next(iter(radiation.values())).band.values))
    signal = [[float(case.band_signal.sel(band=band)) for band in names] for case in radiation.values()]
    gathered = xr.Dataset(
        {
            "gas_signal": (("condition", "band"), signal),
            **{
                name: ("condition", [number(case, name) for case in radiation.values()])
                for name in ("numerical_power", "chamber_pressure")
            },
            "sample_emittance": ("condition", [fraction("emittance", value) for value in emittance]),
            "first_of_ladder": ("condition", [ladder(name, radiation)[0] for name in radiation]),
        },
        {"condition": list(radiation), "band": names},
    )
    return gathered.sortby(["numerical_power", "chamber_pressure", "condition"])


def _of_conditions(gas):
    """What each condition is, for the results made from its gas."""
    return {name: gas[name] for name in ("numerical_power", "chamber_pressure") if name in gas}


def visibility(gas, response, *, object_temperature, visibility_level):
    """Visibility factors of all bands, and the surface temperatures at which they reach given levels.

    `object_temperature` [K] rises; levels lie in (0, 1). Source: Fagnani et al., eq. 10, sec. 4.3.
    """
    temperature = increasing("object_temperature", object_temperature, "K")
    surface = gas.sample_emittance.values[:, None, None] * blackbody_signals(temperature, response)[None]
    factor = visibility_factor(surface, gas.gas_signal.values[:, :, None])

    def limit(level, case, band):
        return temperature_at_visibility(
            level,
            lambda value: blackbody_signals(value, response)[band],
            gas.gas_signal.values[case, band],
            gas.sample_emittance.values[case],
        )

    cases, bands = range(gas.sizes["condition"]), range(gas.sizes["band"])
    limits = [[[limit(level, case, band) for band in bands] for case in cases] for level in visibility_level]
    return xr.Dataset(
        {
            "visibility_factor": (("condition", "band", "object_temperature"), factor),
            "visibility_limit": (("visibility_level", "condition", "band"), limits),
            **_of_conditions(gas),
            "sample_emittance": gas.sample_emittance,
        },
        {"object_temperature": temperature, "visibility_level": list(visibility_level), "band": gas.band},
    )


def apparent_temperature(gas, response, curve, *, object_temperature):
    """Temperature read on each condition's surface through the gas, and its relative error.

    `object_temperature` [K] rises; NaN and a status where the curve gives no reading. Source: Fagnani et al.,
    eqs. 4 to 7. ASSUME: thin atmosphere, uniform window, no reflected gas radiation (their sec. 2).
    """
    temperature = increasing("object_temperature", object_temperature, "K")
    reading, status = _read(gas, response, curve, gas.sample_emittance.values[:, None], temperature[None])
    dims = ("condition", "object_temperature")
    return xr.Dataset(
        {
            "apparent_temperature": (dims, reading),
            "relative_error": (dims, relative_error(reading, temperature)),
            "reading_status": (dims, status),
            **_of_conditions(gas),
            "sample_emittance": gas.sample_emittance,
            "instrument_range": curve.instrument_range,
        },
        {"object_temperature": temperature},
    )


def error_map(gas, response, curve, *, object_temperature, emittance, error_level):
    """Relative error over surface temperature and emittance, and the curve of one error level.

    `object_temperature` [K] rises, as does the emittance, in (0, 1]. Source: Fagnani et al., eq. 7, sec. 4.4.
    """
    temperature = increasing("object_temperature", object_temperature, "K")
    emittance = increasing("emittance", emittance, "1")
    shape = (1, emittance.size, 1), (1, 1, temperature.size)
    reading, _ = _read(gas, response, curve, emittance.reshape(shape[0]), temperature.reshape(shape[1]))
    error = relative_error(reading, temperature)
    limit, status = error_limit(temperature, error, error_level)
    dims = ("condition", "emittance")
    return xr.Dataset(
        {
            "relative_error": ((*dims, "object_temperature"), error),
            "error_limit": (dims, limit),
            "limit_status": (dims, status),
            **_of_conditions(gas),
        },
        {"object_temperature": temperature, "emittance": emittance},
        {"error_level": float(error_level)},
    )


def transient(gas, response, curve, *, conditions, time, initial_temperature, gain, natural_frequency):
    """Apparent temperature while a sample heats as a critically damped second-order system.

    Of the named conditions, at times [s] that rise; temperatures [K] and frequency [s-1] as of
    `transient.step_response`. Source: Fagnani et al., eq. 11, sec. 4.5.
    """
    missing = sorted(set(conditions) - set(gas.condition.values))
    if missing:
        raise ValueError(
            f"transient of unknown condition {', '.join(missing)}; known: {list(gas.condition.values)}"
        )
    chosen = gas.sel(condition=list(conditions))
    time = increasing("time", time, "s")
    truth = step_response(time, initial_temperature, gain, natural_frequency)
    reading, status = _read(chosen, response, curve, chosen.sample_emittance.values[:, None], truth[None])
    dims = ("condition", "time")
    return xr.Dataset(
        {
            "object_temperature_history": ("time", truth),
            "apparent_temperature": (dims, reading),
            "reading_status": (dims, status),
            **_of_conditions(chosen),
            "sample_emittance": chosen.sample_emittance,
            "instrument_range": curve.instrument_range,
        },
        {"time": time},
    )


def surface_radiance(*, object_temperature, emittance, wavelength):
    """Radiance of a grey surface at several temperatures [K], to be set beside that of the gas.

    Source: Fagnani et al., eq. 2, first term, without window and atmosphere; sec. 4.2.

    >>> found = surface_radiance(object_temperature=[1500.0], emittance=0.85, wavelength=[1.0e-6])
    >>> f"{found.surface_radiance.item() * 1e-6:.1f} W m-2 sr-1 per um"
    '6913.4 W m-2 sr-1 per um'
    """
    temperature = increasing("object_temperature", object_temperature, "K")
    wavelength = increasing("wavelength", wavelength, "m")
    radiance = fraction("emittance", emittance) * blackbody_radiance(wavelength, temperature[:, None])
    return xr.Dataset(
        {"surface_radiance": (("object_temperature", "wavelength"), radiance)},
        {"object_temperature": temperature, "wavelength": wavelength},
        {"emittance": float(emittance)},
    )


def _read(gas, response, curve, emittance, temperature):
    """Reading and status of shape broadcast(emittance, temperature) with conditions first."""
    black = blackbody_signals(temperature, response)
    lead = (-1,) + (1,) * (np.ndim(temperature) - 1)
    light = [gas.gas_signal.sel(band=band).values.reshape(lead) for band in bands_of(response)]
    return _reading([emittance * body + gas for body, gas in zip(black, light, strict=True)], curve)


def _reading(signals, curve):
    """Reading and status of an instrument that takes the surface as grey, from signals (...) of its bands."""
    if "calibration_signal" in curve:
        return invert_grey(signals, curve.calibration_temperature.values, curve.calibration_signal.values)
    ratio = calibration_ratio(float(curve.sensitivity_ratio), signals)
    return invert_ratio(ratio, curve.calibration_temperature.values, curve.calibration_ratio.values)


SURFACES = {"no reflection": None, "mirror": 0.0, "mixed": 0.5, "matt": 1.0}  # share of diffuse reflection
CORRECTIONS = ("none", "line of sight", "reference")


def reflection_map(
    gas, spectra, response, curve, *, object_temperature, emittance, error_level, gas_variation, tolerance
):
    r"""Error maps of samples that reflect the gas, before and after two corrections.

    .. math:: S = \varepsilon B(T) + G
              + (1 - \varepsilon)\,[(1 - m)\,S^{g,s}_{specular} + m\,S^{g,s}_{diffuse}]

    The corrections subtract the gas of the line of sight alone (known from a simulation or a view past the
    sample: the reflection stays), or the reference measured on the cold sample itself, reflection included,
    which then is wrong by `gas_variation`.

    Source: Fagnani et al., eq. 2, secs. 4.4 and 5.1. ASSUME: the mirrored ray of an axisymmetric jet is the
    line of sight, so that the specular part is the gas signal itself; flat spectral reflectance.

    Parameters
    ----------
    gas : Dataset, contract 'gas_signal'
    spectra : Dataset, contract 'gas_spectra', of some of these conditions
    response, curve : Datasets, contracts 'response', 'ratio_curve'
    object_temperature, emittance : (T,) [K], (E,) [1], increasing
    error_level : float [1]
    gas_variation : float [1]
        How far the gas may have drifted from its reference.
    tolerance : float [K]
        What the neglect of the reflection may cost at most.

    Returns
    -------
    Dataset, contract 'reflection'
    """
    temperature = increasing("object_temperature", object_temperature, "K")
    emittance = increasing("emittance", emittance, "1")
    order = list(spectra.condition.values)
    gas = gas.sel(condition=order)
    incident = spectra.incident_binned.sel(condition=order, reflection="diffuse").values
    middle = spectra.wavelength.values
    size = np.diff(spectra.wavelength_edge.values)
    curves = [respond(middle, response.wavelength.values, row) for row in responsivities(response)]
    diffuse = np.stack([incident @ (row * size) for row in curves], axis=1)  # (condition, band)
    names = bands_of(response)
    own = gas.gas_signal.sel(band=names).values
    black = blackbody_signals(temperature, response)
    shape = (len(SURFACES), len(CORRECTIONS), len(order), emittance.size, temperature.size)
    error, grey = np.empty(shape), emittance[None, :, None]
    for surface, mix in enumerate(SURFACES.values()):
        added = [
            light + (0.0 if mix is None else reflected(grey, light, scattered, mix))
            for light, scattered in zip(own.T[:, :, None, None], diffuse.T[:, :, None, None], strict=True)
        ]
        for row in range(len(CORRECTIONS)):
            left = [
                (extra, extra - own[:, band, None, None], gas_variation * extra)[row]
                for band, extra in enumerate(added)
            ]
            seen = [grey * body + more for body, more in zip(black, left, strict=True)]
            reading, _ = _reading(seen, curve)
            error[surface, row] = relative_error(reading, temperature)
    limit, status = error_limit(temperature, error, error_level)
    cost = np.abs(error - error[:1]) * temperature
    within_tolerance, _ = error_limit(temperature, cost, tolerance)
    below = np.where(np.isnan(within_tolerance), temperature[0], within_tolerance)
    beyond = np.where(np.isnan(cost[..., -1]) | (cost[..., -1] > tolerance), np.nan, below)
    dims = ("surface", "correction", "condition", "emittance")
    return xr.Dataset(
        {
            "relative_error": ((*dims, "object_temperature"), error),
            "error_limit": (dims, limit),
            "limit_status": (dims, status),
            "neglect_limit": (dims, beyond),
            "incident_signal": (("condition", "reflection", "band"), np.stack([own, diffuse], axis=1)),
            "gas_signal": (("condition", "band"), own),
            **_of_conditions(gas),
        },
        {
            "surface": list(SURFACES),
            "correction": list(CORRECTIONS),
            "condition": order,
            "emittance": emittance,
            "object_temperature": temperature,
            "reflection": ["specular", "diffuse"],
            "band": names,
        },
        {
            "error_level": float(error_level),
            "gas_variation": float(gas_variation),
            "neglect_tolerance": float(tolerance),
        },
    )
