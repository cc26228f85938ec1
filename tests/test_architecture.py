"""The rules of layout that a machine can hold us to."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "plasmapyro"
BASE = {
    "constants",
    "checks",
    "conditions",
    "progress",
    "tables",
    "refraction",
    "versions",
    "quantities",
    "foreign",
}
MAY_IMPORT = {  # physics groups; every group may also import BASE and itself
    "contracts": set(),  # not physics: what files hold
    "gas": set(),
    "flow": {"gas"},
    "sightline": {"gas"},
    "radiation": {"gas"},
    "instrument": {"radiation"},
    "analysis": {"instrument", "radiation"},
    "design": {"gas", "sightline", "radiation", "instrument", "analysis"},
    "record": {"instrument", "radiation"},  # a test as numbers to use, the same for all who read it
    "experiment": {"record", "instrument", "radiation"},
    "estimate": {"record", "instrument", "radiation"},
    "quality": {"record", "instrument", "radiation", "identification"},
    "identification": set(),  # names of lines
    "readers": {  # files in, datasets out: the one group that knows files
        "contracts",
        "io",
        "record",
        "instrument",
        "radiation",
    },
    "diagnosis": {
        "gas",
        "identification",
        "radiation",
        "instrument",
        "record",
        "experiment",
        "contracts",
        "io",
        "shipped",
    },  # files: only `command`
    "campaign": {"diagnosis"},  # laws of what diagnoses share
    "claims": {"analysis", "diagnosis", "instrument", "radiation"},  # a worked example of the diagnosis
    "facility": {"gas", "flow", "sightline", "diagnosis"},  # of the last: probabilities of names
    "plots": {"contracts", "io"},
    "report": {"page", "record"},  # its environment of templates; words of a status
    "cfd": {"gas", "sightline", "readers", "configuration", "io"},  # files of other programs in, ours out
    "commands": {  # behind the command line
        "cli",
        "shipped",
        "analysis",
        "quality",
        "diagnosis",
        "campaign",
        "estimate",
        "design",
        "io",
        "contracts",
        "configuration",
        "page",
        "plots",
        "cfd",
        "experiment",
        "facility",
        "identification",
        "instrument",
        "radiation",
        "readers",
        "record",
        "sightline",
    },
    "page": {"plots", "record"},  # pictures; words of a status
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


STEPS = (
    "effects",
    "gas",
    "fit",
    "select",
    "simulation",
    "report",
    "stage",
    "command",
)  # of a diagnosis, ground first
FILES = {"contracts", "io", "shipped", "importlib", "json", "os", "pathlib", "shutil", "tempfile"}


def diagnosis_files():
    return sorted((PACKAGE / "diagnosis").rglob("[a-z]*.py"))


@pytest.mark.parametrize("path", diagnosis_files(), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_step_of_the_diagnosis_imports_only_steps_below(path):
    step = path.relative_to(PACKAGE / "diagnosis").parts[0].removesuffix(".py")
    found = {name.split(".")[2] for name in imports(path) if name.startswith("plasmapyro.diagnosis.")}
    assert found <= set(STEPS[: STEPS.index(step)]) | ({step} if path.parent.name == step else set())


def test_the_steps_of_the_diagnosis_stand_on_six_levels_with_few_arrows():
    arrows = {}
    for path in diagnosis_files():
        step = path.relative_to(PACKAGE / "diagnosis").parts[0].removesuffix(".py")
        below = {name.split(".")[2] for name in imports(path) if name.startswith("plasmapyro.diagnosis.")}
        arrows.setdefault(step, set()).update(below - {step})

    def level(step):
        return 1 + max((level(below) for below in arrows.get(step, ())), default=0)

    assert level("command") <= 6
    assert sum(map(len, arrows.values())) < 20


@pytest.mark.parametrize("path", diagnosis_files(), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_only_the_command_of_the_diagnosis_knows_files(path):
    parts = {name.removeprefix("plasmapyro.").split(".")[0] for name in imports(path)}
    assert not parts & FILES or path.name == "command.py"


def test_io_imports_only_the_base_contracts_and_seals():
    found = {name.split(".")[1] for name in imports(PACKAGE / "io.py") if name.startswith("plasmapyro.")}
    assert found <= {"contracts", "cost", "foreign", "progress", "seals", "tables", "versions"}


@pytest.mark.parametrize("path", sorted((ROOT / "workflow/scripts").glob("*.py")), ids=lambda p: p.name)
def test_scripts_stay_thin(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= SCRIPT_LINES
    assert not any(isinstance(node, ast.FunctionDef | ast.For | ast.If) for node in ast.walk(ast.parse(text)))
    loops = (ast.ListComp, ast.SetComp, ast.DictComp)  # run for their effects, a loop in disguise
    assert not any(
        isinstance(node, ast.Expr) and isinstance(node.value, loops) for node in ast.walk(ast.parse(text))
    )


def test_the_twin_shares_no_code_with_the_package():
    for path in sorted((ROOT / "workflow/twin").glob("*.py")):
        assert not [name for name in imports(path) if name.split(".")[0] == "plasmapyro"], path


def test_the_second_laboratory_shares_no_code_with_the_package_or_the_first():
    for path in sorted((ROOT / "workflow/worlds").glob("*.py")):
        assert not {name.split(".")[0] for name in imports(path)} & {"plasmapyro", "twin", "blind"}, path


@pytest.mark.parametrize("rules", sorted((ROOT / "workflow/rules").glob("*.smk")), ids=lambda p: p.name)
def test_every_script_of_a_rule_exists(rules):
    for line in rules.read_text(encoding="utf-8").splitlines():
        if line.strip().startswith('"../scripts/'):
            assert (rules.parent / line.strip().strip('"')).resolve().is_file(), line


OPENERS = {
    "open",
    "read_bytes",
    "read_text",
    "load_dataset",
    "open_dataset",
    "open_dataarray",
    "Dataset",
    "load",
}


def openers(path):
    """Calls that read a file by themselves, as 'object.name'."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            if name.rpartition(".")[2] in OPENERS:
                yield name


@pytest.mark.parametrize("path", sorted((ROOT / "workflow/scripts").glob("*.py")), ids=lambda p: p.name)
def test_a_job_reads_results_through_io_alone_where_their_bytes_are_checked(path):
    assert {name for name in openers(path) if not name.startswith("io.")} == set()


@pytest.mark.parametrize("path", sorted((ROOT / "workflow/scripts").glob("*.py")), ids=lambda p: p.name)
def test_a_script_takes_its_inputs_by_name_because_it_is_one_itself(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    whole = {"snakemake.input"}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign):
            targets, values = (getattr(part, "elts", [part]) for part in (node.targets[0], node.value))
            pairs = zip(targets, values, strict=False)
            whole |= {ast.unparse(name) for name, value in pairs if ast.unparse(value) == "snakemake.input"}
    taken = {
        ast.unparse(part).lstrip("*")
        for node in ast.walk(tree)
        for part in ([node.iter] if isinstance(node, ast.comprehension) else getattr(node, "args", []) or [])
        if isinstance(part, ast.expr)
    }
    assert not taken & whole


def test_only_io_opens_netcdf():
    for path in sorted(PACKAGE.rglob("*.py")):
        opened = {name for name in openers(path) if name.split(".")[0] in {"xr", "xarray", "netCDF4"}}
        assert opened - {"xr.Dataset"} == ({"xr.open_dataset"} if path.name == "io.py" else set()), path
