"""The description of a run holds what RO-Crate's own validator asks of it."""

import json
from importlib import resources

import pytest

from plasmapyro.report.crate import compose

PUBLICATION = {
    "title": "an invented run",
    "authors": ["One Person"],
    "date": "2026-01-31",
    "licence": "https://spdx.org/licenses/BSD-3-Clause",
}
VERSIONS = {"plasmapyro": "0.1.0", "snakemake": "9.0", "numpy": "2.0"}
MAIN = "workflow/Snakefile"
NEEDS_THE_NETWORK = ["ro-crate-1.1_3.1", "ro-crate-1.1_3.2"]  # whether the context can be downloaded
# What we leave out knowingly: clock times, an affiliation and a publisher that only the user knows, an
# address of the workflow, a README and the formal parameters of Bioschemas.
LEFT_OUT = {
    "process-run-crate-0.5_3.2",
    "process-run-crate-0.5_5.1",
    "process-run-crate-0.5_8.4",
    "ro-crate-1.1_22.3",
    "ro-crate-1.1_30.2",
    "ro-crate-1.1_30.3",
    "workflow-ro-crate-1.0_6.1",
    "workflow-ro-crate-1.0_6.2",
    "workflow-ro-crate-1.0_8.1",
}


def write(folder, **changes):
    files = {MAIN: "rule all:", "workflow/config/config.yaml": "a: 1", "claims.nc": "x", "figures/a.svg": "y"}
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content)
    results = {name: ("0" * 64, 1) for name in ("claims.nc", "figures/a.svg")}
    workflow = {name: ("1" * 64, 1) for name in (MAIN, "workflow/config/config.yaml")}
    text = compose(results, workflow, main=MAIN, publication=PUBLICATION | changes, versions=VERSIONS)
    (folder / "ro-crate-metadata.json").write_text(text)
    return folder


@pytest.fixture
def issues(monkeypatch):
    """A function: folder -> (check, message) of everything the validator finds, without a network."""
    services = pytest.importorskip("rocrate_validator.services")
    from rocrate_validator.models import Severity
    from rocrate_validator.utils import document_loader

    stored = json.loads((resources.files("rocrate") / "data/ro-crate.jsonld").read_text(encoding="utf-8"))
    # Version 1.3 lies in the package; of the terms used here 1.1 writes only this one otherwise.
    stored["@context"]["ComputationalWorkflow"] = "https://bioschemas.org/ComputationalWorkflow"
    monkeypatch.setattr(document_loader, "_fetch_json_ld", lambda url: stored)

    def find(folder):
        settings = services.ValidationSettings(
            rocrate_uri=str(folder),
            profile_identifier="workflow-run-crate",
            requirement_severity=Severity.RECOMMENDED,
            skip_checks=NEEDS_THE_NETWORK,
        )
        return {
            (issue.check.identifier, issue.severity.name, issue.message)
            for issue in services.validate(settings).get_issues()
        }

    return find


@pytest.mark.filterwarnings("ignore:ConjunctiveGraph")
def test_the_validator_of_workflow_run_crates_finds_nothing_required(issues, tmp_path):
    found = issues(write(tmp_path))
    assert not [issue for issue in found if issue[1] == "REQUIRED"]
    assert {issue[0] for issue in found} <= LEFT_OUT, found


@pytest.mark.filterwarnings("ignore:ConjunctiveGraph")
@pytest.mark.parametrize("damage", ["result", "type"])
def test_the_validator_sees_what_is_missing(issues, tmp_path, damage):
    path = write(tmp_path) / "ro-crate-metadata.json"
    if damage == "result":
        (tmp_path / "claims.nc").unlink()
    else:
        path.write_text(path.read_text().replace('"ComputationalWorkflow"', '"Thing"'))
    assert [issue for issue in issues(tmp_path) if issue[1] == "REQUIRED"]


def test_equal_runs_have_equal_descriptions_without_a_clock(tmp_path):
    first, second = (write(tmp_path / name) for name in "ab")
    text = (first / "ro-crate-metadata.json").read_text()
    assert text == (second / "ro-crate-metadata.json").read_text()
    assert "Time" not in text


def test_each_file_stands_there_once_with_its_digest(tmp_path):
    graph = json.loads((write(tmp_path) / "ro-crate-metadata.json").read_text())["@graph"]
    names = [entity["@id"] for entity in graph]
    assert len(names) == len(set(names))
    files = {entity["@id"]: entity for entity in graph if "sha256" in entity}
    (root,) = (entity for entity in graph if entity["@id"] == "./")
    assert files.keys() == {part["@id"] for part in root["hasPart"]}
    assert files["claims.nc"]["sha256"] == "0" * 64 and files[MAIN]["sha256"] == "1" * 64
    (run,) = (entity for entity in graph if entity["@type"] == "CreateAction")
    assert [part["@id"] for part in run["result"]] == ["claims.nc", "figures/a.svg"]
    assert run["object"] == {"@id": "workflow/config/config.yaml"}


def test_a_crate_without_its_snakefile_is_refused():
    with pytest.raises(ValueError, match="workflow/Snakefile: the main file must be one"):
        compose({}, {}, main=MAIN, publication=PUBLICATION, versions=VERSIONS)
