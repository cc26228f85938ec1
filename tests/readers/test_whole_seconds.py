"""Spectra whose dates are whole seconds, beside a pyrometer whose clock is finer."""

import shutil
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from plasmapyro.commands.check import contents
from plasmapyro.readers.clock import cycle
from plasmapyro.readers.stage import read_test

EXAMPLE = Path(__file__).parents[2] / "docs" / "example" / "my_test"
TRUE = 2.0 + 4.0 * np.arange(15)  # [s] middles of the exposures of 0.5 s
INJECTION = datetime(2026, 5, 4, 14, 3, 20)


@pytest.fixture
def dated(tmp_path):
    """The example, the end of each exposure dated as the makers' programs do: decimals are cut off."""

    def write(late=0.0, true=TRUE):
        folder = shutil.copytree(EXAMPLE, tmp_path / f"late {late:g}")
        for path, middle in zip(sorted((folder / "spectrometer").iterdir()), true, strict=True):
            date = INJECTION + timedelta(seconds=middle + 0.25 + late)
            head, rest = path.read_text(encoding="utf-8").split("\n", 1)
            path.write_text(f"{head}\nDate: {date:%a %b %d %H:%M:%S} CET {date:%Y}\n{rest}", encoding="utf-8")
        described = folder / "test.yaml"
        words = described.read_text(encoding="utf-8")
        old = "{from: order, first: 2.0, period: 4.0}"
        assert old in words
        described.write_text(words.replace(old, f'{{from: date, zero: "{INJECTION}"}}'), encoding="utf-8")
        return folder

    return write


def test_spectra_are_moved_within_the_second_that_their_dates_leave_open(dated):
    test = read_test(dated())
    assert test.spectrum_time.values == pytest.approx(TRUE, abs=0.11)
    assert test.attrs["spectra_moved"] == pytest.approx(0.25, abs=0.11)


def test_a_ray_in_one_spectrum_moves_none(dated):
    folder = dated()
    expected = read_test(folder).spectrum_time.values
    path = folder / "spectrometer/spectrum_008.txt"
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[80] = f"{lines[80].split()[0]}\t60000.0"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert read_test(folder).spectrum_time.values == pytest.approx(expected, abs=0.06)


def test_a_clock_that_is_off_by_more_is_left_for_a_person_to_see(dated):
    test = read_test(dated(-2.0))
    assert "spectra_moved" not in test.attrs
    assert test.spectrum_time.values == pytest.approx(TRUE - 2.0 - 0.25, abs=1e-9)


def test_dates_that_fit_a_constant_cycle_give_its_times(dated):
    """Frames of 1.6 s dated in whole seconds follow each other by 1 s and 2 s in turn."""
    true = 2.0 + 1.6 * np.arange(15)
    test = read_test(dated(true=true))
    assert test.spectrum_time.values == pytest.approx(true, abs=0.15)
    assert test.attrs["spectra_period"] == pytest.approx(1.6, abs=0.02)
    assert "spectra_moved" not in test.attrs
    assert any("one per 1.6 s, in the constant cycle that their dates fit" in line for line in contents(test))


def test_dates_of_frames_with_a_gap_stay(dated):
    true = 2.0 + 1.6 * (np.arange(15) + (np.arange(15) > 6))
    test = read_test(dated(true=true))
    assert "spectra_period" not in test.attrs
    stayed = test.spectrum_time.values - test.attrs.get("spectra_moved", 0.0)
    assert stayed == pytest.approx(np.floor(true + 0.25) - 0.25, abs=1e-9)


@pytest.mark.parametrize("jitter", [0.0, 0.02])
def test_a_cycle_is_found_within_its_margin(jitter):
    rng = np.random.default_rng(3)
    for period in (0.73, 1.303, 2.41, 3.77):
        true = 0.4 + period * np.arange(60) + jitter * rng.uniform(-1, 1, 60)
        found, first, margin = cycle(np.floor(true))
        assert np.abs(first + found * np.arange(60) - true).max() < margin + 2 * jitter + 0.05


@pytest.mark.parametrize(
    "true", [1.6 * np.arange(7), 0.7 * np.arange(12), np.zeros(30), 1.6 * np.arange(30) ** 1.02]
)
def test_few_frames_a_short_series_and_a_cycle_that_changes_have_no_line(true):
    assert cycle(np.floor(true)) is None
