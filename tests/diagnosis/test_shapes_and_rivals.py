"""Bins of single pixels, terms that act by their square, and names beside unknown structures."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm

from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit.observation import as_through
from plasmapyro.diagnosis.fit.setting import TAILS, WIDE, Setting, free_numbers, log_prior, numbers_of
from plasmapyro.diagnosis.gas.templates import line_groups
from plasmapyro.diagnosis.select.screen import Candidate, Screen
from plasmapyro.diagnosis.select.search import at_end
from plasmapyro.diagnosis.select.structures import Structure
from plasmapyro.diagnosis.select.unknowns import SCALES, Unknowns
from plasmapyro.radiation.slit import FWHM_PER_SIGMA
from plasmapyro.record.binning import pixel_edges

ALGEBRA = 1e-8  # relative, of two ways to the same number


def test_a_pixel_as_wide_as_the_slit_may_be_a_bin_of_its_own_at_a_line():
    wavelength = np.linspace(750e-9, 850e-9, 129)
    gas = 1 + 50 * np.exp(-(((wavelength - 800.3e-9) / 0.4e-9) ** 2))
    size = np.diff(pixel_edges(wavelength, gas, 0.75e-9))
    edges = pixel_edges(wavelength, gas, 0.75e-9)
    at_line = np.searchsorted(edges, np.argmax(gas), side="right") - 1
    assert (size[at_line - 2 : at_line + 3] == 1).any()
    assert size[3] > 1  # away from the line pixels are joined


def test_a_finer_spectrum_becomes_that_of_the_coarser_slit():
    """Lines between the pixels, seen through 0.35 nm, against the formula for 0.75 nm."""
    pixels = np.linspace(770e-9, 790e-9, 401)
    lines = np.array([775.03e-9, 777.41e-9, 777.63e-9, 785.0e-9])

    def seen(fwhm):
        return norm.pdf(pixels[:, None], lines, fwhm / FWHM_PER_SIGMA).sum(axis=1)

    fine = np.stack([seen(0.35e-9), 2 * seen(0.35e-9)])
    fine[0, 240] = np.nan  # no line there
    full = np.zeros(fine.shape, dtype=bool)
    full[1, 240] = True
    found, reached = as_through(0.75e-9, 0.35e-9, pixels, fine, full)
    inner = np.isfinite(found).all(axis=0)
    assert not inner[[0, -1]].any() and inner[40:-40].all()
    expected = np.stack([seen(0.75e-9), 2 * seen(0.75e-9)])[:, inner]
    assert found[:, inner] == pytest.approx(expected, abs=0.006 * expected.max())  # reach of three sigma
    assert not reached[0].any() and 21 <= reached[1].sum() <= 41 and reached[1, 240]
    same, untouched = as_through(0.75e-9, 0.75e-9, pixels, fine, full)
    assert same is fine and untouched is full


def test_an_amplitude_far_beyond_what_is_usual_is_dear_but_not_ruled_out():
    """The prior is the mean of normals, against its definition, over the normal of the fit."""
    effect = CATALOGUE["CaII"]
    free = free_numbers((Setting(effect, 24.0, {}),))[:1]
    density = np.mean([norm.pdf(24.0, 0, k * effect.sigma) for k in TAILS])
    in_fit = np.exp(-0.5 * (24.0 / (WIDE * effect.sigma)) ** 2)
    assert log_prior(free, [24.0]) == pytest.approx(np.log(np.sqrt(2 * np.pi) * density / in_fit))
    assert log_prior(free, [24.0]) > norm.logpdf(24.0, 0, effect.sigma) + 200


def test_what_is_measured_finer_is_no_less_likely_than_what_is_as_significant():
    """Of two offsets, each 12 of its standard deviations, one is measured 30 times finer: the density of
    amplitudes goes with 1/a over what effects are usually as large as, so that no unit decides."""
    effect = CATALOGUE["off1"]
    free = free_numbers((Setting(effect, 0.0, {}),))[:1]
    amplitude = effect.sigma * np.geomspace(0.02, 20.0, 40)
    of_fit = 0.5 * (amplitude / (WIDE * effect.sigma)) ** 2
    evidence = [log_prior(free, [a]) for a in amplitude] - of_fit + np.log(amplitude / 12.0)
    assert np.ptp(evidence) < 0.8  # a mean of eight normals is no straight line


@pytest.mark.parametrize(
    ("identity", "amplitude", "ends"),
    [
        ("refl", 3.0, True),
        ("refl", 2.9, False),
        ("refl", 0.0, False),
        ("Cu", 0.3, False),  # much copper, in a range up to 500
        ("winD", -0.2, True),
        ("winD", -0.19, False),
    ],
)
def test_an_amplitude_at_the_end_of_its_range_measures_nothing(identity, amplitude, ends):
    one = CATALOGUE[identity]
    settings = (Setting(CATALOGUE["winE"], 0.1, {}), Setting(one, amplitude, dict(one.shapes[0])))
    state = SimpleNamespace(amplitudes=numbers_of(settings))
    assert at_end(SimpleNamespace(settings=settings, state=state)) is ends


@pytest.mark.parametrize(("identity", "tolerance"), [("grad", 0.02), ("lsf", 0.12), ("ripple", 0.4)])
def test_a_term_that_acts_by_its_square_is_found_near_its_amplitude(model, identity, tolerance):
    """The secant over the prior is the start of a fit at half of it; higher powers are left."""
    effect = CATALOGUE[identity]
    knots = np.interp(model.history.knots, [0, 20, 120, 150], [350, 1200, 1500, 1150])
    values = np.array([p.centre for p in model.parameters])
    half = 0.5 * effect.step

    def change(amplitude):
        plain = model.evaluate(1, knots, values)
        return (
            model.evaluate(1, knots, values, (Setting(effect, amplitude, dict(effect.shapes[-1])),)) - plain
        )

    column = change(effect.step) / effect.step
    linear = np.sum(column * change(half)) / np.sum(column**2)
    assert effect.amplitude_of(linear) == pytest.approx(half, rel=tolerance)
    assert effect.linear_of(effect.amplitude_of(linear)) == pytest.approx(linear, rel=1e-12)


@pytest.mark.parametrize("single", [False, True])
def test_the_gain_beside_a_structure_is_that_of_least_squares_with_its_covariance(single):
    random = np.random.default_rng(3)
    rows = random.normal(size=(30, 5)) * np.array([3.0, 2.0, 40.0, 40.0, 40.0])
    data = rows[:, 0] + rows[:, 2] * 0.3 + random.normal(size=30)
    structure = Structure("pattern", "three", slice(0, 3), single)
    found = Screen(
        (Candidate(CATALOGUE["winE"], {}), Candidate(CATALOGUE["phi"], {})),
        (structure,),
        rows.T @ data,
        rows.T @ rows,
        np.ones(5),
        None,
    )
    gains = Unknowns(found).gains_beside(found, 0)
    best = -np.inf
    for scale in SCALES:
        for chosen in [[2], [3], [4]] if single else [[2, 3, 4]]:
            covariance = np.eye(30) + scale**2 * rows[:, chosen] @ rows[:, chosen].T
            inverse = np.linalg.inv(covariance)
            evidence = -0.5 * data @ inverse @ data - 0.5 * np.linalg.slogdet(covariance)[1]
            if evidence > best:
                best = evidence
                expected = [(row @ inverse @ data) ** 2 / (row @ inverse @ row) for row in rows[:, :2].T]
    assert np.allclose(gains, expected, rtol=ALGEBRA)


def test_fringes_are_found_as_one_combination_of_the_channels():
    """A fringe of 12 standard deviations spread over 60 channels, none of which shows it alone."""
    x = np.linspace(0, 1, 60)
    fringe = np.sin(2 * np.pi * 9 * x + 0.4)
    fringe *= 12 / np.linalg.norm(fringe)
    angle = 2 * np.pi * x[:, None, None] * np.arange(4, 25)[:, None] + np.arange(3) * np.pi / 3
    basis = np.sin(angle).reshape(60, -1)
    classes = (
        Structure("one_pattern", "one", slice(0, 60), True),
        Structure("fringe_pattern", "fringes", slice(0, 60), True, basis),
    )
    scale = 100.0  # of the data per unit of a channel
    found = Screen((), classes, scale * fringe, scale**2 * np.eye(60), np.ones(60), None)
    one, many = Unknowns(found)(found.score)
    assert one < 2 and many > 40


def test_two_multiplets_with_darkness_between_them_err_by_themselves():
    axis = np.linspace(850e-9, 880e-9, 3001)
    light = sum(
        a * np.exp(-(((axis - c) / 0.45e-9) ** 2))
        for c, a in ((862.0e-9, 1), (862.9e-9, 2), (868.3e-9, 6), (870.5e-9, 2))
    )
    names, rows = line_groups(axis, ["N I"], light[None])
    assert np.allclose(rows.sum(axis=0), light)
    strong = [row for row in rows if row.sum() > 0.1 * light.sum()]
    assert len(strong) == 2
    assert axis[strong[0] > 0].max() < 867e-9 and axis[strong[1] > 0].min() > 864e-9
