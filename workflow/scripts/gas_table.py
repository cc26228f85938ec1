"""Rule gas_table: properties of an equilibrium gas on temperature and pressure."""

import numpy as np

from plasmapyro import io
from plasmapyro.gas.stage import gas_table
from plasmapyro.quantities import steps

io.log_to(snakemake.log[0])
result = gas_table(
    temperature=steps(*snakemake.params.temperature_k),
    pressure=np.array(snakemake.params.pressure_mbar) * 100.0,
    nitrogen=snakemake.params.nitrogen_mole_fraction,
    argon=snakemake.params.argon_mole_fraction,
)
io.write(result, snakemake.output[0], "gas", config=dict(snakemake.params))
