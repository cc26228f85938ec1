"""Rule air_table: properties of equilibrium air on temperature and pressure."""

import numpy as np

from plasmapyro import io
from plasmapyro.gas.stage import air_table

io.log_to(snakemake.log[0])
start, stop, step = snakemake.params.temperature_k
result = air_table(
    temperature=np.arange(start, stop + step / 2, step),
    pressure=np.array(snakemake.params.pressure_mbar) * 100.0,
)
io.write(result, snakemake.output[0], "gas", config=dict(snakemake.params))
