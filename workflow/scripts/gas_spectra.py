"""Rule gas_spectra: binned spectra of the gas along every line of sight and of the light on the sample."""

from plasmapyro import io, job
from plasmapyro.design.stage import gas_spectra
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
keys, given = in_si(snakemake.params), snakemake.input
names = keys.pop("conditions")
result = gas_spectra(
    {name: io.read(path, "sightline") for name, path in zip(names, given.sightlines, strict=True)},
    {name: io.read(path, "flow") for name, path in zip(names, given.flows, strict=True)},
    wavelength_range=keys.pop("wavelength"),
    thinning=keys.pop("sightline_thinning"),
    mirror_angle=keys.pop("angle"),
    **keys,
)
job.write(snakemake, result, "gas_spectra")
