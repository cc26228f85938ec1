"""A run as a Workflow Run RO-Crate: what was made, from what, by which workflow, under which licence."""

import json
from pathlib import PurePosixPath

SPECIFICATION = "https://w3id.org/ro/crate/1.1"
PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": ("Workflow RO-Crate", "1.0"),
}
CONTEXT = [f"{SPECIFICATION}/context", "https://w3id.org/ro/terms/workflow-run/context"]
FORMATS = {
    ".csv": "text/csv",
    ".html": "text/html",
    ".json": "application/json",
    ".lock": "text/plain",
    ".md": "text/markdown",
    ".nc": "application/x-netcdf",
    ".png": "image/png",
    ".py": "text/x-python",
    ".svg": "image/svg+xml",
    ".vtu": "model/vnd.vtk",
    ".yaml": "application/yaml",
}
SNAKEMAKE = "https://w3id.org/workflowhub/workflow-ro-crate#snakemake"


def compose(results, workflow, *, main, publication, versions):
    """The text of `ro-crate-metadata.json` (JSON-LD); the same inputs give the same bytes.

    `results`, `workflow`: path relative to the crate -> (SHA-256, size [byte]) of what the run made, and what
    it was made with; `main`: the Snakefile, one of the latter, ValueError if not; `publication`: `title`,
    `authors` (names), `date` (ISO 8601) and `licence` (URL) of the results; `versions`: package -> version,
    `plasmapyro` among them.

    Source: RO-Crate 1.1; Workflow Run Crate 0.5 (Leo et al. 2024, doi:10.1371/journal.pone.0309210).
    Deviation: no start and end of the run, because a file with a clock time differs between equal runs; times
    stand in the benchmark files.
    """
    if main not in workflow:
        raise ValueError(f"{main}: the main file must be one of the workflow's; got {', '.join(workflow)}")
    authors = [
        {"@id": f"#author-{place}", "@type": "Person", "name": name}
        for place, name in enumerate(publication["authors"], start=1)
    ]
    software = [
        {
            "@id": f"https://pypi.org/project/{name}/{number}/",
            "@type": "SoftwareApplication",
            "name": name,
            "url": f"https://pypi.org/project/{name}/{number}/",
            "version": number,
        }
        for name, number in sorted(versions.items())
        if name != "plasmapyro"
    ]
    graph = [
        {
            "@id": "ro-crate-metadata.json",
            "@type": "CreativeWork",
            "about": {"@id": "./"},
            "conformsTo": [{"@id": SPECIFICATION}, {"@id": list(PROFILES)[-1]}],
        },
        {
            "@id": "./",
            "@type": "Dataset",
            "author": _links(authors),
            "conformsTo": [{"@id": profile} for profile in PROFILES],
            "datePublished": publication["date"],
            "description": "Results of one run of plasmapyro: gas radiation in front of a surface, its effect"
            " on a two-colour pyrometer, corrected temperatures and what the simulation gets wrong.",
            "hasPart": [{"@id": path} for path in sorted([*workflow, *results])],
            "license": {"@id": publication["licence"]},
            "mainEntity": {"@id": main},
            "mentions": {"@id": "#run"},
            "name": publication["title"],
        },
        {
            "@id": "#run",
            "@type": "CreateAction",
            "agent": _links(authors),
            "description": "All rules of the workflow, with the configuration in the crate; start and end are"
            " left out, so that equal runs give equal files.",
            "instrument": {"@id": main},
            "name": "Run of the workflow",
            "object": _single([{"@id": path} for path in sorted(workflow) if path.endswith(".yaml")]),
            "result": _single([{"@id": path} for path in sorted(results)]),
        },
        *authors,
        _named(publication["licence"], publication["licence"].rpartition("/")[2]),
        {
            "@id": SNAKEMAKE,
            "@type": "ComputerLanguage",
            "identifier": {"@id": "https://snakemake.readthedocs.io"},
            "name": "Snakemake",
            "url": {"@id": "https://snakemake.readthedocs.io"},
            "version": versions.get("snakemake", ""),
        },
        *software,
        *(_named(profile, name, version=number) for profile, (name, number) in PROFILES.items()),
        *(_file(path, *facts) for path, facts in sorted(results.items())),
    ]
    for path, facts in sorted(workflow.items()):
        entity = _file(path, *facts)
        if path == main:
            entity |= {
                "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow"],
                "license": {"@id": publication["licence"]},
                "name": "plasmapyro",
                "programmingLanguage": {"@id": SNAKEMAKE},
                "softwareRequirements": _links(software),
                "version": versions["plasmapyro"],
            }
        graph.append(entity)
    return json.dumps({"@context": CONTEXT, "@graph": graph}, indent=1) + "\n"


def _links(entities):
    return _single([{"@id": entity["@id"]} for entity in entities])


def _single(entries):
    """A list of one as that one, as RO-Crate asks."""
    return entries[0] if len(entries) == 1 else entries


def _named(address, name, **facts):
    return {"@id": address, "@type": "CreativeWork", "name": name, **facts}


def _file(path, digest, size):
    suffix = PurePosixPath(path).suffix
    return {
        "@id": path,
        "@type": "File",
        "contentSize": str(size),
        "encodingFormat": FORMATS.get(suffix, "text/plain"),
        "name": path,
        "sha256": digest,
    }
