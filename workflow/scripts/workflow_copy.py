"""Rule workflow_copy: the workflow and the configuration that a run is made with, beside its results."""

from plasmapyro import io, workspace

io.log_to(snakemake.log[0])
used = snakemake.input.used
workspace.require_unchanged(used, snakemake.params.begun_with)
io.write_texts(map(io.read_text, used), snakemake.output)
