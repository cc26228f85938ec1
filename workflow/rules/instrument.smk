RESULTS += expand(
    "results/instrument/{name}.nc",
    name=["response", "ratio_curve", "calibration", "spectrometer_calibration"],
)


rule response:
    output:
        "results/instrument/response.nc",
    log:
        "results/logs/response.log",
    params:
        **config["instrument"]["response"],
    script:
        "../scripts/response.py"


rule ratio_curve:
    input:
        response="results/instrument/response.nc",
    output:
        "results/instrument/ratio_curve.nc",
    log:
        "results/logs/ratio_curve.log",
    params:
        **config["instrument"]["ratio_curve"],
    script:
        "../scripts/ratio_curve.py"


rule calibration:
    input:
        response="results/instrument/response.nc",
        points=config["instrument"]["calibration_points"],
    output:
        "results/instrument/calibration.nc",
    log:
        "results/logs/calibration.log",
    params:
        **config["instrument"]["calibration"],
    script:
        "../scripts/calibration.py"


rule spectrometer_calibration:
    input:
        config["instrument"]["spectrometer_counts"],
    output:
        "results/instrument/spectrometer_calibration.nc",
    log:
        "results/logs/spectrometer_calibration.log",
    params:
        **config["instrument"]["spectrometer"],
    script:
        "../scripts/spectrometer_calibration.py"
