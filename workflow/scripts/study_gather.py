"""Rule study_gather: all conditions of a study along named dimensions."""

import numpy as np

from plasmapyro import io
from plasmapyro.study import plan
from plasmapyro.study.stage import gather

io.log_to(snakemake.log[0])
keys = snakemake.params
start, stop, step = keys.object_temperature_k
limit_start, limit_stop, limit_step = keys.error_temperature_k
result = gather(
    (io.read(path, "study_signal") for path in snakemake.input.signals),
    io.read(snakemake.input.response, "response"),
    io.read(snakemake.input.curve, "ratio_curve"),
    conditions=plan.in_si(keys.axes, keys.extra),
    object_temperature=np.arange(start, stop + step / 2, step),
    limit_temperature=np.arange(limit_start, limit_stop + limit_step / 2, limit_step),
    error_level=keys.error_level,
)
io.write(result, snakemake.output[0], "study", sources=snakemake.input, config=dict(keys))
