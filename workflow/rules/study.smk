# A parameter study: `snakemake --configfile config/study.yaml`. Without the key `study` there is nothing here.
# One job per flow, one per flow and angle; emittances meet their gas in the last job only.
from plasmapyro.study import plan

STUDY = plan.make(config["study"], config["flow"]["start"], config["flow"]["power_step_kw"])
STUDY_RESULTS = ["results/study.nc", *drawn(["study_limit", "study_emittance"])]
STUDY_AXES = {"axes": config["study"]["axes"], "extra": config["study"].get("extra", [])}


rule study_flow:
    input:
        gas="results/gas/air11.nc",
        start="results/flow/start/reference.nc",
        known=lambda wildcards: expand("results/study/flow/{flow}.nc", flow=STUDY.chains[wildcards.flow]),
        neighbours=config["flow"]["neighbours"],
        emission=emission_of("air11", PHYSICS),
    output:
        "results/study/flow/{flow}.nc",
    log:
        "results/logs/study/flow_{flow}.log",
    # Flows of one level do not need each other, so a scheduler may take any number of them together.
    group:
        lambda wildcards: f"study_flows_{STUDY.level(wildcards.flow)}"
    params:
        **{key: value for key, value in config["flow"]["convergence"].items() if key != "error_mesh_ratio"},
        **PHYSICS,
        coil_frequency_khz=config["flow"]["torch"]["coil_frequency_khz"],
        condition=lambda wildcards: STUDY.flows[wildcards.flow],
        power_step_kw=config["flow"]["power_step_kw"],
    script:
        "../scripts/study_flow.py"


rule study_signal:
    input:
        study_flow=lambda wildcards: f"results/study/flow/{STUDY.sight_lines[wildcards.sight_line][0]}.nc",
        response="results/instrument/response.nc",
    output:
        "results/study/signal/{sight_line}.nc",
    log:
        "results/logs/study/signal_{sight_line}.log",
    group:
        "study_signals"
    params:
        **{key: value for key, value in config["sightline"].items() if key != "angle_deg"},
        **config["radiation"],
        angle_deg=lambda wildcards: STUDY.sight_lines[wildcards.sight_line][1],
    script:
        "../scripts/study_signal.py"


rule study_gather:
    input:
        signals=expand("results/study/signal/{sight_line}.nc", sight_line=STUDY.sight_lines),
        response="results/instrument/response.nc",
        curve="results/instrument/ratio_curve.nc",
    output:
        "results/study.nc",
    localrule: True
    params:
        **STUDY_AXES,
        object_temperature_k=config["study"]["object_temperature_k"],
        error_temperature_k=config["analysis"]["error_temperature_k"],
        error_level=config["analysis"]["error_level"],
    script:
        "../scripts/study_gather.py"


rule figures_study:
    input:
        "results/study.nc",
    output:
        limit=drawn("study_limit"),
        emittance=drawn("study_emittance"),
    localrule: True
    script:
        "../scripts/figures_study.py"
