from snakemake.utils import min_version

from plasmapyro import configuration

min_version("9.0")


configfile: "config/config.yaml"


for path in workflow.configfiles:
    configuration.read(path)
configuration.check(config, "config/schema.yaml", "the configuration")
CONDITIONS = configuration.load_folder(
    config["conditions"], "config/schema_condition.yaml", order="numerical_power_kw"
)
TESTS = configuration.load_folder(config["tests"], "config/schema_test.yaml")

configuration.check_together(config, CONDITIONS, TESTS)


include: "workflow/rules/gas.smk"
include: "workflow/rules/flow.smk"
include: "workflow/rules/sightline.smk"
include: "workflow/rules/instrument.smk"
include: "workflow/rules/radiation.smk"
include: "workflow/rules/analysis.smk"
include: "workflow/rules/twin.smk"
include: "workflow/rules/experiment.smk"
include: "workflow/rules/diagnosis.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/figures.smk"


rule all:
    default_target: True
    input:
        FIGURES,
        "results/claims.md",
