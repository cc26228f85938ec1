"""Species of spectra that we made ourselves, and of spectra that hold none."""

import made_spectra as made
import numpy as np
import pytest

from plasmapyro.identification.identify import identify
from plasmapyro.identification.peaks import find

SURE = 0.9


def names(answer):
    return {one.species.element for one in answer.named if one.probability >= SURE}


@pytest.mark.parametrize(
    ("lines", "elements"),
    [
        (made.SODIUM + made.POTASSIUM, {"Na", "K"}),
        (made.LITHIUM, {"Li"}),
        (made.COPPER, {"Cu"}),
        (made.CALCIUM + made.OXYGEN, {"Ca", "O"}),
    ],
    ids=["sodium and potassium", "lithium", "copper", "calcium in air"],
)
@pytest.mark.parametrize("offset", [0.0, 0.2], ids=["", "scale 0.2 nm off"])
def test_elements_are_named_and_no_others(lines, elements, offset):
    answer = identify(*made.spectrum(lines, offset=offset))
    assert names(answer) == elements
    # a sixth of the width of 0.3 nm: between lines the scale leans on its mean
    assert float(answer.scale(620e-9)) == pytest.approx(offset * 1e-9, abs=0.05e-9)


def test_a_little_of_another_element_is_found_beside_much_of_one():
    faint = [(place, 0.05 * strength) for place, strength in made.COPPER]
    assert names(identify(*made.spectrum(made.CALCIUM + faint, peak=2e4))) == {"Ca", "Cu"}


def test_a_line_that_must_be_there_and_is_not_speaks_against_a_species():
    def evidence(lines):
        found = identify(*made.spectrum(made.CALCIUM + lines))
        return {one.species.name: one.fit.log_bayes for one in found.named}.get("K I", 0.0)

    whole = evidence([(766.490, 300), (769.896, 160)])
    assert whole > 4
    assert evidence([(769.896, 160)]) < whole - 4  # the stronger line of the two is missing


@pytest.mark.parametrize("seed", range(3))
def test_lines_at_random_have_no_name(seed):
    rng = np.random.default_rng(seed)
    lines = list(zip(rng.uniform(320, 940, 15), rng.uniform(100, 1000, 15), strict=True))
    answer = identify(*made.spectrum(lines, seed))
    assert names(answer) == set()
    assert answer.unexplained.size >= 12


def test_noise_has_no_name():
    axis, counts = made.spectrum([(600.0, 1e-9)], peak=0.0)
    assert names(identify(axis, counts)) == set()


def test_a_pattern_of_odd_and_even_pixels_hides_no_line():
    """Converters that read odd and even pixels apart: an alternation three times the noise."""
    axis = np.arange(300.0, 900.0, 0.1) * 1e-9
    line = 150 * np.exp(-(((axis - 600e-9) / 0.2e-9) ** 2))
    counts = np.random.default_rng(1).poisson(300 + line) + 60.0 * (-1) ** np.arange(axis.size)
    found = find(axis, counts)
    assert np.abs(found.wavelength - 600e-9).min() < 0.05e-9
    assert found.wavelength.size < 0.005 * axis.size  # the others are noise


def test_a_flat_record_is_refused():
    axis = np.linspace(400e-9, 800e-9, 500)
    with pytest.raises(ValueError, match="flat"):
        identify(axis, np.full(500, 7.0))


def test_bands_are_named_by_their_heads():
    """C2 Swan as tails behind its heads (R. W. B. Pearse & A. G. Gaydon, 1976), degraded to the violet."""
    heads = [(516.52, 1.0), (512.93, 0.5), (473.71, 0.6), (471.52, 0.55), (469.76, 0.35), (563.55, 0.4)]
    heads += [(558.55, 0.35), (554.07, 0.2)]
    axis = np.arange(430.0, 620.0, 0.1)
    light = np.zeros(axis.size)
    for head, strength in heads:
        behind = head - axis
        light += strength * np.where(behind > 0, np.exp(-behind / 1.5), np.exp(-((behind / 0.15) ** 2)))
    counts = np.random.default_rng(3).poisson(4000 * light + 300).astype(float)
    assert "C2" in names(identify(axis * 1e-9, counts))
