"""The whole design on a made-up gas: it flees the light, falls back to 1 um without it, repeats itself."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from plasmapyro.analysis.transient import step_response
from plasmapyro.design import judge, stage, trust
from plasmapyro.design.settings import design_tables, settings_from

KEYS = {
    "detectors": ["silicon"],
    "silicon_thickness_um": 500,
    "band_counts": [1, 2],
    "shapes": ["box"],
    "width_nm": [10, 200],
    "object_temperature_k": [1200, 1600, 2000],
    "emittance": [0.5, 0.9],
    "no_gas_temperature_k": [700, 1000, 1300, 1600, 1900, 2200, 2500],
    "error_level": 0.01,
    "limit_emittance": 0.85,
    "limit_temperature_k": [700, 3000],
    "gain_tolerance": 0.17,
    "map_emittance": [0.1, 1.0, 4],
    "receiver": {
        "throughput_m2_sr": 1e-8,
        "area_mm2": 1,
        "bandwidth_hz": 50,
        "amplifier_noise_a_per_root_hz": 1e-13,
    },
    "uncertainties": {
        "signal": 0.01,
        "source_temperature_k": 3,
        "source_reference_k": 1273,
        "emittance": 0.05,
        "emittance_slope_per_um": 0.1,
        "window_slope_per_um": 0.02,
    },
    "search": {"seed": 1, "population": 8, "generations": 30},
    "brute_force": {"centre_step_nm": 50, "width_nm": [20, 100]},
    "trust": {
        "emittance_range": [0.7, 0.9],
        "levels": [0.01, 0.05],
        "gas_variation": 0.03,
        "initial_temperature_k": 350,
        "gain_k": 1250,
        "natural_frequency_per_s": 0.1,
    },
}
SETTINGS = settings_from(KEYS, 200)
TABLES = design_tables("silicon_green_2008")
SHINING = (700e-9, 950e-9)  # where the made-up gas is a thousand times brighter than beyond
NEAR_ONE_MICROMETRE = (0.85e-6, 1.15e-6)


@pytest.fixture(scope="module")
def spectra():
    edges = np.linspace(700e-9, 1200e-9, 251)
    middle = (edges[1:] + edges[:-1]) / 2
    power = np.array([60e3, 70e3, 80e3])
    shape = np.where(middle < SHINING[1], 1.0, 1e-3)
    own = (
        5e7
        * np.exp((power / 1e3 - 70) / 30)[:, None, None, None]
        * np.array([1.0, 0.8, 1.25])[None, :, None, None]
        * np.array([0.7, 0.3])[None, None, :, None]
        * shape
    )
    light = own[:, 0].sum(axis=1)
    return xr.Dataset(
        {
            "binned_radiance": (("condition", "state", "component", "wavelength"), own),
            "incident_binned": (
                ("condition", "reflection", "wavelength"),
                np.stack([light, 5 * light], axis=1),
            ),
            "wavelength_edge": ("edge", edges),
            "component_uncertainty": ("component", [0.1, 0.3]),
            "numerical_power": ("condition", power),
        },
        {
            "condition": ["60kW", "70kW", "80kW"],
            "state": list(judge.STATES),
            "component": ["N I", "N2 1P"],
            "reflection": ["specular", "diffuse"],
            "wavelength": middle,
        },
    )


@pytest.fixture(scope="module")
def response():
    wavelength = np.arange(700e-9, 1150.5e-9, 1e-9)
    wide, narrow = (np.exp(-(((wavelength - c) / 70e-9) ** 2)) for c in (0.93e-6, 1.03e-6))
    return xr.Dataset(
        {"responsivity_wide": ("wavelength", wide), "responsivity_narrow": ("wavelength", narrow)},
        {"wavelength": wavelength},
    )


@pytest.fixture(scope="module")
def designs(spectra, response):
    return stage.band_design(spectra, response, TABLES, settings=SETTINGS)


def test_the_best_single_band_lies_where_the_gas_is_dark(designs):
    row = designs.sel(design="1-band optimum, silicon, box")
    assert float(row.band_centre[0] - row.band_width[0] / 2) >= SHINING[1] - 2e-9


def test_the_best_bands_beat_the_reference_and_the_coarse_grid(designs):
    best = designs.sel(design=designs.attrs["best_two_band"])
    brute = designs.sel(design="brute force, silicon, box")
    assert float(best.total_error) < float(designs.total_error[0])
    assert float(best.design_score) <= float(brute.design_score)
    assert float(brute.design_score) == pytest.approx(float(designs.candidate_score.min()), rel=1e-12)


def test_the_gain_of_the_robust_design_stays_within_its_tolerance(designs):
    best = designs.sel(design=designs.attrs["best_two_band"])
    change = best.gain_change.values[1:]
    assert (best.design_gain > 0).all()
    assert np.nanmax(np.abs(change - 1)) < 0.2


def test_without_gas_the_two_bands_fall_back_to_one_micrometre(designs):
    row = designs.sel(design="2-band optimum without gas, silicon")
    assert NEAR_ONE_MICROMETRE[0] < float(row.band_centre.mean()) < NEAR_ONE_MICROMETRE[1]


def test_a_reference_gains_nothing_over_itself(designs):
    np.testing.assert_array_equal(designs.design_gain[0], 0.0)


def test_a_design_that_reaches_beyond_the_data_is_named_but_not_judged(designs):
    row = designs.isel(design=np.flatnonzero(designs.design_kind == "beyond the data"))
    assert row.sizes["design"] == 1 and np.isnan(row.total_error).all() and np.isfinite(row.band_centre[0, 0])


def test_the_same_seed_gives_the_same_designs(designs, spectra, response):
    again = stage.band_design(spectra, response, TABLES, settings=SETTINGS)
    xr.testing.assert_identical(designs, again)


def test_no_gas_at_all_leaves_no_gas_error(spectra, response):
    bench = judge.make_bench(spectra, TABLES, SETTINGS)
    dark = replace(bench, gas=np.zeros_like(bench.gas))
    signal = dark.currents("silicon", np.array([[0.9e-6, 1.0e-6]]), np.full((1, 2), 20e-9), "box")
    error = dark.gas_error(signal, dark.weights(signal), np.array([1000.0, 2000.0]), [0.3])
    np.testing.assert_allclose(error, 0.0, atol=1e-9)


@pytest.fixture(scope="module")
def trusted(designs, spectra, response):
    return trust.trust(spectra, designs, response, TABLES, settings=SETTINGS)


def test_the_reference_of_the_sample_helps_and_reflection_hurts(trusted):
    limit = trusted.trust_temperature.isel(trust_level=0)
    as_read, subtracted = limit.isel(setup=0), limit.isel(setup=1)
    assert (subtracted < as_read).all()
    assert (as_read.sel(surface="matt") > as_read.sel(surface="mirror")).all()


def test_a_wider_level_is_reached_earlier(trusted):
    assert (
        trusted.trust_temperature.isel(trust_level=1) <= trusted.trust_temperature.isel(trust_level=0)
    ).all()


def test_times_are_those_of_the_heating_sample():
    time = trust.time_to_reach(1200.0, 350.0, 1250.0, 0.1)
    assert step_response(time, 350.0, 1250.0, 0.1) == pytest.approx(1200.0, rel=1e-8)
    assert trust.time_to_reach(300.0, 350.0, 1250.0, 0.1) == 0.0
    assert np.isnan(trust.time_to_reach(1700.0, 350.0, 1250.0, 0.1))


def test_the_page_names_the_temperatures_and_refuses_unknown_conditions(trusted):
    page = trust.as_markdown(trusted, "70kW")
    first = float(trusted.trust_temperature.sel(condition="70kW", surface="mirror")[0, 0])
    assert f"{first:.0f} K" in page and "Matt sample" in page and "What helps most" in page
    with pytest.raises(ValueError, match="95kW"):
        trust.as_markdown(trusted, "95kW")


@pytest.mark.parametrize("count", [1, 3, 25])
def test_the_reference_may_have_any_bands(designs, spectra, response, count):
    wavelength = response.wavelength.values
    centres = [1.03e-6] if count == 1 else np.linspace(0.75e-6, 1.1e-6, count)
    curves = (np.abs(wavelength - np.array(centres)[:, None]) < 5.5e-9).astype(float)
    names = [f"b{place}" for place in range(count)]
    bands = xr.Dataset(
        {"responsivity": (("band", "wavelength"), curves)},
        {"wavelength": wavelength, "band": names},
        {"instrument": "mine"},
    )
    found = trust.trust(spectra, designs, bands, TABLES, settings=SETTINGS)
    assert [name for name in found.setup.values if name.startswith("mine, ")] == list(found.setup.values[:3])
    limit = found.trust_temperature.isel(trust_level=0)
    # The gas shines from 700 nm to where it ends; its own light taken out, a reading is right from colder on.
    assert (limit.isel(setup=1) <= limit.isel(setup=0)).all() and np.isfinite(limit[:, :, :2]).all()
    bench = judge.make_bench(spectra, TABLES, SETTINGS)
    scores = judge.Judge(bench, spectra.numerical_power.values, bands, SETTINGS)
    assert scores.reference_weights.shape == (1, count)
    moved = bands.assign_coords(wavelength=wavelength - 100e-9)
    if count > 1:
        with pytest.raises(ValueError, match="must cover the b0 band"):
            trust.trust(spectra, designs, moved, TABLES, settings=SETTINGS)
