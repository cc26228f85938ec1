"""Stage: temperature and smooth emissivity of a surface from spectra alone, with or without a plasma."""

import numpy as np
import xarray as xr

from plasmapyro.constants import FIRST_RADIATION, SECOND_RADIATION
from plasmapyro.estimate.emissivity import follow, infer, log_emissivity, smooth_prior
from plasmapyro.estimate.lamps import ALIKE, SURE, lamp
from plasmapyro.estimate.light import of_bands, of_spectra
from plasmapyro.record import budget, flags, status
from plasmapyro.record.attributes import carried
from plasmapyro.record.emittance import UNTOLD, mean_emittance
from plasmapyro.record.foreign import without_narrow_light
from plasmapyro.record.inputs import instruments
from plasmapyro.record.record import record_of

MISFIT = 2.0  # rms of the residuals in standard deviations, beyond which this is not light of a hot surface:
# five of chi-squared for five bands; real furnaces show 0.3 to 1.2, room light on them 2 to 14
FREER, TRIED = (1.0, 1.5, 2.0, 3.0), 20  # times the stated course, told by the clearest samples
LEAST_TELLING = 4  # channels
LEAST_CLEAR = 3.0  # standard deviations of a bin whose brightness is told
# Stated uncertainties of the emissivity: real furnaces ask for 0.1 to 1.4 of them, a fifth of the light of
# a lit room on 600 C for 7, which a free course had taken up as 30 K.
PULLED = 5.0
LASTS = 0.1  # [1] ASSUME: relative change of temperature over which a bin keeps its error: slit and stray
# light act on the slope of the light, so at another temperature they leave other errors
# ASSUME: of the freedom of its course; by as much the level of an emissivity wanders from what is stated at
# the injection. A surface that oxidises, or is roughened, changes in both.
AGES = 1 / 3
LARGEST = 0.1  # [1] relative standard uncertainty of the temperature, beyond which there is none


def estimate_emissivity(
    test,
    calibration,
    *,
    level,
    shape,
    length,
    memory,
    stray_light,
    bin_width,
    bin_uncertainty,
    gas_variation,
    least_signal_to_noise,
    least_surface_share,
    saturation_counts,
    noise_block,
):
    """Temperature and emissivity over wavelength and time from the spectra, or bands, of a test without gas.

    Parameters
    ----------
    test : Dataset, contract 'test', with spectra, or signals of a radiometer
    calibration : Dataset, contract 'spectrometer_calibration', or None if the test holds radiances; contract
        'radiometer_calibration'
    level : float [1], or None
        Relative standard uncertainty of the emissivity as a whole; None: what the test states.
    shape : float [1]
        Of its course over wavelength: the least; up to three times as much where the light asks for it.
    length, memory : float [m], [s]
        Over which its course and its change in time are smooth.
    stray_light : float [1], of spectra
        Share of the mean count rate that may reach every pixel, in the test and in the calibration.
    bin_width : float [m]
        Pixels are averaged over it.
    bin_uncertainty : float [1]
        Of a bin, independent: what is rough in calibration and emissivity.
    gas_variation : float [1]
        Relative standard deviation of the gas radiance about that of the reference window.
    least_signal_to_noise, least_surface_share : float [1]
        Of the clearest bin: below the first a spectrum is dark, below the other the gas dominates.
    saturation_counts : float [count]
    noise_block : int
        Pixels per noise estimate.

    Returns
    -------
    Dataset, contract 'emissivity_estimate'
        Attributes: `contradictions`, what speaks against light of a hot surface; `degenerate`, what the light
        cannot tell.

    Raises
    ------
    ValueError
        Naming every fault of the test, or fewer than three usable bins.
    """
    name = "spectrometer" if "spectrometer" in instruments(test) else "radiometer"
    record = record_of(test, {name: calibration}, saturation_counts=saturation_counts, needed=[name])
    record = without_narrow_light(record)
    settings = {"bin_width": bin_width, "bin_uncertainty": bin_uncertainty, "gas_variation": gas_variation}
    settings |= {"stray_light": stray_light, "noise_block": noise_block}
    light = {"spectrometer": of_spectra, "radiometer": of_bands}[name](record, calibration, settings)
    frames, wavelength, seen, noise = light.frames, light.channels.wavelength, light.seen, light.noise
    if level is None:
        level = record.emittance_uncertainty / record.emittance or UNTOLD
    if light.middle.size == 1:
        shape = 0.0  # the emissivity is stated where the one band lies
    mean = mean_emittance(test.attrs, wavelength)
    state = _status(record, light)
    with np.errstate(invalid="ignore"):
        clearest = np.nanmax(
            np.where(np.isfinite(seen), seen / np.hypot(noise, light.offset), -np.inf), axis=1
        )
        share = np.nansum(seen, axis=1) / np.nansum(seen + light.behind, axis=1)
    state[(state == status.VALID) & ~(share >= least_surface_share)] = status.GAS_DOMINATED
    given = np.isin(state, (status.VALID, status.GAS_DOMINATED))
    state[given & ~(clearest >= least_signal_to_noise)] = status.NO_SIGNAL
    used = np.isin(state, (status.VALID, status.GAS_DOMINATED))
    data, error = np.where(used[:, None], seen, np.nan), np.hypot(noise, light.independent * seen)

    def fitted(factor, rows=slice(None)):
        """Prior of a course `factor` times as free, its shapes, and the fit of some samples."""
        own = smooth_prior(wavelength, mean, level=level, shape=factor * shape, length=length)
        whole = own._replace(basis=np.column_stack([own.basis, light.basis]))
        found = infer(light.channels, whole, data[rows], error[rows], light.linear[rows])
        return whole, own.basis.shape[1], found

    rows = np.flatnonzero(used)[np.argsort(-clearest[used])[:TRIED]]
    told = [np.nanmedian(fitted(one, rows)[2].evidence) for one in FREER] if rows.size else 0
    prior, smooth, alone = fitted(course_freedom(told, light.middle.size))
    room = None if record.window or name == "radiometer" else _lamp(record, light, prior, alone, data, noise)
    misfit = np.sqrt(np.nansum(alone.residual**2, axis=1) / np.maximum(np.isfinite(data).sum(axis=1), 1))
    over = (light.flag & (flags.SATURATED | flags.CLIPPED) > 0).any(axis=1)
    # Of light from which no temperature comes.
    unread = np.where(over, status.SATURATED, status.NO_SIGNAL).astype("int8")
    state = np.where(used & ~alone.converged, unread, state)
    unlike = used & (misfit > MISFIT)
    state[unlike] = status.CONTRADICTED
    # What is not light of a hot surface says nothing about its neighbours; the errors of bins last.
    data[~np.isin(state, (status.VALID, status.GAS_DOMINATED))] = np.nan
    age = np.full(wavelength.size, AGES * shape)
    whole = prior._replace(basis=np.column_stack([age, prior.basis, light.rough]))
    gains = np.broadcast_to(light.gains, (*data.shape, light.gains.shape[1]))
    linear = light.linear
    memories = np.full(whole.basis.shape[1] + linear.shape[-1] + gains.shape[-1], np.inf)
    smooth, shapes = 1 + smooth, 1 + prior.basis.shape[1]
    memories[:shapes] = light.kept
    memories[:smooth] = memory
    memories[whole.basis.shape[1] :][: len(light.memory)] = light.memory
    with np.errstate(divide="ignore"):
        kept = np.exp(-np.diff(frames.time)[:, None] / memories)
    rough = slice(shapes, whole.basis.shape[1])
    kept[:, rough] *= np.exp(-_change(frames.time, alone)[:, None] / LASTS)
    kept[~record.phases(frames.time[1:])[0], 0] = 1.0
    start = np.append(0.0, np.ones(kept.shape[1] - 1))
    bare = found = follow(light.channels, whole, kept, data, noise, linear, gains, start)
    if room is not None:
        count = room.columns.shape[1]
        of_room = np.concatenate([linear, np.broadcast_to(room.columns, (*data.shape, count))], axis=-1)
        stays = np.pad(kept, ((0, 0), (0, count)), constant_values=1.0)
        begun = np.append(start, np.ones(count))
        found = follow(light.channels, whole, stays, data, noise, of_room, gains, begun)
    lost = np.isfinite(data).any(axis=1) & ~(found.converged & (found.relative_uncertainty < LARGEST))
    state = np.where(lost, unread, state)
    # Judged without a lamp, whose free spectrum takes up much that is none.
    pull = log_emissivity(bare, 0.0, whole.basis[:, :smooth])[0] / np.hypot(level, shape)
    pulled = np.isin(state, (status.VALID, status.GAS_DOMINATED))
    pulled &= np.abs(np.nan_to_num(pull)).max(axis=1) > PULLED
    state[pulled] = status.CONTRADICTED
    said = _contradictions(record.clock(frames.time), light, alone.residual, np.flatnonzero(unlike))
    said = said or _asked_for(record.clock(frames.time), wavelength, pull, np.flatnonzero(pulled))
    made = _dataset(test, record, light, whole, smooth, found, alone.residual, state, said)
    if room is None:
        return made
    return made.assign_attrs(_of_lamp(room, bare.temperature - made.spectral_temperature.values))


def _lamp(record, light, prior, alone, data, noise):
    """The `lamps.Lamp` beside the light of the coldest samples, which it moves most; None: unlikely."""
    told = np.isfinite(alone.state[:, 0])
    if not told.any():
        return None
    told &= np.nan_to_num(alone.temperature) < (1 + ALIKE) * alone.temperature[told].min()
    seen = data[told].mean(axis=0)
    error = np.hypot(np.sqrt((noise[told] ** 2).mean(axis=0) / told.sum()), light.independent * seen)
    slit = float(record.attributes["spectrometer_fwhm"])
    linear = light.linear[told].mean(axis=0)
    found = lamp(light.channels, prior, light.middle, seen, error, linear, slit)
    return found if found is not None and found.odds > SURE else None


def _of_lamp(room, cost):
    """What a file says of light of a lamp: kind, logarithm of the odds, where [m], size, `cost` (S,) [K]."""
    named = {"lamp": room.kind, "lamp_odds": room.odds, "lamp_wavelength": room.most}
    named["lamp_radiance"] = room.radiance
    return named | ({"lamp_cost": float(np.nanmedian(cost))} if np.isfinite(cost).any() else {})


def course_freedom(told, channels):
    """Times the stated course that light of such evidence (logarithms, one of each of `FREER`) speaks for.

    The root mean square over all that may be, each as likely beforehand as it is little: five bands alone
    often do not tell, and the likeliest of all would be stated too surely. Fewer than four never do:
    temperature and level take two, and the course is as stated.
    """
    if channels < LEAST_TELLING:
        return 1.0
    odds = np.nan_to_num(told - np.log(FREER), nan=-np.inf)
    weight = np.exp(odds - odds.max()) if np.isfinite(odds).any() else np.ones(1)
    return float(np.sqrt(np.average(np.square(FREER[: weight.size]), weights=weight)))


def _change(time, alone):
    """Relative change of temperature (S - 1,) from sample to sample; those without one lie between theirs."""
    told = alone.converged
    if not told.any():
        return np.zeros(time.size - 1)
    return np.abs(np.diff(np.interp(time, time[told], np.log(alone.temperature[told]))))


def _status(record, light):
    frames, chosen = light.frames, light.flag
    state = np.full(frames.time.size, status.VALID, dtype="int8")
    injected = record.phases(frames.time)[0]
    state[(chosen & (flags.SATURATED | flags.CLIPPED) > 0).mean(axis=1) > 0.5] = status.SATURATED
    state[(chosen & (flags.LOST | flags.STUCK | flags.RELIT) > 0).mean(axis=1) > 0.5] = status.MISSING
    state[~injected] = status.NOT_INJECTED
    state[record.straddling(frames)] = status.STRADDLING
    return state


def _dataset(test, record, light, prior, smooth, found, residual, state, said):
    frames, middle, wavelength = light.frames, light.middle, light.channels.wavelength
    known = np.isin(state, (status.VALID, status.GAS_DOMINATED))
    blank = np.where(known, 1.0, np.nan)
    temperature, error = found.temperature * blank, found.relative_uncertainty
    factor = np.exp(budget.NORMAL_95 * error)
    nearest = np.array([np.argmin(np.abs(wavelength - one)) for one in middle])
    value, deviation = log_emissivity(found, prior.logarithm[nearest], prior.basis[nearest, :smooth])
    value, spread = np.exp(value) * blank[:, None], np.exp(budget.NORMAL_95 * deviation)
    across = ("spectrum_time", "emissivity_wavelength")
    return xr.Dataset(
        {
            "spectral_temperature": ("spectrum_time", temperature),
            "spectral_temperature_uncertainty": ("spectrum_time", temperature * error),
            "spectral_temperature_interval": (
                ("bound", "spectrum_time"),
                np.stack([temperature / factor, temperature * factor]),
            ),
            "spectral_status": ("spectrum_time", state, status.flags()),
            "emissivity": (across, value),
            "emissivity_interval": (("bound", *across), np.stack([value / spread, value * spread])),
            "spectral_residual": (across, residual),
            **budget.variables(_inputs(temperature, error, found.noise_only)),
        },
        {
            "spectrum_time": record.clock(frames.time),
            "time": record.clock(frames.time),
            "emissivity_wavelength": middle,
        },
        carried(test)
        | {
            "degenerate": _degenerate(temperature, found, middle),
            "contradictions": said,
        },
    )


def _inputs(temperature, error, noise):
    """The uncertainty budget: noise, and what calibration and emissivity leave open besides."""
    rest = np.sqrt(np.maximum(error**2 - noise**2, 0.0))
    return [
        budget.Input("noise of the spectra", "noise", temperature * noise),
        budget.Input("emissivity over wavelength, and the calibration", "emittance", temperature * rest),
    ]


def _degenerate(temperature, found, wavelength):
    """What the light cannot tell, in words, for the hottest spectrum."""
    if not np.isfinite(temperature).any():
        return ""
    hottest = np.nanargmax(temperature)
    kelvin, error = temperature[hottest], found.relative_uncertainty[hottest]
    ends = wavelength[[0, -1]] if wavelength.size > 1 else wavelength
    change = 100 * np.expm1(-SECOND_RADIATION / (ends * kelvin) * error)
    words = " and ".join(
        f"{one:+.2g} % at {place * 1e9:.0f} nm" for one, place in zip(change, ends, strict=True)
    )
    return (
        f"of the +- {kelvin * error:.2g} K at {kelvin:.0f} K the noise makes"
        f" {kelvin * found.noise_only[hottest]:.1g} K; a surface hotter by all of it, with an emissivity of"
        f" {words}, gives the same light: what is stated of the emissivity decides"
    )


def _asked_for(time, wavelength, pull, bad):
    """A sentence if spectra ask for another emissivity than was stated."""
    if not bad.size:
        return ""
    row, column = np.unravel_index(np.argmax(np.abs(pull[bad])), pull[bad].shape)
    return (
        f"{bad.size} of {time.size} spectra (first at {time[bad[0]]:g} s) ask for an emissivity that is"
        f" {abs(pull[bad][row, column]):.0f} of its stated uncertainties off at"
        f" {wavelength[column] * 1e9:.0f} nm: other light in the view, or another emissivity than stated"
    )


def _contradictions(time, light, residual, bad):
    """A sentence if spectra are no light of a hot surface of smooth emissivity."""
    if not bad.size:
        return ""
    worst, wavelength = np.nan_to_num(residual[bad]), light.middle
    row, column = np.unravel_index(np.argmax(np.abs(worst)), worst.shape)
    side = "more" if worst[row, column] > 0 else "less"
    return (
        f"{bad.size} of {time.size} spectra (first at {time[bad[0]]:g} s) are not the light of a hot surface"
        f" of smooth emissivity: most at {wavelength[column] * 1e9:.0f} nm, {abs(worst[row, column]):.0f}"
        f" uncertainties {side} light{_as_bright(light, bad[row])}: other light in the view, or a calibration"
        " of another instrument"
    )


def _as_bright(light, row):
    """Where a spectrum is as bright as the hottest and the coldest black body, in words; "" for bands."""
    clear = light.seen[row] > LEAST_CLEAR * light.noise[row]
    if light.channels.weight is None or light.frames.band or clear.sum() < 2:
        return ""
    where, seen = light.middle[clear], light.seen[row][clear]
    kelvin = SECOND_RADIATION / where / np.log1p(FIRST_RADIATION / where**5 / seen)
    ends = (int(np.argmax(kelvin)), int(np.argmin(kelvin)))
    words = " and ".join(f"{kelvin[one]:.0f} K at {where[one] * 1e9:.0f} nm" for one in ends)
    return f" (as bright as a black body of {words})"
