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


def made_for(targets):
    """Every result that the rules make for these targets, they themselves among them."""
    found, ahead = set(), list(targets)
    while ahead:
        path = ahead.pop()
        makers = [each for each in workflow.rules if path not in found and each.is_producer(path)]
        if makers:
            maker = min(makers, key=lambda each: len(each.wildcard_names))
            wildcards = maker.get_wildcards(path)
            found.update(map(str, maker.expand_output(wildcards)[0]))
            ahead += map(str, maker.expand_input(wildcards)[0])
    return sorted(found)


COPIES = [f"results/workflow/{path}" for path in USED]
BEGUN_WITH = [io.digest(path) for path in USED]


# Apart from the crate: Snakemake digests all inputs of a rule again for each of its outputs.
rule workflow_copy:
    input:
        used=USED,
    output:
        COPIES,
    params:
        begun_with=BEGUN_WITH,
    script:
        "../scripts/workflow_copy.py"


rule crate:
    input:
        results=lambda wildcards: made_for([*FIGURES, *RESULTS]),
        used=USED,
        copies=COPIES,
    output:
        CRATE,
    params:
        publication=config["publication"],
        begun_with=BEGUN_WITH,
    script:
        "../scripts/crate.py"
