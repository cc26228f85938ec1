"""Stage of the joint estimate: a test and the calibrations in, surface temperature and gas out."""

from dataclasses import dataclass, replace
from functools import wraps

import numpy as np
import xarray as xr

from plasmapyro.estimate import prepare, radiometer
from plasmapyro.estimate.contradiction import REGISTER, STRAINED, contradicted, pulled, stretched
from plasmapyro.estimate.dynamics import GAS, RATE, TEMPERATURE, Dynamics
from plasmapyro.estimate.instrument import InverseTable, from_straight, straight
from plasmapyro.estimate.observations import Constants, constants
from plasmapyro.estimate.response import InverseErrors
from plasmapyro.estimate.smoother import FITTED, Chain, Fit, Spread, fit, misfit, spread_of
from plasmapyro.estimate.throughput import CHANCE, NAME, in_doubt
from plasmapyro.instrument.calibration import EXTRAPOLATED, VALID
from plasmapyro.record import budget, flags, status
from plasmapyro.record.attributes import carried
from plasmapyro.record.emittance import UNTOLD, tilt, tilt_uncertainty, with_temperature
from plasmapyro.record.record import Record, record_of

FIRST_TEMPERATURE = 1.0  # [K] before injection: what is not known of the surface enters with it
FIRST_RATE = 0.01  # [K/s] standard deviation before injection: nothing heats the sample
KICK = 100.0  # [K/s] of the rate at injection and at the end of the plasma
START_DYNAMICS = {"quiet": 1e-2, "bending": 30.0, "memory": 15.0}  # where the search begins
GAS_START = 1e-3  # [1] the gas amplitude right after injection is 1 by definition
BEFORE_DEVIATION = 1.0  # [1] of the gas amplitude before injection: left to the data
FIRST_ROUNDS = 2  # of path and dynamics, before the noise is looked at again
BENDS = 2  # times that exposures take the path between their samples anew
# ASSUME: what no model of a constant grey surface knows: emittance and windows change by some per cent while
# a surface oxidises and a jet blows at them; like the throughput of an instrument in the diagnosis.
CHANGING = 0.02  # [1] standard, of the level of the light through the test
MOST_GAS = 1e3  # [1] of its light in the reference window; a plasma changes by some tens of per cent


def posterior(
    test,
    calibration,
    response,
    spectrometer_calibration=None,
    radiometer_calibration=None,
    *,
    gas_drift,
    gas_flicker,
    gas_flicker_time,
    gas_change,
    band_shift_uncertainty,
    initial_temperature,
    initial_temperature_uncertainty,
    scale_uncertainty,
    bin_uncertainty,
    injection_time_span,
    plasma_off_time_span,
    least_surface_share,
    largest_uncertainty,
    saturation_counts,
    noise_block,
    instruments=("pyrometer", "spectrometer", "radiometer"),
    emissivity_level=None,
    emissivity_shape=0.1,
    emissivity_length=200e-9,
    throughput_chance=CHANCE,
    least_samples=None,
    most_samples=prepare.MOST_SAMPLES,
):
    """`Posterior`: what bands of a test in absolute units and, if present, its spectra tell of its surface.

    Parameters
    ----------
    test : Dataset, contract 'test'
        With a pyrometer or a radiometer of any bands; spectra are used if there are any.
    calibration : Dataset, contract 'calibration', or None without a pyrometer
    response : Dataset, contract 'response', or None without a pyrometer
    spectrometer_calibration : Dataset, contract 'spectrometer_calibration', optional
        Needed for counts.
    gas_drift : float [1]
        Standard deviation of the slow change of the gas light from injection to the end of the plasma.
    gas_flicker, gas_flicker_time : float [1], [s]
        Used only if the bands do not tell.
    gas_change : float [1]
        Relative change of colour of the gas when the probe comes in.
    band_shift_uncertainty : float [m]
        Of the place of each response on the wavelength axis.
    initial_temperature, initial_temperature_uncertainty : float [K]
        Of the surface at injection.
    scale_uncertainty, bin_uncertainty : float [1]
        Of the spectrometer: common to all wavelengths (what lies in its view), and of each bin.
    injection_time_span, plasma_off_time_span : float [s]
        Left out before injection and after the end of the plasma.
    least_surface_share : float [1]
        If the surface gives less in both bands, the status says that the gas dominates.
    largest_uncertainty : float [1]
        Beyond this relative standard uncertainty there is no temperature.
    saturation_counts : float [count]
    noise_block : int
        Pixels per noise estimate of the spectrometer.
    instruments : names of those to use; the data of others are left aside.
    radiometer_calibration : Dataset, contract 'radiometer_calibration', optional
    emissivity_level : float [1], or None
        With a radiometer: relative standard uncertainty of the emissivity as a whole; None: as stated.
    emissivity_shape, emissivity_length : float [1], [m]
        With a radiometer: standard deviation of the course of the emissivity over wavelength, constant
        through the test, and over which length it is smooth. Without one the surface is grey, or as stated.
    throughput_chance : float [1]
        That a pyrometer alone sees another share of the light than calibration and emittance say.
    least_samples : int, or None
        In which the noise of bands must be seen; None: of a pyrometer 200, of a radiometer 60.
    most_samples : int
        Neighbours of a longer record are averaged.

    Raises
    ------
    ValueError
        Naming every fault of the test, or if the iteration does not converge.

    Notes
    -----
    Not in the paper; method and reasons in docs/temperature.md. Where instruments and calibrations contradict
    each other there is no temperature, but a status and the reason.
    """
    given = {
        "pyrometer": calibration,
        "spectrometer": spectrometer_calibration,
        "radiometer": radiometer_calibration,
    }
    record = record_of(
        test,
        {name: one for name, one in given.items() if name in instruments},
        saturation_counts=saturation_counts,
    )
    if prepare.leading(record) is None:
        raise ValueError("the joint estimate needs the bands of a pyrometer or of a radiometer")
    if record.instrument("radiometer") is not None:
        level = emissivity_level or record.emittance_uncertainty / record.emittance or UNTOLD
        record = replace(record, emittance_uncertainty=level * record.emittance)
    spans = injection_time_span, plasma_off_time_span
    samples = prepare.samples_of(record, spans, least_samples, most_samples)
    told = np.isfinite(samples.flicker)
    deviation = samples.flicker if told else gas_flicker
    correlation = samples.flicker_time if told else gas_flicker_time
    gas = prepare.first_gas(record, samples)
    frames, bands = record.instrument("spectrometer"), record.instrument("radiometer")
    slope, course, keys = (0.0, 0.0), None, {}
    if bands is not None:
        seen = [
            radiometer_calibration.wavelength.values,
            *([] if response is None else [response.wavelength]),
        ]
        seen += [] if frames is None else [frames.wavelength]
        if len(seen) == 1 and len(bands.band) == 1:
            emissivity_shape = radiometer.EXACT
        course = radiometer.course_of(record, seen, emissivity_shape, emissivity_length)
        keys = {"relative": course.relative, "basis": course.basis}
    if record.instrument("pyrometer") is not None:
        stated = record.emittance_slope, record.emittance_slope_uncertainty
        slope = tilt(stated[0], response), 0.0 if frames is None else tilt_uncertainty(*stated, response)
        leading = prepare.pyrometer_data(samples, response, calibration, gas, slope[0], course)
        fixed = prepare.pyrometer_constants(
            record, leading, calibration, gas, gas_change, band_shift_uncertainty
        )
    else:
        leading = radiometer.leading_data(samples, bands, radiometer_calibration, gas, course)
        fixed = radiometer.leading_constants(
            record, radiometer_calibration, gas, gas_change, band_shift_uncertainty
        )
    path = prepare.first_path(samples, leading, gas, record.emittance, initial_temperature)
    path[:, TEMPERATURE] = straight(path[:, TEMPERATURE])
    path[:, RATE] /= from_straight(path[:, TEMPERATURE])[1]
    start = straight(initial_temperature)
    slope_then = from_straight(start)[1]
    error, kick = initial_temperature_uncertainty / slope_then, KICK / np.sqrt(slope_then)
    observations = [leading]
    if course is not None:
        fixed = fixed + constants("emissivity_shape", np.zeros(course.shapes.shape[1]), 1.0)
    if course is not None and leading.name == "pyrometer":
        exposure = prepare.mean_flicker(deviation, correlation, bands.integration_time)
        beside = radiometer.beside_data(
            record, radiometer_calibration, samples.time, exposure, noise_block, spans, course
        )
        observations.append(beside)
        fixed = fixed + radiometer.beside_constants(
            beside, bands, radiometer_calibration, scale_uncertainty, gas_change
        )
    if frames is not None:
        # ASSUME: one source for pyrometer and spectrometer; its error then does not average out.
        source = calibration if spectrometer_calibration is None else spectrometer_calibration
        kelvin = float(source.source_temperature.mean()) if source is not None else np.inf
        spectra = prepare.spectrometer_data(
            record,
            frames,
            samples.time,
            kelvin,
            prepare.mean_flicker(deviation, correlation, frames.integration_time),
            noise_block,
            spans,
            slope,
            leading.name == "pyrometer",
            **keys,
        )
        if spectra is not None:
            observations.append(spectra)
            fixed = fixed + prepare.spectrometer_constants(
                spectra, scale_uncertainty, bin_uncertainty, gas_change
            )
            if spectra.source != "source_error":
                own = 0.0 if source is None else float(source.source_temperature_uncertainty.mean())
                fixed = fixed + constants(spectra.source, 0.0, max(own, prepare.NOTHING))
    # A second instrument contradicts a throughput that is not as stated; a pyrometer alone must doubt it.
    doubted = course is None and len(observations) == 1 and throughput_chance > 0
    if doubted:
        observations[0] = replace(leading, drift=prepare.ramps(samples.time))
        fixed = fixed + constants(NAME, 0.0, prepare.NOTHING)
        fixed = fixed + constants("band_drift", np.zeros(prepare.RAMPS), prepare.NOTHING)
    observations = [replace(one, **_inverse(one)) for one in observations]
    time = samples.time
    chain = Chain(
        time,
        (0.0, record.off),
        0.0,
        np.array([start, 0.0, path[0, GAS], 0.0]),
        np.diag(
            [
                FIRST_TEMPERATURE**2 if time[0] < 0 else error**2,
                FIRST_RATE**2 if time[0] < 0 else kick**2,
                BEFORE_DEVIATION**2 if time[0] < 0 else GAS_START**2,
                deviation**2,
            ]
        ),
    )
    dynamics = Dynamics(
        **START_DYNAMICS,
        kick=kick,
        gas=gas_drift**2 / record.off,
        gas_start=GAS_START,
        flicker=deviation,
        flicker_time=correlation,
        start=error,
    )
    found = fit(chain, observations, fixed, dynamics, path, fixed.mean.copy(), FIRST_ROUNDS)
    observations, found = _refined(chain, observations, fixed, found)
    if not found.converged:
        raise ValueError(f"the joint estimate did not converge in {found.steps} steps")
    doubts = {}
    if doubted:
        found, spread, fixed, doubts = in_doubt(chain, observations, fixed, found, throughput_chance)
    else:
        spread = spread_of(chain, observations, fixed, found)
    return Posterior(record, test, samples, observations, fixed, found, spread, doubts)


@wraps(posterior, assigned=())
def estimate(
    test, calibration, response, spectrometer_calibration=None, radiometer_calibration=None, **settings
):
    """Surface temperature of a test: what `posterior` finds, as Dataset of contract 'joint_estimate'."""
    given = response, spectrometer_calibration, radiometer_calibration
    found = posterior(test, calibration, *given, **settings)
    bands = radiometer_calibration.instrument_range if calibration is None else calibration.fit_range
    limits = (
        settings[name] for name in ("least_surface_share", "largest_uncertainty", "plasma_off_time_span")
    )
    return _dataset(found, bands.values, *limits)


@dataclass(frozen=True)
class Posterior:
    """Path and constants that a test leaves, with their uncertainty."""

    record: Record
    test: xr.Dataset
    samples: prepare.Samples
    observations: list
    fixed: Constants  # prior
    found: Fit
    spread: Spread
    doubts: dict  # of the throughput

    def contradicted(self):
        """Samples (n,) that contradict one another, and why."""
        return contradicted(self.samples.time, self.observations, self.fixed, self.found)


def _refined(chain, observations, fixed, found):
    """Observations with the noise that the residuals show (lines inflate the first guess of their bins) and,
    if the data then agree better, exposures along the path between samples; and the fit to them.

    An exposure that sees its nearest sample alone may pull that one away from its neighbours, where
    instruments disagree slowly; along the path it cannot, and constants are pulled instead.
    """
    observations = [prepare.rescaled(one, found, fixed) for one in observations]
    found = fit(chain, observations, fixed, found.dynamics, found.path, found.values, 1)
    for _ in range(BENDS):
        curved = [prepare.bent(one, chain, found.path) for one in observations]
        trial = fit(chain, curved, fixed, found.dynamics, found.path, found.values, 0)
        if not trial.converged or misfit(chain, curved, fixed, trial) > misfit(
            chain, observations, fixed, found
        ):
            break
        observations, found = curved, trial
    return observations, found


def _inverse(data):
    """Tables of an observation over the inverse temperature."""
    found = {"table": InverseTable(data.table)}
    if hasattr(data, "errors"):
        found["errors"] = {name: InverseErrors(one) for name, one in data.errors.items()}
    return found


def _families(fixed, spread, stretch=1.0):
    """Of each family of constants what it adds to the temperatures (n,) of the chain, see `budget.of_family`;
    `stretch` (p,): times what is stated of each."""
    across, deviation = spread.across * np.square(stretch), fixed.deviation * stretch
    places = [(row, fixed.where(row["name"])) for row in REGISTER]
    return [
        budget.of_family(row["input"], row["group"], across[:, at], deviation[at], row["unit"])
        for row, at in places
        if at.size
    ]


def _inputs(record, pyrometer, fixed, kelvin, rows, noise):
    """The uncertainty budget of the temperatures (n,) `kelvin` of the chain from `rows` of the constants and
    what `noise` adds."""
    rows += _of_slope(record, fixed, rows) if pyrometer.name == "pyrometer" else []
    signal, slope, _ = pyrometer.table(kelvin)
    of_level = np.mean(signal / slope, axis=1)
    following = of_level * with_temperature(from_straight(kelvin)[0], record.emittance)
    of_bands = budget.Input("noise of the samples; flicker and drift of the gas", "noise", noise)
    words = "emittance or windows that change through the test"
    return [
        *rows,
        of_bands,
        budget.Input("emittance that follows the temperature", "emittance", following),
        budget.Input(words, "unnamed misfit", CHANGING * of_level, CHANGING, "1"),
    ]


def _of_slope(record, fixed, rows):
    """Takes the slope of the emittance, which the gains of the bands hold, out of their row."""
    slope = record.emittance_slope_uncertainty / np.sqrt(2)
    whole = fixed.deviation[fixed.where("gain_error")[0]]
    place = next(at for at, row in enumerate(rows) if row.name == "gain of each band")
    share = min(slope / whole, 1.0)
    row, rest = rows[place], np.sqrt(1 - share**2)
    rows[place] = row._replace(contribution=row.contribution * rest, uncertainty=row.uncertainty * rest)
    words = "emittance of the wide over the narrow band"
    own = record.emittance_slope_uncertainty
    return [budget.Input(words, "emittance", row.contribution * share, own, "1")]


def _dataset(posterior, fit_range, least_share, largest, span):
    test, record, samples, observations = (
        getattr(posterior, name) for name in ("test", "record", "samples", "observations")
    )
    fixed, found, spread = posterior.fixed, posterior.found, posterior.spread
    of, group = fixed.where, samples.group
    middle, scale = from_straight(found.path[:, TEMPERATURE])
    alone = scale * spread.alone
    told = (alone < largest * middle)[group]
    bands, names = prepare.leading(record), [one.name for one in observations]
    current = "gas_current" if names[0] == "pyrometer" else "radiometer_gas"
    temperature = np.interp(bands.time, samples.time, middle)
    # Of a pyrometer alone level and ratio are in doubt already, each by its chance.
    sure = not posterior.doubts
    own = _families(fixed, spread)
    wide = _families(fixed, spread, stretched(fixed, found)) if sure else list(own)
    variance = spread.path[:, TEMPERATURE, TEMPERATURE]
    more = budget.combined(wide) ** 2 - budget.combined(own) ** 2
    # Continuity is no measurement: the path may not know more than the samples about it by themselves.
    unsure = np.where(alone < largest * middle, np.maximum(spread.alone**2 - variance - more, 0.0), 0.0)
    deviation = (scale * np.sqrt(variance + more + unsure))[group]
    noise = np.sqrt(budget.remainder(variance, own) ** 2 + unsure)
    inputs = _inputs(record, observations[0], fixed, found.path[:, TEMPERATURE], wide, noise)
    surface, gas, _ = observations[0].predict(found.path, found.values, of)
    # Where there is no light of a gas, noise may make what is fitted of it negative.
    share, injected = np.clip(surface / (surface + gas), 0, 1)[:, group], samples.injected[group]
    against, words = posterior.contradicted()
    known = injected & told & (deviation < largest * temperature)
    low, high = fit_range
    state = np.where((temperature < low) | (temperature > high), EXTRAPOLATED, VALID).astype("int8")
    state[(share < least_share).all(axis=0)] = status.GAS_DOMINATED
    state[bands.flagged(flags.SATURATED, flags.CLIPPED).all(axis=1)] = status.SATURATED
    state[bands.flagged(flags.LOST, flags.STUCK, flags.SPIKED, flags.RELIT).all(axis=1)] = status.MISSING
    state[~known] = status.NO_SIGNAL
    # Between the samples before and behind a switch only the path's own bend tells.
    dying = (bands.time > record.off) & (bands.time <= record.off + span)
    state[dying] = status.STRADDLING
    state[against[group]] = status.CONTRADICTED
    known &= ~(against[group] | dying)
    state[~injected] = status.NOT_INJECTED
    factor = np.exp(budget.NORMAL_95 * deviation / temperature)
    amplitude = np.where(samples.shining, 1 + found.path[:, GAS], 0.0)[group]
    if (most := np.abs(amplitude).max()) > MOST_GAS:
        low, high = map(record.clock, record.window)
        raise ValueError(
            f"the gas would have to be {most:.0e} times as bright as in the reference window"
            f" {low:g} to {high:g} s, which is dark; choose one in which the plasma shines"
            " on the instrument (--reference-window)"
        )
    of_constants = np.sqrt(np.diag(spread.constants))
    sound = np.nan if against.all() else 1.0  # of constants that contradict what is stated nothing is told
    emittance = sound * float(np.exp(found.values[of("log_emittance")[0]]))
    gains = found.values[of("gain_error")] - observations[0].source_slope * found.values[of("source_error")]
    blank = np.where(known, 1.0, np.nan)
    inputs = [one._replace(contribution=(scale * one.contribution)[group] * blank) for one in inputs]
    direction = np.zeros((len(gains), fixed.mean.size))
    direction[np.arange(len(gains)), of("gain_error")] = 1.0
    direction[:, of("source_error")[0]] = -observations[0].source_slope
    gain_variance = np.einsum("bi,ij,bj->b", direction, spread.constants, direction)
    return xr.Dataset(
        {
            "surface_temperature": ("time", np.where(known, temperature, np.nan)),
            "surface_temperature_uncertainty": ("time", np.where(known, deviation, np.nan)),
            "surface_temperature_interval": (
                ("bound", "time"),
                np.where(known, np.stack([temperature / factor, temperature * factor]), np.nan),
            ),
            "estimate_status": ("time", state, status.flags()),
            "estimated_surface_share": (("band", "time"), np.where(injected, share, np.nan)),
            "gas_amplitude": ("time", amplitude),
            "gas_amplitude_uncertainty": (
                "time",
                (samples.shining * np.sqrt(spread.path[:, GAS, GAS]))[group],
            ),
            current: ("band", found.values[of("gas_signal")]),
            f"{current}_uncertainty": ("band", of_constants[of("gas_signal")]),
            "estimated_emittance": emittance,
            "estimated_emittance_uncertainty": emittance * float(of_constants[of("log_emittance")[0]]),
            "gain_correction": ("band", sound * np.expm1(gains)),
            "gain_correction_uncertainty": ("band", sound * np.sqrt(gain_variance)),
            "whitened_residual": (
                ("band", "time"),
                observations[0].residual(found.path, found.values, of)[:, group],
            ),
            **budget.variables(inputs),
        },
        {"time": record.clock(bands.time), "band": list(bands.band)},
        carried(test)
        | {
            "instruments": " ".join(sorted(names)),
            "contradictions": "; ".join(words),
            "strained": "; ".join(pulled(observations, fixed, found, STRAINED)) if sure else "",
            "steps": found.steps,
            "gas_flicker": float(found.dynamics.flicker),
            "gas_flicker_time": float(found.dynamics.flicker_time),
        }
        | {f"dynamics_{name}": float(getattr(found.dynamics, name)) for name in FITTED}
        | posterior.doubts,
    )
