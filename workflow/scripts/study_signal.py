"""Rule study_signal: band signals of the gas along one line of sight of a study."""

from plasmapyro import io
from plasmapyro.quantities import in_si
from plasmapyro.study.stage import signal

io.log_to(snakemake.log[0])
settings = in_si(snakemake.params)
result = signal(
    io.read(snakemake.input.flow, "study_flow"),
    io.read(snakemake.input.response, "response"),
    wavelength_range=settings.pop("wavelength"),
    **settings,
)
io.write(result, snakemake.output[0], "study_signal", sources=snakemake.input, config=dict(snakemake.params))
