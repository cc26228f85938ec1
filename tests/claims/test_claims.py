"""Verdicts say what the numbers say; measurements of claims on curves known by construction."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.claims import analysis, experiment, flow
from plasmapyro.claims.claim import Claim
from plasmapyro.claims.stage import as_markdown


def claim(value, low, high, **more):
    return Claim("key", "1", "words", value, "K", low, high, **more)


@pytest.mark.parametrize(
    ("value", "verdict"),
    [
        (100.0, "reproduced"),
        (90.0, "reproduced"),
        (125.0, "differs by +25 K"),
        (80.0, "differs by -10 K"),
        (np.nan, "no value here"),
    ],
)
def test_verdict_follows_from_the_range(value, verdict):
    assert claim(value, 90, 100).verdict == verdict


def test_synthetic_and_untestable_claims_say_so():
    assert claim(95.0, 90, 100, basis="synthetic").verdict == "reproduced (synthetic data)"
    assert claim(120.0, 90, 100, basis="synthetic").verdict == "differs by +20 K (synthetic data)"
    assert claim(95.0, 90, 100, basis="untestable").verdict == "not testable here"


def triangular_path():
    """Temperature up to 1350 K over 4 mm, then down to 350 K over 100 mm, then flat."""
    path = np.array([0.0, 4e-3, 0.104, 0.3, 1.0])
    return xr.Dataset(
        {
            "temperature": ("path_distance", [350.0, 1350.0, 350.0, 350.0, 300.0]),
            "pressure": ("path_distance", [5050.0, 5000.0, 5000.0, 5000.0, 1e5]),
        },
        {"path_distance": path},
        {"exit_distance": 0.279},
    )


def test_flow_claims_read_the_path():
    found = {claim.key: claim.value for claim in flow.flow_claims([triangular_path()] * 2, [5e4, 6e4])}
    assert found["boundary_layer"] == pytest.approx(4 * (0.9 * 1350 - 350) / 1000, rel=1e-12)
    assert found["core_extent"] == pytest.approx(4 + 95.0, rel=1e-12)
    assert found["core_temperature_highest_power"] == 1350.0
    assert found["cold_outside"] == 350.0
    assert found["domain_exit"] == pytest.approx(279.0)
    assert found["pressure_uniform"] == pytest.approx(1.0)


def test_power_is_read_off_the_error_curves():
    temperature = np.array([1000.0, 1350.0, 1700.0])
    power = np.array([60e3, 80e3, 100e3])
    error = 1e-3 * np.exp(power / 20e3)[:, None] * np.ones(3)
    reading = xr.Dataset(
        {
            "relative_error": (("condition", "object_temperature"), error),
            "numerical_power": ("condition", power),
        },
        {"object_temperature": temperature},
    )
    claims = {one.key: one.value for one in analysis.threshold_claims(reading)}
    assert claims["power_from_error_at_1120K"] == pytest.approx(20 * np.log(100), rel=1e-9)
    assert np.isnan(claims["power_from_error_at_1600K"])  # 0.2 % is below all powers computed


def test_thresholds_of_a_test_are_read_off_its_noise():
    temperature = np.repeat(np.arange(1000.0, 1600.0), 5)
    error = 0.01 * 10 ** ((1350 - temperature) / 200) * (1 + 0.2 * np.sin(np.arange(temperature.size)))
    found = experiment._highest_with_error_above(temperature, error, 0.01)
    assert found == pytest.approx(1350, abs=20)


def test_markdown_counts_its_verdicts():
    names = ("section", "statement", "unit", "printed", "verdict", "remark", "basis")
    rows = [claim(95.0, 90, 100), claim(125.0, 90, 100), claim(np.nan, 1, 2, basis="untestable")]
    table = xr.Dataset(
        {name: ("claim", [getattr(row, name) for row in rows]) for name in names}
        | {"value": ("claim", [row.value for row in rows])}
    )
    text = as_markdown(table)
    assert "3 claims: 1 reproduced, 1 differs, 0 no value here, 1 not testable here." in text
    assert "| 1 | words | 90 to 100 K | 125 K | differs by +25 K |" in text
