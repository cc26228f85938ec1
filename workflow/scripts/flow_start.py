"""Rule flow_start: steady flow at the reference condition, from a hot first guess."""

from plasmapyro import io, job
from plasmapyro.flow.stage import cold_start
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
settings = in_si(snakemake.params)
torch = in_si(settings.pop("torch"))
result = cold_start(
    io.read(snakemake.input[0], "gas"),
    wall_temperature=torch.pop("wall_temperature"),
    coil_frequency=torch.pop("coil_frequency"),
    torch={name.removeprefix("torch_"): value for name, value in torch.items()},
    **settings,
)
job.write(snakemake, result, "flow")
