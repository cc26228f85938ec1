"""Rule facility: what measured pairs of heat flux and Pitot pressure say of the computed flows."""

from plasmapyro import io, job
from plasmapyro.facility.stage import facility
from plasmapyro.facility.verdict import as_markdown

io.log_to(snakemake.log[0])
given, keys, made = snakemake.input, snakemake.params, snakemake.output
readings = {
    name: io.read(path, "probe_readings") for name, path in zip(keys.conditions, given.readings, strict=True)
}
result = facility(readings, **keys.settings)
job.write(snakemake, result, "facility")
io.write_text(as_markdown(result), made.text)
