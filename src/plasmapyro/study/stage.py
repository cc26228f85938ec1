"""Stages of a parameter study: a flow or the word that there is none, a sight line, all side by side."""

import logging

import numpy as np
import xarray as xr

from plasmapyro.analysis.stage import apparent_temperature, error_map
from plasmapyro.analysis.visibility import visibility_factor
from plasmapyro.checks import flags, fraction, increasing
from plasmapyro.flow import stage as flow_stage
from plasmapyro.flow.continuation import Extinguished, NotConverged
from plasmapyro.instrument.pyrometer import blackbody_signals
from plasmapyro.radiation.bandsignal import BANDS, two_bands
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.sightline.stage import line_of_sight

log = logging.getLogger(__name__)

COMPUTED, EXTINGUISHED, UNSTEADY, NOT_ASKED = 0, 1, 2, 3
MEANINGS = {
    COMPUTED: "computed",
    EXTINGUISHED: "plasma_goes_out",
    UNSTEADY: "no_steady_flow_found",
    NOT_ASKED: "not_part_of_the_study",
}
NO_GAS = 2  # status of a reading or limit where the gas is not known
FLOW_DIMS = ("numerical_power", "chamber_pressure", "mass_flow_rate")
DIMS = (*FLOW_DIMS, "emittance", "sightline_angle")
BATCH = 64  # sight lines worked on together, for the memory of their error maps
ROUND_OFF = 1e-12  # relative, between values that are the same but for a change of unit


def flow(
    gas, start, *, known=(), neighbours=(), numerical_power, chamber_pressure, mass_flow_rate, **settings
):
    """Steady flow at one condition, or a dataset that says why there is none (contract 'study_flow').

    That a flow was not found is a result of the study, not a fault of the run: the plasma may go out there,
    or the flow may have no steady state. `flow_status` 1 or 2 says so, with the attribute `reason` and none
    of the fields. Every other fault is raised. Arguments as of `flow.stage.condition`, errors are not
    estimated; `known`: other flows of the study, of which those without a flow are left out.
    """
    found = [one.drop_vars("flow_status") for one in known if int(one.flow_status) == COMPUTED]
    place = {
        "numerical_power": float(numerical_power),
        "chamber_pressure": float(chamber_pressure),
        "mass_flow_rate": float(mass_flow_rate),
    }
    try:
        # No error estimate: it costs two more flows on coarser meshes, of which a study keeps nothing.
        result = flow_stage.condition(
            gas, start, neighbours=[*found, *neighbours], error_mesh_ratio=0.0, **place, **settings
        )
        status = COMPUTED
    except NotConverged as fault:
        log.warning("%s", fault)
        status = EXTINGUISHED if isinstance(fault, Extinguished) else UNSTEADY
        result = xr.Dataset(place, attrs={"origin": "modelled", "reason": str(fault)})
    return result.assign(flow_status=((), np.int8(status), flags(MEANINGS)))


def signal(
    flow,
    response,
    *,
    angle,
    points,
    window_distance,
    instrument_distance,
    laboratory_temperature,
    laboratory_pressure,
    wavelength_range,
    grid_points,
    slit_fwhm,
):
    """Band signals of the gas and its highest temperature along one line of sight (contract 'study_signal').

    NaN where there is no flow; the spectrum is not kept. Settings as of `sightline.stage.line_of_sight` and
    `radiation.stage.line_of_sight_radiance`.
    """
    place = {name: flow[name] for name in FLOW_DIMS}
    gas_signal, peak, origin = np.full(len(BANDS), np.nan), np.nan, "modelled"
    if int(flow.flow_status) == COMPUTED:
        line = line_of_sight(
            flow,
            angle=angle,
            points=points,
            window_distance=window_distance,
            instrument_distance=instrument_distance,
            laboratory_temperature=laboratory_temperature,
            laboratory_pressure=laboratory_pressure,
        )
        light = line_of_sight_radiance(
            line, response, wavelength_range=wavelength_range, grid_points=grid_points, slit_fwhm=slit_fwhm
        )
        gas_signal = light.band_signal.sel(band=list(BANDS)).values
        peak, origin = float(line.temperature.max()), light.attrs["origin"]
    return xr.Dataset(
        {
            **place,
            "sightline_angle": float(angle),
            "flow_status": ((), flow.flow_status.values, flags(MEANINGS)),
            "gas_signal": ("band", gas_signal),
            "peak_temperature": peak,
        },
        {"band": list(BANDS)},
        {"origin": origin},
    )


def gather(signals, response, curve, *, conditions, object_temperature, limit_temperature, error_level):
    """All conditions of a study along named dimensions: gas, visibility, reading, limit of the error.

    Source: Fagnani et al., secs. 4.2 to 4.4, as in `analysis.stage`.

    ValueError: a condition without a signal, an emittance outside (0, 1].

    Parameters
    ----------
    signals : iterable of Dataset, contract 'study_signal'
        One for each flow and angle that the conditions need.
    response, curve : Datasets, contracts 'response', 'ratio_curve'
    conditions : (N, 5) array_like
        Power [W], pressure [Pa], mass flow rate [kg s-1], emittance [1], angle [rad] of each condition.
    object_temperature : (T,) array [K], strictly increasing
        Of the curves that are kept.
    limit_temperature : (L,) array [K], strictly increasing
        Among which the limit of the error is looked for.
    error_level : float [1]

    Returns
    -------
    Dataset, contract 'study'
        Dimensions are the values that occur, rising. Where a combination was not asked for or has no flow,
        numbers are NaN and `study_status` says which of the two.
    """
    conditions = np.atleast_2d(np.asarray(conditions, dtype=float))
    temperature = increasing("object_temperature", object_temperature, "K")
    response = two_bands(response, "a study")
    axes = [np.unique(column) for column in conditions.T]
    emittance = np.array([fraction("emittance", value) for value in axes[DIMS.index("emittance")]])
    asked = np.zeros([axis.size for axis in axes], dtype=bool)
    asked[tuple(np.searchsorted(axis, column) for axis, column in zip(axes, conditions.T, strict=True))] = (
        True
    )
    result = _empty(dict(zip(DIMS, axes, strict=True)), temperature, error_level)
    places, gas = _collected(signals, result, asked.any(axis=DIMS.index("emittance")))
    found = np.broadcast_to(result.flow_status.values[..., None, None], asked.shape)
    result.study_status.values[asked] = found[asked]
    black = blackbody_signals(temperature, response)
    for begin in range(0, len(places), BATCH):
        batch = slice(begin, begin + BATCH)
        flows, angles = places[batch, : len(FLOW_DIMS)].T, places[batch, -1]
        some, wanted = gas[batch], asked[(*flows, slice(None), angles)]
        grid = (*flows, slice(None), angles)  # one row of all emittances for each sight line
        seen = visibility_factor(emittance[:, None, None] * black, some[:, None, :, None])
        reading, status = _readings(some, response, curve, emittance, temperature)
        limits = error_map(
            _as_conditions(some), response, curve,
            object_temperature=limit_temperature, emittance=emittance, error_level=error_level,
        )  # fmt: skip
        for name, values, unknown in (
            ("visibility_factor", seen, np.nan),
            ("relative_error", reading, np.nan),
            ("study_reading_status", status, NO_GAS),
            ("error_limit", limits.error_limit.values, np.nan),
            ("study_limit_status", limits.limit_status.values, NO_GAS),
        ):
            mask = wanted.reshape(wanted.shape + (1,) * (values.ndim - 2))
            result[name].values[grid] = np.where(mask, values, unknown)
    return result


def _empty(axes, temperature, error_level):
    """The result before anything is known: NaN, and the status 'not part of the study'."""
    sizes = {**{name: values.size for name, values in axes.items()}, "band": len(BANDS)}
    sizes["object_temperature"] = temperature.size
    line = (*FLOW_DIMS, DIMS[-1])

    def filled(dims, value, attributes=None):
        return dims, np.full([sizes[name] for name in dims], value), attributes or {}

    return xr.Dataset(
        {
            "flow_status": filled(FLOW_DIMS, np.int8(NOT_ASKED), flags(MEANINGS)),
            "study_status": filled(DIMS, np.int8(NOT_ASKED), flags(MEANINGS)),
            "gas_signal": filled((*line, "band"), np.nan),
            "peak_temperature": filled(line, np.nan),
            "visibility_factor": filled((*DIMS, "band", "object_temperature"), np.nan),
            "relative_error": filled((*DIMS, "object_temperature"), np.nan),
            "study_reading_status": filled((*DIMS, "object_temperature"), np.int8(NO_GAS)),
            "error_limit": filled(DIMS, np.nan),
            "study_limit_status": filled(DIMS, np.int8(NO_GAS)),
        },
        {**axes, "band": list(BANDS), "object_temperature": temperature},
        {"title": "Parameter study", "origin": "modelled", "error_level": float(error_level)},
    )


def _collected(signals, result, needed):
    """Put what belongs to a sight line into `result`.

    Return the places (S, 4) of those with gas, and its band signals (S, band).
    """
    line = (*FLOW_DIMS, DIMS[-1])
    left, places, gas = needed.copy(), [], []
    for one in signals:
        values = [float(one[name]) for name in line]
        place = tuple(_index(result[name].values, value) for name, value in zip(line, values, strict=True))
        if -1 in place or not left[place]:
            raise ValueError(f"a signal at {_words(values)} that no condition needs, or the second one there")
        left[place] = False
        status = int(one.flow_status)
        result.flow_status.values[place[:-1]] = status
        result.peak_temperature.values[place] = float(one.peak_temperature)
        result.gas_signal.values[place] = one.gas_signal.sel(band=list(BANDS)).values
        if status == COMPUTED:
            places.append(place)
            gas.append(result.gas_signal.values[place])
    if left.any():
        first = [result[name].values[i] for name, i in zip(line, np.argwhere(left)[0], strict=True)]
        raise ValueError(f"{left.sum()} sight lines have no signal, the first at {_words(first)}")
    return np.array(places, dtype=int).reshape(-1, len(line)), np.array(gas).reshape(-1, len(BANDS))


def _index(axis, value):
    """Place of `value` on an axis, but for round-off; -1 if it is not there."""
    nearest = int(np.abs(axis - value).argmin())
    return nearest if np.isclose(axis[nearest], value, rtol=ROUND_OFF, atol=0) else -1


def _words(values):
    power, pressure, rate, angle = values
    return f"{power / 1e3:g} kW, {pressure / 100:g} mbar, {rate * 1e3:g} g/s, {np.degrees(angle):g} deg"


def _as_conditions(gas_signal):
    """Dataset of contract 'gas_signal' of band signals (S, band); names and powers are only numbers."""
    count = len(gas_signal)
    return xr.Dataset(
        {
            "gas_signal": (("condition", "band"), gas_signal),
            "numerical_power": ("condition", np.arange(count, dtype=float)),
            "sample_emittance": ("condition", np.ones(count)),
        },
        {"condition": [str(number) for number in range(count)], "band": list(BANDS)},
    )


def _readings(gas_signal, response, curve, emittance, temperature):
    """Relative error and status (S, emittance, T) of the reading through the gas (S, band)."""
    gas = _as_conditions(np.repeat(gas_signal, emittance.size, axis=0))
    gas["sample_emittance"] = ("condition", np.tile(emittance, len(gas_signal)))
    read = apparent_temperature(gas, response, curve, object_temperature=temperature)
    shape = len(gas_signal), emittance.size, temperature.size
    return read.relative_error.values.reshape(shape), read.reading_status.values.reshape(shape)
