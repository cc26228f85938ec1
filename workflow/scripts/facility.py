"""Rule facility: what measured pairs of heat flux and Pitot pressure say of the computed flows."""

from plasmapyro import io
from plasmapyro.facility.stage import facility
from plasmapyro.facility.verdict import as_markdown

io.log_to(snakemake.log[0])
given, keys, made = snakemake.input, snakemake.params, snakemake.output
readings = {
    name: io.read(path, "probe_readings") for name, path in zip(keys.conditions, given.readings, strict=True)
}
result = facility(readings, **keys.settings)
io.write(result, made.table, "facility", sources=given, config=dict(keys))
io.write_text(as_markdown(result), made.text)
