"""A small diagnosis as its files hold it, for the tests of the page: invented numbers, no computation."""

import json

import numpy as np
import xarray as xr

from plasmapyro.record import budget, recommended, status

TIME = np.array([-10.0, 2.0, 20.0, 100.0, 200.0, 310.0])
WAVELENGTH = np.linspace(760e-9, 1020e-9, 8)


def candidate(name, *, kelvin, probability, rank):
    return {
        "id": name,
        "name": f"cause {name}",
        "class": "windows",
        "stage": "path",
        "rank": rank,
        "amplitude": 0.0412,
        "standard_error": 0.0031,
        "interval95": [0.035, 0.047],
        "unit": "1",
        "amplitude_name": "loss",
        "shape": {},
        "gain_chi2": 512.0,
        "log_evidence": 249.0,
        "probability": probability,
        "significance": 22.6,
        "angle_to_next": 8.4,
        "next": "other",
        "temperature_shift": {"paper": kelvin, "base": -kelvin / 2, "at_time": 280.0},
        "phases": ["steady"],
        "instruments": ["spectrometer"],
        "sentence": "",
    }


def report(**changes):
    """A whole report; `changes` replace its top-level entries."""
    count = TIME.size
    signal = list(np.linspace(1e-9, 1e-7, count))
    phases = [
        {"id": "pre", "name": "before", "start": -20.0, "end": 0.0, "samples": 1},
        {"id": "steady", "name": "steady", "start": 0.0, "end": 300.0, "samples": 4},
    ]
    whole = {
        "schema": "plasmapyro-diagnosis-1",
        "dataset": {
            "title": "Test 7",
            "condition": "80kW",
            "origin": "measured",
            "sha256": "0" * 64,
            "instruments": ["pyrometer", "spectrometer"],
            "phases": phases,
            "plasma_off_time": 300.0,
            "time_bins": count,
            "wavelength_bins": WAVELENGTH.size,
        },
        "findings": [],
        "noise": [
            {
                "channel": "wide",
                "relative": 0.003,
                "constant": 0.0,
                "linear": 0.0,
                "quadratic": 9e-6,
                "lag1": 0.02,
                "tail": 1.1,
                "unit": "A",
            }
        ],
        "base": {
            "chi2": 2711.0,
            "dof": 2531.0,
            "converged": True,
            "adequate": True,
            "why": "",
            "by_phase": [
                {"phase": "pre", "channel": "wide", "chi2": 97.0, "count": 100, "p": 0.2},
                {"phase": "steady", "channel": "lines", "chi2": 300.0, "count": 100, "p": 1e-6},
            ],
            "pulls": [
                {
                    "id": "power",
                    "name": "simulated power",
                    "value": 0.27,
                    "sigma": 0.08,
                    "pull": 3.4,
                    "unit": "1",
                    "finding": True,
                }
            ],
        },
        "tests": [{"id": "any", "name": "largest gain", "statistic": 512.0, "p": 1e-5, "threshold": 13.1}],
        "thresholds": {
            "effect": 13.1,
            "unknown": 2.4,
            "third": 16.0,
            "nulls": 4000,
            "seed": 1,
            "level": 0.05,
        },
        "candidates": [
            candidate("winE", kelvin=12.4, probability=0.91, rank=1),
            candidate("other", kelvin=3.2, probability=0.07, rank=2),
        ],
        "verdict": {
            "status": "one-of",
            "named": ["winE"],
            "set": [["winE", "other"]],
            "class": ["windows"],
            "probability": {"winE": 0.91, "other": 0.07, "unknown": 0.02, "none": 0.0},
            "joint_probability": 0.91,
            "uncalibrated": 0.97,
            "p_base": 1e-5,
            "unknown": {"instrument": "spectrometer", "axis": "wavelength"},
            "temperature_shift": -6.2,
            "sentences": ["The data reject the base model.", "Nothing else is needed."],
            "missing_evidence": [
                {
                    "measurement": "lamp through the window",
                    "decides": ["winE", "other"],
                    "expected_significance": 40.0,
                }
            ],
        },
        "discrepancy": {
            "class": None,
            "name": None,
            "log_bayes": 1.2,
            "per_class": [{"id": "smooth", "name": "smooth map", "log_bayes": 1.2}],
            "rank1": None,
            "lines": [],
        },
        "simulation": {
            "p": 0.3,
            "threshold": 10.0,
            "power": 0.98,
            "brightness": 1.02,
            "power_error": 0.03,
            "systems": [
                {
                    "name": name,
                    "wavelength": [8e-7, 9.45e-7],
                    "ratio": ratio,
                    "error": 0.05,
                    "stated": 0.1,
                    "by_power": 1.0,
                    "beyond": ratio > 1.3,
                }
                for name, ratio in (("N2 1P 800-945 nm", 1.42), ("O I 777 nm", 0.98))
            ],
            "lines": [{"wavelength": 7.8e-7, "strength": 0.2, "error": 0.03}],
            "gains": [{"id": "T_exc", "gain_chi2": 3.0}],
            "sentences": ["N2 1P 800-945 nm: 1.42 of the simulated light is measured."],
        },
        "extended": {
            "configuration": "effects:\n  - id: winE\n",
            "terms": [{"id": "winE", "parameters": {"loss": 0.041}, "standard_errors": {"loss": 0.003}}],
            "chi2": 2530.0,
            "dof": 2530.0,
            "applied": True,
            "why": "held-out data improve",
        },
        "gain": {
            "heldout_log_score": 214.0,
            "heldout_standard_error": 31.0,
            "blocks": [
                {"start": 0.0, "end": 20.0, "difference": 3.0},
                {"start": 20.0, "end": 40.0, "difference": -1.0},
            ],
            "cross_instrument": 12.0,
            "cross_condition": None,
            "kappa_before": None,
            "kappa_after": None,
            "temperature_shift": -6.2,
            "temperature_sigma_base": 2.2,
            "temperature_sigma_extended": 2.4,
        },
        "limits": [
            {
                "id": "phi",
                "name": "sensitivity ratio",
                "amplitude_5sigma": 0.025,
                "unit": "1",
                "temperature_5sigma": 75.0,
                "temperature_prior": 45.0,
                "invisible": True,
                "measurement": "repeat the calibration",
            }
        ],
        "posterior": {
            "names": ["ratio"],
            "mean": [0.001],
            "covariance": [[1e-6]],
            "prior": {"mean": [0.0], "covariance": [[1.6e-5]]},
            "misfit": 1.0,
            "with_priors": False,
            "temperature": {"time": [20.0], "value": [1400.0], "sigma": [2.0], "slope": [[1500.0]]},
        },
        "next": [
            {
                "id": name,
                "measurement": f"the {name} repeated",
                "kelvin_before": 2.6,
                "kelvin_after": kelvin,
                "resolves": [["winE", "eps_ox"]] if name == "lamp" else [],
                "after_first": 1.1,
            }
            for name, kelvin in (("calibration", 1.4), ("lamp", 2.3))
        ],
        "show": {
            "phases": ["pre", "steady"],
            "signals": {
                "time": list(TIME),
                "wide": signal,
                "narrow": [None, *signal[1:]],
                "wide_model": signal,
                "narrow_model": signal,
                "wide_extended": signal,
                "narrow_extended": signal,
            },
            "kappa": {
                "wide": 1.02,
                "narrow": None,
                "wide_error": 0.1,
                "narrow_error": None,
                "wavelength": list(WAVELENGTH),
                "kappa": [1.0] * (WAVELENGTH.size - 1) + [None],
                "error": [0.05] * WAVELENGTH.size,
                "labels": [{"wavelength": 777e-9, "text": "O I 777"}],
            },
            "emittance_loop": {
                "temperature": [1300.0, 1500.0, 1600.0, 1400.0],
                "emittance": [0.85, 0.86, 0.84, 0.83],
                "error": [0.01] * 4,
                "heating": [True, True, True, False],
                "stated": 0.85,
            },
            "line_hump": {
                "measured": {"line": 1.04, "hump": 1.01, "line_error": 0.03, "hump_error": 0.02},
                "tracks": [
                    {
                        "id": "refl",
                        "name": "reflected light",
                        "amplitude": [0.0, 1.0],
                        "line": [1.0, 1.44],
                        "hump": [1.0, 1.27],
                    }
                ],
                "closest": "none",
            },
            "gas_monitor": {
                "time": list(TIME),
                "gas": [1.6, 1.0, 1.0, 1.0, None, 0.0],
                "error": [0.01] * count,
                "channels": {"electric_power": [1.0] * count},
            },
            "components": [
                {
                    "instrument": "spectrometer",
                    "singular_value": 31.0,
                    "expected": 18.0,
                    "time": list(TIME),
                    "time_weight": [0.0] * count,
                    "axis": list(WAVELENGTH),
                    "axis_weight": [1.0] * WAVELENGTH.size,
                    "resembles": [{"id": "winE", "cosine": 0.93}],
                }
            ],
            "autocorrelation": [{"channel": "wide", "lag": [1, 2], "value": [0.02, -0.1], "band": 0.12}],
            "quantiles": [{"channel": "wide", "normal": [-1.0, 1.0], "residual": [-1.1, 1.0]}],
            "profile": [{"id": "winE", "amplitude": [0.03, 0.04, 0.05], "chi2": [13.0, 0.0, 13.0]}],
            "angles": {"ids": ["winE", "other"], "degrees": [[0.0, 8.4], [8.4, 0.0]]},
        },
        "checks": {
            "p": 0.4,
            "by_phase": [{"phase": "hot", "channel": "wide", "chi2": 31.0, "count": 30, "p": 0.41}],
        },
        "assumptions": ["local thermal equilibrium"],
        "provenance": {
            "version": "0.1.0",
            "commit": None,
            "seed": 1,
            "files": {"test.nc": "0" * 64},
            "blind_score": None,
        },
    }
    return whole | changes


def residual_map(models=("base", "extended"), instruments=("pyrometer", "spectrometer")):
    """Residuals of a small map; an absent instrument's variables are absent."""
    random = np.random.default_rng(1)
    variables = {"time_edge": (("time_bin", "bound"), np.stack([TIME - 5, TIME + 5], 1))}
    coordinates = {"time_bin": TIME, "model": list(models)}
    if "spectrometer" in instruments:
        edge = np.stack([WAVELENGTH - 15e-9, WAVELENGTH + 15e-9], 1)
        shape = (len(models), TIME.size, WAVELENGTH.size)
        variables["wavelength_edge"] = (("wavelength_bin", "bound"), edge)
        variables["radiance_residual"] = (
            ("model", "time_bin", "wavelength_bin"),
            random.standard_normal(shape),
        )
        coordinates["wavelength_bin"] = WAVELENGTH
    if "pyrometer" in instruments:
        shape = (len(models), 2, TIME.size)
        variables["signal_residual"] = (("model", "band", "time_bin"), random.standard_normal(shape))
        coordinates["band"] = ["wide", "narrow"]
    return xr.Dataset(variables, coordinates)


def temperature():
    """Temperatures by three methods, of which the extended one is recommended; nothing before injection."""
    base = np.where(TIME < 0, np.nan, 1000.0 + TIME)
    variables = {"paper_temperature": ("time_bin", base + 5.0)}
    for name, offset in (("base", 0.0), ("extended", -4.0)):
        for suffix, shift in (("", 0.0), ("_low", -3.0), ("_high", 3.0)):
            variables[f"{name}_temperature{suffix}"] = ("time_bin", base + offset + shift)
    blank = np.where(TIME < 0, np.nan, 1.0)
    inputs = [
        budget.Input("temperature of the source", "calibration", 1.2 * blank, 3.0, "K", "rectangular"),
        budget.Input("noise of the samples", "noise", 0.9 * blank, freedom=8.0),
    ]
    state = np.where(TIME < 0, status.NOT_INJECTED, np.where(TIME < 10, status.GAS_DOMINATED, status.VALID))
    series = recommended.series(TIME, base - 4.0, state, inputs, axis="time_bin")
    choice = recommended.Choice("extended", "Recommended: the diagnosis, because data confirm it.")
    return series.assign(variables).assign_attrs(recommended.attributes(choice))


def truth():
    """What was hidden in the data of these numbers: a cause that was found and one that was not."""
    hidden = [{"effect": "winE", "amplitude": 0.045}, {"effect": "drift", "amplitude": 0.2}]
    true = np.where(TIME < 0, 350.0, 997.0 + TIME)
    return xr.Dataset({"surface_temperature": ("time", true)}, {"time": TIME}, {"hidden": json.dumps(hidden)})
