"""Verdicts say what the numbers say; measurements of claims on curves known by construction."""

import json

import numpy as np
import pytest
import xarray as xr

from plasmapyro.claims import analysis, experiment, flow, premises
from plasmapyro.claims.claim import REGISTER, Claim, untestable_claims
from plasmapyro.claims.stage import as_markdown
from plasmapyro.tables import rows


def claim(value, low, high, **more):
    return Claim("key", "1", "words", value, "K", low, high, **more)


@pytest.mark.parametrize(
    ("value", "verdict"),
    [
        (100.0, "reproduced"),
        (90.0, "reproduced"),
        (125.0, "differs by +25 K"),
        (80.0, "differs by -10 K"),
        (np.nan, "no value here"),
    ],
)
def test_verdict_follows_from_the_range(value, verdict):
    assert claim(value, 90, 100).verdict == verdict


@pytest.mark.parametrize(("value", "verdict"), [(0.21, "+0.11"), (0.311, "+0.211"), (1.2, "+1.1")])
def test_a_number_without_unit_keeps_its_digits(value, verdict):
    assert Claim("key", "1", "words", value, "1", 0, 0.1).verdict == f"differs by {verdict}"


def test_synthetic_and_untestable_claims_say_so():
    assert claim(95.0, 90, 100, basis="synthetic").verdict == "reproduced (synthetic data)"
    assert claim(120.0, 90, 100, basis="synthetic").verdict == "differs by +20 K (synthetic data)"
    assert claim(95.0, 90, 100, basis="untestable").verdict == "not testable here"


def test_a_row_of_the_register_is_a_claim_of_its_own():
    keys = [row["key"] for row in rows("claims/claims.csv")]
    assert len(keys) == len(set(keys)) == len(REGISTER)
    assert all(one.basis == "untestable" for one in untestable_claims()) and len(untestable_claims()) == 4


def triangular_path():
    """Temperature up to 1350 K over 4 mm, then down to 350 K over 100 mm, then flat."""
    path = np.array([0.0, 4e-3, 0.104, 0.3, 1.0])
    return xr.Dataset(
        {
            "temperature": ("path_distance", [350.0, 1350.0, 350.0, 350.0, 300.0]),
            "pressure": ("path_distance", [5050.0, 5000.0, 5000.0, 5000.0, 1e5]),
        },
        {"path_distance": path},
        {"exit_distance": 0.279, "numerical_power": 5e4},
    )


def test_flow_claims_read_the_path():
    hotter = triangular_path()
    hotter["temperature"] = hotter.temperature.copy(data=[350.0, 1350.0, 360.0, 350.0, 300.0])
    hotter["temperature"][1] = 1350.5
    claims = flow.flow_claims([triangular_path(), triangular_path(), hotter])
    found = {claim.key: claim.value for claim in claims}
    assert found["boundary_layer"] == pytest.approx(4 * (0.9 * 1350 - 350) / 1000, rel=1e-12)
    assert found["core_extent"] == pytest.approx(4 + 95.0, rel=1e-12)
    assert found["core_temperature_lowest_power"] == 1350.0
    assert found["core_temperature_highest_power"] == 1350.5
    assert found["cold_outside"] == pytest.approx(360 - 10 * 46 / 196, rel=1e-12)
    assert found["domain_exit"] == pytest.approx(279.0)
    assert found["pressure_uniform"] == pytest.approx(1.0)


def by_key(claims):
    return {one.key: one.value for one in claims}


def test_radiance_claims_take_the_median_power_inside_the_band():
    wavelength = np.linspace(0.7e-6, 1.2e-6, 501)
    response = xr.Dataset(
        {"responsivity_wide": ("wavelength", ((wavelength > 0.8e-6) & (wavelength < 1.0e-6)) * 1.0)},
        {"wavelength": wavelength},
    )
    surface = xr.Dataset(
        {
            "surface_radiance": (
                ("object_temperature", "wavelength"),
                np.array([1.0, 4.0])[:, None] * np.ones(501),
            )
        },
        {"object_temperature": [1000.0, 1500.0], "wavelength": wavelength},
        {"emittance": 0.85},
    )

    def gas(edge, peak):
        radiance = np.where(wavelength < edge, 2.0, 0.5)
        radiance[300] = peak  # at 1.0 um, outside the band
        radiance[150] = peak / 10  # at 0.85 um
        spectrum = xr.Dataset({"gas_radiance_slit": ("wavelength_slit", radiance)})
        return spectrum.assign_coords(wavelength_slit=wavelength)

    cases = [gas(0.80e-6, 20.0), gas(0.85e-6, 200.0), gas(0.95e-6, 2000.0)]
    found = by_key(analysis.radiance_claims(cases, surface, response))
    assert found["gas_over_surface_1000K"] == pytest.approx(
        25, abs=1.0
    )  # 0.05 of 0.20 um, one sample is 0.5 %
    assert found["line_peaks_1500K"] == pytest.approx(20 / 4, rel=1e-12)


def test_visibility_claims_take_the_worst_case():
    factor = np.array([[[0.2, 0.95], [0.3, 0.97]], [[0.01, 0.90], [0.05, 0.92]]])
    visibility = xr.Dataset(
        {"visibility_factor": (("condition", "band", "object_temperature"), factor)},
        {"band": ["wide", "narrow"], "object_temperature": [750.0, 1500.0]},
    )
    found = by_key(analysis.visibility_claims(visibility))
    assert found["visibility_cold"] == 0.3
    assert found["visibility_hot"] == 0.90
    assert found["visibility_bands_differ"] == pytest.approx(0.1, rel=1e-12)


# Error over emittance and temperatures of which the middle two lie in the instrument's range.
MAP_TEMPERATURE = np.array([500.0, 1000.0, 2000.0, 3000.0])
MAP = np.array([[[9, np.nan, 0.02, 9], [9, -0.02, 0.01, 9], [9, 0.001, 0.002, 9]]])


def error_file(limit):
    return xr.Dataset(
        {"error_limit": (("condition", "emittance"), limit)},
        {"emittance": [0.1, 0.5, 1.0]},
        {"error_level": 0.01},
    ).assign(
        relative_error=(("case", "emittance", "object_temperature"), MAP), object_temperature=MAP_TEMPERATURE
    )


def reading_file(error, temperature=(1000.0, 1400.0, 1500.0, 1600.0)):
    return xr.Dataset(
        {
            "relative_error": (("condition", "object_temperature"), np.asarray(error)),
            "numerical_power": ("condition", 1e4 * np.arange(6, 6 + len(error))),
        },
        {"object_temperature": np.array(temperature)},
    )


def history_file(apparent, truth):
    return xr.Dataset(
        {
            "apparent_temperature": (("condition", "time"), [apparent]),
            "object_temperature_history": ("time", truth),
        },
        {"condition": ["80kW"], "time": [-1.0, 1.0, 20.0, 100.0]},
    ).assign(instrument_range=("bound", [973.0, 2073.0]))


def error_claims(limit, error=((0.2, 0.02, 0.005, 0.001),)):
    history = history_file([np.nan, 5000.0, 1200.0, 1616.0], [350.0, 360.0, 1150.0, 1600.0])
    return by_key(analysis.error_claims(reading_file(error), error_file(limit), history))


def test_error_map_claims_count_only_pairs_with_a_value():
    found = error_claims([[1400.0, 1300.0, 1200.0], [1500.0, 1250.0, np.nan]])
    assert found["error_map_ordered_by_power"] == 50
    assert found["error_map_falls_with_emittance"] == 100
    found = error_claims([[1400.0, 1300.0, 1350.0]])
    assert np.isnan(found["error_map_ordered_by_power"])
    assert found["error_map_falls_with_emittance"] == 50


def test_the_part_of_the_range_counts_no_reading_and_weighs_emittances_evenly():
    found = error_claims([[1400.0, 1300.0, 1200.0]] * 1)
    # Beyond the level: all of the range up to an emittance of 0.1, half of it at 0.5, nothing at 1.
    exact = 100 * (0.1 * 1.0 + 0.4 * 0.75 + 0.5 * 0.25)
    assert found["error_over_the_range"] == pytest.approx(exact, abs=0.3)  # steps of 0.005


def test_asymptote_is_the_ratio_of_slopes():
    found = error_claims([[3000.0, 1400.0, 1300.0]])
    assert found["error_map_asymptote"] == pytest.approx(100 * (0.4 / 1600) / (0.5 / 100), rel=1e-12)


def test_onset_of_the_error_is_its_last_crossing():
    found = error_claims([[1400.0, 1300.0, 1200.0]], [[np.nan, 0.02, 0.005, 0.001]])
    assert found["error_below_1500K"] == pytest.approx(1400 + 100 * 0.01 / 0.015, rel=1e-12)


def test_transient_claims_read_fall_turn_and_end():
    found = error_claims([[1400.0, 1300.0, 1200.0]])
    assert found["transient_falls_80kW"] == 2073 - 1200  # from the top of the range; 5000 K is not read
    assert found["transient_steady"] == pytest.approx(1150 + 450 * 60 / 80, rel=1e-12)
    assert found["transient_turns_80kW"] == 20
    assert found["transient_merges_80kW"] == pytest.approx(1.0, rel=1e-12)


def test_a_transient_without_a_reading_has_no_value():
    history = history_file([np.nan] * 4, [350.0, 360.0, 1150.0, 1600.0])
    claims = analysis.error_claims(
        reading_file([[0.2, 0.02, 0.005, 0.001]]), error_file([[3.0, 2.0, 1.0]]), history
    )
    assert np.isnan(by_key(claims)["transient_turns_80kW"])


def test_power_is_read_off_the_error_curves():
    power = np.array([60e3, 80e3, 100e3])
    reading = reading_file(1e-3 * np.exp(power / 20e3)[:, None] * np.ones(4))
    reading["numerical_power"] = ("condition", power)
    found = by_key(analysis.threshold_claims(reading))
    assert found["power_from_error_1120K"] == pytest.approx(20 * np.log(100), rel=1e-9)
    assert np.isnan(found["power_from_error_steady"])  # 0.2 % is below all powers computed


def test_thresholds_of_a_test_are_read_off_its_noise():
    temperature = np.repeat(np.arange(1000.0, 1600.0), 5)
    error = 0.01 * 10 ** ((1353 - temperature) / 200) * (1 + 0.1 * np.sin(np.arange(temperature.size)))
    found = experiment._highest_with_error_above(temperature, error, 0.01)
    assert found == pytest.approx(1353, abs=2)  # a tenth of a bin; the medians of the noise differ by 1 %


def test_the_transition_is_read_off_the_visibility_factors():
    temperature = np.array([500.0, 1000.0, 2000.0])
    factor = np.array([[[0.0, 0.2, 1.0], [0.0, 0.4, 1.0]]])  # crossings of 0.1 at 750 and 625, of 0.9 ...
    visibility = xr.Dataset(
        {"visibility_factor": (("condition", "band", "object_temperature"), factor)},
        {"band": ["wide", "narrow"], "object_temperature": temperature},
    )
    found = by_key(analysis.visibility_claims(visibility))
    assert found["transition_begins"] == pytest.approx((750 + 625) / 2, rel=1e-12)
    assert found["transition_ends"] == pytest.approx((1875 + 1000 + 500 / 0.6) / 2, rel=1e-12)
    assert found["interference_up_to"] == pytest.approx(1000 + 1000 * 0.79 / 0.8, rel=1e-12)


def premise_files():
    """A gas of a nitrogen band and a line, on an axis of three wavelengths of which the band sees two."""
    axis = np.array([0.7e-6, 0.9e-6, 1.0e-6])
    response = xr.Dataset(
        {"responsivity_wide": ("wavelength", [0.0, 1.0, 1.0])}, {"wavelength": [0.8e-6, 0.85e-6, 1.1e-6]}
    )
    light = np.array([[9.0, 3.0, 3.0], [9.0, 1.0, 1.0], [9.0, 5.0, 5.0]])
    spectrum = xr.Dataset(
        {
            "gas_radiance_component_slit": (("component", "wavelength_slit"), light),
            "gas_radiance_slit": ("wavelength_slit", light.sum(axis=0)),
        },
        {"wavelength_slit": axis, "component": ["N2 1P", "free-bound", "O I"]},
    )
    variations = xr.Dataset(
        {
            "added_radiance": (("addition", "wavelength_slit"), [[50.0, 0.03, 0.06]]),
            "core_radiance": (("core_change", "wavelength_slit"), [[0.0, 0, 0], [1.0, 1.0, 2.0]]),
        },
        {"addition": ["warm_wall"], "core_change": [-0.06, 0.0], "wavelength_slit": axis},
    )
    gas = xr.Dataset(
        {"viscosity": (("pressure", "temperature"), [[1e-4, 2e-4], [1e-4, 2e-4]])},
        {"pressure": [4000.0, 6000.0], "temperature": [1000.0, 2000.0]},
    )
    line = triangular_path().assign_attrs(
        chamber_pressure=5000.0, mass_flow_rate=0.016, flow_settings=json.dumps({"torch": '{"radius": 0.08}'})
    )
    line["temperature_error"] = ("path_distance", [300.0, 13.5, 300.0, 0.0, 0.0])
    return line, spectrum, variations, response, gas


def test_premises_are_read_off_the_files():
    line, spectrum, variations, response, gas = premise_files()
    found = by_key(premises.gas_claims([line] * 3, [spectrum] * 3, variations, response, gas))
    assert found["wall_temperature"] == pytest.approx(3.0, rel=1e-12)
    assert found["nitrogen_background"] == pytest.approx(75.0, rel=1e-12)
    assert found["grid_independence"] == pytest.approx(1.0, rel=1e-12)  # the edges of the jet do not count
    assert found["reynolds_number"] == pytest.approx(2 * 0.016 / (np.pi * 0.08 * 1.35e-4), rel=1e-12)
    # A black body of 350 K at 1 um in the brackets of Planck's law, in W m-2 sr-1 m-1.
    black = 2 * 6.62607015e-34 * 299792458**2 / 1e-30 / np.expm1(0.0143877688 / 1e-6 / 350)
    assert found["gas_beyond_the_domain"] == pytest.approx(100 * black / 9.0, rel=1e-6)


def test_premises_without_their_files_have_no_value():
    line, spectrum, _, response, gas = premise_files()
    line = line.drop_vars("temperature_error").assign_attrs(flow_settings="{}")
    found = by_key(
        [
            *premises.gas_claims([line], [spectrum], None, response, gas),
            *premises.reflection_claims(None),
            *premises.design_claims(None),
        ]
    )
    without = {name for name, value in found.items() if np.isnan(value)}
    assert without == {
        "wall_temperature",
        "reynolds_number",
        "grid_independence",
        "reflection_mirror",
        "reflection_matt",
        "best_wavelength",
    }


def test_reflection_is_what_a_sample_adds_at_an_emittance_of_0_8():
    surface, emittance = ["no reflection", "mirror", "matt"], [0.1, 0.8]
    error = np.array([0.01, 0.013, 0.08])[:, None, None, None, None] * np.ones((3, 1, 3, 2, 2))
    error[..., 0, :] = 5.0  # at 0.1
    error[..., 0] = 7.0  # at 1000 K
    error[2, 0, 2, 1, 1] = 3.0  # one power is far off
    reflection = xr.Dataset(
        {
            "relative_error": (
                ("surface", "correction", "condition", "emittance", "object_temperature"),
                error,
            )
        },
        {
            "surface": surface,
            "correction": ["none"],
            "emittance": emittance,
            "object_temperature": [1000.0, 1350.0],
        },
    )
    found = by_key(premises.reflection_claims(reflection))
    assert found["reflection_mirror"] == pytest.approx(0.3, rel=1e-9)
    assert found["reflection_matt"] == pytest.approx(7.0, rel=1e-9)


def test_the_best_wavelength_is_that_of_two_bands_without_a_gas():
    nan = np.nan
    designs = xr.Dataset(
        {
            "design_kind": ("design", ["optimum", "no gas", "no gas"]),
            "band_centre": (("design", "design_band"), [[9e-7, 9e-7], [8e-7, nan], [9e-7, 1.1e-6]]),
        }
    )
    assert by_key(premises.design_claims(designs))["best_wavelength"] == pytest.approx(1000.0, rel=1e-12)


def synthetic(data, coordinates, **attributes):
    return xr.Dataset(data, coordinates, {"origin": "synthetic", **attributes})


def test_calibration_claims_take_the_largest_residual_and_the_calibrated_range():
    curve = np.array([900.0, 1000.0, 1500.0, 2000.0])
    calibration = synthetic(
        {
            "sensitivity_ratio": 0.3151,
            "model_residual": ("calibration_point", [0.004, -0.009]),
            "fit_residual": ("calibration_point", [0.001, 0.001]),
            "temperature_uncertainty": ("calibration_temperature", curve * [0.9, 0.012, 0.016, 0.9]),
            "fit_range": ("bound", [973.0, 1773.0]),
        },
        {"calibration_temperature": curve},
    )
    claims = experiment.calibration_claims(calibration)
    found = by_key(claims)
    assert found["sensitivity_ratio"] == 0.3151
    assert found["calibration_residual"] == pytest.approx(0.9, rel=1e-12)
    assert found["quadratic_fit"] == pytest.approx(0.1, rel=1e-12)
    assert found["temperature_uncertainty"] == pytest.approx(1.4, rel=1e-12)
    assert all(one.basis == "synthetic" for one in claims)


def corrected_test():
    time = np.arange(-10.0, 400.0)
    temperature = np.clip(1000.0 + 6 * time, 1000.0, 1600.0)
    error = 0.2 * np.exp(-(temperature - 1000.0) / 100.0)
    error[time > 300] = 0.9  # cooling counts for nothing
    return synthetic(
        {
            "corrected_temperature": ("time", temperature),
            "relative_error": ("time", -error),
            "corrected_status": ("time", np.where((time > 0) & (time < 20), 5, 0)),
            "signal_wide": ("time", np.where(time < 0, 2.0, 1.0)),
            "signal_narrow": ("time", np.where(time < 0, 4.0, 1.0)),
        },
        {"time": time},
        plasma_off_time=300.0,
        injection_time=0.0,
    )


def test_correction_claims_read_heating_and_steady_state():
    found = by_key(experiment.correction_claims(corrected_test()))
    assert found["error_one_percent"] == pytest.approx(1000 + 100 * np.log(20), abs=5)  # a quarter of a bin
    assert found["error_ten_percent"] == pytest.approx(1000 + 100 * np.log(2), abs=5)
    assert found["error_steady"] == pytest.approx(20 * np.exp(-6), rel=1e-9)
    assert found["signals_drop"] == pytest.approx(50, rel=1e-12)
    assert found["corrected_rises"] == 100


def test_only_valid_values_tell_whether_the_temperature_rises():
    test = corrected_test()
    early = (test.time > 0) & (test.time < 20)  # dominated by the gas
    test["corrected_temperature"] = test.corrected_temperature.where(~early, 3000.0 - 20 * test.time)
    assert by_key(experiment.correction_claims(test))["corrected_rises"] == 100


def test_a_corrected_temperature_that_falls_does_not_recover_the_heating():
    test = corrected_test()
    test["corrected_temperature"] = 2000 - test.corrected_temperature
    assert by_key(experiment.correction_claims(test))["corrected_rises"] == 0


def test_spectrometer_claims_start_after_injection_and_take_the_median():
    pyrometer = corrected_test()
    time = np.array([-4.0, 10.0, 20.0, 30.0, 40.0])
    truth = np.interp(time, pyrometer.time, pyrometer.corrected_temperature)
    spectra = synthetic(
        {
            "spectrum_status": ("spectrum_time", [0, 4, 0, 0, 0]),
            "spectrometer_temperature": ("spectrum_time", truth * [1.5, 1.5, 1.01, 0.98, 1.03]),
        },
        {"spectrum_time": time},
    )
    found = by_key(experiment.spectrometer_claims(pyrometer, spectra))
    assert found["spectrometer_start"] == 20
    assert found["instruments_agree"] == pytest.approx(2.0, rel=1e-9)


def test_markdown_counts_its_verdicts():
    names = ("section", "statement", "unit", "printed", "verdict", "remark", "basis")
    rows = [
        claim(95.0, 90, 100),
        claim(125.0, 90, 100),
        claim(np.nan, 1, 2, basis="untestable"),
        claim(95.0, 90, 100, basis="synthetic"),
    ]
    table = xr.Dataset(
        {name: ("claim", [getattr(row, name) for row in rows]) for name in names}
        | {"value": ("claim", [row.value for row in rows])}
    )
    text = as_markdown(table)
    assert "From the simulation: 1 reproduced, 1 differ, 0 without a value here, 1 not testable here." in text
    assert "On synthetic data: 1 reproduced, 0 differ, 0 without a value." in text
    assert "| 1 | words | 90 to 100 K | 125 K | differs by +25 K |" in text
