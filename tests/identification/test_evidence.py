"""Evidence for species of our own invention: what is shared, what is faint, what is averaged."""

from dataclasses import replace

import numpy as np
import pytest

from plasmapyro.identification.evidence import BELIEVED, NOTHING, Explained, Scene
from plasmapyro.identification.identify import PLACE, UNCALIBRATED, Scale, _before
from plasmapyro.identification.peaks import find
from plasmapyro.identification.species import Species

SEEN = (505.0, 512.0, 519.0, 526.0, 533.0, 540.0)  # [nm]
LOW, HIGH = 2.5e6, 3.5e6  # [m-1]: the line of the high level shines in the hot gas only


def invented(name, places, upper):
    places = np.array(places) * 1e-9
    return Species(name, name, places, np.full(places.size, 1e8), np.array(upper))


MANY = invented("many", SEEN[:4], [LOW, LOW, LOW, HIGH])  # explains the fourth if need be
FEW = invented("few", SEEN[3:], [LOW] * 3)
APART = invented("apart", SEEN[4:], [LOW] * 2)


@pytest.fixture(scope="module")
def scene():
    axis = np.arange(495.0, 550.0, 0.05)
    light = sum(np.exp(-4 * np.log(2) * ((axis - place) / 0.3) ** 2) for place in SEEN)
    counts = np.random.default_rng(1).normal(500 + 200 * light, 1.0)
    return Scene(find(axis * 1e-9, counts), UNCALIBRATED, Scale(0.0), PLACE)


def test_a_species_is_not_held_to_what_another_explains_only_in_its_absence(scene):
    """Chain rule: ln B(few) + ln B(many | few) - ln B(many) where ln B(few | many) misses a line."""
    many = scene.fit(MANY)
    given = scene.fit(FEW, many.explained)
    alone = scene.fit(FEW)
    first = _before(scene, FEW, {MANY: many}).log_bayes
    assert given.log_bayes + 0.5 < first < alone.log_bayes
    assert first == pytest.approx(
        alone.log_bayes + scene.fit(MANY, alone.explained).log_bayes - many.log_bayes, abs=1e-9
    )


def test_the_order_of_species_without_a_common_peak_is_nothing(scene):
    many = scene.fit(MANY)
    assert _before(scene, APART, {MANY: many}).log_bayes == pytest.approx(
        scene.fit(APART, many.explained).log_bayes, abs=0.05
    )


def test_a_line_at_the_limit_of_detection_says_little(scene):
    """Between two spectra that noise tells apart evidence must not jump."""

    def evidence(snr):
        peaks = replace(scene.peaks, snr=np.where(np.arange(len(SEEN)) == 5, snr, scene.peaks.snr))
        return Scene(peaks, UNCALIBRATED, Scale(0.0), PLACE).fit(APART).log_bayes

    steps = [evidence(snr) for snr in np.linspace(*BELIEVED, 7)]
    assert np.all(np.diff(steps) > 0)
    assert np.diff(steps).max() < 0.35 * (steps[-1] - steps[0])
    assert evidence(BELIEVED[0] - 1) == pytest.approx(steps[0], abs=1e-9)


def test_many_peaks_by_chance_make_a_species_less_likely(scene):
    """As if each peak stood for ten."""
    alone = scene.fit(APART).log_bayes
    assert scene.counted(np.full(len(SEEN), 10.0)).fit(APART).log_bayes < alone - 2
    assert scene.fit(APART).log_bayes == alone


def test_a_peak_is_no_chance_for_being_there_itself(scene):
    """One as bright as no other is rarer by chance than one among its like, not as often as one of six."""
    light = np.where(np.arange(len(SEEN)) == 5, 200.0, 1.0) * scene.peaks.light
    bright = Scene(replace(scene.peaks, light=light), UNCALIBRATED, Scale(0.0), PLACE)
    assert bright.chance[5] < 0.05 * scene.chance[5]


def test_the_peaks_of_a_species_are_no_chance_to_each_other(scene):
    """Of three around the second, all its own, chance makes three without it and none with it:
    3!/0! is about (3 - (3 - 1)/2)^3. Each stands for four here: fewer have a least density."""
    crowd = scene.counted(np.full(len(SEEN), 4.0))
    beside = crowd._beside(crowd.fit(MANY))
    assert beside[1] / crowd.chance[1] == pytest.approx(2 / 3, rel=0.05)
    assert beside[5] == crowd.chance[5]


def test_a_line_is_brighter_than_expected_less_often_than_fainter():
    faint, bright = Scene._strength(np.log([0.05, 20.0]), 1.0)
    assert 0.5 < bright / faint < 0.8


def test_what_is_explained_is_the_mean_over_settings(scene):
    """Temperature and depth decide of the fourth line, which others may explain: its light lies between that
    of the coldest thin gas and of a black body, nearer to the first if they do."""
    seen = scene.peaks.light
    others = Explained(np.where(np.arange(seen.size) == 3, seen, 0.0), scene.peaks.wavelength)
    alone, beside = (scene.fit(MANY, other).explained.light for other in (NOTHING, others))
    for light in (alone, beside):
        assert light[:3] == pytest.approx(seen[:3], rel=0.5)
        assert np.all(light[4:] == 0)
    cold = MANY.light(2500.0, 0.1)
    assert 2 * cold[3] / cold[0] < beside[3] / beside[0] < 0.7 * alone[3] / alone[0] < 0.7


def test_what_is_explained_moves_steadily_with_a_peak(scene):
    """Amount and setting of most likelihood would jump, and with them what is left to other species."""

    def explained(share):
        light = scene.peaks.light * np.where(np.arange(len(SEEN)) == 3, share, 1.0)
        peaks = replace(scene.peaks, light=light)
        return Scene(peaks, UNCALIBRATED, Scale(0.0), PLACE).fit(MANY).explained.light[3]

    moves = np.diff(np.log([explained(share) for share in np.geomspace(0.2, 1.0, 9)]))
    assert np.all(moves > 0)
    assert moves.max() < 0.35  # a step of the amount is 0.7
