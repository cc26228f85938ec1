"""The forward model: its integrals, its derivatives, the order of effects."""

import dataclasses

import numpy as np
import pytest
from scipy.integrate import quad

from plasmapyro.forward.averaging import exposure_variance, footprint_variance, planck_derivatives
from plasmapyro.forward.bins import LINE_BINS, bin_mean
from plasmapyro.forward.light import Scene
from plasmapyro.forward.model import GreyTable, grey_signals, signals
from plasmapyro.forward.stage import bin_pixels, forward_model
from plasmapyro.instrument.pyrometer import band_signal, blackbody_signal

BIN_RTOL = 4e-4  # Planck's law at the middle of a 3 nm bin against its mean, at 800 K
GAS_RTOL = 1e-3  # lines placed within 1 nm at the filter edge
TABLE_RTOL = 1e-8  # cubic spline of ln S in 1/T
SLOPE_RTOL = 1e-6  # central difference of 0.01 K


def scene(temperature, amplitude=1.0, **changes):
    temperature = np.atleast_1d(np.asarray(temperature, dtype=float))
    size = temperature.size
    values = {
        "time": np.arange(size) * 1.0,
        "temperature": temperature,
        "gas_amplitude": np.full(size, amplitude),
        "injected": np.ones(size, dtype=bool),
        "emittance": 0.85,
        "power": 80e3,
    }
    return Scene(**(values | changes))


def test_a_surface_without_gas_gives_the_band_integrals_of_the_calibration(model, response):
    temperature = np.array([800.0, 1200.0, 2000.0])
    seen = signals(model["pyrometer"], scene(temperature, amplitude=0.0)).value
    for column, (band, gain) in enumerate((("wide", 3.15e-9), ("narrow", 1e-8))):
        fine = blackbody_signal(
            temperature, response.wavelength.values, response[f"responsivity_{band}"].values
        )
        np.testing.assert_allclose(seen[:, column], 0.85 * gain * fine, rtol=BIN_RTOL)


@pytest.mark.parametrize("power", [70e3, 80e3])
def test_gas_without_a_surface_gives_the_band_integrals_of_its_lines(model, response, gases, power):
    hidden = scene(1000.0, amplitude=2.0, injected=np.array([False]), power=power)
    seen = signals(model["pyrometer"], hidden).value[0]
    gas = gases[power]
    for column, (band, gain) in enumerate((("wide", 3.15e-9), ("narrow", 1e-8))):
        weight = np.interp(
            gas.wavelength, response.wavelength, response[f"responsivity_{band}"], left=0, right=0
        )
        expected = 2 * gain * band_signal(gas.wavelength.values, weight, gas.gas_radiance.values)
        assert seen[column] == pytest.approx(expected, rel=GAS_RTOL, abs=0)


def test_between_two_conditions_the_gas_is_their_geometric_mean(model):
    for instrument in model.values():
        middle = instrument.gas_at(75e3)
        np.testing.assert_allclose(middle**2, instrument.gas[0] * instrument.gas[1], rtol=1e-12)
    with pytest.raises(ValueError, match="70 to 80 kW; got 90 kW"):
        model["pyrometer"].gas_at(90e3)


def test_the_gas_lines_have_bins_of_their_own(model):
    edges = set(np.round(model["spectrometer"].edges * 1e9, 6))
    for low, high in LINE_BINS:
        assert {round(low * 1e9, 6), round(high * 1e9, 6)} <= edges
        assert not [edge for edge in edges if low * 1e9 + 1e-3 < edge < high * 1e9 - 1e-3]


@pytest.mark.parametrize("name", ["pyrometer", "spectrometer"])
def test_slope_is_the_derivative(model, name):
    temperature, step = np.array([700.0, 1000.0, 1600.0, 2200.0]), 0.01
    up, down = (signals(model[name], scene(temperature + sign * step)).value for sign in (1, -1))
    slope = signals(model[name], scene(temperature)).slope
    np.testing.assert_allclose(slope, (up - down) / (2 * step), rtol=SLOPE_RTOL)


@pytest.mark.parametrize("name", ["pyrometer", "spectrometer"])
def test_the_table_gives_the_same_as_the_bins(model, name):
    spread = scene(np.linspace(400, 2500, 50), amplitude=0.9, temperature_variance=100.0)
    direct, tabled = signals(model[name], spread), grey_signals(model[name], spread, GreyTable(model[name]))
    np.testing.assert_allclose(tabled.value, direct.value, rtol=TABLE_RTOL)
    np.testing.assert_allclose(tabled.slope, direct.slope, rtol=1e-5)  # derivative of a spline


def test_second_derivative_of_planck_is_that_of_finite_differences():
    wavelength = np.array([0.75e-6, 1.1e-6])
    low, middle, high = (planck_derivatives(wavelength, 1200.0 + shift) for shift in (-0.1, 0.0, 0.1))
    np.testing.assert_allclose(middle[1], (high[0] - low[0]) / 0.2, rtol=1e-6)
    np.testing.assert_allclose(middle[2], (high[1] - low[1]) / 0.2, rtol=1e-6)


def test_a_footprint_sees_what_the_integral_over_it_gives():
    drop, variance = footprint_variance(14e-3, 80.0, 25e-3)

    def profile(radius):
        return 1600.0 - 80.0 * (radius / 25e-3) ** 2

    def over_disc(function):
        return quad(lambda r: function(profile(r)) * 2 * r / 7e-3**2, 0, 7e-3)[0]

    assert 1600 - drop == pytest.approx(over_disc(lambda t: t), rel=1e-9)
    assert variance == pytest.approx(over_disc(lambda t: (t - 1600 + drop) ** 2), rel=1e-9)
    mean, _, bend = planck_derivatives(0.9e-6, 1600 - drop)
    exact = over_disc(lambda t: planck_derivatives(0.9e-6, t)[0])
    assert mean + variance / 2 * bend == pytest.approx(exact, rel=1e-5)  # third order left out
    assert abs(mean / exact - 1) > 1e-5  # which is not nothing


def test_an_exposure_of_a_ramp_has_the_variance_of_a_uniform_law():
    time = np.arange(5.0)
    np.testing.assert_allclose(exposure_variance(time, 30 * time, 1.0), 900 / 12, rtol=1e-12)


@dataclasses.dataclass
class Effect:
    stage: str
    change: object

    def __call__(self, record):
        return self.change(record)


def test_without_effects_nothing_changes_and_an_idle_effect_is_bit_identical(model):
    base = signals(model["pyrometer"], scene([900.0, 1500.0]))
    idle = signals(model["pyrometer"], scene([900.0, 1500.0]), [Effect("path", lambda light: light)])
    np.testing.assert_array_equal(base.value, idle.value)
    np.testing.assert_array_equal(base.slope, idle.slope)


def test_effects_act_in_the_order_of_their_stages(model):
    called = []

    def note(name):
        return lambda record: called.append(name) or record

    stages = ["clock", "optics", "surface", "detector", "source", "path", "surface"]
    signals(model["pyrometer"], scene(1000.0), [Effect(s, note(f"{s}{i}")) for i, s in enumerate(stages)])
    assert called == ["source4", "surface2", "surface6", "path5", "optics1", "detector3", "clock0"]
    with pytest.raises(ValueError, match="got 'window'"):
        signals(model["pyrometer"], scene(1000.0), [Effect("window", note("x"))])


def test_effects_on_light_and_signals_carry_the_derivative(model):
    effects = [
        Effect("surface", lambda light: light.replace(emittance=0.5 * light.emittance)),
        Effect("path", lambda light: light.replace(transmittance=0.9 * light.transmittance)),
        Effect("detector", lambda seen: seen.mapped(seen.value**2, 2 * seen.value)),
    ]
    temperature = np.array([1000.0, 1600.0])

    def run(shift):
        return signals(model["pyrometer"], scene(temperature + shift), effects)

    by_hand = signals(model["pyrometer"], scene(temperature, amplitude=1.0, emittance=0.425)).value
    np.testing.assert_allclose(run(0.0).value, (0.9 * by_hand) ** 2, rtol=1e-12)
    np.testing.assert_allclose(run(0.0).slope, (run(0.01).value - run(-0.01).value) / 0.02, rtol=SLOPE_RTOL)


def test_reflected_gas_light_grows_with_what_is_not_emitted(response, calibration, gases):
    mirrored = {p: g.assign(incident_radiance=3 * g.gas_radiance) for p, g in gases.items()}
    model = forward_model(response, calibration, mirrored)["pyrometer"]
    dark = scene(300.0, incident_share=1.0)  # a surface that does not shine itself
    plain = signals(model, scene(300.0)).value
    np.testing.assert_allclose(signals(model, dark).value, plain * (1 + 0.15 * 3), rtol=1e-9)


def test_bins_mean_their_pixels_and_say_when_one_is_lost():
    pixels, edges = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.5, 2.5, 4.5])
    spectra = np.array([[1.0, 3.0, 5.0, 7.0], [1.0, 3.0, 5.0, np.nan]])
    mean, count = bin_pixels(pixels, spectra, np.isfinite(spectra), edges)
    np.testing.assert_array_equal(mean, [[2.0, 6.0], [2.0, np.nan]])
    np.testing.assert_array_equal(count, [2, 2])


def test_bins_beyond_the_spectrum_and_other_slits_are_refused(response, calibration, gases):
    with pytest.raises(ValueError, match="600 to 700 nm, the spectrum only from 700 to 1200 nm"):
        bin_mean(gases[70e3].wavelength.values, gases[70e3].gas_radiance.values, [0.6e-6, 0.7e-6])
    with pytest.raises(ValueError, match="slit is 1.5 nm, that of the radiance 0.75 nm"):
        forward_model(response, calibration, gases, np.linspace(750e-9, 1030e-9, 100), 1.5e-9)
