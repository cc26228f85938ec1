# Each rule draws one family of figures from the netCDF of the stages that it shows.
FORMATS = ["svg", "png"]
TEST_FIGURES = {  # by the instruments that they need
    ("pyrometer",): [
        "fig8b_sample_emittance",
        "fig9a_signals",
        "fig9b_temperatures",
        "fig9c_error",
        "joint_estimate",
    ],
    ("spectrometer",): ["fig10a_reference_spectrum", "fig10b_normalised_spectra"],
    ("pyrometer", "spectrometer"): ["fig10c_two_instruments"],
}


def drawn(name):
    return expand("results/figures/{name}.{format}", name=name, format=FORMATS)


def drawn_of_test(name):
    return drawn(f"{name}_{{test}}")


FIGURES = [
    *drawn(
        [
            "fig2a_responses",
            "fig2b_calibration",
            "fig3b_spectrometer_factor",
            "fig4b_line_of_sight",
            "fig5_spectral_radiance",
            "fig6a_visibility_factors",
            "fig6b_visibility_limits",
            "fig7a_apparent_temperature",
            "fig7b_relative_error",
            "fig7c_error_map",
            "fig7d_transient",
        ]
    ),
    *drawn(
        [
            "fig4a_temperature_field",
            "flow_convergence",
            "flow_balances",
            "design_bands",
            "design_trade_off",
            "design_error_maps",
            "design_shelf",
            "reflecting_samples",
            "trust",
            *[f"flow_{condition}" for condition in COMPUTED],
        ]
        if COMPUTED
        else []
    ),
    *[
        f"results/figures/{name}_{test}.{format}"
        for test, settings in TESTS.items()
        for needed, names in TEST_FIGURES.items()
        if set(needed) <= set(settings["instruments"])
        for name in names
        for format in FORMATS
    ],
]


rule figures_instrument:
    input:
        response="results/instrument/response.nc",
        calibration="results/instrument/calibration.nc",
        spectrometer="results/instrument/spectrometer_calibration.nc",
    output:
        responses=drawn("fig2a_responses"),
        calibration=drawn("fig2b_calibration"),
        spectrometer_factor=drawn("fig3b_spectrometer_factor"),
    log:
        "results/logs/figures_instrument.log",
    benchmark:
        "results/benchmarks/figures_instrument.tsv"
    script:
        "../scripts/figures_instrument.py"


rule figures_flow:
    input:
        flows=expand("results/flow/{condition}.nc", condition=COMPUTED),
        sightlines=expand("results/sightline/{condition}.nc", condition=COMPUTED),
    output:
        temperature_field=drawn("fig4a_temperature_field"),
        convergence=drawn("flow_convergence"),
        balances=drawn("flow_balances"),
        fields=drawn([f"flow_{condition}" for condition in COMPUTED]),
    log:
        "results/logs/figures_flow.log",
    benchmark:
        "results/benchmarks/figures_flow.tsv"
    params:
        conditions=COMPUTED,
        field_condition=config["figures"]["field_condition"],
        numerical_power_kw=[CONDITIONS[name]["numerical_power_kw"] for name in COMPUTED],
        formats=len(FORMATS),
    script:
        "../scripts/figures_flow.py"


rule figures_sightline:
    input:
        sightlines=expand("results/sightline/{condition}.nc", condition=CONDITIONS),
    output:
        line_of_sight=drawn("fig4b_line_of_sight"),
    log:
        "results/logs/figures_sightline.log",
    benchmark:
        "results/benchmarks/figures_sightline.tsv"
    params:
        conditions=list(CONDITIONS),
        numerical_power_kw=[case["numerical_power_kw"] for case in CONDITIONS.values()],
    script:
        "../scripts/figures_sightline.py"


rule figures_radiation:
    input:
        radiation=expand("results/radiation/{condition}.nc", condition=CONDITIONS),
        surface="results/analysis/surface_radiance.nc",
        response="results/instrument/response.nc",
    output:
        spectral_radiance=drawn("fig5_spectral_radiance"),
    log:
        "results/logs/figures_radiation.log",
    benchmark:
        "results/benchmarks/figures_radiation.tsv"
    params:
        conditions=list(CONDITIONS),
        numerical_power_kw=[case["numerical_power_kw"] for case in CONDITIONS.values()],
    script:
        "../scripts/figures_radiation.py"


rule figures_analysis:
    input:
        visibility="results/analysis/visibility.nc",
        apparent_temperature="results/analysis/apparent_temperature.nc",
        error_map="results/analysis/error_map.nc",
        transient="results/analysis/transient.nc",
    output:
        visibility_factors=drawn("fig6a_visibility_factors"),
        visibility_limits=drawn("fig6b_visibility_limits"),
        apparent_temperature=drawn("fig7a_apparent_temperature"),
        relative_error=drawn("fig7b_relative_error"),
        error_map=drawn("fig7c_error_map"),
        transient=drawn("fig7d_transient"),
    log:
        "results/logs/figures_analysis.log",
    benchmark:
        "results/benchmarks/figures_analysis.tsv"
    script:
        "../scripts/figures_analysis.py"


rule figures_pyrometer:
    input:
        test=test_file,
        correction="results/experiment/{test}/pyrometer_correction.nc",
    output:
        sample_emittance=drawn_of_test("fig8b_sample_emittance"),
        signals=drawn_of_test("fig9a_signals"),
        temperatures=drawn_of_test("fig9b_temperatures"),
        error=drawn_of_test("fig9c_error"),
    log:
        "results/logs/figures_pyrometer_{test}.log",
    benchmark:
        "results/benchmarks/figures_pyrometer_{test}.tsv"
    script:
        "../scripts/figures_pyrometer.py"


rule figures_spectrometer:
    input:
        spectrometer="results/experiment/{test}/spectrometer_correction.nc",
        radiation=expand("results/radiation/{condition}.nc", condition=config["experiment"]["compare_with"]),
    output:
        reference_spectrum=drawn_of_test("fig10a_reference_spectrum"),
        normalised_spectra=drawn_of_test("fig10b_normalised_spectra"),
    log:
        "results/logs/figures_spectrometer_{test}.log",
    benchmark:
        "results/benchmarks/figures_spectrometer_{test}.tsv"
    params:
        conditions=config["experiment"]["compare_with"],
        numerical_power_kw=[
            CONDITIONS[name]["numerical_power_kw"] for name in config["experiment"]["compare_with"]
        ],
        spectrum_times_s=config["figures"]["spectrum_times_s"],
    script:
        "../scripts/figures_spectrometer.py"


rule figures_both:
    input:
        pyrometer="results/experiment/{test}/pyrometer_correction.nc",
        spectrometer="results/experiment/{test}/spectrometer_correction.nc",
    output:
        two_instruments=drawn_of_test("fig10c_two_instruments"),
    log:
        "results/logs/figures_both_{test}.log",
    benchmark:
        "results/benchmarks/figures_both_{test}.tsv"
    script:
        "../scripts/figures_both.py"


rule figures_design:
    input:
        spectra="results/design/gas_spectra.nc",
        designs="results/design/band_design.nc",
        surface="results/analysis/surface_radiance.nc",
        reflection="results/design/reflection.nc",
        trust="results/design/trust.nc",
    output:
        bands=drawn("design_bands"),
        trade_off=drawn("design_trade_off"),
        error_maps=drawn("design_error_maps"),
        shelf=drawn("design_shelf"),
        reflecting_samples=drawn("reflecting_samples"),
        trust=drawn("trust"),
    log:
        "results/logs/figures_design.log",
    benchmark:
        "results/benchmarks/figures_design.tsv"
    params:
        field_condition=config["figures"]["field_condition"],
        shown=COMPUTED[:: max(1, len(COMPUTED) // 3)],
    script:
        "../scripts/figures_design.py"


rule figures_joint:
    input:
        correction="results/experiment/{test}/pyrometer_correction.nc",
        joint="results/experiment/{test}/joint_estimate.nc",
    output:
        joint_estimate=drawn_of_test("joint_estimate"),
    log:
        "results/logs/figures_joint_{test}.log",
    benchmark:
        "results/benchmarks/figures_joint_{test}.tsv"
    script:
        "../scripts/figures_joint.py"
