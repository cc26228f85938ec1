"""The examples of the documentation run as they stand."""

import re
from pathlib import Path

import matplotlib
import pytest

DOCS = Path(__file__).resolve().parents[1] / "docs"


def examples():
    for page in sorted(DOCS.glob("*.md")):
        for number, code in enumerate(re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL)):
            yield pytest.param(code, id=f"{page.name}-{number}")


@pytest.mark.parametrize("code", list(examples()))
def test_an_example_runs(code, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    matplotlib.use("Agg")
    namespace = {}
    exec(compile(code, "example", "exec"), namespace)
    drawn = list(tmp_path.glob("*.png"))
    assert len(drawn) == 1 and drawn[0].stat().st_size > 10_000
    lines = namespace["axes"].get_lines()
    assert len(lines) == namespace["spectrum"].sizes["component"]
    namespace["plt"].close("all")
