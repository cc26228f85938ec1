"""From a displayed temperature back to that of the surface, where only the display was logged."""

import numpy as np
import xarray as xr

from plasmapyro.checks import flags, non_negative, positive
from plasmapyro.instrument.pyrometer import blackbody_signals, invert_ratio

BANDS = ("wide", "narrow")
STEP = 2.0  # [K] between the surface temperatures at which the reading is known
SURFACES = (500.0, 4000.0)  # [K]
QUANTILES = (0.025, 0.975)
LEAST_SHARE = 0.95  # of the draws that must know a surface for an interval to be given
STATUS = {
    0: "one_surface_temperature",
    1: "two_surface_temperatures",
    2: "below_what_the_gas_allows",
    3: "below_the_floor_of_the_instrument",
    4: "near_the_least_reading_of_the_gas",
    5: "above_the_surfaces_considered",
    6: "without_a_reading",
}


def correct_reading(
    gas, response, curve, *, condition, time, reading, slope=1.0, quantum=0.0, floor=0.0, at_least=0.0,
    noise=0.0, emittance=None, emittance_uncertainty, power_uncertainty, engine_uncertainty, draws, seed,
):  # fmt: skip
    r"""Surface temperature behind the computed gas of a condition, from what a pyrometer displayed.

    .. math:: T_{app} = H_c^{-1}\!\Big(\frac{\phi}{s}\,
              \frac{\varepsilon B_w(T) + G_w}{\varepsilon B_n(T) + G_n}\Big)

    is inverted for T. From cold surfaces, where the gas is read, the display falls to a least value and
    rises again with the surface: one reading belongs to two surfaces. The hot one is `surface_temperature`,
    the cold one `other_temperature`, unless the surface is known to be at least so warm.

    The interval holds 95 % of draws over power (which moves both gas signals along those of the other
    conditions), the signals of both bands, emittance, noise and the quantum of the display.

    ValueError: an unknown condition, an argument out of range, or a power uncertainty with one condition
    only.

    Parameters
    ----------
    gas, response, curve : Datasets, contracts 'gas_signal', 'response', 'ratio_curve'
    condition : str
    time : (t,) array [s], strictly increasing
    reading : (t,) array [K]
        NaN where there was none.
    slope : float [1]
        Setting of the instrument: ratio of the emittances (wide over narrow) it was told.
    quantum, noise : float [K]
        Step of the display; standard deviation of one reading.
    floor, at_least : float [K]
        Least temperature the instrument displays; surface known to be no colder (a thermocouple below it).
    emittance : float [1], optional
        That of the condition by default.
    emittance_uncertainty, power_uncertainty, engine_uncertainty : float [1]
        Relative standard uncertainties; the last of each band's gas signal, independent in both (ASSUME).
    draws, seed : int

    Returns
    -------
    Dataset, contract 'corrected_reading'
    """
    names = list(gas.condition.values)
    if condition not in names:
        raise ValueError(f"no condition '{condition}'; known: {', '.join(map(str, names))}")
    for name, value in (("quantum", quantum), ("noise", noise), ("floor", floor)):
        non_negative(name, value, "K")
    positive("slope", slope, "1")
    case = gas.sel(condition=condition)
    emittance = float(positive("emittance", case.sample_emittance if emittance is None else emittance, "1"))
    signal = case.gas_signal.sel(band=list(BANDS)).values
    reading = np.asarray(reading, dtype=float)
    surfaces = np.arange(SURFACES[0], SURFACES[1] + STEP / 2, STEP)
    black = blackbody_signals(surfaces, response)

    def branches(light, grey):
        """Display over the surfaces, with the place of its least value."""
        ratio = (grey * black[0] + light[0]) / (grey * black[1] + light[1])
        shown, _ = invert_ratio(
            float(curve.sensitivity_ratio) * ratio / slope,
            curve.calibration_temperature.values,
            curve.calibration_ratio.values,
        )
        shown = np.where(np.isnan(shown), np.inf, shown)
        return shown, _turn(shown)

    shown, turn = branches(signal, emittance)
    hot = _on_branch(reading, shown[turn:], surfaces[turn:])
    cold = _on_branch(reading, shown[: turn + 1][::-1], surfaces[: turn + 1][::-1])
    two = np.isfinite(cold) & (cold >= at_least)
    random = np.random.default_rng(seed)
    elasticity = _elasticity(gas, condition, power_uncertainty)
    drawn = np.empty((draws, reading.size))
    for row in drawn:
        power = power_uncertainty * random.standard_normal()
        light = signal * np.exp(elasticity * power + engine_uncertainty * random.standard_normal(2))
        grey = emittance * np.exp(emittance_uncertainty * random.standard_normal())
        true = reading + noise * random.standard_normal(reading.size)
        true = true + quantum * (random.random(reading.size) - 0.5)
        there, place = branches(light, grey)
        row[:] = _on_branch(true, there[place:], surfaces[place:])
    known = np.isfinite(drawn).mean(axis=0)
    low, high = np.full((2, reading.size), np.nan)
    sure = np.isfinite(hot) & (known >= LEAST_SHARE)
    if sure.any():
        low[sure], high[sure] = np.nanquantile(drawn[:, sure], QUANTILES, axis=0)
    status = np.where(two, 1, 0)
    status[np.isfinite(hot) & ~sure] = 4
    status[~np.isfinite(hot)] = 2
    status[reading > shown[-1]] = 5
    status[reading < floor] = 3
    status[np.isnan(reading)] = 6
    given = np.isin(status, (0, 1))
    return xr.Dataset(
        {
            "apparent_temperature": ("time", reading),
            "surface_temperature": ("time", np.where(given, hot, np.nan)),
            "surface_temperature_low": ("time", np.where(given, low, np.nan)),
            "surface_temperature_high": ("time", np.where(given, high, np.nan)),
            "other_temperature": ("time", np.where(given & two, cold, np.nan)),
            "corrected_reading_status": ("time", status.astype("int8"), flags(STATUS)),
            "object_temperature": ("object_temperature", surfaces),
            "display": ("object_temperature", np.where(np.isfinite(shown), shown, np.nan)),
        },
        {"time": np.asarray(time, dtype=float)},
        {"least_reading": float(shown[turn]), "turning_temperature": float(surfaces[turn])},
    )


def _turn(shown):
    """Place of the least display; the coldest surface where there is no gas."""
    return int(np.argmin(shown))


def _on_branch(reading, shown, surfaces):
    """Surface of each reading on a rising branch; NaN off it."""
    finite = np.isfinite(shown)
    if not finite.any():  # gas so bright that the display is off its scale for every surface
        return np.full(np.shape(reading), np.nan)
    shown, surfaces = shown[finite], surfaces[finite]
    rising = np.concatenate([[True], np.diff(np.maximum.accumulate(shown)) > 0])
    return np.interp(reading, shown[rising], surfaces[rising], left=np.nan, right=np.nan)


def _elasticity(gas, condition, power_uncertainty):
    """d ln(gas signal) / d ln(power) of both bands at a condition, from its neighbours on the same ladder."""
    if not power_uncertainty:
        return np.zeros(len(BANDS))
    if "first_of_ladder" in gas:
        gas = gas.isel(condition=(gas.first_of_ladder == gas.first_of_ladder.sel(condition=condition)).values)
    ordered = gas.sortby("numerical_power")
    power = np.log(ordered.numerical_power.values)
    if len(np.unique(power)) < 2:
        raise ValueError(
            "the uncertainty of the power needs a second condition that differs in its power only, to know"
            " what power does to the gas; compute one, or set it to 0"
        )
    place = list(ordered.condition.values).index(condition)
    light = np.log(ordered.gas_signal.sel(band=list(BANDS)).values)
    slope = np.gradient(light, power, axis=0) if len(power) > 2 else np.diff(light, axis=0) / np.diff(power)
    return slope[min(place, len(slope) - 1)]
