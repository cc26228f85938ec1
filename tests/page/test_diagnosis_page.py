"""The page of a diagnosis: says the verdict first, needs nothing else, gives nothing away."""

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from reader import Reader
from sample_report import candidate, report, residual_map, temperature, truth

from plasmapyro.page.recommended import BESIDE, headline
from plasmapyro.page.stage import STATUS, write_page
from plasmapyro.page.words import kelvin, number, probability, with_error, without_folders


@pytest.fixture(scope="module")
def page():
    return write_page(report(), residual_map(), temperature())


def pictures(page):
    return re.findall(r"<svg.*?</svg>", page, flags=re.DOTALL)


def test_page_is_whole_and_loads_nothing(page):
    reader = Reader(page)
    assert not {"script", "link", "iframe", "object"} & set(reader.tags)
    for _, name, value in reader.attributes:
        if name in ("src", "href", "xlink:href", "action", "srcset"):
            assert value.startswith(("#", "data:image/png;base64,")), value
    assert all(found.startswith("#") for found in re.findall(r"url\(([^)]*)\)", page))
    assert "@import" not in page


def test_verdict_stands_before_any_figure(page):
    assert page.index("The data reject the base model.") < page.index("<svg")
    assert page.index("The data reject the base model.") < page.index("Nothing else is needed.")


def test_measured_data_are_called_so(page):
    assert "SYNTHETIC" not in page and "data: measured" in page


def test_every_figure_scales_and_speaks(page):
    found = pictures(page)
    assert len(found) >= 13
    for svg in found:
        root = ET.fromstring(svg)
        assert root.get("viewBox") and root.get("width") is None and root.get("height") is None
        assert root.get("role") == "img" and len(root.get("aria-label")) > 10
    captions = re.findall(r"<figcaption><b>(.+?)</b> (.+?)</figcaption>", page)
    assert len(captions) == len(found)
    assert page.count("<figure>") == len(found)


def test_synthetic_is_said_and_users_text_is_no_markup_and_tells_no_folder():
    evil = '<script>alert("1")</script> & /home/anna/secret/run7.nc'
    changed = report(
        dataset=report()["dataset"] | {"title": evil, "condition": "<b>80", "origin": "synthetic"},
        assumptions=[evil, r"C:\Users\anna\data\x.csv", "ratio T/T and 1/s stay"],
        provenance=report()["provenance"] | {"files": {"/home/anna/secret/run7.nc": "ab"}},
        candidates=[candidate("winE", kelvin=1.0, probability=0.9, rank=1) | {"name": "<i>x</i> $ /srv/a/b"}],
    )
    page = write_page(changed, residual_map(), temperature())
    assert "SYNTHETIC DATA" in page and "data: synthetic" in page
    assert "<script" not in page and "<b>80" not in page and "<i>x" not in page
    assert "anna" not in page and "secret" not in page and "/srv/a" not in page
    assert "&lt;script&gt;alert(&#34;1&#34;)&lt;/script&gt; &amp; run7.nc" in page
    assert "x.csv" in page and "ratio T/T and 1/s stay" in page


def test_candidates_keep_their_order_and_show_kelvin(page):
    words = Reader(page).words
    ranking = words[words.index("★ marks what is named") :]
    assert ranking.index("cause winE ★") < ranking.index("cause other")
    assert "+12 K" in words and "+3.2 K" in words and "−6.2 K" in words
    assert "0.0412 ± 0.0031" in words


def test_of_several_named_causes_only_the_first_answer_has_a_probability():
    """The others explain what the first leaves: a nought beside a star would contradict it."""
    both = [
        candidate("winE", kelvin=12.0, probability=0.95, rank=1),
        candidate("drift", kelvin=3.0, probability=0.0, rank=2),
    ]
    verdict = report()["verdict"] | {
        "status": "named",
        "named": ["winE", "drift"],
        "probability": {"winE": 0.95},
        "joint_probability": 0.88,
    }
    words = Reader(write_page(report(candidates=both, verdict=verdict), residual_map(), temperature())).words
    assert "2 causes are named" in words and "0.88 probability that all named causes are right" in words
    ranking = words[words.index("★ marks what is named") :]
    first, second = ranking.index("cause winE ★"), ranking.index("cause drift ★")
    assert "0.95" in ranking[first:second] and "beside it" in ranking[second : second + 200]


def test_a_cause_that_the_base_model_takes_up_shows_no_amplitude():
    row = candidate("eps_T", kelvin=0.0, probability=0.0, rank=1)
    row |= {"amplitude": 0.0, "standard_error": 0.5, "significance": 0.0, "gain_chi2": 3224.0}
    words = Reader(write_page(report(candidates=[row]), residual_map(), temperature())).words
    assert "the base model takes it up" in words and "3.22" not in words


def test_what_remains_invisible_is_said_in_kelvin(page):
    words = Reader(page).words
    assert "sensitivity ratio 75 K 45 K" in words and "repeat the calibration" in words
    assert "possible and invisible: sensitivity ratio" in words
    assert "it would show an error of 45 K of the paper's correction" in words


def test_what_would_decide_is_said(page):
    words = Reader(page).words
    assert "cannot tell apart: cause winE, cause other" in words
    assert "lamp through the window cause winE, cause other 40 sd" in words


def test_lines_without_a_name_get_one(page):
    assert "Lines that the simulated gas lacks" not in page
    lines = [
        {
            "species": "Na I",
            "probability": 0.998,
            "lines": [589.0e-9, 589.59e-9],
            "rivals": ["K I"],
            "effect": {"id": "lines Na I", "amplitude": 1.34, "uncertainty": 0.11},
        }
    ]
    left = report()["discrepancy"] | {"lines": lines}
    words = Reader(write_page(report(discrepancy=left), residual_map(), temperature())).words
    for piece in ("Na I", "589", "589.59", "K I", "1.3 ± 0.11", "lines Na I"):
        assert piece in words


def test_misfit_of_a_phase_is_shown_by_number_and_shade(page):
    assert re.search(r'background:#e9967f" title="p = 1e-06, 100 data">3<', page)
    assert re.search(r'background:#eef6ee" title="p = 0.2, 100 data">0.97<', page)


def test_gain_is_shown_and_nothing_asked_that_the_program_refuses(page):
    words = Reader(page).words
    assert "foretold better by 6.9 standard errors" in words and "1 of 2" in words
    assert "214" not in words  # the logarithm of a probability of thousands of values tells nobody anything
    assert "configuration" not in words
    assert "The extended temperature is used" in words


def test_the_temperature_to_take_away_stands_below_the_verdict_with_its_reason_and_budget(page):
    words = Reader(page).words
    assert words.index("Recommended: the diagnosis, because data confirm it.") < words.index("Why")
    assert "1016 ± 2.9 K first, at 20 s (95 %)" in words  # the one at 2 s is dominated by the gas
    assert "4 of 6 samples with a temperature to take away" in words
    small = words[words.index("Standard uncertainties in kelvin") :]
    assert "310 s 1306 K 0.9 K 1.2 K 1.5 K ± 2.9 K" in small
    # Welch-Satterthwaite: 1.5^4 / (0.9^4 / 8) = 61.7
    assert "temperature of the source calibration 3 K 0.4 K/K rectangular ∞" in small
    assert "root of the summed squares 62" in small


def test_synthetic_data_show_what_was_hidden_and_what_was_found():
    words = Reader(write_page(report(), residual_map(), temperature(), truth())).words
    assert "cause winE 0.045 0.0412 ± 0.0031 found, 1.2 standard errors off" in words
    assert "drift 0.2 – not named" in words
    # base + 5, base and base - 4 against base - 3: 8, 3 and 1 K
    for row in ("the paper's correction 8 K 8 K", "base model 3 K 3 K", "to take away 1 K 1 K"):
        assert row in words
    assert "interval of 100 % of the samples" in words
    assert "hidden" not in Reader(write_page(report(), residual_map(), temperature())).words.split("Why")[0]


def test_no_status_contradicts_what_stands_above_it():
    said = {"rule": "stuck", "severity": "contradiction", "where": "test", "remedy": "look", "saw": "it is"}
    verdict = report()["verdict"] | {"status": "null", "named": [], "set": [], "probability": {"none": 0.9}}
    nothing = temperature()
    nothing["recommended_temperature"] = np.nan * nothing.recommended_temperature
    nothing = nothing.assign_attrs(recommended="none", recommended_because="No temperature: x.")
    page = write_page(report(verdict=verdict, findings=[said]), residual_map(), nothing)
    words = Reader(page).words
    assert "the model explains the data, but the data contradict themselves" in words
    assert 'class="verdict fine"' not in page and "Before anything else: look." in words
    assert "0 of 6 samples with a temperature to take away" in words
    unknown = verdict | {"status": "unknown", "probability": {"none": 0.6}}
    words = Reader(write_page(report(verdict=unknown), residual_map(), temperature())).words
    assert "nothing is wrong" not in words and "probability: no cause is needed" not in words
    assert "Look at the light of the spectrometer along wavelength: something unknown is seen there." in words


@pytest.mark.parametrize("best", ["base", "none"])
@pytest.mark.parametrize("severity", [None, *BESIDE])
@pytest.mark.parametrize("status", STATUS)
def test_green_stands_alone(status, severity, best):
    """A doubted pyrometer had "nothing wrong was found" in green below the doubt."""
    words, edge = headline(*STATUS[status], [{"severity": severity}] if severity else [], best)
    assert (edge == "fine") == ((status, severity, best) == ("null", None, "base"))
    assert words.startswith(STATUS[status][0]) and "nothing wrong" not in words
    amiss = severity is not None or best == "none"
    assert (", but " in words) == (amiss and STATUS[status][1] != "open")


def test_refused_extension_keeps_the_base_temperature():
    refused = report()["extended"] | {"applied": False, "why": "held-out data do not improve"}
    page = write_page(report(extended=refused), residual_map(), temperature())
    assert "The base temperature is kept: held-out data do not improve" in page
    assert "extended model, 95 %" not in page


def test_nothing_wrong_needs_no_extension():
    verdict = report()["verdict"] | {
        "status": "null",
        "named": [],
        "set": [],
        "probability": {"none": 0.97, "unknown": 0.03},
        "sentences": ["The base model explains these data."],
        "missing_evidence": [],
    }
    show = report()["show"] | {"profile": []}
    page = write_page(
        report(verdict=verdict, extended=None, gain=None, candidates=[], show=show),
        residual_map(models=("base", "extended")),
        temperature(),
    )
    words = Reader(page).words
    assert "the model explains the data" in words and "★" not in words
    assert "extended model" not in words


@pytest.mark.parametrize("instrument", ["pyrometer", "spectrometer"])
def test_one_instrument_is_enough(instrument):
    show = report()["show"]
    if instrument == "pyrometer":
        show |= {"kappa": None, "line_hump": None, "gas_monitor": None}
    else:
        empty = {name: [] for name in show["signals"]}
        show |= {"signals": empty, "emittance_loop": None}
    dataset = report()["dataset"] | {"instruments": [instrument]}
    page = write_page(
        report(show=show, dataset=dataset), residual_map(instruments=(instrument,)), temperature()
    )
    words = Reader(page).words
    assert ("What is left of the spectra" in words) == (instrument == "spectrometer")
    assert ("What is left of the signals" in words) == (instrument == "pyrometer")


def test_same_files_same_page(page):
    assert write_page(report(), residual_map(), temperature()) == page


def test_another_format_is_refused():
    with pytest.raises(ValueError, match="schema must be 'plasmapyro-diagnosis-1'; got '2'"):
        write_page(report(schema="2"), residual_map(), temperature())


def test_numbers_are_written_as_they_are_worth():
    assert kelvin(-0.04) == "0 K" and kelvin(12.4) == "+12 K" and kelvin(-4.14) == "−4.1 K"
    assert kelvin(float("nan")) == kelvin(None) == "–"
    assert number(1.23456e-21) == "1.23·10⁻²¹" and number(0.0412) == "0.0412"
    assert with_error(0.0412, 0.0031) == "0.0412 ± 0.0031" and with_error(214.0, 31.0) == "214 ± 31"
    assert with_error(5.0, 0.0, "nm") == "5 nm" and with_error(3.2, 0.4, "0.01") == "3.20 ± 0.40 %"
    assert probability(3e-6) == "< 0.0001" and probability(0.91) == "0.91" and probability(0.0) == "0"
    assert without_folders("see /data/a/b.nc, m/s, a/b") == "see b.nc, m/s, a/b"


def test_the_report_of_these_tests_honours_the_published_format():
    schema = Path(__file__).resolve().parents[2] / "src/plasmapyro/diagnosis/diagnosis.schema.json"
    jsonschema.validate(json.loads(json.dumps(report())), json.loads(schema.read_text(encoding="utf-8")))


def test_what_contradicts_itself_in_the_data_stands_before_the_verdict(page):
    said = {"rule": "stuck", "severity": "contradiction", "where": "/home/me/my_test", "remedy": "look"}
    found = report(findings=[{**said, "saw": "both <b>stay</b>"}])
    shown = write_page(found, residual_map(), temperature())
    words = "the data contradict themselves my_test: both <b>stay</b>; look [stuck]"
    assert words in Reader(shown).words and "<b>stay" not in shown
    assert shown.index("the data contradict") < shown.index('aria-label="Verdict"')
    assert "contradict themselves" not in page
    named = report()["verdict"] | {"status": "named"}
    doubted = report(verdict=named, findings=[{**said, "saw": "x", "severity": "doubt"}])
    shown = write_page(doubted, residual_map(), temperature())
    assert "doubts about the data" in shown and " named, but the data are in doubt" in shown


def test_what_was_taken_as_given_is_not_called_missed():
    """On the page of an extended run all that was hidden was "not named", by its id."""
    row = {"id": "drift", "name": "drift of the gas", "unit": "1", "amplitude": 0.19, "standard_error": 0.01}
    known, hidden = report(given=[row]), truth()
    assert (
        "drift of the gas 0.2 0.190 ± 0.010 taken as given, 1.0 standard errors off"
        in Reader(write_page(known, residual_map(), temperature(), hidden)).words
    )
    known["given"][0]["standard_error"] = 0.0
    page = write_page(known, residual_map(), temperature(), hidden)
    assert "drift of the gas 0.2 0.19 taken as given" in Reader(page).words
    hidden.attrs["hidden"] = '[{"effect": "power", "amplitude": -0.07}]'
    known["simulation"] |= {"power": 0.998, "power_error": 0.013}
    page = write_page(known, residual_map(), temperature(), hidden)
    assert "power −0.07 – nothing of it is left" in Reader(page).words


def test_the_closest_change_of_the_gas_has_a_name():
    known = report()
    known["show"]["line_hump"] |= {"closest": known["show"]["line_hump"]["tracks"][0]["id"]}
    track = known["show"]["line_hump"]["tracks"][0]
    words = Reader(write_page(known, residual_map(), temperature())).words
    assert f"within their priors: {track['name']}." in words


def test_a_hidden_power_is_found_where_the_gas_tells_it():
    """The power is no effect of the catalogue: what was found of it stands with the simulation."""
    hidden = truth()
    hidden.attrs["hidden"] = '[{"effect": "power", "amplitude": -0.07}]'
    for power, said in ((0.93, "−0.0700 ± 0.0093 found, 0.0 standard errors off"), (0.98, "– not named")):
        simulation = report()["simulation"] | {"power": power, "power_error": 0.01}
        page = write_page(report(simulation=simulation), residual_map(), temperature(), hidden)
        assert said in Reader(page).words
