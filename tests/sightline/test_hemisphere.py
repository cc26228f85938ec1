import numpy as np
import pytest
from scipy.special import expn

from plasmapyro.sightline.hemisphere import directions

FLOAT_RTOL = 1e-13  # ~500 eps
CORE = np.radians(4.5)


def mean(radiance, count, core_angle=CORE):
    angle, weight = directions(count, core_angle)
    return np.sum(weight * radiance(angle))


def test_an_isotropic_field_returns_itself():
    assert mean(lambda angle: 7.0 + 0 * angle, 5) == pytest.approx(7.0, rel=FLOAT_RTOL, abs=0)


def test_a_cap_counts_with_its_view_factor():
    # Modest, view factor of a disc seen from a point on its axis: sin^2 of the half angle.
    angle, weight = directions(8, CORE)
    assert weight[angle < CORE].sum() == pytest.approx(np.sin(CORE) ** 2, rel=1e-4)
    angle, weight = directions(12, np.radians(40))
    assert weight[angle < np.radians(40)].sum() == pytest.approx(np.sin(np.radians(40)) ** 2, rel=1e-9)


def test_a_thin_slab_gives_twice_its_normal_radiance():
    # Uniform layer of infinite extent: L = j d / cos(theta); the mean of 1/cos over the view factor is 2.
    assert mean(lambda angle: 1 / np.cos(angle), 8) == pytest.approx(2, rel=1e-4)


@pytest.mark.parametrize("depth", [0.01, 0.3, 2.0])
def test_a_slab_of_any_depth_gives_the_exponential_integral(depth):
    # Modest, plane-parallel media: source function times 1 - 2 E3(tau). The kink at grazing angles, as wide
    # as the slab is deep, limits the order.
    found = [mean(lambda angle: -np.expm1(-depth / np.cos(angle)), count) for count in (8, 32)]
    exact = 1 - 2 * expn(3, depth)
    assert found[0] == pytest.approx(exact, rel=1e-2)
    assert found[1] == pytest.approx(exact, rel=1e-3)


def test_a_smooth_field_converges_faster_than_any_power():
    # L = cos^2(theta): the integral of sin(2 theta) cos^2(theta) from 0 to pi/2 is 1/2.
    errors = [abs(mean(lambda angle: np.cos(angle) ** 2, count) - 0.5) for count in (6, 9, 12)]
    assert errors[1] < errors[0] / 20 and errors[2] < errors[1] / 20


def torch(angle):
    """Profile of a torch core: falls linearly to its edge, where it drops, and a faint tail beyond."""
    edge, rim = np.radians(4.2), np.radians(0.4)
    core = 1e4 * np.clip(1 - (angle / edge) ** 2, 0, None) / (1 + np.exp((angle - edge) / rim))
    return core + 0.5 / np.sin(np.clip(angle, np.radians(1), None))


def test_eight_directions_and_eight_suffice_for_a_torch_core():
    fine = np.linspace(0, np.pi / 2, 1_000_001)
    exact = np.trapezoid(torch(fine) * np.sin(2 * fine), fine)
    for core in (4.0, 4.5, 5.0):
        assert mean(torch, 8, np.radians(core)) == pytest.approx(exact, rel=0.01)
        assert mean(torch, 32, np.radians(core)) == pytest.approx(exact, rel=0.001)


@pytest.mark.parametrize("count", [3, 8.5])
def test_too_few_directions_are_refused(count):
    with pytest.raises(ValueError, match="directions must be a whole number >= 4; got"):
        directions(count, CORE)


@pytest.mark.parametrize("core", [0.0, 2.0, np.nan])
def test_a_core_angle_out_of_range_is_refused(core):
    with pytest.raises(ValueError, match=r"core_angle must lie in \[0.01, 60\] deg; got"):
        directions(8, core)
