"""docs/your-own-data.md, run as written."""

import re
import shlex
import shutil
import sys
from pathlib import Path

import numpy as np

from plasmapyro import cli, contracts, io
from plasmapyro.readers.stage import check_test, read_test

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "your-own-data.md"
FENCE = re.compile(r"```(\w+)(?: (?:file=(\S+)|(output)|calibration))?\n(.*?)```", re.DOTALL)
sys.path.insert(0, str(ROOT / "tests" / "commands"))


def blocks():
    return [(language, name, output, content) for language, name, output, content in FENCE.findall(page())]


def page():
    return PAGE.read_text(encoding="utf-8")


def write_folder(folder):
    folder.mkdir(parents=True)
    for _, name, _, content in blocks():
        if name and "/" not in name:
            (folder / name).write_text(content, encoding="utf-8")
    return folder


def shell(line):
    """One line of a command block: the program, or a copy of a folder."""
    words = shlex.split(line)
    if words[0] == "plasmapyro":
        assert cli.main(words[1:]) == 0, line
    else:
        assert words[:2] == ["cp", "-r"], line
        shutil.copytree(words[2], words[3])


def test_every_command_runs_as_written(tmp_path, monkeypatch, capsys):
    shutil.copytree(ROOT / "docs" / "example", tmp_path / "docs" / "example")
    monkeypatch.chdir(tmp_path)
    commands = printed = 0
    for language, name, output, content in blocks():
        if name and "/" in name:
            Path(name).write_text(content, encoding="utf-8")
        elif language == "sh":
            for line in content.splitlines():
                capsys.readouterr()
                shell(line)
                commands += 1
        elif output:
            assert capsys.readouterr().out == content
            printed += 1
        elif "temperature.nc" in content:
            exec(compile(content, str(PAGE), "exec"), {})
    assert commands >= 10 and printed == 1
    both, pyrometer, spectrometer = (
        io.read(f"{name}.nc", "correction") for name in ("temperature", "pyrometer", "spectrometer")
    )
    assert "spectrum_time" not in pyrometer and "corrected_temperature" not in spectrometer
    np.testing.assert_array_equal(pyrometer.corrected_temperature, both.corrected_temperature)
    np.testing.assert_array_equal(spectrometer.scaled_temperature, both.scaled_temperature)
    assert both.attrs["origin"] == "synthetic"


def test_the_example_gives_the_temperature_it_was_made_with(tmp_path):
    import laboratory

    example = ROOT / "docs" / "example"
    assert cli.main(["calibrate", str(example / "calibration"), "--out", str(tmp_path / "lab")]) == 0
    words = ["correct", str(example / "my_test"), "--instrument", str(tmp_path / "lab")]
    assert cli.main([*words, "--out", str(tmp_path / "t.nc")]) == 0
    found = io.read(tmp_path / "t.nc", "correction")
    for name, axis, state in (
        ("corrected_temperature", "time", "corrected_status"),
        ("scaled_temperature", "spectrum_time", "spectrum_status"),
    ):
        good = found[state].values == 0
        error = found[name].values[good] - laboratory.temperature(found[axis].values)[good]
        stated = found[f"{name}_uncertainty"].values[good]
        assert np.mean(np.abs(error) < 2 * stated + 3) > 0.95  # 3 K: the quadratic curve


def test_the_example_is_the_one_of_the_laboratory(tmp_path):
    import laboratory

    laboratory.calibration_folder(tmp_path / "calibration")
    laboratory.test_folder(tmp_path / "my_test")
    made = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file())
    kept = ROOT / "docs" / "example"
    shipped = (path for folder in ("calibration", "my_test") for path in (kept / folder).rglob("*"))
    assert made == sorted(path.relative_to(kept) for path in shipped if path.is_file())
    for path in made:
        if path.suffix == ".yaml":
            assert (tmp_path / path).read_text() == (kept / path).read_text()


def test_the_page_on_files_runs_as_written(tmp_path, monkeypatch):
    write_folder(tmp_path / "my_test")
    monkeypatch.chdir(tmp_path)
    programs = [
        content for language, _, _, content in blocks() if language == "python" and "my_test" in content
    ]
    assert programs
    for program in programs:
        exec(compile(program, str(PAGE), "exec"), {})
    contracts.check(read_test("my_test"), "test")


def test_the_message_on_the_page_is_the_one_that_comes(tmp_path, monkeypatch):
    folder = write_folder(tmp_path / "my_test")
    table = folder / "pyrometer.csv"
    table.write_text(table.read_text().replace("52,80", "52,8O"))
    monkeypatch.chdir(tmp_path)
    (message,) = check_test("my_test")
    assert message in page()


def test_every_status_and_key_on_the_page_exists():
    words = set(re.findall(r"`([a-z_]+)`", page()))
    source = "".join(path.read_text() for kind in ("py", "csv") for path in (ROOT / "src").rglob(f"*.{kind}"))
    source += "".join(path.read_text() for path in (ROOT / "config").glob("*.yaml"))
    unknown = {word for word in words if not re.search(rf"\b{word}\b", source)}
    assert unknown <= {"long", "short"}, unknown
