"""A study as a user meets it: what is planned, what is not computed twice, what a scheduler gets to see."""

import re

import clone
import numpy as np
import yaml
from small_study import ROOT, prepare, snakemake, write
from snakemake.cli import get_argument_parser

from plasmapyro import io
from plasmapyro.analysis import stage as analysis
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.sightline.stage import line_of_sight
from plasmapyro.study import stage

SAME_RTOL = 1e-12  # the same computation by another way


def planned(folder, *arguments):
    """Rule -> number of jobs of a dry run, and all that it says."""
    run = clone.snakemake(folder, "--dry-run", *arguments, "--configfile", "study.yaml")
    return clone.planned(run), run.stdout + run.stderr


def test_a_study_is_planned_where_emittances_cost_no_job_and_angles_no_flow(project):
    write(project)
    before, _ = planned(project)
    assert before["study_flow"] == 6 and before["study_signal"] == 12
    assert before["study_gather"] == before["flow_start"] == before["gas_table"] == 1
    assert not {"flow", "radiance", "all"} & before.keys()
    write(project, emittance=[k / 10 for k in range(1, 11)], angle_deg=[30, 35, 40, 45, 50])
    jobs, _ = planned(project)
    assert jobs == {**before, "study_signal": 5 * 6}


def test_the_main_job_is_one_name_away(project):
    write(project)
    jobs, _ = planned(project, "all")
    assert jobs["flow"] == 9 and "study_flow" not in jobs


def test_a_scheduler_sees_packets(project):
    """36 flows of at most four levels and 360 sight lines: packets of 8 and of 40."""
    write(
        project,
        numerical_power_kw=[60, 70, 80, 90, 100, 110],
        chamber_pressure_mbar=[40, 50, 60],
        mass_flow_rate_g_s=[14, 16],
        angle_deg=list(range(25, 75, 5)),
    )
    _, text = planned(project, "--profile", "profiles/slurm")
    packets = re.findall(r"Group job (study_\w+)", text)
    assert packets.count("study_signals") == 9
    assert 5 <= len(packets) - 9 <= 8


def options_of(profile):
    return yaml.safe_load((ROOT / f"profiles/{profile}/config.yaml").read_text())


def test_the_profiles_pack_the_same_groups_and_hold_known_options_only():
    slurm, kubernetes = options_of("slurm"), options_of("kubernetes")
    assert [one for one in slurm["group-components"] if "study" in one] == kubernetes["group-components"]
    assert kubernetes["resources"] == slurm["resources"]
    known = get_argument_parser()._option_string_actions
    for options, ours in ((slurm, ("slurm-",)), (kubernetes, ("kubernetes-", "storage-s3-"))):
        strange = [key for key in options if f"--{key}" not in known and not key.startswith(ours)]
        assert strange == []


def test_a_wrong_study_stops_before_the_first_job(project):
    write(project, angle_deg=[35, 20])
    code, text = snakemake(project)
    assert code != 0 and "angle_deg: 20 deg; a line of sight this close to the axis" in text
    assert not (project / "results").exists()


def test_a_small_study_from_files_to_figures(project):
    """Two flows, one of them not to be found, two angles and two emittances; the flows are given."""
    config, flow = prepare(project)
    code, text = snakemake(project)
    assert code == 0, text
    study = io.read(project / "results/study.nc", "study")
    assert dict(study.sizes) == {
        "numerical_power": 2, "chamber_pressure": 1, "mass_flow_rate": 1, "emittance": 2,
        "sightline_angle": 2, "band": 2, "object_temperature": 5,
    }  # fmt: skip
    there, missing = study.isel(numerical_power=0), study.isel(numerical_power=1)
    assert (there.study_status == 0).all() and (missing.study_status == stage.EXTINGUISHED).all()
    assert np.isnan(missing.error_limit).all()
    assert study.attrs["sources"].count("study/signal") == 4 and '"emittance"' in study.attrs["configuration"]
    against_the_single_stages(project, config, flow, there.isel(chamber_pressure=0, mass_flow_rate=0))
    for figure in ("study_limit", "study_emittance"):
        assert (project / f"results/figures/{figure}.png").stat().st_size > 5000
    write(project, numerical_power_kw=[80, 90], chamber_pressure_mbar=[50], emittance=[0.5, 0.7, 0.85])
    jobs, _ = planned(project)
    assert set(jobs) == {"study_gather", "figures_study", "study"}


def against_the_single_stages(project, config, flow, study):
    """One condition of the study by the stages that the main job uses."""
    view, light = config["sightline"], config["radiation"]
    response = io.read(project / "results/instrument/response.nc", "response")
    curve = io.read(project / "results/instrument/ratio_curve.nc", "ratio_curve")
    line = line_of_sight(
        flow,
        angle=np.radians(50),
        points=view["points"],
        window_distance=view["window_distance_mm"] * 1e-3,
        instrument_distance=view["instrument_distance_mm"] * 1e-3,
        laboratory_temperature=view["laboratory_temperature_k"],
        laboratory_pressure=view["laboratory_pressure_pa"],
    )
    radiation = line_of_sight_radiance(
        line,
        response,
        wavelength_range=[edge * 1e-9 for edge in light["wavelength_nm"]],
        grid_points=light["grid_points"],
        slit_fwhm=light["slit_fwhm_nm"] * 1e-9,
    )
    gas = analysis.gather({"here": radiation}, emittance=[0.85])
    read = analysis.apparent_temperature(
        gas, response, curve, object_temperature=study.object_temperature.values
    )
    one = study.sel(emittance=0.85).sel(sightline_angle=np.radians(50), method="nearest")
    np.testing.assert_allclose(one.gas_signal, radiation.band_signal, rtol=SAME_RTOL, atol=0)
    np.testing.assert_allclose(one.relative_error, read.relative_error[0], rtol=SAME_RTOL, atol=0)
    assert float(one.peak_temperature) == float(line.temperature.max())
    other = study.sel(emittance=0.85).sel(sightline_angle=np.radians(35), method="nearest")
    assert (other.gas_signal > one.gas_signal).all()  # the flatter path sees more of the jet
