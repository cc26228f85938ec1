RESULTS += expand(
    "results/analysis/{name}{own}.nc",
    name=["gas_signal", "visibility", "apparent_temperature", "error_map", "transient"],
    own=SETS,
)
RESULTS += ["results/analysis/surface_radiance.nc"]


rule gas_signal:
    input:
        radiation=of_set("results/radiation/{condition}.nc"),
    output:
        "results/analysis/gas_signal{own}.nc",
    params:
        conditions=lambda wildcards: SETS[wildcards.own],
        emittance=lambda wildcards: [CONDITIONS[name]["emittance"] for name in SETS[wildcards.own]],
    script:
        "../scripts/gas_signal.py"


rule visibility:
    input:
        gas_signal="results/analysis/gas_signal{own}.nc",
        response="results/instrument/response.nc",
    output:
        "results/analysis/visibility{own}.nc",
    params:
        object_temperature_k=config["analysis"]["visibility_temperature_k"],
        visibility_level=config["analysis"]["visibility_level"],
    script:
        "../scripts/visibility.py"


rule apparent_temperature:
    input:
        gas_signal="results/analysis/gas_signal{own}.nc",
        response="results/instrument/response.nc",
        ratio_curve="results/instrument/ratio_curve.nc",
    output:
        "results/analysis/apparent_temperature{own}.nc",
    params:
        object_temperature_k=config["analysis"]["apparent_temperature_k"],
    script:
        "../scripts/apparent_temperature.py"


rule error_map:
    input:
        gas_signal="results/analysis/gas_signal{own}.nc",
        response="results/instrument/response.nc",
        ratio_curve="results/instrument/ratio_curve.nc",
    output:
        "results/analysis/error_map{own}.nc",
    params:
        object_temperature_k=config["analysis"]["error_temperature_k"],
        emittance=config["analysis"]["error_emittance"],
        error_level=config["analysis"]["error_level"],
    script:
        "../scripts/error_map.py"


HEATING = config["analysis"]["transient"]


rule transient:
    input:
        gas_signal="results/analysis/gas_signal{own}.nc",
        response="results/instrument/response.nc",
        ratio_curve="results/instrument/ratio_curve.nc",
    output:
        "results/analysis/transient{own}.nc",
    params:
        **{key: value for key, value in HEATING.items() if key != "conditions"},
        conditions=lambda wildcards: OWN if wildcards.own else HEATING["conditions"],
    script:
        "../scripts/transient.py"


rule surface_radiance:
    output:
        "results/analysis/surface_radiance.nc",
    params:
        object_temperature_k=config["figures"]["surface_temperature_k"],
        emittance=config["figures"]["surface_emittance"],
        wavelength_nm=config["radiation"]["wavelength_nm"],
    script:
        "../scripts/surface_radiance.py"


# Logs of nothing but the temperature that a pyrometer displayed.
READINGS = config.get("readings", {})
RESULTS += expand("results/reading/{reading}.nc", reading=READINGS)


def gas_signal_of(wildcards):
    own = READINGS[wildcards.reading]["condition"] in OWN
    return f"results/analysis/gas_signal{'_own' if own else ''}.nc"


rule corrected_reading:
    input:
        display=lambda wildcards: READINGS[wildcards.reading]["file"],
        gas_signal=gas_signal_of,
        response="results/instrument/response.nc",
        ratio_curve="results/instrument/ratio_curve.nc",
    output:
        "results/reading/{reading}.nc",
    wildcard_constraints:
        reading=one_of(READINGS),
    params:
        settings=lambda wildcards: {
            key: value for key, value in READINGS[wildcards.reading].items() if key != "file"
        },
    script:
        "../scripts/corrected_reading.py"
