"""docs/your-own-data.md, run as written."""

import re
from pathlib import Path

from plasmapyro import contracts
from plasmapyro.readers.stage import check_test, read_test

PAGE = Path(__file__).resolve().parents[2] / "docs" / "your-own-data.md"
FENCE = re.compile(r"```(\w+)(?: file=(\S+))?\n(.*?)```", re.DOTALL)


def blocks():
    return FENCE.findall(PAGE.read_text(encoding="utf-8"))


def write_folder(folder):
    folder.mkdir(parents=True)
    for _, name, content in blocks():
        if name:
            (folder / name).write_text(content, encoding="utf-8")
    return folder


def test_the_page_runs_as_written(tmp_path, monkeypatch):
    write_folder(tmp_path / "my_test")
    monkeypatch.chdir(tmp_path)
    programs = [content for language, _, content in blocks() if language == "python"]
    assert programs
    for program in programs:
        exec(compile(program, str(PAGE), "exec"), {})
    contracts.check(read_test("my_test"), "test")


def test_the_message_on_the_page_is_the_one_that_comes(tmp_path, monkeypatch):
    folder = write_folder(tmp_path / "my_test")
    table = folder / "pyrometer.csv"
    table.write_text(table.read_text().replace("52,80", "52,8O"))
    monkeypatch.chdir(tmp_path)
    (message,) = check_test("my_test")
    assert message in PAGE.read_text(encoding="utf-8")
