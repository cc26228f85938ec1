"""The stages of section 4 on cases whose answer is known without running them."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.analysis import stage
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.instrument.stage import ratio_curve
from plasmapyro.radiation.bandsignal import BANDS

WAVELENGTH = np.linspace(0.75e-6, 1.15e-6, 401)
CURVE = np.geomspace(400.0, 8000.0, 600)
PHI = 0.315
INVERSION_RTOL = 1e-5  # 0.5 % temperature step of the curve, error falls with its square (checked below)
TRUTH = np.array([905.0, 1237.0, 1994.0])


def response():
    narrow = (WAVELENGTH >= 0.95e-6).astype(float)
    return xr.Dataset(
        {"responsivity_wide": ("wavelength", np.ones(401)), "responsivity_narrow": ("wavelength", narrow)},
        {"wavelength": WAVELENGTH},
    )


def band_signals(temperature):
    bands = response()
    return [blackbody_signal(temperature, WAVELENGTH, bands[f"responsivity_{band}"].values) for band in BANDS]


def calibration(curve=CURVE):
    return ratio_curve(
        response(), sensitivity_ratio=PHI, calibration_temperature=curve, instrument_range=[973.0, 2073.0]
    )


def gas(signals, emittance=0.85):
    cases = {f"case{number}": radiation(pair, 1e3 * (1 + number)) for number, pair in enumerate(signals)}
    return stage.gather(cases, emittance=np.broadcast_to(emittance, len(signals)))


def radiation(signals, power=None):
    """What `gather` reads of a file of contract 'radiation'."""
    stated = {} if power is None else {"numerical_power": power, "chamber_pressure": 5000.0}
    return xr.Dataset({"band_signal": ("band", list(signals))}, {"band": ["wide", "narrow"]}, stated)


def blue_light(strength):
    """Gas of the colour of a black body at 5000 K."""
    wide, narrow = band_signals(np.array(5000.0))
    return float(strength), float(strength * narrow / wide)


def reading(signals, emittance=0.85, truth=TRUTH):
    return stage.apparent_temperature(
        gas(signals, emittance), response(), calibration(), object_temperature=truth
    )


def test_conditions_are_sorted_by_power_whatever_their_names():
    cases = {
        "a 130": radiation([3.0, 1.0], 130e3),
        "mine": radiation([4.0, 1.0]),
        "z 60": radiation([1.0, 1.0], 60e3),
        "y 90": radiation([2.0, 1.0], 90e3),
    }
    gathered = stage.gather(cases, emittance=[0.8, 0.7, 0.9, 1.0])
    assert gathered.condition.values.tolist() == [
        "z 60",
        "y 90",
        "a 130",
        "mine",
    ]  # that without a power last
    assert gathered.gas_signal.sel(band="wide").values.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert gathered.sample_emittance.values.tolist() == [0.9, 1.0, 0.8, 0.7]
    np.testing.assert_array_equal(gathered.numerical_power, [60e3, 90e3, 130e3, np.nan])


def test_no_condition_is_refused():
    with pytest.raises(ValueError, match="no power condition"):
        stage.gather({}, emittance=[])


def test_without_gas_the_reading_is_the_truth():
    result = reading([(0.0, 0.0)])
    assert result.apparent_temperature.values[0] == pytest.approx(TRUTH, rel=INVERSION_RTOL)
    assert not result.reading_status.any()


def test_a_gas_that_shines_like_the_surface_changes_nothing():
    wide, narrow = band_signals(np.array(1237.0))
    result = reading([(0.5 * wide, 0.5 * narrow)], truth=np.array([1237.0]))
    assert result.relative_error.values == pytest.approx(0.0, abs=INVERSION_RTOL)


def test_the_curve_is_the_ratio_of_blackbody_signals_times_phi():
    wide, narrow = band_signals(np.array(1237.0))
    curve = calibration(np.array([1000.0, 1237.0, 2000.0]))
    assert float(curve.calibration_ratio[1]) == pytest.approx(PHI * wide / narrow, rel=1e-12)


def test_half_the_emittance_equals_twice_the_gas():
    faint_surface, bright_gas = reading([blue_light(20.0)], 0.4), reading([blue_light(40.0)], 0.8)
    xr.testing.assert_allclose(
        faint_surface.apparent_temperature, bright_gas.apparent_temperature, rtol=1e-12
    )
    assert (faint_surface.apparent_temperature > reading([blue_light(20.0)], 0.8).apparent_temperature).all()


def test_inversion_error_falls_with_the_square_of_the_step():
    def worst(count):
        curve = calibration(np.geomspace(400.0, 8000.0, count))
        result = stage.apparent_temperature(
            gas([(0.0, 0.0)]), response(), curve, object_temperature=np.arange(900.0, 1101.0)
        )
        return float(abs(result.relative_error).max())

    assert worst(61) / worst(121) == pytest.approx(4, rel=0.15)


def test_light_bluer_than_any_black_body_gives_no_reading():
    result = reading([(1e9, 1.0)])
    assert np.isnan(result.apparent_temperature).all()
    assert (result.reading_status == 1).all()


def test_visibility_is_one_half_where_gas_and_surface_are_equal():
    wide, narrow = band_signals(np.array(1237.0))
    result = stage.visibility(
        gas([(0.85 * wide, 0.85 * narrow)]), response(), object_temperature=TRUTH, visibility_level=[0.5]
    )
    assert result.visibility_factor.values[0, :, 1] == pytest.approx([0.5, 0.5], rel=1e-12)
    assert result.visibility_limit.values[0, 0] == pytest.approx([1237.0, 1237.0], rel=1e-9)


def test_every_condition_has_its_own_emittance():
    """Gas as bright as the surface at 1237 K, whose emittance differs by condition: half is visible."""
    wide, narrow = band_signals(np.array(1237.0))
    emittance = [0.85, 0.4]
    result = stage.visibility(
        gas([(share * wide, share * narrow) for share in emittance], emittance),
        response(),
        object_temperature=TRUTH,
        visibility_level=[0.5],
    )
    np.testing.assert_allclose(result.visibility_factor.values[:, :, 1], 0.5, rtol=1e-12)
    np.testing.assert_allclose(result.visibility_limit.values[0], 1237.0, rtol=1e-9)


def test_results_carry_the_range_of_the_instrument():
    for contract in ("apparent_temperature", "transient"):
        assert made(contract).instrument_range.values.tolist() == [973.0, 2073.0]


def test_error_limit_rises_as_the_emittance_falls_and_ends_at_the_colour_of_the_gas():
    wide, narrow = band_signals(np.array(3000.0))  # gas of the colour of a black body at 3000 K
    result = stage.error_map(
        gas([(1e-4 * wide, 1e-4 * narrow)]),
        response(),
        calibration(),
        object_temperature=np.arange(500.0, 3500.0, 5.0),
        emittance=[1e-9, 0.05, 0.5, 1.0],
        error_level=0.01,
    )
    limit = result.error_limit.values[0]
    assert (np.diff(limit) < 0).all()
    assert limit[0] == pytest.approx(3000.0 / 1.01, abs=0.5)  # only gas is seen: T_app = 3000 K = 1.01 T_obj


def test_transient_reads_high_first_and_merges():
    result = stage.transient(
        gas([blue_light(20.0)]),
        response(),
        calibration(),
        conditions=["case0"],
        time=np.arange(0.0, 101.0, 1.0),
        initial_temperature=350.0,
        gain=1250.0,
        natural_frequency=0.1,
    )
    difference = (result.apparent_temperature - result.object_temperature_history).values[0]
    assert difference[0] > 500
    assert abs(difference[-1]) < 16  # 1 % of 1600 K


def test_transient_of_an_unknown_condition_is_refused():
    with pytest.raises(ValueError, match="unknown condition 60kW; known"):
        stage.transient(
            gas([(1.0, 1.0)]),
            response(),
            calibration(),
            conditions=["60kW"],
            time=[0.0, 1.0],
            initial_temperature=350.0,
            gain=1.0,
            natural_frequency=1.0,
        )


def made(contract):
    dark = gas([blue_light(20.0)])
    heating = {"initial_temperature": 350.0, "gain": 1250.0, "natural_frequency": 0.1}
    return {
        "gas_signal": lambda: dark,
        "visibility": lambda: stage.visibility(
            dark, response(), object_temperature=TRUTH, visibility_level=[0.9]
        ),
        "apparent_temperature": lambda: reading([blue_light(20.0)]),
        "error_map": lambda: stage.error_map(
            dark, response(), calibration(), object_temperature=TRUTH, emittance=[0.5, 1.0], error_level=0.01
        ),
        "transient": lambda: stage.transient(
            dark, response(), calibration(), conditions=["case0"], time=[0.0, 1.0], **heating
        ),
        "surface_radiance": lambda: stage.surface_radiance(
            object_temperature=[750.0], emittance=0.85, wavelength=WAVELENGTH
        ),
    }[contract]()


@pytest.mark.parametrize(
    "contract",
    ["gas_signal", "visibility", "apparent_temperature", "error_map", "transient", "surface_radiance"],
)
def test_results_honour_their_contracts(contract):
    contracts.check(contracts.label(made(contract), contract), contract)
