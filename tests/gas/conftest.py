"""Tables of `tests/reference`, checked against their certificates."""

import csv
import hashlib
from pathlib import Path

import pytest
import yaml

FOLDER = Path(__file__).parents[1] / "reference"


@pytest.fixture
def reference():
    """Function name -> list of rows, each a dict of column name (without unit) to text."""

    def load(name):
        content = (FOLDER / f"{name}.csv").read_bytes()
        certificate = yaml.safe_load((FOLDER / f"{name}.yml").read_text(encoding="utf-8"))
        assert hashlib.sha256(content).hexdigest() == certificate["sha256"]
        header, *rows = csv.reader(content.decode("utf-8").splitlines())
        names = [cell.partition(" [")[0] for cell in header]
        return [dict(zip(names, row, strict=True)) for row in rows]

    return load
