"""Rule pyrometer_correction: corrected signals and temperatures of the pyrometer of a test."""

from plasmapyro import io
from plasmapyro.experiment.stage import correct_pyrometer

io.log_to(snakemake.log[0])
result = correct_pyrometer(
    io.read(snakemake.input.test, "test"),
    io.read(snakemake.input.calibration, "calibration"),
    **dict(snakemake.params),
)
io.write(
    result,
    snakemake.output[0],
    "pyrometer_correction",
    sources=snakemake.input,
    config=dict(snakemake.params),
)
