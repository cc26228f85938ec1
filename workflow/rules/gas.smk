RESULTS.append("results/gas/air11.nc")


rule air_table:
    output:
        "results/gas/air11.nc",
    log:
        "results/logs/air_table.log",
    benchmark:
        "results/benchmarks/air_table.tsv"
    params:
        **config["gas"],
    script:
        "../scripts/air_table.py"
