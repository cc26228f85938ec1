from snakemake.utils import min_version

from plasmapyro import configuration, workspace

min_version("9.0")


configfile: "config/config.yaml"


for path in workflow.configfiles:
    configuration.read(path)
configuration.check(config, "config/schema.yaml", "the configuration")
if "study" in config:
    from plasmapyro.study import plan

    plan.check(config)
CONDITIONS = configuration.load_folder(
    config["conditions"], "config/schema_condition.yaml", order="numerical_power_kw"
)
TESTS = configuration.load_folder(config["tests"], "config/schema_test.yaml")

configuration.check_together(config, CONDITIONS, TESTS)
CFD_CONDITIONS = [name for name, case in CONDITIONS.items() if "cfd" in case]
if CFD_CONDITIONS:  # the import takes 0.1 s, in every job
    from plasmapyro.cfd.mapping import check_conditions

    check_conditions(CONDITIONS)
COMPUTED = [name for name in CONDITIONS if name not in CFD_CONDITIONS]
SETTINGS = [config, CONDITIONS, TESTS]
if workflow.is_main_process:
    DAMAGED, BUSY = workspace.begin("results", SETTINGS)
    for path in DAMAGED:
        logger.warning(f"{path} no longer had the bytes it was written with; it is computed again")
else:
    workspace.same_settings(SETTINGS)


onstart:
    workspace.require_free(BUSY)


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
include: "workflow/rules/claims.smk"
include: "workflow/rules/figures.smk"
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
    transient,
    surface_radiance,
    twin_calibration,
    twin_test,
    read_test,
    claims,
    crate,
    report,
    figures_instrument,
    figures_flow,
    figures_radiation,
    figures_analysis,
    figures_pyrometer,
    figures_spectrometer,
    figures_both,
    figures_sightline,
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
