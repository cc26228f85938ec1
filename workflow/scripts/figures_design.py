"""Rule figures_design: bands, trade-off, error maps, shelf, reflecting samples, trust."""

from plasmapyro import io
from plasmapyro.plots import design

io.log_to(snakemake.log[0])
spectra = io.read(snakemake.input.spectra, "gas_spectra")
designs = io.read(snakemake.input.designs, "band_design")
surface = io.read(snakemake.input.surface, "surface_radiance")
reflection = io.read(snakemake.input.reflection, "reflection")
drawn, keys = snakemake.output, snakemake.params
design.bands(spectra, designs, surface, keys.field_condition, drawn.bands)
design.trade_off(designs, drawn.trade_off)
design.error_maps(designs, drawn.error_maps)
design.shelf(designs, drawn.shelf)
design.reflecting_samples(reflection, keys.shown, drawn.reflecting_samples)
design.trust(io.read(snakemake.input.trust, "trust"), drawn.trust)
