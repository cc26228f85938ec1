"""Every command of every page is run, or checked as far as it can be without the hours that it takes.

`plasmapyro` on the examples runs as it stands; on results of the main job it runs in
`test_commands_on_results.py` (`make compare`) and is parsed here. `make` and `snakemake` are dry runs; of the
scripts, options and arguments are compared with their help.
"""

import functools
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import yaml
from clone import copy_of_the_project
from pages import LANGUAGES, LOG, PAGES, PROGRAMS, ROOT, Command, all_commands, commands, fences, is_command

from plasmapyro import cli, configuration, io
from plasmapyro.sightline import neqair
from plasmapyro.sightline.stage import equilibrium_sightline

LARGEST_NUMBER_OF_PAGES = 14
NOT_PAGES = {
    "decisions.md",
    "scoreboard.md",
    "blind-tests.md",
    "real-data.md",
    "radiation_cost.md",
    "paper.md",
    "index.md",
    "gallery.md",
    "api.md",
    "reference.md",
}  # a log, results, a map, and the frame of the site
READ_RESULTS = ("trust", "correct-reading")
RUN_ELSEWHERE = {  # box after box, as they stand
    page: where
    for page, where in {
        "your-own-data.md": "tests/readers/test_own_data_page.py",
        "python.md": "tests/test_public_functions.py",
        "large-studies.md": "tests/study/test_large_studies_page.py",
        "tutorial.md": "tests/pages/test_tutorial.py",
    }.items()
    if (ROOT / where).exists()
}
PLACEHOLDERS = {"{test}": "csic_160kW", "FOLDER": "docs/example/my_test"}
PLACEHOLDERS["SPECTRUM"] = "docs/example/my_test/spectrometer/spectrum_002.txt"
OF_A_CLUSTER = ("--slurm-", "--kubernetes-", "--storage-", "--default-storage-")  # options with one value
KINDS_OF_YAML = {"condition": "config/schema_condition.yaml", "test": "config/schema_test.yaml"}
PYTHON = [page for page in PAGES if page.name in ("radiation.md", "file-formats.md")]


def ids(found):
    return [f"{one.page}: {one.line}" if isinstance(one, Command) else one.name for one in found]


def parametrize(name, found):
    assert found
    return pytest.mark.parametrize(name, found, ids=ids(found))


def test_there_are_few_pages_and_the_readme_names_each():
    pages = {page.name for page in PAGES} - NOT_PAGES - {"README.md"}
    assert len(pages) <= LARGEST_NUMBER_OF_PAGES, sorted(pages)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert not [name for name in pages if f"(docs/{name})" not in readme]


def test_the_site_holds_every_page_and_every_formula():
    """What `make site` would refuse, or leave out, later."""
    index = (ROOT / "docs/index.md").read_text(encoding="utf-8").splitlines()
    assert not [page.stem for page in (ROOT / "docs").glob("*.md") if page.stem not in ("index", *index)]
    listed = (ROOT / "docs/reference.md").read_text(encoding="utf-8").splitlines()
    package = ROOT / "src/plasmapyro"
    for path in package.rglob("*.py"):
        if ".. math::" in path.read_text(encoding="utf-8"):
            part = path.relative_to(package).parts[0].removesuffix(".py")
            assert f"reference/{part}" in listed, path


@parametrize("page", PAGES)
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", text):
        if not target.startswith("http"):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"
    for target in re.findall(r"`((?:docs|tests|workflow|benchmarks|src|config|profiles)/[\w./-]+)`", text):
        assert page.name == LOG or (ROOT / target).exists(), f"{page.name} names {target}"


@parametrize("page", PAGES)
def test_boxes_have_a_known_language_and_commands_stand_in_those_of_commands(page):
    for language, _, content in fences(page):
        assert language in LANGUAGES, f"{page.name}: a box of {language}"
        if language == "text":
            assert not [line for line in content.splitlines() if is_command(line) or line.startswith("$ ")]


@parametrize("page", [page for page in PAGES if page.name != LOG])
def test_no_command_calls_a_program_that_no_test_knows(page):
    for command in commands(page):
        assert command.words[0] in PROGRAMS, f"{page.name}: no test knows what '{command.line}' does"


@parametrize("page", PAGES)
def test_yaml_reads_and_fits_its_schema(page):
    for language, rest, content in fences(page):
        kind = rest.partition(" ")[0]
        if language == "yaml":
            values = yaml.safe_load(content)
            assert isinstance(values, dict)
            if kind.startswith("file=config/conditions/"):
                kind = "condition"
            if kind in KINDS_OF_YAML:
                configuration.check(values, ROOT / KINDS_OF_YAML[kind], page.name)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Where a reader stands: the examples, a sight line as text, a field with its map."""
    sys.path.insert(0, str(ROOT / "tests" / "cfd"))
    import cfd_samples as samples

    shutil.copytree(ROOT / "docs" / "example", tmp_path / "docs" / "example")
    distance = np.linspace(0, 0.1, 6)
    line = equilibrium_sightline(distance, 6000.0 - 2e4 * distance, 5000.0)
    (tmp_path / "LOS.dat").write_text(neqair.compose(line))
    shutil.copy(samples.FILES / "mixed_ascii.vtu", tmp_path / "flow.vtu")
    (tmp_path / "map.yaml").write_text(yaml.safe_dump(samples.settings()))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def call(words):
    """Exit status of the command; of --help as well."""
    try:
        return cli.main(words)
    except SystemExit as end:
        return end.code


def needs_results(command):
    """Commands that read the results of the main job; readings of the facility are the user's to download."""
    return any(word.startswith("results") for word in command.words) or command.words[1] in READ_RESULTS


@parametrize("page", [page for page in PAGES if page.name not in {LOG, *RUN_ELSEWHERE}])
def test_commands_on_the_examples_run(page, folder, capsys):
    for command in commands(page):
        if command.words[0] == "plasmapyro" and len(command.words) > 2 and not needs_results(command):
            words = [PLACEHOLDERS.get(word, word) for word in command.words[1:]]
            assert call(words) == 0, f"{command.line}\n{capsys.readouterr().err}"


@parametrize("command", all_commands("plasmapyro"))
def test_commands_on_results_are_right_and_their_inputs_come_from_a_rule(command):
    if len(command.words) == 2:
        assert f"  {command.words[1]} " in cli.parser().format_help()
        return
    if "--help" not in command.words:
        cli.parser().parse_args(command.words[1:])
    rules = "".join(path.read_text() for path in (ROOT / "workflow/rules").glob("*.smk"))
    rules = rules.replace("{condition}", "90kW").replace("{test}", "csic_160kW")
    for word in command.words[2:]:
        if word.startswith("results"):
            assert f'"{word}' in rules, f"no rule makes {word}"


def test_pages_that_run_elsewhere_do():
    for page, where in RUN_ELSEWHERE.items():
        assert page in (ROOT / where).read_text(encoding="utf-8")


@parametrize("page", PYTHON)
def test_an_example_in_python_runs(page, folder, capsys):
    matplotlib.use("Agg")
    io.write_text("", folder / "results/radiation/note.txt")
    narrow = ("--wavelength-nm", "770", "785", "--grid-points", "20000")
    assert cli.main(["radiance", "LOS.dat", "--out", "results/radiation/90kW.nc", *narrow]) == 0
    for language, _, content in fences(page):
        if language == "python":
            namespace = {}
            exec(compile(content, page.name, "exec"), namespace)
            if "axes" in namespace:
                assert (folder / "spectrum.png").stat().st_size > 10_000
                assert len(namespace["axes"].get_lines()) == namespace["spectrum"].sizes["component"]
                namespace["plt"].close("all")
            else:
                assert 777e-9 < float(capsys.readouterr().out.splitlines()[-1]) < 778e-9


def test_no_page_has_python_that_is_not_run():
    with_python = {
        page.name for page in PAGES if any(language == "python" for language, _, _ in fences(page))
    }
    assert with_python == {page.name for page in PYTHON} | set(RUN_ELSEWHERE)


def test_make_targets_exist():
    words = dict.fromkeys(word for command in all_commands("make") for word in command.words[1:])
    run = subprocess.run(["make", "-n", "--keep-going", *words], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A clean copy of the workflow with the conditions that pages add."""
    place = copy_of_the_project(tmp_path_factory.mktemp("clone"))
    for page in PAGES:
        for _, rest, content in fences(page):
            if rest.startswith("file=config/"):
                io.write_text(content, place / rest.removeprefix("file="))
    for command in all_commands("cp"):
        if command.words[1].startswith("config/"):
            shutil.copy(place / command.words[1], place / command.words[2])
    if (place / "config/study.yaml").exists():
        shutil.copy(place / "config/study.yaml", place / "my_study.yaml")
    return place


def call_of_snakemake(command):
    """Options that matter, and targets, of a call; cores and profiles are those of the machine."""
    options, targets, words = [], [], iter(command.words[1:])
    for word in words:
        if word.endswith(".yaml"):
            options += ([] if "--configfile" in options else ["--configfile"]) + [word]
        elif word in ("--configfile", "--", "--dry-run"):
            continue
        elif word == "--config":
            options += [word, next(words)]
        elif word == "--profile":
            assert (ROOT / next(words) / "config.yaml").exists(), command.line
        elif word in ("--cores", "--jobs", "--executor") or word.startswith(OF_A_CLUSTER):
            next(words)
        elif word.startswith("-"):
            options.append(word)
        else:
            targets.append(re.sub(r"\{test\}", PLACEHOLDERS["{test}"], word))
    return tuple(options), targets


def calls_of_snakemake():
    """Options -> all targets that pages ask for with them, and whether one asks for no target."""
    calls = {}
    for command in all_commands("snakemake"):
        options, targets = call_of_snakemake(command)
        calls.setdefault((options, bool(targets)), set()).update(targets)
    return [(options, sorted(targets)) for (options, _), targets in calls.items()]


@pytest.mark.parametrize(("options", "targets"), calls_of_snakemake(), ids=str)
def test_calls_of_snakemake_plan_their_jobs(options, targets, project):
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    words = [*targets, *options, "--cores", "2", "--dry-run", "--quiet", "rules"]
    run = subprocess.run(
        [sys.executable, "-m", "snakemake", *words],
        cwd=project,
        capture_output=True,
        text=True,
        env=environment,
    )
    assert run.returncode == 0, run.stdout[-2000:] + run.stderr[-2000:]


@functools.cache
def help_of(script):
    run = subprocess.run([sys.executable, ROOT / script, "--help"], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return run.stdout


@parametrize("command", all_commands("python"))
def test_scripts_know_their_options(command):
    script, *words = command.words[1:]
    if not words and "argparse" not in (ROOT / script).read_text():
        return
    said = help_of(script)
    for word in words:
        if word.startswith("-") or not re.search(r"[\d/.]|[A-Z]", word):
            assert re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", said), f"{script}: {word}"


@parametrize("command", all_commands("pytest"))
def test_tests_named_on_pages_exist(command):
    places = [ROOT / word for word in command.words[1:] if not word.startswith("-")]
    assert all(place.exists() for place in places)
    files = [file for place in places for file in (place.rglob("*.py") if place.is_dir() else [place])]
    text = "".join(file.read_text(encoding="utf-8") for file in files)
    assert all(f'"{variable}"' in text for variable in command.variables)


def test_what_is_installed_and_activated_exists():
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for command in all_commands("pip"):
        for package in command.words[2:]:
            extra = re.fullmatch(r"plasmapyro\[(\w+)\]", package)
            plugin = re.fullmatch(r"snakemake-(executor|storage)-plugin-\w+", package)
            known = plugin or package in ("plasmapyro", ".")
            assert known or re.search(rf"^{extra[1]} = \[", project, re.MULTILINE), command.line
    for command in all_commands("git"):
        assert command.words[1] == "clone", command.line
    for command in all_commands("."):
        assert command.line == ". .venv/bin/activate"
    for command in all_commands("cp"):
        assert command.page in RUN_ELSEWHERE or (ROOT / command.words[1]).is_file(), command.line
