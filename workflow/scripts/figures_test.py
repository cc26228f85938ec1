"""Rules figures_pyrometer and others: what the instruments of a test show (figures 9b, 10, 11)."""

from pathlib import Path

from plasmapyro import io
from plasmapyro.plots import experiment

io.log_to(snakemake.log[0])
contracts = {
    "test": "test",
    "pyrometer": "pyrometer_correction",
    "joint": "joint_estimate",
    "spectrometer": "spectrometer_correction",
}
experiment.figures(
    {name: io.read(path, contracts[name]) for name, path in snakemake.input.items() if name in contracts},
    {Path(path).stem: io.read(path, "radiation") for path in snakemake.input.radiation},
    snakemake.params.spectrum_times_s,
    snakemake.output,
)
