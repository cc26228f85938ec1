"""Rule band_design: pyrometers by bands and detector, searched, confirmed and ranked."""

from plasmapyro import io, job
from plasmapyro.design.settings import design_tables, settings_from
from plasmapyro.design.stage import band_design

io.log_to(snakemake.log[0])
keys = snakemake.params
result = band_design(
    io.read(snakemake.input.spectra, "gas_spectra"),
    io.read(snakemake.input.response, "response"),
    design_tables(keys.silicon_table),
    settings=settings_from(keys.design, keys.air_path_mm),
)
job.write(snakemake, result, "band_design")
