"""A lamp or a furnace: no gas, and a surface that is in view and warm from the first sample on."""

from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.effects.instrument import stray
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.diagnosis.fit.terms import AMPLITUDE, Term
from plasmapyro.diagnosis.gas.templates import GasLibrary
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record.inputs import instruments

RANGE = (200e-9, 4000e-9)  # [m] in which light is looked at
STEP = 0.5e-9  # [m]
UNIT = 0.1  # [1], of the hottest surface: the light that offsets are counted in, in the place of the gas
STRAY_LIGHT = 0.003  # [1] ASSUME: of the mean count rate, as in the estimate with an emissivity
BEYOND = 1.0  # [s] after the last sample, where the end of the plasma is put
BEHIND_PLASMA = ("refl", "torchglow", "scat")  # effects besides those of the gas that need one


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


def with_stray_light(given, test):
    """What is taken as given, with stray light of unknown share in the spectra.

    Of either sign: the spectrum of the calibration held some as well.
    """
    if "spectrometer" not in instruments(test) or any(term.setting.id == stray.id for term in given):
        return tuple(given)
    either = replace(stray, bounds=(-stray.bounds[1], stray.bounds[1]))
    return *given, Term(Setting(either, 0.0), {AMPLITUDE: STRAY_LIGHT})


def askable(effects):
    """The effects {id: Effect} that a test without a plasma may show."""
    return {
        identity: one
        for identity, one in effects.items()
        if one.stage != "gas" and not one.steady_gas and identity not in BEHIND_PLASMA
    }
