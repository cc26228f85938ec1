"""The study says of each condition what the single stages say, and of a missing flow that it is missing."""

import inspect
from itertools import product

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.analysis import stage as analysis
from plasmapyro.flow.continuation import Extinguished, NotConverged
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.instrument.stage import ratio_curve
from plasmapyro.study import stage

WAVELENGTH = np.linspace(0.75e-6, 1.15e-6, 201)
SAME_RTOL = 1e-12  # the same formulas over arrays of another shape
TEMPERATURE = np.arange(800.0, 2401.0, 400.0)
LIMIT_TEMPERATURE = np.arange(600.0, 3001.0, 50.0)
LEVEL = 0.01
POWER, PRESSURE, RATE = (60e3, 90e3), (5e3, 1e4), (0.016,)
EMITTANCE, ANGLE = (0.3, 0.6, 0.9), (0.5, 0.9)


@pytest.fixture(scope="module")
def response():
    narrow = (WAVELENGTH >= 0.95e-6).astype(float)
    return xr.Dataset(
        {"responsivity_wide": ("wavelength", np.ones(201)), "responsivity_narrow": ("wavelength", narrow)},
        {"wavelength": WAVELENGTH},
    )


@pytest.fixture(scope="module")
def curve(response):
    return ratio_curve(
        response,
        sensitivity_ratio=0.315,
        calibration_temperature=np.geomspace(400.0, 8000.0, 400),
        instrument_range=[973.0, 2073.0],
    )


def gas_of(place, response):
    """Band signals that are another at each place."""
    power, pressure, rate, angle = place
    black = [
        blackbody_signal(np.array(5000.0), WAVELENGTH, response[f"responsivity_{band}"].values)
        for band in stage.BANDS
    ]
    strength = 2e-6 * (power / 9e4) ** 3 * (pressure / 5e3) * (rate / 0.016) / np.sin(angle)
    return strength * np.array(black) * [1.0, 1 - 0.1 * angle]


def signal_of(place, response, status=0):
    known = status == 0
    return xr.Dataset(
        {
            **dict(zip((*stage.FLOW_DIMS, "sightline_angle"), place, strict=True)),
            "flow_status": status,
            "gas_signal": ("band", gas_of(place, response) if known else [np.nan, np.nan]),
            "peak_temperature": place[0] / 10 if known else np.nan,
        },
        {"band": list(stage.BANDS)},
    )


def gathered(signals, response, curve, conditions=None, **changes):
    conditions = conditions or list(product(POWER, PRESSURE, RATE, EMITTANCE, ANGLE))
    found = stage.gather(
        signals,
        response,
        curve,
        conditions=conditions,
        **{
            "object_temperature": TEMPERATURE,
            "limit_temperature": LIMIT_TEMPERATURE,
            "error_level": LEVEL,
            **changes,
        },
    )
    return contracts.check(contracts.label(found, "study"), "study")


def all_signals(response):
    return [signal_of(place, response) for place in product(POWER, PRESSURE, RATE, ANGLE)]


@pytest.mark.parametrize("batch", [1, 3, 64])
def test_each_condition_is_what_the_single_stages_say(response, curve, monkeypatch, batch):
    monkeypatch.setattr(stage, "BATCH", batch)
    study = gathered(reversed(all_signals(response)), response, curve)
    for place in product(POWER, PRESSURE, RATE, EMITTANCE, ANGLE):
        one = study.sel(dict(zip(stage.DIMS, place, strict=True)))
        signal = gas_of((*place[:3], place[4]), response)
        gas = analysis.gather(
            {"here": xr.Dataset({"band_signal": ("band", signal)}, {"band": list(stage.BANDS)})},
            emittance=[place[3]],
        )
        read = analysis.apparent_temperature(gas, response, curve, object_temperature=TEMPERATURE)
        seen = analysis.visibility(gas, response, object_temperature=TEMPERATURE, visibility_level=[0.9])
        limit = analysis.error_map(
            gas,
            response,
            curve,
            object_temperature=LIMIT_TEMPERATURE,
            emittance=[place[3]],
            error_level=LEVEL,
        )
        same(one.relative_error, read.relative_error[0])
        same(one.study_reading_status, read.reading_status[0])
        same(one.visibility_factor, seen.visibility_factor[0])
        same(one.error_limit, limit.error_limit[0, 0])
        same(one.study_limit_status, limit.limit_status[0, 0])
        same(one.gas_signal, signal)
        assert float(one.peak_temperature) == place[0] / 10
        assert int(one.study_status) == int(one.flow_status) == stage.COMPUTED


def same(found, expected):
    np.testing.assert_allclose(np.asarray(found), np.asarray(expected), rtol=SAME_RTOL, atol=0)


def test_half_the_emittance_is_twice_the_gas(response, curve):
    signals = all_signals(response)
    doubled = [one.assign(gas_signal=2 * one.gas_signal) for one in signals]
    study, other = (gathered(some, response, curve) for some in (signals, doubled))
    same(study.error_limit.sel(emittance=0.3), other.error_limit.sel(emittance=0.6))
    assert np.isfinite(study.error_limit).any()


@pytest.mark.parametrize("status", [stage.EXTINGUISHED, stage.UNSTEADY])
def test_a_missing_flow_is_nan_with_its_reason_and_leaves_the_others_alone(response, curve, status):
    whole = gathered(all_signals(response), response, curve)
    lost = dict(numerical_power=POWER[1], chamber_pressure=PRESSURE[0])
    signals = [
        signal_of(place, response, status if place[:2] == (POWER[1], PRESSURE[0]) else 0)
        for place in product(POWER, PRESSURE, RATE, ANGLE)
    ]
    study = gathered(signals, response, curve)
    there = study.sel(lost)
    assert (there.study_status == status).all() and (there.flow_status == status).all()
    for name in ("gas_signal", "peak_temperature", "visibility_factor", "relative_error", "error_limit"):
        assert np.isnan(there[name]).all(), name
    assert (there.study_reading_status == stage.NO_GAS).all()
    assert (there.study_limit_status == stage.NO_GAS).all()
    kept = study.where(study.flow_status == 0, drop=False)
    for name in ("gas_signal", "visibility_factor", "relative_error", "error_limit"):
        same(kept[name], whole[name].where(study.flow_status == 0))
    assert int((study.study_status == 0).sum()) == 3 * len(EMITTANCE) * len(ANGLE)


def test_what_was_not_asked_for_says_so(response, curve):
    extra = (75e3, 5e3, 0.016, 0.45, 0.5)
    conditions = [*product(POWER, PRESSURE, RATE, EMITTANCE, ANGLE), extra]
    signals = [*all_signals(response), signal_of((*extra[:3], extra[4]), response)]
    study = gathered(signals, response, curve, conditions)
    assert dict(study.sizes)["numerical_power"] == 3 and dict(study.sizes)["emittance"] == 4
    asked = study.study_status != stage.NOT_ASKED
    assert int(asked.sum()) == len(conditions) and bool(asked.sel(dict(zip(stage.DIMS, extra, strict=True))))
    assert np.isnan(study.visibility_factor.where(~asked)).all()
    assert np.isfinite(study.visibility_factor.where(asked, 0.5)).all()
    assert (study.study_limit_status.where(~asked, stage.NO_GAS) == stage.NO_GAS).all()
    assert int(study.flow_status.sel(numerical_power=75e3, chamber_pressure=1e4)[0]) == stage.NOT_ASKED


def test_values_that_differ_by_round_off_are_one(response, curve):
    signals = [one.assign(mass_flow_rate=one.mass_flow_rate * (1 + 4e-16)) for one in all_signals(response)]
    assert (gathered(signals, response, curve).study_status == 0).all()


def test_a_signal_too_few_or_too_many_is_refused(response, curve):
    signals = all_signals(response)
    with pytest.raises(
        ValueError, match=r"1 sight lines have no signal, the first at 60 kW, 50 mbar, 16 g/s"
    ):
        gathered(signals[1:], response, curve)
    with pytest.raises(ValueError, match="no condition needs, or the second one there"):
        gathered([*signals, signals[0]], response, curve)
    stranger = signal_of((61e3, 5e3, 0.016, 0.5), response)
    with pytest.raises(ValueError, match="61 kW, 50 mbar, 16 g/s"):
        gathered([*signals, stranger], response, curve)
    with pytest.raises(ValueError, match=r"emittance must lie in \(0, 1\]"):
        gathered([], response, curve, [(6e4, 5e3, 0.016, 1.1, 0.5)])


PLACE = dict(numerical_power=6e4, chamber_pressure=5e3, mass_flow_rate=0.016)


@pytest.mark.parametrize(
    ("fault", "status"), [(Extinguished, stage.EXTINGUISHED), (NotConverged, stage.UNSTEADY)]
)
def test_a_flow_that_does_not_exist_is_a_result(monkeypatch, fault, status):
    def no_flow(gas, start, **_):
        raise fault("the plasma goes out between here and there")

    monkeypatch.setattr(stage.flow_stage, "condition", no_flow)
    result = stage.flow(None, None, **PLACE)
    contracts.check(contracts.label(result, "study_flow"), "study_flow")
    assert int(result.flow_status) == status
    assert result.attrs["reason"] == "the plasma goes out between here and there"
    found = stage.signal(
        result,
        None,
        angle=0.6,
        points=20,
        window_distance=0.8,
        instrument_distance=1.0,
        laboratory_temperature=300.0,
        laboratory_pressure=101325.0,
        wavelength_range=(7e-7, 1.2e-6),
        grid_points=160_000,
        slit_fwhm=7.5e-10,
    )
    contracts.check(contracts.label(found, "study_signal"), "study_signal")
    assert int(found.flow_status) == status and float(found.numerical_power) == 6e4
    assert np.isnan(found.gas_signal).all() and np.isnan(found.peak_temperature)


def test_any_other_fault_is_not_hidden(monkeypatch):
    def broken(gas, start, **_):
        raise ValueError("mesh_factor must be > 0")

    monkeypatch.setattr(stage.flow_stage, "condition", broken)
    with pytest.raises(ValueError, match="mesh_factor"):
        stage.flow(None, None, **PLACE)


def test_a_flow_starts_from_those_of_its_chain_that_exist(monkeypatch):
    taken = {}

    takes = inspect.signature(stage.flow_stage.condition)

    def condition(*arguments, **settings):
        bound = takes.bind(*arguments, **settings).arguments
        taken.update(bound | bound["target"])
        return xr.Dataset(attrs={"origin": "modelled"})

    monkeypatch.setattr(stage.flow_stage, "condition", condition)
    known = [xr.Dataset({"numerical_power": 1.0 * k, "flow_status": s}) for k, s in enumerate((0, 1, 0, 2))]
    foreign = xr.Dataset({"numerical_power": 9.0})
    others = {name for name, one in takes.parameters.items() if one.default is one.empty}
    rest = others - {"gas", "start", "error_mesh_ratio", "target", *PLACE}
    settings = {**dict.fromkeys(rest, 1.0), "power_step": 1e4}
    result = stage.flow(None, None, known=known, neighbours=[foreign], **settings, **PLACE)
    assert [float(one.numerical_power) for one in taken["neighbours"]] == [0.0, 2.0, 9.0]
    assert all("flow_status" not in one for one in taken["neighbours"])
    assert (taken["power_step"], taken["numerical_power"], taken["error_mesh_ratio"]) == (1e4, 6e4, 0.0)
    assert int(result.flow_status) == stage.COMPUTED


def test_only_files_of_a_study_may_have_gaps(response):
    place = (60e3, 5e3, 0.016, 0.5)
    lost = contracts.label(signal_of(place, response, 1), "study_signal")
    contracts.check(lost, "study_signal")
    whole = xr.Dataset(
        {
            "gas_signal": (("condition", "band"), np.full((1, 2), np.nan)),
            "numerical_power": ("condition", [1.0]),
            "sample_emittance": ("condition", [1.0]),
        },
        {"condition": ["a"], "band": list(stage.BANDS)},
    )
    with pytest.raises(contracts.ContractError, match="gas_signal: NaN not allowed"):
        contracts.check(contracts.label(whole, "gas_signal"), "gas_signal")
