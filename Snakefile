import os
import sys

from snakemake.utils import min_version

from plasmapyro import configuration, workspace
from plasmapyro.gas.species import AIR, gas_name
from plasmapyro.readers.stage import condition_of, misplaced

min_version("9.0")
os.environ["PLASMAPYRO_JOB"] = "1"  # its processes load their modules without a search for garbage
try:  # what is wrong in a configuration is said by file and key, without Python's frames
    configuration.read("config/config.yaml")
except configuration.ConfigurationError as fault:
    raise SystemExit(f"plasmapyro: {fault}") from None


configfile: "config/config.yaml"


try:
    for path in workflow.configfiles:
        configuration.read(path)
    configuration.check(
        config, "config/schema.yaml", " with ".join(map(os.path.relpath, workflow.configfiles))
    )
    if "study" in config:
        from plasmapyro.study import plan

        plan.check(config)
    CONDITIONS = configuration.load_folder(
        config["conditions"], "config/schema_condition.yaml", order="numerical_power_kw"
    )
    TESTS = configuration.load_folder(config["tests"], "config/schema_test.yaml")

    # With bands the pyrometer that the paper's and the twin's tests are of is another instrument.
    BANDS = "bands" in config["instrument"]
    LEFT_OUT = [name for name, case in TESTS.items() if BANDS and "pyrometer" in case["instruments"]]
    TESTS = {name: case for name, case in TESTS.items() if name not in LEFT_OUT}
    CHANGES = {}  # of the light of the gas, by condition
    STATED = (config["instrument"], *CONDITIONS.values(), *TESTS.values())
    if any("effects" in case for case in STATED):  # the import takes a second
        from plasmapyro.commands import terms

        terms.check_effects(TESTS, "test", config["tests"]["folder"])
        terms.check_effects(CONDITIONS, "condition", config["conditions"]["folder"])
        TESTS = terms.with_instrument(config["instrument"].get("effects", []), TESTS)
        CONDITIONS, CHANGES = terms.with_effects(CONDITIONS)
    if workflow.is_main_process and any("effects" in case.get("twin", {}) for case in TESTS.values()):
        sys.path.insert(0, os.path.abspath("workflow"))  # the package knows nothing of what is hidden
        from twin import story

        if found := story.faults_of(TESTS, config["tests"]["folder"]):
            raise configuration.ConfigurationError(found)
    configuration.check_together(config, CONDITIONS, TESTS)
    CFD_CONDITIONS = [name for name, case in CONDITIONS.items() if "cfd" in case]
    if CFD_CONDITIONS:  # the import takes 0.1 s, in every job
        from plasmapyro.cfd.mapping import check_conditions

        check_conditions(CONDITIONS)
    COMPUTED = [name for name in CONDITIONS if name not in CFD_CONDITIONS]
    # The paper's figures and claims show the named set; one's own conditions get files of their own, *_own.*.
    PAPER = [name for name in CONDITIONS if name in config["claims"]["conditions"]]
    OWN = [name for name in CONDITIONS if name not in PAPER]
    SETS = {"": PAPER, **({"_own": OWN} if OWN else {})}
    # The simulation that a test is compared with, as its file says; not that of a lamp without plasma.
    COMPARED = {
        test: case["twin"]["condition"] if "twin" in case else condition_of(case["data_folder"])
        for test, case in TESTS.items()
    }
    COMPARED = {
        test: condition or config["diagnosis"]["condition"]
        for test, condition in COMPARED.items()
        if condition != "none"
    }
    configuration.check_compared(COMPARED, CONDITIONS)
    if lost := list(misplaced({test: case for test, case in TESTS.items() if "twin" not in case})):
        raise configuration.ConfigurationError("\n  ".join(["tests without their data:", *lost]))
    # Those that are worked on by themselves; the others judge what these taught.
    WORKED = [test for test, case in TESTS.items() if not case.get("judge")]
    DIAGNOSED = [test for test in COMPARED if test in WORKED]
    SETTINGS = [config, CONDITIONS, TESTS]
    if workflow.is_main_process:
        configuration.check_targets(sys.argv[1:], CONDITIONS, config["conditions"])
        DAMAGED, BUSY = workspace.begin("results", SETTINGS)
        workspace.digest_once()
        workspace.wake_once()
        if LEFT_OUT:
            logger.warning(f"instrument.bands: tests of a pyrometer are left out: {', '.join(LEFT_OUT)}")
        for path in DAMAGED:
            logger.warning(f"{path} no longer had the bytes it was written with; it is computed again")
    else:
        workspace.same_settings(SETTINGS)
except (configuration.ConfigurationError, workspace.WorkspaceError) as fault:
    raise SystemExit(f"plasmapyro: {fault}") from None


onstart:
    workspace.require_free(BUSY)


wildcard_constraints:
    own="(_own)?",


def of_set(path, among=CONDITIONS):
    """Input function: the files of the conditions of a set, as far as they are among some."""
    return lambda wildcards: expand(path, condition=[one for one in SETS[wildcards.own] if one in among])


RESULTS = []  # what the main job leaves behind besides figures; each file of rules adds its own


include: "workflow/rules/cfd.smk"
include: "workflow/rules/gas.smk"
include: "workflow/rules/flow.smk"
include: "workflow/rules/sightline.smk"
include: "workflow/rules/instrument.smk"
include: "workflow/rules/radiation.smk"
include: "workflow/rules/analysis.smk"
include: "workflow/rules/twin.smk"
include: "workflow/rules/experiment.smk"
include: "workflow/rules/design.smk"
include: "workflow/rules/diagnosis.smk"
include: "workflow/rules/extended.smk"
include: "workflow/rules/campaign.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/facility.smk"
include: "workflow/rules/crate.smk"
include: "workflow/rules/report.smk"


if "study" in config:

    include: "workflow/rules/study.smk"

    rule study:
        default_target: True
        input:
            STUDY_RESULTS,
        localrule: True


# On a cluster these run beside Snakemake: a queue would take longer than they do.
localrules:
    all,
    response,
    ratio_curve,
    calibration,
    spectrometer_calibration,
    gas_signal,
    visibility,
    apparent_temperature,
    error_map,
    reflection_map,
    trust,
    trust_pages,
    transient,
    surface_radiance,
    twin_calibration,
    twin_test,
    read_test,
    findings,
    claims,
    facility,
    figures_facility,
    workflow_copy,
    crate,
    report,
    figures_instrument,
    figures_calibration,
    figures_flow,
    figures_fields,
    figures_analysis,
    flow_vtu,
    cfd_sightline,
    cfd_surface_view,
    figures_design,


rule all:
    default_target: "study" not in config
    input:
        FIGURES,
        RESULTS,
        CRATE,


def name_of_jobs(rule):
    """Name of a rule and its wildcards, for what its jobs leave beside their results."""
    return rule.name + "".join(
        f"{{{one}}}" if one == "own" else f"_{{{one}}}" for one in sorted(rule.wildcard_names)
    )


# A script counts by its bytes, not by its date (`rerun-triggers` of the profiles): a finished folder may be
# moved, renamed, copied or cloned again, and an edited script still runs. Each job keeps a log and notes its cost
# (`plasmapyro.cost`); those of a study, which may be thousands, stand in folders of their own.
for each in workflow.rules:
    if each.script:
        # Absent where a rule states none.
        for kind in ("input", "log"):
            setattr(each, f"{kind}_modifier", getattr(each, f"{kind}_modifier") or each.output_modifier)
        each.set_input(script=local(f"workflow/scripts/{os.path.basename(each.script)}"))
        if not each.log:
            each.set_log(f"results/logs/{name_of_jobs(each)}.log")
