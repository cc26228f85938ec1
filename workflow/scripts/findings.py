"""Rule findings: what contradicts itself in a test, its results and its calibrations."""

import json
from pathlib import Path

from plasmapyro import io
from plasmapyro.quality.catalogue import of_test
from plasmapyro.readers.stage import read_with_files

io.log_to(snakemake.log[0])
paths, folder = snakemake.input, snakemake.params.folder
others = ("calibration", "response", "spectrometer_calibration", "radiometer_calibration")
found = of_test(
    folder,
    read_with_files(folder),
    [io.read(path, Path(path).stem) for path in paths.corrections],
    **{name: io.read(path, name) for name, path in paths.items() if name in others and path},
)
io.write_text(json.dumps([finding.entry for finding in found], indent=1) + "\n", snakemake.output[0])
