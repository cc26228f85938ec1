"""Two-colour pyrometry through a radiating plasma: from torch flow to corrected surface temperature."""

import gc as _gc
import os as _os
from importlib import import_module as _import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from plasmapyro.api import calibrate, check, correct, diagnose, radiance, read, save, simulations

if "PLASMAPYRO_JOB" in _os.environ:  # of the workflow, until its modules are loaded: see `cost`
    _gc.disable()

__all__ = ["calibrate", "check", "correct", "diagnose", "radiance", "read", "save", "simulations"]


def __getattr__(name: str) -> object:
    """The public functions, imported when they are asked for: jobs and `--help` need none of them."""
    if name == "__version__":
        return _import_module("importlib.metadata").version("plasmapyro")
    if name in __all__:
        return getattr(_import_module("plasmapyro.api"), name)
    raise AttributeError(f"module 'plasmapyro' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
