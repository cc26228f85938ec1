"""Rule read_test: a folder of raw files as one test."""

from plasmapyro import job
from plasmapyro.readers.stage import read_test

job.run(snakemake, read_test, "test")
