"""Rule recommended_temperature: of all estimates of a test the one to take away, and why."""

import json
from pathlib import Path

from plasmapyro import io
from plasmapyro.record.recommended import of_correction

io.log_to(snakemake.log[0])
files = snakemake.input
parts = [io.read(path, Path(path).stem) for path in files.corrections]
result = of_correction(parts, json.loads(io.read_text(files.findings)))
io.write(result, snakemake.output[0], "temperature", sources=files)
