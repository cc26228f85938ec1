"""Rule response: modelled spectral responses of the two bands."""

from plasmapyro import io
from plasmapyro.instrument.stage import band_response

io.log_to(snakemake.log[0])
keys = snakemake.params
result = band_response(
    silicon_table=keys.silicon_table,
    top_thickness=keys.top_thickness_um * 1e-6,
    bottom_thickness=keys.bottom_thickness_um * 1e-6,
    short_wavelength_edge=keys.short_wavelength_edge_nm * 1e-9,
    edge_sigma=keys.edge_sigma_nm * 1e-9,
    long_wavelength_limit=keys.long_wavelength_limit_nm * 1e-9,
    wavelength_step=keys.wavelength_step_nm * 1e-9,
)
io.write(result, snakemake.output[0], "response", config=dict(keys))
