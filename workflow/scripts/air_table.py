"""Rule air_table: properties of equilibrium air on temperature and pressure."""

import numpy as np

from plasmapyro import io
from plasmapyro.gas.stage import air_table
from plasmapyro.quantities import steps

io.log_to(snakemake.log[0])
result = air_table(
    temperature=steps(*snakemake.params.temperature_k),
    pressure=np.array(snakemake.params.pressure_mbar) * 100.0,
)
io.write(result, snakemake.output[0], "gas", config=dict(snakemake.params))
