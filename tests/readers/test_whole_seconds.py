"""Spectra whose dates are whole seconds, beside a pyrometer whose clock is finer."""

import shutil
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from plasmapyro.readers.stage import read_test

EXAMPLE = Path(__file__).parents[2] / "docs" / "example" / "my_test"
TRUE = 2.0 + 4.0 * np.arange(15)  # [s] middles of the exposures of 0.5 s
INJECTION = datetime(2026, 5, 4, 14, 3, 20)


@pytest.fixture
def dated(tmp_path):
    """The example, the end of each exposure dated as the makers' programs do: decimals are cut off."""

    def write(late=0.0):
        folder = shutil.copytree(EXAMPLE, tmp_path / f"late {late:g}")
        for path, middle in zip(sorted((folder / "spectrometer").iterdir()), TRUE, strict=True):
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


def test_a_clock_that_is_off_by_more_is_left_for_a_person_to_see(dated):
    test = read_test(dated(-2.0))
    assert "spectra_moved" not in test.attrs
    assert test.spectrum_time.values == pytest.approx(TRUE - 2.0 - 0.25, abs=1e-9)
