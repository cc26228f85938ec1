"""A wrong configuration is refused with the key, its value, the rule and what was meant."""

from pathlib import Path

import pytest
import yaml
from snakemake.utils import update_config

from plasmapyro import configuration

ROOT = Path(__file__).resolve().parents[1]
CONDITION = ROOT / "config" / "schema_condition.yaml"
GOOD = {"numerical_power_kw": 90, "chamber_pressure_mbar": 50, "mass_flow_rate_g_s": 16, "emittance": 0.85}


def refusal(values):
    with pytest.raises(configuration.ConfigurationError) as caught:
        configuration.check(values, CONDITION, "90kW.yaml")
    return str(caught.value)


def test_a_misspelt_key_is_named_with_the_nearest_valid_one():
    message = refusal({**GOOD, "emitance": 0.8})
    assert "90kW.yaml" in message and "unknown key 'emitance'; did you mean 'emittance'?" in message


def test_all_faults_are_listed_with_their_rule():
    message = refusal({**GOOD, "emittance": 1.2, "numerical_power_kw": "ninety"})
    assert "emittance: 1.2 is greater than the maximum of 1" in message
    assert "numerical_power_kw: 'ninety' is not of type 'number'" in message


def test_a_missing_key_is_named():
    message = refusal({key: GOOD[key] for key in GOOD if key != "emittance"})
    assert "'emittance' is a required property" in message


@pytest.mark.parametrize("number", [float("nan"), float("inf")])
def test_a_number_without_end_is_refused(number):
    assert "emittance: " in refusal({**GOOD, "emittance": number})


def test_a_key_given_twice_is_refused(tmp_path):
    text = "\n".join(f"{key}: {value}" for key, value in GOOD.items())
    (tmp_path / "x.yaml").write_text(f"{text}\nemittance: 0.2\n")
    with pytest.raises(configuration.ConfigurationError, match="key 'emittance' is given twice"):
        configuration.load(tmp_path / "x.yaml", CONDITION)


@pytest.mark.parametrize(
    "words, said",
    [
        ("050", "'050' would be read as 40; write it without"),  # octal in YAML 1.1
        ("-0_20", "'-0_20' would be read as -16"),
        ("1:30", "'1:30' would be read as 90"),  # to the base of 60
        ("095", "'095' is not of type 'number'; write 95 "),
        ("5e1", "'5e1' is not of type 'number'; write 50 "),
        ("50 mbar", "'50 mbar' is not of type 'number' ("),
    ],
)
def test_a_number_that_yaml_takes_for_another_is_refused(tmp_path, words, said):
    text = "\n".join(f"{key}: {value}" for key, value in (GOOD | {"chamber_pressure_mbar": words}).items())
    (tmp_path / "x.yaml").write_text(text)
    with pytest.raises(configuration.ConfigurationError) as caught:
        configuration.load(tmp_path / "x.yaml", CONDITION)
    assert said in str(caught.value)


def test_a_number_of_one_meaning_is_read(tmp_path):
    for words in ("0", "-0", "+50", "5_0", "05", "00", "0x32", "50.", "0.05", "5.0e+1", "012.5"):
        (tmp_path / "x.yaml").write_text(f"x: {words}")
        assert isinstance(configuration.read(tmp_path / "x.yaml")["x"], int | float), words


@pytest.mark.parametrize("name", ["95kW.yml", "95kW.YAML", "95kW.yaml.txt"])
def test_a_file_whose_ending_hides_it_is_named(tmp_path, name):
    for one in ("90kW.yaml", "95kW.yaml.off", "notes.txt"):
        (tmp_path / one).write_text("\n".join(f"{key}: {value}" for key, value in GOOD.items()))
    assert set(configuration.load_folder({"folder": tmp_path, "only": []}, CONDITION)) == {"90kW"}
    (tmp_path / name).write_text("numerical_power_kw: 95")
    with pytest.raises(configuration.ConfigurationError, match=f"{name}: is not read; let its name end in"):
        configuration.load_folder({"folder": tmp_path, "only": []}, CONDITION)


def test_hidden_files_that_systems_leave_behind_are_no_configurations(tmp_path):
    (tmp_path / "90kW.yaml").write_text("\n".join(f"{key}: {value}" for key, value in GOOD.items()))
    (tmp_path / "._90kW.yaml").write_bytes(b"\x00\x05\x16\x07")
    found = configuration.load_folder({"folder": tmp_path, "only": []}, CONDITION)
    assert set(found) == {"90kW"}


def test_a_rule_of_a_condition_that_stands_in_the_schema_beside_it_holds():
    with pytest.raises(configuration.ConfigurationError) as caught:
        own = {"probe_temperature_k": 5000, "adiabatic_walls": ["roof"]}
        configuration.check({**GOOD, "flow": own}, CONDITION, "90kW.yaml")
    message = str(caught.value)
    assert "flow.probe_temperature_k: 5000 is greater than the maximum of 3500 (Temperature of" in message
    assert "flow.adiabatic_walls.0: 'roof'" in message


def shipped():
    config = configuration.load(ROOT / "config/config.yaml", ROOT / "config/schema.yaml")
    conditions = configuration.load_folder(config["conditions"], CONDITION, order="numerical_power_kw")
    return config, conditions, configuration.load_folder(config["tests"], ROOT / "config/schema_test.yaml")


def spoil(config, place, value):
    *path, last = place.split(".")
    for key in path:
        config = config[key]
    config[last] = value


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        ("gas.temperature_k", [15000, 200, 25], "gas.temperature_k: [15000, 200] must rise"),
        ("radiation.wavelength_nm", [1200, 700], "radiation.wavelength_nm: [1200, 700] must rise"),
        ("analysis.error_emittance", [0.5, 2.0, 50], "analysis.error_emittance.1: 2.0 is greater"),
        ("gas.pressure_mbar", [50, 40], "must rise"),
    ],
)
def test_a_range_that_does_not_fit_is_refused(place, value, message):
    config = shipped()[0]
    spoil(config, place, value)
    with pytest.raises(configuration.ConfigurationError) as caught:
        configuration.check(config, ROOT / "config/schema.yaml", "config.yaml")
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        (
            "figures.field_condition",
            "91kW",
            "figures.field_condition: no file for '91kW'; did you mean '90kW'?",
        ),
        ("claims.test", "csic", "claims.test: no file for 'csic'; known: csic_160kW"),
        ("experiment.compare_with", ["85kW"], "experiment.compare_with: no file for '85kW'"),
        ("gas.pressure_mbar", [60, 100], "chamber_pressure_mbar of 50kW: 50 mbar lies outside"),
        ("sightline.window_distance_mm", 1200, "window_distance_mm must be less than"),
    ],
)
def test_values_that_do_not_fit_together_are_refused(place, value, message):
    config, conditions, tests = shipped()
    configuration.check_together(config, conditions, tests)
    spoil(config, place, value)
    with pytest.raises(configuration.ConfigurationError) as caught:
        configuration.check_together(config, conditions, tests)
    assert message in str(caught.value)


def test_the_conditions_of_the_claims_differ_in_their_power_only():
    config, conditions, tests = shipped()
    case = conditions["90kW"]
    conditions |= {
        "wet": {**case, "chamber_pressure_mbar": 20},
        "twin": dict(case),
        "own": {**case, "cfd": {}},
        "mixed": {**case, "flow": {"mixing": 0.1}},
    }
    del conditions["own"]["numerical_power_kw"]
    configuration.check_together(config, conditions, tests)  # as the user's own conditions they may be there
    config["claims"]["conditions"] += ["wet", "twin", "own", "mixed"]
    with pytest.raises(configuration.ConfigurationError) as caught:
        configuration.check_together(config, conditions, tests)
    message = str(caught.value)
    assert "chamber_pressure_mbar is 20 in 'wet' and 50 in '50kW'" in message
    assert "'90kW' and 'twin' have the same numerical_power_kw" in message
    assert "'own' lacks numerical_power_kw" in message
    assert "'mixed' has another flow than '50kW'" in message


def test_measurements_that_nothing_would_be_held_against_are_refused():
    config, conditions, tests = shipped()
    own = {"measured": {"pitot_pressure_pa": {}}}
    conditions["mine"] = conditions["90kW"] | own
    configuration.check_together(config, conditions, tests)
    conditions["theirs"] = conditions["90kW"] | own | {"cfd": {}}
    with pytest.raises(configuration.ConfigurationError, match="measured of theirs: held against computed"):
        configuration.check_together(config, conditions, tests)
    del conditions["theirs"], config["facility"]
    with pytest.raises(
        configuration.ConfigurationError, match="measured of mine: needs the section 'facility'"
    ):
        configuration.check_together(config, conditions, tests)


@pytest.mark.parametrize("key", ["figures.field_condition", "analysis.transient.conditions"])
def test_what_the_paper_shows_must_be_in_its_set(key):
    config, conditions, tests = shipped()
    config["claims"]["conditions"] = ["50kW", "70kW"]
    with pytest.raises(configuration.ConfigurationError, match=f"{key}: '.0kW' is not in claims.conditions"):
        configuration.check_together(config, conditions, tests)


def test_only_another_programs_flow_may_lack_a_power():
    assert "'numerical_power_kw' is a required property" in refusal(
        {key: GOOD[key] for key in GOOD if key != "numerical_power_kw"}
    )
    own = {key: GOOD[key] for key in GOOD if key != "numerical_power_kw"} | {"cfd": {"file": "flow.vtu"}}
    configuration.check(own, CONDITION, "mine.yaml")


def test_a_ladder_of_files_shares_all_but_power_and_emittance():
    conditions = {
        "low": GOOD | {"numerical_power_kw": 60, "emittance": 0.5},
        "own": GOOD,
        "another emittance": GOOD | {"emittance": 0.5},
        "wet": GOOD | {"chamber_pressure_mbar": 20},
        "foreign": GOOD | {"cfd": {"file": "a.vtu", "geometry": "axisymmetric"}},
        "foreign 2": GOOD | {"numerical_power_kw": 80, "cfd": {"file": "b.vtu", "geometry": "axisymmetric"}},
    }
    assert configuration.ladder(conditions, "own") == ["low", "own"]
    assert configuration.ladder(conditions, "low") == ["low", "another emittance"]  # the first by name
    assert configuration.ladder(conditions, "foreign") == ["foreign", "foreign 2"]
    del conditions["foreign"]["numerical_power_kw"]
    assert configuration.ladder(conditions, "foreign") == ["foreign"]
    assert configuration.ladder(conditions, "foreign 2") == ["foreign 2"]


def test_a_test_of_an_unknown_condition_is_refused_with_the_nearest():
    configuration.check_compared({"a": "90kW"}, {"90kW": GOOD})
    with pytest.raises(
        configuration.ConfigurationError, match="condition of test a: no file for '91kW'; did you mean '90kW'"
    ):
        configuration.check_compared({"a": "91kW", "b": "90kW"}, {"90kW": GOOD})


def test_a_twin_of_an_unknown_condition_is_refused():
    config, conditions, tests = shipped()
    tests["csic_160kW"]["twin"]["condition"] = "95kW"
    with pytest.raises(configuration.ConfigurationError, match="twin.condition of test csic_160kW: no file"):
        configuration.check_together(config, conditions, tests)


def test_a_file_of_a_condition_that_the_run_leaves_out_says_how_to_have_it(tmp_path):
    (tmp_path / "mine.yaml").write_text("")
    known, selection = {"60kW": {}, "80kW": {}}, {"folder": tmp_path, "only": ["60kW", "80kW"]}
    sound = ["results/flow/60kW.nc", "results/flow/start/reference.nc", "results/figures/fig8c.svg", "all"]
    configuration.check_targets(sound, known, selection)
    left_out = r"add --config 'conditions=\{only: \[60kW, 80kW, mine\]\}'"
    for target, message in (("mine", left_out), ("80kw", "no file for '80kw'; did you mean '80kW'")):
        with pytest.raises(configuration.ConfigurationError, match=message):
            configuration.check_targets([f"results/radiation/{target}.nc"], known, selection)


def test_broken_yaml_names_the_file(tmp_path):
    (tmp_path / "x.yaml").write_text("a: [1\n")
    with pytest.raises(configuration.ConfigurationError, match=r"x\.yaml: not readable as YAML"):
        configuration.load(tmp_path / "x.yaml", CONDITION)


@pytest.mark.parametrize("path", sorted((ROOT / "config/conditions").glob("*.yaml")), ids=lambda p: p.stem)
def test_the_shipped_conditions_are_valid(path):
    configuration.load(path, CONDITION)


@pytest.mark.parametrize("path", sorted((ROOT / "config/tests").glob("*.yaml")), ids=lambda p: p.stem)
def test_the_shipped_tests_are_valid(path):
    configuration.load(path, ROOT / "config/schema_test.yaml")


def test_the_shipped_configurations_are_valid():
    config = configuration.load(ROOT / "config/config.yaml", ROOT / "config/schema.yaml")
    update_config(config, configuration.read(ROOT / "config/minimal.yaml"))  # as Snakemake does
    configuration.check(config, ROOT / "config/schema.yaml", "config.yaml with minimal.yaml")


def leaves(tree, path=()):
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield from leaves(value, (*path, key))
    else:
        yield path, tree


def test_minimal_holds_what_differs_from_the_full_configuration_and_nothing_else():
    full, minimal = (
        dict(leaves(yaml.safe_load((ROOT / "config" / name).read_text())))
        for name in ("config.yaml", "minimal.yaml")
    )
    assert minimal.keys() <= full.keys()
    assert [key for key in minimal if minimal[key] == full[key]] == []


def every_level(schema, path=""):
    if schema.get("type") == "object":
        yield path, schema
    for key, rule in schema.get("properties", {}).items():
        yield from every_level(rule, f"{path}.{key}")


def referred(rule):
    """The rule itself, or the one in the file beside it that it refers to."""
    if "$ref" not in rule:
        return rule
    name, _, path = rule["$ref"].partition("#/")
    found = yaml.safe_load((ROOT / "config" / name).read_text())
    for key in path.split("/"):
        found = found[key]
    return found


@pytest.mark.parametrize("name", ["schema.yaml", "schema_condition.yaml", "schema_test.yaml"])
def test_schemas_are_closed_and_described(name):
    schema = yaml.safe_load((ROOT / "config" / name).read_text())
    for path, level in every_level(schema):
        assert isinstance(level.get("additionalProperties"), bool | dict), f"{name}{path} is open"
        assert level["additionalProperties"] is not True, f"{name}{path} is open"
        for key, rule in level.get("properties", {}).items():
            rule = referred(rule)
            assert "description" in rule or rule.get("type") == "object", (
                f"{name}{path}.{key} lacks a description"
            )
