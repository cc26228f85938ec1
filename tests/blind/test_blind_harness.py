"""The harness of the blind tests: cases from a seed, sizes that are true, a truth that stays hidden."""

import ast
import dataclasses
import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from blind import bench, board, calibrate, draw, make, page, run
from blind.metric import LINE_SIZE, Metric
from blind.score import judge_temperature, score
from invented import DISTANCE, SPECIES, TEMPERATURE, density, spectra
from powers import ladder
from twin import campaign, hidden
from two_bands import RESPONSE

ROOT = Path(__file__).resolve().parents[2]


def test_the_ladder_of_powers_is_read_from_the_files_not_from_their_names(tmp_path):
    facts = {"chamber_pressure": 5000.0, "mass_flow_rate": 0.016, "gas": "air", "flow_settings": "{}"}
    for name, power, changes in (
        ("zz", 50e3, {}),
        ("mine", 80e3, {}),
        ("130kW", 85e3, {"chamber_pressure": 2000.0}),
        ("90kW", None, {}),
    ):
        stated = {} if power is None else {"numerical_power": power}
        xr.Dataset(attrs=facts | changes | stated).to_netcdf(tmp_path / f"{name}.nc")
    assert ladder(tmp_path) == {50e3: tmp_path / "zz.nc", 80e3: tmp_path / "mine.nc"}
    assert ladder(tmp_path / "nothing") == {}


@pytest.fixture(scope="module")
def workbench():
    table = np.linspace(300.0, 14000.0, 275)
    fractions = np.stack([density(table)[name] * 1.380649e-23 * table / 5000.0 for name in SPECIES], -1)
    profile = xr.Dataset({"temperature": ("path_distance", TEMPERATURE)}, {"path_distance": DISTANCE})
    composition = xr.Dataset(
        {"mole_fraction": (("pressure", "temperature", "species"), fractions[None])},
        {"pressure": [5000.0], "temperature": table, "species": list(SPECIES)},
    )
    return bench.Bench(RESPONSE, {80e3: profile}, composition, spectra())


@pytest.fixture(scope="module")
def metric(workbench):
    return Metric(workbench, bench.draw_base(3, 4))


# ---- drawing ---------------------------------------------------------------------------------------------


def test_cases_follow_from_the_seed_alone():
    counts = {"null": 3, "single": 20, "double": 4, "outside": 6, "puzzle": 6}
    first, again, other = (draw.draw(seed, counts) for seed in ("a", "a", "b"))
    assert first == again and first != other
    assert len({case.seed for case in first + other}) == 2 * 39
    longer = draw.draw("a", counts | {"null": 5})
    assert [case for case in longer if case.kind == "null"][:3] == first[:3]


def test_the_second_laboratory_adds_cases_and_changes_none_of_the_first():
    counts = {"null": 2, "single": 3, "outside": 2}
    first, second = (draw.draw("a", counts, world=world) for world in ("first", "second"))
    assert first[0] == draw.Case("null-0000", "null", draw.number("a", "null", 0))
    assert {case.world for case in second} == {"second"}
    assert {case.name for case in first}.isdisjoint(case.name for case in second)
    assert all(case.effects[0][0] in draw.WORLDS["second"].OUTSIDE for case in second[-2:])
    with pytest.raises(ValueError, match="kinds are null, single"):
        draw.draw("a", {"liar": 1}, world="second")


def test_singles_go_through_catalogue_and_ladder_before_they_repeat():
    rungs = len(hidden.CATALOGUE) * len(draw.SNR_LADDER)
    pairs = [(case.effects[0][0], case.effects[0][1]) for case in draw.draw("a", {"single": rungs})]
    assert len(set(pairs)) == rungs


def test_each_kind_hides_what_it_says():
    cases = draw.draw("c", {kind: 12 for kind in draw.KINDS})
    for case in cases:
        names = [one[0] for one in case.effects]
        assert len(names) == {"single": 1, "double": 2, "outside": 1, "without": 1, "sabotage": 1}.get(
            case.kind, 0
        )
        assert all((name in hidden.OUTSIDE) == (case.kind == "outside") for name in names)
        assert (case.noise is not None) == (case.kind == "liar")
        assert case.without == ((names[0],) if case.kind == "without" else ())
        assert case.sabotage == (names[0] if case.kind == "sabotage" else None)
    with pytest.raises(ValueError, match="kinds are null"):
        draw.draw("c", {"nul": 1})


# ---- sizes -----------------------------------------------------------------------------------------------


def test_hidden_effect_has_the_size_it_was_asked_for(workbench, metric):
    """A matched filter on noisy data finds the SNR, with the scatter of one that it must have."""
    found, metric = {0.0: [], 20.0: []}, metric.thermometer
    scene = workbench.scene(metric.base)
    exposure, device = scene.spectrometer_integration_time, scene.spectrometer
    sized = make._sized(metric, "gas_drift", 20.0, 1, {})
    vector, size = metric.signature([sized])
    assert size == pytest.approx(20.0, rel=0.03)
    for snr, kept in found.items():
        for seed in range(6):
            seen = bench.apply(scene, metric.gas, [sized] if snr else [])
            base = dataclasses.replace(metric.base, seed=seed)
            clean = workbench.clean(seen, metric.gas, base)
            # The flicker of another seed is in both; the calibration is perfect here.
            still = workbench.clean(scene, metric.gas, base)
            random = np.random.default_rng(seed)
            noise = [sigma * random.standard_normal(sigma.shape) for sigma in metric.sigma]
            output = [
                r + (c - s) + n for r, c, s, n in zip(metric.reference, clean, still, noise, strict=True)
            ]
            assert output[1].shape == (len(metric.frames), device.pixels) and exposure == 0.9
            kept.append(float(metric.project(metric.whiten(output)) @ vector / size))
    assert np.mean(found[0.0]) == pytest.approx(0.0, abs=1.5)
    assert np.mean(found[20.0]) == pytest.approx(20.0, abs=1.5)
    assert np.std(found[0.0]) < 1.8  # one standard deviation each: six draws exceed 1.8 once in 1000


def test_counts_scatter_as_the_metric_assumes(workbench, metric):
    scene = workbench.scene(metric.base)
    test, _ = workbench.record(scene, metric.gas, metric.base)
    steady = (metric.frames > 150) & (metric.frames < 290)
    counts = test.counts.values[steady]
    # Neighbouring pixels share the flicker of the gas; second differences over frames leave the noise.
    noise = np.diff(counts, axis=0).std(axis=0) / np.sqrt(2)
    sigma = metric.sigma[1][steady].mean(axis=0) * scene.spectrometer_integration_time
    # Right: with noise of another size all SNR would be wrong.
    assert np.median(noise / sigma) == pytest.approx(1.0, abs=0.05)


def test_a_swing_of_the_surface_is_no_signal(workbench, metric):
    """0.3 K with a period of 37 s; the temperature is free every 8 s and linear between."""
    before = metric.scene.glow

    def glow(instrument, wavelength, kelvin, time):
        return before(instrument, wavelength, kelvin + 0.3 * np.sin(2 * np.pi * time / 37.0), time)

    output = workbench.clean(dataclasses.replace(metric.scene, glow=glow), metric.gas, metric.base)
    raw = metric.whiten(output)
    assert np.linalg.norm(metric.project(raw)) < 0.1 * np.linalg.norm(raw)


def test_what_an_analysis_must_leave_free_is_no_signal(workbench, metric):
    """A change of emittance or of the gas within its prior is worth at most its prior."""
    brighter = dataclasses.replace(metric.gas, radiance=metric.gas.radiance * 1.1)
    output = workbench.clean(metric.scene, brighter, metric.base)
    raw = metric.whiten(output)
    left = np.linalg.norm(metric.project(raw))
    assert np.linalg.norm(raw) > 10 * left and left < 1.0  # a tenth of 30 % before and after injection


@pytest.mark.parametrize(("effect", "amplitude"), [("wshift", 0.02), ("lsf", 0.028)])
def test_what_a_simulation_must_state_of_itself_is_free(workbench, metric, effect, amplitude):
    """A scale a kelvin off, a slit of 0.7529 nm that is stated as 0.75 nm."""
    scene = bench.apply(metric.scene, metric.gas, [{"effect": effect, "amplitude": amplitude}])
    changed = metric.whiten(workbench.clean(scene, metric.gas, metric.base))
    away = [min(np.linalg.norm(row - changed), np.linalg.norm(row + changed)) for row in metric.nuisance]
    assert min(away) < 0.1 * np.linalg.norm(changed)  # the other sign bends the other way


@pytest.mark.parametrize("steps", [4.0, 8.0])
def test_a_line_many_times_as_bright_costs_the_steps_of_its_strength(workbench, metric, steps):
    """Strengths are factors: four steps of 8 % make 1.38, which a tangent would count as five."""
    name, (system, first, last) = "O I 777", bench.LINES["O I 777"]
    radiance = metric.gas.radiance.copy()
    inside = (metric.gas.centres > first * 1e-9) & (metric.gas.centres < last * 1e-9)
    radiance[metric.gas.systems.index(system), inside] *= np.exp(steps * LINE_SIZE)
    other = dataclasses.replace(metric.gas, radiance=radiance)
    change = metric.whiten(workbench.clean(metric.scene, other, metric.base))
    linear = metric.project(change)
    start = np.clip(linear[-len(metric.nuisance) :], -1, 1)
    found = metric._beyond_tangents(change, start)
    assert np.linalg.norm(found) <= steps * (1 + 1e-2), name
    assert np.linalg.norm(found) < np.linalg.norm(linear)


def test_alike_effects_are_close_and_others_far(metric):
    assert metric.angle("winD", "winD") == pytest.approx(0.0, abs=1e-3)
    assert metric.angle("winD", "winD_sl") < 40
    assert metric.angle("winE", "off1") > 60
    assert metric.angle("winE", "no such cause") == 90.0


def test_size_out_of_reach_is_not_made(workbench):
    case = draw.Case("x", "single", 7, effects=(("afterglow", 500.0, 1, {"decay_s": 1.0}),))
    with pytest.raises(make.BeyondRange, match="afterglow at SNR 500 needs the amplitude"):
        make.make(case, workbench)


# ---- the truth stays hidden -----------------------------------------------------------------------------


class Spy:
    """In place of the analyser's process: keeps its order and looks around its folder."""

    def __init__(self):
        self.order, self.seen = None, None

    def ask(self, order):
        self.order = order
        folder = Path(order["data"])
        self.seen = sorted(path.name for path in folder.parent.rglob("*"))
        with xr.open_dataset(folder / "test.nc") as test:
            self.words = json.dumps({key: str(value) for key, value in test.attrs.items()}) + str(list(test))
        return {"ok": False, "fault": "only looking"}


def test_analyser_gets_the_data_and_nothing_else(workbench, tmp_path):
    case = draw.Case("single-x", "single", 11, effects=(("winE", 20.0, 1, {}),))
    spy = Spy()
    record = run.run_case(case, workbench, [tmp_path] * draw.LABORATORIES, tmp_path, tmp_path, spy)
    assert record["outcome"] == "failed" and record["reason"] == "only looking"
    assert spy.seen == ["data", "test.nc"]
    assert "winE" not in spy.words and "seed" not in spy.words
    told = json.dumps(spy.order)
    assert "winE" not in told and "11" not in told.replace(str(tmp_path), "")
    assert set(spy.order) == {"do", "data", "out", "radiance", "laboratory", "without", "sabotage"}


def test_only_the_worker_knows_the_package():
    for path in (ROOT / "workflow/blind").glob("*.py"):
        names = {
            name.split(".")[0]
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            for name in (
                [alias.name for alias in node.names]
                if isinstance(node, ast.Import)
                else [node.module or ""]
                if isinstance(node, ast.ImportFrom)
                else []
            )
        }
        own = path.name in ("worker.py", "sabotage.py")
        assert ("plasmapyro" in names) == own, path.name
    for path in (ROOT / "src").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert "import twin" not in text and "from twin" not in text and "from blind" not in text


# ---- scoring ---------------------------------------------------------------------------------------------


def made(kind="single", effects=("winE",)):
    case = draw.Case("x", kind, 1)
    base = bench.draw_base(1, 4)
    hidden_ones = tuple({"effect": name, "amplitude": 0.1, "shape": {}, "snr": 20.0} for name in effects)
    return make.Made(case, base, hidden_ones, None)


def answer(status, named=(), sets=(), probability=None):
    return {
        "verdict": {
            "status": status,
            "named": list(named),
            "set": [list(one) for one in sets],
            "probability": probability or {},
            "uncalibrated": max((probability or {"none": 1.0}).values()),
            "unknown": None,
            "sentences": [""],
        },
        "discrepancy": {"class": None},
        "candidates": [],
        "simulation": {"gains": []},
        "extended": None,
        "gain": None,
        "base": {"adequate": True, "chi2": 10.0, "dof": 10.0},
        "show": {"line_hump": {"closest": "refl"}},
    }


def temperatures(one, paper=40.0, base=20.0, extended=2.0, half=5.0):
    time = np.arange(-10.0, 330.0, 5.0)
    truth = one.temperature(time)
    variables = {"paper_temperature": ("time_bin", truth + paper)}
    for name, off in (("base", base), ("extended", extended)):
        for suffix, shift in (("", 0.0), ("_low", -half), ("_high", half)):
            variables[f"{name}_temperature{suffix}"] = ("time_bin", truth + off + shift)
    return xr.Dataset(variables, {"time_bin": time})


def near(one, other):
    """Angles of a made-up world: winE and winE_sl are alike."""
    return 10.0 if {one, other} == {"winE", "winE_sl"} else 80.0


@pytest.mark.parametrize(
    ("named", "sets", "exact", "class_", "in_set", "extra"),
    [
        (["winE"], [["winE"]], True, True, True, []),
        (["winE_sl"], [["winE_sl"]], False, True, False, []),
        (["phi"], [["phi", "winE"]], False, True, True, ["phi"]),
        (["phi"], [["phi"]], False, False, False, ["phi"]),
        (["winE", "clock"], [["winE"], ["clock"]], True, True, True, ["clock"]),
        ([], [], False, False, False, []),
    ],
)
def test_names_are_scored_exactly_by_class_and_by_set(named, sets, exact, class_, in_set, extra):
    one = made()
    result = score(one, answer("named" if named else "null", named, sets), temperatures(one), near)
    assert (result["exact"], result["class"], result["in_set"]) == ([exact], [class_], [in_set])
    assert result["extra"] == extra and result["alarm"] == bool(named)


def test_unknown_is_right_outside_the_catalogue_and_confidence_in_a_wrong_name_is_not():
    one = made("outside", ("etalon",))
    right = score(
        one, answer("unknown", probability={"unknown": 0.99, "none": 0.01}), temperatures(one), near
    )
    assert right["unknown"] and not right["confident_wrong"] and right["brier"] < 1e-3
    wrong = score(
        one, answer("named", ["lsf"], [["lsf"]], {"lsf": 0.9, "unknown": 0.1}), temperatures(one), near
    )
    assert not wrong["unknown"] and wrong["confident_wrong"]
    assert wrong["log_score"] == pytest.approx(np.log(0.1)) and not wrong["stated_right"]


def test_temperatures_are_judged_against_the_true_ones():
    one = made()
    judged = judge_temperature(one, temperatures(one))
    assert judged["paper"]["rms"] == pytest.approx(40.0) and judged["base"]["worst"] == pytest.approx(20.0)
    assert judged["base"]["coverage"] == 0.0 and judged["extended"]["coverage"] == 1.0
    assert judged["extended"]["sigma"] == pytest.approx(5.0 / 1.96)


def test_temperatures_are_judged_where_a_surface_shines_and_away_from_its_own_end_of_the_plasma():
    time = np.arange(0.0, 240.0, 2.0)
    truth = np.where(time < 60, 400.0, 1500.0)
    wrong = np.where((time < 60) | (np.abs(time - 200.5) < 1.5), 90.0, 3.0)
    rows = {f"{which}_temperature": truth + wrong for which in ("paper", "base", "extended")}
    rows |= {f"{which}_temperature_{end}": truth + sign * 5 for which in ("base", "extended")
             for end, sign in (("low", -1), ("high", 1))}  # fmt: skip
    table = xr.Dataset({name: ("time_bin", row) for name, row in rows.items()}, {"time_bin": time})
    one = SimpleNamespace(temperature=lambda at: np.interp(at, time, truth), coldest=850.0, plasma_off=200.0)
    assert judge_temperature(one, table)["base"]["worst"] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("hits", "trials", "low", "high"),
    [(0, 10, 0.0, 0.3085), (5, 10, 0.1871, 0.8129), (10, 10, 0.6915, 1.0), (20, 400, 0.0308, 0.0762)],
)
def test_intervals_of_rates_are_those_of_clopper_and_pearson(hits, trials, low, high):
    assert board.clopper_pearson(hits, trials) == pytest.approx((low, high), abs=6e-5)


def entry(kind, effects, one, report, noise=None):
    record = {"case": "x", "kind": kind, "noise": noise, "outcome": "scored", "effects": list(one.effects)}
    record["score"] = score(one, report, temperatures(one), near)
    return record | {"cost": {"wall": 3.0, "processor": 2.0}}


def test_board_counts_what_happened(tmp_path):
    nothing = made("null", ())
    records = [entry("null", (), nothing, answer("null", probability={"none": 1.0})) for _ in range(3)]
    records.append(entry("null", (), nothing, answer("named", ["phi"], [["phi"]])))
    records.append(entry("liar", (), nothing, answer("null"), noise="remembering"))
    single = made()
    records.append(entry("single", ("winE",), single, answer("named", ["winE"], [["winE"]])))
    records.append(entry("single", ("winE",), single, answer("one-of", ["phi"], [["phi"]])))
    two = made("double", ("winE", "clock"))
    records.append(entry("double", (), two, answer("named", ["winE_sl", "clock"], [["winE_sl"], ["clock"]])))
    outside = made("outside", ("etalon",))
    records.append(entry("outside", (), outside, answer("unknown")))
    puzzle = made("puzzle", ("refl",))
    records.append(entry("puzzle", (), puzzle, answer("null")))
    records.append({"case": "y", "kind": "single", "noise": None, "outcome": "beyond range", "reason": ""})
    summary = board.summary(records)
    assert summary["false_alarms"]["hits"] == 1 and summary["false_alarms"]["trials"] == 4
    assert summary["false_alarms_wrong_noise"]["rate"] == 0.0
    assert summary["at_least_20"]["exact"]["rate"] == 0.5 and summary["ladder"]["20"]["class"]["rate"] == 0.5
    assert summary["double"]["both_classes"]["rate"] == 1.0 and summary["double"]["both_exact"]["rate"] == 0.0
    assert summary["outside"]["unknown"]["rate"] == 1.0 and summary["puzzle"]["right"]["rate"] == 1.0
    assert summary["temperature"]["reduction_where_biased"]["value"] == pytest.approx(10.0)
    assert summary["confusion"] == {"winE": {"winE": 1, "phi": 1}}
    assert summary["skipped"] == {"single": 1}
    held = {row["bar"]: row["held"] for row in summary["bars"]}
    assert held["false alarms, right noise"] is False and held["class named, SNR >= 8"] is False
    assert held["sabotaged formula: still named exactly"] is None
    told = page.text(summary, "Seed `x`.", ["A note."])
    assert (
        "| false alarms, right noise | 0.25 (0.00631 to 0.806) | 4 | <= 0.05 | **missed** |" in told
        and "A note." in told
    )
    page.figure(summary, tmp_path / "board.png")
    assert (tmp_path / "board.png").stat().st_size > 10_000


def test_finished_cases_are_not_run_again(tmp_path, workbench):
    case = draw.draw("seed", {"null": 1})[0]
    run._log(tmp_path)
    run._store(
        tmp_path, {"case": case.name, "kind": "null", "noise": None, "outcome": "failed", "reason": "x"}
    )
    run.main(["--seed", "seed", "--null", "1", "--out", str(tmp_path), "--results", str(tmp_path / "none")])
    summary = json.loads((tmp_path / "scoreboard.json").read_text(encoding="utf-8"))
    assert summary["failed"] == {"null": 1}


def test_missing_results_are_named(tmp_path):
    with pytest.raises(ValueError, match="no radiation files; run the main job first"):
        bench.load(tmp_path)


def test_a_dead_analyser_is_a_failed_case(tmp_path):
    analyser = run.Analyser(tmp_path / "log")
    try:
        answer = analyser.ask({"do": "nothing of the kind"}, limit=60)
        assert not answer["ok"] and "KeyError" in answer["fault"]
        late = analyser.ask({"do": "prepare", "laboratory": str(tmp_path)}, limit=0.0)
        assert not late["ok"] and "no answer within 0 s" in late["fault"]
        assert analyser.process is None
    finally:
        analyser.close()


def test_calibration_files_of_a_laboratory_are_those_a_user_would_make(tmp_path):
    analyser = run.Analyser(tmp_path / "log")
    (tmp_path / "instrument").mkdir()
    from plasmapyro import io

    io.write(RESPONSE, tmp_path / "instrument/response.nc", "response")
    try:
        folders = run.laboratories(tmp_path, tmp_path, SimpleNamespace(response=RESPONSE), "seed", analyser)
    finally:
        analyser.close()
    ratios = []
    for folder in folders:
        calibration = io.read(folder / "calibration.nc", "calibration")
        spectrometer = io.read(folder / "spectrometer_calibration.nc", "spectrometer_calibration")
        assert spectrometer.sizes["wavelength"] == bench.PIXELS
        ratios.append(float(calibration.sensitivity_ratio))
    assert len(set(ratios)) == draw.LABORATORIES
    np.testing.assert_allclose(ratios, campaign.Pyrometer().sensitivity_ratio, rtol=0.01)


def test_calibration_table_holds_shares_of_right_answers_as_of_the_full_mix():
    nothing, single = made("null", ()), made()
    records = [entry("null", (), nothing, answer("null", probability={"none": 0.9})) for _ in range(40)]
    records += [entry("single", (), single, answer("null", probability={"none": 0.9})) for _ in range(60)]
    records += [
        entry("single", (), single, answer("named", [name], [[name]], {name: 0.99}))
        for name in ["winE"] * 30 + ["clock"] * 30
    ]
    rows = {status: calibrate.steps(cases) for status, cases in calibrate.pairs(records).items()}
    # Nulls count 400/40 each, singles of SNR 20 168/120: of 484 that are called none, 400 are.
    assert rows["null"][0][1] == pytest.approx(400 / (400 + 60 * 168 / 120), abs=0.01)
    assert sum(size for _, _, size in rows["named"]) == 60
    assert [right for _, right, _ in rows["named"]] == pytest.approx([0.5] * len(rows["named"]), abs=0.02)


def test_staircase_of_right_answers_rises_with_what_is_stated():
    random = np.random.default_rng(4)
    stated = random.uniform(0.4, 1.0, 3000)
    right = random.random(3000) < stated**2
    rows = calibrate.steps([(s, bool(r), 1.0) for s, r in zip(stated, right, strict=True)])
    x, y, size = np.array(rows).T
    assert np.all(np.diff(y) > 0) and size.sum() == 3000
    # Steps of 30 cases and more, pooled: 0.1 is three standard errors.
    assert y == pytest.approx(x**2, abs=0.12)
