"""Species of spectra that we made ourselves, and of spectra that hold none."""

from pathlib import Path

import made_spectra as made
import numpy as np
import pytest

from plasmapyro.identification import identify as module
from plasmapyro.identification.identify import CLEAR, identify
from plasmapyro.identification.peaks import find, one_detector
from plasmapyro.readers.spectrum import read_frames

EXAMPLE = Path(__file__).parents[2] / "docs/example/my_test"
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


@pytest.mark.parametrize(
    ("element", "lines"),
    [("Ne", made.NEON), ("Kr", made.KRYPTON), ("Xe", made.XENON), ("Cl", made.CHLORINE)],
)
def test_a_lamp_without_a_common_element_tells_its_own_scale(element, lines):
    """Half a line's width off, nothing but the lamp's own lines says so."""
    assert names(identify(*made.spectrum(lines, offset=0.15))) == {element}


def test_a_little_of_another_element_is_found_beside_much_of_one():
    faint = [(place, 0.05 * strength) for place, strength in made.COPPER]
    assert names(identify(*made.spectrum(made.CALCIUM + faint, peak=2e4))) == {"Ca", "Cu"}


@pytest.mark.parametrize(
    ("lines", "share", "element"), [(made.COPPER, 0.012, "Cu"), (made.LITHIUM, 0.02, "Li")]
)
def test_what_is_likely_and_not_certain_is_listed_with_its_probability(lines, share, element):
    faint = [(place, share * strength) for place, strength in lines]
    answer = identify(*made.spectrum(made.CALCIUM + faint, peak=2e4))
    listed = {one.species.element: one.probability for one in answer.named}
    assert set(listed) == {"Ca", element}
    assert 0.5 < listed[element] < SURE < listed["Ca"]
    assert answer.unexplained.size == 0


def test_a_line_that_must_be_there_and_is_not_speaks_against_a_species():
    def evidence(lines):
        found = identify(*made.spectrum(made.CALCIUM + lines))
        return {one.species.name: one.fit.log_bayes for one in found.named}.get("K I", 0.0)

    whole = evidence([(766.490, 300), (769.896, 160)])
    assert whole > 4
    assert evidence([(769.896, 160)]) < whole - 4  # the stronger line of the two is missing


@pytest.mark.filterwarnings("error")
def test_a_plateau_of_a_full_converter_is_no_peak_and_no_warning():
    """Wider than what peaks are held against it has no prominence, of which scipy warned."""
    axis, counts = made.spectrum(made.CALCIUM)
    full = np.minimum(counts + 5e4 * np.exp(-(((axis * 1e9 - 750) / 5) ** 2)), 2e4)
    assert (full == 2e4).sum() > 60
    answer = identify(axis, full)
    assert names(answer) == {"Ca"}
    assert not np.any(np.abs(answer.peaks.wavelength * 1e9 - 750) < 4)


@pytest.mark.parametrize("seed", range(3))
def test_lines_at_random_have_no_name(seed):
    rng = np.random.default_rng(seed)
    lines = list(zip(rng.uniform(320, 940, 15), rng.uniform(100, 1000, 15), strict=True))
    answer = identify(*made.spectrum(lines, seed))
    assert names(answer) == set()
    assert answer.unexplained.size >= 12


@pytest.mark.parametrize("seed", [4, 26, 30, 54])
def test_chance_is_as_frequent_as_it_is(seed):
    """Of sixty such spectra three have a name, seven if chance has a `SPREAD` of 0.02 and common species
    0.1: these four too, of 9 to 33 lines."""
    rng = np.random.default_rng(9100 + seed)
    number = rng.integers(5, 60)
    lines = list(zip(rng.uniform(320, 940, number), 10 ** rng.uniform(1.5, 3, number), strict=True))
    assert names(identify(*made.spectrum(lines, seed))) == set()


def test_chance_counts_against_much_evidence_too(monkeypatch):
    """Thorium II came to 12.2 by eleven faint peaks among noise; sodium has 29 here, and chance as much."""
    spectrum = made.spectrum(made.SODIUM)
    assert names(identify(*spectrum)) == {"Na"}
    monkeypatch.setattr(module, "_by_chance", lambda scene, one, others: 29.0)
    assert names(identify(*spectrum)) == set()


def test_noise_has_no_name():
    axis, counts = made.spectrum([(600.0, 1e-9)], peak=0.0)
    answer = identify(axis, counts)
    assert names(answer) == set()
    assert answer.peaks.snr.min() < CLEAR < answer.peaks.snr[answer.unexplained].min(initial=np.inf)


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


def lines_at(axis, places, fwhm):
    """Sum of lines of a full width [nm] at places [nm], of the same area each."""
    return sum(np.exp(-4 * np.log(2) * ((axis - place) / fwhm) ** 2) / fwhm for place in places)


@pytest.mark.parametrize("faint", [0.3, 0.0])
def test_a_line_on_the_flank_of_another_is_found_and_none_on_a_slope(faint):
    axis = np.arange(560.0, 620.0, 0.1)
    light = 4e3 * lines_at(axis, (575.03, 589.0, 603.0), 0.4) + faint * 4e3 * lines_at(axis, [589.55], 0.4)
    counts = np.random.default_rng(5).poisson(light + 200 + 100 * (axis - 560)).astype(float)
    expected = [575.03, 589.0, 589.55, 603.0] if faint else [575.03, 589.0, 603.0]
    assert find(axis * 1e-9, counts).wavelength * 1e9 == pytest.approx(expected, abs=0.1)  # a channel


def test_a_neighbour_makes_a_line_no_wider():
    """Its fainter neighbour lies above half of it; the light of each is that of a line of that height."""
    axis = np.arange(560.0, 620.0, 0.1)
    light = 4e4 * lines_at(axis, (570.03, 589.0, 609.0), 0.5) + 3.6e4 * lines_at(axis, [589.6], 0.5)
    found = find(axis * 1e-9, light + np.random.default_rng(5).normal(200, 20, axis.size))
    alone, beside = (np.abs(found.wavelength - place).argmin() for place in (570.03e-9, 589e-9))
    assert found.width[beside] == pytest.approx(found.width[alone], rel=0.3)
    assert found.light[beside] == pytest.approx(found.light[alone], rel=0.3)


@pytest.mark.parametrize("seed", range(3))
def test_noise_stands_out_of_its_mean_not_of_the_lowest_around(seed):
    """Of the highest 8000 values of noise ten lie five deviations above the lowest beside them; fainter peaks
    than five are not believed."""
    axis = np.linspace(300e-9, 900e-9, 8000)
    noise = np.random.default_rng(seed).normal(100, 1, axis.size)
    assert np.sum(find(axis, noise).snr > CLEAR) <= 3


OVERLAP = (445.0, 449.03, 453.1, 457.05, 461.0, 465.02)  # [nm], lines that two detectors see


def overlapping():
    """Axis [m] and counts of two detectors, a fine and a coarse slit, that interleave from 440 to 470 nm."""
    rng = np.random.default_rng(1)
    both = ((np.arange(400.0, 470.0, 0.06), 0.25), (np.arange(440.0, 560.0, 0.145), 0.5))
    places = (410.0, 430.0, *OVERLAP, 500.0, 540.0)
    counts = np.concatenate([rng.normal(300 + 1000 * lines_at(own, places, fwhm), 8) for own, fwhm in both])
    axis = np.concatenate([own for own, _ in both])
    order = np.argsort(axis)
    return axis[order] * 1e-9, counts[order]


def test_a_line_that_two_detectors_see_is_one():
    axis, counts = overlapping()
    found = find(*one_detector(axis, counts)).wavelength * 1e9
    assert found[(found > 440) & (found < 470)] == pytest.approx(OVERLAP, abs=0.08)
    assert find(axis, counts).wavelength.size > 20  # from channel to channel the one, then the other


def test_even_channels_stay_as_they_are():
    axis = np.linspace(300e-9, 900e-9, 2000) ** 1.01
    for own in (axis, np.delete(axis, [500, 1200])):
        np.testing.assert_allclose(one_detector(own, own)[1], own, rtol=1e-12)


def test_each_detector_has_a_slit_of_its_own():
    rng = np.random.default_rng(4)
    fine, coarse = np.arange(300.0, 450.0, 0.06), np.arange(450.0, 900.0, 0.14)
    axis = np.concatenate([fine, coarse])
    light = np.concatenate(
        [lines_at(fine, np.arange(305, 450, 10.03), 0.5), lines_at(coarse, np.arange(455, 900, 20.07), 0.5)]
    )
    found = find(axis * 1e-9, rng.poisson(2000 * light + 300).astype(float))
    assert np.interp([350e-9, 700e-9], found.axis, found.slit) == pytest.approx([0.5e-9, 0.5e-9], rel=0.25)


@pytest.mark.parametrize("frame", ["000", "003"])
def test_wide_lines_of_air_are_not_moved_until_others_fit(frame):
    """Eight lines of 4 nm: shifts of 6 to 13 nm fitted magnesium, titanium, or nothing that is there."""
    axis, frames = read_frames(EXAMPLE / f"spectrometer/spectrum_{frame}.txt")
    for dark in (read_frames(EXAMPLE / "dark.txt")[1][0], 0.0):
        answer = identify(axis, frames[0] - dark)
        assert names(answer) == {"N", "O"}
        assert abs(float(answer.scale(890e-9))) < 0.5e-9
