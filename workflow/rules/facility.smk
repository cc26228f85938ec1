# What probes would read in each computed flow, beside measured pairs; only where the configuration asks for it.
if "facility" in config and COMPUTED:
    FIGURES += drawn("facility_pairs")
    RESULTS += [
        "results/facility.nc",
        "results/facility.md",
        *expand("results/facility/{condition}.nc", condition=COMPUTED),
    ]


rule probe_readings:
    input:
        flow="results/flow/{condition}.nc",
        gas="results/gas/air11.nc",
    output:
        "results/facility/{condition}.nc",
    log:
        "results/logs/probe_readings_{condition}.log",
    benchmark:
        "results/benchmarks/probe_readings_{condition}.tsv"
    params:
        **{
            key: config.get("facility", {}).get(key)
            for key in ["rates", "recombination", "probe_radius_mm", "wall_temperature_k", "pitot_radius_mm"]
        },
        measured=lambda wildcards: CONDITIONS[wildcards.condition].get("measured", {}),
    script:
        "../scripts/probe_readings.py"


rule facility:
    input:
        readings=expand("results/facility/{condition}.nc", condition=COMPUTED),
    output:
        table="results/facility.nc",
        text="results/facility.md",
    log:
        "results/logs/facility.log",
    benchmark:
        "results/benchmarks/facility.tsv"
    params:
        conditions=COMPUTED,
        settings={
            key: config.get("facility", {}).get(key)
            for key in ["admissible_recombination", "flux_uncertainty", "pressure_uncertainty"]
        },
    script:
        "../scripts/facility.py"


rule figures_facility:
    input:
        "results/facility.nc",
    output:
        drawn("facility_pairs"),
    log:
        "results/logs/figures_facility.log",
    benchmark:
        "results/benchmarks/figures_facility.tsv"
    script:
        "../scripts/figures_facility.py"
