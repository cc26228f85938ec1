"""The step response against the differential equation that it solves."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from plasmapyro.analysis.transient import step_response


def test_solves_the_critically_damped_oscillator():
    start, gain, omega = 350.0, 1250.0, 0.1

    def oscillator(_, state):
        position, speed = state
        return [speed, omega**2 * (start + gain - position) - 2 * omega * speed]

    time = np.linspace(0.0, 100.0, 21)
    solution = solve_ivp(oscillator, (0, 100), [start, 0.0], t_eval=time, rtol=1e-10, atol=1e-8)
    assert step_response(time, start, gain, omega) == pytest.approx(solution.y[0], rel=1e-7)


def test_waits_for_the_injection_and_reaches_the_paper_s_steady_state():
    assert step_response(-5.0, 350.0, 1250.0, 0.1) == 350.0
    assert step_response(80.0, 350.0, 1250.0, 0.1) == pytest.approx(
        1600.0, abs=4.0
    )  # 9 e^-8 * 1250 K = 3.8 K


def test_impossible_frequency_is_refused():
    with pytest.raises(ValueError, match="natural_frequency must be > 0"):
        step_response(1.0, 350.0, 1250.0, 0.0)
