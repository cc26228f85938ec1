"""Rule figures_fields: the computed fields, one figure each (figure 5a and beyond)."""

from plasmapyro import io
from plasmapyro.facility.sections import sections
from plasmapyro.plots import flow

io.log_to(snakemake.log[0])
keys, drawn = snakemake.params, snakemake.output
flows, sightlines = (
    {name: io.read(path, contract) for name, path in zip(keys.conditions, paths, strict=True)}
    for contract, paths in (("flow", snakemake.input.flows), ("sightline", snakemake.input.sightlines))
)
flow.temperature_field(flows[keys.field_condition], sightlines[keys.field_condition], drawn.temperature_field)
files = [drawn.fields[k : k + keys.formats] for k in range(0, len(drawn.fields), keys.formats)]
flow.fields(flows.values(), sightlines.values(), files)
found = sections(flows[keys.field_condition], io.read(snakemake.input.gas, "gas"))
flow.budgets(flows[keys.field_condition], found, drawn.budgets)
