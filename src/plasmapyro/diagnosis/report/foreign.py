"""Species whose lines the gas has and its simulation lacks, as effects that can be kept."""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from plasmapyro.diagnosis.effects.gas import JET_EXCITATION, line_spectrum, lines_of
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.diagnosis.fit.terms import AMPLITUDE, Term
from plasmapyro.identification.identify import NAMED, identify
from plasmapyro.record.binning import LEAVE_OUT_BEFORE, LEAVE_OUT_OFF
from plasmapyro.refraction import air_wavelength

LEAST = 0.5  # probability from which a species is proposed
STRONGEST = 4  # lines that are listed
ERROR = 0.1  # [1] ASSUME: of the simulated light of a pixel, beside the strengths that were measured
FEWEST = 3  # spectra that tell the noise of their mean
BROAD = 10.0  # slits: light that changes over more is no line
OF_AIR = ("N", "O", "N2", "N2+", "O2", "NO")  # whatever of it is simulated: its lines err
NEAR = 1.5  # slits, or channels, within which a line that the comparison found is one of a species


def lines_lacking(model, comparison):
    """Species whose lines the gas has and its simulation lacks, see `species_left`.

    Asked where the comparison shows such a line, in the mean of the spectra behind the injection, pixel by
    pixel, less the simulated gas with its systems and multiplets as strong as measured. A species is listed
    that has one of those lines among its own. `with_sample`: whether less than half of its light is there
    before the injection; None where no spectra say.
    """
    lacking = np.array([one.wavelength for one in comparison.lines if one.strength > 0])
    frames = model.record.instrument("spectrometer")
    if frames is None or not lacking.size:
        return []
    library, half = model.library, frames.integration_time / 2
    ratio = {one.name: one.ratio for one in comparison.systems}
    gas = np.array([ratio.get(name, 1.0) for name in library.group_name]) @ library.group
    margin = half + LEAVE_OUT_OFF
    seen = _mean(frames, (frames.time > margin) & (frames.time < model.off - margin), library, gas)
    before = _mean(frames, frames.time < -half - LEAVE_OUT_BEFORE, library, gas)
    if seen is None:
        return []
    found = species_left(*seen, library, gas)
    reach = NEAR * max(library.slit_fwhm, *(_spacing(one) for one in model.instruments))
    simulated = {name.split()[0] for name in (*library.group_name, *OF_AIR)}
    return [
        {**one, "with_sample": _with_sample(one, before, library, gas)}
        for one in found
        if atom(one) not in simulated and _beside(one["lines"], air_wavelength(lacking), reach)
    ]


def _mean(frames, chosen, library, gas):
    """Wavelengths (C,) [m] of pixels, their mean light in chosen frames less a gas (K,), and its error."""
    light = frames.sound[chosen]
    told = np.isfinite(light).sum(axis=0) >= FEWEST
    if not told.any():
        return None
    wavelength, light = frames.wavelength[told], light[:, told]
    gas = np.interp(wavelength, library.wavelength, gas, left=0.0, right=0.0)
    return wavelength, np.nanmean(light, axis=0) - gas, np.hypot(_noise(light), ERROR * gas)


def _with_sample(one, before, library, gas):
    """Whether a species shines as `before` the injection (of `_mean`) by less than half as much as behind."""
    if before is None:
        return None
    return _amount(one["species"], *before, library, gas)[0] < one["effect"]["amplitude"] / 2


def _spacing(instrument):
    """Middle distance [m] of the channels of a spectrometer, 0 of bands."""
    return float(np.median(np.diff(instrument.wavelength))) if instrument.weight is None else 0.0


def _beside(lines, others, reach):
    """Whether one of some lines lies within a reach [m] of others."""
    return bool((np.abs(np.subtract.outer(lines, others)) < reach).any())


def _noise(light):
    """Standard deviation (C,) of the mean of frames (F, C) in time, from differences of neighbours."""
    count = np.isfinite(light).sum(axis=0)
    return np.sqrt(np.nanmean(np.diff(light, axis=0) ** 2, axis=0) / 2 / count)


def species_left(wavelength, left, sigma, library, gas=None):
    """Species behind light that a model leaves, and the effects that would explain it.

    `left`, `sigma` (C,) [W m-2 sr-1 m-1]: mean light besides the model while the plasma burns, and its
    standard deviation, in channels [m] in vacuum; the O I triplet of a gas (K,), or of the library, is the
    unit of the amplitude. One dict each: `species`, `probability`, `lines` [m] (in air), `rivals`, and
    `effect` with id, amplitude and its standard `uncertainty`, as under the key `effects`.
    """
    usable = np.isfinite(left) & (sigma < 1e3 * np.median(sigma))
    wavelength, left, sigma = wavelength[usable], left[usable], sigma[usable]
    axis = air_wavelength(wavelength)
    answer = identify(axis, left, sigma, library.slit_fwhm, calibrated=True)
    found = []
    for one in answer.named:
        if one.probability >= LEAST:
            matched = one.fit.matched[np.argsort(-answer.peaks.light[one.fit.matched], kind="stable")]
            places = np.sort(answer.peaks.wavelength[matched[:STRONGEST]])
            amplitude, error = _amount(one.species.name, wavelength, left, sigma, library, gas)
            effect = {"id": lines_of(one.species.name).id, "amplitude": amplitude, "uncertainty": error}
            found.append(
                {
                    "species": one.species.name,
                    "probability": one.probability,
                    "lines": [float(place) for place in places],
                    "rivals": list(one.rivals),
                    "effect": effect,
                }
            )
    return found


def _amount(species, wavelength, left, sigma, library, gas):
    """Amplitude of the lines of a species in light (C,) and its error, both beside what is broad."""
    around = BROAD * library.slit_fwhm / np.median(np.diff(wavelength))
    shape = line_spectrum((species,), library, JET_EXCITATION, gas)
    shape = np.interp(wavelength, library.wavelength, shape)
    shape, left = ((one - gaussian_filter1d(one, around)) / sigma for one in (shape, left))
    size = max(float(shape @ shape), 1e-300)
    return max(float(shape @ left) / size, 0.0), size**-0.5


def atom(one):
    """What a species is of: 'Ar' of 'Ar I'."""
    return one["species"].split()[0]


def certain(one):
    """Whether a species is listed with the probability of a name, and no other explains its lines as well."""
    return one["probability"] >= NAMED and not one["rivals"]


def terms_of_jet(foreign):
    """Terms of species that are certain and in the jet with and without a sample, for its simulation."""
    for one in foreign:
        if certain(one) and one["with_sample"] is False:
            effect = one["effect"]
            error = float(np.hypot(effect["uncertainty"], ERROR * effect["amplitude"]))
            setting = Setting(lines_of(one["species"]), effect["amplitude"])
            yield Term(setting, {AMPLITUDE: error}, own=True)


def line_pattern(model, species):
    """Light (c, 1) of the lines of a species in the channels of the last instrument of a model."""
    spectrum = line_spectrum((species,), model.library, JET_EXCITATION)
    centre = np.array([one.centre for one in model.parameters])
    return model.signal_of(len(model.instruments) - 1, spectrum[None], centre).T
