"""Rule calibration: sensitivity ratio, modelled ratio curve and quadratic fit of the pyrometer."""

from plasmapyro import io
from plasmapyro.instrument.stage import pyrometer_calibration
from plasmapyro.quantities import steps

io.log_to(snakemake.log[0])
keys = snakemake.params
result = pyrometer_calibration(
    io.read(snakemake.input.response, "response"),
    io.read(snakemake.input.points, "calibration_points"),
    source_temperature_uncertainty=keys.source_temperature_uncertainty_k,
    signal_uncertainty=keys.signal_uncertainty,
    instrument_range=keys.instrument_range_k,
    calibration_temperature=steps(*keys.calibration_temperature_k),
    draws=keys.draws,
    seed=keys.seed,
)
io.write(result, snakemake.output[0], "calibration", sources=snakemake.input, config=dict(keys))
