"""Rules for a calibration: points that it does not explain."""

import numpy as np

from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.quality.rule import BANDS, rule
from plasmapyro.quality.series import SIGMA


@rule(
    "points_leave_curve",
    looks_at="ratio of the calibration points over the modelled curve",
    needs=("calibration",),
    limit=0.04,
    unit="1",
    reason="1 % per signal and 3 K of the source make 1.5 %; temperatures in Celsius taken as K make 5 to"
    " 15 %",
    says="at {kelvin:g} K the ratio of the calibration points is {off:+.1%} off the modelled curve",
    remedy="see whether source_temperature is in the unit stated (degC or K), and no point is mistyped",
)
def points_leave_curve(case, limit):
    rest = case.calibration.model_residual.values
    worst = int(np.argmax(np.abs(rest)))
    if abs(rest[worst]) <= limit:
        return None
    return {"kelvin": float(case.calibration.source_temperature.values[worst]), "off": float(rest[worst])}


def level_residuals(points, response):
    """Residuals (2, N) of the signals of calibration points about the modelled ones, logarithmic."""
    rows = []
    for band in BANDS:
        curve = blackbody_signal(
            points.source_temperature.values,
            response.wavelength.values,
            response[f"responsivity_{band}"].values,
        )
        rest = np.log(points[f"signal_{band}"].values / curve)
        rows.append(rest - np.median(rest))
    return np.array(rows)


@rule(
    "levels_leave_curve",
    looks_at="level of the calibration points over the modelled one",
    needs=("points", "response"),
    limit=0.25,
    unit="1",
    reason="a response that ends 1 % off in wavelength bends the levels by 7 %; Celsius taken as K makes a"
    " factor of two and more, a mistyped or clipped point tens of per cent",
    says="at {kelvin:g} K signal_{band} of the calibration points is {off:+.0%} off what Planck's law gives"
    " from the others",
    remedy="see whether source_temperature is in the unit stated (degC or K), the point is mistyped, or the"
    " amplifier"
    " was at its end",
)
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


@rule(
    "source_dark",
    looks_at="net counts of the exposures of the source",
    needs=("exposures",),
    limit=3.0,
    unit="standard deviations",
    reason="the source adds light in most pixels; below the dark it is exchanged with it",
    says="exposure {number} of the source is darker than its dark in {share:.0%} of the pixels",
    remedy="exchange `light` and `dark`, or measure the dark again",
)
def source_dark(case, limit):
    net = case.exposures.exposure_counts.values - case.exposures.exposure_dark.values
    for number, row in enumerate(net, 1):
        row = row[np.isfinite(row)]
        noise = SIGMA * np.median(np.abs(np.diff(row))) if row.size > 1 else 0.0
        if np.median(row) < -limit * noise / np.sqrt(row.size):
            return {"number": number, "share": float(np.mean(row < 0))}
    return None


@rule(
    "rates_disagree",
    looks_at="count rates of the exposures of one source against each other",
    needs=("exposures",),
    limit=0.1,
    unit="1",
    reason="one source gives one rate; a tenth allows for a detector that is not quite linear",
    says="exposures {first} and {second} of one source give count rates that differ by a factor of"
    " {factor:.3g}",
    remedy="check the integration times, and that light and dark belong together",
)
def rates_disagree(case, limit):
    data = case.exposures
    net = data.exposure_counts.values - data.exposure_dark.values
    usable = (net > 0.02 * np.nanmax(net)) & (
        data.exposure_counts.values < data.attrs.get("saturation_counts", 6e4)
    )
    for second in range(1, len(net)):
        both = usable[0] & usable[second]
        if both.sum() < 10:
            continue
        rates = net[:, both] / data.exposure_time.values[:, None]
        factor = float(np.median(rates[second] / rates[0]))
        if abs(np.log(factor)) > limit:
            return {"first": 1, "second": second + 1, "factor": factor}
    return None
