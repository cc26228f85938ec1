"""Rule extended_gain: what the extension of a test made better and worse, outside its fit."""

import json

from plasmapyro import io
from plasmapyro.claims.beside import of_tests
from plasmapyro.commands.terms import read_terms
from plasmapyro.diagnosis.report.loop import loop_page
from plasmapyro.diagnosis.simulation.predicted import foretold

io.log_to(snakemake.log[0])
files, keys = snakemake.input, snakemake.params
reports = [json.loads(io.read_text(path)) for path in files.reports]
kinds = ["pyrometer_correction", "spectrometer_correction"] * 2
corrections = [io.read(path, kind) for path, kind in zip(files.corrections, kinds, strict=True)]
kinds = ("tests", "test"), ("simulated", "radiation"), ("extended", "radiation")
read = [[io.read(path, kind) for path in files.get(name)] for name, kind in kinds]
predictions = foretold(
    dict(zip(keys.names, zip(*read, strict=True), strict=True)),
    io.read(files.calibration, "calibration"),
    io.read(files.spectrometer_calibration, "spectrometer_calibration"),
    limits=keys.limits,
    saturation_counts=keys.saturation_counts,
)
instrument = [io.read(files[name], name) for name in ("response", "ratio_curve")]
claims = of_tests(predictions, dict(zip(keys.names, read[0], strict=True)), *instrument, keys.analysis)
pairs, terms = (corrections[:2], corrections[2:]), read_terms(files.terms, "condition")
page = loop_page(snakemake.wildcards.test, *reports, pairs, predictions, terms, claims)
io.write_text(page, snakemake.output[0])
