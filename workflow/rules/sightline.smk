rule sightline:
    input:
        "results/flow/{condition}.nc",
    output:
        "results/sightline/{condition}.nc",
    log:
        "results/logs/sightline_{condition}.log",
    benchmark:
        "results/benchmarks/sightline_{condition}.tsv"
    params:
        **config["sightline"],
    script:
        "../scripts/sightline.py"
