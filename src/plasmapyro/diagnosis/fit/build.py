"""From a test, its calibrations and the gas spectra to instruments on bins and the base model."""

import logging
from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.fit import observation, radiometer
from plasmapyro.diagnosis.fit.model import TAIL, WALK, History, Model, knots
from plasmapyro.diagnosis.fit.observation import Instrument
from plasmapyro.diagnosis.fit.parameter import Parameter
from plasmapyro.diagnosis.fit.persistent import persistent, wandering_gas
from plasmapyro.diagnosis.fit.terms import AMPLITUDE
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.radiation.bandsignal import BANDS, responsivities
from plasmapyro.radiation.planck import planck_and_slope
from plasmapyro.record import binning, flags
from plasmapyro.record.emittance import PER_MICRON, tilt, tilt_uncertainty
from plasmapyro.record.inputs import has_plasma
from plasmapyro.record.rounding import rounding

LOG = logging.getLogger(__name__)
LEAST_SAMPLES = 10  # of bands: differences of fewer tell no noise
LEAST_SPECTRA = 5  # pixels tell it together
LEAST_PIXELS = 8
MOST_SAMPLES, MOST_SPECTRA = 12000, 3000  # of a fit; a longer record is averaged over neighbours
EXACT = 1e-6  # [1] stands for an uncertainty of zero
UNIFORM = np.sqrt(3)  # half width of a uniform law over its standard deviation
DARK_COUNTS = 8.0  # [count] ASSUME: error of the background of a pixel: 25 counts of noise, some ten scans
# ASSUME: over a record, of all pixels alike: dark current doubles every 7 K (Janesick, Scientific CCDs,
# ch. 7), so some 100 counts gain 2 % as the room warms by 0.2 K
DARK_DRIFT = 2.0  # [count]
DARK_WALK, DARK_MODES = 0.5, 4  # [count] ASSUME: how far it walks at random besides; its slowest modes
WIDEST_CHANNEL = 5e-9  # [m] over which the mean of a hot surface's light is that of the middle
PATTERN_MARGIN = 1.3  # [1]: the noise of the calibration is itself estimated, from few pixels
GAS_SIGMA = 0.15  # [1] of the brightness of the gas as a whole
BEFORE = (np.log(1.6), 0.35)  # brightness before injection over after it, logarithm: the jet flows free
FREE_GAS = 2.0  # [1] of the gas in one channel over its simulated light: the data are to say what it is
BEFORE_POWER_SIGMA = 0.1  # [1] of ln P: the sample changes the jet that it is held into
EDGE = 1.0  # [nm] ASSUME: of the stated edges of a band; filters are cut to 1 or 2 nm and drift by 0.02 nm/K
TAIL_ERROR = 0.02  # [1] ASSUME: of silicon at its long-wave end, 1 % per kelvin
ROUGH = 0.005  # [1] ASSUME: of a scale without a plasma, as `bin_uncertainty` with `--estimator emissivity`
OF_GAS = ("gas", "before_injection", "before_power")
# [s] ASSUME: of two computers, each a tick of 15.6 ms and its network time: "low tens of milliseconds" over
# wide networks, D. Mills et al., RFC 5905 (2010)
CLOCKS = 0.02
MOMENTS = 0.05  # [s] ASSUME: of injection and end, which are stated by hand, against what instruments see
GAIN_SIGMA = 0.02  # [1] of each instrument between calibration and test


def base_model(
    record,
    library,
    calibration,
    response,
    spectrometer_calibration=None,
    given=(),
    radiometer_calibration=None,
    power=None,
    steep=None,
):
    """Instruments on bins and the base model of a test.

    Parameters
    ----------
    record : Record of the test
    library : GasLibrary of its condition
    calibration : Dataset, contract 'calibration', or None without a pyrometer
    response : Dataset, contract 'response', or None without a pyrometer
    spectrometer_calibration : Dataset, contract 'spectrometer_calibration', or None
    given : sequence of Term
        Effects that are taken as given: what is uncertain of them joins the parameters.
    radiometer_calibration : Dataset, contract 'radiometer_calibration', or None
        Bands take the place of the pyrometer's where the test has none of these.
    power : (mean, standard deviation) of the logarithm of the power of the gas over the simulated one
    steep : steep.Steep, optional
        Of a surface that the usual bins do not follow.

    Returns
    -------
    Model
        Its times count from the injection, as those of the record.
    """
    (edges, pauses), known = observation.time_bins(record), None
    edges = edges if steep is None else steep.edges
    axis = None if response is None else (response["wavelength"].values, responsivities(response))
    instruments, lamp, sources = [], {}, None
    bands, frames = (record.instrument(name) for name in ("pyrometer", "spectrometer"))
    others = record.instrument("radiometer") if bands is None else None
    if bands is not None and calibration is not None:
        sources = [calibration["source_temperature"].values] * len(bands.band)
        instruments.append(
            _bands(bands, record.off, calibration["absolute_sensitivity"], axis, library, edges)
        )
    elif others is not None and radiometer_calibration is not None:
        others, known = radiometer.covered(others, radiometer_calibration, library.wavelength)
        axis = known["wavelength"].values, list(known["responsivity"].values)
        sources = list(known["band_source_temperature"].values[:, None])
        sensitivity = known["band_sensitivity"] * others.window_transmittance
        instruments.append(_bands(others, record.off, sensitivity, axis, library, edges))
    if instruments:
        lamp["pyrometer"] = _lamp_of_bands(sources, axis)
    if frames is not None:
        fwhm = float(record.attributes["spectrometer_fwhm"])
        instruments.append(_spectrometer(frames, record.off, library, edges, fwhm))
        lamp["spectrometer"] = _lamp_of_spectrometer(instruments[-1], spectrometer_calibration)
    plasma = has_plasma(record.attributes)
    bending = bands is None or not plasma  # an emissivity that bends over wavelength
    if bending:
        instruments = radiometer.of_an_emissivity(instruments, record, known)
    instruments = _sufficient(instruments, record.off, plasma)
    end = max(instrument.moment.max() for instrument in instruments)
    own = knots(edges, 0.0, record.off, end, pauses)
    bend = 0.0 if steep is None else np.interp(own, steep.time, steep.bend)
    history = History(own, record.off, cold=plasma, bend=bend)
    parameters = base_parameters(record, calibration, None if bending else response)
    if bending:
        parameters = radiometer.instead(parameters, instruments, record, known)
    if "pyrometer" in lamp:
        names = BANDS if others is None else others.band
        parameters += _responses(sources, axis, names)[: len(names) + (others is None)]
    parameters = (*parameters, *of_given(given))
    if plasma:
        parameters += wandering_gas(edges[0], edges[-1])
    else:
        parameters = tuple(replace(one, sigma=EXACT) if one.id in OF_GAS else one for one in parameters)
    if len(instruments) > 1:
        parameters += (
            Parameter("clocks", "clock of the pyrometer", CLOCKS, "s", instrument="pyrometer"),
            Parameter("moments", "moments of injection and end", MOMENTS, "s"),
        )
    if frames is not None and plasma:
        parameters += (
            Parameter("dark_drift", "drift of the dark", DARK_DRIFT, "count", instrument="spectrometer"),
            *(
                Parameter(f"{WALK}_{mode}", "dark that wanders", sigma, "count", instrument="spectrometer")
                for mode, sigma in enumerate(DARK_WALK * np.sqrt(2) / np.pi / np.arange(1, DARK_MODES + 1), 1)
            ),
        )
    slope = 0.0 if others is not None else _tilt(record.emittance_slope, response)
    errors = [persistent(one, edges[0], edges[-1], 0.0 if plasma else ROUGH, pauses) for one in instruments]
    rest = parameters, record, slope, axis, lamp, errors, given
    return Model(instruments, library, history, *rest, power=power)


def _tilt(slope, response):
    """Slope [m-1] of the emittance; 0, and said, where no bands tell what a stated one means."""
    if response is None and slope != 1:
        LOG.warning(
            "emittance_slope is left aside: it holds between the bands of a response.nc that is not there"
        )
        return 0.0
    return tilt(slope, response)


def _sufficient(instruments, off, plasma):
    """The instruments with samples enough to know their noise by; refused if there are none, or none lit by
    the plasma that a test has."""
    count = {one.kind: int((one.raw_bin >= 0).sum()) for one in instruments}
    least = {one.kind: LEAST_SPECTRA if one.weight is None else LEAST_SAMPLES for one in instruments}
    kept = [one for one in instruments if count[one.kind] >= least[one.kind]]
    lit = any(((one.moment[:, 0] > 0) & (one.moment[:, -1] < off)).any() for one in kept)
    for one in kept:
        dark = ~(np.nanmedian(one.value, axis=0) > 0)
        if dark.any() if one.weight is not None else dark.mean() > 0.5:
            raise ValueError(f"most samples of the {one.kind} are not > 0: are sign and dark level right?")
    if kept and lit:
        for kind in set(count) - {one.kind for one in kept}:
            LOG.warning("the %s is left out: %d samples, %d needed", kind, count[kind], least[kind])
        return kept
    held = ", ".join(f"{number} of the {kind}" for kind, number in count.items())
    raise ValueError(
        f"a diagnosis needs {min(least.values(), default=LEAST_SAMPLES)} sound samples of an instrument"
        + (", some between injection and the end of the plasma" if plasma else "")
        + f"; the test holds {held}"
        + ("" if lit or not kept else ", none lit by it")
    )


def base_parameters(record, calibration, response=None):
    """The parameters of the base model with their priors; an error of the slope of the emittance is one of
    the ratio of the bands, unless their `response` says what it does to spectra."""
    ratio, sloped = 0.005, ()
    if calibration is not None:
        ratio = float(calibration.sensitivity_ratio_uncertainty / calibration.sensitivity_ratio)
    slope, unsure = record.emittance_slope, record.emittance_slope_uncertainty
    if response is None:
        ratio = float(np.hypot(ratio, unsure / slope))
    elif unsure > 0:
        sigma = tilt_uncertainty(slope, unsure, response) / PER_MICRON
        sloped = (Parameter("emittance_slope", "slope of the emittance", sigma, "um-1"),)
    ratio = max(ratio, EXACT)
    source = 3.0 / UNIFORM
    return (
        Parameter("emittance", "emittance", max(record.emittance_uncertainty / record.emittance, EXACT)),
        Parameter("gain_pyrometer", "throughput of the pyrometer", GAIN_SIGMA, instrument="pyrometer"),
        Parameter(
            "gain_spectrometer", "throughput of the spectrometer", GAIN_SIGMA, instrument="spectrometer"
        ),
        Parameter("ratio", "sensitivity ratio", ratio, instrument="pyrometer"),
        Parameter("lamp", "temperature of the calibration source", source, "K"),
        Parameter("gas", "brightness of the gas (logarithm)", GAS_SIGMA),
        Parameter(
            "before_injection", "gas before over after injection (logarithm)", BEFORE[1], "1", BEFORE[0]
        ),
        Parameter("before_power", "gas before injection, as if of another power", BEFORE_POWER_SIGMA),
        *sloped,
    )


def _responses(sources, response, names):
    """Errors of the stated responses of bands of some `names`, which their calibrations saw as well.

    `sources`: temperatures [K] of each band's calibration. The tail, common to all, comes last.
    """
    (wavelength, curves), shift = response, 1e-9
    rise = 1 + np.clip((wavelength - TAIL[0]) / np.ptp(TAIL), 0, 1)

    def change(kelvin, axis, curve, plain):
        signals = (blackbody_signal(kelvin, *one) for one in ((axis, curve), (wavelength, plain)))
        return float(np.mean(np.log(np.divide(*signals))))

    each = list(zip(sources, curves, strict=True))
    moved = np.diag([change(kelvin, wavelength + shift, curve, curve) for kelvin, curve in each])
    grown = [change(kelvin, wavelength, curve * rise, curve) for kelvin, curve in each]
    rows = [
        Parameter(f"edge_{name}", f"edges of the {name} band", EDGE, "nm", 0.0, "pyrometer", tuple(row))
        for name, row in zip(names, moved, strict=True)
    ]
    tail = "tail", "long-wave tail of the responses", TAIL_ERROR, "1", 0.0, "pyrometer", tuple(grown)
    return (*rows, Parameter(*tail))


def of_given(terms):
    """Parameters of the numbers of given terms that are not known exactly."""
    for term in terms:
        effect = term.setting.effect
        for name, (centre, sigma) in term.prior().items():
            what, unit = (effect.amplitude, effect.unit) if name == AMPLITUDE else (name, "")
            own = f"{effect.id}.{name}", f"{effect.name}: {what}"
            yield Parameter(*own, sigma, unit, centre, start=term.numbers[name])


def _on_bins(one, raw, index, bins):
    """Fields of an `Instrument` from samples (t, C) in bins: means, and instants that stand for them."""
    half, nodes = one.integration_time / 2, observation.nodes_of(one.integration_time)
    moment, count = observation.instants(one.time - half, one.time + half, index, bins, nodes)
    value, number = binning.mean_in_bins(raw, index, bins)
    kept = count > 0
    renumber = np.where(kept, np.cumsum(kept) - 1, -1)
    return {
        "moment": moment[kept],
        "value": value[kept],
        "number": number[kept],
        "raw": raw,
        "raw_moment": one.time[:, None] + half / UNIFORM * nodes,
        "raw_bin": np.where(index >= 0, renumber[index], -1),
    }


def _membership(one, edges, off):
    half = one.integration_time / 2
    return binning.membership(one.time - half, one.time + half, edges, 0.0, off)


def _bands(bands, off, sensitivity, response, library, edges):
    """Bands of a pyrometer or a radiometer, each on the nodes of its response (wavelength, curves)."""
    recorded, steps = bands.time.size, tuple(rounding(own) for own in bands.sound.T)
    bands = binning.thinned(bands, off, MOST_SAMPLES)
    raw = np.ascontiguousarray(bands.sound)
    index = observation.without_lost(_membership(bands, edges, off), raw)
    axis, curves = response
    spans = [observation.band_nodes(radiometer.seen_part(bands.name, axis, curve)) for curve in curves]
    ends = np.cumsum([0, *(centres.size for _, centres in spans)])
    weight = np.zeros((len(curves), ends[-1]))
    maps = []
    for band, (curve, (places, _)) in enumerate(zip(curves, spans, strict=True)):
        weight[band, ends[band] : ends[band + 1]] = observation.band_weights(places, axis, curve)
        maps.append(observation.band_gas_map(places, library.wavelength, axis, curve))
    count = len(curves)
    return Instrument(
        kind="pyrometer",
        wavelength=np.concatenate([centres for _, centres in spans]),
        weight=weight,
        gain=sensitivity.values.astype(float),
        gas_map=observation.side_by_side(maps),
        node_edges=tuple(places for places, _ in spans),
        factor=None,
        pixel_edges=None,
        gas_error=np.full(count, FREE_GAS),
        pattern=np.zeros(count),
        dark=np.zeros(count),
        band=tuple(bands.band),
        source=bands.name,
        rounding=steps,
        recorded=recorded / bands.time.size,
        **_on_bins(bands, raw, index, edges.size - 1),
    )


def seen_in_most(radiance):
    """Pixels (P,) with a value in most of the spectra (t, P) that hold any."""
    there = np.isfinite(radiance)
    return there.sum(axis=0) > 0.5 * there.any(axis=1).sum()


def _spectrometer(frames, off, library, edges, fwhm):
    frames = binning.thinned(frames, off, MOST_SPECTRA)
    wavelength, saturated = frames.wavelength, frames.flagged(flags.SATURATED)
    slit = library.slit_fwhm
    radiance, saturated = observation.as_through(slit, fwhm, wavelength, frames.sound, saturated)
    factor = np.ones(wavelength.size) if frames.factor is None else frames.factor
    relative = np.zeros(wavelength.size)
    if frames.factor_uncertainty is not None:
        relative = frames.factor_uncertainty
    inside = (wavelength > library.wavelength[3]) & (wavelength < library.wavelength[-4])
    chosen = np.flatnonzero(inside & seen_in_most(radiance))
    if chosen.size < LEAST_PIXELS:
        raise ValueError(
            f"{chosen.size} usable pixels of the spectrometer lie within the simulated spectra,"
            f" {library.wavelength[0] * 1e9:.0f} to {library.wavelength[-1] * 1e9:.0f} nm; a diagnosis needs"
            f" {LEAST_PIXELS}: leave the spectra out, or compute the radiance over their range"
        )
    radiance, wavelength, factor, relative = (
        radiance[:, chosen],
        wavelength[chosen],
        factor[chosen],
        relative[chosen],
    )
    seen = np.interp(wavelength, library.wavelength, library.base)
    pixels = binning.pixel_edges(wavelength, seen, min(slit, WIDEST_CHANNEL))
    raw, number_of_pixels = observation.in_pixel_bins(radiance, pixels)
    in_bin = number_of_pixels.max(axis=0)
    # The mean of some pixels of a bin is that of another wavelength.
    raw = np.where(number_of_pixels == in_bin, raw, np.nan)
    lost = np.where(saturated[:, chosen], 0.0, radiance)
    index = observation.without_lost(_membership(frames, edges, off), lost)
    raw = np.where(observation.beside_saturation(saturated[:, chosen], index, pixels), np.nan, raw)
    centres, _ = observation.in_pixel_bins(wavelength, pixels)
    binned_factor, _ = observation.in_pixel_bins(factor, pixels)
    pattern, _ = observation.in_pixel_bins(relative, pixels)
    return Instrument(
        kind="spectrometer",
        source="spectrometer",
        wavelength=centres,
        weight=None,
        gain=np.ones(centres.size),
        gas_map=observation.pixel_gas_map(library.wavelength, wavelength, pixels),
        node_edges=(),
        factor=binned_factor,
        pixel_edges=pixels,
        gas_error=np.full(centres.size, FREE_GAS),
        pattern=PATTERN_MARGIN * np.maximum(pattern, 1e-4) / np.sqrt(in_bin),
        dark=np.full(centres.size, DARK_COUNTS) * binned_factor / np.sqrt(in_bin),
        highest=observation.highest_of(binning.mean_in_bins(radiance / factor, index, edges.size - 1)[0]),
        **_on_bins(frames, raw, index, edges.size - 1),
    )


def _lamp_of_bands(sources, response):
    """Relative change (C,) of the sensitivities per kelvin of the sources [K-1]."""
    step, axis = 0.5, response[0]
    return np.array(
        [
            np.mean(
                np.log(
                    blackbody_signal(source + step, axis, curve)
                    / blackbody_signal(source - step, axis, curve)
                )
            )
            / (2 * step)
            for source, curve in zip(sources, response[1], strict=True)
        ]
    )


def _lamp_of_spectrometer(instrument, calibration):
    """Relative change (P,) of the calibration factor per kelvin of the source [K-1]."""
    if calibration is None:
        return np.zeros(instrument.wavelength.size)
    source = np.array([float(calibration["source_temperature"])])
    body, slope = planck_and_slope(instrument.wavelength, source)
    return (slope / body)[0]
