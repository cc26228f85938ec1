# What probes would read in each computed flow, beside measured pairs; only where the configuration asks for it.
PAIRS_MBAR = 50  # the pairs were measured in air at this pressure, and are held against flows of that gas
PAIRED = [  # without flows of other walls or more mixing, which lie on another curve
    name
    for name in COMPUTED
    if GAS_OF[name][0] == AIR["N2"] and CONDITIONS[name]["chamber_pressure_mbar"] == PAIRS_MBAR
    if not {"flow", "mixing"} & set(CONDITIONS[name])
]
if "facility" in config:
    RESULTS += expand("results/facility/{condition}.nc", condition=COMPUTED)
    if PAIRED:
        FIGURES += drawn("facility_pairs")
        RESULTS += ["results/facility.nc", "results/facility.md"]


rule probe_readings:
    input:
        flow="results/flow/{condition}.nc",
        gas=of_gas("results/gas/{gas}.nc"),
    output:
        "results/facility/{condition}.nc",
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
        readings=expand("results/facility/{condition}.nc", condition=PAIRED),
    output:
        table="results/facility.nc",
        text="results/facility.md",
    params:
        conditions=PAIRED,
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
    script:
        "../scripts/figures_facility.py"
