# What a diagnosis proposes, taken as given: base -> diagnosis -> what it changes once more, under results/extended.
# The graph has no circle, because nothing under results/ but that folder reads the proposal. Effects of a test act
# on that test; those of the gas, found in the first test, on the simulation that every test is compared with.
# One page needs both instruments, and a simulated flow behind the gas.
BOTH = {"pyrometer", "spectrometer"}
FORETOLD = [
    test for test in COMPARED if BOTH <= set(TESTS[test]["instruments"]) and COMPARED[test] in COMPUTED
]
EXTENDED = [test for test in FORETOLD if test in WORKED] if config["diagnosis"]["extend"] else []
RESULTS += expand("results/extended/{test}/{name}", test=EXTENDED, name=["gain.md", "joint_estimate.nc"])
RESULTS += expand("results/extended/diagnosis/{test}/diagnosis.json", test=EXTENDED)


def extended_gas(wildcards):
    """The light of the gas for the model of a test: that of its own condition as extended."""
    own = COMPARED[wildcards.test]
    return [f"results/{'extended/' if name == own else ''}radiation/{name}.nc" for name in ladders(wildcards)]


EXTENDED_MODEL = MODEL | {"radiation": extended_gas}


use rule restored_test as extended_test with:
    input:
        **EXTENDED_MODEL,
        terms="results/diagnosis/{test}/terms.yaml",
        test=test_file,
    output:
        "results/extended/{test}/test.nc",


use rule pyrometer_correction as extended_pyrometer_correction with:
    input:
        test="results/extended/{test}/test.nc",
        calibration="results/instrument/calibration.nc",
        response="results/instrument/response.nc",
    output:
        "results/extended/{test}/pyrometer_correction.nc",


use rule spectrometer_correction as extended_spectrometer_correction with:
    input:
        test="results/extended/{test}/test.nc",
        spectrometer_calibration=spectrometer_calibration_of,
    output:
        "results/extended/{test}/spectrometer_correction.nc",


use rule joint_estimate as extended_joint_estimate with:
    input:
        test="results/extended/{test}/test.nc",
        calibration="results/instrument/calibration.nc",
        response="results/instrument/response.nc",
        spectrometer_calibration=spectrometer_calibration_of,
    output:
        "results/extended/{test}/joint_estimate.nc",


rule extended_flow:
    input:
        gas=of_gas("results/gas/{gas}.nc"),
        start=of_gas(start_of),
        emission=loss_of,
        terms=[f"results/diagnosis/{test}/terms.yaml" for test in EXTENDED[:1]],
        flow="results/flow/{condition}.nc",
    output:
        "results/extended/flow/{condition}.nc",
    params:
        # The error of a mesh is known from the flow that it starts from.
        **FLOW | {"error_mesh_ratio": 0},
    script:
        "../scripts/extended_flow.py"


use rule sightline as extended_sightline with:
    input:
        flow="results/extended/flow/{condition}.nc",
    output:
        "results/extended/sightline/{condition}.nc",


rule extended_radiance:
    input:
        terms=[f"results/diagnosis/{test}/terms.yaml" for test in EXTENDED[:1]],
        radiation="results/radiation/{condition}.nc",
        sightline="results/extended/sightline/{condition}.nc",
        response="results/instrument/response.nc",
    output:
        "results/extended/radiation/{condition}.nc",
    params:
        **config["radiation"],
    script:
        "../scripts/extended_radiance.py"


use rule diagnosis as extended_diagnosis with:
    input:
        **EXTENDED_MODEL,
        terms="results/diagnosis/{test}/terms.yaml",
        test=test_file,
        findings="results/experiment/{test}/findings.json",
        others=other_tests,
    output:
        report="results/extended/diagnosis/{test}/diagnosis.json",
        residual_map="results/extended/diagnosis/{test}/residual_map.nc",
        temperature="results/extended/diagnosis/{test}/temperature.nc",
        page="results/extended/diagnosis/{test}/index.html",
        terms="results/extended/diagnosis/{test}/terms.yaml",


rule extended_gain:
    input:
        reports=[
            "results/diagnosis/{test}/diagnosis.json",
            "results/extended/diagnosis/{test}/diagnosis.json",
        ],
        corrections=[
            f"results/{stage}/{{test}}/{instrument}_correction.nc"
            for stage in ("experiment", "extended")
            for instrument in ("pyrometer", "spectrometer")
        ],
        terms=f"results/diagnosis/{next(iter(EXTENDED), '')}/terms.yaml",
        tests=[usable_test(SimpleNamespace(test=test)) for test in FORETOLD],
        simulated=[f"results/radiation/{COMPARED[test]}.nc" for test in FORETOLD],
        extended=[f"results/extended/radiation/{COMPARED[test]}.nc" for test in FORETOLD],
        calibration="results/instrument/calibration.nc",
        spectrometer_calibration="results/instrument/spectrometer_calibration.nc",
        response="results/instrument/response.nc",
        ratio_curve="results/instrument/ratio_curve.nc",
    output:
        "results/extended/{test}/gain.md",
    params:
        names=FORETOLD,
        analysis=config["analysis"],
        saturation_counts=config["experiment"]["spectrometer"]["saturation_counts"],
        limits=LIMITS,
    script:
        "../scripts/extended_gain.py"
