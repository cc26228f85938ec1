"""The command `plasmapyro trust`: what it says when the results are not there, and where it stops."""

from plasmapyro import cli


def test_missing_results_are_named_and_nothing_is_written(tmp_path, capsys):
    page = tmp_path / "page.md"
    assert cli.main(["trust", "90kW", "--results", str(tmp_path), "--out", str(page)]) == cli.BAD_INPUT
    assert "gas_spectra.nc: no such file" in capsys.readouterr().err
    assert not page.exists()


def test_impossible_emittances_are_refused(tmp_path, capsys):
    words = ["trust", "90kW", "--results", str(tmp_path), "--emittance", "0.5", "1.5"]
    assert cli.main(words) == cli.BAD_INPUT
    assert "design.trust.emittance_range" in capsys.readouterr().err


def test_a_file_that_is_no_configuration_is_refused(tmp_path, capsys):
    other = tmp_path / "other.yaml"
    other.write_text("design: {}\n")
    assert cli.main(["trust", "90kW", "--config", str(other)]) == cli.BAD_INPUT
    assert "sightline" in capsys.readouterr().err
