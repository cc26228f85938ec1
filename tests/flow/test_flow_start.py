"""One steady flow whatever the start: a condition from below, from above and from cold."""

import numpy as np
import pytest

from plasmapyro.flow.stage import cold_start, condition

MESH = 3.0  # 2 500 triangles
TOLERANCES = {"velocity_tolerance": 0.2, "temperature_tolerance": 2e-3, "largest_step_count": 80}
# The last change of Newton's method is at most 0.2 m/s and 2e-3 of T; its error is far smaller.
VELOCITY_TOLERANCE, TEMPERATURE_TOLERANCE = 0.2, 2e-3
COMMON = {
    "chamber_pressure": 5e3,
    "mass_flow_rate": 0.016,
    "coil_frequency": 4e5,
    "probe_temperature": 350.0,
    "viscosity_limiter": 0.02,
    **TOLERANCES,
}


def reached_from(air, start, power):
    return condition(
        air,
        start,
        numerical_power=power,
        swirl_angle=0.0,
        radiation_factor=0.0,
        power_step=1e4,
        error_mesh_ratio=0.0,
        **COMMON,
    )


@pytest.fixture(scope="module")
def cold(air, torch_lengths):
    """Function power -> cold start."""
    return lambda power: cold_start(
        air,
        numerical_power=power,
        wall_temperature=350.0,
        mesh_factor=MESH,
        start_mesh_factor=MESH,
        torch=torch_lengths,
        **COMMON,
    )


def test_a_flow_does_not_depend_on_where_it_was_started(air, cold):
    start = cold(90e3)
    from_above = reached_from(air, start, 85e3)
    below = reached_from(air, start, 80e3)
    from_below = reached_from(air, below, 85e3)
    for other in (from_below, cold(85e3)):
        assert np.abs(np.log(other.temperature / from_above.temperature)).max() < TEMPERATURE_TOLERANCE
        for name in ("axial_velocity", "radial_velocity"):
            assert np.abs(other[name] - from_above[name]).max() < VELOCITY_TOLERANCE
        assert float(other.coil_current) == pytest.approx(float(from_above.coil_current), rel=1e-4)
    # Not because nothing changes: 5 kW are 7 % of the axial velocity somewhere.
    assert np.abs(start.axial_velocity - from_above.axial_velocity).max() > 10 * VELOCITY_TOLERANCE
