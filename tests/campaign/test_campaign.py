import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml
from clone import copy_of_the_project, snakemake
from scipy.stats import norm
from twin import drawn
from twin.drawn import REFERENCE, plan_and_reports

from plasmapyro import cli, io
from plasmapyro.campaign import report as in_words
from plasmapyro.campaign import stage
from plasmapyro.campaign.applied import applied
from plasmapyro.campaign.hierarchy import Campaign
from plasmapyro.commands.priors import read_priors
from plasmapyro.diagnosis.fit.prior import Normal

RANDOM = 60  # campaigns
HOT = 1000.0  # [K]
EXAMPLE = Path(__file__).resolve().parents[2] / "docs/example"
ENDS = 0.90, 0.98  # of the coverage of 95 % intervals
GAIN = 1.5  # least, of a temperature with both instruments
ORDER = (
    0,
    1,
    2,
    3,
    2,
    1,
    0,
    3,
    1,
    2,
)  # of the diagnosed tests: the first, and the first of a cleaned window, of a cavity
PLAIN = 3, 1, 2, 3, 2, 1, 1, 3, 1, 2  # the same without one

ROUNDING = 1e-8  # [1], relative, of sums in another order


def campaign(seed, *, tests=10, odd=None, order=ORDER):
    """A drawn campaign of tests that see what the four diagnosed ones of the example see."""
    listed = yaml.safe_load((EXAMPLE / "campaign/campaign.yaml").read_text())["tests"]
    seen = [
        (1e3 * one["electric_power_kw"], one["material"], drawn.Seen(json.loads(told)["posterior"]))
        for one in listed
        for told in [(EXAMPLE.parents[1] / one["diagnosis"]).read_text()]
    ]
    return drawn.campaign([seen[place] for place in order[:tests]], seed, odd=odd)


def found_in(made):
    plan, reports = plan_and_reports(made)
    return stage.campaign(stage.tests_of(plan, reports), REFERENCE)


def drawn_campaigns(order, count=RANDOM):
    """Of drawn campaigns: which laws lie in their intervals, how many leave a sound test out, and of the last
    temperature the errors (2, n) [K], alone and with the campaign, and whether its interval holds."""
    inside, odd, errors, held = [], 0, [], []
    for seed in range(count):
        truth, made = campaign(seed, order=order)
        true = truth.pop("temperature")
        whole = Campaign(stage.tests_of(*plan_and_reports(made)), REFERENCE)
        joint = whole.joint(whole.odd_ones())
        odd += bool(joint.odd)
        last = whole.tests[-2]
        value, sigma = stage.temperature(last, stage.law_of(joint, last.name, last.after.names))
        hot = true > HOT
        errors.append([(one - true)[hot] for one in (last.temperature["value"], value)])
        held.append(np.abs(value - true)[hot] < 1.96 * sigma[hot])
        for name, number in truth.items():
            mean, sigma = joint.number(name)
            inside.append(abs(number - mean) < 1.96 * sigma)
    return np.mean(inside), odd, np.sqrt(np.mean(np.square(errors), axis=(0, 2))), np.mean(held)


def test_intervals_of_random_campaigns_hold_as_often_as_they_say_and_temperatures_gain():
    inside, odd, (alone, together), held = drawn_campaigns(ORDER)
    assert ENDS[0] < inside < ENDS[1]
    assert alone > GAIN * together
    assert ENDS[0] < held <= 1.0
    assert odd <= 6  # of 60 sound campaigns: 1 % of each of 40 groups would be far more


def test_without_anything_absolute_a_campaign_gains_less_and_says_so():
    inside, _, (alone, together), held = drawn_campaigns(PLAIN, RANDOM // 2)
    assert ENDS[0] < inside < ENDS[1] and ENDS[0] < held <= 1.0
    assert 1.05 * together < alone < GAIN * together


@pytest.mark.parametrize(
    ("number", "off", "group"),
    [("power", -0.2, "efficiency"), ("gain_spectrometer", -0.08, "window"), ("ratio", 0.015, "instrument")],
)
def test_a_test_that_does_not_belong_is_named_and_leaves_the_law_alone(number, off, group):
    truth, made = campaign(3, odd=(4, number, off))
    found = found_in(made)
    assert found.joint.odd == (("run04", group),)
    truth.pop("temperature")
    for name, value in truth.items():
        mean, sigma = found.joint.number(name)
        assert abs(value - mean) < 3.3 * sigma, name


def test_each_test_narrows_the_prior_of_the_next_and_their_temperatures():
    found = found_in(campaign(5)[1])
    laws = [*(row.prior for row in found.rows[1:]), found.next]
    names = [name for name in found.next.names if stage.group_of(name) == "instrument"]
    widths = np.array([law.of(names).sigma for law in laws])
    assert (np.diff(widths, axis=0) < 1e-4 * widths[0]).all()  # scatters are learnt, too: some hardly move
    volume = [np.linalg.slogdet(law.of(names).covariance)[1] for law in laws]
    assert (np.diff(volume) < 0).all()
    ratio = widths[:, names.index("ratio")]
    assert (np.diff(ratio) < 0).all() and ratio[-1] < 0.85 * ratio[0]
    alone, earlier, whole = np.array([row.sigma for row in found.rows]).T
    assert (earlier[1:] < alone[1:]).all()
    assert (whole < (1 + ROUNDING) * earlier).all()  # the last one has no later test: both are the same


def test_a_cleaning_starts_a_window_anew():
    found = found_in(campaign(5)[1])
    loss = {row.test.name: found.joint.number(f"gain_spectrometer {row.test.name}") for row in found.rows}
    before = loss["run05"][0] - loss["run04"][0]
    mean, sigma = found.joint.number("fouling gain_spectrometer")
    assert abs(before + mean) < 4 * np.hypot(sigma, 0.01)
    _, wide = (
        found.rows[6].prior.of(["gain_spectrometer"]).mean,
        found.rows[6].prior.of(["gain_spectrometer"]).sigma,
    )
    assert wide[0] == pytest.approx(0.02, rel=0.01)  # as a clean window was before any test


def test_a_prior_that_a_test_has_used_counts_once():
    """The same data, diagnosed with the prior of the tests before, give the same campaign."""
    plan, reports = plan_and_reports(campaign(8)[1])
    plain = stage.campaign(stage.tests_of(plan, reports), REFERENCE)
    told, row = reports["run09"]["posterior"], plain.rows[-1]
    matrix, pull = row.test.message()
    law = row.prior.of(told["names"])
    covariance = np.linalg.inv(np.linalg.inv(law.covariance) + matrix)
    mean = covariance @ (np.linalg.solve(law.covariance, law.mean) + pull)
    reports["run09"]["posterior"] = told | {
        "mean": mean.tolist(),
        "covariance": covariance.tolist(),
        "prior": {"mean": law.mean.tolist(), "covariance": law.covariance.tolist()},
        "with_priors": True,
    }
    again = stage.campaign(stage.tests_of(plan, reports), REFERENCE)
    assert (
        np.abs(again.joint.mean - plain.joint.mean) < 2e-6 * np.sqrt(np.diag(plain.joint.covariance))
    ).all()
    np.testing.assert_allclose(again.joint.covariance, plain.joint.covariance, rtol=1e-5, atol=1e-12)


def test_a_slope_that_a_pyrometer_alone_cannot_see_is_no_ratio_of_the_others():
    """The same data of the last test, the ratio open by as much more as an untold slope of its emittance."""
    plan, reports = plan_and_reports(campaign(8)[1])
    plain = Campaign(stage.tests_of(plan, reports), REFERENCE)
    (test, matrix, pull), told = plain.messages["run09"], reports["run09"]["posterior"]
    law = test.before.wider("ratio", 0.01)
    covariance = np.linalg.inv(np.linalg.inv(law.covariance) + matrix)
    reports["run09"]["posterior"] = told | {
        "mean": (covariance @ (np.linalg.solve(law.covariance, law.mean) + pull)).tolist(),
        "covariance": covariance.tolist(),
        "prior": {"mean": law.mean.tolist(), "covariance": law.covariance.tolist()},
    }
    doubted = Campaign(stage.tests_of(plan, reports), REFERENCE).joint()
    widths = [one.number("ratio")[1] for one in (plain.joint(), doubted, plain.joint(without="run09"))]
    assert widths == sorted(widths)
    assert doubted.number("ratio run09")[1] > 1.05 * plain.joint().number("ratio run09")[1]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the files of a campaign; the commands run there."""
    monkeypatch.chdir(tmp_path)
    plan, reports = plan_and_reports(campaign(1, tests=4)[1])
    for name, report in reports.items():
        (tmp_path / f"{name}.json").write_text(json.dumps(report))
    (tmp_path / "campaign.yaml").write_text(yaml.safe_dump(plan))
    return tmp_path


def test_an_emittance_has_no_interval_above_one():
    low, high = in_words.interval(0.99, 0.01, 1.0)
    law = norm(0.99, 0.01)
    assert high < 1.0
    assert (law.cdf(high) - law.cdf(low)) / law.cdf(1.0) == pytest.approx(0.95)
    assert in_words.interval(0.0, 1.0, np.inf) == pytest.approx(norm.interval(0.95))


def test_the_command_writes_a_prior_that_reads_back(folder):
    assert cli.main(["campaign", "campaign.yaml", "--out", "made"]) == 0
    assert {path.name for path in (folder / "made").iterdir()} == {
        "priors.yaml",
        "campaign.md",
        "campaign.png",
    }
    law = read_priors("made/priors.yaml")
    plan = yaml.safe_load((folder / "campaign.yaml").read_text())
    reports = {one["name"]: json.loads((folder / one["diagnosis"]).read_text()) for one in plan["tests"]}
    found = stage.campaign(stage.tests_of(plan, reports), REFERENCE).next
    np.testing.assert_allclose(law.covariance, found.covariance, rtol=1e-6, atol=1e-14)
    np.testing.assert_array_equal(law.mean, found.mean)
    first = (folder / "made/priors.yaml").read_bytes()
    assert cli.main(["campaign", "campaign.yaml", "--out", "made"]) == 0
    assert (folder / "made/priors.yaml").read_bytes() == first


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda plan: plan["tests"].reverse(), "stands after a later one"),
        (lambda plan: plan["tests"][1].update(name="run00"), "listed twice"),
        (lambda plan: plan["tests"][1].update(material="sic"), "'sic' and 'SiC'; write one in one way"),
        (lambda plan: plan["tests"][0].update(materiel="C/SiC"), "materiel"),
        (lambda plan: plan["tests"][0].update(diagnosis="none.json"), "none.json: no such file; a name"),
        (lambda plan: plan["tests"][0].update(diagnosis="campaign.yaml"), "no diagnosis.json"),
        (lambda plan: plan["tests"][1].update(diagnosis="run00.json"), "which would count twice"),
        (lambda plan: plan["tests"][3].update(date="2026-02-31"), "2026-02-31: day is out of range"),
    ],
)
def test_bad_files_are_refused_in_one_message(folder, capsys, change, words):
    plan = yaml.safe_load((folder / "campaign.yaml").read_text())
    change(plan)
    (folder / "campaign.yaml").write_text(yaml.safe_dump(plan))
    assert cli.main(["campaign", "campaign.yaml", "--out", "made"]) == 2
    assert words in capsys.readouterr().err
    assert not (folder / "made").exists()


def test_what_a_campaign_says_of_instruments_ends_with_their_calibration(folder, capsys):
    """Digests of the files of the instruments, as diagnoses state them: of one test others, then of all."""
    for name, digest in (("run00", "a"), ("run01", "b")):
        report = json.loads((folder / f"{name}.json").read_text())
        report["provenance"] = {"files": {"calibration.nc": 64 * digest, "radiation/80kW.nc": 64 * digest}}
        (folder / f"{name}.json").write_text(json.dumps(report))
    assert cli.main(["campaign", "campaign.yaml", "--out", "made"]) == 2
    said = capsys.readouterr().err
    assert "run01 was diagnosed with another calibration.nc than run00" in said and "80kW" not in said
    (folder / "run01.json").write_text(json.dumps(report | {"provenance": {}}))
    assert cli.main(["campaign", "campaign.yaml", "--out", "made"]) == 0
    assert read_priors("made/priors.yaml", {"calibration.nc": 64 * "a"}) is not None
    for command in ("diagnose", "correct"):
        read = [command, str(EXAMPLE / "my_test"), "--priors", "made/priors.yaml", "--out", "none"]
        assert cli.main(read) == 2
        assert "were measured with another calibration.nc" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda values: values.pop("mean"), "'mean' is a required property"),
        (lambda values: values.update(sgma=[1.0]), "unknown key 'sgma'; did you mean 'sigma'?"),
        (lambda values: values["names"].__setitem__(0, "emitance"), "names.0: 'emitance'"),
        (lambda values: values["names"].__setitem__(0, "ratio"), "non-unique"),
        (lambda values: values.update(sigma=values["sigma"][1:]), "a number for each name"),
        (lambda values: values.update(mean=["x"] * len(values["mean"])), "is not of type 'number'"),
        (lambda values: values["mean"].__setitem__(0, 0.85), "the logarithm of the emittance"),
        (lambda values: values["mean"].__setitem__(-1, 80.0), "the logarithm of watts"),
        (lambda values: values["correlation"][0].__setitem__(1, 3.0), "symmetric"),
        (lambda values: values["sigma"].__setitem__(0, -1.0), "less than or equal to the minimum of 0"),
    ],
)
def test_priors_that_are_no_law_are_refused_in_a_sentence(folder, capsys, change, words):
    assert cli.main(["campaign", "campaign.yaml", "--out", "made"]) == 0
    values = yaml.safe_load(Path("made/priors.yaml").read_text())
    change(values)
    Path("wrong.yaml").write_text(yaml.safe_dump(values))
    capsys.readouterr()
    for command in ("diagnose", "correct"):
        assert cli.main([command, str(EXAMPLE / "my_test"), "--priors", "wrong.yaml", "--out", "none"]) == 2
        said = capsys.readouterr().err
        assert "wrong.yaml" in said and words in said
    assert not Path("none").exists()


def test_the_rule_makes_a_prior_that_diagnosis_and_correction_take(tmp_path, monkeypatch):
    project = copy_of_the_project(tmp_path / "clone")
    shutil.copytree(EXAMPLE, project / "docs/example")
    shutil.copy(EXAMPLE / "campaign/campaign.yaml", project / "config")
    run = snakemake(project, "campaign")
    assert run.returncode == 0, run.stderr
    assert (project / "results/campaign/campaign.png").stat().st_size > 10_000
    assert (project / "results/campaign/campaign.md").read_text().startswith("# A campaign of 4 tests")
    monkeypatch.chdir(project)
    law = read_priors("results/campaign/priors.yaml")
    with_it = ["--priors", "results/campaign/priors.yaml", "--out"]
    assert cli.main(["correct", "docs/example/my_test", *with_it, "made.nc"]) == 0
    assert cli.main(["diagnose", "docs/example/my_test", *with_it, "made"]) == 0
    told = json.loads(Path("made/diagnosis.json").read_text())["posterior"]
    assert told["with_priors"]
    own = [told["names"].index(name) for name in ("emittance", "ratio", "power")]
    np.testing.assert_allclose(
        np.sqrt(np.diag(told["prior"]["covariance"]))[own],
        law.of(["emittance", "ratio", "power"]).sigma,
        rtol=1e-6,
    )
    made = io.read("made.nc", "correction")
    assert made.attrs["emittance"] == pytest.approx(np.exp(law.of(["emittance"]).mean[0]))


def test_corrections_with_a_prior_are_those_of_an_instrument_without_its_errors():
    """Signals and spectra that a wrong ratio, throughput and scale have changed, and the law that says so."""
    random = np.random.default_rng(2)
    pixels = 1e-9 * np.linspace(780.0, 1020.0, 25)
    test = xr.Dataset(
        {"spectral_radiance": (("spectrum_time", "wavelength"), random.uniform(1e7, 1e8, (3, 25)))},
        {"wavelength": pixels},
        {"emittance": 0.85, "emittance_uncertainty": 0.05},
    )
    calibration = xr.Dataset(
        {
            "sensitivity_ratio": 0.3,
            "sensitivity_ratio_uncertainty": 0.0015,
            "absolute_sensitivity": ("band", [3e-9, 1e-8]),
            "calibration_ratio": ("calibration_temperature", [0.2, 0.3]),
            "fit_coefficient": ("fit_power", [0.1, 1e-4, 0.0]),
            "fit_covariance": (("fit_power", "other_fit_power"), 1e-6 * np.eye(3)),
        }
    )
    scale = np.linspace(-0.004, 0.004, 5)
    names = (
        "emittance",
        "gain_pyrometer",
        "gain_spectrometer",
        "ratio",
        *(f"scale_{n}" for n in range(780, 1021, 60)),
    )
    mean = np.array([np.log(0.8), -0.02, -0.03, 0.01, *scale])
    law = Normal(names, mean, np.diag([0.02, 0.01, 0.01, 0.001, *[0.002] * 5]) ** 2)
    told, found = applied(test, {"calibration": calibration}, law)
    wrong = np.exp(-0.03 + np.interp(pixels * 1e9, range(780, 1021, 60), scale))
    np.testing.assert_allclose(told.spectral_radiance * wrong, test.spectral_radiance, rtol=1e-12)
    assert told.attrs["emittance"] == pytest.approx(0.8)
    assert told.attrs["emittance_uncertainty"] == pytest.approx(0.016)
    made = found["calibration"]
    np.testing.assert_allclose(made.absolute_sensitivity, [3e-9 * np.exp(-0.01), 1e-8 * np.exp(-0.02)])
    for name in ("sensitivity_ratio", "calibration_ratio", "fit_coefficient"):
        np.testing.assert_allclose(made[name], calibration[name] * np.exp(0.01))
    assert made.sensitivity_ratio_uncertainty / made.sensitivity_ratio == pytest.approx(0.001)
