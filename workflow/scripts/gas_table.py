"""Rule gas_table: properties of an equilibrium gas on temperature and pressure."""

from plasmapyro import job
from plasmapyro.gas.stage import gas_table
from plasmapyro.quantities import steps

NAMES = {"nitrogen_mole_fraction": "nitrogen", "argon_mole_fraction": "argon"}

job.run(snakemake, gas_table, "gas", temperature=steps, renamed=NAMES)
