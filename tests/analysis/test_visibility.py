"""Visibility factors against cases solved by hand."""

import numpy as np
import pytest

from plasmapyro.analysis.visibility import temperature_at_visibility, visibility_factor

ROOT_RTOL = 1e-9  # brentq is asked for 1e-12 in T; exp and log add a few 1e-16 times c2/(lambda T) < 60


def wien(temperature):
    return 1e9 * np.exp(-14388.0 / temperature)


def test_equal_signals_are_half_visible():
    assert visibility_factor(2.0, 2.0) == 0.5
    assert visibility_factor([1.0, 3.0], 1.0) == pytest.approx([1 / 2, 3 / 4], rel=1e-15, abs=0)


def test_without_gas_everything_is_visible():
    assert visibility_factor(1e-30, 0.0) == 1


@pytest.mark.parametrize(("level", "emittance"), [(0.99, 0.85), (0.9, 0.85), (0.5, 0.1)])
def test_temperature_at_a_level_inverts_wien_by_hand(level, emittance):
    gas = 500.0
    by_hand = 14388.0 / np.log(1e9 * emittance * (1 - level) / (level * gas))
    found = temperature_at_visibility(level, wien, gas, emittance)
    assert found == pytest.approx(by_hand, rel=ROOT_RTOL)
    assert visibility_factor(emittance * wien(found), gas) == pytest.approx(level, rel=1e-8)


def test_level_outside_the_bracket_is_no_number():
    assert np.isnan(temperature_at_visibility(0.99, wien, 1e12, 0.85))


@pytest.mark.parametrize("level", [0.0, 1.0, np.nan])
def test_impossible_level_is_refused(level):
    with pytest.raises(ValueError, match="level must lie in"):
        temperature_at_visibility(level, wien, 1.0, 0.85)


def test_negative_gas_signal_is_refused():
    with pytest.raises(ValueError, match="gas_signal must be >= 0"):
        visibility_factor(1.0, -1.0)
