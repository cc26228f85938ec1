"""Rule crate: the run as a Workflow Run RO-Crate, with the files it was made with."""

import os
from importlib.metadata import version

from plasmapyro import io, workspace
from plasmapyro.report.crate import compose
from plasmapyro.versions import versions

io.log_to(snakemake.log[0])
given = snakemake.input
workspace.require_unchanged(given.used, snakemake.params.begun_with)
results, workflow = (
    {os.path.relpath(path, "results"): (io.digest(path), os.path.getsize(path)) for path in paths}
    for paths in (given.results, given.copies)
)
text = compose(
    results,
    workflow,
    main="workflow/Snakefile",
    publication=snakemake.params.publication,
    versions={"snakemake": version("snakemake"), **dict(versions())},
)
io.write_text(text, snakemake.output[0])
