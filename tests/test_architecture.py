"""The rules of layout that a machine can hold us to."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "plasmapyro"
BASE = {"constants", "checks", "progress", "tables", "refraction", "versions"}
MAY_IMPORT = {  # physics groups; every group may also import BASE and itself
    "gas": set(),
    "flow": {"gas"},
    "sightline": {"gas"},
    "radiation": {"gas"},
    "instrument": {"radiation"},
    "analysis": {"instrument", "radiation"},
    "design": {"gas", "sightline", "radiation", "instrument", "analysis"},
    "experiment": {"instrument", "analysis", "radiation"},
    "forward": {"radiation"},
    "estimate": {"forward", "experiment", "instrument", "radiation"},
    "readers": {  # files in, datasets out: the one group that knows files
        "contracts",
        "io",
        "experiment",
        "instrument",
        "radiation",
    },
    "diagnosis": {"gas", "radiation", "instrument", "experiment", "contracts", "io"},  # files: only `command`
    "claims": set(),
    "plots": {"contracts", "io"},
    "report": set(),
    "cfd": {"gas", "sightline", "readers", "configuration", "io"},  # files of other programs in, ours out
    "commands": {  # behind the command line
        "diagnosis",
        "estimate",
        "design",
        "io",
        "contracts",
        "configuration",
        "cfd",
        "experiment",
        "instrument",
        "radiation",
        "readers",
        "sightline",
    },
    "page": set(),
    # a plan reads the configuration, its jobs call the stages of the chain
    "study": {"configuration", "flow", "sightline", "radiation", "instrument", "analysis"},
}
BANNED_IN_PHYSICS = {"snakemake", "yaml", "matplotlib"}
SCRIPT_LINES = 30


def imports(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"relative import in {path}"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def group_files():
    return sorted(path for path in PACKAGE.rglob("*/*.py") if "data" not in path.parts)


@pytest.mark.parametrize("path", group_files(), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_point_down(path):
    group = path.relative_to(PACKAGE).parts[0]
    found = {name.split(".")[1] for name in imports(path) if name.startswith("plasmapyro.")}
    assert found <= BASE | {group} | MAY_IMPORT[group]


@pytest.mark.parametrize("path", group_files(), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_physics_knows_no_files_and_no_pictures(path):
    if path.relative_to(PACKAGE).parts[0] not in {"page", "plots", "readers", "cfd"}:
        assert not {name.split(".")[0] for name in imports(path)} & BANNED_IN_PHYSICS


def test_io_imports_only_the_base_contracts_and_workspace():
    found = {name.split(".")[1] for name in imports(PACKAGE / "io.py") if name.startswith("plasmapyro.")}
    assert found <= {"contracts", "progress", "tables", "versions", "workspace"}


@pytest.mark.parametrize("path", sorted((ROOT / "workflow/scripts").glob("*.py")), ids=lambda p: p.name)
def test_scripts_stay_thin(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= SCRIPT_LINES
    assert not any(isinstance(node, ast.FunctionDef | ast.For | ast.If) for node in ast.walk(ast.parse(text)))


def test_the_twin_shares_no_code_with_the_package():
    for path in sorted((ROOT / "workflow/twin").glob("*.py")):
        assert not [name for name in imports(path) if name.split(".")[0] == "plasmapyro"], path


@pytest.mark.parametrize("rules", sorted((ROOT / "workflow/rules").glob("*.smk")), ids=lambda p: p.name)
def test_every_script_of_a_rule_exists(rules):
    for line in rules.read_text(encoding="utf-8").splitlines():
        if line.strip().startswith('"../scripts/'):
            assert (rules.parent / line.strip().strip('"')).resolve().is_file(), line
