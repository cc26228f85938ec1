"""Light of the gas that the sample reflects, against configuration factors and limits."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.analysis.reflection import reflected
from plasmapyro.analysis.stage import error_map, reflection_map
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.sightline.hemisphere import directions

FLOAT_RTOL = 1e-12
FACTOR_RTOL = 5e-3  # the accuracy asked of the view-factor integral


def test_a_black_surface_reflects_nothing():
    assert reflected(1.0, 3.0, 70.0, 0.4) == 0.0


def test_a_mirror_in_uniform_symmetric_gas_returns_the_emitted_radiance_times_its_reflectance():
    radiance = 1 - np.exp(-0.3)  # of a slab of optical depth 0.3, the same on both sides of the normal
    emittance = np.array([0.1, 0.5, 0.85])
    assert reflected(emittance, radiance, 99.0, 0.0) == pytest.approx(
        (1 - emittance) * radiance, rel=FLOAT_RTOL
    )


def test_a_matt_surface_in_isotropic_light_returns_the_same_as_a_mirror():
    assert reflected(0.3, 7.0, 7.0, 1.0) == pytest.approx(reflected(0.3, 7.0, 7.0, 0.0), rel=FLOAT_RTOL)


def test_half_rough_lies_half_way():
    assert reflected(0.2, 2.0, 10.0, 0.5) == pytest.approx(0.8 * 6.0, rel=FLOAT_RTOL)


@pytest.mark.parametrize("count", [4, 8])
def test_the_few_rays_of_the_workflow_give_the_factor_of_the_core(count):
    angle, weight = directions(count, np.radians(4.5))
    assert weight[angle <= np.radians(4.5)].sum() == pytest.approx(
        np.sin(np.radians(4.5)) ** 2, rel=FACTOR_RTOL
    )


@pytest.mark.parametrize("emittance, roughness, name", [(1.1, 0, "emittance"), (0.5, -0.1, "roughness")])
def test_impossible_surfaces_are_refused(emittance, roughness, name):
    with pytest.raises(ValueError, match=name):
        reflected(emittance, 1.0, 1.0, roughness)


@pytest.fixture(scope="module")
def case():
    edges = np.linspace(700e-9, 1200e-9, 101)
    middle = (edges[1:] + edges[:-1]) / 2
    wide, narrow = (np.exp(-(((middle - c) / 60e-9) ** 2)) for c in (0.9e-6, 1.04e-6))
    response = xr.Dataset(
        {"responsivity_wide": ("wavelength", wide), "responsivity_narrow": ("wavelength", narrow)},
        {"wavelength": middle},
    )
    temperature = np.arange(600.0, 5000.0, 10.0)
    ratio = blackbody_signal(temperature, middle, wide) / blackbody_signal(temperature, middle, narrow)
    curve = xr.Dataset(
        {"sensitivity_ratio": 1.0, "calibration_ratio": ("calibration_temperature", ratio)},
        {"calibration_temperature": temperature},
    )
    size = np.diff(edges)
    light = np.stack([np.full((1, 100), 1.0e7), np.full((1, 100), 2.0e8)], axis=1)
    spectra = xr.Dataset(
        {
            "incident_binned": (("condition", "reflection", "wavelength"), light),
            "wavelength_edge": ("edge", edges),
        },
        {"condition": ["a"], "reflection": ["specular", "diffuse"], "wavelength": middle},
    )
    gas = xr.Dataset(
        {
            "gas_signal": (("condition", "band"), [[1.0e7 * (row * size).sum() for row in (wide, narrow)]]),
            "numerical_power": ("condition", [9e4]),
        },
        {"condition": ["a"], "band": ["wide", "narrow"]},
    )
    return gas, spectra, response, curve


def maps(case, **changes):
    settings = {
        "object_temperature": np.arange(900.0, 2500.0, 25.0),
        "emittance": [0.1, 0.5, 0.9, 1.0],
        "error_level": 0.01,
        "gas_variation": 0.03,
        "tolerance": 10.0,
    } | changes
    return reflection_map(*case, **settings)


def test_without_reflection_it_is_the_error_map_of_the_paper(case):
    gas, _, response, curve = case
    ours = maps(case).sel(surface="no reflection", correction="none")
    paper = error_map(
        gas,
        response,
        curve,
        object_temperature=ours.object_temperature.values,
        emittance=ours.emittance.values,
        error_level=0.01,
    )
    np.testing.assert_allclose(ours.relative_error, paper.relative_error, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("count", [1, 3, 5, 25])
def test_samples_reflect_before_instruments_of_any_bands(case, count):
    """Without reflection it is the map of errors; a matt sample in twenty times the light reads hot."""
    gas, spectra, _, _ = case
    middle, names = spectra.wavelength.values, [f"b{place}" for place in range(count)]
    curves = np.exp(-(((middle - np.linspace(750e-9, 1150e-9, count)[:, None]) / 20e-9) ** 2))
    response = xr.Dataset(
        {"responsivity": (("band", "wavelength"), curves)}, {"wavelength": middle, "band": names}
    )
    light = 1e7 * curves @ np.diff(spectra.wavelength_edge.values)
    gas = xr.Dataset(
        {"gas_signal": (("condition", "band"), light[None]), "numerical_power": ("condition", [9e4])},
        {"condition": ["a"], "band": names},
    )
    kelvin = np.arange(600.0, 5000.0, 10.0)
    black = [blackbody_signal(kelvin, middle, row) for row in curves]
    curve = xr.Dataset(
        {"calibration_signal": (("band", "calibration_temperature"), black)},
        {"calibration_temperature": kelvin, "band": names},
    )
    found = maps((gas, spectra, response, curve)).sel(condition="a")
    keys = {"object_temperature": found.object_temperature.values, "emittance": found.emittance.values}
    plain = error_map(gas, response, curve, **keys, error_level=0.01).relative_error.sel(condition="a")
    own = found.relative_error.sel(correction="none")
    np.testing.assert_allclose(own.sel(surface="no reflection"), plain, rtol=1e-10, atol=1e-12)
    hot, dark = (own.sel(surface="matt", emittance=e, object_temperature=1500.0) for e in (0.1, 1.0))
    assert float(hot - plain.sel(emittance=0.1, object_temperature=1500.0)) > 0.02
    assert float(dark) == pytest.approx(float(plain.sel(emittance=1.0, object_temperature=1500.0)))
    assert list(found.incident_signal.band.values) == names
    diffuse = found.incident_signal.sel(reflection="diffuse")
    np.testing.assert_allclose(diffuse, 20 * found.incident_signal.sel(reflection="specular"), rtol=1e-12)


def test_all_surfaces_agree_where_the_emittance_is_one(case):
    error = maps(case).relative_error.sel(emittance=1.0)
    np.testing.assert_allclose(error, np.broadcast_to(error[:1], error.shape), rtol=1e-10)


def test_reflection_raises_the_temperature_limit_and_more_at_low_emittance(case):
    limit = maps(case).error_limit.sel(correction="none", condition="a")
    extra = limit.sel(surface="matt") - limit.sel(surface="no reflection")
    assert (np.diff(extra.values) < 0).all() and extra.values[0] > 100


def test_subtracting_the_line_of_sight_leaves_the_reflection_only(case):
    result = maps(case).sel(correction="line of sight")
    np.testing.assert_allclose(result.relative_error.sel(surface="no reflection"), 0.0, atol=1e-4)
    assert (
        float(
            result.relative_error.sel(surface="matt", emittance=0.1, condition="a").isel(
                object_temperature=20
            )
        )
        > 0.01
    )


def test_the_reference_of_the_sample_itself_leaves_the_drift_of_the_gas(case):
    exact = maps(case, gas_variation=0.0).sel(correction="reference").relative_error
    np.testing.assert_allclose(exact, 0.0, atol=1e-4)  # interpolation of the curve
