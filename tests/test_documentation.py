"""The example of the radiation page runs as it stands (the page on own data is tested with the readers)."""

import re
from pathlib import Path

import matplotlib
import pytest

PAGE = Path(__file__).resolve().parents[1] / "docs" / "radiation.md"


def examples():
    code = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    assert code, "the page lost its example"
    return code


@pytest.mark.parametrize("code", examples())
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
