from types import SimpleNamespace

# What the simulation of each test gets wrong; results/diagnosis/{test}/index.html is the page to read.
RESULTS += expand(
    "results/diagnosis/{test}/{name}",
    test=TESTS,
    name=["diagnosis.json", "residual_map.nc", "temperature.nc", "index.html"],
)


def tests_condition(wildcards):
    """The simulation that a test is compared with."""
    return TESTS[wildcards.test].get("twin", {}).get("condition") or config["diagnosis"]["condition"]


rule gas_variations:
    input:
        sightline="results/sightline/{condition}.nc",
        view="results/surface_view/{condition}.nc",
        radiation="results/radiation/{condition}.nc",
    output:
        "results/radiation_variations/{condition}.nc",
    log:
        "results/logs/gas_variations_{condition}.log",
    benchmark:
        "results/benchmarks/gas_variations_{condition}.tsv"
    params:
        pressure_pa=lambda wildcards: CONDITIONS[wildcards.condition]["chamber_pressure_mbar"] * 100,
        boundary_layer_depth_mm=config["diagnosis"]["boundary_layer_depth_mm"],
    script:
        "../scripts/gas_variations.py"


def other_tests(wildcards):
    """Tests at other conditions: what is named in one is tried on them."""
    mine = tests_condition(wildcards)
    return [
        test_file(SimpleNamespace(test=other))
        for other in TESTS
        if tests_condition(SimpleNamespace(test=other)) != mine
    ]


rule diagnosis:
    input:
        test=test_file,
        others=other_tests,
        radiation=expand("results/radiation/{condition}.nc", condition=CONDITIONS),
        variations=lambda wildcards: f"results/radiation_variations/{tests_condition(wildcards)}.nc",
        response="results/instrument/response.nc",
        calibration="results/instrument/calibration.nc",
        spectrometer_calibration="results/instrument/spectrometer_calibration.nc",
    output:
        report="results/diagnosis/{test}/diagnosis.json",
        residual_map="results/diagnosis/{test}/residual_map.nc",
        temperature="results/diagnosis/{test}/temperature.nc",
        page="results/diagnosis/{test}/index.html",
    log:
        "results/logs/diagnosis_{test}.log",
    benchmark:
        "results/benchmarks/diagnosis_{test}.tsv"
    params:
        draws=config["diagnosis"]["draws"],
        seed=config["diagnosis"]["seed"],
        without=config["diagnosis"]["without"],
        powers={name: one["numerical_power_kw"] * 1e3 for name, one in CONDITIONS.items()},
    script:
        "../scripts/diagnosis.py"


# Simulations as weak as the efficiency of the published experiment implies (published.EFFICIENCY); the first is taken.
EFFICIENCY_KW = (56, 64)
WEAK = [
    name
    for name, case in CONDITIONS.items()
    if EFFICIENCY_KW[0] <= case["numerical_power_kw"] <= EFFICIENCY_KW[1]
]
if WEAK and len(CONDITIONS) > 2:
    RESULTS += ["results/diagnosis/published_experiment.md"]


rule published_experiment:
    input:
        radiation=expand("results/radiation/{condition}.nc", condition=CONDITIONS),
        variations=[f"results/radiation_variations/{condition}.nc" for condition in WEAK[:1]],
        response="results/instrument/response.nc",
        ratio_curve="results/instrument/ratio_curve.nc",
    output:
        "results/diagnosis/published_experiment.md",
    log:
        "results/logs/published_experiment.log",
    benchmark:
        "results/benchmarks/published_experiment.tsv"
    localrule: True
    params:
        condition=WEAK[:1],
        powers={name: one["numerical_power_kw"] * 1e3 for name, one in CONDITIONS.items()},
        emittance=[CONDITIONS[condition]["emittance"] for condition in WEAK[:1]],
    script:
        "../scripts/published_experiment.py"
