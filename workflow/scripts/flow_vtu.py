"""Rule flow_vtu: the computed flow fields as files that ParaView opens."""

from plasmapyro import io
from plasmapyro.cfd.export import write_vtus

io.log_to(snakemake.log[0])
write_vtus((io.read(path, "flow") for path in snakemake.input.flows), snakemake.output)
