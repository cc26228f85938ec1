"""The synthetic twin: its physics, its independence in numbers, its files."""

import dataclasses

import numpy as np
import pytest
import xarray as xr
from scipy.constants import sigma
from twin import campaign, light, sample
from twin.plasma import Plasma, brightness
from two_bands import RESPONSE

from plasmapyro import contracts
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.radiation.bandsignal import band_signal, respond
from plasmapyro.radiation.planck import blackbody_radiance

AGREEMENT = 1e-3  # what the two independent codes owe each other


def plume():
    """An invented gas: lines 20 pm wide at the places of N I and O I, on a smooth hump."""
    wavelength = np.linspace(0.70e-6, 1.20e-6, 100001)
    radiance = 2e6 * np.exp(-(((wavelength - 1.05e-6) / 0.15e-6) ** 2))
    for centre, peak in (
        (746.8, 8e9),
        (777.4, 4e10),
        (844.6, 4e10),
        (868.0, 2e10),
        (939.0, 5e9),
        (1011.0, 1e9),
    ):
        radiance += peak / (1 + ((wavelength - centre * 1e-9) / 10e-12) ** 2)
    return xr.Dataset({"gas_radiance": ("wavelength", radiance)}, {"wavelength": wavelength})


GAS = plume()


def test_planck_of_both_codes_agrees():
    wavelength = np.linspace(0.7e-6, 1.2e-6, 11)
    for temperature in (350.0, 1600.0, 6000.0):
        mine, theirs = light.planck(wavelength, temperature), blackbody_radiance(wavelength, temperature)
        np.testing.assert_allclose(mine, theirs, rtol=1e-8)  # constants of two sources


def test_blackbody_band_signals_of_both_codes_agree():
    temperature = np.array([800.0, 1300.0, 2000.0])
    mine = campaign.band_signals(RESPONSE, temperature)
    theirs = [
        blackbody_signal(temperature, RESPONSE.wavelength.values, RESPONSE[f"responsivity_{band}"].values)
        for band in ("wide", "narrow")
    ]
    np.testing.assert_allclose(mine, theirs, rtol=AGREEMENT)


@pytest.mark.parametrize("band", ["wide", "narrow"])
def test_gas_band_signals_of_both_codes_agree(band):
    nodes, response = RESPONSE.wavelength.values, RESPONSE[f"responsivity_{band}"].values
    grid = GAS.wavelength.values
    theirs = band_signal(grid, respond(grid, nodes, response), GAS.gas_radiance.values)
    edges, _, weight = light.band(nodes, response)
    mine = light.bin_mean(grid, GAS.gas_radiance.values, edges) @ weight
    assert mine == pytest.approx(theirs, rel=AGREEMENT)


def test_bins_keep_the_integral_of_lines():
    edges, _ = light.bins(0.72e-6, 1.15e-6, 1e-9)
    inside = (GAS.wavelength >= 0.72e-6) & (GAS.wavelength <= 1.15e-6)
    fine = np.trapezoid(GAS.gas_radiance[inside], GAS.wavelength[inside])
    binned = np.sum(light.bin_mean(GAS.wavelength.values, GAS.gas_radiance.values, edges) * np.diff(edges))
    assert binned == pytest.approx(fine, rel=1e-5)


def test_slit_keeps_the_integral_and_gives_the_width():
    edges, centres = light.bins(0.80e-6, 0.82e-6, 0.01e-9)
    pixels = np.linspace(0.805e-6, 0.815e-6, 1001)
    needle = np.where(np.abs(centres - 0.81e-6) < 0.006e-9, 1.0, 0.0)
    seen = light.through_slit(edges, needle, pixels, 0.75e-9)
    area = np.sum(needle * np.diff(edges))
    assert np.trapezoid(seen, pixels) == pytest.approx(area, rel=1e-4, abs=0)
    assert np.ptp(pixels[seen > seen.max() / 2]) == pytest.approx(0.75e-9, abs=0.02e-9)


def test_spectrum_that_does_not_reach_is_refused():
    edges, _ = light.bins(0.6e-6, 0.8e-6, 1e-9)
    with pytest.raises(ValueError, match="covers 700 to 1200 nm; 600 to 800 nm are needed"):
        light.bin_mean(GAS.wavelength.values, GAS.gas_radiance.values, edges)


def test_sample_settles_where_heat_in_equals_heat_out():
    disc = sample.Sample()
    end = sample.history(disc, np.array([0.0, 4000.0]), 5000.0)[-1]
    inward = (
        disc.contact * disc.holder_loss / (disc.contact + disc.holder_loss) * (end - disc.initial_temperature)
    )
    gained = disc.cold_wall_heat_flux * (1 - end / disc.recovery_temperature)
    lost = disc.emittance * sigma * (end**4 - disc.surroundings**4) + inward
    assert gained == pytest.approx(lost, rel=1e-4)


def test_sample_heats_for_eighty_seconds_to_about_1600_k_and_then_cools():
    time = np.array([-10.0, 0.0, 6.0, 80.0, 300.0, 400.0])
    before, start, early, warm, steady, cold = sample.history(sample.Sample(), time, 300.0)
    assert (before, start) == pytest.approx((350, 350), rel=1e-12)
    assert early < 650 and 1500 < warm < steady < 1650 and cold < 900


def test_plasma_drops_at_injection_flickers_and_ends():
    time = np.arange(-20.0, 310.0, 0.05)
    level = brightness(Plasma(), time, 300.0, np.random.default_rng(1))
    assert level[time < -1].mean() == pytest.approx(1.7, rel=0.01)
    assert level[(time > 0) & (time < 6)].mean() == pytest.approx(1.0, rel=0.02)
    assert level[time > 301].max() < 1e-12
    still = brightness(Plasma(flicker=0.0), time, 300.0, np.random.default_rng(1))
    assert still[np.searchsorted(time, 299.9)] == pytest.approx(1.03, abs=0.011)  # drift and swing


@pytest.fixture(scope="module")
def recorded():
    return campaign.record(campaign.Scene(condition="90kW"), RESPONSE, [(1.0, GAS)], 3)


def test_files_honour_the_contracts_of_the_package(recorded):
    contracts.check(recorded[0], "test")
    contracts.check(campaign.calibration_points(RESPONSE, 3), "calibration_points")
    contracts.check(campaign.spectrometer_counts(3), "spectrometer_counts")


def test_truth_is_sealed(recorded):
    test, truth = recorded
    assert not set(truth.data_vars) & set(test.data_vars)
    assert {"surface_temperature", "gas_scale"} <= set(truth.data_vars)
    assert "seed" not in test.attrs and test.attrs["origin"] == "synthetic"


def test_axes_are_those_of_the_laboratory(recorded):
    test, _ = recorded
    np.testing.assert_allclose(np.diff(test.time), 0.1, rtol=1e-6)
    assert (float(test.time[0]), float(test.time[-1])) == (-20.0, 400.0)
    assert set(np.diff(test.spectrum_time)) == {2.0} and 2.0 in test.spectrum_time
    assert test.sizes["wavelength"] == 2068 and float(test.counts.max()) <= 65535
    assert (test.counts == np.rint(test.counts)).all()


def test_signals_drop_at_injection_and_follow_the_sample(recorded):
    test, _ = recorded
    for band in ("wide", "narrow"):
        signal = test[f"signal_{band}"]
        before, after = signal.sel(time=slice(-10, -1)).mean(), signal.sel(time=slice(0, 4)).mean()
        assert float(before / after) == pytest.approx(1.7, rel=0.03)
        assert float(signal.sel(time=200, method="nearest")) > 20 * float(after)


def test_same_seed_same_files_and_other_seed_other_noise(recorded):
    again = campaign.record(campaign.Scene(condition="90kW"), RESPONSE, [(1.0, GAS)], 3)
    other = campaign.record(campaign.Scene(condition="90kW"), RESPONSE, [(1.0, GAS)], 4)
    for one, two in zip(recorded, again, strict=True):
        xr.testing.assert_identical(one, two)
    assert not other[0].signal_wide.equals(recorded[0].signal_wide)
    assert other[1].surface_temperature.equals(recorded[1].surface_temperature)


def test_written_twice_the_bytes_are_the_same(recorded, tmp_path):
    for name in ("one.nc", "two.nc"):
        campaign.write(recorded[0], tmp_path / name)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "two.nc").read_bytes()
    assert not list(tmp_path.glob("*.part"))


def test_half_and_half_of_one_gas_is_that_gas(recorded):
    halves = campaign.record(campaign.Scene(condition="90kW"), RESPONSE, [(0.5, GAS), (0.5, GAS)], 3)
    np.testing.assert_allclose(halves[0].signal_wide, recorded[0].signal_wide, rtol=1e-12)


def test_a_hidden_effect_is_a_changed_scene(recorded):
    calm = dataclasses.replace(
        campaign.Scene(condition="90kW"), plasma=Plasma(drift=0.0, swing=0.0, flicker=0.0)
    )
    _, truth = campaign.record(calm, RESPONSE, [(1.0, GAS)], 3)
    shining = (truth.time > 0.3) & (truth.time < 299)
    np.testing.assert_allclose(truth.gas_scale[shining], 1.0, atol=1e-5)


def test_effects_on_the_light_reach_the_instrument_they_are_meant_for(recorded):
    base = campaign.Scene(condition="90kW")

    def dirty(instrument, wavelength, time):
        return np.where(time > 100, 0.9, 1.0) if instrument == "pyrometer" else 1.0

    def lamp(instrument, wavelength, time, temperature):
        return np.where(time < 0, 1e9, 0.0)

    def half_after(wavelength, temperature, time):
        return np.where(time > 200, 0.425, 0.85)

    changes = {"transmittance": dirty, "extra_radiance": lamp, "emittance": half_after}
    test, truth = campaign.record(dataclasses.replace(base, **changes), RESPONSE, [(1.0, GAS)], 3)
    signal = test.signal_narrow / recorded[0].signal_narrow
    assert float(signal.sel(time=slice(110, 190)).mean()) == pytest.approx(0.9, abs=1e-3)
    assert float(signal.sel(time=slice(210, 290)).mean()) == pytest.approx(0.45, abs=2e-3)  # gas: 1e-3
    assert float(signal.sel(time=slice(-10, -1)).min()) > 2
    net = (test.counts - test.background_counts) / (recorded[0].counts - test.background_counts)
    assert float(net.sel(spectrum_time=150).median()) == pytest.approx(1, abs=0.01)
    assert float(net.sel(spectrum_time=250).median()) == pytest.approx(0.5, abs=0.01)
    assert truth.surface_temperature.equals(recorded[1].surface_temperature)
