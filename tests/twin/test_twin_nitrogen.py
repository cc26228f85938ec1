"""The first positive system of N2 in the twin, against sums over levels and the statistics of a rotor."""

import numpy as np
import pytest
from scipy.constants import c, h, k
from twin import lines, nitrogen

CENTRES = np.arange(716e-9, 1156e-9, 0.05e-9)


def only(level, temperature):
    """Population of one vibrational level in rotational equilibrium."""
    energy = lines.NITROGEN_VIBRATION[level]
    return lambda vibration, rotation: np.where(
        np.abs(vibration - energy) < 1, np.exp(-h * c * 100 * rotation / (k * temperature)), 0.0
    )


@pytest.mark.parametrize("temperature", [2000.0, 4000.0])
def test_a_band_reaches_to_the_violet_as_far_as_the_rotation_is_hot(temperature):
    """The mean rotational energy of a linear rotor is kT; the lower state has 0.89 of the constant B."""
    light = nitrogen.bands(CENTRES, only(0, temperature))
    place = np.sum(light * 1e-2 / CENTRES) / light.sum()  # [cm-1] of the 0-0 band
    upper = nitrogen.UPPER[0] - nitrogen.UPPER[1] / 2
    lower = nitrogen.LOWER[0] - nitrogen.LOWER[1] / 2
    expected = (1 - lower / upper) * k * temperature / (100 * h * c)
    # The mean over P, Q and R branches lies 2 B'' / 3 lower; a cm-1 is 1 %.
    assert place - 1e7 / (1046.6 * 1.00027) == pytest.approx(expected, rel=0.05)


def test_the_tail_of_the_origin_band_follows_its_own_level():
    """Between 990 and 1040 nm shines v' = 0 of the 0-0 band; hotter vibration takes from it."""
    warm = nitrogen.change(CENTRES, 6000.0, nitrogen.vibrational(6000.0, 1.1))
    level = np.array(lines.NITROGEN_VIBRATION, dtype=float) - lines.NITROGEN_VIBRATION[0]
    share = [np.exp(-h * c * 100 * level / (k * kelvin)).sum() for kelvin in (6000.0, 6600.0)]
    head = (CENTRES > 1045e-9) & (CENTRES < 1048e-9)
    assert warm[head].mean() == pytest.approx(share[0] / share[1], rel=0.03)
    tail = (CENTRES > 1000e-9) & (CENTRES < 1040e-9)
    assert np.all(warm[tail] < 1) and warm[tail].mean() > warm[head].mean()


def test_other_vibration_keeps_the_number_of_molecules():
    factor = nitrogen.vibrational(5000.0, 0.8)
    level = np.array(lines.NITROGEN_VIBRATION, dtype=float)
    now = np.exp(-h * c * 100 * (level - level[0]) / (k * 5000.0))
    assert np.sum(now * factor(level, 0.0)) == pytest.approx(now.sum(), rel=1e-6)


def test_a_hotter_gas_shifts_the_light_by_the_ratio_of_boltzmann_factors():
    """With all levels at 6600 instead of 6000 K, v' = 0 without rotation gains nothing, all else does."""

    def heated(vibration, rotation):
        energy = vibration - lines.NITROGEN_VIBRATION[0] + rotation
        return np.exp(h * c * 100 * energy / k * (1 / 6000.0 - 1 / 6600.0))

    hot = nitrogen.change(CENTRES, 6000.0, heated)
    assert np.all(hot > 0.99)
    seen = [hot[np.argmin(np.abs(CENTRES - nm * 1e-9))] for nm in (1047.0, 1020.0, 755.0)]
    assert seen[0] < seen[1] < seen[2]
