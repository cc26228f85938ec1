from types import SimpleNamespace

# What the simulation of each test gets wrong; results/diagnosis/{test}/index.html is the page to read.
RESULTS += expand(
    "results/diagnosis/{test}/{name}",
    test=DIAGNOSED,
    name=["diagnosis.json", "residual_map.nc", "temperature.nc", "index.html"],
)
# Varied spectra need the light on the surface, which another program's flow gives only if it is axisymmetric.
# `plasmapyro diagnose` varies the gas of the other conditions when a test asks for it.
VIEWED = [
    condition
    for condition, case in CONDITIONS.items()
    if case.get("cfd", {}).get("geometry", "axisymmetric") == "axisymmetric"
]
VARIED = [
    condition
    for condition in dict.fromkeys([*map(COMPARED.get, DIAGNOSED), config["diagnosis"]["condition"]])
    if condition in VIEWED
]
RESULTS += expand("results/surface_view/{condition}.nc", condition=VIEWED)
RESULTS += expand("results/radiation_variations/{condition}.nc", condition=VARIED)


rule gas_variations:
    input:
        sightline="results/sightline/{condition}.nc",
        surface_view="results/surface_view/{condition}.nc",
        radiation="results/radiation/{condition}.nc",
        emission_table=table_of,
    output:
        "results/radiation_variations/{condition}.nc",
    params:
        pressure_pa=lambda wildcards: CONDITIONS[wildcards.condition]["chamber_pressure_mbar"] * 100,
        boundary_layer_depth_mm=config["diagnosis"]["boundary_layer_depth_mm"],
    script:
        "../scripts/gas_variations.py"


def other_tests(wildcards):
    """Tests at other conditions: what is named in one is tried on them."""
    mine = COMPARED[wildcards.test]
    return [usable_test(SimpleNamespace(test=other)) for other in DIAGNOSED if COMPARED[other] != mine]


# Gases that a test and those at other conditions are compared with, each with the powers beside it.
def ladders(wildcards):
    found = {COMPARED.get(wildcards.test), *map(COMPARED.get, DIAGNOSED)} - {None}
    return sorted({one for condition in found for one in configuration.ladder(CONDITIONS, condition)})


MODEL = dict(  # what the model of a test is made of, besides the test
    radiation=lambda wildcards: expand("results/radiation/{condition}.nc", condition=ladders(wildcards)),
    variations=expand("results/radiation_variations/{condition}.nc", condition=VARIED),
    response="results/instrument/response.nc",
    calibration=f"results/instrument/{CALIBRATION}.nc",
    spectrometer_calibration=(
        rules.joint_estimate.input.spectrometer_calibration
        if BANDS
        else "results/instrument/spectrometer_calibration.nc"
    ),
)
LIMITS = {  # of the paper's correction
    name: config["experiment"]["pyrometer"][name]
    for name in ["signal_uncertainty", "gas_variation", "detection_level", "least_surface_share"]
}


rule diagnosis:
    input:
        **MODEL,
        test=test_file,
        findings="results/experiment/{test}/findings.json",
        others=other_tests,
    output:
        report="results/diagnosis/{test}/diagnosis.json",
        residual_map="results/diagnosis/{test}/residual_map.nc",
        temperature="results/diagnosis/{test}/temperature.nc",
        page="results/diagnosis/{test}/index.html",
        terms="results/diagnosis/{test}/terms.yaml",
    params:
        effects=lambda wildcards: TESTS[wildcards.test].get("effects", []),
        draws=config["diagnosis"]["draws"],
        seed=config["diagnosis"]["seed"],
        without=config["diagnosis"]["without"],
        saturation_counts=config["experiment"]["spectrometer"]["saturation_counts"],
        limits=LIMITS,
    script:
        "../scripts/diagnosis.py"


# Only for a test whose file states effects: the model of the diagnosis, fitted to it, takes them out.
rule restored_test:
    input:
        **MODEL,
        test=test_file,
    output:
        "results/experiment/{test}/restored_test.nc",
    params:
        effects=lambda wildcards: TESTS[wildcards.test].get("effects", []),
        saturation_counts=config["experiment"]["spectrometer"]["saturation_counts"],
    script:
        "../scripts/restored_test.py"


# Simulations as weak as the efficiency of the published experiment implies (published.EFFICIENCY); the first is taken.
EFFICIENCY_KW = (56, 64)
WEAK = [
    name for name in PAPER if EFFICIENCY_KW[0] <= CONDITIONS[name]["numerical_power_kw"] <= EFFICIENCY_KW[1]
]
if WEAK and len(PAPER) > 2 and not BANDS:
    RESULTS += ["results/diagnosis/published_experiment.md"]


rule published_experiment:
    input:
        radiation=expand("results/radiation/{condition}.nc", condition=PAPER),
        variations=[f"results/radiation_variations/{condition}.nc" for condition in WEAK[:1]],
        response="results/instrument/response.nc",
        ratio_curve="results/instrument/ratio_curve.nc",
    output:
        "results/diagnosis/published_experiment.md",
    localrule: True
    params:
        condition=WEAK[:1],
        emittance=[CONDITIONS[condition]["emittance"] for condition in WEAK[:1]],
    script:
        "../scripts/published_experiment.py"
