"""Rule study_gather: all conditions of a study along named dimensions."""

from plasmapyro import io, job
from plasmapyro.quantities import steps
from plasmapyro.study import plan
from plasmapyro.study.stage import gather

io.log_to(snakemake.log[0])
keys = snakemake.params
result = gather(
    (io.read(path, "study_signal") for path in snakemake.input.signals),
    io.read(snakemake.input.response, "response"),
    io.read(snakemake.input.curve, "ratio_curve"),
    conditions=plan.in_si(keys.axes, keys.extra),
    object_temperature=steps(*keys.object_temperature_k),
    limit_temperature=steps(*keys.error_temperature_k),
    error_level=keys.error_level,
)
job.write(snakemake, result, "study")
