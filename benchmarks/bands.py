"""Five bands through a plasma, against ratios of two with a grey assumption. Numbers of docs/real-data.md.

    python benchmarks/bands.py [--tests N] [--seed N] [--surfaces N]

Invented surfaces behind invented gas: the emissivity is tilted over wavelength, curved about any wavelength,
or changes from one tilt to another while the surface oxidises; its level is drawn with the uncertainty that
the test states. Ratios are those of all ten pairs of the same bands, their gas taken out the same way.
--surfaces: as many single samples at 1700 K without a gas instead, with the course of the emissivity as
stated and as free as the light of each asks for; "as stated" are surfaces drawn from what the test states.
"""

import argparse
import itertools

import numpy as np
import xarray as xr

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.estimate.emissivity import Channels, infer, smooth_prior
from plasmapyro.estimate.emissivity_stage import FREER, course_freedom, estimate_emissivity
from plasmapyro.instrument.bands import radiometer_calibration
from plasmapyro.radiation.planck import blackbody_radiance

CENTRES, WIDTH = np.array([700e-9, 800e-9, 900e-9, 1000e-9, 1100e-9]), 20e-9  # [m]
NAMES = [f"b{place + 1}" for place in range(CENTRES.size)]
NOISE, EMITTANCE, LEVELS = 0.003, 0.75, (0.06, 0.15)
MIDDLE, SPAN = 900e-9, 200e-9  # [m]
OFF, WINDOW = 40.0, (0.0, 5.0)  # [s]
SETTINGS = {  # the defaults of `plasmapyro correct`
    "level": None,
    "shape": 0.1,
    "length": 200e-9,
    "memory": 100.0,
    "stray_light": 0.003,
    "bin_width": 20e-9,
    "bin_uncertainty": 0.005,
    "gas_variation": 0.03,
    "least_signal_to_noise": 10.0,
    "least_surface_share": 0.5,
    "saturation_counts": 65000.0,
    "noise_block": 50,
}
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
KINDS = ("tilted", "curved", "oxidising", "as stated")


def light(kelvin, emissivity=lambda _: 1.0):
    """Radiance (t, C) of the bands, by Gauss and Legendre's rule."""
    at = CENTRES[:, None] + WIDTH / 2 * NODES
    body = np.stack([blackbody_radiance(row, np.asarray(kelvin)[:, None]) for row in at], axis=1)
    return np.sum(WEIGHTS * emissivity(at) * body, axis=-1) * WIDTH / 2


def surface(kind, random, spread):
    """Emissivity before and after the test: functions of wavelength [m]."""
    level = EMITTANCE * np.exp(spread * random.normal())
    slope, bend, centre = random.normal(0, 0.3), random.normal(0, 0.1), random.uniform(800e-9, 1000e-9)
    tilted = lambda at: level * (at / MIDDLE) ** -slope  # noqa: E731
    if kind == "curved":
        one = lambda at: level * np.exp(bend * (((at - centre) / SPAN) ** 2 - 0.5))  # noqa: E731
        return one, one
    after = random.normal(0, 0.3)
    return tilted, (lambda at: 1.05 * level * (at / MIDDLE) ** -after) if kind == "oxidising" else tilted


def calibration(random):
    wavelength = np.arange(680e-9, 1120e-9, 0.5e-9)
    curves = np.abs(wavelength - CENTRES[:, None]) < WIDTH / 2
    facts = {"instrument": "five", "calibration": "absolute", "signal_uncertainty": NOISE}
    response = xr.Dataset(
        {"responsivity": (("band", "wavelength"), curves.astype(float))},
        {"wavelength": wavelength, "band": NAMES},
        facts | {"origin": "synthetic", "instrument_range": (900.0, 2600.0)},
    )
    kelvin = np.arange(1100.0, 2001.0, 150.0)
    seen = light(kelvin) * random.normal(1, NOISE, (kelvin.size, CENTRES.size))
    points = {"source_temperature": kelvin} | dict(zip(NAMES, seen.T, strict=True))
    return radiometer_calibration(response, points, source_temperature_uncertainty=1.0)


def one_test(kind, random, spread, plasma):
    """Error (t,) [K] of five bands, whether inside the 95 % interval, and errors (10, t) of all ratios."""
    time = np.arange(-1.0, 50.0, 0.5)
    kelvin = 350 + 1350 / (1 + np.exp(-(time - 12) / 2.5))
    before, after = (light(kelvin, one) for one in surface(kind, random, spread))
    share = np.clip((time - 8) / 32, 0, 1)[:, None]
    shining = (plasma & (time < OFF))[:, None]
    gas = 0.05 * light([1600.0]) * (1 + 0.01 * random.normal(size=(time.size, 1))) * shining
    signal = ((1 - share) * before + share * after) * (time >= 0)[:, None] + gas
    signal *= random.normal(1, NOISE, signal.shape)
    test = xr.Dataset(
        {"radiometer_signal": (("radiometer_time", "band"), signal, {"units": "1"})},
        {"radiometer_time": ("radiometer_time", time, {"units": "s"}), "band": NAMES},
        ({"injection_time": 0.0, "plasma_off_time": OFF, "reference_window": list(WINDOW)} if plasma else {})
        | {
            "origin": "synthetic",
            "condition": "90kW" if plasma else "none",
            "emittance": EMITTANCE,
            "emittance_uncertainty": spread * EMITTANCE,
            "window_transmittance_radiometer": 1.0,
            "radiometer_integration_time": 0.01,
        },
    )
    found = estimate_emissivity(test, calibration(random), **SETTINGS)
    hot = (time > 15) & (np.abs(time - OFF) > 0.6) & np.isfinite(found.spectral_temperature.values)
    low, high = found.spectral_temperature_interval.values
    window = signal[(time > 0) & (time < WINDOW[1])].mean(axis=0)
    clean = signal - np.where(shining, window, 0)
    curve = np.arange(700.0, 3500.0)
    black, ratios = light(curve), []
    for a, b in itertools.combinations(range(CENTRES.size), 2):
        grey = np.interp(clean[hot, a] / clean[hot, b], black[:, a] / black[:, b], curve)
        ratios.append(grey - kelvin[hot])
    return (
        (found.spectral_temperature.values - kelvin)[hot],
        ((low < kelvin) & (kelvin < high))[hot],
        np.array(ratios),
    )


def surfaces(kind, random, spread, count, kelvin=1700.0):
    """Rms error [K] and share inside 95 % of samples, course as stated and freed; rms of the ratios."""
    prior = {"level": spread, "length": SETTINGS["length"]}
    if kind == "as stated":
        told = smooth_prior(CENTRES, EMITTANCE, shape=SETTINGS["shape"], **prior)
        course = np.exp(told.logarithm + random.standard_normal((count, told.basis.shape[1])) @ told.basis.T)
    else:
        course = np.array([surface(kind, random, spread)[0](CENTRES) for _ in range(count)])
    seen = course * blackbody_radiance(CENTRES, kelvin) * (1 + NOISE * random.standard_normal(course.shape))

    def fitted(factor, rows=slice(None)):
        one = smooth_prior(CENTRES, EMITTANCE, shape=factor * SETTINGS["shape"], **prior)
        return infer(Channels(CENTRES), one, seen[rows], NOISE * seen[rows])

    told = np.array([fitted(one).evidence for one in FREER]).T
    freed = [fitted(course_freedom(one, CENTRES.size), slice(n, n + 1)) for n, one in enumerate(told)]
    for fits in [fitted(1.0)], freed:
        found, error = (
            np.concatenate([getattr(fit, name) for fit in fits])
            for name in ("temperature", "relative_uncertainty")
        )
        inside = np.abs(np.log(found / kelvin)) < 1.959964 * error
        yield np.sqrt(np.mean((found - kelvin) ** 2)), 100 * inside.mean()
    colour = SECOND_RADIATION / CENTRES
    pairs = itertools.combinations(range(CENTRES.size), 2)
    log = np.log(seen / blackbody_radiance(CENTRES, kelvin))
    grey = [(log[:, a] - log[:, b]) / (colour[a] - colour[b]) for a, b in pairs]  # of -1/T
    yield np.sqrt(np.mean((kelvin**2 * np.array(grey)) ** 2)), np.nan


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tests", type=int, default=40, metavar="N", help="of each kind and level")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the draws")
    parser.add_argument("--surfaces", type=int, metavar="N", help="single samples without a gas")
    options = parser.parse_args()
    for spread, kind in itertools.product(LEVELS, (*KINDS[:2], KINDS[3])) if options.surfaces else ():
        random = np.random.default_rng([options.seed, KINDS.index(kind), int(100 * spread)])
        (own, stated), (freed, inside), (grey, _) = surfaces(kind, random, spread, options.surfaces)
        numbers = f"{own:.1f} K | {stated:.1f} % | {freed:.1f} K | {inside:.1f} % | {grey:.1f} K |"
        print(f"| {100 * spread:.0f} % | {kind} | {numbers}", flush=True)
    if options.surfaces:
        return
    print("| level known to | plasma | emissivity | five bands | ratios, grey | times less | inside 95 % |")
    print("|---|---|---|---|---|---|---|")
    for spread, plasma, kind in itertools.product(LEVELS, (True, False), KINDS[:3]):
        random = np.random.default_rng([options.seed, KINDS.index(kind), int(100 * spread), plasma])
        drawn = [one_test(kind, random, spread, plasma) for _ in range(options.tests)]
        own, grey = (np.sqrt(np.mean([np.mean(one[place] ** 2) for one in drawn])) for place in (0, 2))
        share = 100 * np.array([one[1].mean() for one in drawn])  # samples of a test share its surface
        inside = f"{share.mean():.1f} +- {share.std() / np.sqrt(share.size):.1f} %"
        numbers = f"{own:.1f} K | {grey:.1f} K | {grey / own:.1f} | {inside} |"
        print(f"| {100 * spread:.0f} % | {'yes' if plasma else 'no'} | {kind} | {numbers}", flush=True)


if __name__ == "__main__":
    main()
