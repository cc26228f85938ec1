"""Rule flow: steady flow at one condition, continued from the nearest known solution."""

from plasmapyro import io, job
from plasmapyro.flow.stage import condition
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
keys = snakemake.params
result = condition(
    io.read(snakemake.input.gas, "gas"),
    io.read(snakemake.input.start, "flow"),
    neighbours=[io.read(path, "flow") for path in snakemake.input.neighbours],
    emission=next((io.read(path, "net_emission") for path in snakemake.input.emission), None),
    **in_si(keys),
)
job.write(snakemake, result, "flow")
