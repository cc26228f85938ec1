# One table per gas of the conditions; the names of the files say which.
def gas_key(nitrogen, argon=0.0):
    name = "air11" if nitrogen == AIR["N2"] else gas_name(nitrogen).split()[0].replace(":", "_")
    return f"{name}_Ar_{argon:g}" if argon else name


GAS_OF = {
    name: (
        CONDITIONS[name].get("nitrogen_mole_fraction", AIR["N2"]),
        CONDITIONS[name].get("argon_mole_fraction", 0.0),
    )
    for name in COMPUTED
}
GASES = {gas_key(*gas): gas for gas in [(AIR["N2"], 0.0), *GAS_OF.values()]}
RESULTS += expand("results/gas/{gas}.nc", gas=GASES)


rule gas_table:
    output:
        "results/gas/{gas}.nc",
    wildcard_constraints:
        gas=one_of(GASES),
    params:
        **config["gas"],
        nitrogen_mole_fraction=lambda wildcards: GASES[wildcards.gas][0],
        argon_mole_fraction=lambda wildcards: GASES[wildcards.gas][1],
    script:
        "../scripts/gas_table.py"


# Only for flows that lose heat by radiation.
rule net_emission:
    input:
        gas="results/gas/{gas}.nc",
    output:
        "results/gas/emission/{gas}.nc",
    params:
        absorption_radius_mm=config["flow"]["absorption_radius_mm"],
    script:
        "../scripts/net_emission.py"
