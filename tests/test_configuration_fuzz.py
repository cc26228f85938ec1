"""Thousands of wrong configurations: each is taken as it stands or refused with one message, nothing else.

`PLASMAPYRO_FUZZ=10000 pytest tests/test_configuration_fuzz.py` tries that many.
"""

import os
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from judge import judge, require_refused

from plasmapyro import configuration

ROOT = Path(__file__).resolve().parents[1]
FILES = {
    "config/config.yaml": "config/schema.yaml",
    "config/conditions/90kW.yaml": "config/schema_condition.yaml",
    "config/tests/csic_160kW.yaml": "config/schema_test.yaml",
}
COUNT = int(os.environ.get("PLASMAPYRO_FUZZ", "120"))
SCRAPS = [
    "\t", "&a ", "*a", "<<: *a", "!!python/object/apply:os.system ['true']", "!!binary aGk=", "---\n", "...",
    "1e999", "-.inf", ".nan", "1" * 5000, "9" * 400, "0x10", "1_000", "12:30:00", "2020-01-01", "~", "yes",
    "{", "}", "[", "]", "'", '"', ":", "- ", "# ", "? ", "|", ">", "\x00", "\ufeff", "é", "90 kW",
    "../../etc", "/etc/passwd", "{test}", "$(true)", "null", "[[[[[[", "{a: {a: {a: 1}}}", "emittance: 0.5\n",
]  # fmt: skip
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.dates(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=6), inner, max_size=3),
    max_leaves=6,
)


def places(values, path=()):
    """Paths of all keys and entries in nested mappings and lists."""
    pairs = (
        values.items() if isinstance(values, dict) else enumerate(values) if isinstance(values, list) else ()
    )
    for key, inner in pairs:
        yield (*path, key)
        yield from places(inner, (*path, key))


def outcome(path, schema):
    """The accepted mapping, or the message of the refusal; any other end is a fault."""
    try:
        return configuration.load(path, ROOT / schema)
    except configuration.ConfigurationError as refusal:
        message = str(refusal)
        assert path.name in message and "Traceback" not in message
        return message


@pytest.mark.parametrize("name", FILES)
@settings(max_examples=COUNT // 6, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(data=st.data())
def test_a_wrong_value_is_refused_by_its_key_or_taken_as_it_stands(name, tmp_path_factory, data):
    values = yaml.safe_load((ROOT / name).read_text(encoding="utf-8"))
    place = data.draw(st.sampled_from(list(places(values))))
    new = data.draw(VALUES)
    target = values
    for key in place[:-1]:
        target = target[key]
    action = data.draw(st.sampled_from(["replace", "drop", "rename"]))
    old = target[place[-1]]
    if action == "replace":
        target[place[-1]] = new
    else:
        del target[place[-1]]
    if action == "rename" and isinstance(target, dict):
        target[f"{place[-1]}x"] = old
    path = tmp_path_factory.getbasetemp() / "fuzz.yaml"
    path.write_text(yaml.safe_dump(values, allow_unicode=True), encoding="utf-8")
    found = outcome(path, FILES[name])
    if action == "rename" and isinstance(target, dict) and len(place) == 1:
        assert isinstance(found, str) and f"'{place[-1]}x'" in found, "an unknown key was taken"
    if not isinstance(found, str):
        assert found == values or repr(found) == repr(values), "a value was changed in silence"


@pytest.mark.parametrize("name", FILES)
@settings(max_examples=COUNT // 6, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(data=st.data())
def test_a_spoilt_text_is_refused_in_one_message_or_still_valid(name, tmp_path_factory, data):
    text = (ROOT / name).read_text(encoding="utf-8")
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(text)))
        length = data.draw(st.integers(0, 12))
        text = text[:place] + data.draw(st.sampled_from(SCRAPS)) + text[place + length :]
    path = tmp_path_factory.getbasetemp() / "fuzz.yaml"
    path.write_bytes(text.encode("utf-8", errors="replace"))
    outcome(path, FILES[name])


def refusal(tmp_path, text):
    path = tmp_path / "x.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(configuration.ConfigurationError) as caught:
        configuration.load(path, ROOT / "config/schema_condition.yaml")
    return str(caught.value)


def test_a_bomb_of_aliases_is_refused_at_its_first_alias(tmp_path):
    bomb = "a: &a [x]\n" + "".join(
        f"{b}: &{b} [*{a}, *{a}, *{a}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    assert "aliases (*name) are not taken" in refusal(tmp_path, bomb)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[" * 100_000, "nested too deeply"),
        ("a: " + "x" * 250_001, "the limit is 0.25 MB"),
        ("a: !!python/object/apply:os.getcwd []", "could not determine a constructor"),
        ("emittance:\t0.5\n\tx: 1", "not readable as YAML"),
        (b"\xff\xfe\x00", "not readable as YAML"),
        ("numerical_power_kw: " + "9" * 5000, "not readable as YAML"),
        ("- a\n- b", "is not of type 'object'"),
        ("", "is empty"),
    ],
)
def test_hostile_texts_are_refused_by_name(tmp_path, text, words):
    assert words in refusal(tmp_path, text)


@pytest.mark.parametrize("name", ["a b", "{test}", "-n", "a;b", "ü"])
def test_a_file_name_that_would_break_others_is_refused(tmp_path, name):
    (tmp_path / f"{name}.yaml").write_text("x: 1")
    with pytest.raises(configuration.ConfigurationError, match="the name of the file becomes part"):
        configuration.load_folder({"folder": tmp_path, "only": []}, ROOT / "config/schema_condition.yaml")


@pytest.mark.parametrize(
    "tag", ["!!int ''", "!!timestamp x", "!!float ''", "!!bool ''", "!!binary é", "!!null"]
)
def test_a_tag_that_does_not_fit_its_word_is_refused_or_a_wrong_value(tmp_path, tag):
    assert "x.yaml" in refusal(tmp_path, f"emittance: {tag}")


@pytest.mark.parametrize(
    "flood", ["1:", "1_", "[", "{", "- ", "? ", "'", "&a ", "!", "#\n", " ", "1.e", "\n\n\t"]
)
def test_a_flood_of_one_piece_is_refused_within_seconds(tmp_path, flood):
    (tmp_path / "x.yaml").write_text("emittance: " + flood * (200_000 // len(flood)))
    ending = judge(["sightline", tmp_path / "f.vtu", "--map", tmp_path / "x.yaml", "--out", "o.nc"], tmp_path)
    require_refused(ending, "x.yaml")
