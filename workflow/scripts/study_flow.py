"""Rule study_flow: steady flow at one condition of a study, or the word that there is none."""

from plasmapyro import io, job
from plasmapyro.quantities import in_si
from plasmapyro.study.stage import flow

io.log_to(snakemake.log[0])
keys = dict(snakemake.params)
settings = {name: value for name, value in keys.items() if name != "condition"} | keys["condition"]
result = flow(
    io.read(snakemake.input.gas, "gas"),
    io.read(snakemake.input.start, "flow"),
    known=[io.read(path, "study_flow") for path in snakemake.input.known],
    neighbours=[io.read(path, "flow") for path in snakemake.input.neighbours],
    emission=next((io.read(path, "net_emission") for path in snakemake.input.emission), None),
    **in_si(settings),
)
job.write(snakemake, result, "study_flow")
