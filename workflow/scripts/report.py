"""Rule report: everything the run found, on one page."""

import base64
import csv
import json
from pathlib import Path

from plasmapyro import io
from plasmapyro.report.stage import compose

io.log_to(snakemake.log[0])
given, keys = snakemake.input, snakemake.params
figures = [(Path(path).stem, base64.b64encode(io.read_bytes(path)).decode()) for path in given.figures]
timings = [
    (name, {key: float(row[key]) for key in ("s", "cpu_time", "max_rss")})
    for path in sorted(Path("results/benchmarks").glob("*.tsv"))
    for name in [max((rule for rule in keys.rules if path.stem.startswith(rule)), key=len, default="")]
    if name  # of a rule that there still is
    for row in csv.DictReader(io.read_text(path).splitlines(), delimiter="\t")
]
page = compose(
    figures,
    io.read(given.claims, "claims") if given.claims else None,
    list(zip(keys.tests, (io.read(one, Path(one).stem) for one in given.corrections), strict=True)),
    findings=[one for path in given.findings for one in json.loads(io.read_text(path))],
    diagnoses=list(zip(keys.diagnosed, map(io.read_text, given.diagnoses), strict=True)),
    timings=timings,
    **keys.shown,
)
io.write_text(page, snakemake.output[0])
