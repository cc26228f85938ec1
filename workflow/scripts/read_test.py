"""Rule read_test: a folder of raw files as one test, without others in the same log."""

from plasmapyro import io, job
from plasmapyro.quality.catalogue import own_test
from plasmapyro.readers.stage import read_with_files

io.log_to(snakemake.log[0])
folder = snakemake.params.folder
job.write(snakemake, own_test(read_with_files(folder), folder), "test")
