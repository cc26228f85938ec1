"""Rule ratio_curve: modelled signal ratio of a black body, with the published sensitivity ratio."""

from plasmapyro import job
from plasmapyro.instrument.stage import ratio_curve
from plasmapyro.quantities import steps

job.run(
    snakemake,
    ratio_curve,
    "ratio_curve",
    temperature=steps,
    renamed={"temperature": "calibration_temperature"},
)
