"""Rule figures_flow: how the flows of a set converged and what they balance."""

from pathlib import Path

from plasmapyro import io
from plasmapyro.plots import flow

io.log_to(snakemake.log[0])
flows = {Path(path).stem: io.read(path, "flow") for path in snakemake.input.flows}
flow.convergence(flows, snakemake.output.convergence)
flow.balances(flows, snakemake.output.balances)
