"""Rule study_signal: band signals of the gas along one line of sight of a study."""

from plasmapyro import job
from plasmapyro.study.stage import signal

job.run(snakemake, signal, "study_signal", renamed={"wavelength": "wavelength_range"})
