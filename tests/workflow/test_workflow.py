"""The workflow as a user meets it: what runs, what reruns, what a wrong key says."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def snakemake(folder, *arguments):
    command = [sys.executable, "-m", "snakemake", "--cores", "1", *arguments]
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)


@pytest.fixture
def project(tmp_path):
    """A clean copy of the workflow, as after a clone."""
    folder = tmp_path / "clone"
    folder.mkdir()
    shutil.copy(ROOT / "Snakefile", folder)
    for name in ("config", "workflow", "profiles"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def planned(run):
    """Rule -> number of jobs that a dry run announces."""
    assert run.returncode == 0, run.stdout + run.stderr
    table = run.stdout.split("Job stats:")[1].split("total")[0]
    return {name: int(count) for name, count in re.findall(r"^(\w+)\s+(\d+)$", table, re.MULTILINE)}


def test_the_main_job_plans_nine_conditions(project):
    jobs = planned(snakemake(project, "--dry-run"))
    assert jobs["flow_start"] == 1
    assert jobs["flow"] == jobs["sightline"] == jobs["radiance"] == 9


def test_the_light_on_the_surface_is_a_target_of_its_own(project):
    assert "reflected_radiance" not in planned(snakemake(project, "--dry-run"))
    jobs = planned(snakemake(project, "--dry-run", "results/reflection/90kW.nc"))
    assert jobs["surface_view"] == jobs["reflected_radiance"] == 1


def test_a_tenth_condition_is_one_more_file(project):
    first = (project / "config/conditions/90kW.yaml").read_text()
    (project / "config/conditions/95kW.yaml").write_text(first.replace("90", "95"))
    jobs = planned(snakemake(project, "--dry-run"))
    assert jobs["flow"] == jobs["radiance"] == 10


def test_a_test_may_hold_one_instrument_and_ready_radiances(project):
    (project / "config/tests/mine.yaml").write_text(
        "data_folder: mydata\ninstruments: [spectrometer]\ncalibrated_spectra: true\n"
    )
    (project / "mydata").mkdir()
    (project / "mydata/test.nc").write_bytes(b"")
    jobs = planned(snakemake(project, "--dry-run"))
    assert jobs["spectrometer_correction"] == jobs["figures_spectrometer"] == 2
    assert jobs["pyrometer_correction"] == jobs["figures_pyrometer"] == jobs["figures_both"] == 1


def test_a_folder_of_raw_files_is_read_first(project):
    (project / "config/tests/mine.yaml").write_text(
        "data_folder: mydata\ninstruments: [pyrometer]\ncalibrated_spectra: true\n"
    )
    (project / "mydata").mkdir()
    facts = ("injection_time: 0", "plasma_off_time: 9", "reference_window: [0, 3]", "emittance: 0.8")
    facts += (
        "emittance_uncertainty: 0.1",
        "window_transmittance_pyrometer: 1",
        "pyrometer_integration_time: 0.01",
    )
    (project / "mydata/test.yaml").write_text(
        "attributes: {origin: measured, " + ", ".join(facts) + "}\npyrometer:\n  columns:\n"
        "    time: {name: t, unit: s}\n    signal_wide: {name: a, unit: nA}\n"
        "    signal_narrow: {name: b, unit: nA}\n"
    )
    (project / "mydata/pyrometer.csv").write_text("t,a,b\n" + "".join(f"{i},{i},{i}\n" for i in range(9)))
    run = snakemake(project, "results/experiment/mine/test.nc")
    assert run.returncode == 0, run.stdout + run.stderr
    assert (project / "results/experiment/mine/test.nc").exists()
    assert planned(snakemake(project, "--dry-run"))["pyrometer_correction"] == 2
    again = snakemake(project, "--dry-run", "results/experiment/mine/test.nc")
    assert "Nothing to be done" in again.stdout + again.stderr


def test_a_folder_of_raw_calibration_files_is_read_first(project):
    shutil.copytree(ROOT / "docs" / "example" / "calibration", project / "lamp")
    config = project / "config" / "config.yaml"
    words = config.read_text()
    for key in ("calibration_points", "spectrometer_counts"):
        words = re.sub(rf"{key}: \S+", f"{key}: lamp", words)
    config.write_text(words)
    targets = ["results/instrument/calibration.nc", "results/instrument/spectrometer_calibration.nc"]
    plan = snakemake(project, "-n", *targets).stdout
    for rule in ("read_points", "read_exposures", "spectrometer_calibration"):
        assert re.search(rf"^{rule} +1$", plan, re.MULTILINE), plan
    assert "twin" not in plan


def test_minimal_takes_two_conditions(project):
    assert planned(snakemake(project, "--dry-run", "--configfile", "config/minimal.yaml"))["flow"] == 2


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        ("config/conditions/90kW.yaml", "emittance:", "emitance:", "did you mean 'emittance'?"),
        ("config/config.yaml", "slit_fwhm_nm:", "slit_fwmh_nm:", "did you mean 'slit_fwhm_nm'?"),
        ("config/config.yaml", "angle_deg: 35", "angle_deg: 135", "sightline.angle_deg: 135"),
        ("config/tests/csic_160kW.yaml", "data_folder:", "datafolder:", "did you mean 'data_folder'?"),
        ("config/config.yaml", "field_condition: 90kW", "field_condition: 91kW", "did you mean '90kW'?"),
    ],
)
def test_a_wrong_configuration_stops_before_the_first_job(project, file, old, new, message):
    path = project / file
    path.write_text(path.read_text().replace(old, new))
    run = snakemake(project)
    assert run.returncode != 0
    assert message in run.stdout + run.stderr
    assert not (project / "results").exists()


@pytest.fixture
def half_way(project):
    """The project after a run up to the responses."""
    run = snakemake(project, "results/instrument/response.nc")
    assert run.returncode == 0, run.stdout + run.stderr
    return project


def test_a_second_call_has_nothing_to_do(half_way):
    assert (
        "Nothing to be done"
        in snakemake(half_way, "results/instrument/response.nc").stderr
        + snakemake(half_way, "results/instrument/response.nc").stdout
    )


def test_a_changed_value_reruns_what_depends_on_it_and_nothing_else(half_way):
    assert snakemake(half_way, "results/analysis/surface_radiance.nc").returncode == 0
    path = half_way / "config/config.yaml"
    path.write_text(path.read_text().replace("edge_sigma_nm: ", "edge_sigma_nm: 1"))
    both = ("results/instrument/response.nc", "results/analysis/surface_radiance.nc")
    jobs = planned(snakemake(half_way, "--dry-run", *both))
    assert jobs.get("response") == 1
    assert "surface_radiance" not in jobs


def test_a_run_killed_in_the_middle_goes_on_to_the_same_bytes(half_way):
    """A job that was cut off leaves its mark and perhaps a part of a file; neither is in the way."""
    whole = (half_way / "results/instrument/response.nc").read_bytes()
    (half_way / "results/instrument/response.nc").unlink()
    (half_way / "results/instrument/response.nc.part").write_bytes(whole[:100])
    run = subprocess.Popen(
        [sys.executable, "-m", "snakemake", "--cores", "1", "results/instrument/response.nc"],
        cwd=half_way,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    for line in run.stderr:
        if "rule response" in line:
            break
    os.killpg(run.pid, 9)
    run.wait()
    run.stderr.close()
    again = snakemake(half_way, "results/instrument/response.nc")
    assert again.returncode == 0, again.stdout + again.stderr
    assert (half_way / "results/instrument/response.nc").read_bytes() == whole
