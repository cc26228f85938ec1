# What a reader needs to cite and reuse a run: results/ro-crate-metadata.json describes every result, and
# results/workflow holds a copy of the workflow and the configuration that made them.
import os
from glob import glob

from plasmapyro import io

CRATE = "results/ro-crate-metadata.json"
USED = sorted(
    {
        "Snakefile",
        *glob("workflow/rules/*.smk"),
        *glob("workflow/scripts/*.py"),
        *map(os.path.relpath, workflow.configfiles),
        *glob("config/schema*.yaml"),
        *[
            f"{config[kind]['folder']}/{name}.yaml"
            for kind, cases in (("conditions", CONDITIONS), ("tests", TESTS))
            for name in cases
        ],
        *glob("environment.lock"),
    }
)


rule crate:
    input:
        results=[path for path in [*FIGURES, *RESULTS] if path.startswith("results/")],
        used=USED,
    output:
        metadata=CRATE,
        used=[f"results/workflow/{path}" for path in USED],
    log:
        "results/logs/crate.log",
    benchmark:
        "results/benchmarks/crate.tsv"
    params:
        publication=config["publication"],
        begun_with=[io.digest(path) for path in USED],
    script:
        "../scripts/crate.py"
