"""Rules for a calibration: points that it does not explain."""

import numpy as np

from plasmapyro.instrument.pyrometer import blackbody_signals
from plasmapyro.instrument.spectrometer import NORMAL_MAD
from plasmapyro.quality.rule import rule
from plasmapyro.radiation.bandsignal import BANDS


@rule()
def points_leave_curve(case, limit):
    rest = case.calibration.model_residual.values
    worst = int(np.argmax(np.abs(rest)))
    if abs(rest[worst]) <= limit:
        return None
    return {"kelvin": float(case.calibration.source_temperature.values[worst]), "off": float(rest[worst])}


@rule()
def bands_unlike(case, limit):
    phi = float(case.calibration.sensitivity_ratio)
    if 1 / limit < phi < limit:
        return None
    more, less = BANDS if phi > 1 else BANDS[::-1]
    return {"more": more, "less": less, "factor": max(phi, 1 / phi)}


def level_residuals(points, response):
    """Residuals (2, N) of the signals of calibration points about the modelled ones, logarithmic."""
    signals = np.array([points[f"signal_{band}"].values for band in BANDS])
    rest = np.log(signals / blackbody_signals(points.source_temperature.values, response))
    return rest - np.median(rest, axis=1, keepdims=True)


@rule()
def levels_leave_curve(case, limit):
    rest = level_residuals(case.points, case.response)
    band, worst = np.unravel_index(np.argmax(np.abs(rest)), rest.shape)
    if abs(rest[band, worst]) <= limit:
        return None
    return {
        "kelvin": float(case.points.source_temperature.values[worst]),
        "band": BANDS[band],
        "off": float(np.expm1(rest[band, worst])),
    }


@rule()
def source_dark(case, limit):
    net = case.exposures.exposure_counts.values - case.exposures.exposure_dark.values
    for number, row in enumerate(net, 1):
        row = row[np.isfinite(row)]
        noise = NORMAL_MAD * np.median(np.abs(np.diff(row))) if row.size > 1 else 0.0
        if np.median(row) < -limit * noise / np.sqrt(row.size):
            return {"number": number, "share": float(np.mean(row < 0))}
    return None


@rule()
def rates_disagree(case, limit):
    data = case.exposures
    counts, duration = data.exposure_counts.values, data.exposure_time.values[:, None]
    net = counts - data.exposure_dark.values
    rates, told = net / duration, np.isfinite(net) & (counts < data.attrs.get("saturation_counts", 6e4))
    for second in range(1, len(net)):
        pair = [0, second]
        # What each should count, by the brighter of the two: a dark that holds the light leaves nothing.
        due = np.fmax(rates[0], rates[second]) * duration[pair]
        both = (due > 0.02 * np.nanmax(net)).all(axis=0) & told[pair].all(axis=0)
        if both.sum() < 10:
            continue
        first, other = np.maximum(np.median(rates[pair][:, both], axis=1), 0.0)
        factor = float(other / first) if first > 0 else np.inf
        if not np.exp(-limit) <= factor <= np.exp(limit):
            return {"first": 1, "second": second + 1, "factor": factor}
    return None
