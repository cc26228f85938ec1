# One cold start at a reference condition; each power condition continues from it by itself, or from a nearer
# solution of an earlier run. The radiation loss is computed only where it is asked for.
EMISSION = ["results/gas/net_emission.nc"] if config["flow"]["physics"]["radiation_factor"] else []
if COMPUTED:
    RESULTS += ["results/flow/start/reference.nc", *expand("results/flow/{condition}.nc", condition=COMPUTED)]


rule net_emission:
    input:
        "results/gas/air11.nc",
    output:
        "results/gas/net_emission.nc",
    log:
        "results/logs/net_emission.log",
    benchmark:
        "results/benchmarks/net_emission.tsv"
    script:
        "../scripts/net_emission.py"


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
        **config["flow"]["start"],
        **config["flow"]["convergence"],
        probe_temperature_k=config["flow"]["physics"]["probe_temperature_k"],
        torch=config["flow"]["torch"],
    script:
        "../scripts/flow_start.py"


rule flow:
    input:
        gas="results/gas/air11.nc",
        start="results/flow/start/reference.nc",
        neighbours=config["flow"]["neighbours"],
        emission=EMISSION,
    output:
        "results/flow/{condition}.nc",
    log:
        "results/logs/flow_{condition}.log",
    benchmark:
        "results/benchmarks/flow_{condition}.tsv"
    params:
        **config["flow"]["convergence"],
        **config["flow"]["physics"],
        coil_frequency_khz=config["flow"]["torch"]["coil_frequency_khz"],
        numerical_power_kw=lambda wildcards: CONDITIONS[wildcards.condition]["numerical_power_kw"],
        chamber_pressure_mbar=lambda wildcards: CONDITIONS[wildcards.condition]["chamber_pressure_mbar"],
        mass_flow_rate_g_s=lambda wildcards: CONDITIONS[wildcards.condition]["mass_flow_rate_g_s"],
        power_step_kw=config["flow"]["power_step_kw"],
    script:
        "../scripts/flow.py"
