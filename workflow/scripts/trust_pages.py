"""Rule trust_pages: from when on a reading can be trusted, one page per condition."""

from plasmapyro import io
from plasmapyro.design.trust import as_markdown

io.log_to(snakemake.log[0])
keys = snakemake.params
tables = [io.read(path, "trust") for path in snakemake.input.tables]
pages = (as_markdown(tables[table], name) for name, table in zip(keys.conditions, keys.table, strict=True))
io.write_texts(pages, snakemake.output)
