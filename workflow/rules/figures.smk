# Each rule draws one family of figures from the netCDF of the stages that it shows.
FORMATS = ["svg", "png"]
TEST_FIGURES = {  # by the instruments that they need
    ("pyrometer",): [
        "fig9b_sample_emittance",
        "fig10a_signals",
        "fig10b_temperatures",
        "fig10c_error",
        "joint_estimate",
    ],
    ("spectrometer",): ["fig11a_reference_spectrum", "fig11b_normalised_spectra"],
    ("pyrometer", "spectrometer"): ["fig11c_two_instruments"],
}


def drawn(name):
    return expand("results/figures/{name}.{format}", name=name, format=FORMATS)


def drawn_of_test(name):
    return drawn(f"{name}_{{test}}")


def drawn_of_set(name):
    return drawn(f"{name}{{own}}")


OF_SET = [  # of the conditions of the paper, and again of the user's own
    "fig5b_line_of_sight",
    "fig6_spectral_radiance",
    "fig7a_visibility_factors",
    "fig7b_visibility_limits",
    "fig8a_apparent_temperature",
    "fig8b_relative_error",
    "fig8c_error_map",
    "fig8d_transient",
]
FIGURES = [
    *drawn(["fig3a_responses", *([] if BANDS else ["fig3b_calibration", "fig4b_spectrometer_factor"])]),
    *drawn([f"{name}{own}" for own in SETS for name in OF_SET]),
    *drawn(
        [
            f"{name}{own}"
            for own, names in SETS.items()
            if set(names) & set(COMPUTED)
            for name in ("flow_convergence", "flow_balances")
        ]
    ),
    *drawn(
        ["fig5a_temperature_field", "flow_budgets", *[f"flow_{name}" for name in COMPUTED]]
        if COMPUTED
        else []
    ),
    *drawn(
        [
            "design_bands",
            "design_trade_off",
            "design_error_maps",
            "design_shelf",
            "reflecting_samples",
            "trust",
        ]
        if DESIGNED
        else []
    ),
    *[
        f"results/figures/{name}_{test}.{format}"
        for test in WORKED
        for needed, names in TEST_FIGURES.items()
        if set(needed) <= set(TESTS[test]["instruments"])
        for name in names
        for format in FORMATS
    ],
]


rule figures_instrument:
    input:
        response="results/instrument/response.nc",
    output:
        responses=drawn("fig3a_responses"),
    script:
        "../scripts/figures_instrument.py"


rule figures_calibration:
    input:
        calibration="results/instrument/calibration.nc",
        spectrometer="results/instrument/spectrometer_calibration.nc",
    output:
        calibration=drawn("fig3b_calibration"),
        spectrometer_factor=drawn("fig4b_spectrometer_factor"),
    script:
        "../scripts/figures_calibration.py"


rule figures_fields:
    input:
        flows=expand("results/flow/{condition}.nc", condition=COMPUTED),
        sightlines=expand("results/sightline/{condition}.nc", condition=COMPUTED),
        gas=f"results/gas/{gas_key(*GAS_OF.get(config['figures']['field_condition'], (AIR['N2'],)))}.nc",
    output:
        temperature_field=drawn("fig5a_temperature_field"),
        budgets=drawn("flow_budgets"),
        fields=drawn([f"flow_{condition}" for condition in COMPUTED]),
    params:
        conditions=COMPUTED,
        field_condition=config["figures"]["field_condition"],
        formats=len(FORMATS),
    script:
        "../scripts/figures_fields.py"


rule figures_flow:
    input:
        flows=of_set("results/flow/{condition}.nc", COMPUTED),
    output:
        convergence=drawn_of_set("flow_convergence"),
        balances=drawn_of_set("flow_balances"),
    script:
        "../scripts/figures_flow.py"


rule figures_analysis:
    input:
        sightlines=of_set("results/sightline/{condition}.nc"),
        radiation=of_set("results/radiation/{condition}.nc"),
        surface="results/analysis/surface_radiance.nc",
        response="results/instrument/response.nc",
        visibility="results/analysis/visibility{own}.nc",
        apparent_temperature="results/analysis/apparent_temperature{own}.nc",
        error_map="results/analysis/error_map{own}.nc",
        transient="results/analysis/transient{own}.nc",
    output:
        line_of_sight=drawn_of_set("fig5b_line_of_sight"),
        spectral_radiance=drawn_of_set("fig6_spectral_radiance"),
        visibility_factors=drawn_of_set("fig7a_visibility_factors"),
        visibility_limits=drawn_of_set("fig7b_visibility_limits"),
        apparent_temperature=drawn_of_set("fig8a_apparent_temperature"),
        relative_error=drawn_of_set("fig8b_relative_error"),
        error_map=drawn_of_set("fig8c_error_map"),
        transient=drawn_of_set("fig8d_transient"),
    script:
        "../scripts/figures_analysis.py"


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
    params:
        field_condition=config["figures"]["field_condition"],
        shown=DESIGNED[:: max(1, len(DESIGNED) // 3)],
    script:
        "../scripts/figures_design.py"


def corrections_of(instruments):
    return {one: f"results/experiment/{{test}}/{one}_correction.nc" for one in instruments}


DRAWN = {test: tuple(sorted(set(TESTS[test]["instruments"]) - {"radiometer"})) for test in WORKED}


# One rule for each set of instruments that a test may have.
for instruments in sorted(set(DRAWN.values()) - {()}):
    OF_TEST = [
        name for needed, names in TEST_FIGURES.items() if set(needed) <= set(instruments) for name in names
    ]

    rule:
        name:
            f"figures_{'_'.join(instruments)}"
        input:
            **corrections_of(instruments),
            **({"joint": "results/experiment/{test}/joint_estimate.nc"} if "pyrometer" in instruments else {}),
            test=test_file,
            radiation=expand(
                "results/radiation/{condition}.nc", condition=config["experiment"]["compare_with"]
            ),
        output:
            **{name: drawn_of_test(name) for name in OF_TEST},
        wildcard_constraints:
            test=one_of([test for test in WORKED if DRAWN[test] == instruments]),
        localrule: True
        params:
            spectrum_times_s=config["figures"]["spectrum_times_s"],
        script:
            "../scripts/figures_test.py"
