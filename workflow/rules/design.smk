# Which bands see least of the gas, samples that mirror it, and from when on a reading can be trusted.
AIR_PATH_MM = config["sightline"]["instrument_distance_mm"] - config["sightline"]["window_distance_mm"]
# The light on the sample needs the flow around it: conditions of another program's flow are left out. The search is made
# in the gases of the paper's conditions, whose powers are a ladder; all others are judged with what it found.
DESIGNED = [name for name in PAPER if name in COMPUTED]
JUDGED = (
    {own: [name for name in names if name in COMPUTED] for own, names in SETS.items()} if DESIGNED else {}
)
JUDGED = {own: names for own, names in JUDGED.items() if names}
RESULTS += expand("results/design/{name}{own}.nc", name=["gas_spectra", "reflection", "trust"], own=JUDGED)
RESULTS += ["results/design/band_design.nc"] if DESIGNED else []
RESULTS += expand("results/design/trust_{condition}.md", condition=COMPUTED if DESIGNED else [])
DESIGN = {name: value for name, value in config["design"].items() if name not in ("reflection", "trust")}


rule gas_spectra:
    input:
        sightlines=of_set("results/sightline/{condition}.nc", COMPUTED),
        flows=of_set("results/flow/{condition}.nc", COMPUTED),
    output:
        "results/design/gas_spectra{own}.nc",
    params:
        conditions=lambda wildcards: JUDGED[wildcards.own],
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
    params:
        design=DESIGN,
        air_path_mm=AIR_PATH_MM,
        silicon_table=config["instrument"]["response"]["silicon_table"],
    script:
        "../scripts/band_design.py"


rule reflection_map:
    input:
        gas_signal="results/analysis/gas_signal{own}.nc",
        gas_spectra="results/design/gas_spectra{own}.nc",
        response="results/instrument/response.nc",
        ratio_curve="results/instrument/ratio_curve.nc",
    output:
        "results/design/reflection{own}.nc",
    params:
        **config["design"]["reflection"],
        object_temperature_k=config["analysis"]["error_temperature_k"],
        error_level=config["analysis"]["error_level"],
    script:
        "../scripts/reflection_map.py"


rule trust:
    input:
        spectra="results/design/gas_spectra{own}.nc",
        designs="results/design/band_design.nc",
        response="results/instrument/response.nc",
    output:
        "results/design/trust{own}.nc",
    params:
        design=config["design"],
        air_path_mm=AIR_PATH_MM,
        silicon_table=config["instrument"]["response"]["silicon_table"],
    script:
        "../scripts/trust.py"


# One job for all pages, because opening a Python takes longer than writing one.
rule trust_pages:
    input:
        tables=expand("results/design/trust{own}.nc", own=JUDGED),
    output:
        expand("results/design/trust_{condition}.md", condition=COMPUTED),
    params:
        conditions=COMPUTED,
        table=[list(JUDGED).index(own) for name in COMPUTED for own, names in JUDGED.items() if name in names],
    script:
        "../scripts/trust_pages.py"
