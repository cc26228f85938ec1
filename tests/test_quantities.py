"""Keys of the configuration become arguments in SI."""

import doctest
from inspect import signature
from pathlib import Path

import numpy as np
import pytest
import yaml

from plasmapyro import quantities
from plasmapyro.experiment import stage as experiment
from plasmapyro.flow import stage as flow
from plasmapyro.flow.geometry import Torch
from plasmapyro.instrument import stage as instrument
from plasmapyro.quantities import in_si, steps
from plasmapyro.sightline import stage as sightline

ROOT = Path(__file__).resolve().parents[1]
CONFIG = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
FLOW = CONFIG["flow"]
POWER = {"numerical_power_kw": 80, "chamber_pressure_mbar": 50, "mass_flow_rate_g_s": 16}
COUNTS = {"saturation_counts": 1, "least_net_counts": 1, "noise_block_pixels": 1}
COMMON = FLOW["physics"] | POWER | {"coil_frequency_khz": 400, "power_step_kw": FLOW["power_step_kw"]}


def test_the_examples_are_right():
    assert doctest.testmod(quantities) == (0, 2)


def test_the_longer_of_two_endings_counts():
    found = in_si(
        {"mass_flow_rate_g_s": 16, "velocity_tolerance_m_s": 0.2, "natural_frequency_per_s": 0.1, "t_s": 3}
    )
    assert found == {"mass_flow_rate": 0.016, "velocity_tolerance": 0.2, "natural_frequency": 0.1, "t": 3}


def test_each_unit_is_what_it_is_in_si():
    keys = {
        "a_kw": 2,
        "b_mbar": 50,
        "c_g_s": 16,
        "d_khz": 400,
        "e_mm": 14,
        "f_um": 200,
        "g_nm": 0.75,
        "h_deg": 180,
    }
    expected = [2000.0, 5000.0, 0.016, 4e5, 0.014, 2e-4, 7.5e-10, np.pi]
    assert list(in_si(keys).values()) == pytest.approx(expected, rel=1e-15, abs=0)


def test_what_is_in_si_keeps_its_type():
    """Counts of pixels stay whole, and integers of the configuration integers of the attributes."""
    found = in_si({"noise_block_pixels": 50, "instrument_range_k": [973, 2073], "conditions": ["80kW"]})
    assert found == {"noise_block": 50, "instrument_range": [973, 2073], "conditions": ["80kW"]}
    assert isinstance(found["noise_block"], int) and isinstance(found["instrument_range"][0], int)


def test_an_angle_is_in_radians_to_the_last_bit():
    assert in_si({"angle_deg": 35})["angle"] == np.radians(35)


@pytest.mark.parametrize(
    "first, last, step, count", [(500, 2500, 5, 401), (-5, 100, 0.1, 1051), (400, 4000, 10, 361)]
)
def test_both_ends_are_included(first, last, step, count):
    values = steps(first, last, step)
    assert (values.size, values[0]) == (count, first)
    assert values[-1] == pytest.approx(last, rel=1e-12)


def test_no_unit_of_the_configuration_is_overlooked():
    """A key with a unit that `in_si` does not know would pass as if it were SI."""
    by_hand = {"_m2_sr", "_mm2", "_hz", "_per_root_hz", "_per_um"}  # of the design, in `design.settings`

    def keys(tree):
        for key, value in tree.items():
            yield key
            if isinstance(value, dict):
                yield from keys(value)

    units = {
        "kw",
        "mbar",
        "pa",
        "g_s",
        "khz",
        "hz",
        "s",
        "k",
        "deg",
        "mm",
        "mm2",
        "um",
        "nm",
        "m",
        "sr",
        "pixels",
    }
    unknown = [
        key
        for key in keys(CONFIG)
        if key.rsplit("_", 1)[-1] in units and not key.endswith((*quantities.ENDINGS, *by_hand))
    ]
    assert not unknown


@pytest.mark.parametrize(
    "stage, inputs, keys",
    [
        (flow.condition, 2, FLOW["convergence"] | COMMON),
        (sightline.line_of_sight, 1, CONFIG["sightline"]),
        (instrument.band_response, 0, CONFIG["instrument"]["response"]),
        (instrument.spectrometer_calibration, 1, CONFIG["instrument"]["spectrometer"]),
        (
            instrument.calibrate_exposures,
            1,
            {"saturation_counts": 1, "least_net_counts": 1, "noise_block_pixels": 1},
        ),
        (experiment.correct_spectra, 2, CONFIG["experiment"]["spectrometer"]),
    ],
    ids=lambda one: getattr(one, "__name__", ""),
)
def test_keys_are_the_arguments_of_the_stages_that_take_them_all(stage, inputs, keys):
    signature(stage).bind(*[None] * inputs, **in_si(keys))


def test_the_keys_of_the_torch_are_the_fields_of_the_torch_and_of_the_cold_start():
    torch = in_si(FLOW["torch"])
    others = {name: torch.pop(name) for name in ("wall_temperature", "coil_frequency")}
    Torch(**{name.removeprefix("torch_"): value for name, value in torch.items()})
    settings = FLOW["start"] | FLOW["convergence"] | {"probe_temperature_k": 350}
    signature(flow.cold_start).bind(None, torch=torch, **others, **in_si(settings))
