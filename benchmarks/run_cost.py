"""What a run costs: processor time of its jobs by rule, the extended run apart (`results/benchmarks`).

python benchmarks/run_cost.py [results]
"""

import argparse
import csv
from collections import defaultdict
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[1] / "workflow/scripts"
EXTENDED = "extended_"  # begins the names of the jobs of the extended run


def rule_of(job, rules):
    """The rule of a job, whose name goes on with the wildcards; the job where it has no script of its own."""
    return max((rule for rule in rules if f"{job}_".startswith(f"{rule}_")), key=len, default=job)


def costs(folder):
    """Rule -> processor times [s] of its jobs, as noted in a folder of a run."""
    rules = [path.stem.removeprefix(EXTENDED) for path in SCRIPTS.glob("*.py")]
    found = defaultdict(list)
    for path in sorted(folder.rglob("*.tsv")):
        (row,) = csv.DictReader(path.read_text(encoding="utf-8").splitlines(), delimiter="\t")
        own = path.stem.removeprefix(EXTENDED)
        found[path.stem.removesuffix(own) + rule_of(own, rules)].append(float(row["cpu_time"]))
    return dict(found)


def table(found):
    """Markdown of rules, the dearest first, and the sums of main job and extended run."""
    lines = ["| rule | jobs | CPU s |", "|---|---|---|"]
    for rule, times in sorted(found.items(), key=lambda one: -sum(one[1])):
        lines.append(f"| `{rule}` | {len(times)} | {sum(times):.0f} |")
    for name, apart in (("main job", False), ("extended run", True)):
        own = [one for rule, times in found.items() if rule.startswith(EXTENDED) == apart for one in times]
        lines.append(f"| **{name}** | {len(own)} | **{sum(own):.0f}** |")
    return "\n".join(lines)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", nargs="?", type=Path, default="results", help="folder of a finished run")
    print(table(costs(parser.parse_args().results / "benchmarks")))
