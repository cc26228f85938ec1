"""Files by which others find, cite, build and check the project say the same."""

import json
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CITED = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))


def test_title_version_licence_and_authors_agree():
    codemeta, zenodo = (json.loads((ROOT / name).read_text()) for name in ("codemeta.json", ".zenodo.json"))
    assert codemeta["name"] == zenodo["title"] == CITED["title"]
    assert codemeta["description"] == zenodo["description"]
    assert codemeta["keywords"] == zenodo["keywords"] == CITED["keywords"]
    versions = {one["version"] for one in (codemeta, zenodo, PROJECT)}
    assert versions == {str(CITED["version"])}
    assert zenodo["license"] == CITED["license"] == PROJECT["license"]
    assert codemeta["license"].endswith(f"/{PROJECT['license']}")
    authors = [one["name"] for one in CITED["authors"]]
    assert (
        [one["name"] for one in codemeta["author"]] == [one["name"] for one in zenodo["creators"]] == authors
    )
    for key in ("readme", "softwareHelp"):
        assert (ROOT / codemeta[key]).is_file()


def test_the_workflow_catalogue_finds_what_it_lists():
    usage = yaml.safe_load((ROOT / ".snakemake-workflow-catalog.yml").read_text())["usage"]
    assert set(usage) <= {"mandatory-flags", "software-stack-deployment", "report"}
    assert (ROOT / "Snakefile").is_file() and (ROOT / "workflow/rules").is_dir()
    assert (ROOT / "config/config.yaml").is_file() and (ROOT / "README.md").is_file()
    assert not any(usage["software-stack-deployment"].values())  # no rule asks for conda or a container
    rules = "".join(path.read_text() for path in (ROOT / "workflow/rules").glob("*.smk"))
    assert "conda:" not in rules and "container:" not in rules


def test_hosts_containers_and_hooks_call_what_stands_here():
    steps = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text())["jobs"]["run"]["steps"]
    assert steps[-1]["run"] == "bash .ci/run" and (ROOT / ".ci/run").is_file()
    makefile = (ROOT / "Makefile").read_text()
    assert (
        "RUN make .venv/installed" in (ROOT / "Containerfile").read_text()
        and "\n.venv/installed:" in makefile
    )
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"][0]["hooks"]
    for hook in hooks:  # the same tools as `make test`
        assert hook["entry"].replace(".venv/bin", "$(BIN)") in makefile, hook["id"]
