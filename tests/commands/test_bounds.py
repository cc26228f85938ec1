"""Every command that reads files, fed with bombs, devices, pipes and links that go round in a circle."""

import os
import shutil
from argparse import ArgumentTypeError
from pathlib import Path

import h5py
import netCDF4
import numpy as np
import pytest
import xarray as xr
from judge import judge, require_refused

from plasmapyro import io
from plasmapyro.commands import options
from plasmapyro.commands.outputs import beside, require_of_test, require_writable
from plasmapyro.readers.stage import sources

EXAMPLE = Path(__file__).resolve().parents[2] / "docs" / "example"
TEST, LAMP = EXAMPLE / "my_test", EXAMPLE / "calibration"


def commands(place, path):
    """name -> the command with `path` as one of its inputs; `place` takes the output."""
    out, folder, empty = place / "out" / "o.nc", path.parent, place / "empty"
    return {
        "check": ["check", path],
        "correct": ["correct", path, "--instrument", empty, "--out", out],
        "correct, instrument": ["correct", TEST, "--instrument", folder, "--out", out],
        "calibrate": ["calibrate", LAMP, "--response", path, "--out", place / "out" / "lab"],
        "diagnose": [
            "diagnose",
            path,
            "--radiance",
            empty,
            "--instrument",
            empty,
            "--out",
            place / "out" / "d",
        ],
        "diagnose, radiance": ["diagnose", TEST, "--radiance", folder, "--instrument", empty]
        + ["--out", place / "out" / "d"],
        "radiance": ["radiance", path, "--out", out],
        "radiance, response": ["radiance", path, "--response", path, "--out", out],
        "sightline, map": ["sightline", path, "--map", path, "--out", out],
        "trust": ["trust", "90kW", "--config", path],
    }


NAMES = list(commands(Path(), Path()))
OF_NETCDF = [name for name in NAMES if name not in ("sightline, map", "trust")]


@pytest.fixture
def run(tmp_path):
    for name in ("in", "out", "empty"):
        (tmp_path / name).mkdir()

    def command(name, path=None):
        path = path or tmp_path / "in" / "calibration.nc"
        ending = judge(commands(tmp_path, path)[name], tmp_path)
        assert list((tmp_path / "out").iterdir()) == []
        return ending

    return command


@pytest.fixture
def file(tmp_path, run):
    return tmp_path / "in" / "calibration.nc"


@pytest.mark.parametrize("size", [300_000_000, 10_000_000_000])
@pytest.mark.parametrize("name", OF_NETCDF)
def test_a_netcdf_file_that_claims_gigabytes(run, file, name, size):
    with netCDF4.Dataset(file, "w") as made:
        made.createDimension("time", size)
        made.createVariable("time", "f8", ("time",), zlib=True)
    require_refused(run(name), "calibration.nc", "says that it holds")


@pytest.mark.parametrize("way", ["storage", "virtual", "link"])
@pytest.mark.parametrize("name", ["check", "correct, instrument", "radiance"])
def test_a_netcdf_file_that_brings_bytes_of_another_file(run, file, name, way):
    secret = np.linspace(2000.0, 3000.0, 400)
    (file.parent / "secret").write_bytes(secret.tobytes())
    with h5py.File(file.parent / "other.h5", "w") as other:
        other["x"] = secret
    with h5py.File(file, "w") as made:
        if way == "storage":
            where = [(str(file.parent / "secret"), 0, secret.nbytes)]
            made.create_dataset("time", shape=secret.shape, dtype="<f8", external=where)
        elif way == "virtual":
            layout = h5py.VirtualLayout(shape=secret.shape, dtype="<f8")
            layout[...] = h5py.VirtualSource("other.h5", "x", shape=secret.shape)
            made.create_virtual_dataset("time", layout)
        else:
            made["time"] = h5py.ExternalLink("other.h5", "/x")
    require_refused(run(name), "calibration.nc", "another file ('time')")


def test_a_chunk_of_a_gigabyte_around_one_number_is_refused(run, file):
    with h5py.File(file, "w") as made:
        chunks = {"maxshape": (None,), "chunks": (10**8,), "compression": "gzip"}
        made.create_dataset("time", shape=(1,), dtype="f8", **chunks)[0] = 1.0
    require_refused(run("check"), "calibration.nc", "not a readable netCDF file")


@pytest.mark.parametrize("kind", ["device", "pipe", "circle"])
@pytest.mark.parametrize("name", NAMES)
def test_only_plain_files_are_read(run, file, name, kind):
    if kind == "device":
        file.symlink_to("/dev/zero")
    elif kind == "pipe":
        os.mkfifo(file)
    else:
        file.symlink_to(file.name)
    require_refused(run(name), file.name)


@pytest.mark.parametrize("name", ["check", "radiance", "sightline, map", "trust", "diagnose"])
def test_the_endless_device_itself_is_not_read(run, name):
    require_refused(run(name, Path("/dev/zero")), "/dev/zero")


@pytest.mark.parametrize("name", ["pyrometer.csv", "dark.txt", "test.yaml"])
@pytest.mark.parametrize("target", ["itself", "/dev/zero", "/none"])
def test_raw_files_that_are_links_to_nothing_that_can_be_read(tmp_path, name, target):
    shutil.copytree(TEST, tmp_path / "test")
    path = tmp_path / "test" / name
    path.unlink()
    path.symlink_to(name if target == "itself" else target)
    require_refused(judge(["check", tmp_path / "test"], tmp_path), name)


def test_a_spectrum_that_is_a_link_to_itself(tmp_path):
    shutil.copytree(TEST, tmp_path / "test")
    path = sorted((tmp_path / "test/spectrometer").iterdir())[2]
    path.unlink()
    path.symlink_to(path.name)
    require_refused(judge(["check", tmp_path / "test"], tmp_path), path.name)


@pytest.mark.parametrize("kind", ["device", "pipe", "link to a device", "circle", "beside itself"])
@pytest.mark.parametrize(
    "words",
    [
        ["correct", TEST, "--instrument", LAMP, "--out"],
        ["radiance", TEST / "test.yaml", "--out"],
        ["sightline", TEST / "test.yaml", "--map", TEST / "test.yaml", "--out"],
        ["trust", "90kW", "--out"],
    ],
    ids=["correct", "radiance", "sightline", "trust"],
)
def test_an_output_is_a_plain_file_or_nothing(tmp_path, words, kind):
    plain = out = tmp_path / ("out.md" if words[0] == "trust" else "out.nc")
    if kind == "pipe":
        os.mkfifo(out)
    elif kind == "link to a device":
        out.symlink_to("/dev/null")
    elif kind == "circle":
        out.symlink_to(out.name)
    elif kind == "beside itself":
        out.symlink_to(out.name)
        out = out / f"x{out.suffix}"
    before = kind != "device" and _identity(plain)
    ending = judge([*words, "/dev/null" if kind == "device" else out], tmp_path)
    assert ending.status == 2 and "Traceback" not in ending.message, ending
    if kind in ("device", "pipe", "link to a device"):
        require_refused(ending, "is a device or a pipe, not a plain file")
    assert not os.path.isfile("/dev/null")
    assert kind == "device" or _identity(plain) == before


def _identity(path):
    found = os.lstat(path)
    return found.st_mode, found.st_ino, found.st_mtime_ns


def test_results_of_two_folders_that_differ_behind_a_dot_lie_apart(tmp_path, monkeypatch):
    for name in ("Nr. 1", "Nr. 2", "160kW_1.5mbar"):
        (tmp_path / name).mkdir()
        assert beside(tmp_path / name, "_temperature.nc") == Path(f"{name}_temperature.nc")
    (tmp_path / "Nr. 1/shot.3.nc").touch()
    assert beside(tmp_path / "Nr. 1/shot.3.nc", "_diagnosis") == Path("shot.3_diagnosis")
    monkeypatch.chdir(tmp_path / "Nr. 2")
    assert beside(".", "_diagnosis") == Path("../Nr. 2_diagnosis")  # what is read is not written into


@pytest.mark.parametrize("absolute", [False, True])
def test_a_result_of_another_test_of_the_same_name_is_not_lost(tmp_path, monkeypatch, absolute):
    monkeypatch.chdir(tmp_path)
    base = tmp_path.parent / f"{tmp_path.name}_elsewhere" if absolute else Path()
    for k, day in enumerate(("monday", "tuesday")):
        folder = base / day / "test1"
        (folder / "calibration").mkdir(parents=True)
        (folder / "calibration/lamp.csv").write_text("copied, too\n")
        (folder / "test.yaml").write_text("title: copied from one test to the next\n")
        (folder / "signals.csv").write_text(f"{k}\n")
    monday, tuesday = base / "monday/test1", base / "tuesday/test1"
    require_of_test(beside(monday, "_temperature.nc"), monday)
    lines = [f"{io.digest(one)}  {io.told_path(one)}" for one in sources(monday)]
    xr.Dataset(attrs={"sources": "\n".join(lines)}).to_netcdf("test1_temperature.nc")
    require_of_test(Path("test1_temperature.nc"), monday)
    with pytest.raises(ValueError, match="the result of another test, of .*; name yours with --out"):
        require_of_test(Path("test1_temperature.nc"), tuesday)
    (monday / "test.yaml").write_text("title: corrected\n")
    require_of_test(Path("test1_temperature.nc"), monday)
    require_of_test(Path("test1_temperature.nc"), tmp_path / "absent")  # is refused as what it is


def test_a_folder_that_may_not_be_written_is_refused_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(ValueError, match="no right to write there; name another folder"):
        require_writable([tmp_path / "new" / "t.nc"], [])


def test_a_calibration_does_not_replace_a_pipe(tmp_path):
    (tmp_path / "lab").mkdir()
    os.mkfifo(tmp_path / "lab" / "response.nc")
    require_refused(judge(["calibrate", LAMP, "--out", tmp_path / "lab"], tmp_path), "is a device or a pipe")
    assert [path.name for path in (tmp_path / "lab").iterdir()] == ["response.nc"]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda out: out.write_text("x"), "is no folder"),
        (lambda out: (out.mkdir(), (out / "notes.txt").write_text("mine")), "holds other files (notes.txt)"),
        (lambda out: os.mkfifo(out), "is no folder"),
        (lambda out: out.symlink_to("/dev"), "holds other files"),
    ],
)
def test_a_folder_that_a_diagnosis_cannot_replace_is_refused_before_the_work(tmp_path, make, words):
    make(tmp_path / "d")
    command = ["diagnose", TEST, "--radiance", TEST, "--instrument", LAMP, "--out", tmp_path / "d"]
    require_refused(judge(command, tmp_path), words)


def test_a_diagnosis_does_not_replace_the_folder_it_reads_or_is_called_from(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for out in (TEST / "d", LAMP, EXAMPLE, ".", tmp_path.parent):
        command = ["diagnose", TEST, "--radiance", TEST, "--instrument", LAMP, "--out", out]
        words = "you stand in it" if out in (".", tmp_path.parent) else "is or holds an input, or lies in one"
        require_refused(judge(command, tmp_path), words)


@pytest.mark.parametrize(
    "flood", ["1" * 100_000, "1 " * 50_000, "a" * 100_000, "\r" * 100_000, "-" * 100_000]
)
def test_a_flood_of_one_character_is_refused_with_a_short_message(run, file, flood):
    """A pattern of quadratic cost took minutes for a word of 30 000 digits; messages quoted all of it."""
    file.write_text("1.5\n" + flood + "\n" + flood)
    for name in ("radiance", "sightline, map", "trust"):
        ending = run(name)
        require_refused(ending, file.name)
        assert len(ending.message) < 4000 and ending.message.replace("\n", "").isprintable()


def test_what_a_laboratory_types_wrong_is_told_with_its_place_and_what_to_do(tmp_path):
    """A name that promises another kind of file, one file for its folder, per cent, too few points."""
    lamp, test = (shutil.copytree(folder, tmp_path / folder.name) for folder in (LAMP, TEST))
    out = ["--out", tmp_path / "t.nc"]
    for name in ("t.csv", "t.xlsx", "t.html"):
        with pytest.raises(ArgumentTypeError, match=r"is a netCDF file: name it t\.nc"):
            options.KINDS["netcdf"](name)
    for command in ("correct", "correct-reading", "sightline", "radiance"):
        with pytest.raises(ValueError, match="--out is a netCDF file"):
            options.check(command, {"out": "t.csv"})
    for command, option, name in (
        ("heat-flux", "csv", "t.xlsx"),
        ("identify", "out", "t.nc"),
        ("correct", "html", "t.pdf"),
        ("trust", "out", "t.html"),
        ("radiance", "spectrum_text", "t.csv"),
    ):
        with pytest.raises(ValueError, match=rf"--{option.replace('_', '-')} is a .*: name it t\."):
            options.check(command, {option: name})
    for name in ("test.yaml", "pyrometer.csv"):
        command = ["correct", test / name, "--instrument", lamp, *out]
        require_refused(judge(command, tmp_path), f"is one file of a test; name its folder, {test}")
    described = test / "test.yaml"
    described.write_text(described.read_text().replace("emittance: 0.8", "emittance: 80"))
    require_refused(
        judge(["check", test], tmp_path), "emittance: 80 is not in (0, 1]; state it as a fraction"
    )
    points = lamp / "points.csv"
    points.write_text("\n".join(points.read_text().splitlines()[:4]) + "\n")
    said = f"{points}: holds 3 different source temperatures, and a curve needs 4"
    require_refused(judge(["calibrate", lamp, "--out", tmp_path / "lab"], tmp_path), said)
