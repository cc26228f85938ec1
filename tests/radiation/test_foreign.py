"""Light that the simulated gas lacks: lines of other species against integrals, a ripple against Bessel."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from scipy.special import i0
from two_bands import RESPONSE

from plasmapyro.commands.changes import radiance_with
from plasmapyro.commands.terms import changes_of
from plasmapyro.diagnosis.effects.condition import OF_CONDITION
from plasmapyro.diagnosis.effects.gas import JET_EXCITATION, line_spectrum, species_lines
from plasmapyro.diagnosis.fit.terms import terms_of
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.foreign import oxygen_triplet, rippled, warmer
from plasmapyro.radiation.slit import through_slit
from plasmapyro.radiation.stage import line_of_sight_radiance

PRESSURE = 5000.0  # [Pa]
C2 = 1.438776877e-2  # [m K]
KEYS = {"wavelength_range": (700e-9, 1200e-9), "grid_points": 160_000, "slit_fwhm": 0.75e-9}


def sight_line(kelvin):
    """Uniform gas between cold ends."""
    temperature = np.array([350.0, kelvin, kelvin, 350.0])
    density = number_density(temperature, np.full(4, PRESSURE))
    return xr.Dataset(
        {
            "temperature": ("path_distance", temperature),
            "pressure": ("path_distance", np.full(4, PRESSURE)),
            "number_density": (("species", "path_distance"), density.T),
        },
        {"path_distance": [0.0, 0.003, 0.1, 0.103], "species": list(SPECIES)},
        {"gas": "air", "origin": "modelled"},
    )


@pytest.fixture(scope="module")
def plain():
    return line_of_sight_radiance(sight_line(6000.0), RESPONSE, **KEYS)


def with_copper(amount, plain):
    entries = [{"id": "Cu", "amplitude": amount}, {"id": "lines Fe I", "amplitude": 2 * amount}]
    changes = changes_of(terms_of(entries, OF_CONDITION))
    assert changes == {"lines": {"Cu I": amount, "Fe I": 2 * amount}}
    return radiance_with(changes, sight_line(6000.0), RESPONSE, **KEYS)


def test_lines_of_a_species_carry_the_light_that_they_are_said_to(plain):
    """Band signals against the sum over lines of light times responsivity; behind the slit the same light."""
    result = with_copper(3.0, plain)
    assert set(result.variables) == set(plain.variables) and result.attrs == plain.attrs
    triplet = oxygen_triplet(plain.wavelength_slit.values, plain.gas_radiance_slit.values)
    expected = np.zeros(2)
    for species, amount in (("Cu I", 0.3), ("Fe I", 0.6)):
        wavelength, strength = species_lines((species,))
        for band, name in enumerate(("wide", "narrow")):
            curve = RESPONSE[f"responsivity_{name}"]
            inside = np.interp(wavelength, curve.wavelength, curve, left=0, right=0)
            expected[band] += amount * triplet * np.sum(strength * inside)
    more = result.band_signal - plain.band_signal
    assert more.values == pytest.approx(expected, rel=1e-3)  # responses bend within a step of the grid
    assert (result.band_signal_gridless - plain.band_signal_gridless).values == pytest.approx(
        expected, rel=1e-3
    )
    seen = SimpleNamespace(  # as the diagnosis sees it: a Gaussian slit around every line
        wavelength=plain.wavelength_slit.values, base=plain.gas_radiance_slit.values, slit_fwhm=0.75e-9
    )
    for species, amount in (("Cu I", 3.0), ("Fe I", 6.0)):
        light = result.gas_radiance_component_slit.sel(component=species).values
        wanted = amount * line_spectrum((species,), seen, JET_EXCITATION)
        assert np.abs(light - wanted).max() < 1e-3 * wanted.max()
    error = result.error_share * result.gas_radiance_slit
    xr.testing.assert_allclose(error, plain.error_share * plain.gas_radiance_slit, rtol=1e-6)


@pytest.mark.parametrize(
    ("identity", "amplitude", "shape"),
    [
        ("contin", 20.0, {"own": 0.0}),
        ("contin", 20.0, {"own": 0.7}),
        ("selfabs", 1.5, {}),
        ("P_eff", 0.05, {}),
    ],
)
def test_a_condition_shines_as_the_effect_of_the_diagnosis_says(plain, identity, amplitude, shape):
    """The light of the engine against the formula of the catalogue, on the spectra varied by it."""
    entry = {"id": identity, "amplitude": amplitude} | ({"shape": shape} if shape else {})
    changes = changes_of(terms_of([entry], OF_CONDITION))
    result = radiance_with(changes, sight_line(6000.0), RESPONSE, **KEYS)
    assert set(result.variables) == set(plain.variables) and set(result.attrs) == set(plain.attrs)
    slit, base = plain.wavelength_slit.values, plain.gas_radiance_slit.values
    if identity == "P_eff":
        expected = line_of_sight_radiance(sight_line(6000.0 * 1.05), RESPONSE, **KEYS).gas_radiance_slit
    elif identity == "contin":
        free, own = slit**-2.0 * np.exp(-C2 / (slit * 6000.0)), shape["own"]
        parts = plain.gas_radiance_component_slit
        smooth = [name for name in parts.component.values if "free" in name or "detachment" in name]
        edges = parts.sel(component=smooth).sum("component").values
        shine = (1 - own) * free / free.mean() + own * edges / edges.mean()
        expected = base + amplitude * shine * 0.01 * base.mean()
    else:
        tau = plain.optical_depth.values / plain.optical_depth.values.max()
        fine = plain.gas_radiance.values * -np.expm1(-amplitude * tau) / (amplitude * np.maximum(tau, 1e-300))
        expected = through_slit(plain.wavelength.values, fine, slit, float(plain.attrs["slit_fwhm"]))
    np.testing.assert_allclose(result.gas_radiance_slit, expected, rtol=2e-3, atol=1e-4 * base.max())
    whole = result.gas_radiance_component_slit.sum("component")
    np.testing.assert_allclose(whole, result.gas_radiance_slit, rtol=1e-3, atol=1e-4 * base.max())
    share = (result.gas_radiance - plain.gas_radiance).values
    for band, name in enumerate(("wide", "narrow")):
        curve = RESPONSE[f"responsivity_{name}"]
        weight = np.interp(plain.wavelength, curve.wavelength, curve, left=0, right=0)
        more = np.trapezoid(share * weight, plain.wavelength)
        told = float((result.band_signal - plain.band_signal)[band])
        assert told == pytest.approx(more, rel=5e-3)


def test_nothing_to_add_is_the_simulation_itself(plain):
    entries = [{"id": name, "amplitude": 0} for name in OF_CONDITION if name not in ("mixing", "contin")]
    entries.append({"id": "contin", "amplitude": 0, "shape": {"own": 0.5}})
    entries.append({"id": "lines Fe I", "amplitude": 0})
    assert changes_of(terms_of(entries, OF_CONDITION)) == {}
    xr.testing.assert_identical(radiance_with({}, sight_line(6000.0), RESPONSE, **KEYS), plain)


@pytest.mark.parametrize("ripple", [0.05, 0.2])
def test_a_ripple_averages_light_over_a_sine_of_the_temperature(ripple):
    """Of light exp(k T/T0) the mean over a sine is the Bessel function I0(k a) times the light at rest."""
    growth, line = 8.0, sight_line(6000.0)

    def radiance(at):
        light = np.exp(growth * at.temperature.values[1] / 6000.0)
        return xr.Dataset(
            {name: 1.0 * light for name in ("gas_radiance", "band_signal")} | {"optical_depth": light}
        )

    result, rest = rippled(radiance, line, ripple), radiance(line)
    assert float(result.gas_radiance) == pytest.approx(
        float(rest.gas_radiance) * i0(growth * ripple), rel=1e-5
    )
    assert float(result.optical_depth) == float(rest.optical_depth)


def test_warmer_gas_is_the_gas_of_that_temperature():
    found, wanted = warmer(sight_line(6000.0), 0.1), sight_line(6600.0)
    hot = {"path_distance": slice(1, 3)}
    xr.testing.assert_allclose(found.isel(hot), wanted.isel(hot), rtol=1e-9)
    with pytest.raises(ValueError, match="equilibrium"):
        warmer(sight_line(6000.0).isel(species=slice(0, 5)), 0.1)
