RESULTS += expand(
    "results/analysis/{name}.nc",
    name=["gas_signal", "visibility", "apparent_temperature", "error_map", "transient", "surface_radiance"],
)


rule gas_signal:
    input:
        radiation=expand("results/radiation/{condition}.nc", condition=CONDITIONS),
    output:
        "results/analysis/gas_signal.nc",
    log:
        "results/logs/gas_signal.log",
    benchmark:
        "results/benchmarks/gas_signal.tsv"
    params:
        conditions=list(CONDITIONS),
        numerical_power_kw=[case["numerical_power_kw"] for case in CONDITIONS.values()],
        emittance=[case["emittance"] for case in CONDITIONS.values()],
    script:
        "../scripts/gas_signal.py"


rule visibility:
    input:
        gas="results/analysis/gas_signal.nc",
        response="results/instrument/response.nc",
    output:
        "results/analysis/visibility.nc",
    log:
        "results/logs/visibility.log",
    benchmark:
        "results/benchmarks/visibility.tsv"
    params:
        object_temperature_k=config["analysis"]["visibility_temperature_k"],
        visibility_level=config["analysis"]["visibility_level"],
    script:
        "../scripts/visibility.py"


rule apparent_temperature:
    input:
        gas="results/analysis/gas_signal.nc",
        response="results/instrument/response.nc",
        curve="results/instrument/ratio_curve.nc",
    output:
        "results/analysis/apparent_temperature.nc",
    log:
        "results/logs/apparent_temperature.log",
    benchmark:
        "results/benchmarks/apparent_temperature.tsv"
    params:
        object_temperature_k=config["analysis"]["apparent_temperature_k"],
    script:
        "../scripts/apparent_temperature.py"


rule error_map:
    input:
        gas="results/analysis/gas_signal.nc",
        response="results/instrument/response.nc",
        curve="results/instrument/ratio_curve.nc",
    output:
        "results/analysis/error_map.nc",
    log:
        "results/logs/error_map.log",
    benchmark:
        "results/benchmarks/error_map.tsv"
    params:
        object_temperature_k=config["analysis"]["error_temperature_k"],
        emittance=config["analysis"]["error_emittance"],
        error_level=config["analysis"]["error_level"],
    script:
        "../scripts/error_map.py"


rule transient:
    input:
        gas="results/analysis/gas_signal.nc",
        response="results/instrument/response.nc",
        curve="results/instrument/ratio_curve.nc",
    output:
        "results/analysis/transient.nc",
    log:
        "results/logs/transient.log",
    benchmark:
        "results/benchmarks/transient.tsv"
    params:
        **config["analysis"]["transient"],
    script:
        "../scripts/transient.py"


rule surface_radiance:
    output:
        "results/analysis/surface_radiance.nc",
    log:
        "results/logs/surface_radiance.log",
    benchmark:
        "results/benchmarks/surface_radiance.tsv"
    params:
        object_temperature_k=config["figures"]["surface_temperature_k"],
        emittance=config["figures"]["surface_emittance"],
        wavelength_nm=config["radiation"]["wavelength_nm"],
    script:
        "../scripts/surface_radiance.py"
