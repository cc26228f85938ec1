"""The pyrometer of the tests: a silicon sandwich behind a cut-on filter, as in the paper."""

from plasmapyro.instrument.stage import band_response

RESPONSE = band_response(
    silicon_table="silicon_green_2008",
    top_thickness=200e-6,
    bottom_thickness=400e-6,
    short_wavelength_edge=0.75e-6,
    edge_sigma=5e-9,
    long_wavelength_limit=1.15e-6,
    wavelength_step=0.5e-9,
)
