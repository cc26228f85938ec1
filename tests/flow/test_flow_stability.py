"""Linear stability of round flows against published values, and a section of a computed flow."""

import numpy as np
import pytest
from jet_stability import BaseFlow, NotFound, Waves, grid
from scipy.optimize import brentq


def cold(points, outer, scale, speed, shear, reynolds):
    """Flow of constant properties, speed(r) and its slope."""
    g = grid(outer, scale, points)
    one, zero = np.ones_like(g.r), np.zeros_like(g.r)
    return BaseFlow(g, speed(g.r), shear(g.r), zero, one, zero, one, one / reynolds, zero, one / reynolds)


def test_pipe_flow_has_its_published_eigenvalue():
    """A. Meseguer, L. N. Trefethen, J. Comput. Phys. 186 (2003) 178: Re 3000, alpha 1, m 1."""
    pipe = cold(40, 1.0, 50.0, lambda r: 1 - r**2, lambda r: -2 * r, 3000.0)
    found = Waves(pipe, 1).mode(1.0, 0.91 - 0.04j)
    assert found.omega == pytest.approx(0.911465567623 - 0.041275644693j, abs=1e-10)


def far_jet(reynolds):
    return cold(50, 60.0, 3.0, lambda r: (1 + r**2) ** -2.0, lambda r: -4 * r * (1 + r**2) ** -3.0, reynolds)


def test_the_far_jet_turns_unstable_at_the_published_reynolds_number():
    """P. J. Morris, J. Fluid Mech. 77 (1976) 511: m = 1 at 37.64, there on a grid of finite differences."""

    def growth(reynolds):
        waves, start = Waves(far_jet(reynolds), 1), 0.104 - 0.0j
        return max(waves.mode(alpha, start).omega.imag for alpha in (0.44, 0.45, 0.46))

    assert brentq(growth, 30.0, 50.0, xtol=0.02) == pytest.approx(37.64, abs=0.15)


def test_the_far_jet_is_stable_to_axisymmetric_disturbances():
    """G. K. Batchelor, A. E. Gill, J. Fluid Mech. 14 (1962) 529: without friction only m = 1 can grow."""
    found = {m: Waves(far_jet(300.0), m).unstable(0.8, 0.3) for m in (0, 1, 2)}
    assert len(found[1]) == 1 and not found[0] and not found[2]
    # Its wave also grows in space, and faster friction takes it away.
    spatial = Waves(far_jet(300.0), 1).at_frequency(found[1][0].omega.real, found[1][0])
    assert spatial.omega.imag == pytest.approx(0.0, abs=1e-8) and spatial.alpha.imag < -0.05


def light_jet(density_ratio, steepness=8, reynolds=1e5):
    """Jet of Monkewitz and Sohn: speed and temperature 1 / (1 + (2^(r^2) - 1)^N), perfect gas."""
    g = grid(30.0, 1.2, 90)
    power = np.exp2(np.minimum(g.r**2, 40.0))
    speed = 1 / (1 + (power - 1) ** steepness)
    shear = -(speed**2) * steepness * (power - 1) ** (steepness - 1) * power * np.log(2) * 2 * g.r
    shear[g.r**2 > 40] = 0.0
    excess = 1 / density_ratio - 1
    temperature = 1 + excess * speed
    rho, one = 1 / (density_ratio * temperature), np.ones_like(g.r)
    return BaseFlow(
        g, speed, shear, excess * shear, rho, -1 / temperature, rho, one / reynolds, 0 * one, one / reynolds
    )


def test_a_light_jet_turns_absolutely_unstable_at_the_published_density():
    """P. A. Monkewitz, K. D. Sohn, AIAA J. 26 (1988) 911: 0.72, m = 0; with these profiles at N = 8."""
    rates = {}
    for ratio in (0.71, 0.73):
        waves = Waves(light_jet(ratio), 0)
        saddle = waves.saddle(waves.mode(0.88 - 1.70j, 1.31 - 0.0j))
        assert abs(saddle.group_velocity) < 1e-5
        assert waves.pinches(saddle, 1.5)
        rates[ratio] = saddle.omega.imag
    assert rates[0.71] > 0 > rates[0.73]


def test_a_guess_that_leads_nowhere_is_said():
    with pytest.raises(NotFound, match="no mode"):
        Waves(far_jet(300.0), 1).at_frequency(1e6, Waves(far_jet(300.0), 1).mode(0.8, 0.3))
