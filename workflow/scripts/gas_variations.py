"""Rule gas_variations: spectra of the gas with one property varied at a time."""

from plasmapyro import job
from plasmapyro.diagnosis.gas.stage import gas_variations

job.run(snakemake, gas_variations, "gas_variations")
