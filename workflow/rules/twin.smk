# The synthetic twin: files as a laboratory would hand them over, made by code that shares nothing with the package.
if not BANDS:
    RESULTS += [config["instrument"]["calibration_points"], config["instrument"]["spectrometer_counts"]]
RESULTS += [
    f"results/twin/{test}/{name}.nc"
    for test, settings in TESTS.items()
    if "twin" in settings
    for name in ["test", "truth"]
]


rule twin_calibration:
    input:
        response="results/instrument/response.nc",
    output:
        points="results/twin/calibration_points.nc",
        counts="results/twin/spectrometer_counts.nc",
    params:
        seed=config["twin"]["seed"],
    script:
        "../scripts/twin_calibration.py"


def beside(test):
    """The simulations nearest in power to the true gas of a test, if its power is what is hidden."""
    told, (own, *_) = TESTS[test]["twin"], TESTS[test]["twin"]["gas"]
    if not any(one["effect"] == "power" for one in told.get("effects", [])):
        return []
    # What is true of a test of the paper's does not depend on the conditions that a user adds.
    known = {name: CONDITIONS[name] for name in (PAPER if own in PAPER else CONDITIONS)}
    rungs = configuration.ladder(known, own)
    at = rungs.index(own)
    return [*rungs[max(at - 1, 0) : at], *rungs[at + 1 : at + 2]]


rule twin_test:
    input:
        response="results/instrument/response.nc",
        gas=lambda wildcards: expand(
            "results/radiation/{condition}.nc",
            condition=TESTS[wildcards.test]["twin"]["gas"],
        ),
        # Effects on the gas follow from its profile along the sight line and its composition; what a matt
        # surface scatters comes from all of the flow.
        # The power that is hidden lies between the simulated ones.
        beside=lambda wildcards: expand("results/radiation/{condition}.nc", condition=beside(wildcards.test)),
        profile=lambda wildcards: (
            [
                f"results/sightline/{next(iter(TESTS[wildcards.test]['twin']['gas']))}.nc",
                "results/gas/air11.nc",
            ]
            + [
                f"results/flow/{next(iter(TESTS[wildcards.test]['twin']['gas']))}.nc"
                for one in TESTS[wildcards.test]["twin"]["effects"]
                if one["effect"] == "refl" and one.get("shape", {}).get("diffuse") != 0
            ][:1]
            if TESTS[wildcards.test]["twin"].get("effects")
            else []
        ),
    output:
        test="results/twin/{test}/test.nc",
        truth="results/twin/{test}/truth.nc",
    params:
        condition=lambda wildcards: TESTS[wildcards.test]["twin"]["condition"],
        effects=lambda wildcards: TESTS[wildcards.test]["twin"].get("effects", []),
        electric_power_kw=lambda wildcards: TESTS[wildcards.test]["twin"].get("electric_power_kw", 160),
        pyrometer_period_s=config["twin"]["pyrometer_period_s"],
        spectrometer_period_s=config["twin"]["spectrometer_period_s"],
        weights=lambda wildcards: list(TESTS[wildcards.test]["twin"]["gas"].values()),
        seed=lambda wildcards: TESTS[wildcards.test]["twin"].get("seed", config["twin"]["seed"]),
    script:
        "../scripts/twin_test.py"
