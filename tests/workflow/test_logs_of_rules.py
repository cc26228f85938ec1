"""Each job keeps a log and its time and memory, under a name of its own; each rule calls its script."""

import csv
import re
import subprocess
import sys
from pathlib import Path

from clone import copy_of_the_project, snakemake

RULES = Path(__file__).resolve().parents[2] / "workflow" / "rules"
JOB = r"^(?:local)?rule (\w+):\n(?:    .*\n)*?    log: (\S+)\n"


def test_each_job_has_a_log_of_its_own(tmp_path):
    project = copy_of_the_project(tmp_path / "clone")
    run = snakemake(project, "--dry-run", "--forceall", "all", "results/report.html")
    jobs = re.findall(JOB, run.stdout, re.MULTILINE)
    assert len(jobs) == run.stdout.count("    jobid: ") - 1 > 80  # all but that of the rule `all`
    assert len({log for _, log in jobs}) == len(jobs)
    for rule, log in jobs:
        assert re.fullmatch(rf"results/logs/{rule}\w*\.log", log)


def test_a_job_notes_what_it_cost_beside_its_log(tmp_path):
    log, noted = tmp_path / "results/logs/one/job_90kW.log", tmp_path / "results/benchmarks/one/job_90kW.tsv"
    log.parent.mkdir(parents=True)
    work = "import time\nheld = bytearray(b'1') * 300_000_000\nwhile time.process_time() < 1.0: pass"
    words = f"from plasmapyro import io\nio.log_to({str(log)!r})\n{work}"
    subprocess.run([sys.executable, "-c", words], check=True)
    (row,) = csv.DictReader(noted.read_text().splitlines(), delimiter="\t")
    assert 1.0 <= float(row["cpu_time"]) < 60
    assert float(row["s"]) >= 0.9 * float(row["cpu_time"])
    assert 300 / 1.048 <= float(row["max_rss"]) < 3000


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
