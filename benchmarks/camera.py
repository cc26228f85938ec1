"""Temperature and emissivity of every pixel of a camera with 25 bands: time and error.

    python benchmarks/camera.py

An invented camera: 25 bands of 20 nm from 600 to 1080 nm, absolute calibration, 0.5 % noise, 250 x 250 pixels
of a surface from 1200 to 2000 K. Its emissivity is stated as 0.8 within 5 %, its course within 10 %:
"stated", of that level, with a tilt that grows over the picture; "drawn", in each pixel off in level and
tilt as far as is stated.
"""

import time

import numpy as np

from plasmapyro.estimate.emissivity import Channels, infer, log_emissivity, smooth_prior
from plasmapyro.radiation.planck import blackbody_radiance

PIXELS, BANDS, NOISE = 250, 25, 0.005
WAVELENGTH = np.linspace(0.59e-6, 1.09e-6, 101)
CENTRES = np.linspace(0.6e-6, 1.08e-6, BANDS)
LEVEL, SHAPE = 0.05, 0.1  # [1] stated uncertainties of the emissivity as a whole and of its course


def photograph(kind):
    """Time, errors and coverage of all pixels of a surface of a kind, printed."""
    random = np.random.default_rng(1)
    across, down = np.meshgrid(np.linspace(-1, 1, PIXELS), np.linspace(-1, 1, PIXELS))
    kelvin = (1600 + 400 * np.exp(-(across**2) - down**2) - 200 * across).ravel()
    course = (WAVELENGTH - 0.84e-6) / 0.25e-6
    level, tilt = np.zeros(kelvin.size), SHAPE * down.ravel()
    if kind == "drawn":
        level, tilt = random.normal(0, LEVEL, kelvin.size), random.normal(0, SHAPE, kelvin.size)
    emissivity = 0.8 * np.exp(level[:, None] + tilt[:, None] * course)
    weight = (np.abs(WAVELENGTH - CENTRES[:, None]) <= 0.0101e-6).astype(float)
    signal = (emissivity * blackbody_radiance(WAVELENGTH, kelvin[:, None])) @ weight.T
    signal *= 1 + NOISE * random.standard_normal(signal.shape)
    prior = smooth_prior(WAVELENGTH, 0.8, level=LEVEL, shape=SHAPE, length=2.5e-7)
    begin = time.perf_counter(), time.process_time()
    found = infer(Channels(WAVELENGTH, weight), prior, signal, NOISE * signal)
    value, spread = log_emissivity(found, prior.logarithm, prior.basis)
    wall, own = time.perf_counter() - begin[0], time.process_time() - begin[1]
    error = found.temperature / kelvin - 1
    inside = np.mean(np.abs(error) < 1.96 * found.relative_uncertainty)
    off = value - np.log(emissivity)
    held = np.mean(np.abs(off) < 1.96 * spread)
    print(f"emissivity {kind}: {PIXELS} x {PIXELS} pixels, {BANDS} bands: {wall:.1f} s ({own:.1f} s of CPU)")
    print(
        f"temperature: rms error {100 * np.sqrt(np.mean(error**2)):.2f} %, {100 * inside:.1f} % inside 95 %"
    )
    print(
        f"emissivity: rms error {100 * np.sqrt(np.mean(off**2)):.1f} %, {100 * held:.1f} % inside 95 %;"
        f" {found.converged.mean():.4f} settled"
    )


if __name__ == "__main__":
    for one in ("stated", "drawn"):
        photograph(one)
