"""Rule claims: each number or statement of the paper beside what this chain gives."""

from plasmapyro import io, job
from plasmapyro.claims.stage import as_markdown, claims_table

io.log_to(snakemake.log[0])
given = snakemake.input
contracts = {"variations": "gas_variations", "reflection": "reflection", "designs": "band_design"}
known = {name: io.read(given[name][0], contract) for name, contract in contracts.items() if given[name]}
table = claims_table(
    sightlines=[io.read(path, "sightline") for path in given.sightlines],
    radiances=[io.read(path, "radiation") for path in given.radiation],
    surface=io.read(given.surface, "surface_radiance"),
    response=io.read(given.response, "response"),
    visibility=io.read(given.visibility, "visibility"),
    reading=io.read(given.apparent_temperature, "apparent_temperature"),
    errors=io.read(given.error_map, "error_map"),
    history=io.read(given.transient, "transient"),
    calibration=io.read(given.calibration, "calibration"),
    pyrometer=io.read(given.pyrometer, "pyrometer_correction"),
    spectra=io.read(given.spectrometer, "spectrometer_correction"),
    gas=io.read(given.gas, "gas"),
    **known,
)
job.write(snakemake, table, "claims")
io.write_text(as_markdown(table), snakemake.output.text)
