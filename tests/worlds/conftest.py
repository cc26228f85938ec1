"""Lets the tests import the second laboratory and the harness, which are no part of the package."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "workflow")]
