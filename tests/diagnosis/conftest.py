"""A small laboratory of its own: two bands, a spectrometer, a gas of Gaussian lines, a sample that heats and
cools.

Signals are made here with formulas of their own, not with those of the package.
"""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from small_laboratory import (
    FIT,
    OFF,
    POWERS,
    SLIT_FWHM,
    black_body,
    error_modes,
    flicker_of,
    gas_components,
    temperature_of,
)

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "workflow"))


@pytest.fixture(scope="session")
def axis():
    return np.arange(701e-9, 1199e-9, 0.15e-9)


@pytest.fixture(scope="session")
def radiation(axis):
    def dataset(power):
        parts = gas_components(axis, power)
        return xr.Dataset(
            {
                "gas_radiance_slit": ("wavelength_slit", parts.sum(axis=0)),
                "gas_radiance_component_slit": (("component", "wavelength_slit"), parts),
                "component_uncertainty": ("component", [0.05, 0.09, 0.1]),
                **error_modes(axis, [0.05, 0.09, 0.1]),
            },
            {"wavelength_slit": axis, "component": ["O I", "N I", "N2 1P"]},
            {"slit_fwhm": SLIT_FWHM, "origin": "synthetic", "numerical_power": power},
        )

    return {name: dataset(power) for name, power in POWERS.items()}


@pytest.fixture(scope="session")
def variations(axis):
    base = gas_components(axis, 80e3)
    total = base.sum(axis=0)
    levels = np.array([-0.1, -0.05, 0.0, 0.05, 0.1])
    names = ("excitation", "vibration", "optical_depth")
    amplitude = np.array([levels, levels * 3, (levels + 0.1) * 10])
    shapes = np.array([base[:2].sum(axis=0) + 1e5, base[2] + 1e5, base[0] + 1e5])
    core = 0.06 * np.arange(-6, 8)
    varied = np.array(
        [
            total * np.exp(np.outer(a * s, row / row.max()))
            for a, s, row in zip(amplitude, (6, 1, -0.3), shapes, strict=True)
        ]
    )
    return xr.Dataset(
        {
            "core_radiance": (
                ("core_change", "wavelength_slit"),
                total * np.exp(np.outer(8 * core, (total / total.max()) ** 0.3)),
            ),
            "variation_amplitude": (("variation", "level"), amplitude),
            "varied_radiance": (("variation", "level", "wavelength_slit"), varied),
            "added_radiance": (
                ("addition", "wavelength_slit"),
                np.array([total, 20 * total, 0.01 * total, np.exp(-(((axis - 9.2e-7) / 2e-8) ** 2)) * 1e6]),
            ),
        },
        {
            "core_change": core,
            "variation": list(names),
            "addition": ["reflected_specular", "reflected_diffuse", "warm_wall", "cyanogen"],
            "wavelength_slit": axis,
        },
        {"origin": "synthetic", "slit_fwhm": SLIT_FWHM},
    )


@pytest.fixture(scope="session")
def response():
    wavelength = np.arange(740e-9, 1150.1e-9, 1e-9)
    wide = np.exp(-(((wavelength - 9.3e-7) / 9e-8) ** 2))
    narrow = np.exp(-(((wavelength - 1.04e-6) / 4e-8) ** 2))
    return xr.Dataset(
        {"responsivity_wide": ("wavelength", wide), "responsivity_narrow": ("wavelength", narrow)},
        {"wavelength": wavelength},
        {"origin": "synthetic"},
    )


@pytest.fixture(scope="session")
def calibration(response):
    temperature = np.arange(500.0, 3001.0, 10.0)
    wavelength = response.wavelength.values
    signals = [
        np.trapezoid(
            response[f"responsivity_{band}"].values * black_body(wavelength, temperature[:, None]), wavelength
        )
        for band in ("wide", "narrow")
    ]
    ratio = 0.3 * signals[0] / signals[1]
    between = (temperature >= FIT[0]) & (temperature <= FIT[1])
    place = (temperature[between] - sum(FIT) / 2) / (np.diff(FIT) / 2)
    return xr.Dataset(
        {
            "fit_coefficient": ("fit_power", np.polynomial.polynomial.polyfit(place, ratio[between], 2)),
            "fit_covariance": (("fit_power", "other_fit_power"), 1e-6 * np.eye(3)),
            "fit_range": ("bound", list(FIT)),
            "instrument_range": ("bound", [800.0, 2000.0]),
            "sensitivity_ratio": 0.3,
            "sensitivity_ratio_uncertainty": 0.0015,
            "absolute_sensitivity": ("band", [0.3e-8, 1e-8]),
            "source_temperature": ("calibration_point", np.arange(1000.0, 1700.0, 100.0)),
            "calibration_ratio": ("calibration_temperature", ratio),
        },
        {"band": ["wide", "narrow"], "calibration_temperature": temperature},
        {"origin": "synthetic"},
    )


@pytest.fixture(scope="session")
def record(axis, response):
    """Makes a test: record(window_loss=..., ratio_error=..., seed=...).

    `grains` take a share of the light over the wavelength, `slope` is that of the emittance per um.
    It runs from `start` to `end` [s] with a sample every `period` and a spectrum every `frame`.
    """

    def make(
        *,
        seed=1,
        window_loss=0.0,
        ratio_error=0.0,
        fringe=0.0,
        grains=0.0,
        slope=0.0,
        noise=1.0,
        emittance=0.85,
        power=80e3,
        start=-12.0,
        end=150.0,
        off=OFF,
        rise_time=12.0,
        height=1150.0,
        drop=0.0,
        flicker=0.0,
        period=0.5,
        frame=1.0,
    ):
        random = np.random.default_rng(seed)
        time = np.arange(start, end, period) + period / 10
        middle = np.arange(start + frame / 2, end, frame)
        pixels = np.arange(752e-9, 1028e-9, 0.8e-9)
        plume = gas_components(axis, power).sum(axis=0)

        def light(wavelength, gas, moment):
            moment = moment[:, None]
            kelvin = temperature_of(moment, off, rise_time, height, drop)
            surface = emittance * black_body(wavelength, kelvin) * (moment >= 0)
            surface = surface * (1 + slope * (wavelength * 1e6 - 0.95))
            burning = (moment >= 0) & (moment < off)
            surface = surface * (1 - grains * burning * 0.95e-6 / wavelength)
            scale = np.where(moment < 0, 1.6, (moment < off).astype(float))
            return surface + scale * flicker_of(moment, flicker, np.random.default_rng([seed, 1])) * gas

        wavelength = response.wavelength.values
        inside = np.interp(wavelength, axis, plume)
        whole = light(wavelength, inside, time)
        signals = np.array(
            [
                gain * np.trapezoid(response[f"responsivity_{band}"].values * whole, wavelength)
                for gain, band in ((0.3e-8 * np.exp(ratio_error), "wide"), (1e-8, "narrow"))
            ]
        )
        signals = signals * (1 + noise * 0.003 * random.standard_normal(signals.shape))
        place, share = np.polynomial.legendre.leggauss(3 if frame < 5 else 16)
        seen = gas_components(pixels, power).sum(axis=0)
        spectra = sum(
            one / 2 * light(pixels, seen, middle + 0.45 * frame * at)
            for at, one in zip(place, share, strict=True)
        )
        spectra = spectra * (1 - window_loss * np.clip(middle / off, 0, 1)[:, None])
        spectra = spectra * (1 + fringe * np.sin(2 * np.pi * 1.1e-4 / pixels))
        level = np.hypot(0.006 * spectra, 2e5)
        spectra = spectra + noise * level * random.standard_normal(spectra.shape)
        return xr.Dataset(
            {
                "signal_wide": ("time", signals[0], {"units": "A"}),
                "signal_narrow": ("time", signals[1], {"units": "A"}),
                "spectral_radiance": (("spectrum_time", "wavelength"), spectra, {"units": "W m-2 sr-1 m-1"}),
            },
            {
                "time": ("time", time, {"units": "s"}),
                "spectrum_time": ("spectrum_time", middle, {"units": "s"}),
                "wavelength": ("wavelength", pixels, {"units": "m"}),
            },
            {
                "condition": "80kW",
                "origin": "synthetic",
                "injection_time": 0.0,
                "plasma_off_time": off,
                "reference_window": np.array([0.0, rise_time / 3]),
                "emittance": 0.85,
                "emittance_uncertainty": 0.05,
                "window_transmittance_pyrometer": 0.87,
                "window_transmittance_spectrometer": 0.95,
                "pyrometer_integration_time": period / 50,
                "spectrometer_integration_time": 0.9 * frame,
                "spectrometer_fwhm": SLIT_FWHM,
            },
        )

    return make


@pytest.fixture(scope="session")
def laboratory(radiation, variations, response, calibration):
    return SimpleNamespace(
        radiation=radiation, variations=variations, response=response, calibration=calibration
    )


@pytest.fixture(scope="session")
def model(record, laboratory):
    from plasmapyro.diagnosis.fit.build import base_model
    from plasmapyro.diagnosis.gas.library import gas_library
    from plasmapyro.record.record import record_of

    both = {"pyrometer": None, "spectrometer": None}
    library = gas_library("80kW", laboratory.radiation, laboratory.variations, fwhm=SLIT_FWHM)
    return base_model(record_of(record(), both), library, laboratory.calibration, laboratory.response)


@pytest.fixture(scope="session")
def diagnosis_of(laboratory):
    """Diagnoses a test of the laboratory."""
    from plasmapyro.diagnosis import command
    from plasmapyro.diagnosis.stage import diagnose

    def run(test, **options):
        with np.errstate(all="ignore"):
            return diagnose(
                test,
                laboratory.radiation,
                laboratory.variations,
                laboratory.response,
                laboratory.calibration,
                **{"draws": 400, "saturation_counts": 65000.0, "limits": command.LIMITS} | options,
            )

    return run


@pytest.fixture(scope="session")
def diagnosed(record, diagnosis_of):
    """Diagnoses a test of `record` with some settings, keeping results."""
    kept = {}

    def run(without=(), **settings):
        key = (without, *sorted(settings.items()))
        if key not in kept:
            kept[key] = diagnosis_of(record(**settings), exclude=without)
        return kept[key]

    return run
