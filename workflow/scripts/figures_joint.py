"""Rule figures_joint: joint estimate beside what is measured and what the subtraction gives."""

from plasmapyro import io
from plasmapyro.plots.experiment import joint_temperature

io.log_to(snakemake.log[0])
joint_temperature(
    io.read(snakemake.input.correction, "pyrometer_correction"),
    io.read(snakemake.input.joint, "joint_estimate"),
    snakemake.output.joint_estimate,
)
