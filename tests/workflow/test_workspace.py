"""One run at a time, damaged files are found, a changed configuration is noticed."""

import asyncio
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
import snakemake.io

from plasmapyro import io, workspace


@pytest.fixture
def results(tmp_path, monkeypatch):
    """A results folder, taken for this process; the environment and the locks are put back."""
    monkeypatch.setenv(workspace.SEALS, "")
    monkeypatch.setenv(workspace.SETTINGS, "")
    monkeypatch.setattr(workspace, "_held", [])
    folder = tmp_path / "results"
    assert workspace.begin(folder, {"a": 1}) == ([], False)
    yield folder
    for lock in workspace._held:
        lock.close()


def release():
    workspace._held.pop().close()


def begin_elsewhere(folder):
    """What another process gets that takes the same folder."""
    code = f"from plasmapyro import workspace; print(workspace.begin({str(folder)!r}, 1)[1])"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip()


def test_a_second_run_is_told_to_wait_until_the_first_has_ended(results):
    assert begin_elsewhere(results) == "True"
    release()
    assert begin_elsewhere(results) == "False"


def test_a_run_beside_another_is_refused():
    workspace.require_free(False)
    with pytest.raises(workspace.WorkspaceError, match="wait until it has ended"):
        workspace.require_free(True)


@pytest.mark.parametrize("place", [0, 5, -1])
def test_a_flipped_bit_is_found_and_the_file_removed(results, place):
    path = results / "a" / "b.md"
    io.write_text("some result\n", path)
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)
    release()
    assert workspace.begin(results, {}) == ([path], False)
    assert not path.exists()


def test_a_truncated_file_is_found(results):
    path = results / "b.md"
    io.write_text("some result\n", path)
    os.truncate(path, 4)
    release()
    assert workspace.begin(results, {}) == ([path], False)


def test_whole_files_and_files_of_others_stay(results):
    io.write_text("some result\n", results / "b.md")
    io.write_text("newer\n", results / "b.md")
    (results / "note.txt").write_text("of the user")
    release()
    assert workspace.begin(results, {}) == ([], False)
    assert (results / "b.md").read_text() == "newer\n" and (results / "note.txt").exists()


def test_parts_of_a_killed_job_are_cleared_away(results):
    part = results / ".x.123.part.nc"
    part.write_bytes(b"half")
    release()
    workspace.begin(results, {})
    assert not part.exists()


def test_nothing_is_noted_outside_of_a_workflow(tmp_path, monkeypatch):
    monkeypatch.delenv(workspace.SEALS, raising=False)
    io.write_text("x", tmp_path / "x.md")
    assert [path.name for path in tmp_path.rglob("*")] == ["x.md"]


def test_a_job_refuses_a_configuration_that_its_run_did_not_begin_with(results):
    workspace.same_settings({"a": 1})
    with pytest.raises(workspace.WorkspaceError, match="changed while the run was at work"):
        workspace.same_settings({"a": 2})


def test_a_folder_that_cannot_be_made_is_refused_with_a_remedy(tmp_path, monkeypatch):
    monkeypatch.setenv(workspace.SEALS, "")
    monkeypatch.setenv(workspace.SETTINGS, "")
    (tmp_path / "results").write_text("a file where the folder should be")
    with pytest.raises(workspace.WorkspaceError, match="give the folder write permission"):
        workspace.begin(tmp_path / "results", {})


@pytest.mark.parametrize("name", ["", "flow"])
def test_a_folder_without_write_permission_is_refused_by_its_name(tmp_path, monkeypatch, name):
    monkeypatch.setenv(workspace.SEALS, "")
    monkeypatch.setenv(workspace.SETTINGS, "")
    closed = tmp_path / "results" / name
    closed.mkdir(parents=True)
    # root may write everywhere, so the answer of the system is put in its mouth
    monkeypatch.setattr(workspace.os, "access", lambda place, _: place != closed)
    with pytest.raises(workspace.WorkspaceError, match=f"{closed}: cannot be written to .permission denied"):
        workspace.begin(tmp_path / "results", {})


def test_a_failed_write_keeps_the_older_file_and_says_what_to_do(tmp_path):
    path = tmp_path / "x.md"
    io.write_text("old", path)

    def full(part):
        part.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(io.StorageError, match=r"No space left on device.*MB are free there\); free space"):
        io.store(path, full)
    assert [found.name for found in tmp_path.iterdir()] == ["x.md"] and path.read_text() == "old"


def test_results_of_a_clock_that_ran_ahead_are_dated_now_and_alike(results):
    tomorrow, paths = time.time() + 86400, [results / name for name in ("a.nc", "group/b.nc", "old.nc")]
    for path in paths:
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(b"x")
        os.utime(path, (tomorrow, tomorrow))
    os.utime(paths[-1], (1e9, 1e9))
    release()
    workspace.begin(results, {"a": 1})
    first, second, old = (path.stat().st_mtime_ns for path in paths)
    assert first == second  # none of them looks older than another that it is made from
    assert time.time_ns() - 60e9 < first <= time.time_ns()
    assert old == 10**18


def test_a_run_is_not_described_by_files_that_were_edited_meanwhile(tmp_path):
    paths = [tmp_path / name for name in ("90kW.yaml", "100kW.yaml")]
    for path in paths:
        path.write_text("emittance: 0.85")
    begun_with = [io.digest(path) for path in paths]
    workspace.require_unchanged(paths, begun_with)
    paths[1].write_text("emittance: 0.5")
    with pytest.raises(workspace.WorkspaceError, match=r"/100kW.yaml: changed .* Call again"):
        workspace.require_unchanged(paths, begun_with)


def test_a_file_is_digested_anew_only_when_it_has_changed(tmp_path, monkeypatch):
    asked = []

    async def digested(file, threshold):
        asked.append(threshold)
        return Path(file).read_text()

    monkeypatch.setattr(snakemake.io._IOFile, "checksum", digested)
    workspace.digest_once()
    path = tmp_path / "a.nc"

    def found(threshold=10):
        return asyncio.run(snakemake.io._IOFile.checksum(str(path), threshold))

    path.write_text("one")
    assert [found(), found(), found(20)] == ["one"] * 3 and asked == [10, 20]
    path.write_text("other")
    assert found() == "other" and asked == [10, 20, 10]


def test_the_scheduler_is_woken_once_in_a_while_however_often_it_asks(monkeypatch):
    from snakemake.scheduling.job_scheduler import JobScheduler

    asked, clock = [], []
    monkeypatch.setattr(JobScheduler, "_schedule_reevalutation", lambda scheduler, delay: asked.append(delay))
    monkeypatch.setattr(workspace.time, "monotonic", lambda: clock[-1])
    workspace.wake_once()
    for now in (0.0, 0.5, 0.9, 1.0, 1.1, 2.0):
        clock.append(now)
        JobScheduler._schedule_reevalutation("a scheduler", 1.0)
    assert asked == [1.0] * 3
