rule radiance:
    input:
        sightline="results/sightline/{condition}.nc",
        response="results/instrument/response.nc",
    output:
        "results/radiation/{condition}.nc",
    log:
        "results/logs/radiance_{condition}.log",
    benchmark:
        "results/benchmarks/radiance_{condition}.tsv"
    params:
        **config["radiation"],
    script:
        "../scripts/radiance.py"
