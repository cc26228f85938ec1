"""Rule trust: from which temperature on, and how long after injection, a reading can be trusted."""

from plasmapyro import io, job
from plasmapyro.design.settings import design_tables, settings_from
from plasmapyro.design.trust import trust

io.log_to(snakemake.log[0])
keys = snakemake.params
result = trust(
    io.read(snakemake.input.spectra, "gas_spectra"),
    io.read(snakemake.input.designs, "band_design"),
    io.read(snakemake.input.response, "response"),
    design_tables(keys.silicon_table),
    settings=settings_from(keys.design, keys.air_path_mm),
)
job.write(snakemake, result, "trust")
