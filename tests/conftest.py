"""One thread per process: results must not depend on the number of cores. Reference tables, a browser."""

import csv
import hashlib
import os
import shutil
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


@pytest.fixture(scope="module")
def browser():
    """A headless Chromium, as large as a test asks for."""
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        pytest.skip("needs chromium and chromedriver (Debian: apt-get install chromium chromium-driver)")
    selenium = pytest.importorskip("selenium.webdriver")
    options = selenium.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for switch in ("headless", "no-sandbox", "disable-gpu", "disable-background-networking", "no-first-run"):
        options.add_argument(f"--{switch}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = selenium.Chrome(options, selenium.ChromeService(shutil.which("chromedriver")))
    yield driver
    driver.quit()
