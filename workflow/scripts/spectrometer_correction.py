"""Rule spectrometer_correction: corrected spectra of a test and the temperatures fitted to them."""

from plasmapyro import io
from plasmapyro.experiment.stage import correct_spectra
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
keys = snakemake.params
result = correct_spectra(
    io.read(snakemake.input.test, "test"),
    io.read(snakemake.input.calibration, "spectrometer_calibration") if snakemake.input.calibration else None,
    **in_si(keys),
)
io.write(result, snakemake.output[0], "spectrometer_correction", sources=snakemake.input, config=dict(keys))
