"""Rule figures_pyrometer: sample, signals, temperatures and error of a test (figures 9b, 10a to 10c)."""

from plasmapyro import io
from plasmapyro.plots import experiment

io.log_to(snakemake.log[0])
experiment.sample_emittance(io.read(snakemake.input.test, "test"), snakemake.output.sample_emittance)
corrected = io.read(snakemake.input.correction, "pyrometer_correction")
experiment.signals(corrected, snakemake.output.signals)
experiment.temperatures(corrected, snakemake.output.temperatures)
experiment.error_of_measured(corrected, snakemake.output.error)
