RESULTS += expand("results/sightline/{condition}.nc", condition=CONDITIONS)


rule sightline:
    input:
        flow="results/flow/{condition}.nc",
    output:
        "results/sightline/{condition}.nc",
    wildcard_constraints:
        condition=one_of(COMPUTED),
    params:
        **config["sightline"],
    script:
        "../scripts/sightline.py"


rule surface_view:
    input:
        flow="results/flow/{condition}.nc",
    output:
        "results/surface_view/{condition}.nc",
    wildcard_constraints:
        condition=one_of(COMPUTED),
    params:
        **config["reflection"],
        angle_deg=config["sightline"]["angle_deg"],
    script:
        "../scripts/surface_view.py"
