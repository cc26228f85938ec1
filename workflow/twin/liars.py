"""Noise that is not what a laboratory believes: for tests of false alarms."""

from dataclasses import replace

import numpy as np

from twin.plasma import remembered


def _louder(factor):
    def apply(scene):
        pyrometer = scene.pyrometer
        return replace(
            scene,
            pyrometer=replace(
                pyrometer,
                reading_noise=factor * pyrometer.reading_noise,
                floor_noise=factor * pyrometer.floor_noise,
            ),
            draw=lambda random, shape, axis: random.standard_normal(shape) * (1.0 if axis == -1 else factor),
        )

    return apply


def _remembering(rho):
    """First-order autoregressive noise of unit variance in time."""

    def draw(random, shape, axis):
        kicks = np.moveaxis(random.standard_normal(shape), axis, 0)
        return np.moveaxis(remembered(kicks, rho), 0, axis)

    return lambda scene: replace(scene, draw=draw)


def _heavy_tailed(scene):
    """Student's t with three degrees of freedom, scaled to unit variance."""
    return replace(scene, draw=lambda random, shape, axis: random.standard_t(3, shape) / np.sqrt(3.0))


def _aliased(scene):
    """A 300 Hz ripple of the plasma, sampled slowly: it returns at a low frequency."""
    before = scene.pyrometer_output
    first, last = scene.reference_window

    def output(clean, time):
        signals = before(clean, time)
        gas = signals[:, (time >= first) & (time <= last)].mean(axis=1, keepdims=True)
        # The sampling clock is off by 0.01 %.
        wave = np.sin(2 * np.pi * 300.0 * time * (1 + 1e-4))
        return signals + np.where(time <= scene.plasma_off_time, 0.01 * gas * wave, 0.0)

    return replace(scene, pyrometer_output=output)


def _spoiled(change):
    def apply(scene):
        before = scene.recorded
        return replace(scene, recorded=lambda test, random: change(before(test, random), random))

    return apply


def _dropped(test, random):
    """One in twenty spectra and one in fifty readings is missing."""
    frames = random.random(test.sizes["spectrum_time"]) < 0.05
    readings = random.random(test.sizes["time"]) < 0.02
    test["counts"] = test.counts.where(~test.spectrum_time.copy(data=frames))
    for name in ("signal_wide", "signal_narrow"):
        test[name] = test[name].where(~test.time.copy(data=readings))
    return test


def _saturated(test, random):
    """Charge above four fifths of the brightest pixel is lost."""
    top = float(test.counts.max())
    full = 65535.0
    bright = test.counts > 0.8 * top
    test["counts"] = test.counts.where(~bright, full)
    return test


def _spiky(test, random):
    """One in a hundred values is hit."""
    for name in ("signal_wide", "signal_narrow", "counts"):
        values = test[name].values.copy()
        hit = random.random(values.shape) < 0.01
        size = 0.05 * np.abs(values) if name != "counts" else 400.0
        values = np.where(hit, values + size * random.exponential(1.0, values.shape), values)
        test[name] = (test[name].dims, np.minimum(np.rint(values), 65535) if name == "counts" else values)
        test[name].attrs["units"] = "count" if name == "counts" else "A"
    return test


LIARS = {
    "louder_1.1": _louder(1.1),
    "louder_1.3": _louder(1.3),
    "remembering": _remembering(0.5),
    "heavy_tailed": _heavy_tailed,
    "aliased": _aliased,
    "dropped": _spoiled(_dropped),
    "saturated": _spoiled(_saturated),
    "spiky": _spoiled(_spiky),
}


def lie(scene, name):
    """The scene with a noise of another kind; ValueError if the kind is unknown."""
    if name not in LIARS:
        raise ValueError(f"noise must be one of {', '.join(LIARS)}; got {name!r}")
    return LIARS[name](scene)
