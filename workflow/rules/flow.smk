# One cold start at a reference condition; each power condition continues from it by itself.
if COMPUTED:
    RESULTS += ["results/flow/start/reference.nc", *expand("results/flow/{condition}.nc", condition=COMPUTED)]


rule flow_start:
    input:
        "results/gas/air11.nc",
    output:
        "results/flow/start/reference.nc",
    log:
        "results/logs/flow_start.log",
    benchmark:
        "results/benchmarks/flow_start.tsv"
    params:
        **config["flow"]["torch"],
        **config["flow"]["start"],
        **config["flow"]["convergence"],
    script:
        "../scripts/flow_start.py"


rule flow:
    input:
        gas="results/gas/air11.nc",
        start="results/flow/start/reference.nc",
    output:
        "results/flow/{condition}.nc",
    log:
        "results/logs/flow_{condition}.log",
    benchmark:
        "results/benchmarks/flow_{condition}.tsv"
    params:
        **config["flow"]["convergence"],
        numerical_power_kw=lambda wildcards: CONDITIONS[wildcards.condition]["numerical_power_kw"],
        chamber_pressure_mbar=lambda wildcards: CONDITIONS[wildcards.condition]["chamber_pressure_mbar"],
        mass_flow_rate_g_s=lambda wildcards: CONDITIONS[wildcards.condition]["mass_flow_rate_g_s"],
        power_step_kw=config["flow"]["power_step_kw"],
    script:
        "../scripts/flow.py"
