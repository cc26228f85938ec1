"""A lamp or a furnace: no gas, and a surface that is in view and warm from the first sample on."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.ndimage import gaussian_filter1d

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.diagnosis.effects.instrument import dark_counts, stray, wider_slit
from plasmapyro.diagnosis.fit.persistent import STRAY_LIGHT
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.diagnosis.fit.terms import AMPLITUDE, Term
from plasmapyro.diagnosis.gas.templates import GasLibrary
from plasmapyro.instrument.spectrometer import local_noise
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record import binning

RANGE = (200e-9, 4000e-9)  # [m] in which light is looked at
STEP = 0.5e-9  # [m]
UNIT = 0.1  # [1], of the hottest surface: the light that offsets are counted in, in the place of the gas
WIDTH = 0.3  # [1] ASSUME: of the width of the slit, how well it is known
LEAST_SLOPE = 5  # pixels over which the slope of the response is taken at least
BASELINE = 0.3  # ASSUME: of a pixel's noise, baseline of a frame: clamps of real converters jump by so much
FAR = 1000.0  # of a pixel's noise: no baseline is so far off
WIDEST = 100.0  # [nm] standard deviation of a slit
MOST_KNOTS = 12
BEYOND = 1.0  # [s] after the last sample, where the end of the plasma is put
LAMP = "lamp_in_view"
NOT_ASKED = ("refl", "torchglow", "scat", stray.id)  # effects that need a plasma, or are in the model anyway


class OtherLight(NamedTuple):
    """Light of a lamp beside that of the surface: its kind in words, and its radiance (N, K) at wavelengths
    (N,) [m] per coefficient, each of these normal with variance 1 before the data."""

    kind: str
    wavelength: np.ndarray
    columns: np.ndarray


def timed(record):
    """The record with its zero before the first exposure, and an end that no sample reaches."""
    longest = max(one.integration_time for one in record.instruments)
    start = min(one.time[0] for one in record.instruments) - longest
    moved = [replace(one, time=one.time - start) for one in record.instruments]
    end = max(one.time[-1] + one.integration_time for one in moved) + BEYOND
    more = {name: (time - start, values) for name, (time, values) in record.accompanying.items()}
    times = {"injection": record.injection + start, "off": float(end), "window": (0.0, 0.0)}
    return replace(record, instruments=tuple(moved), accompanying=more, **times)


def dark_library(fwhm, kelvin):
    """Templates in the place of those of a gas: light of a surface of some temperature [K], which stands for
    the unit of offsets and shines in no test."""
    axis = np.arange(*RANGE, STEP)
    light = UNIT * blackbody_radiance(axis, kelvin)
    none = np.zeros((0, axis.size))
    return GasLibrary(
        condition="none",
        power=np.nan,
        wavelength=axis,
        slit_fwhm=fwhm,
        log_power=np.zeros(1),
        radiance=light[None],
        group_name=("none",),
        group=light[None],
        variation={},
        addition={},
        weakest=light,
        systems=(),
        causes=(),
        strength_modes=none,
        shape_systems=(),
        shape_causes=(),
        shape_modes=none,
    )


def of_instrument(given, record, calibration, room=None):
    """What is taken as given, and besides it what every spectrometer does: stray light, a slit, a baseline.

    Parameters
    ----------
    given : sequence of Term
    record : Record
    room : OtherLight that was found in the spectra, or None
    calibration : Dataset, contract 'spectrometer_calibration', or None if the spectra are radiances
        Stray light is of either sign then, and nothing is known of slit and baseline.
    """
    frames = record.instrument("spectrometer")
    if frames is not None and room is not None:
        given = *given, _lamp(room)
    if frames is None or any(term.setting.id == stray.id for term in given):
        return tuple(given)
    if calibration is None or frames.factor is None:
        either = replace(stray, bounds=(-stray.bounds[1], stray.bounds[1]))
        return *given, Term(Setting(either, 0.0), {AMPLITUDE: STRAY_LIGHT})
    axis, kelvin = frames.wavelength, float(calibration["source_temperature"])
    rate = blackbody_radiance(axis, kelvin) / frames.factor
    seen = np.isfinite(rate) & (rate > 0)
    axis, rate = axis[seen], rate[seen]
    width = float(record.attributes["spectrometer_fwhm"]) / np.sqrt(8 * np.log(2))
    own = _stray_of_both(axis, rate), 0.0, STRAY_LIGHT
    slit = _slit(axis, rate, kelvin, width), width * 1e9, WIDTH * width * 1e9
    both = (Term(Setting(one, value), {AMPLITUDE: error}) for one, value, error in (own, slit))
    return *given, *both, _baseline(frames)


def _stray_of_both(axis, rate):
    """Stray light of the mean count rate, where the calibration, of count rates (P,), held its share too."""

    def formula(output, amplitude):
        share = rate.mean() / np.interp(output.wavelength, axis, rate)
        counts = np.average(output.value / output.factor, axis=1, weights=output.pixels)[:, None]
        return (1 - amplitude * share) * output.value + amplitude * counts * output.factor

    return replace(stray, output=formula)


def _slit(axis, rate, kelvin, width):
    r"""A slit of variance :math:`\sigma^2`, before which the calibration stood too, of count rates r (P,).

    With its source at :math:`T_c` and :math:`x = (c_2/\lambda^2)(1/T - 1/T_c)` a surface seems brighter by

    .. math:: \sigma^2 x\,\Big[\frac{d \ln r}{d\lambda} + \frac{x}{2} - \frac{1}{\lambda}\Big],

    the second order of the means of r L over the slit.
    """
    pixel = np.median(np.diff(axis))
    slope = gaussian_filter1d(np.log(rate), max(width / pixel, LEAST_SLOPE), mode="nearest", order=1) / pixel

    def formula(scene, amplitude):
        where = scene.wavelength
        x = SECOND_RADIATION / where**2 * (1 / scene.temperature[..., None] - 1 / kelvin)
        change = (amplitude * 1e-9) ** 2 * x * (np.interp(where, axis, slope) + x / 2 - 1 / where)
        return scene.but(glow=scene.glow * (1 + change))

    return replace(wider_slit, light=formula, amplitude="standard deviation", bounds=(0.0, WIDEST))


def _lamp(room):
    """Light of a lamp that shines alike at all times."""
    names = [f"coefficient {place}" for place in range(room.columns.shape[1])]

    def formula(output, amplitude, **numbers):
        light = room.columns @ [numbers[name] for name in names]
        return output.value + np.interp(output.wavelength, room.wavelength, light)

    one = {"id": LAMP, "name": f"light like that of {room.kind}", "unit": "1"}
    shown = replace(dark_counts, output=formula, shape_bounds=dict.fromkeys(names, (-FAR, FAR)), **one)
    return Term(Setting(shown, 0.0, dict.fromkeys(names, 0.0)), dict.fromkeys(names, 1.0))


def _baseline(frames):
    """Counts that all pixels of a frame share, each of at most `MOST_KNOTS` times of a series apart."""
    noise = np.nanmedian(local_noise(frames.sound / frames.factor, frames.wavelength.size))
    count = min(frames.time.size, MOST_KNOTS * (1 + binning.series(frames.time)[-1]))
    times = frames.time[np.linspace(0, frames.time.size - 1, count).round().astype(int)]
    names = [f"at {time:.6g} s" for time in times]

    def formula(output, amplitude, **counts):
        there = np.interp(output.time, times, [counts[name] for name in names])
        return output.value + there[:, None] * output.factor

    one = {"id": "baseline", "name": "baseline of the spectrometer", "unit": "count"}
    shown = replace(
        dark_counts, output=formula, shape_bounds=dict.fromkeys(names, (-FAR * noise, FAR * noise)), **one
    )
    return Term(Setting(shown, 0.0, dict.fromkeys(names, 0.0)), dict.fromkeys(names, BASELINE * noise))


def askable(effects):
    """The effects {id: Effect} that a test without a plasma may show."""
    return {
        identity: one
        for identity, one in effects.items()
        if one.stage != "gas" and not one.steady_gas and identity not in NOT_ASKED
    }
