# Which bands see least of the gas, samples that mirror it, and from when on a reading can be trusted.
AIR_PATH_MM = config["sightline"]["instrument_distance_mm"] - config["sightline"]["window_distance_mm"]
# The light on the sample needs the flow around it: conditions of another program's flow are left out.
if COMPUTED:
    RESULTS += [f"results/design/{name}.nc" for name in ("gas_spectra", "band_design", "reflection", "trust")]
    RESULTS += expand("results/design/trust_{condition}.md", condition=COMPUTED)
DESIGN = {name: value for name, value in config["design"].items() if name not in ("reflection", "trust")}


rule gas_spectra:
    input:
        sightlines=expand("results/sightline/{condition}.nc", condition=COMPUTED),
        flows=expand("results/flow/{condition}.nc", condition=COMPUTED),
    output:
        "results/design/gas_spectra.nc",
    log:
        "results/logs/gas_spectra.log",
    benchmark:
        "results/benchmarks/gas_spectra.tsv"
    params:
        conditions=COMPUTED,
        numerical_power_kw=[CONDITIONS[name]["numerical_power_kw"] for name in COMPUTED],
        angle_deg=config["sightline"]["angle_deg"],
        core_angle_deg=config["reflection"]["core_angle_deg"],
        wavelength_nm=DESIGN["wavelength_nm"],
        grid_points=DESIGN["grid_points"],
        table_nodes=DESIGN["table_nodes"],
        bin_width_nm=DESIGN["bin_width_nm"],
        temperature_change=DESIGN["temperature_change"],
        sightline_thinning=DESIGN["sightline_thinning"],
        directions=DESIGN["directions"],
        ray_points=DESIGN["ray_points"],
    script:
        "../scripts/gas_spectra.py"


rule band_design:
    input:
        spectra="results/design/gas_spectra.nc",
        response="results/instrument/response.nc",
    output:
        "results/design/band_design.nc",
    log:
        "results/logs/band_design.log",
    benchmark:
        "results/benchmarks/band_design.tsv"
    params:
        design=DESIGN,
        air_path_mm=AIR_PATH_MM,
        silicon_table=config["instrument"]["response"]["silicon_table"],
    script:
        "../scripts/band_design.py"


rule reflection_map:
    input:
        gas="results/analysis/gas_signal.nc",
        spectra="results/design/gas_spectra.nc",
        response="results/instrument/response.nc",
        curve="results/instrument/ratio_curve.nc",
    output:
        "results/design/reflection.nc",
    log:
        "results/logs/reflection_map.log",
    benchmark:
        "results/benchmarks/reflection_map.tsv"
    params:
        **config["design"]["reflection"],
        object_temperature_k=config["analysis"]["error_temperature_k"],
        error_level=config["analysis"]["error_level"],
    script:
        "../scripts/reflection_map.py"


rule trust:
    input:
        spectra="results/design/gas_spectra.nc",
        designs="results/design/band_design.nc",
        response="results/instrument/response.nc",
    output:
        table="results/design/trust.nc",
        pages=expand("results/design/trust_{condition}.md", condition=COMPUTED),
    log:
        "results/logs/trust.log",
    benchmark:
        "results/benchmarks/trust.tsv"
    params:
        conditions=COMPUTED,
        design=config["design"],
        air_path_mm=AIR_PATH_MM,
        silicon_table=config["instrument"]["response"]["silicon_table"],
    script:
        "../scripts/trust.py"
