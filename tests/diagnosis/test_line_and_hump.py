"""Which explanation a spectrum of the gas is nearest to, and the tracks of lines against hump."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.gas.library import gas_library
from plasmapyro.diagnosis.report import line_hump, show

MATT_LINE, MATT_HUMP = 113.0, 57.0  # of a matt surface over the sight line, as at 60 kW
ERRORS = (0.03, 0.03)


@pytest.fixture(scope="module")
def library(radiation, variations, axis):
    changed = variations.copy(deep=True)
    total = radiation["80kW"].gas_radiance_slit.values
    matt = np.where(np.abs(axis - 777.6e-9) < 3e-9, MATT_LINE, MATT_HUMP) * total
    changed["added_radiance"].loc["reflected_diffuse"] = matt
    return gas_library("80kW", radiation, changed, fwhm=1.0e-9)


def closest(library, spectrum, **settings):
    explanations = line_hump.explanations(library, 0.85)
    return line_hump.line_hump(library, (spectrum, ERRORS), explanations, **settings)["closest"]


@pytest.mark.parametrize("share", [0.012, 0.025, 0.04, 0.08])
def test_a_little_matt_light_is_a_reflection(library, share):
    """Line and hump rise by 1.7 and 0.85 % per thousandth: the track bends long before a fifth."""
    spectrum = library.base + 0.15 * share * library.addition["reflected_diffuse"]
    assert closest(library, spectrum) == "refl"


def test_matt_track_is_nowhere_far_from_its_curve(library):
    name, amplitudes, change = line_hump.explanations(library, 0.85)["refl_diffuse"]
    near = np.abs(library.wavelength - 777.6e-9) < line_hump.LINE_REACH
    hump = (library.wavelength > line_hump.HUMP[0]) & (library.wavelength < line_hump.HUMP[1])
    points = np.log(
        [
            [change(a)[part].sum() / library.base[part].sum() for part in (near, hump)]
            for a in sorted([*amplitudes, *np.geomspace(1e-3, 1, 60)])
        ]
    )
    track = np.log(
        [[change(a)[part].sum() / library.base[part].sum() for part in (near, hump)] for a in amplitudes]
    )
    # Linear between nodes, in logarithms; 1 % is well below any error of a strength.
    assert np.abs(np.interp(points[:, 0], track[:, 0], track[:, 1]) - points[:, 1]).max() < 0.01
    assert "matt" in name


@pytest.mark.parametrize("more", [-0.2, 0.2, 0.4])
def test_more_of_the_same_light_is_a_path_though_a_mirror_gives_it_too(library, more):
    assert closest(library, (1 + more) * library.base) == "path"
    assert closest(library, (1 + more) * library.base, calibration=True) == "calibration"


@pytest.mark.parametrize("power", [-0.06, 0.0, 0.06])
def test_gas_within_its_priors_needs_no_explanation(library, power):
    """The power is known to 8 %: line and hump move by 40 and 6 % here, and nothing is explained by it."""
    assert closest(library, library.base * library.power_factor(power)) == "none"


@pytest.mark.parametrize("power", [-0.06, 0.06])
def test_a_grey_factor_is_a_path_whatever_the_power_within_its_prior(library, power):
    spectrum = 1.4 * library.base * library.power_factor(power)
    assert closest(library, spectrum) == "path"


@pytest.mark.parametrize("power", [-0.4, 0.4])
def test_much_more_or_less_power_is_power(library, power):
    assert closest(library, library.base * library.power_factor(power)) == "P_eff"


def test_a_gas_without_the_line_has_errors_that_can_be_drawn(library):
    """A foreign gas may lack O I 777 nm: what is fitted there is noise, and may be below zero."""
    lacking = np.where(np.abs(library.wavelength - 777.6e-9) < 5e-9, -0.01, 1.0) * library.base
    found = line_hump.line_hump(library, (lacking, ERRORS), line_hump.explanations(library, 0.85))
    assert found["measured"]["line"] < 0 < found["measured"]["line_error"]
    assert found["closest"]


def test_the_step_is_told_only_where_there_is_gas():
    """A foreign gas may be absent from a channel: what is fitted there may be below zero, an error never."""
    time = np.array([-2.0, -1.0, 1.0])
    gas = np.array([[2.0, -0.1], [2.0, -0.1], [0.0, 0.0]])
    one = SimpleNamespace(time=time, value=gas, band=None, middle=np.array([8e-7, 9e-7]))
    noise, solution = SimpleNamespace(variance=np.ones((3, 2))), SimpleNamespace(gas=[gas], prediction=[gas])
    step = show.kappa(SimpleNamespace(instruments=[one], off=0.0), SimpleNamespace(noise=[noise]), solution)
    assert step["kappa"] == [pytest.approx(1.0), None] and step["error"][0] > 0 and step["error"][1] is None
