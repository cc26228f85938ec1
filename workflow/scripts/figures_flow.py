"""Rule figures_flow: computed fields, how they converged and what they balance (figure 4a and beyond)."""

from plasmapyro import io
from plasmapyro.plots import flow

io.log_to(snakemake.log[0])
keys, drawn = snakemake.params, snakemake.output
flows = {
    name: io.read(path, "flow") for name, path in zip(keys.conditions, snakemake.input.flows, strict=True)
}
sightlines = {
    name: io.read(path, "sightline")
    for name, path in zip(keys.conditions, snakemake.input.sightlines, strict=True)
}
flow.temperature_field(flows[keys.field_condition], sightlines[keys.field_condition], drawn.temperature_field)
numerical_power = [power * 1e3 for power in keys.numerical_power_kw]
flow.convergence(flows, numerical_power, drawn.convergence)
flow.balances(flows, numerical_power, drawn.balances)
files = [drawn.fields[k : k + keys.formats] for k in range(0, len(drawn.fields), keys.formats)]
flow.fields(flows.values(), sightlines.values(), files)
