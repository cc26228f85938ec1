from plasmapyro.readers.stage import sources as raw_files

# What calibrates the bands of a test: the two-colour pyrometer's, or those of an instrument of any bands.
CALIBRATION = "radiometer_calibration" if BANDS else "calibration"
RESULTS += expand(
    "results/instrument/{name}.nc",
    name=["response", "ratio_curve", *([] if BANDS else ["calibration", "spectrometer_calibration"])],
)

POINTS = config["instrument"]["calibration_points"]
EXPOSURES = config["instrument"]["spectrometer_counts"]


rule response:
    input:
        bands=[config["instrument"]["bands"]] if "bands" in config["instrument"] else [],
    output:
        "results/instrument/response.nc",
    params:
        **config["instrument"]["response"],
    script:
        "../scripts/response.py"


rule ratio_curve:
    input:
        response="results/instrument/response.nc",
    output:
        "results/instrument/ratio_curve.nc",
    params:
        **config["instrument"]["ratio_curve"],
    script:
        "../scripts/ratio_curve.py"


# Only for a folder of raw files, which calibration.yaml describes.
rule read_points:
    input:
        lambda wildcards: raw_files(POINTS),
    output:
        "results/instrument/calibration_points.nc",
    localrule: True
    params:
        folder=POINTS,
    script:
        "../scripts/read_points.py"


rule calibration:
    input:
        response="results/instrument/response.nc",
        calibration_points=POINTS if POINTS.endswith(".nc") else "results/instrument/calibration_points.nc",
    output:
        "results/instrument/calibration.nc",
    params:
        **config["instrument"]["calibration"],
    script:
        "../scripts/calibration.py"


rule radiometer_calibration:
    input:
        lambda wildcards: raw_files(POINTS),
    output:
        "results/instrument/radiometer_calibration.nc",
    localrule: True
    params:
        folder=POINTS,
        source_temperature_uncertainty_k=config["instrument"]["calibration"][
            "source_temperature_uncertainty_k"
        ],
    script:
        "../scripts/radiometer_calibration.py"


if EXPOSURES.endswith(".nc"):

    rule spectrometer_calibration:
        input:
            spectrometer_counts=EXPOSURES,
        output:
            "results/instrument/spectrometer_calibration.nc",
        params:
            **config["instrument"]["spectrometer"],
        script:
            "../scripts/spectrometer_calibration.py"

else:

    # A folder of raw files, which calibration.yaml describes.
    rule read_exposures:
        input:
            raw_files(EXPOSURES),
        output:
            "results/instrument/spectrometer_exposures.nc",
        localrule: True
        params:
            folder=EXPOSURES,
        script:
            "../scripts/read_exposures.py"

    rule spectrometer_calibration:
        input:
            spectrometer_exposures="results/instrument/spectrometer_exposures.nc",
        output:
            "results/instrument/spectrometer_calibration.nc",
        params:  # the folder states the uncertainty of its own source
            **{
                name: value
                for name, value in config["instrument"]["spectrometer"].items()
                if name != "source_temperature_uncertainty_k"
            },
        script:
            "../scripts/exposure_calibration.py"
