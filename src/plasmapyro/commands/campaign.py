"""`plasmapyro campaign`: what several tests say together, and the prior of the next one."""

import json
import sys
from pathlib import Path

import plasmapyro.campaign
from plasmapyro import configuration, io, progress
from plasmapyro.campaign.report import page
from plasmapyro.campaign.stage import calibrations_of, campaign, priors_text, tests_of
from plasmapyro.commands.outputs import require_folder
from plasmapyro.plots.campaign import laws

SCHEMA = Path(plasmapyro.campaign.__file__).with_name("campaign.schema.yaml")
NAMES = ("priors.yaml", "campaign.md", "campaign.png")


def run(options):
    """Run `plasmapyro campaign`: diagnoses in, three files out."""
    plan = plan_of(options.file)
    if options.until is not None:
        plan = until(plan, options.until)
    read = [options.file, *(one["diagnosis"] for one in plan["tests"])]
    require_folder(options.out, NAMES, read)
    write(plan, options.out)
    progress.say("done")


def plan_of(path):
    """The plan of a campaign from its file; ConfigurationError for another."""
    return configuration.load(path, SCHEMA)


def until(plan, name):
    """The plan before one of its tests, which is the coming one."""
    names = [one["name"] for one in plan["tests"]]
    if name not in names[1:]:
        raise ValueError(f"--until: must name a test after the first ({', '.join(names[1:])}); got {name!r}")
    place = names.index(name)
    keys = ("date", "electric_power_kw", "material")
    return plan | {"tests": plan["tests"][:place], "next": {key: plan["tests"][place][key] for key in keys}}


def write(plan, folder):
    """Write the three files of a campaign, by its `campaign.schema.yaml`, into a folder."""
    reports = {one["name"]: report_of(one["diagnosis"]) for one in plan["tests"]}
    tests = tests_of(plan, reports)
    progress.say(f"campaign of {len(tests) - 1} tests")
    found = campaign(tests, 1e3 * plan["reference_power_kw"])
    files_of = {name: one for report in reports.values() for name, one in calibrations_of(report).items()}

    def files(made):
        io.write_text(priors_text(found, files_of), made / "priors.yaml")
        io.write_text(page(found), made / "campaign.md")
        laws(found, [made / "campaign.png"])

    io.store_folder(folder, files)
    sys.stdout.write(page(found).splitlines()[2] + "\n")


def report_of(path):
    """The report of a diagnosis from its file; ValueError for another file."""
    if not Path(path).exists():
        raise ValueError(f"{path}: no such file; a name in the list counts from the folder of the call")
    try:
        report = json.loads(io.read_text(path))
    except ValueError as fault:
        raise ValueError(f"{path}: no diagnosis.json: {fault}") from None
    if not isinstance(report, dict) or report.get("schema") != "plasmapyro-diagnosis-1":
        raise ValueError(f"{path}: no diagnosis.json of this package")
    return report
