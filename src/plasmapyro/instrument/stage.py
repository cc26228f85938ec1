"""Stages of the instrument: responses, calibration of the pyrometer, calibration of the spectrometer."""

import numpy as np
import xarray as xr

from plasmapyro import tables
from plasmapyro.checks import counted, flags, increasing, positive
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.instrument import calibration, raw_counts, spectrometer
from plasmapyro.instrument.pyrometer import blackbody_signals, calibration_ratio
from plasmapyro.instrument.response import sandwich_response, silicon_absorption
from plasmapyro.instrument.shape import planck_shape
from plasmapyro.radiation.bandsignal import BANDS, two_bands

SLOPE_STEP = 1e-4  # relative half step of central differences: error 1e-8 of the slope


def band_response(
    *,
    silicon_table,
    top_thickness,
    bottom_thickness,
    short_wavelength_edge,
    edge_sigma,
    long_wavelength_limit,
    wavelength_step,
):
    """Modelled responses of the two bands of a sandwich silicon pyrometer.

    The grid runs from six edge widths below the long-pass edge to the long limit, beyond which both
    responses are taken as zero.

    Source: Fagnani et al., sec. 3.2 (bands 0.75 to 1.15 um and 0.95 to 1.15 um). Deviation: the
    maker's manual (MR1S rev. E2) ends both bands at 1.1 um; the paper's limit is the default here.
    ASSUME: the printed band limits are feet of the curves, about a tenth of the peak: with the top
    layer that puts the foot of the narrow band at 0.95 um, the silicon tail reaches a tenth of the
    peak near the printed long limit as well, which half-height limits would not.

    Parameters
    ----------
    silicon_table : str
        Table in `data/detector`, e.g. 'silicon_green_2008'.
    top_thickness, bottom_thickness : float [m]
        Layers of the detector; the top one sets where the narrow band begins.
    short_wavelength_edge, edge_sigma : float [m]
        Position and width of the long-pass filter.
    long_wavelength_limit : float [m]
        End of both bands.
    wavelength_step : float [m]
        Spacing of the samples, at most; the last sample falls on the limit.

    Returns
    -------
    Dataset, contract 'response', origin 'modelled'
    """
    table = tables.load(f"detector/{silicon_table}")
    start = short_wavelength_edge - 6 * edge_sigma
    if not start < long_wavelength_limit:
        raise ValueError(
            f"long_wavelength_limit must exceed the long-pass edge; got {long_wavelength_limit:g} m"
            f" against {short_wavelength_edge:g} m"
        )
    count = int(np.ceil((long_wavelength_limit - start) / wavelength_step * (1 - 1e-9))) + 1
    wavelength = np.linspace(start, long_wavelength_limit, count)
    wide, narrow = sandwich_response(
        wavelength,
        silicon_absorption(wavelength, table["wavelength"], table["absorption_coefficient"]),
        top_thickness=top_thickness,
        bottom_thickness=bottom_thickness,
        edge=short_wavelength_edge,
        edge_sigma=edge_sigma,
    )
    return xr.Dataset(
        {"responsivity_wide": ("wavelength", wide), "responsivity_narrow": ("wavelength", narrow)},
        {"wavelength": wavelength},
        {
            "origin": tables.weakest(["modelled", table.origin]),
            "references": f"Modelled layered silicon detector; absorption: {table.source}",
        },
    )


def ratio_curve(response, *, sensitivity_ratio, calibration_temperature, instrument_range):
    """Modelled signal ratio of a black body, :math:`H_c(T)`, for a stated sensitivity ratio.

    Source: Fagnani et al., eq. 5; the sensitivity ratio 0.315 from their sec. 3.2.

    Parameters
    ----------
    response : Dataset, contract 'response'
    sensitivity_ratio : float [1]
        It cancels in readings that are simulated and inverted with the same curve.
    calibration_temperature : (C,) array [K], strictly increasing
    instrument_range : (2,) floats [K]

    Returns
    -------
    Dataset, contract 'ratio_curve'
        Of an instrument of other bands the signals of a black body instead of a ratio.
    """
    curve = increasing("calibration_temperature", calibration_temperature, "K")
    black = blackbody_signals(curve, response)
    if "responsivity" in response:  # no one ratio: signals of a black body, for readings that take it as grey
        own = {"calibration_signal": (("band", "calibration_temperature"), black)}
        own["instrument_range"] = ("bound", np.asarray(response.attrs["instrument_range"], dtype=float))
        return xr.Dataset(own, {"calibration_temperature": curve, "band": response.band.values})
    phi = float(positive("sensitivity_ratio", sensitivity_ratio, "1"))
    return xr.Dataset(
        {
            "sensitivity_ratio": phi,
            "calibration_ratio": ("calibration_temperature", calibration_ratio(phi, black)),
            "instrument_range": ("bound", increasing("instrument_range", instrument_range, "K")),
        },
        {"calibration_temperature": curve},
    )


def pyrometer_calibration(
    response,
    calibration_points,
    *,
    source_temperature_uncertainty,
    signal_uncertainty,
    instrument_range,
    calibration_temperature,
    draws,
    seed,
):
    """Sensitivities, modelled ratio curve and quadratic fit of a pyrometer, with their uncertainties.

    Source: Fagnani et al., eqs. 5 and 6 and sec. 3.2.

    ValueError: missing or non-positive signals, fewer than four temperatures, or a quadratic fit that does
    not rise over the instrument range.

    Parameters
    ----------
    response : Dataset, contract 'response'
    calibration_points : Dataset, contract 'calibration_points', without missing samples
    source_temperature_uncertainty : float [K]
    signal_uncertainty : float [1]
        Relative standard uncertainty of one signal.
    instrument_range : (2,) floats [K]
        Lowest and highest temperature the instrument reads.
    calibration_temperature : (C,) array [K], strictly increasing
        Where the curves are tabulated; may reach beyond the instrument range.
    draws : int
        Monte Carlo draws behind `temperature_uncertainty`.
    seed : int

    Returns
    -------
    Dataset, contract 'calibration'
    """
    response = two_bands(response, "the calibration of a two-colour pyrometer")
    curve = increasing("calibration_temperature", calibration_temperature, "K")
    span = increasing("instrument_range", instrument_range, "K")
    source = positive("source_temperature", calibration_points.source_temperature.values, "K")
    signals = [positive(f"signal_{band}", calibration_points[f"signal_{band}"].values, "A") for band in BANDS]

    def modelled(temperature):
        return blackbody_signals(temperature, response)

    def covariance(logarithm, count):
        step = SLOPE_STEP * source
        slope = (logarithm(source + step) - logarithm(source - step)) / (2 * step)
        return calibration.point_covariance(slope, source_temperature_uncertainty, signal_uncertainty, count)

    def log_ratio(temperature):
        wide, narrow = modelled(temperature)
        return np.log(wide / narrow)

    for band, light in zip(BANDS, modelled(source), strict=True):
        positive(f"light that responsivity_{band} takes in", light, "W m-2 sr-1")
    ratio, ratio_covariance = signals[0] / signals[1], covariance(log_ratio, 2)
    sensitivity_ratio, ratio_uncertainty = calibration.fit_sensitivity(
        ratio, np.exp(log_ratio(source)), ratio_covariance
    )
    absolute = [
        calibration.fit_sensitivity(
            signals[band],
            modelled(source)[band],
            covariance(lambda temperature, band=band: np.log(modelled(temperature)[band]), 1),
        )
        for band in range(len(BANDS))
    ]
    coefficient, coefficient_covariance, fit_range = calibration.fit_quadratic(
        source, ratio, ratio_covariance
    )
    calibration.require_rising(coefficient, fit_range, span)
    readable = (curve >= span[0]) & (curve <= span[1])
    fitted, uncertainty = np.full((2, curve.size), np.nan)
    fitted[readable] = calibration.quadratic_ratio(curve[readable], coefficient, fit_range)
    uncertainty[readable] = calibration.reading_uncertainty(
        curve[readable],
        coefficient,
        coefficient_covariance,
        fit_range,
        signal_uncertainty,
        draws,
        np.random.default_rng(seed),
    )
    point, table, power = "calibration_point", "calibration_temperature", "fit_power"
    model_ratio = sensitivity_ratio * np.exp(log_ratio(source))
    return xr.Dataset(
        {
            "sensitivity_ratio": sensitivity_ratio,
            "sensitivity_ratio_uncertainty": ratio_uncertainty,
            "absolute_sensitivity": ("band", [value for value, _ in absolute]),
            "absolute_sensitivity_uncertainty": ("band", [value for _, value in absolute]),
            "source_temperature": (point, source),
            "point_ratio": (point, ratio),
            "model_residual": (point, ratio / model_ratio - 1),
            "fit_residual": (point, ratio / calibration.quadratic_ratio(source, coefficient, fit_range) - 1),
            "calibration_ratio": (table, sensitivity_ratio * np.exp(log_ratio(curve))),
            "fitted_ratio": (table, fitted),
            "temperature_uncertainty": (table, uncertainty),
            "fit_coefficient": (power, coefficient),
            "fit_covariance": ((power, "other_fit_power"), coefficient_covariance),
            "fit_range": ("bound", fit_range),
            "instrument_range": ("bound", span),
        },
        {"band": list(BANDS), "calibration_temperature": curve},
        {"origin": "modelled", "signal_uncertainty": float(signal_uncertainty)},
    )


def spectrometer_calibration(
    spectrometer_counts, *, source_temperature_uncertainty, saturation_counts, least_net_counts, noise_block
):
    """Calibration factor of a spectrometer, its noise, and which pixels can be used.

    Source: Fagnani et al., eq. 9.

    ValueError: a missing attribute, or no usable pixel.

    Parameters
    ----------
    spectrometer_counts : Dataset, contract 'spectrometer_counts'
        With the attributes `source_temperature` [K] and `integration_time` [s].
    source_temperature_uncertainty : float [K]
    saturation_counts : float [count]
        Raw counts from here on are saturated.
    least_net_counts : float [count]
        Net counts up to here are no signal.
    noise_block : int
        Pixels per noise estimate.

    Returns
    -------
    Dataset, contract 'spectrometer_calibration'
    """
    missing = {"source_temperature", "integration_time"} - set(spectrometer_counts.attrs)
    if missing:
        raise ValueError(f"spectrometer_counts lacks the attributes {', '.join(sorted(missing))}")
    temperature = float(spectrometer_counts.attrs["source_temperature"])
    wavelength = increasing("wavelength", spectrometer_counts.wavelength.values, "m")
    counts = spectrometer_counts.calibration_counts.values
    background = spectrometer_counts.calibration_background.values
    status = spectrometer.pixel_status(counts, background, saturation_counts, least_net_counts)
    usable = status == spectrometer.USABLE
    if not usable.any():
        raise ValueError(
            f"no usable pixel in the spectrometer calibration: of {usable.size},"
            f" {np.sum(status == spectrometer.SATURATED)} are saturated,"
            f" {np.sum(status == spectrometer.NO_SIGNAL)} without signal,"
            f" {np.sum(status == spectrometer.MISSING)} missing"
        )
    net = np.where(usable, counts - background, np.nan)
    factor = spectrometer.calibration_factor(
        wavelength, net, 0.0, temperature, spectrometer_counts.attrs["integration_time"]
    )
    return xr.Dataset(
        {
            "calibration_factor": ("wavelength", factor),
            "calibration_factor_uncertainty": (
                "wavelength",
                spectrometer.local_noise(net, noise_block) / net,
            ),
            "pixel_status": ("wavelength", status, flags(spectrometer.STATUS)),
            "source_temperature": temperature,
            "source_temperature_uncertainty": float(source_temperature_uncertainty),
        },
        {"wavelength": wavelength},
    )


def calibrate_exposures(exposures, *, saturation_counts, least_net_counts, noise_block, fit_range=None):
    r"""Calibration factor of a spectrometer from raw exposures of a certified source.

    .. math:: f_\lambda = \tau_\lambda L^{source}_\lambda / \bar r_\lambda

    with the mean linear rate of the exposures, each pixel from those in which it is usable.

    Source: Fagnani et al., eq. 9. Deviation: the paper subtracts one background and takes counts as
    linear; the dark's scale, linearity and several exposures are ours.

    ValueError: no usable pixel, or a dark without pattern.

    Parameters
    ----------
    exposures : Dataset, contract 'spectrometer_exposures'
        With the facts of the detector that a calibration folder states, as attributes:
        `linearity_coefficients` (K,) [count^-k], see `raw_counts.linear_signal`, (1,) for a linear detector;
        `linearity_uncertainty` [1], relative and standard, left after that; `hot_threshold` [1], standard
        deviations by which a hot pixel exceeds its neighbours in the dark; `transmittance` [1] of what stood
        before the source and will not stand before the test; perhaps `masked_pixels`, indices (negative from
        the end) that no light reaches and that settle after the bright ones; `dim_range` (2,) [m], where the
        source is dark enough to see the pattern of the dark current (without it each dark is taken as it
        is); `saturation_counts` [count].
    saturation_counts : float [count]
        Raw counts from here on are saturated, where the exposures state none.
    least_net_counts : float [count]
        Net counts up to here are no signal.
    noise_block : int
        Pixels per noise estimate.
    fit_range : (2,) floats [m], optional
        Pixels beyond it are left out of every fit to spectra.

    Returns
    -------
    Dataset, contract 'spectrometer_calibration'
        `calibration_factor_uncertainty` is independent from pixel to pixel, `calibration_factor_common`
        (source, linearity, dark) is not. `source_temperature` is that of the source's shape.
    """
    facts = exposures.attrs
    linearity_coefficients = np.atleast_1d(facts["linearity_coefficients"])
    masked_pixels = np.atleast_1d(facts.get("masked_pixels", np.array([], dtype=int)))
    dim_range, transmittance = facts.get("dim_range"), float(facts["transmittance"])
    saturation_counts = float(facts.get("saturation_counts", saturation_counts))
    wavelength = increasing("wavelength", exposures.wavelength.values, "m")
    counts, dark = exposures.exposure_counts.values, exposures.exposure_dark.values
    times = positive("exposure_time", exposures.exposure_time.values, "s")
    dim = None if dim_range is None else (wavelength >= dim_range[0]) & (wavelength <= dim_range[1])
    parts = [
        raw_counts.net_rate(
            light,
            black,
            integration_time=time,
            coefficients=linearity_coefficients,
            masked=masked_pixels,
            dim=dim,
            noise_block=noise_block,
        )
        for light, black, time in zip(counts, dark, times, strict=True)
    ]
    rates, noises, commons, scales = (np.array(part) for part in zip(*parts, strict=True))
    status = spectrometer.pixel_status(counts, dark, saturation_counts, -np.inf)
    weak = (status == spectrometer.USABLE) & ~(rates * times[:, None] > least_net_counts)
    status[weak] = spectrometer.NO_SIGNAL
    hot = np.stack([raw_counts.hot_pixels(black, float(facts["hot_threshold"])) for black in dark])
    status[hot & (status == spectrometer.USABLE)] = spectrometer.HOT
    status[:, np.asarray(masked_pixels, dtype=int)] = spectrometer.MASKED
    source = np.asarray(exposures.source_radiance.values, dtype=float)
    status[:, ~np.isfinite(source)] = spectrometer.MISSING
    if fit_range is not None:
        status[:, (wavelength < fit_range[0]) | (wavelength > fit_range[1])] = spectrometer.LEFT_OUT
    usable = status == spectrometer.USABLE
    rate, noise = raw_counts.combined(rates, noises, usable)
    pixel = np.where(usable.any(axis=0), spectrometer.USABLE, status[0]).astype("int8")
    if not usable.any():
        said = counted(pixel, spectrometer.STATUS)
        raise ValueError(f"no usable pixel in the spectrometer calibration: {said}")
    drift = np.min(np.where(usable, commons, np.inf), axis=0)
    source_uncertainty = exposures.source_radiance_uncertainty.values
    linearity = float(facts["linearity_uncertainty"])
    common = np.sqrt(source_uncertainty**2 + linearity**2 + (drift / rate) ** 2)
    lit = pixel == spectrometer.USABLE
    seen = planck_shape(wavelength, np.where(lit, source, np.nan), (wavelength[0], wavelength[-1]))
    middle = np.flatnonzero(lit)[lit.sum() // 2]
    return xr.Dataset(
        {
            "calibration_factor": ("wavelength", source * transmittance / rate),
            "calibration_factor_uncertainty": ("wavelength", noise / rate),
            "calibration_factor_common": ("wavelength", np.where(lit, common, np.nan)),
            "pixel_status": ("wavelength", pixel, flags(spectrometer.STATUS)),
            "dark_scale": ("exposure", scales),
            "linearity_coefficient": ("linearity_power", np.asarray(linearity_coefficients, dtype=float)),
            **({"masked_pixel": ("masked", list(masked_pixels))} if len(masked_pixels) else {}),
            "source_temperature": seen.temperature,
            # dL/L = (c2 / lambda T) dT/T in Wien's limit
            "source_temperature_uncertainty": float(
                source_uncertainty[middle] * wavelength[middle] * seen.temperature**2 / SECOND_RADIATION
            ),
        },
        {"wavelength": wavelength},
    )
