"""Rule figures_both: corrected temperature of the pyrometer and of the spectrometer (figure 11c)."""

from plasmapyro import io
from plasmapyro.plots.experiment import two_instruments

io.log_to(snakemake.log[0])
two_instruments(
    io.read(snakemake.input.pyrometer, "pyrometer_correction"),
    io.read(snakemake.input.spectrometer, "spectrometer_correction"),
    snakemake.output.two_instruments,
)
