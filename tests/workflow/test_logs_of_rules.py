"""Each job keeps a log and its time and memory, under a name of its own; each rule calls its script."""

import re
from pathlib import Path

from clone import copy_of_the_project, snakemake

RULES = Path(__file__).resolve().parents[2] / "workflow" / "rules"
JOB = r"^(?:local)?rule (\w+):\n(?:    .*\n)*?    log: (\S+)\n(?:    .*\n)*?    benchmark: (\S+)\n"


def test_each_job_has_a_log_and_a_benchmark_of_its_own(tmp_path):
    project = copy_of_the_project(tmp_path / "clone")
    run = snakemake(project, "--dry-run", "--forceall", "all", "results/report.html")
    jobs = re.findall(JOB, run.stdout, re.MULTILINE)
    assert len(jobs) == run.stdout.count("    jobid: ") - 1 > 80  # all but that of the rule `all`
    assert len({log for _, log, _ in jobs}) == len(jobs)
    for rule, log, benchmark in jobs:
        assert re.fullmatch(rf"results/logs/{rule}\w*\.log", log)
        assert benchmark == log.replace("logs", "benchmarks").replace(".log", ".tsv")


def test_each_rule_calls_the_script_of_its_name():
    found = 0
    for path in sorted(RULES.glob("*.smk")):
        blocks = re.split(r"^rule (\w+):$", path.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
        for name, text in zip(blocks[::2], blocks[1::2], strict=True):
            text = text.partition("\nuse rule ")[0]
            assert re.findall(r'^    script:\n        "\.\./scripts/(\w+)\.py"$', text, re.MULTILINE) == [
                name
            ]
            found += 1
    assert found > 40
