"""Temperature and emissivity of every pixel of a camera with 25 bands: time and error.

    python benchmarks/camera.py

An invented camera: 25 bands of 20 nm from 600 to 1080 nm, absolute calibration, 0.5 % noise, 250 x 250 pixels
of a surface from 1200 to 2000 K whose emissivity tilts from edge to edge.
"""

import time

import numpy as np

from plasmapyro.estimate.emissivity import Channels, infer, log_emissivity, smooth_prior
from plasmapyro.radiation.planck import blackbody_radiance

PIXELS, BANDS, NOISE = 250, 25, 0.005
WAVELENGTH = np.linspace(0.59e-6, 1.09e-6, 101)
CENTRES = np.linspace(0.6e-6, 1.08e-6, BANDS)


def main():
    random = np.random.default_rng(1)
    across, down = np.meshgrid(np.linspace(-1, 1, PIXELS), np.linspace(-1, 1, PIXELS))
    kelvin = (1600 + 400 * np.exp(-(across**2) - down**2) - 200 * across).ravel()
    course = (WAVELENGTH - 0.84e-6) / 0.25e-6
    emissivity = 0.8 * np.exp(0.1 * down.ravel()[:, None] * course)
    weight = (np.abs(WAVELENGTH - CENTRES[:, None]) <= 0.0101e-6).astype(float)
    signal = (emissivity * blackbody_radiance(WAVELENGTH, kelvin[:, None])) @ weight.T
    signal *= 1 + NOISE * random.standard_normal(signal.shape)
    prior = smooth_prior(WAVELENGTH, 0.8, level=0.05, shape=0.1, length=2.5e-7)
    begin = time.perf_counter(), time.process_time()
    found = infer(Channels(WAVELENGTH, weight), prior, signal, NOISE * signal)
    value, spread = log_emissivity(found, prior.logarithm, prior.basis)
    wall, own = time.perf_counter() - begin[0], time.process_time() - begin[1]
    error = found.temperature / kelvin - 1
    inside = np.mean(np.abs(error) < 1.96 * found.relative_uncertainty)
    off = value - np.log(emissivity)
    print(f"{PIXELS} x {PIXELS} pixels, {BANDS} bands: {wall:.1f} s ({own:.1f} s of CPU)")
    print(
        f"temperature: rms error {100 * np.sqrt(np.mean(error**2)):.2f} %, {100 * inside:.1f} % inside 95 %"
    )
    print(
        f"emissivity: rms error {100 * np.sqrt(np.mean(off**2)):.1f} %; {found.converged.mean():.4f} settled"
    )


if __name__ == "__main__":
    main()
