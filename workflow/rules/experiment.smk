def test_file(wildcards):
    return f"{TESTS[wildcards.test]['data_folder']}/test.nc"


def spectrometer_calibration_of(wildcards):
    calibrated = TESTS[wildcards.test]["calibrated_spectra"]
    return [] if calibrated else "results/instrument/spectrometer_calibration.nc"


rule pyrometer_correction:
    input:
        test=test_file,
        calibration="results/instrument/calibration.nc",
    output:
        "results/experiment/{test}/pyrometer_correction.nc",
    log:
        "results/logs/pyrometer_correction_{test}.log",
    benchmark:
        "results/benchmarks/pyrometer_correction_{test}.tsv"
    params:
        **config["experiment"]["pyrometer"],
    script:
        "../scripts/pyrometer_correction.py"


rule spectrometer_correction:
    input:
        test=test_file,
        calibration=spectrometer_calibration_of,
    output:
        "results/experiment/{test}/spectrometer_correction.nc",
    log:
        "results/logs/spectrometer_correction_{test}.log",
    benchmark:
        "results/benchmarks/spectrometer_correction_{test}.tsv"
    params:
        **config["experiment"]["spectrometer"],
    script:
        "../scripts/spectrometer_correction.py"
