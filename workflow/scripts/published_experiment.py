"""Rule published_experiment: which power the published errors imply, and what could stand in for it."""

from pathlib import Path

from plasmapyro import io
from plasmapyro.claims import published_experiment as published
from plasmapyro.diagnosis import command
from plasmapyro.diagnosis.gas.library import gas_library

io.log_to(snakemake.log[0])
paths, keys = snakemake.input, snakemake.params
inputs = command.load_inputs(paths.radiation, Path(paths.response).parent, paths.variations)
ratio = float(io.read(paths.ratio_curve, "ratio_curve").sensitivity_ratio)
condition = keys.condition[0]
library = gas_library(
    condition,
    inputs.radiation,
    inputs.variations[condition],
    fwhm=float(inputs.radiation[condition].attrs["slit_fwhm"]),
)
reader = published.Reader(inputs.response, keys.emittance[0], ratio)
io.write_text(published.as_text(library, reader), snakemake.output[0])
