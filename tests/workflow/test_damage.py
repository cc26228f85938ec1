"""A damaged byte is never used: results are compared with what was noted of them when they are read."""

import os
import re
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
from test_workflow import project, snakemake  # noqa: F401 (a fixture)

from plasmapyro import contracts, foreign, io, seals, workspace
from plasmapyro.commands.calibrate import RESPONSE
from plasmapyro.instrument.stage import band_response


@pytest.fixture
def results(tmp_path, monkeypatch):
    """The folder of a run at work."""
    monkeypatch.setenv(workspace.SEALS, str(tmp_path / "results" / workspace.FOLDER))
    return tmp_path / "results"


@pytest.fixture(scope="module")
def response():
    return band_response(**RESPONSE)


def flip(path, place, bit=16):
    """One bit of a file turned over, its date as before."""
    stat = path.stat()
    content = bytearray(path.read_bytes())
    content[place] ^= bit
    path.write_bytes(content)
    os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))


def place_of(path, values):
    place = path.read_bytes().find(np.asarray(values, "<f8").tobytes())
    assert place > 0
    return place


DAMAGED = "response.nc: damaged or replaced since the workflow wrote it"


@pytest.mark.parametrize("place", [0, 0.1, 0.5, 0.9, 0.9999])
def test_a_bit_that_flips_during_a_run_stops_the_job_that_reads_it(results, response, place):
    path = results / "instrument/response.nc"
    io.write(response, path, "response")
    io.read(path, "response")
    flip(path, int(place * path.stat().st_size))
    for use in (lambda: io.read(path, "response"), lambda: io.digest(path), lambda: io.read_bytes(path)):
        with pytest.raises(contracts.ContractError, match=DAMAGED):
            use()


def test_nothing_is_made_from_a_source_that_was_damaged_meanwhile(results, response):
    io.write(response, results / "response.nc", "response")
    flip(results / "response.nc", 5000)
    with pytest.raises(contracts.ContractError, match=DAMAGED):
        io.write(response, results / "copy.nc", "response", sources=[results / "response.nc"])
    assert not (results / "copy.nc").exists()


def test_a_command_outside_of_the_workflow_finds_the_damage_too(results, response, monkeypatch):
    io.write(response, results / "response.nc", "response")
    io.write_text("a page", results / "page.md")
    monkeypatch.delenv(workspace.SEALS)
    io.read(results / "response.nc", "response")
    flip(results / "response.nc", -9)
    flip(results / "page.md", 0)
    with pytest.raises(contracts.ContractError, match=DAMAGED):
        io.read(results / "response.nc", "response")
    with pytest.raises(contracts.ContractError, match="page.md: damaged"):
        io.read_text(results / "page.md")


def test_a_file_that_no_workflow_noted_is_guarded_by_the_checksum_of_its_format(tmp_path, response):
    path = tmp_path / "lab.nc"
    io.write(response, path, "response")
    place = place_of(path, response.responsivity_wide.values)
    for step in (0, 8 * 200 + 6, 8 * response.sizes["wavelength"] - 1):
        flip(path, place + step)
        with pytest.raises(contracts.ContractError, match="lab.nc: not a readable netCDF file"):
            io.read(path, "response")
        flip(path, place + step)
    io.read(path, "response")


def test_a_result_written_anew_is_read_without_complaint(results):
    for words in ("first", "second"):
        io.write_text(words, results / "a" / "b.md")
        assert io.read_text(results / "a" / "b.md") == words


def test_a_folder_of_results_is_swapped_as_a_whole_and_noted(results):
    folder = results / "diagnosis" / "mine"

    def writer(words):
        def write(made):
            io.write_text(words, made / "a.md")
            if words != "first":
                io.write_text(words, made / "b.md")
            if words == "broken":
                raise ValueError("a fault of ours")

        return write

    io.store_folder(folder, writer("first"))
    with pytest.raises(ValueError, match="a fault of ours"):
        io.store_folder(folder, writer("broken"))
    assert {path.name: path.read_text() for path in folder.iterdir()} == {"a.md": "first"}
    io.store_folder(folder, writer("second"))
    assert {path.name: path.read_text() for path in folder.iterdir()} == {"a.md": "second", "b.md": "second"}
    assert [path.name for path in folder.parent.iterdir()] == ["mine"]
    notes = sorted(str(note.relative_to(results)) for note in results.rglob("*.sha256"))
    assert notes == [f".seals/diagnosis/mine/{name}.md.sha256" for name in "ab"]
    flip(folder / "a.md", 0)
    with pytest.raises(contracts.ContractError, match="a.md: damaged"):
        io.read_text(folder / "a.md")


def test_a_folder_that_cannot_take_its_place_leaves_the_old_one(tmp_path, monkeypatch):
    folder = tmp_path / "mine"
    io.store_folder(folder, lambda made: (made / "a.md").write_text("first"))
    rename = os.rename

    def refused(source, target):
        if str(source).endswith(".part"):
            raise OSError(5, "Input/output error")
        rename(source, target)

    monkeypatch.setattr(os, "rename", refused)
    with pytest.raises(io.StorageError, match="mine: could not be written .*Input/output error"):
        io.store_folder(folder, lambda made: (made / "a.md").write_text("second"))
    assert [path.name for path in tmp_path.iterdir()] == ["mine"] and (folder / "a.md").read_text() == "first"


def test_parts_of_a_folder_of_a_killed_job_are_cleared_away(tmp_path, monkeypatch):
    for name in (workspace.SEALS, workspace.SETTINGS):
        monkeypatch.setenv(name, "")
    monkeypatch.setattr(workspace, "_held", [])
    for name in (".mine.7.part", ".mine.7.part-old"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "a.md").write_text("half")
        (tmp_path / name / ".a.7.part.md").write_text("half")
    assert workspace.begin(tmp_path, {}) == ([], False)
    workspace._held.pop().close()
    assert [path.name for path in tmp_path.iterdir()] == [workspace.FOLDER]


def test_a_bit_flipped_between_two_jobs_of_one_run_stops_it_and_the_next_run_repairs(project):  # noqa: F811
    target, made = project / "results/instrument/response.nc", "results/instrument/ratio_curve.nc"
    whole = snakemake(project, made)
    assert whole.returncode == 0, whole.stdout + whole.stderr
    expected = {name: (project / name).read_bytes() for name in (made, "results/instrument/response.nc")}
    (project / made).unlink()
    with xr.open_dataset(target) as stored:
        place = place_of(target, stored.responsivity_wide.values) + 8 * 300 + 6
    command = [sys.executable, "-m", "snakemake", "--cores", "1", made]
    environment = {**os.environ, "PATH": f"{os.path.dirname(sys.executable)}:{os.environ['PATH']}"}
    run = subprocess.Popen(
        command, cwd=project, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    words = []
    for line in run.stdout:
        words.append(line)
        if re.match(r"(local)?rule ratio_curve", line):
            flip(target, place)
    run.stdout.close()
    assert run.wait() != 0 and not (project / made).exists()
    assert f"results/instrument/{DAMAGED}" in "".join(words)
    again = snakemake(project, made)
    assert again.returncode == 0, again.stdout + again.stderr
    assert {name: (project / name).read_bytes() for name in expected} == expected


def test_a_path_beside_the_results_is_not_noted(results, tmp_path):
    io.write_text("x", tmp_path / "elsewhere.md")
    assert seals.noted(tmp_path / "elsewhere.md") is None
    assert foreign.unfit(tmp_path / "elsewhere.md", 10) is None


def test_sources_never_hold_the_path_of_a_machine(tmp_path, response, monkeypatch):
    folder = tmp_path / "here"
    (folder / "raw").mkdir(parents=True)
    for path in (folder / "raw/a.csv", tmp_path / "b.csv"):
        path.write_text("x")
    monkeypatch.chdir(folder)
    given = [folder / "raw/a.csv", tmp_path / "b.csv", "raw/a.csv", "../b.csv"]
    io.write(response, "out.nc", "response", sources=given)
    told = [line.split()[1] for line in io.read("out.nc", "response").attrs["sources"].splitlines()]
    assert told == ["raw/a.csv", "b.csv", "raw/a.csv", "../b.csv"]


def test_a_full_disk_is_told_once_when_several_files_belong_together(tmp_path, response, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", full)
    with pytest.raises(io.StorageError) as caught:
        io.write_labelled([(tmp_path / "a.nc", response), (tmp_path / "b.nc", response)])
    assert str(caught.value).count("No space left") == str(caught.value).count("could not be written") == 1


def test_text_is_read_with_any_line_ends(tmp_path):
    (tmp_path / "a.txt").write_bytes(b"a\r\nb\rc\n")
    assert io.read_text(tmp_path / "a.txt") == "a\nb\nc\n"


def test_no_result_takes_the_place_of_a_pipe_or_a_device(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "null").symlink_to("/dev/null")
    for name in ("pipe", "null"):
        with pytest.raises(io.StorageError, match=f"{name}: is not a plain file and is not replaced"):
            io.write_text("x", tmp_path / name)
    assert sorted(path.name for path in tmp_path.iterdir() if not path.is_file()) == ["null", "pipe"]
