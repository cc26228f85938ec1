RESULTS += ["results/claims.nc", "results/claims.md"]


rule claims:
    input:
        sightlines=expand("results/sightline/{condition}.nc", condition=CONDITIONS),
        radiation=expand("results/radiation/{condition}.nc", condition=CONDITIONS),
        surface="results/analysis/surface_radiance.nc",
        response="results/instrument/response.nc",
        visibility="results/analysis/visibility.nc",
        apparent_temperature="results/analysis/apparent_temperature.nc",
        error_map="results/analysis/error_map.nc",
        transient="results/analysis/transient.nc",
        calibration="results/instrument/calibration.nc",
        pyrometer=f"results/experiment/{config['claims']['test']}/pyrometer_correction.nc",
        spectrometer=f"results/experiment/{config['claims']['test']}/spectrometer_correction.nc",
    output:
        table="results/claims.nc",
        text="results/claims.md",
    log:
        "results/logs/claims.log",
    benchmark:
        "results/benchmarks/claims.tsv"
    params:
        numerical_power_kw=[case["numerical_power_kw"] for case in CONDITIONS.values()],
    script:
        "../scripts/claims.py"
