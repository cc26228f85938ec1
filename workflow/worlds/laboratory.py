"""Instruments of a laboratory, their calibration with its errors, and what they record of a scene."""

from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from worlds.engine import CENTRES, EDGES
from worlds.gas import BOLTZMANN, LIGHT, PLANCK

SMOOTH = np.arange(650.0, 1231.0, 1.0) * 1e-9  # wavelengths of smooth light [m]
FULL = 65535.0
ROOM = 0.1  # [s] before the first frame and behind the last, which may be early or late
LAMPS, DARKS = 20, 50  # scans of a calibration, and of the dark of a test
TOGETHER, APART, DRIFT, POINTING = 60.0, 90.0, 80.0, 0.7  # [s]: memory of gains, ratio, spectrometer, aim
POINTS_K = np.arange(973.0, 1774.0, 50.0)  # set points of the black body


def planck(wavelength, temperature):
    """Black body [W m-2 sr-1 m-1]."""
    x = PLANCK * LIGHT / (wavelength * BOLTZMANN * temperature)
    return 2 * PLANCK * LIGHT**2 / wavelength**5 / np.expm1(x)


@dataclass(frozen=True)
class Laboratory:
    """All about instruments and calibration that a case does not change; true values, not stated ones."""

    seed: int
    pyrometer_rate: float  # [Hz]
    integration: float  # of the pyrometer [s]
    exposure: float  # of the spectrometer [s]
    period: float
    pixels: int
    first: float  # [m]
    last: float
    fwhm: float
    has_pyrometer: bool
    has_spectrometer: bool
    edges: tuple  # true minus stated edge of the bands [m]
    tail: float  # relative error of the response at its red end
    ratio: float  # sensitivity of the wide over the narrow band
    source_bias: float  # true minus stated temperature of the black body at 1773 K [K]
    spectral_error: float  # standard deviation of the correlated error of the spectral calibration
    spectral_scale: float  # its correlation length [m]
    wander: tuple  # of the gains of spectrometer, bands together, bands apart
    pointing: float
    bits: int  # of the pyrometer's converter, its ranges taken together
    noise: float  # relative noise of a reading
    jitter: float  # of the clocks [s]
    windows: tuple  # stated transmittances: pyrometer, spectrometer
    window_error: tuple  # relative
    read_noise: float  # [counts]
    electrons: float  # per count
    lamp: float  # stated temperature of the spectrometer's source [K]
    gain_flicker: float  # 1/f noise of the gain of each band by itself
    frame_jitter: float  # of the times of frames, that a computer takes [s]
    clock_error: float  # of the clock of the pyrometer against that of the spectrometer, in a test [s]

    @property
    def wavelength(self):
        """Pixels (W,) [m]."""
        return np.linspace(self.first, self.last, self.pixels)


def draw(seed):
    """A laboratory from a seed."""
    random = np.random.default_rng([seed, 21])

    def log(low, high):
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    rate, exposure, pixels = log(1, 1000), log(0.2, 30), int(log(500, 4000))
    first, last = random.uniform(700e-9, 772e-9), random.uniform(930e-9, 1050e-9)
    pitch, kind = (last - first) / (pixels - 1), random.random()
    return Laboratory(
        seed=int(seed),
        pyrometer_rate=rate,
        integration=min(0.01, 0.8 / rate),
        exposure=exposure,
        period=exposure * random.uniform(1.01, 1.3),
        pixels=pixels,
        first=first,
        last=last,
        fwhm=max(log(0.3e-9, 3e-9), 1.5 * pitch),
        has_pyrometer=bool(kind > 0.12),
        has_spectrometer=bool(not 0.12 < kind < 0.22),
        edges=tuple(np.clip(random.normal(0, 0.7e-9, 2), -1.5e-9, 1.5e-9)),
        tail=float(np.clip(random.normal(0, 0.015), -0.03, 0.03)),
        ratio=random.uniform(0.25, 0.40),
        source_bias=float(np.clip(random.normal(0, 1.5), -3, 3)),
        spectral_error=log(2e-3, 8e-3),
        spectral_scale=random.uniform(60e-9, 250e-9),
        wander=(log(2e-4, 2e-3), log(1e-4, 1e-3), log(5e-5, 5e-4)),
        pointing=log(3e-4, 3e-3),
        bits=int(random.choice([16, 18, 20])),
        noise=log(3e-4, 3e-3),
        jitter=log(1e-4, 5e-3),
        windows=(round(random.uniform(0.85, 0.95), 2), round(random.uniform(0.88, 0.95), 2)),
        window_error=tuple(random.normal(0, 0.005, 2)),
        read_noise=log(3, 25),
        electrons=log(2, 20),
        lamp=float(random.choice([1573.0, 1673.0, 1773.0])),
        gain_flicker=log(5e-5, 5e-4),
        frame_jitter=log(1e-4, 2e-2),
        clock_error=log(1e-3, 3e-2),
    )


def true_bands(lab, response):
    """Responses (2, SMOOTH) of the bands as they are: edges shifted, the red end raised or lowered."""
    wave = response.wavelength.values
    red = np.clip((SMOOTH - 1.0e-6) / 0.1e-6, 0, 1)
    rows = [
        np.interp(SMOOTH - shift * (SMOOTH < 1.0e-6), wave, response[name].values, 0, 0)
        * (1 + lab.tail * red)
        for name, shift in zip(("responsivity_wide", "responsivity_narrow"), lab.edges, strict=True)
    ]
    return np.array(rows)


def sensitivity(lab):
    """Count rate per radiance over the pixels, peak 1: a blazed grating before silicon."""
    x = lab.wavelength * 1e6
    return np.exp(-(((x - 0.80) / 0.16) ** 2)) * np.clip((1.12 - x) / 0.2, 0, 1) ** 0.7 + 0.01


def spectral_error(lab):
    """Relative error of the radiance scale over the pixels: certificate, fit and overlap of orders, all
    smooth."""
    random = np.random.default_rng([lab.seed, 22])
    knots = np.arange(600e-9, 1200e-9, 10e-9)
    kernel = np.exp(-0.5 * (np.subtract.outer(knots, knots) / lab.spectral_scale) ** 2)
    curve = np.linalg.cholesky(kernel + 1e-8 * np.eye(knots.size)) @ random.normal(size=knots.size)
    overlap = random.normal(0, 0.5) / (1 + np.exp(-(knots - random.uniform(880e-9, 960e-9)) / 15e-9))
    return lab.spectral_error * np.interp(lab.wavelength, knots, curve + overlap)


def detector_pattern(lab):
    """Dark rate [counts/s], hot pixels among them, and the bias [counts], over the pixels."""
    random = np.random.default_rng([lab.seed, 23])
    dark = random.gamma(8, 1.0, lab.pixels) / 8 * random.uniform(2, 30)
    dark[random.random(lab.pixels) < 0.002] *= 8
    return dark, random.uniform(800, 3000) + random.normal(0, 3, lab.pixels)


def expose(lab, rate, exposure, random, scans=1):
    """Counts of exposures (..., W) of a count rate, with noise of photons and reading, in whole counts."""
    dark, bias = detector_pattern(lab)
    level = (rate + dark) * exposure
    noise = _noise(lab, level, scans)
    counts = bias + level + noise * random.normal(size=np.shape(level))
    return np.clip(np.rint(counts) if scans == 1 else counts, 0, FULL)


def _noise(lab, level, scans):
    """Standard deviation of photons and reading, of levels in counts, in the mean of so many scans."""
    return np.sqrt((np.maximum(level, 0) / lab.electrons + lab.read_noise**2 + 1 / 12) / scans)


def dark_noise(lab):
    """Standard deviation [counts] of the dark of each pixel in a test."""
    return _noise(lab, detector_pattern(lab)[0] * lab.exposure, DARKS)


def lamp_noise(lab):
    """Relative standard deviation of the calibration of each pixel, by counts of the lamp and its dark."""
    rate, exposure = _lamp(lab)
    dark = detector_pattern(lab)[0]
    noise = np.hypot(_noise(lab, (rate + dark) * exposure, LAMPS), _noise(lab, dark * exposure, LAMPS))
    return noise / (rate * exposure)


def _lamp(lab):
    """Count rate of the spectrometer's source over the pixels, as it is, and the exposure [s]."""
    shine = planck(lab.wavelength, lab.lamp + lab.source_bias * (lab.lamp / 1773.0) ** 2)
    rate = sensitivity(lab) * shine * (1 + spectral_error(lab)) * scale(lab)
    dark = detector_pattern(lab)[0]
    return rate, float(f"{min(0.75 * FULL / rate.max(), 0.3 * FULL / dark.mean()):.3g}")


def calibrate(lab, response):
    """Files of the calibration: points of the pyrometer, counts of the spectrometer, as the maker of the
    files sees them."""
    random = np.random.default_rng([lab.seed, 24])
    bands, step = true_bands(lab, response), SMOOTH[1] - SMOOTH[0]
    true = POINTS_K + lab.source_bias * (POINTS_K / 1773.0) ** 2
    light = 0.995 * planck(SMOOTH, true[:, None])
    signals = light @ bands.T * step * gains(lab) * (1 + random.normal(0, 0.002, (true.size, 2)))
    points = xr.Dataset({"source_temperature": ("calibration_point", POINTS_K)})
    for column, name in enumerate(("signal_wide", "signal_narrow")):
        points[name] = "calibration_point", signals[:, column]
    points.attrs = {"origin": "synthetic", "title": "Calibration of a two-colour pyrometer"}
    rate, exposure = _lamp(lab)
    counts = xr.Dataset(
        {
            "calibration_counts": ("wavelength", expose(lab, rate, exposure, random, LAMPS)),
            "calibration_background": ("wavelength", expose(lab, 0 * rate, exposure, random, LAMPS)),
        },
        {"wavelength": lab.wavelength},
        {
            "source_temperature": lab.lamp,
            "integration_time": exposure,
            "scans_averaged": LAMPS,
            "origin": "synthetic",
        },
    )
    counts.attrs["title"] = "Calibration of a spectrometer"
    return points, counts


def gains(lab):
    """Ampere per band signal of the two bands."""
    return 2e-10 * np.array([lab.ratio, 1.0])


def scale(lab):
    """Count rate per radiance: a surface of emittance 0.9 at 1950 K stays below the limit in one exposure."""
    hottest = 0.9 * planck(lab.wavelength, 1950.0) * sensitivity(lab)
    return 0.8 * FULL / (hottest.max() * lab.exposure)


@dataclass
class Scene:
    """Light on its way to the instruments; effects return changed copies.

    `surface` and `path` hold smooth light (t, SMOOTH) and factors by instrument ('p', 's'); `gas` a list of
    (instruments, amplitude (t,), spectrum (bins,)); `fine` a transmittance over the bins; `bands`
    responses; `readings` functions of signals (t, 2), `rates` functions of count rates (frames, W); `clock`
    maps true time to a time on the pyrometer's record.
    """

    time: np.ndarray
    kelvin: np.ndarray  # of the surface
    plasma: np.ndarray  # 1 while it shines
    off: float
    emittance: float
    surface: dict
    gas: list
    path: dict
    fine: np.ndarray
    bands: np.ndarray
    shift: np.ndarray  # of the wavelengths, by time [m]
    blur: float = 0.0  # further standard deviation of the slit [m]
    readings: list = field(default_factory=list)
    rates: list = field(default_factory=list)
    clock: object = None

    def copy(self, **changes):
        """A copy whose containers are its own."""
        own = {
            "surface": dict(self.surface),
            "path": dict(self.path),
            "gas": list(self.gas),
            "readings": list(self.readings),
            "rates": list(self.rates),
            "fine": self.fine.copy(),
            "bands": self.bands.copy(),
            "shift": self.shift.copy(),
        }
        return Scene(**(self.__dict__ | own | changes))

    @property
    def seen(self):
        """1 where the sample is in view."""
        return (self.time >= 0).astype(float)


def grid(start, off, end):
    """Times at which smooth light is computed [s]; both sides of each switch."""
    parts = [
        np.arange(start, 0, 1.0),
        [-1e-6],
        np.arange(0, 3, 0.05),
        np.arange(3, 12, 0.1),  # light between the times is taken as linear: 1e-4 of it
        np.arange(12, 30, 0.25),
        np.arange(30, off, 1.5),
        [off - 1e-6],
        off + np.arange(0, 12, 0.1),
        np.arange(off + 12, end, 0.25),
        [end],
    ]
    return np.unique(np.concatenate(parts))


def onto_smooth(spectrum):
    """Means over 1 nm of spectra over bins (..., bins), at SMOOTH (..., M)."""
    place = np.clip(((CENTRES - SMOOTH[0]) / 1e-9 + 0.5).astype(int), 0, SMOOTH.size - 1)
    shape = (*spectrum.shape[:-1], SMOOTH.size)
    result = np.array(
        [np.bincount(place, row, SMOOTH.size) for row in spectrum.reshape(-1, CENTRES.size)]
    ).reshape(shape)
    return result / np.maximum(np.bincount(place, minlength=SMOOTH.size), 1)


def through_slit(spectrum, wavelength, fwhm, blur=0.0):
    """What pixels see of a spectrum over bins: a Gaussian slit, by Fourier transform and interpolation."""
    sigma = np.hypot(fwhm / 2.3548, blur) / (EDGES[1] - EDGES[0])
    frequency = np.fft.rfftfreq(2 * CENTRES.size)
    light = np.fft.irfft(
        np.fft.rfft(spectrum, 2 * CENTRES.size) * np.exp(-2 * (np.pi * sigma * frequency) ** 2),
        2 * CENTRES.size,
    )
    return np.interp(wavelength, CENTRES, light[: CENTRES.size])


class Record:
    """What is recorded of scenes: the same instants, clocks and wandering for each scene of a case."""

    def __init__(self, lab, scene, seed, flicker):
        self.lab, self.random_seed, self.flicker_size = lab, seed, flicker
        self.start, self.end = scene.time[0], scene.time[-1]
        self.instants = np.arange(self.start, self.end, 1 / lab.pyrometer_rate)
        frames = int((self.end - self.start - 2 * ROOM) / lab.period)
        self.middles = self.start + ROOM + lab.period * np.arange(frames) + lab.exposure / 2

    def signals(self, scene, instants=None):
        """Signals (2, t) of the pyrometer without noise."""
        instants = self.instants if instants is None else instants
        if scene.clock is not None:
            instants = scene.clock(instants)
        fine = onto_smooth(scene.fine)
        light = scene.surface["p"] * fine
        for whom, amplitude, spectrum in scene.gas:
            if "p" in whom:
                light = light + amplitude[:, None] * onto_smooth(spectrum * scene.fine)
        total = (light * scene.path["p"]) @ scene.bands.T * (SMOOTH[1] - SMOOTH[0]) * gains(self.lab)
        result = np.array([np.interp(instants, scene.time, row) for row in total.T])
        for reading in scene.readings:
            result = reading(instants, result)
        return result

    def rates(self, scene, late=0.0):
        """Count rates (frames, W) of the spectrometer without noise, of frames that are late by times [s]."""
        lab, pixels = self.lab, self.lab.wavelength
        total = np.zeros((scene.time.size, pixels.size))
        fine = through_slit(scene.fine, pixels, lab.fwhm, scene.blur)
        light = scene.surface["s"]
        total += np.array([np.interp(pixels, SMOOTH, row) for row in light]) * fine
        drifts = np.ptp(scene.shift) > 0
        for whom, amplitude, spectrum in scene.gas:
            if "s" in whom:
                at = pixels + (0.0 if drifts else scene.shift[0])
                template = through_slit(spectrum * scene.fine, at, lab.fwhm, scene.blur)
                total += amplitude[:, None] * template
                if drifts:
                    total += (amplitude * scene.shift)[:, None] * np.gradient(template, pixels)
        total *= np.array(
            [np.interp(pixels, SMOOTH, row) for row in np.broadcast_to(scene.path["s"], light.shape)]
        )
        result = self.mean(scene.time, total, late) * sensitivity(lab) * scale(lab)
        for rate in scene.rates:
            result = rate(self.middles, result)
        return result

    def mean(self, time, rows, late=0.0):
        """Means over the exposures (frames, ...), late by times [s], of rows (t, ...), linear in time."""
        sums = np.concatenate(
            [
                np.zeros((1, *rows.shape[1:])),
                np.cumsum(np.diff(time)[:, None] * (rows[1:] + rows[:-1]) / 2, axis=0),
            ]
        )
        half, middles = self.lab.exposure / 2, self.middles + late

        def until(at):
            left = np.clip(np.searchsorted(time, at, side="right") - 1, 0, time.size - 2)
            share = (at - time[left])[:, None]
            slope = (rows[left + 1] - rows[left]) / np.diff(time)[left][:, None]
            return sums[left] + share * rows[left] + share**2 / 2 * slope

        return (until(middles + half) - until(middles - half)) / self.lab.exposure

    def dataset(self, scene, dark_scene, attributes):
        """A test file: signals and counts with all noises; `dark_scene` is the scene without the gas."""
        random, lab = np.random.default_rng([self.random_seed, 25]), self.lab
        common = np.arange(self.start - 1, self.end + 1, 0.05)
        flicker = 1 + self.flicker_size * _pink(random, common.size)
        test = xr.Dataset(attrs=attributes)
        if lab.has_pyrometer:
            instants = self.instants + random.normal(0, lab.jitter, self.instants.size)
            instants += random.normal(0, lab.clock_error)
            gas = self.signals(scene, instants) - (bare := self.signals(dark_scene, instants))
            together = _wander(random, self.instants, TOGETHER, lab.wander[1]) + _wander(
                random, self.instants, POINTING, lab.pointing
            )
            apart = np.array([[0.5], [-0.5]]) * _wander(random, self.instants, APART, lab.wander[2])
            own = [np.interp(instants, common, _pink(random, common.size)) for _ in bare]
            apart = apart + lab.gain_flicker * np.array(own)
            signals = (bare + gas * np.interp(instants, common, flicker)) * (1 + together + apart)
            signals += signals * random.normal(0, lab.noise, signals.shape)
            least = 2.0 * signals.max(axis=1, keepdims=True) / 2**lab.bits  # one step of the converter
            signals = np.rint(signals / least + random.normal(0, 0.4, signals.shape)) * least
            test = test.assign_coords(time=("time", self.instants))
            test["signal_wide"], test["signal_narrow"] = ("time", signals[0]), ("time", signals[1])
        if lab.has_spectrometer:
            late = random.normal(0, lab.frame_jitter, self.middles.size)
            middles = self.middles + late
            gas = self.rates(scene, late) - (bare := self.rates(dark_scene, late))
            steady = self.mean(common, flicker[:, None], late)
            drift = (
                1
                + _wander(random, middles, DRIFT, lab.wander[0])
                + _wander(random, middles, POINTING, lab.pointing)
            )
            rates = (bare + gas * steady) * drift[:, None]
            test = test.assign_coords(
                spectrum_time=("spectrum_time", self.middles), wavelength=("wavelength", lab.wavelength)
            )
            test["counts"] = ("spectrum_time", "wavelength"), expose(lab, rates, lab.exposure, random)
            test["background_counts"] = (
                "wavelength",
                expose(lab, np.zeros(lab.pixels), lab.exposure, random, DARKS),
            )
        return test


def _pink(random, size):
    """Noise with a 1/f spectrum above 0.02 Hz at 20 Hz, standard deviation 1."""
    frequency = np.fft.rfftfreq(size, 0.05)
    spectrum = random.normal(size=frequency.size) + 1j * random.normal(size=frequency.size)
    noise = np.fft.irfft(spectrum / np.sqrt(frequency + 0.02), size)
    return noise / noise.std()


def _wander(random, time, memory, size):
    """Ornstein-Uhlenbeck noise at times [s]."""
    knots = _knots(time, memory)
    keep, value = np.exp(-1 / 8), random.normal()
    steps = [value := keep * value + np.sqrt(1 - keep**2) * random.normal() for _ in knots]
    return size * np.interp(time, knots, steps)


def wander_of(time, memory):
    """Courses (t, k) of which numbers of unit variance make such noise of unit size."""
    knots = _knots(time, memory)
    power = np.arange(knots.size)
    root = np.linalg.cholesky(np.exp(-np.abs(power[:, None] - power) / 8))
    return np.array([np.interp(time, knots, column) for column in root.T]).T


def _knots(time, memory):
    return np.arange(time[0] - 1, time[-1] + 1 + memory / 8, memory / 8)
