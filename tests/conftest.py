"""One thread per process for all tests: results must not depend on the number of cores. Reference tables."""

import csv
import hashlib
import os
from pathlib import Path

import pytest
import yaml

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

FOLDER = Path(__file__).parent / "reference"


@pytest.fixture
def published():
    """Function name -> list of rows of a reference table, checked against its certificate.

    Each row is a dict of column name (without unit) to text.
    """

    def load(name):
        content = (FOLDER / f"{name}.csv").read_bytes()
        certificate = yaml.safe_load((FOLDER / f"{name}.yml").read_text(encoding="utf-8"))
        assert hashlib.sha256(content).hexdigest() == certificate["sha256"]
        header, *rows = csv.reader(content.decode("utf-8").splitlines())
        names = [cell.partition(" [")[0] for cell in header]
        return [dict(zip(names, row, strict=True)) for row in rows]

    return load
