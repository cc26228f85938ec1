"""The files of a campaign: calibration of both instruments, and one test with its sealed truth.

Every function returns datasets; `write` stores them. A hidden effect is another `Scene`
(`dataclasses.replace`): it can change the light, the instruments, the sample or the plasma without
touching the rest.
"""

import hashlib
import json
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr

from twin import light, sensors
from twin.plasma import Plasma, brightness
from twin.sample import Sample, history
from twin.sensors import Pyrometer, Spectrometer

TICK = 0.05  # [s] step of the hidden history; the pyrometer samples every second one
DARK_SCANS = 20


def _nothing(instrument, wavelength, time, temperature):
    """No light besides that of surface and gas [W m-2 sr-1 m-1]."""
    return 0.0


def _unchanged(instrument, wavelength, time):
    """Windows and air transmit as they did during the calibration."""
    return 1.0


def _black_body(instrument, wavelength, temperature, time):
    """Radiance of a surface of one temperature, were it black."""
    return light.planck(wavelength, temperature)


def _as_calibrated(band, wavelength, responsivity):
    """Responsivity (N,) of a band: what the calibration saw."""
    return responsivity


def _faithful(clean, time):
    """What an instrument makes of its clean output: signals (2, t) [A] or count rates (S, W)."""
    return clean


def _whole(test, random):
    """The recorded test, with nothing lost on the way."""
    return test


@dataclass(frozen=True)
class Plume:
    """A part of the gas radiance with a history of its own.

    `share` gets (instrument, wavelength (B,), time (t, 1), surface temperature (t, 1), brightness (t, 1),
    emittance) and returns what broadcasts to (t, B).
    """

    wavelength: np.ndarray  # (N,) [m]
    radiance: np.ndarray  # (N,) [W m-2 sr-1 m-1], may be negative
    share: Callable


@dataclass(frozen=True)
class Scene:
    """Everything that is true about a test. Times [s], 0 at injection.

    The functions are the places for hidden effects. Those on the light get the instrument
    ('pyrometer' or 'spectrometer') where it matters, wavelengths (B,) [m], and times and surface
    temperatures of shape (t, 1), and return what broadcasts to (t, B).
    """

    condition: str  # simulation to compare with, as the laboratory believes
    start: float = -20.0
    end: float = 400.0
    plasma_off_time: float = 300.0
    reference_window: tuple = (0.0, 6.0)
    pyrometer_period: float = 0.1
    spectrometer_period: float = 2.0
    pyrometer_integration_time: float = 0.01
    spectrometer_integration_time: float = 1.0
    stated_emittance: float = 0.85
    stated_emittance_uncertainty: float = 0.05
    electric_power: float = 160e3  # [W]
    chamber_pressure: float = 5000.0  # [Pa]
    mass_flow_rate: float = 16e-3  # [kg s-1]
    sample: Sample = field(default_factory=Sample)
    plasma: Plasma = field(default_factory=Plasma)
    pyrometer: Pyrometer = field(default_factory=Pyrometer)
    spectrometer: Spectrometer = field(default_factory=Spectrometer)
    emittance: Callable | None = None  # (wavelength, temperature, time); None: grey, that of the sample
    transmittance: Callable = _unchanged  # (instrument, wavelength, time), relative to the calibration
    extra_radiance: Callable = _nothing  # (instrument, wavelength, time, temperature)
    glow: Callable = _black_body  # (instrument, wavelength, temperature, time)
    plumes: tuple = ()  # of `Plume`, besides the gas of the simulation
    response: Callable = _as_calibrated  # (band, wavelength, responsivity)
    pyrometer_output: Callable = _faithful  # (signals (2, t) [A], time (t,))
    spectrometer_output: Callable = _faithful  # (count rates (S, W) [s-1], time (S,))
    # Exposures are sampled at the starts of their ticks, 25 ms early on average, or in the middle of them.
    centred_exposures: bool = False
    pyrometer_delay: float = 0.0  # [s] what the pyrometer calls t happened at t + delay
    pixel_shift: float = 0.0  # [m] light of wavelength + shift falls on each pixel
    true_fwhm: float | None = None  # [m] of the slit function; None: as stated
    draw: Callable | None = (
        None  # (random, shape, axis of time): noise of unit size; None: as the sensors make it
    )
    recorded: Callable = _whole  # (test, random): what becomes of the files
    hidden: tuple = ()  # of dicts: what was hidden, for the truth file

    def surface_emittance(self, wavelength, temperature, time):
        """Emittance of the surface where it is looked at."""
        if self.emittance is None:
            return self.sample.emittance
        return self.emittance(wavelength, temperature, time)


@dataclass(frozen=True)
class Source:
    """The blackbody source and how it is used."""

    lowest: float = 973.0  # [K]
    highest: float = 1773.0
    step: float = 50.0
    bias: float = 3.0  # [K] half width: the reference sensor, the same for all points
    hold: float = 0.5  # [K] half width: the controller, from point to point
    reading: float = 0.01  # half width: relative error of one reading of one signal
    readings: int = 25  # per point, averaged
    spectrometer_temperature: float = 1773.0
    spectrometer_integration_time: float = 0.4
    scans: int = 20


def _streams(seed, name):
    """A random generator of its own for each part, so that one part does not move another."""
    parts = ("source", "points", "pixels", "lamp", "plasma", "signals", "counts", "tunnel", "files")
    return np.random.default_rng([seed, parts.index(name)])


def calibration_points(response, seed, source=None):
    """Signals of both bands before the source: what `plasmapyro` calls 'calibration_points'."""
    source = source or Source()
    set_point = np.arange(source.lowest, source.highest + source.step / 2, source.step)
    random = _streams(seed, "points")
    hold = random.uniform(-source.hold, source.hold, set_point.size)
    actual = set_point + _source_bias(source, seed) + hold
    clean = Pyrometer().gains[:, None] * band_signals(response, actual)
    error = random.uniform(-source.reading, source.reading, (2, set_point.size, source.readings))
    wide, narrow = clean * (1 + error.mean(axis=-1))
    return xr.Dataset(
        {
            "source_temperature": ("calibration_point", set_point, {"units": "K"}),
            "signal_wide": ("calibration_point", wide, {"units": "A"}),
            "signal_narrow": ("calibration_point", narrow, {"units": "A"}),
        },
        attrs={"origin": "synthetic", "title": "Synthetic calibration of a two-colour pyrometer"},
    )


def _source_bias(source, seed):
    return _streams(seed, "source").uniform(-source.bias, source.bias)


def band_signals(response, temperature):
    """Black body signals of both bands (2, T) [W m-2 sr-1] at the temperatures (T,) [K]."""
    rows = []
    for name in ("responsivity_wide", "responsivity_narrow"):
        _, centres, weight = light.band(response.wavelength.values, response[name].values)
        rows.append(light.planck(centres, np.asarray(temperature)[:, None]) @ weight)
    return np.stack(rows)


def spectrometer_counts(seed, source=None, spectrometer=None):
    """Counts before the source and in the dark: what `plasmapyro` calls 'spectrometer_counts'."""
    source, spectrometer = source or Source(), spectrometer or Spectrometer()
    pixels = spectrometer.wavelength
    actual = source.spectrometer_temperature + _source_bias(source, seed)
    rate = spectrometer.rate_per_radiance(light.planck) * light.planck(pixels, actual)
    pattern = sensors.offset_pattern(spectrometer, _streams(seed, "pixels"))
    random = _streams(seed, "lamp")
    bright, dark = (
        sensors.counts(
            spectrometer,
            np.broadcast_to(value, (source.scans, pixels.size)),
            source.spectrometer_integration_time,
            pattern,
            random,
        ).mean(axis=0)
        for value in (rate, 0.0)
    )
    return xr.Dataset(
        {
            "calibration_counts": ("wavelength", bright, {"units": "count"}),
            "calibration_background": ("wavelength", dark, {"units": "count"}),
        },
        {"wavelength": ("wavelength", pixels, {"units": "m"})},
        {
            "origin": "synthetic",
            "title": "Synthetic calibration of a spectrometer",
            "source_temperature": source.spectrometer_temperature,
            "integration_time": source.spectrometer_integration_time,
            "scans_averaged": source.scans,
        },
    )


def record(scene, response, gas, seed):
    """The test as a laboratory would hand it over, and what is really true: two Datasets.

    `response`: wavelength [m], responsivity_wide, responsivity_narrow; `gas`: pairs of a weight and a
    Dataset; the true gas is the weighted sum of their `gas_radiance`.
    """
    tick, temperature, scale = _histories(scene, seed)
    time, moment = readings(scene)
    clean = _clean_signals(scene, response, gas, tick, temperature, scale)
    wide, narrow = sensors.pyrometer_reading(
        scene.pyrometer, clean, _streams(seed, "signals"), draw=scene.draw
    )

    middle, frames = exposures(scene, tick)
    pixels = scene.spectrometer.wavelength
    rate = _clean_rates(scene, gas, tick, temperature, scale)
    pattern = sensors.offset_pattern(scene.spectrometer, _streams(seed, "pixels"))
    random, exposure = _streams(seed, "counts"), scene.spectrometer_integration_time
    raw = sensors.counts(scene.spectrometer, rate, exposure, pattern, random, draw=scene.draw)
    no_light = np.zeros((DARK_SCANS, pixels.size))
    dark = sensors.counts(scene.spectrometer, no_light, exposure, pattern, random).mean(axis=0)

    running = time <= scene.plasma_off_time
    tunnel = _streams(seed, "tunnel").standard_normal((3, time.size))
    coordinates = {
        "time": ("time", time, {"units": "s"}),
        "spectrum_time": ("spectrum_time", middle, {"units": "s"}),
        "wavelength": ("wavelength", pixels, {"units": "m"}),
    }
    test = xr.Dataset(
        {
            "signal_wide": ("time", wide, {"units": "A"}),
            "signal_narrow": ("time", narrow, {"units": "A"}),
            "counts": (("spectrum_time", "wavelength"), raw, {"units": "count"}),
            "background_counts": ("wavelength", dark, {"units": "count"}),
            "electric_power": (
                "time",
                scene.electric_power * np.where(running, 1 + 0.004 * tunnel[0], 0.0),
                {"units": "W"},
            ),
            "chamber_pressure": ("time", scene.chamber_pressure * (1 + 0.002 * tunnel[1]), {"units": "Pa"}),
            "mass_flow_rate": ("time", scene.mass_flow_rate * (1 + 0.002 * tunnel[2]), {"units": "kg s-1"}),
        },
        coordinates,
        {
            "title": "Synthetic twin of a plasma-wind-tunnel test of a C/SiC sample",
            "origin": "synthetic",
            "condition": scene.condition,
            "injection_time": 0.0,
            "plasma_off_time": scene.plasma_off_time,
            "reference_window": np.array(scene.reference_window),
            "emittance": scene.stated_emittance,
            "emittance_uncertainty": scene.stated_emittance_uncertainty,
            "window_transmittance_pyrometer": 0.87,
            "window_transmittance_spectrometer": 0.95,
            "pyrometer_integration_time": scene.pyrometer_integration_time,
            "spectrometer_integration_time": scene.spectrometer_integration_time,
            "spectrometer_fwhm": scene.spectrometer.fwhm,
        },
    )
    truth = xr.Dataset(
        {
            "surface_temperature": ("time", temperature[moment], {"units": "K"}),
            "gas_scale": ("time", scale[moment], {"units": "1"}),
            "exposure_temperature": ("spectrum_time", temperature[frames].mean(axis=1), {"units": "K"}),
            "exposure_gas_scale": ("spectrum_time", scale[frames].mean(axis=1), {"units": "1"}),
            "emittance": scene.sample.emittance,
            "sensitivity_ratio": scene.pyrometer.sensitivity_ratio,
        },
        {name: coordinates[name] for name in ("time", "spectrum_time")},
        {"origin": "synthetic", "title": "Truth of a synthetic test, not for the processing", "seed": seed},
    )
    if scene.hidden:
        # A drift that is hidden comes on top of the one that every test has.
        told = [
            one | {"amplitude": one["amplitude"] + (one["effect"] == "gas_drift") * scene.plasma.drift}
            for one in scene.hidden
        ]
        truth.attrs["hidden"] = json.dumps(told, sort_keys=True)
    return scene.recorded(test, _streams(seed, "files")), truth


def clean_output(scene, response, gas, seed, warmer=0.0):
    """What the instruments would give without their noise: signals (2, t) [A] and count rates (S, W) [s-1].

    `warmer` [K] is added to the surface temperature after injection, `record`'s other arguments as there.
    """
    tick, temperature, scale = _histories(scene, seed)
    temperature = np.where(tick >= 0, temperature + warmer, temperature)
    signals = _clean_signals(scene, response, gas, tick, temperature, scale)
    return signals, _clean_rates(scene, gas, tick, temperature, scale)


def _histories(scene, seed):
    """Instants (n,) [s], surface temperature [K] and brightness of the gas at them."""
    tick = np.arange(scene.start, scene.end + TICK / 2, TICK)
    temperature = history(scene.sample, tick, scene.plasma_off_time)
    return tick, temperature, brightness(scene.plasma, tick, scene.plasma_off_time, _streams(seed, "plasma"))


def readings(scene):
    """Times (t,) [s] of the pyrometer's readings and their places among the instants."""
    time = np.round(np.arange(scene.start, scene.end + 1e-9, scene.pyrometer_period), 9)
    return time, np.rint((time - scene.start) / TICK).astype(int)


def _clean_signals(scene, response, gas, tick, temperature, scale):
    time, moment = readings(scene)
    if scene.pyrometer_delay:
        then = time + scene.pyrometer_delay
        state = (np.interp(then, tick, temperature), np.interp(then, tick, scale))
        return scene.pyrometer_output(_signals(scene, response, gas, then, *state), time)
    clean = _signals(scene, response, gas, time, temperature[moment], scale[moment])
    return scene.pyrometer_output(clean, time)


def _clean_rates(scene, gas, tick, temperature, scale):
    middle, frames = exposures(scene, tick)
    states = [tick[frames], temperature[frames], scale[frames]]
    if scene.centred_exposures:
        states = [
            (one + whole[frames + 1]) / 2
            for one, whole in zip(states, (tick, temperature, scale), strict=True)
        ]
    radiance = _spectra(scene, gas, *states)
    return scene.spectrometer_output(scene.spectrometer.rate_per_radiance(light.planck) * radiance, middle)


def _light(scene, instrument, wavelength, plumes, time, temperature, scale):
    """Radiance (t, B) at the times (t,); `plumes` (1 + hidden ones, B): the gas at scale 1 and the rest."""
    time, temperature, scale = time[:, None], temperature[:, None], scale[:, None]
    emittance = scene.surface_emittance(wavelength, temperature, time)
    surface = emittance * scene.glow(instrument, wavelength, temperature, time)
    extra = scene.extra_radiance(instrument, wavelength, time, temperature)
    window = scene.transmittance(instrument, wavelength, time)
    total = np.where(time >= 0, surface, 0.0) + scale * plumes[0] + extra
    for hidden, spectrum in zip(scene.plumes, plumes[1:], strict=True):
        total = total + hidden.share(instrument, wavelength, time, temperature, scale, emittance) * spectrum
    return window * total


def _signals(scene, response, gas, time, temperature, scale):
    """Clean signals (2, t) [A] at the given instants (the 10 ms of a reading change nothing)."""
    rows = []
    nodes = response.wavelength.values
    for gain, band in zip(scene.pyrometer.gains, ("wide", "narrow"), strict=True):
        responsivity = scene.response(band, nodes, response[f"responsivity_{band}"].values)
        edges, centres, weight = light.band(nodes, responsivity)
        plumes = [_gas_bins(gas, edges), *_hidden_bins(scene, edges)]
        rows.append(gain * (_light(scene, "pyrometer", centres, plumes, time, temperature, scale) @ weight))
    return np.stack(rows)


def _spectra(scene, gas, time, temperature, scale):
    """Clean radiance (S, W) as the pixels see it; the inputs are (S, n), n instants of each exposure."""
    device = scene.spectrometer
    edges, _ = light.bins(device.first - 4e-9, device.last + 4e-9, 0.02e-9)
    places, fwhm = device.wavelength + scene.pixel_shift, scene.true_fwhm or device.fwhm
    plumes = [
        light.through_slit(edges, bins, places, fwhm)
        for bins in (_gas_bins(gas, edges), *_hidden_bins(scene, edges))
    ]
    instants = zip(time, temperature, scale, strict=True)
    return np.stack([_light(scene, "spectrometer", places, plumes, *one).mean(axis=0) for one in instants])


def _hidden_bins(scene, edges):
    """Bin means of the hidden plumes, one array (B,) each."""
    return [light.bin_mean(plume.wavelength, plume.radiance, edges) for plume in scene.plumes]


def _gas_bins(gas, edges):
    """Bin means of the weighted sum of the gas spectra."""
    return sum(
        weight * light.bin_mean(plume.wavelength.values, plume.gas_radiance.values, edges)
        for weight, plume in gas
    )


def exposures(scene, tick):
    """Middle of each exposure (S,) [s] and the indices (S, n) of the instants within it."""
    half = scene.spectrometer_integration_time / 2
    first = np.ceil((scene.start + half) / scene.spectrometer_period) * scene.spectrometer_period
    middle = np.arange(first, scene.end - half + 1e-9, scene.spectrometer_period)
    begin = np.rint((middle - half - scene.start) / TICK).astype(int)
    count = round(2 * half / TICK)
    return middle, begin[:, None] + np.arange(count)


def write(dataset, path, *, sources=(), configuration=None, versions=""):
    """Store a dataset as netCDF, whole or not at all, the same bytes for the same content.

    The SHA-256 of the source files, the configuration and the versions go into its attributes; a checksum of
    the format guards each variable.
    """
    path = Path(path)
    digests = [(hashlib.sha256(Path(source).read_bytes()).hexdigest(), source) for source in sources]
    dataset = dataset.assign_attrs(
        sources="\n".join(f"{digest}  {source}" for digest, source in digests),
        configuration=json.dumps(configuration or {}, sort_keys=True),
        versions=versions,
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    try:
        guarded = {name: {"fletcher32": True} for name in dataset.variables}
        dataset.to_netcdf(part, engine="netcdf4", encoding=guarded)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
