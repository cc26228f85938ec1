"""Rule extended_flow: the flow at the power that a diagnosis proposes; as it was if it proposes none."""

from plasmapyro import io, job
from plasmapyro.commands.terms import amplitude_of, read_terms
from plasmapyro.flow.stage import condition
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
files, keys = snakemake.input, in_si(snakemake.params)
base = io.read(files.flow, "flow")
change = amplitude_of(read_terms(files.terms[0], "condition"), "power")
power = keys.pop("numerical_power") * (1 + change)
known = {
    "neighbours": [base],
    "emission": next((io.read(path, "net_emission") for path in files.emission), None),
}
inputs = [io.read(files.gas, "gas"), io.read(files.start, "flow")] if change else []
result = condition(*inputs, **known, numerical_power=power, **keys) if change else base
job.write(snakemake, result, "flow")
