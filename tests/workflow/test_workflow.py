"""The workflow as a user meets it: what runs, what reruns, what a wrong key says."""

import json
import os
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
import yaml
from clone import ROOT, copy_of_the_project, planned, snakemake
from gas_signals import gas

from plasmapyro import io
from plasmapyro.diagnosis.effects.gas import species_lines
from plasmapyro.radiation.foreign import oxygen_triplet
from plasmapyro.radiation.stage import line_of_sight_radiance

PAPER = ("5b_line_of_sight", "6_spectral_radiance", "7a_visibility_factors", "8c_error_map")


@pytest.fixture
def project(tmp_path):
    """A clean copy of the workflow, as after a clone."""
    return copy_of_the_project(tmp_path / "clone")


def test_the_main_job_plans_nine_conditions(project):
    jobs = planned(snakemake(project, "--dry-run"))
    assert jobs["flow_start"] == 1
    assert jobs["flow"] == jobs["sightline"] == jobs["radiance"] == 9


def test_the_light_on_the_surface_is_a_target_of_its_own(project):
    assert "reflected_radiance" not in planned(snakemake(project, "--dry-run"))
    jobs = planned(snakemake(project, "--dry-run", "results/reflection/90kW.nc"))
    assert jobs["surface_view"] == jobs["reflected_radiance"] == 1


def test_conditions_of_ones_own_are_files_more_and_touch_nothing_of_the_paper(project):
    """Another power; another pressure, with a power that is there already; another emittance."""
    first = (project / "config/conditions/90kW.yaml").read_text()
    folder = project / "config/conditions"
    (folder / "95kW.yaml").write_text(first.replace("90", "95"))
    (folder / "wet.yaml").write_text(first.replace("chamber_pressure_mbar: 50", "chamber_pressure_mbar: 20"))
    (folder / "0.yaml").write_text(first.replace("emittance: 0.85", "emittance: 0.5"))
    run = snakemake(project, "--dry-run")
    jobs = planned(run)
    assert jobs["flow"] == jobs["radiance"] == 12
    for rule in ("gas_signal", "error_map", "figures_analysis", "figures_flow", "gas_spectra", "trust"):
        assert jobs[rule] == 2, rule
    assert jobs["claims"] == jobs["band_design"] == jobs["figures_design"] == 1
    assert "results/figures/fig8c_error_map_own.svg" in run.stdout
    paper = ["results/claims.md", *[f"results/figures/fig{name}.svg" for name in PAPER]]
    shown = snakemake(project, "--dry-run", "--forceall", *paper)
    assert planned(shown)["radiance"] == 9
    assert not re.findall(r"results/\S*(?:95kW|wet|_own|/0)\.\w+", shown.stdout)


def test_each_gas_has_a_table_a_start_and_ladders_of_its_own(project):
    for name in ("nitrogen_70kW", "argon_60kW"):
        shutil.copy(project / f"config/more/{name}.yaml", project / "config/conditions")
    warm = (project / "config/conditions/80kW.yaml").read_text() + "flow: {back_wall_temperature_k: 7200}\n"
    (project / "config/conditions/warm.yaml").write_text(warm)
    whole = snakemake(project, "--dry-run")
    jobs = planned(whole)
    assert jobs["gas_table"] == jobs["flow_start"] == 3
    assert jobs["radiance"] == jobs["probe_readings"] == 12
    assert "results/gas/air11_Ar_0.0093.nc" in whole.stdout
    (pairs,) = re.findall(r"rule facility:\n    input: (.*)", whole.stdout)
    assert "results/facility/70kW.nc" in pairs and not re.search("nitrogen|warm", pairs)
    alone = snakemake(project, "--dry-run", "results/radiation_variations/nitrogen_70kW.nc")
    assert "results/flow/start/N2.nc" in alone.stdout
    assert not re.findall(r"air11|start/reference|/70kW", alone.stdout)
    shutil.copy(project / "config/more/nitrogen_test.yaml", project / "config/tests")
    chain = planned(snakemake(project, "--dry-run", "results/diagnosis/nitrogen_test/index.html"))
    needed = {"flow", "radiance", "twin_test", "findings", "joint_estimate", "diagnosis"}
    assert (
        needed <= set(chain) and chain["gas_table"] == chain["flow_start"] == 2
    )  # air for the published test


HANDED = """import json
from pathlib import Path
names = ("mixing", "numerical_power_kw", "back_wall_temperature_k", "adiabatic_walls", "radiation_factor")
names += ("tube_wall_temperature_k", "chamber_wall_temperature_k")
handed = {name: snakemake.params[name] for name in names}
handed["loss"] = list(snakemake.input.emission)
Path(snakemake.output[0]).write_text(json.dumps(handed))
"""


def handed_to_flows(project, *conditions):
    """Settings of the flows of conditions: the rule's script is replaced by one that writes them down."""
    (project / "workflow/scripts/flow.py").write_text(HANDED)
    for name in ("gas/air11", "gas/emission/air11", "flow/start/reference"):
        (project / f"results/{name}.nc").parent.mkdir(parents=True, exist_ok=True)
        (project / f"results/{name}.nc").write_bytes(b"")
    paths = [f"results/flow/{name}.nc" for name in conditions]
    run = snakemake(project, *paths, "--allowed-rules", "flow")
    assert run.returncode == 0, run.stderr
    return [json.loads((project / path).read_text()) for path in paths]


@pytest.mark.parametrize("model, common, both", [("best", 0.08, 0.1), ("paper", 0, 0.06)])
def test_mixing_of_a_condition_adds_to_that_of_the_model_as_squares(project, model, common, both):
    """Eddy viscosities add."""
    config, folder = project / "config/config.yaml", project / "config/conditions"
    head, best, rest = config.read_text().replace("model: paper", f"model: {model}").partition("  best:")
    config.write_text(head + best + rest.replace("mixing: 0", "mixing: 0.08", 1))
    effects = "effects: [{id: mixing, amplitude: 0.06}, {id: power, amplitude: -0.1}]\n"
    (folder / "mixed.yaml").write_text((folder / "90kW.yaml").read_text() + effects)
    mixed, plain = handed_to_flows(project, "mixed", "90kW")
    assert (mixed["mixing"], mixed["numerical_power_kw"]) == pytest.approx((both, 81))
    assert (plain["mixing"], plain["numerical_power_kw"]) == (common, 90)


def test_a_condition_may_have_walls_and_a_model_of_its_own(project):
    folder = project / "config/conditions"
    for name, own in {
        "walls": "{back_wall_temperature_k: 7200, chamber_wall_temperature_k: 600, adiabatic_walls: [probe]}",
        "full": "{model: best, mixing: 0.05}",
    }.items():
        (folder / f"{name}.yaml").write_text((folder / "90kW.yaml").read_text() + f"flow: {own}\n")
    walls, full, plain = handed_to_flows(project, "walls", "full", "90kW")
    assert (walls["back_wall_temperature_k"], walls["adiabatic_walls"]) == (7200, ["probe"])
    assert [one["chamber_wall_temperature_k"] for one in (walls, plain)] == [600, 350]
    assert (plain["back_wall_temperature_k"], plain["adiabatic_walls"]) == (350, [])
    assert walls["loss"] == plain["loss"] == [] and full["loss"] == ["results/gas/emission/air11.nc"]
    assert (full["radiation_factor"], full["mixing"], plain["mixing"]) == (1, 0.05, 0)


def test_the_diagnosis_reads_the_ladder_of_what_a_test_names(project):
    """The file of a measured test names the condition; its powers are those of the same pressure."""
    first = (project / "config/conditions/90kW.yaml").read_text()
    for power in (90, 95):
        wet = first.replace("chamber_pressure_mbar: 50", "chamber_pressure_mbar: 20").replace(
            "_kw: 90", f"_kw: {power}"
        )
        (project / f"config/conditions/wet{power}.yaml").write_text(wet)
    (project / "config/tests/csic_160kW.yaml").rename(project / "aside.yaml")
    (project / "config/tests/mine.yaml").write_text(
        "data_folder: mydata\ninstruments: [pyrometer]\ncalibrated_spectra: true\n"
    )
    config = project / "config/config.yaml"
    config.write_text(config.read_text().replace("test: csic_160kW", "test: mine"))
    (project / "mydata").mkdir()
    xr.Dataset(attrs={"condition": "wet90"}).to_netcdf(project / "mydata/test.nc")
    run = snakemake(project, "--dry-run", "results/diagnosis/mine/diagnosis.json")
    assert planned(run)["radiance"] == 3  # those of 20 mbar, and diagnosis.condition for its varied spectra
    inputs = re.search(r"rule diagnosis:\n    input: (.*)", run.stdout)[1]
    assert "results/radiation_variations/wet90.nc" in inputs
    assert set(re.findall(r"results/radiation/(\w+).nc", inputs)) == {"wet90", "wet95"}
    xr.Dataset(attrs={"condition": "wet91"}).to_netcdf(project / "mydata/test.nc")
    assert "condition of test mine: no file for 'wet91'; did you mean" in snakemake(project).stderr


READING = """
readings:
  mine: {file: log.dat, condition: 60kW, floor_k: 1264, emittance_uncertainty: 0.05, power_uncertainty: 0.05,
    engine_uncertainty: 0.1, draws: 40, seed: 1}
"""


def test_a_log_of_displayed_temperatures_goes_back_through_the_gas_of_a_condition(project):
    """The light of the gas is typed, the instrument computed; surfaces as in the command's test."""
    config, out = project / "config/config.yaml", "results/reading/mine.nc"
    config.write_text(config.read_text() + READING.replace("60kW", "61kW"))
    assert "readings.mine.condition: no file for '61kW'" in snakemake(project, "--dry-run").stderr
    config.write_text(config.read_text().replace("61kW", "60kW"))
    (project / "log.dat").write_text("time [s] Ts [K]\n1 1400.5\n2 1559\n3 1200\n")
    assert planned(snakemake(project, "--dry-run"))["corrected_reading"] == 1
    io.write(gas(), project / "results/analysis/gas_signal.nc", "gas_signal")
    only = ("--allowed-rules", "corrected_reading", "response", "ratio_curve")
    run = snakemake(project, out, *only)
    assert run.returncode == 0, run.stderr
    found = io.read(project / out, "corrected_reading")
    assert found.surface_temperature.values[:2] == pytest.approx([1398, 1558], abs=3)
    assert list(found.corrected_reading_status.values) == [1, 1, 3]


def test_a_test_may_hold_one_instrument_and_ready_radiances(project):
    (project / "config/tests/mine.yaml").write_text(
        "data_folder: mydata\ninstruments: [spectrometer]\ncalibrated_spectra: true\n"
    )
    (project / "mydata").mkdir()
    (project / "mydata/test.nc").write_bytes(b"")
    jobs = planned(snakemake(project, "--dry-run"))
    assert jobs["spectrometer_correction"] == 2
    assert jobs["pyrometer_correction"] == 1
    assert jobs["figures_spectrometer"] == jobs["figures_pyrometer_spectrometer"] == 1


def test_effects_that_a_test_states_are_taken_out_before_its_corrections(project):
    for file, entry in (("tests/csic_160kW", "winE"), ("conditions/80kW", "power")):
        path = project / f"config/{file}.yaml"
        path.write_text(f"{path.read_text()}\neffects: [{{id: {entry}, amplitude: 0.05}}]\n")
    run = snakemake(project, "--dry-run", "results/diagnosis/csic_160kW/diagnosis.json")
    assert planned(run)["restored_test"] == 1
    read = re.findall(r"rule pyrometer_correction:\n *input: (.*)", run.stdout)
    assert [words.split(",")[0] for words in read] == ["results/experiment/csic_160kW/restored_test.nc"]


JET = """
numerical_power_kw: 80
chamber_pressure_mbar: 50
mass_flow_rate_g_s: 16
emittance: 0.85
cfd:
  file: jet.csv
  geometry: profile
  length_unit: m
  coordinates: {distance: s}
  variables: {temperature: {name: T, unit: K}, pressure: {name: p, unit: Pa}}
  species: equilibrium
"""


def test_an_effect_that_cannot_be_hidden_is_refused_before_anything_runs(project):
    path = project / "config/tests/csic_160kW.yaml"
    sound = path.read_text()
    wrong = {
        "{effect: winF, amplitude: 0.05}": "twin.effects.3: effect must be one of .*did you mean 'win",
        "{effect: winE, amplitude: 5}": "twin.effects.3: winE: amplitude must lie in .*got 5",
        "{effect: winE, amplitude: 0.05, shape: {tau: 3}}": "twin.effects.3: winE: shape has no tau; it",
        "{effect: power, amplitude: -1}": "twin.effects.3: power: amplitude must lie above -1",
    }
    for one, words in wrong.items():
        path.write_text(sound.replace("{effect: winE, amplitude: 0.05}", one))
        run = snakemake(project, "--dry-run")
        assert run.returncode
        assert re.search("csic_160kW.yaml:\n  " + words, run.stderr), run.stderr
        assert "Traceback" not in run.stderr


GIVEN = "effects: [{id: T_vib, amplitude: -0.08}, {id: T_exc, amplitude: 0.03}, {id: Cu, amplitude: 2}]\n"


def test_effects_of_a_condition_reach_its_light_through_the_engine(project):
    """One line of sight, with and without what is given: the same engine, called with the same changes."""
    (project / "jet.csv").write_text("s,T,p\n0,350,5000\n0.003,6000,5000\n0.1,6000,5000\n0.103,350,5000\n")
    path = project / "config/conditions/jet.yaml"
    path.write_text(f"{JET}{GIVEN}")
    run = snakemake(project, "results/radiation/jet.nc")
    assert run.returncode == 0, run.stdout + run.stderr
    found, line, response = (
        xr.load_dataset(project / f"results/{name}.nc")
        for name in ("radiation/jet", "sightline/jet", "instrument/response")
    )
    keys = {"wavelength_range": (700e-9, 1200e-9), "grid_points": 160_000, "slit_fwhm": 0.75e-9}
    wanted = line_of_sight_radiance(line, response, levels={"vibration": -0.08, "excitation": 0.03}, **keys)
    own = found.gas_radiance - found.gas_radiance_component.sel(component="Cu I")
    assert np.allclose(own, wanted.gas_radiance, rtol=1e-6)
    more = found.gas_radiance_component_slit.sel(component="Cu I")
    triplet = oxygen_triplet(wanted.wavelength_slit.values, wanted.gas_radiance_slit.values)
    centre, strength = species_lines(("Cu I",))
    inside = strength[(centre > 700e-9) & (centre < 1200e-9)].sum()  # the table of lines reaches further
    assert float(more.integrate("wavelength_slit")) == pytest.approx(0.2 * inside * triplet, rel=1e-3)
    path.write_text(f"{JET}effects: [{{id: power, amplitude: 0.05}}]\n")
    assert "the flow of this condition is another program's" in snakemake(project, "--dry-run").stderr


def test_a_test_that_judges_is_foretold_and_nothing_else(project):
    plan = snakemake(project, "--dry-run")
    jobs = planned(plan)
    assert jobs["twin_test"] == jobs["extended_flow"] == jobs["extended_radiance"] == 2
    assert not re.findall(r"results/(?:experiment|diagnosis)/csic_220kW", plan.stdout)
    (read,) = re.findall(r"rule extended_gain:\n *input: (.*)", plan.stdout)
    assert "results/twin/csic_220kW/test.nc" in read and "results/extended/radiation/110kW.nc" in read


def test_effects_of_the_instrument_are_taken_out_of_every_test_that_does_not_state_its_own(project):
    path = project / "config/config.yaml"
    words = "instrument:\n  effects: [{id: winE, amplitude: 0.05}, {id: clock, amplitude: 0.2}]\n"
    path.write_text(path.read_text().replace("instrument:\n", words, 1))
    test = project / "config/tests/csic_160kW.yaml"
    test.write_text(f"{test.read_text()}\neffects: [{{id: clock, amplitude: 0.5}}]\n")
    plan = snakemake(project, "--dry-run", "results/extended/csic_160kW/gain.md")
    assert planned(plan)["restored_test"] == 2
    (read,) = re.findall(r"rule extended_gain:\n *input: (.*)", plan.stdout)
    assert "results/experiment/csic_220kW/restored_test.nc" in read
    path.write_text(path.read_text().replace("winE", "eps_ox"))
    assert "instrument.effects.0.id: 'eps_ox' belongs to" in snakemake(project, "--dry-run").stderr


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


def test_exchanged_columns_of_a_raw_folder_reach_diagnosis_and_report(project):
    shutil.copytree(ROOT / "docs/example/calibration", project / "lamp")
    shutil.copytree(ROOT / "docs/example/my_test", project / "mydata")
    log = project / "mydata/pyrometer.csv"
    log.write_text(log.read_text().replace("S1", "S3").replace("S2", "S1").replace("S3", "S2"))
    config = project / "config/config.yaml"
    words = config.read_text().replace("test: csic_160kW", "test: mine")
    words = re.sub(r"(calibration_points|spectrometer_counts): \S+", r"\1: lamp", words)
    words = re.sub(r"(normalisation_wavelength_nm): \S+", r"\1: 1020", words)
    config.write_text(re.sub(r"(normalisation_half_width_nm): \S+", r"\1: 2", words))
    (project / "config/tests/csic_160kW.yaml").rename(project / "config/tests/mine.yaml")
    (project / "config/tests/mine.yaml").write_text(
        "data_folder: mydata\ninstruments: [pyrometer, spectrometer]\ncalibrated_spectra: false\n"
    )
    run = snakemake(project, "results/experiment/mine/findings.json")
    assert run.returncode == 0, run.stdout + run.stderr
    found = json.loads((project / "results/experiment/mine/findings.json").read_text())
    rules = [one["rule"] for one in found if one["severity"] == "contradiction"]
    assert {"swapped_bands", "instruments_disagree", "estimate_contradicted"} <= set(rules)
    assert found[0]["where"] == "mydata"
    targets = ["results/diagnosis/mine/diagnosis.json", "results/report.html"]
    plan = snakemake(project, "--dry-run", "--forceall", *targets).stdout
    for rule in ("diagnosis", "report"):
        inputs = re.search(rf"rule {rule}:\n    input: (.*)", plan)[1]
        assert "results/experiment/mine/findings.json" in inputs


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


def test_an_instrument_of_any_bands_takes_the_place_of_the_pyrometer(project):
    """Light of the gas, errors, design and trust; claims and tests of a pyrometer are left out. A test of
    that instrument goes through estimate and diagnosis with its own calibration."""
    change = {"instrument": {"bands": "config/instruments/five_band.yaml", "calibration_points": "lamp"}}
    (project / "five.yaml").write_text(yaml.safe_dump(change))
    words = ("--dry-run", "--configfile", "five.yaml")
    plan = snakemake(project, *words)
    jobs, said = planned(plan), plan.stdout + plan.stderr
    assert jobs["radiance"] == 9 and "tests of a pyrometer are left out: csic_160kW" in said
    for rule in ("visibility", "error_map", "transient", "band_design", "reflection_map", "trust"):
        assert jobs[rule] == jobs["figures_analysis"] == 1, rule
    assert not {"twin_test", "claims", "calibration", "figures_calibration", "diagnosis"} & set(jobs)
    shutil.copytree(ROOT / "docs/example/calibration", project / "lamp")
    (project / "mine").mkdir()
    (project / "mine/test.yaml").write_text("attributes: {condition: 90kW}\nradiometer: {file: mine.csv}\n")
    (project / "mine/mine.csv").write_text("time [s],b1\n")
    told = {"data_folder": "mine", "instruments": ["radiometer"], "calibrated_spectra": False}
    (project / "config/tests/mine.yaml").write_text(yaml.safe_dump(told))
    jobs = planned(snakemake(project, "results/report.html", *words))
    for rule in ("radiometer_calibration", "read_test", "joint_estimate", "findings", "diagnosis", "report"):
        assert jobs[rule] == 1, rule
    assert not {"spectrometer_calibration", "pyrometer_correction", "claims"} & set(jobs)


def test_minimal_takes_two_conditions(project):
    assert planned(snakemake(project, "--dry-run", "--configfile", "config/minimal.yaml"))["flow"] == 2


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        ("config/config.yaml", "slit_fwhm_nm:", "slit_fwmh_nm:", "did you mean 'slit_fwhm_nm'?"),
        ("config/tests/csic_160kW.yaml", "data_folder:", "datafolder:", "did you mean 'data_folder'?"),
        ("config/config.yaml", "field_condition: 90kW", "field_condition: 91kW", "did you mean '90kW'?"),
        ("config/conditions/90kW.yaml", "emittance:", "emittance: !!int ''\nx:", "90kW.yaml: not readable"),
        ("config/tests/csic_160kW.yaml", "data_folder: ", "data_folder: a{b}/", "holds braces"),
        (
            "config/tests/csic_160kW.yaml",
            "data_folder:",
            "effects: [{id: winF, amplitude: 0.05}]\ndata_folder:",
            "config/tests/csic_160kW.yaml:\n  effects.0.id: unknown; did you mean 'winE'?",
        ),
    ],
)
def test_a_wrong_configuration_stops_before_the_first_job(project, file, old, new, message):
    path = project / file
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    run = snakemake(project)
    assert run.returncode != 0
    words = run.stdout + run.stderr
    assert message in words
    assert 'File "' not in words and "Traceback" not in words and "Snakefile" not in words
    assert not (project / "results").exists()


def test_a_test_without_its_data_is_named_before_the_first_job(project):
    told = "instruments: [pyrometer, radiometer]\ncalibrated_spectra: true\n"
    for name, folder in (("mine", "mydata"), ("other", "nowhere"), ("sound", "netcdf")):
        (project / f"config/tests/{name}.yaml").write_text(f"data_folder: {folder}\n{told}")
    for file, words in (("mydata/test.yaml", "attributes: {}\npyrometer: {}\n"), ("netcdf/test.nc", "")):
        (project / file).parent.mkdir()
        (project / file).write_text(words)
    run = snakemake(project)
    said = run.stdout + run.stderr
    assert run.returncode != 0 and "Traceback" not in said
    assert "data_folder of test other: nowhere holds neither test.nc nor test.yaml; see docs" in said
    assert "instruments of test mine: mydata/test.yaml describes no radiometer" in said
    assert "test sound" not in said


def test_what_is_wrong_in_several_files_is_said_at_once_file_by_file(project):
    for name in ("80kW", "90kW"):
        path = project / f"config/conditions/{name}.yaml"
        path.write_text(path.read_text().replace("emittance:", "emitance:"))
    said = snakemake(project).stderr
    for name in ("80kW", "90kW"):
        assert (
            f"config/conditions/{name}.yaml does not fit config/schema_condition.yaml:\n  unknown key" in said
        )


def one_instrument(project):
    """A second test, of a spectrometer alone; and one condition that nothing but the diagnosis needs."""
    (project / "config/tests/mine.yaml").write_text(
        "data_folder: mydata\ninstruments: [spectrometer]\ncalibrated_spectra: true\n"
    )
    (project / "mydata").mkdir()
    (project / "mydata/test.nc").write_bytes(b"")


@pytest.mark.parametrize("change", [None, one_instrument, "config/minimal.yaml"])
def test_the_crate_lists_every_result_that_the_run_makes(project, change):
    if callable(change):
        change(project)
    words = ["--configfile", change] if isinstance(change, str) else []
    plan = snakemake(project, "--dry-run", *words).stdout
    jobs = re.findall(r"^(?:local)?rule (\w+):\n((?:    .*\n)+)", plan, re.MULTILINE)
    files = {"input": {}, "output": {}}
    for rule, text in jobs:
        for kind, found in files.items():
            for listed in re.findall(rf"^    {kind}: (.*)$", text, re.MULTILINE):
                found.setdefault(rule, set()).update(listed.split(", "))
    made = set().union(*(listed for rule, listed in files["output"].items() if rule != "crate"))
    described = {path for path in files["input"]["crate"] if path.startswith("results/")}
    assert described == made and len(made) > 100
    groups = {path.split("/")[1] for path in described}
    assert {"radiation_variations", "surface_view", "experiment", "twin"} <= groups
    assert any(path.endswith("joint_estimate.nc") for path in described)


@pytest.fixture
def half_way(project):
    """The project after a run up to the responses."""
    run = snakemake(project, "results/instrument/response.nc")
    assert run.returncode == 0, run.stdout + run.stderr
    return project


def test_a_second_call_has_nothing_to_do(half_way):
    run = snakemake(half_way, "results/instrument/response.nc")
    assert NOTHING in run.stdout + run.stderr


NOTHING = "Nothing to be done"
TARGETS = ("results/instrument/ratio_curve.nc", "results/twin/calibration_points.nc")


@pytest.fixture
def finished(half_way):
    """The project after a small run that has an end."""
    run = snakemake(half_way, *TARGETS)
    assert run.returncode == 0, run.stdout + run.stderr
    return half_way


def test_a_finished_folder_may_be_moved_copied_or_cloned_again(finished):
    def said(folder):
        run = snakemake(folder, "--dry-run", *TARGETS)
        return run.stdout + run.stderr

    moved = finished.rename(finished.with_name("another name"))
    assert NOTHING in said(moved)
    copied = shutil.copytree(moved, moved.with_name("copied"), copy_function=shutil.copyfile)
    for path in sorted(copied.rglob("*"), reverse=True):  # dates as a copy leaves them, later ones first
        path.is_file() and os.utime(path)
    assert NOTHING in said(copied)
    for path in (moved / "workflow").rglob("*.py"):  # as after git clone or checkout
        os.utime(path)
    assert NOTHING in said(moved)


def test_an_edited_script_runs_again(finished):
    for edited, expected in (
        ("ratio_curve", {"ratio_curve"}),
        ("response", {"response", "ratio_curve", "twin_calibration"}),
        ("claims", set()),
    ):
        path = finished / f"workflow/scripts/{edited}.py"
        words = path.read_text()
        path.write_text(words + "# edited\n")
        run = snakemake(finished, "--dry-run", *TARGETS)
        found = set() if NOTHING in run.stdout + run.stderr else planned(run).keys()
        assert found == expected, run.stdout
        path.write_text(words)


def test_every_script_is_an_input_of_its_rule(project):
    plan = snakemake(project, "--dry-run").stdout
    rules = "".join(path.read_text() for path in sorted((project / "workflow/rules").glob("*.smk")))
    script = {new: old for old, new in re.findall(r"^use rule (\w+) as (\w+) with", rules, re.MULTILINE)}
    script["figures_pyrometer_spectrometer"] = "figures_test"
    for rule, text in re.findall(r"^(?:local)?rule (\w+):\n((?:    .*\n)+)", plan, re.MULTILINE):
        assert rule == "all" or f"workflow/scripts/{script.get(rule, rule)}.py" in text, rule


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
