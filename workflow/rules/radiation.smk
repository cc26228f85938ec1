RESULTS += expand("results/radiation/{condition}.nc", condition=CONDITIONS)


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
        changes=lambda wildcards: CHANGES.get(wildcards.condition, {}),
    script:
        "../scripts/radiance.py"


# Not part of the main job: results/reflection/{condition}.nc, about a minute each.
rule reflected_radiance:
    input:
        surface_view="results/surface_view/{condition}.nc",
        response="results/instrument/response.nc",
    output:
        "results/reflection/{condition}.nc",
    log:
        "results/logs/reflected_radiance_{condition}.log",
    benchmark:
        "results/benchmarks/reflected_radiance_{condition}.tsv"
    params:
        **config["radiation"],
    script:
        "../scripts/reflected_radiance.py"
