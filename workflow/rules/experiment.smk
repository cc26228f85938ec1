from pathlib import Path

from plasmapyro.readers.stage import sources


def test_file(wildcards):
    folder = Path(TESTS[wildcards.test]["data_folder"])
    raw = (folder / "test.yaml").exists()
    return f"results/experiment/{wildcards.test}/test.nc" if raw else f"{folder}/test.nc"


# Only for a folder of raw files, which test.yaml describes.
rule read_test:
    input:
        lambda wildcards: sources(TESTS[wildcards.test]["data_folder"]),
    output:
        "results/experiment/{test}/test.nc",
    params:
        folder=lambda wildcards: TESTS[wildcards.test]["data_folder"],
    script:
        "../scripts/read_test.py"


def usable_test(wildcards):
    """The test that corrections start from: without the effects that its file takes as given."""
    given = TESTS[wildcards.test].get("effects")
    return f"results/experiment/{wildcards.test}/restored_test.nc" if given else test_file(wildcards)


def spectrometer_calibration_of(wildcards):
    calibrated = TESTS[wildcards.test]["calibrated_spectra"]
    return [] if calibrated else "results/instrument/spectrometer_calibration.nc"


rule pyrometer_correction:
    input:
        test=usable_test,
        calibration="results/instrument/calibration.nc",
        response="results/instrument/response.nc",
    output:
        "results/experiment/{test}/pyrometer_correction.nc",
    params:
        **config["experiment"]["pyrometer"],
    script:
        "../scripts/pyrometer_correction.py"


rule spectrometer_correction:
    input:
        test=usable_test,
        spectrometer_calibration=spectrometer_calibration_of,
    output:
        "results/experiment/{test}/spectrometer_correction.nc",
    params:
        **config["experiment"]["spectrometer"],
    script:
        "../scripts/spectrometer_correction.py"


rule joint_estimate:
    input:
        test=usable_test,
        calibration=[] if BANDS else "results/instrument/calibration.nc",
        response=[] if BANDS else "results/instrument/response.nc",
        spectrometer_calibration=lambda wildcards: (
            spectrometer_calibration_of(wildcards)
            if "spectrometer" in TESTS[wildcards.test]["instruments"]
            else []
        ),
        radiometer_calibration="results/instrument/radiometer_calibration.nc" if BANDS else [],
    output:
        "results/experiment/{test}/joint_estimate.nc",
    params:
        **config["experiment"]["joint_estimate"],
        instruments=lambda wildcards: TESTS[wildcards.test]["instruments"],
    script:
        "../scripts/joint_estimate.py"


# Of each test: (test, contract) of what it gives.
CORRECTIONS = [
    (test, contract)
    for test in WORKED
    for contract in [
        *[f"{one}_correction" for one in TESTS[test]["instruments"] if one != "radiometer"],
        *["joint_estimate" for one in TESTS[test]["instruments"] if one != "spectrometer"],
    ]
]
RESULTS += [f"results/experiment/{test}/{contract}.nc" for test, contract in CORRECTIONS]
RESULTS += expand("results/experiment/{test}/findings.json", test=WORKED)


rule findings:
    input:
        **{CALIBRATION: f"results/instrument/{CALIBRATION}.nc"},
        test=test_file,
        corrections=lambda wildcards: [
            f"results/experiment/{test}/{contract}.nc"
            for test, contract in CORRECTIONS
            if test == wildcards.test
        ],
        response="results/instrument/response.nc",
        spectrometer_calibration=rules.joint_estimate.input.spectrometer_calibration,
    output:
        "results/experiment/{test}/findings.json",
    params:
        folder=lambda wildcards: TESTS[wildcards.test]["data_folder"],
    script:
        "../scripts/findings.py"


RESULTS += expand("results/experiment/{test}/temperature.nc", test=WORKED)


# The one temperature to take away, with the reason and its uncertainty budget.
rule recommended_temperature:
    input:
        corrections=rules.findings.input.corrections,
        findings="results/experiment/{test}/findings.json",
    output:
        "results/experiment/{test}/temperature.nc",
    script:
        "../scripts/recommended_temperature.py"
