"""The command that names the species of a spectrum."""

import sys
from pathlib import Path

import numpy as np

from plasmapyro import cli

sys.path.insert(0, str(Path(__file__).parents[1] / "identification"))
import made_spectra as made


def test_table_and_figure(tmp_path, capsys):
    axis, counts = made.spectrum(made.SODIUM + made.POTASSIUM)
    np.savetxt(tmp_path / "s.csv", np.stack([axis * 1e9, counts], axis=1), fmt="%.2f", delimiter=",")
    out, plot = tmp_path / "names.csv", tmp_path / "names.png"
    assert cli.main(["identify", str(tmp_path / "s.csv"), "--out", str(out), "--plot", str(plot)]) == 0
    page, table = capsys.readouterr().out, out.read_text().splitlines()
    assert table[0].startswith("species,probability,log_bayes")
    assert {line.split(",")[0] for line in table[1:]} == {"Na I", "K I"}
    assert "Na I" in page and "K I" in page
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_a_width_that_no_peak_has_is_said(tmp_path, capsys):
    axis, counts = made.spectrum(made.SODIUM + made.POTASSIUM + made.LITHIUM)
    np.savetxt(tmp_path / "s.csv", np.stack([axis * 1e9, counts], axis=1), fmt="%.2f", delimiter=",")
    widths = {}
    for factor in (0.2, 1.0, 5.0):
        stated = f"{factor * 0.3:.3f}"
        assert cli.main(["identify", str(tmp_path / "s.csv"), "--fwhm-nm", stated]) == 0
        widths[factor] = "names rest on the width" in capsys.readouterr().err
    assert widths == {0.2: True, 1.0: False, 5.0: True}


def test_dark_of_another_instrument_is_refused(tmp_path, capsys):
    axis, counts = made.spectrum(made.LITHIUM)
    for name, scale in (("s.csv", 1.0), ("d.csv", 1.01)):
        np.savetxt(tmp_path / name, np.stack([axis * 1e9 * scale, counts], axis=1), fmt="%.4f", delimiter=",")
    assert cli.main(["identify", str(tmp_path / "s.csv"), "--dark", str(tmp_path / "d.csv")]) == 2
    assert "other wavelengths" in capsys.readouterr().err


def test_wavelengths_beyond_all_lines_are_refused(tmp_path, capsys):
    """Angstrom of which nothing says so: in nanometres there would be no known line."""
    axis, counts = made.spectrum(made.LITHIUM)
    table = np.stack([axis * 1e10, counts], axis=1)
    np.savetxt(tmp_path / "s.csv", table[axis < 450e-9], fmt="%.4f", delimiter=",")
    assert cli.main(["identify", str(tmp_path / "s.csv")]) == 2
    assert "Angstrom" in capsys.readouterr().err


def test_channels_without_a_number_hide_no_line_elsewhere(tmp_path, capsys):
    axis, counts = made.spectrum(made.SODIUM + made.POTASSIUM)
    counts = np.where(np.abs(axis - 700e-9) < 2e-9, np.nan, counts)
    np.savetxt(tmp_path / "s.csv", np.stack([axis * 1e9, counts], axis=1), fmt="%.2f", delimiter=",")
    assert cli.main(["identify", str(tmp_path / "s.csv")]) == 0
    page = capsys.readouterr().out
    assert "Na I" in page and "K I" in page
