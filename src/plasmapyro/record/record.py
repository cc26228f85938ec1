"""A test as numbers to use: calibrated, flagged sample by sample, its time counted from the injection."""

from dataclasses import dataclass, field

import numpy as np

from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.instrument.spectrometer import USABLE
from plasmapyro.radiation.bandsignal import BANDS
from plasmapyro.record import flags, inputs
from plasmapyro.record.binning import LEAVE_OUT_OFF
from plasmapyro.record.calibrated import calibrated_radiance
from plasmapyro.record.emittance import UNTOLD_SLOPE
from plasmapyro.record.phases import phases, unlit

ACCOMPANYING = ("electric_power", "chamber_pressure", "mass_flow_rate")
ANY = 1000.0  # [K] in the place of a reading that is missing


@dataclass(frozen=True)
class Instrument:
    """What one instrument gave in its C channels, bands or pixels, at its own t times.

    `value` (t, C): signals of bands [A], or radiances of pixels [W m-2 sr-1 m-1], NaN where there is none;
    `flag` (t, C): bits of `flags.MEANINGS`, 0 for a sound sample. A pixel has a `wavelength`, a band a name.
    """

    name: str
    time: np.ndarray  # (t,) [s] middle of each sample, from the injection on
    integration_time: float  # [s]
    value: np.ndarray
    flag: np.ndarray
    window_transmittance: float = 1.0
    band: tuple = ()  # (C,) names
    wavelength: np.ndarray | None = None  # (C,) [m]
    channel_status: np.ndarray | None = None  # (C,) of pixels, see `instrument.spectrometer`
    factor: np.ndarray | None = None  # (C,) radiance per count rate; None where radiances were given
    factor_uncertainty: np.ndarray | None = None  # (C,) [1] relative, from counting noise

    @property
    def sound(self):
        """Values (t, C), NaN where a flag is set."""
        return np.where(self.flag == 0, self.value, np.nan)

    def flagged(self, *bits):
        """Where (t, C) one of some flags is set."""
        return (self.flag & np.bitwise_or.reduce(bits)) > 0


@dataclass(frozen=True)
class Record:
    """One test. Every time counts from the injection, in seconds; `clock` brings it back to that of the test.

    `instruments` holds any number of them, each on its own clock ticks and with any number of channels.
    """

    injection: float  # [s] on the clock of the test; without a plasma its first sample
    off: float  # [s] end of the plasma; -inf without one
    window: tuple  # (begin, end) [s] of the reference; empty without a plasma
    emittance: float  # [1]
    emittance_uncertainty: float
    emittance_slope: float  # [1] emittance in the wide band over that in the narrow one
    emittance_slope_uncertainty: float
    instruments: tuple
    # name -> (time (t,), values (t,)): power, pressure, flow
    accompanying: dict = field(default_factory=dict)
    attributes: dict = field(default_factory=dict)

    def clock(self, time):
        """Times [s] on the clock of the test."""
        return time + self.injection

    def instrument(self, name):
        """The instrument of a name, or None."""
        return next((one for one in self.instruments if one.name == name), None)

    def in_window(self, time):
        """Which of some times (t,) [s] lie in the reference window."""
        return (time >= self.window[0]) & (time <= self.window[1])

    def straddling(self, frames):
        """Which exposures of an instrument (S,) hold the injection or an end of the plasma."""
        ends = np.array([0.0, self.off] if self.window else [])
        return (np.abs(frames.time[:, None] - ends) < frames.integration_time / 2).any(axis=1)

    def phases(self, time):
        """Where the sample is in view, and where the plasma shines on it: (t,) bool each, see `phases`."""
        return phases(time, 0.0, self.off)


def record_of(test, calibrations, *, saturation_counts=np.inf, needed=()):
    """The record of a test from its data and its calibrations, with the instruments wanted that it holds.

    `calibrations`: instrument wanted -> calibration, or None. 'pyrometer': what stands there is not asked,
    its samples are signals; 'spectrometer' (contract 'spectrometer_calibration'): needed for counts, raw ones
    from `saturation_counts` on are saturated; 'radiometer': contract 'radiometer_calibration'. ValueError
    names every fault of the test, an instrument `needed` that is absent, or a calibration that does not fit.
    """
    inputs.require(test, *needed)
    attributes, plasma = test.attrs, inputs.has_plasma(test)
    axes = ("time", "spectrum_time", "radiometer_time")
    first = [float(test[axis].values[0]) for axis in axes if axis in test.variables]
    injection = float(attributes["injection_time"]) if plasma else min(first)
    present = [name for name in inputs.instruments(test) if name in calibrations]
    untold = UNTOLD_SLOPE if present == ["pyrometer"] else 0.0  # spectra see the colour of the surface
    return Record(
        injection,
        float(attributes["plasma_off_time"]) - injection if plasma else -np.inf,
        tuple(float(moment) - injection for moment in attributes["reference_window"]) if plasma else (),
        float(attributes["emittance"]),
        float(attributes["emittance_uncertainty"]),
        float(attributes.get("emittance_slope", 1.0)),
        float(attributes.get("emittance_slope_uncertainty", untold)),
        tuple(_instrument(name, test, injection, calibrations[name], saturation_counts) for name in present),
        {
            name: (test.time.values - injection, test[name].values)
            for name in ACCOMPANYING
            if name in test.variables and "time" in test.variables
        },
        dict(attributes),
    )


def _instrument(name, test, injection, calibration, saturation_counts):
    """One `Instrument`: what both kinds say of a test alike, and what each makes of its samples."""
    axis, made = {
        "pyrometer": ("time", _bands),
        "spectrometer": ("spectrum_time", _pixels),
        "radiometer": ("radiometer_time", _filters),
    }[name]
    value, flag, own = made(test, calibration, saturation_counts)
    flag[flags.stuck(value, inputs.has_plasma(test))] |= flags.STUCK
    exposure = float(test.attrs[f"{name}_integration_time"])
    if inputs.has_plasma(test):
        if name == "pyrometer":
            flag[flags.asked_again(value)] |= flags.STUCK
        window = np.subtract(test.attrs["reference_window"], injection)
        sound = np.where(flag, np.nan, value)
        flag[unlit(test[axis].values - injection, sound, window, exposure)] |= flags.UNLIT
        held = np.where(flag & (flags.LOST | flags.MASKED | flags.STUCK), np.nan, value)
        flag[flags.relit(test[axis].values, held, test.attrs["plasma_off_time"])] |= flags.RELIT
    if name != "spectrometer":
        flag[flags.spiked(value)] |= flags.SPIKED
    return Instrument(
        name,
        test[axis].values - injection,
        exposure,
        value,
        flag,
        float(test.attrs[f"window_transmittance_{name}"]),
        **own,
    )


def _bands(test, _, __):
    value = np.stack([test[f"signal_{band}"].values for band in BANDS]).astype(float).T
    limits = [test.attrs.get(f"signal_saturation_{band}", np.inf) for band in BANDS]
    flag = np.where(np.isnan(value), flags.LOST, 0).astype("uint8")
    flag[value >= np.array(limits)] |= flags.SATURATED
    flag[flags.clipped(value) | flags.rounded(value, gas_of(test, value))] |= flags.CLIPPED
    return value, flag, {"band": BANDS}


def gas_of(test, value):
    """Light of the gas in samples (t, 2) of the bands: the mean of the window while the plasma shines, NaN
    before the injection and while it dies, where it is another."""
    if not inputs.has_plasma(test):
        return np.zeros_like(value)
    facts, time = test.attrs, test.time.values
    inside = (time >= facts["reference_window"][0]) & (time <= facts["reference_window"][1])
    inside &= np.isfinite(value).all(axis=1)
    if not inside.any():
        return np.full(value.shape, np.nan)
    injected, shining = phases(time, facts["injection_time"], facts["plasma_off_time"])
    dead = time > facts["plasma_off_time"] + LEAVE_OUT_OFF
    gas = np.where(shining[:, None], value[inside].mean(axis=0), 0.0)
    return np.where((injected & (shining | dead))[:, None], gas, np.nan)


def _filters(test, calibration, _):
    names, known = list(test.band.values), list(calibration.band.values)
    if set(names) - set(known):
        held, there = (", ".join(map(str, row)) for row in (names, known))
        raise ValueError(f"the radiometer of the test has bands {held}; its calibration {there}")
    if len(names) == 1 and calibration.attrs["calibration"] == "relative":
        raise ValueError(
            f"band '{names[0]}' alone tells a temperature by its level, which a relative calibration leaves"
            " open: calibrate it absolutely, or record a second band"
        )
    if "radiometer_signal" in test.variables:
        value = test.radiometer_signal.values.astype(float)
    else:  # what a black body of the reading gives, times the setting
        shown, bands = test.radiometer_reading.values, calibration.sel(band=names)
        given = np.isfinite(shown) & (shown > 0)  # a display shows dashes out of its range
        black = [blackbody_signal(*one) for one in _each_band(np.where(given, shown, ANY), bands)]
        value = test.radiometer_setting.values * np.stack(black, axis=1) * bands.band_sensitivity.values
        value[~given] = np.nan
        if len(names) == 2:  # a ratio: its level means nothing, and must not jump where the slope is set anew
            value = value * np.nanmedian(value[:, 1]) / value[:, 1:]
    flag = np.where(np.isnan(value), flags.LOST, 0).astype("uint8")
    if "radiometer_signal" in test.variables:
        flag[flags.clipped(value)] |= flags.CLIPPED
    return value, flag, {"band": tuple(names)}


def _each_band(shown, bands):
    """Arguments of `blackbody_signal` for readings (t, C) in each of C bands."""
    curves = bands.responsivity.values
    return [(column, bands.wavelength.values, curve) for column, curve in zip(shown.T, curves, strict=True)]


def _pixels(test, calibration, saturation_counts):
    radiance, status, saturated = calibrated_radiance(test, calibration, saturation_counts)
    unusable = np.broadcast_to(status != USABLE, radiance.shape)
    flag = np.where(np.isnan(radiance) & ~saturated & ~unusable, flags.LOST, 0).astype("uint8")
    flag[saturated] |= flags.SATURATED
    flag[unusable] |= flags.MASKED
    slit = float(test.attrs["spectrometer_fwhm"])
    flag[flags.sharper(np.where(flag, np.nan, radiance), test.wavelength.values, slit)] |= flags.SPIKED
    own = {"wavelength": test.wavelength.values, "channel_status": status}
    if "spectral_radiance" not in test.variables:
        exposure = float(test.attrs["spectrometer_integration_time"])
        own["factor"] = calibration["calibration_factor"].values / exposure
    if calibration is not None:
        own["factor_uncertainty"] = np.nan_to_num(calibration["calibration_factor_uncertainty"].values)
    return radiance, flag, own
