"""Rule read_test: a folder of raw files as one test."""

from plasmapyro import io
from plasmapyro.readers.stage import read_test

io.log_to(snakemake.log[0])
result = read_test(snakemake.params.folder)
io.write(result, snakemake.output[0], "test", sources=snakemake.input)
