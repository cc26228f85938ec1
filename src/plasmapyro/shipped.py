"""The simulations that come with the package: light of the gas at nine powers, and what would change it."""

import hashlib
from functools import cache
from importlib.resources import as_file, files

import yaml

from plasmapyro import io

FOLDER = files("plasmapyro") / "data" / "simulations"
NAME = "air_50mbar_16gs"
OF_CONDITION = ("numerical_power", "optical_depth_simulated")  # attributes of a condition of its own
REMARK = "the test is compared with the simulations that come with plasmapyro, not with those of a run"


@cache
def stored():
    """The shipped file, contract 'simulations', and its SHA-256; ValueError if it is another one."""
    certificate = yaml.safe_load((FOLDER / f"{NAME}.yml").read_text(encoding="utf-8"))
    with as_file(FOLDER / f"{NAME}.nc") as path:
        found = hashlib.sha256(path.read_bytes()).hexdigest()
        if found != certificate["sha256"]:
            raise ValueError(f"{path}: was changed (sha256 {found}); install plasmapyro again")
        return io.read(path, "simulations"), found


def by_condition():
    """Condition -> Dataset with spectra as in contract 'radiation' and all of 'gas_variations'."""
    whole, _ = stored()
    found = {}
    for name in map(str, whole.condition.values):
        one = whole.sel(condition=name, drop=True)
        own = {key: float(one[key]) for key in OF_CONDITION}
        found[name] = one.drop_vars(OF_CONDITION).assign_attrs(own)
    return found
