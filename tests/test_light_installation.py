"""What `pip install plasmapyro` brings: nothing of mesh, flow and workflow, nothing that Windows lacks."""

import ast
import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
COMMANDS = "init check calibrate correct correct_reading diagnose identify live radiance serve trust".split()
LIGHT = ["plasmapyro.cli", *(f"plasmapyro.commands.{name}" for name in COMMANDS)]
NOT_ON_WINDOWS = set(
    "crypt curses fcntl grp nis posix pty pwd readline resource spwd syslog termios tty".split()
)
BROUGHT_BY = {"yaml": "pyyaml", "markupsafe": "jinja2"}  # module: distribution, where the names differ
OF_AN_EXTRA = {("plasmapyro.gas.equilibrium", "cantera")}  # inside a function that these commands do not call


def modules():
    """Name -> path of every module of the package."""
    found = {}
    for path in (ROOT / "src").rglob("*.py"):
        parts = path.relative_to(ROOT / "src").with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imported(path):
    """Names that a module imports anywhere, but for those under `try` with `except ImportError`."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    spared = {
        id(node)
        for block in ast.walk(tree)
        if isinstance(block, ast.Try) and "ImportError" in "".join(ast.unparse(h) for h in block.handlers)
        for node in block.body
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Import) and id(node) not in spared:
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and id(node) not in spared:
            yield from (node.module, *(f"{node.module}.{alias.name}" for alias in node.names))


def light_part():
    """Modules that the light commands can reach -> what each imports from outside of the package."""
    known, found = modules(), {}
    waiting = list(LIGHT)
    while waiting:
        name = waiting.pop()
        if name in known and name not in found:
            names = set(imported(known[name]))
            found[name] = {one.split(".")[0] for one in names} - {"plasmapyro"}
            waiting += [one for one in names if one.startswith("plasmapyro")]
    return found


def test_the_light_part_imports_its_dependencies_and_nothing_that_windows_lacks():
    wanted = {re.split(r"[^\w-]", one)[0].lower() for one in PROJECT["dependencies"]}
    part = light_part()
    assert len(part) > 150  # the search follows imports
    outside = {(module, name) for module, names in part.items() for name in names}
    assert not {pair for pair in outside if pair[1] in NOT_ON_WINDOWS}
    foreign = {pair for pair in outside if pair[1] not in sys.stdlib_module_names}
    assert {pair for pair in foreign if BROUGHT_BY.get(pair[1], pair[1]).lower() not in wanted} == OF_AN_EXTRA
    used = {BROUGHT_BY.get(name, name).lower() for _, name in foreign} | {"netcdf4"}  # by xarray
    assert not wanted - used  # none is asked for in vain


def test_what_the_tests_add_is_locked_apart_and_agrees():
    run, test = (
        dict(re.findall(r"^([\w-]+)==(\S+)", (ROOT / f"environment{part}.lock").read_text(), re.MULTILINE))
        for part in ("", "-test")
    )
    assert {"numpy", "snakemake", "cantera"} <= set(run) and {"pytest", "ruff", "mypy"} <= set(test)
    assert not set(run) & set(test)
