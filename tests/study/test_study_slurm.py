"""A small study through a real Slurm on this machine gives the bytes of a local run, in a few packets."""

import re
import shutil
import subprocess

import pytest
from clone import copy_of_the_project
from small_study import ROOT, prepare, snakemake

SCRIPT = ROOT / "tests/runs/one_machine.sh"
PLAIN = "/usr/bin:/bin"  # where Debian does not put the daemons
CANNOT = 2  # exit code of the script where there can be no Slurm


@pytest.fixture
def slurm(tmp_path):
    """Controller and node daemon for as long as the test takes; skipped where the script says why not."""
    folder = tmp_path / "slurm"
    begun = subprocess.run([SCRIPT, "start", folder], stderr=subprocess.PIPE, text=True)
    if begun.returncode == CANNOT:
        pytest.skip(begun.stderr.strip())
    assert begun.returncode == 0, begun.stderr
    yield
    subprocess.run([SCRIPT, "stop", folder], check=True)


def results(folder):
    """Name -> bytes of every result of the study."""
    root = folder / "results"
    return {str(path.relative_to(root)): path.read_bytes() for path in sorted(root.rglob("*.nc"))}


def test_a_study_through_slurm_gives_the_same_bytes(tmp_path, slurm):
    folders = [tmp_path / name for name in ("local", "cluster")]
    for folder in folders:
        folder.mkdir()
        prepare(copy_of_the_project(folder), angle_deg=[35])
    code, text = snakemake(folders[0], "results/study.nc")
    assert code == 0, text
    code, text = snakemake(folders[1], "results/study.nc", "--profile", "profiles/slurm")
    assert code == 0, text
    local, cluster = (results(folder) for folder in folders)
    assert local.keys() == cluster.keys() and "study.nc" in local
    assert [name for name in local if local[name] != cluster[name]] == []
    packets = re.findall(r"has been submitted with SLURM jobid (\d+)", text)
    assert len(packets) == 1, text  # both sight lines in one packet, the rest beside Snakemake


@pytest.mark.skipif(shutil.which("slurmctld", path=PLAIN), reason="Slurm lies among the plain programs")
def test_without_slurm_the_script_says_what_to_install(tmp_path):
    run = subprocess.run(
        [SCRIPT, "start", tmp_path / "slurm"], env={"PATH": PLAIN}, capture_output=True, text=True
    )
    assert run.returncode == CANNOT
    assert run.stderr == "slurmctld is missing: apt-get install slurm-wlm munge\n"
    assert not (tmp_path / "slurm").exists()
