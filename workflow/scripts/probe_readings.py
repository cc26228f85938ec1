"""Rule probe_readings: what a calorimeter and Pitot probes read in one computed flow."""

from plasmapyro import io, job
from plasmapyro.facility.stage import probe_readings
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
keys = dict(snakemake.params)
measured = in_si(keys.pop("measured"))
result = probe_readings(
    io.read(snakemake.input.flow, "flow"),
    io.read(snakemake.input.gas, "gas"),
    measured=measured,
    **in_si(keys),
)
job.write(snakemake, result, "probe_readings")
