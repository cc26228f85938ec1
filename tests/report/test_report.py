"""The report as a reader meets it: in a real browser, at two widths, without a network."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from plasmapyro.report.captions import FIGURES, describe
from plasmapyro.report.stage import compose

PIXEL = (  # a PNG of one pixel
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)
PHONE, DESKTOP = 390, 1280
ROOT = Path(__file__).resolve().parents[2]


def claims():
    text = {
        "section": "4.1",
        "statement": "a <b>bold</b> claim",
        "unit": "K",
        "printed": "10 K",
        "remark": "none",
    }
    return xr.Dataset(
        {
            **{name: ("claim", [word] * 3) for name, word in text.items()},
            "verdict": ("claim", ["reproduced", "differs by +3 K", "not testable here"]),
            "basis": ("claim", ["simulation", "synthetic", "untestable"]),
            "value": ("claim", [10.0, 13.0, np.nan]),
        },
        {"claim": ["one", "two", "three"]},
        attrs={"sources": "abc  results/a.nc", "plasmapyro_version": "0"},
    )


def corrected():
    time = np.arange(0.0, 100.0)
    temperature = np.where(time < 20, np.nan, 1600.0)
    return xr.Dataset(
        {
            "corrected_temperature": ("time", temperature),
            "corrected_temperature_uncertainty": ("time", 0 * time + 23.0),
            "corrected_status": ("time", np.where(time < 30, 2, 0)),
        },
        {"time": time},
        {"injection_time": 0.0, "plasma_off_time": 90.0, "condition": "80kW", "origin": "synthetic"},
    )


@pytest.fixture(scope="module")
def page():
    timing = {"s": 2.0, "cpu_time": 1.5, "max_rss": 300.0}
    return compose(
        [("fig10a_signals_x", PIXEL), ("fig9b_sample_emittance_x", PIXEL), ("fig8c_error_map", PIXEL)],
        claims(),
        [("mine", corrected())],
        diagnoses=[("mine", "<p>verdict: <b>nothing wrong</b></p><script>document.title = 'x'</script>")],
        timings=[("flow", timing), ("flow", {**timing, "s": 4.0})],
        configuration={"key": "value"},
    )


def test_the_steady_temperature_and_the_first_value_are_those_of_the_data(page):
    row = re.search(r"<td[^>]*>mine</td>.*", page).group()
    # From 20 s on there are values, beyond the calibrated range; from 30 s on valid ones.
    assert all(words in row for words in ("30.0 s", "1600 K", "23 K", "synthetic"))


def test_verdicts_are_counted_whole(page):
    assert ">not testable here</span>: 1 from the simulation, 0 on" in page


@pytest.mark.parametrize(
    ("quantity", "status", "words"),
    [
        ("surface_temperature", "estimate_status", "joint estimate"),
        ("recommended_temperature", "recommended_status", "to take away"),
    ],
)
def test_an_estimate_counts_where_it_is_valid(quantity, status, words):
    time = np.arange(0.0, 100.0)
    estimate = xr.Dataset(
        {
            quantity: ("time", np.where(time < 10, 5000.0, 1500.0)),
            f"{quantity}_uncertainty": ("time", 0 * time + 2.0),
            status: ("time", np.where(time < 10, 1, 0)),
        },
        {"time": time},
        {"injection_time": 0.0, "plasma_off_time": 90.0, "condition": "80kW", "origin": "measured"},
    )
    row = re.search(r"<td[^>]*>mine</td>.*", compose([], claims(), [("mine", estimate)])).group()
    assert all(one in row for one in (words, "10.0 s", "1500 K", "2 K"))
    assert "5000" not in row


def test_a_report_without_claims_says_so_and_which_tests_are_not_there():
    page = compose([], None, [("mine", corrected())], without=["theirs", "twin"])
    assert "claims of the paper" in page and "of that pyrometer: theirs, twin." in page
    assert "Show all claims" not in page and "behind the claims" not in page and ">mine<" in page


def test_words_of_a_user_are_not_taken_as_markup(page):
    assert "a &lt;b&gt;bold&lt;/b&gt; claim" in page


def test_jobs_of_one_rule_share_a_row(page):
    row = re.search(r"<td>flow</td>.*", page).group()
    assert all(f">{words}<" in row for words in ("2", "4.0", "6.0", "300"))


def test_figures_stand_in_the_order_of_their_numbers(page):
    assert page.index('id="fig9b') < page.index('id="fig10a')


def test_a_figure_without_words_is_refused():
    with pytest.raises(KeyError, match="'fig99' has no words yet"):
        describe("fig99")


def test_every_figure_of_the_workflow_has_words():
    rules = (ROOT / "workflow/rules/figures.smk").read_text(encoding="utf-8").partition("\nrule ")[0]
    names = set(re.findall(r'"(\w+)"', rules)) - {"svg", "png", "pyrometer", "spectrometer", "instruments"}
    assert {"fig3a_responses", "joint_estimate", "trust"} <= names and len(names) > 25
    for name in names:
        describe(name)


def test_the_page_asks_for_nothing_from_outside(page):
    assert not re.findall(r"""(?:src|href)=["'](?!#|data:)[^"']*""", page)
    assert "http" not in re.sub(r"data:[^\"']*", "", page)


def test_each_caption_and_alternative_text_says_something():
    for chapter, caption, words in FIGURES.values():
        assert chapter and len(caption) > 20 and len(words) > 20


def open_page(browser, path, width):
    """Show a page; refuse one that is wider than the screen, loads from outside or has errors."""
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width == PHONE}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.get(path.as_uri())
    ask = browser.execute_script
    assert ask("return document.documentElement.scrollWidth") <= width, "the page is wider than the screen"
    pictures = ask("return [...document.images].map(i => [i.alt.length, i.complete && i.naturalWidth])")
    assert all(words > 20 and loaded for words, loaded in pictures)
    drawings = "[...document.querySelectorAll('svg')].filter(s => !s.closest('[aria-hidden=true]'))"
    named = "s.getAttribute('aria-label') || s.getAttribute('aria-labelledby') || s.querySelector('title')"
    assert pictures or ask(f"return {drawings}.length"), "a page without figures"
    assert ask(f"return {drawings}.every(s => {named})"), "a drawing without words"
    return ask, len(pictures)


def nothing_from_outside(browser):
    asked = [entry["message"] for entry in browser.get_log("performance")]
    assert not [message for message in asked if "requestWillBeSent" in message and '"url":"http' in message]
    severe = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert not [entry for entry in severe if "sandboxed" not in entry["message"]], "errors on the console"


@pytest.mark.parametrize("width", [PHONE, DESKTOP])
def test_a_browser_reads_and_clicks_through_the_page(page, browser, tmp_path, width):
    (tmp_path / "report.html").write_text(page, encoding="utf-8")
    ask, pictures = open_page(browser, tmp_path / "report.html", width)
    assert "report" in browser.title and pictures == 3
    for link in browser.find_elements("css selector", "nav a"):
        link.click()
        target = link.get_attribute("href").partition("#")[2]
        place = ask("return document.getElementById(arguments[0]).getBoundingClientRect().top", target)
        assert -1 <= place < 900, f"the link to {target} leads elsewhere"
    for fold in browser.find_elements("css selector", "summary"):
        ask("arguments[0].scrollIntoView({block: 'center'})", fold)
        fold.click()
    assert ask("return [...document.querySelectorAll('details')].every(d => d.open)")
    assert "bold" in browser.find_element("id", "claims").text
    nothing_from_outside(browser)
    frame = browser.find_element("tag name", "iframe")
    assert frame.get_attribute("sandbox") == "", "a page of a test may run scripts"
    browser.switch_to.frame(frame)
    assert "nothing wrong" in browser.find_element("tag name", "body").text
    browser.switch_to.default_content()


@pytest.mark.parametrize("width", [PHONE, DESKTOP])
@pytest.mark.parametrize("name", ["report.html", "diagnosis/csic_160kW/index.html"])
def test_the_pages_of_the_main_job_read_well(browser, name, width):
    if "PLASMAPYRO_RESULTS" not in os.environ:
        pytest.skip("needs the results of the main job (make compare)")
    open_page(browser, ROOT / os.environ["PLASMAPYRO_RESULTS"] / name, width)
    nothing_from_outside(browser)


def test_what_contradicts_itself_stands_before_the_temperatures():
    said = {"rule": "stuck", "where": "my_test", "saw": "stays <b>put</b>", "remedy": "look"}
    both = [{**said, "severity": severity} for severity in ("doubt", "contradiction")]
    page = compose([], claims(), [("mine", corrected())], findings=both)
    first = page.index("<strong>Contradiction.</strong> my_test: stays &lt;b&gt;put&lt;/b&gt;; look")
    assert first < page.index("<strong>Doubt.</strong>") < page.index("mine</td>")
    assert 'role="alert"' not in compose([], claims(), [("mine", corrected())])
