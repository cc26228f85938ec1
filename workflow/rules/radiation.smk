RESULTS += expand("results/radiation/{condition}.nc", condition=CONDITIONS)
# What a particle emits depends on temperature alone, widths on the mixture and its pressure: conditions share tables.
# Gases with traces, with levels at temperatures of their own, and of other programs are computed line by line.
TABLE_OF = {
    name: f"{gas_key(*GAS_OF[name])}_{CONDITIONS[name]['chamber_pressure_mbar']:g}mbar"
    for name in COMPUTED
    if not GAS_OF[name][1] and not CHANGES.get(name)
}


def table_of(wildcards):
    """Input function: the emission table of the gas of a condition, if it has one."""
    mixture = TABLE_OF.get(wildcards.condition)
    return f"results/emission_table/{mixture}.nc" if mixture else []


def of_table(read):
    """Value of `read(condition)` of the conditions of a table."""
    return lambda wildcards: next(read(name) for name, one in TABLE_OF.items() if one == wildcards.mixture)


rule emission_table:
    output:
        "results/emission_table/{mixture}.nc",
    wildcard_constraints:
        mixture=one_of(TABLE_OF.values()),
    params:
        wavelength_nm=config["radiation"]["wavelength_nm"],
        grid_points=config["radiation"]["grid_points"],
        pressure_mbar=of_table(lambda name: CONDITIONS[name]["chamber_pressure_mbar"]),
        nitrogen=of_table(lambda name: GAS_OF[name][0]),
    script:
        "../scripts/emission_table.py"


rule radiance:
    input:
        sightline="results/sightline/{condition}.nc",
        response="results/instrument/response.nc",
        emission_table=table_of,
    output:
        "results/radiation/{condition}.nc",
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
    params:
        **config["radiation"],
    script:
        "../scripts/reflected_radiance.py"
