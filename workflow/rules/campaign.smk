# What the tests of config/campaign.yaml say together; no part of the main job: snakemake results/campaign/priors.yaml.
# The shipped list is that of a synthetic campaign (make campaign), to be replaced by that of a laboratory.
CAMPAIGN = "config/campaign.yaml"


def diagnoses_of_campaign(wildcards):
    """The reports that the list names."""
    return [entry["diagnosis"] for entry in configuration.read(CAMPAIGN)["tests"]]


rule campaign:
    input:
        plan=CAMPAIGN,
        diagnoses=diagnoses_of_campaign,
    output:
        priors="results/campaign/priors.yaml",
        page="results/campaign/campaign.md",
        figure="results/campaign/campaign.png",
    localrule: True
    script:
        "../scripts/campaign.py"
