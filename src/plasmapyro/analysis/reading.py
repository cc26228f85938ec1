"""From a displayed temperature back to that of the surface, where only the display was logged."""

import numpy as np
import xarray as xr

from plasmapyro.analysis.heated_through import heated_through, scatter
from plasmapyro.checks import flags, non_negative, positive
from plasmapyro.instrument.pyrometer import blackbody_signals, invert_ratio
from plasmapyro.radiation.bandsignal import BANDS

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
    5: "beyond_the_surfaces_considered",
    6: "without_a_reading",
}


def correct_reading(
    gas, response, curve, *, condition, time, reading, slope=1.0, quantum=0.0, floor=0.0, at_least=0.0,
    noise=None, emittance=None, emittance_uncertainty, power_uncertainty, engine_uncertainty, draws, seed,
):  # fmt: skip
    r"""Surface temperature behind the computed gas of a condition, from what a pyrometer displayed.

    .. math:: T_{app} = H_c^{-1}\!\Big(\frac{\phi}{s}\,
              \frac{\varepsilon B_w(T) + G_w}{\varepsilon B_n(T) + G_n}\Big)

    is inverted for T. From cold surfaces, where the gas is read, the display falls to a least value and
    rises again with the surface: one reading belongs to two surfaces. The hot one is `surface_temperature`,
    the cold one `other_temperature`, unless the surface is known to be at least so warm. Where the record
    shows the surface heated through the least reading (`heated_through`), that reading tells the gas, and
    before that moment the surface is the cold one.

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
        Step of the display; standard deviation of one reading, by default the scatter of the record.
    floor, at_least : float [K]
        Least temperature the instrument displays, also for colder surfaces; surface known to be no colder (a
        thermocouple below it): if that is above the turn, no surface was heated through it.
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
    for name, value in (("quantum", quantum), ("floor", floor)):
        non_negative(name, value, "K")
    positive("slope", slope, "1")
    case = gas.sel(condition=condition)
    emittance = float(positive("emittance", case.sample_emittance if emittance is None else emittance, "1"))
    reading, time = np.asarray(reading, dtype=float), np.asarray(time, dtype=float)
    surfaces = np.arange(SURFACES[0], SURFACES[1] + STEP / 2, STEP)
    black = blackbody_signals(surfaces, response)
    # What an instrument shows at the end of its display may be anything colder.
    at_floor = reading <= floor + quantum / 2
    noise = scatter(reading) if noise is None else non_negative("noise", noise, "K")

    def display(light, black=black):
        """Display of black bodies' signals behind gas whose signals over the emittance are exp(light)."""
        wide, narrow = black + np.exp(light)[:, None]
        shown, _ = invert_ratio(
            float(curve.sensitivity_ratio) * wide / narrow / slope,
            curve.calibration_temperature.values,
            curve.calibration_ratio.values,
        )
        return np.where(np.isnan(shown), np.inf, shown)

    def at(surface, light):
        """Display of surfaces [K]."""
        shown = display(light, np.stack([np.interp(surface, surfaces, one) for one in black]))
        return np.minimum(shown, curve.calibration_temperature.values[-1])

    def turn(light):
        shown = display(light)
        return surfaces[_turn(shown)], shown.min()

    light = np.log(case.gas_signal.sel(band=list(BANDS)).values / emittance)
    along = power_uncertainty * _elasticity(gas, condition, power_uncertainty)
    covariance = np.outer(along, along) + engine_uncertainty**2 * np.eye(2) + emittance_uncertainty**2
    moment = np.nan
    if at_least < turn(light)[0]:
        seen, sigma = np.where(at_floor, np.nan, reading), np.hypot(noise, quantum / np.sqrt(12.0))
        passed = heated_through(time, seen, at, turn, light, covariance, sigma)
        light, covariance, moment = passed or (light, covariance, moment)
    before = time < moment  # the surface is still colder than that of the least reading
    shown = display(light)
    turn = _turn(shown)

    def surface(reading, shown):
        """Surfaces of readings on the cold and on the hot branch."""
        place = _turn(shown)
        cold = _on_branch(reading, shown[: place + 1][::-1], surfaces[: place + 1][::-1])
        return cold, _on_branch(reading, shown[place:], surfaces[place:])

    cold, hot = surface(reading, shown)
    two = np.isfinite(cold) & (cold >= at_least) & np.isnan(moment)
    found = np.where(before, cold, hot)
    random, root = np.random.default_rng(seed), _root(covariance)
    drawn = np.empty((draws, reading.size))
    for row in drawn:
        own = light + root @ random.standard_normal(2)
        true = reading + noise * random.standard_normal(reading.size)
        true = true + quantum * (random.random(reading.size) - 0.5)
        row[:] = np.where(before, *surface(true, display(own)))
    known = np.isfinite(drawn).mean(axis=0)
    low, high = np.full((2, reading.size), np.nan)
    sure = np.isfinite(found) & (known >= LEAST_SHARE)
    if sure.any():
        low[sure], high[sure] = np.nanquantile(drawn[:, sure], QUANTILES, axis=0)
    status = np.where(two, 1, 0)
    status[np.isfinite(found) & ~sure] = 4
    status[~np.isfinite(found)] = 5
    status[reading < shown[turn]] = 2
    status[at_floor] = 3
    status[np.isnan(reading)] = 6
    given = np.isin(status, (0, 1))
    return xr.Dataset(
        {
            "apparent_temperature": ("time", reading),
            "surface_temperature": ("time", np.where(given, found, np.nan)),
            "surface_temperature_low": ("time", np.where(given, low, np.nan)),
            "surface_temperature_high": ("time", np.where(given, high, np.nan)),
            "other_temperature": ("time", np.where(given & two, cold, np.nan)),
            "corrected_reading_status": ("time", status.astype("int8"), flags(STATUS)),
            "object_temperature": ("object_temperature", surfaces),
            "display": ("object_temperature", np.where(np.isfinite(shown), shown, np.nan)),
        },
        {"time": time},
        {
            "least_reading": float(shown[turn]),
            "turning_temperature": float(surfaces[turn]),
            "heated_through": float(moment),
            "noise": float(noise),
        },
    )


def _root(covariance):
    """Matrix R with R R^T = covariance, also of one without any uncertainty."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))


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
