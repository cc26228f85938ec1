"""Versions of everything that can move a number."""

from functools import cache
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("numpy", "scipy", "xarray", "netCDF4", "cantera", "scikit-fem", "netgen-mesher", "pymetis")


@cache
def versions():
    """Pairs of name and version of the package and of what it computes with; 'not installed' without one."""
    return tuple((name, _version(name)) for name in ("plasmapyro", *PACKAGES))


def told():
    """The versions in one line, as they stand in every netCDF file."""
    return ", ".join(f"{name} {number}" for name, number in versions())


def _version(name):
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
