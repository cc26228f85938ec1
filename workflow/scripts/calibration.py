"""Rule calibration: sensitivity ratio, modelled ratio curve and quadratic fit of the pyrometer."""

from plasmapyro import job
from plasmapyro.instrument.stage import pyrometer_calibration
from plasmapyro.quantities import steps

job.run(snakemake, pyrometer_calibration, "calibration", calibration_temperature=steps)
