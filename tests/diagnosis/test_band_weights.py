import numpy as np
import pytest
from scipy.integrate import quad

from plasmapyro.diagnosis.fit.model import _parted
from plasmapyro.diagnosis.fit.observation import band_nodes, band_weights

WAVELENGTH = 1e-9 * np.arange(700.0, 1101.0, 0.5)
# Ends at 0.3, not at zero, as silicon does that is tabulated up to 1150 nm.
RESPONSE = np.interp(WAVELENGTH * 1e9, [700, 760, 1000, 1100], [0.0, 1.0, 0.8, 0.3])


def test_weights_are_the_integrals_of_a_response_over_the_nodes():
    edges, _ = band_nodes(WAVELENGTH)
    made = band_weights(edges, WAVELENGTH, RESPONSE)

    def response(nm):
        return np.interp(nm, WAVELENGTH * 1e9, RESPONSE, left=0.0, right=0.0)

    for node in (0, 5, 20, made.size - 4):
        low, high = 1e9 * edges[node : node + 2]
        kinks = [nm for nm in (700, 760, 1000, 1100) if low < nm < high] or None
        assert made[node] == pytest.approx(
            1e-9 * quad(response, low, high, points=kinks)[0], rel=1e-9, abs=1e-15
        )


def test_a_response_that_moves_changes_its_weights_without_jumps():
    """A fit takes the slope over a thousandth of a nanometre: a jump of the sum would look like knowledge."""
    edges, centres = band_nodes(WAVELENGTH)
    shift = np.arange(-1.0, 1.0, 1e-3)
    light = np.exp(centres / 200e-9)  # a black body of 1500 K, about
    signal = np.array([band_weights(edges, WAVELENGTH + 1e-9 * one, RESPONSE) @ light for one in shift])
    slope = np.diff(np.log(signal)) / 1e-3
    assert np.abs(np.diff(slope)).max() < 0.02 * np.median(slope)  # a jump of half a nanometre: 100 times it


@pytest.mark.parametrize("by", [-12.0, 7.0])
def test_a_filter_moves_its_flank_and_leaves_the_fall_of_the_detector(by):
    """A filter that rises from 740 to 780 nm before a detector that falls from 900 nm on, 0.5 nm apart."""
    nm = WAVELENGTH * 1e9

    def product(moved):
        return np.interp(nm - moved, [740, 780], [0, 1]) * np.interp(nm, [900, 1100], [1, 0.1])

    other = _parted(WAVELENGTH, product(0.0), -by * 1e-9)  # whose axis moves as a whole by as much
    seen = np.interp(nm, nm + by, other, left=np.nan, right=np.nan)
    inside = np.isfinite(seen)
    np.testing.assert_allclose(seen[inside], product(by)[inside], atol=1e-12)
