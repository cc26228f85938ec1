"""Each rule keeps a log and its time and memory, under a name of its own."""

import re
from pathlib import Path

import pytest

RULES = Path(__file__).resolve().parents[2] / "workflow" / "rules"


def rules():
    """(name, text) of every rule."""
    for path in sorted(RULES.glob("*.smk")):
        blocks = re.split(r"^rule (\w+):$", path.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
        for name, text in zip(blocks[::2], blocks[1::2], strict=True):
            yield name, text.partition("\nuse rule ")[0]


@pytest.mark.parametrize(("name", "text"), list(rules()), ids=[name for name, _ in rules()])
def test_a_rule_has_a_log_and_a_benchmark_of_its_own(name, text):
    (log,) = re.findall(r'^    log:\n        f?"results/logs/(\S+)\.log",$', text, re.MULTILINE)
    (benchmark,) = re.findall(
        r'^    benchmark:\n        f?"results/benchmarks/(\S+)\.tsv"$', text, re.MULTILINE
    )
    assert log == benchmark and log.replace("/", "_").startswith(name)


def test_each_rule_calls_the_script_of_its_name():
    assert len(list(rules())) > 40
    for name, text in rules():
        (script,) = re.findall(r'^    script:\n        "\.\./scripts/(\w+)\.py"$', text, re.MULTILINE)
        assert script == name
