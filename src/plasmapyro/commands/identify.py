"""`plasmapyro identify`: which species a spectrum shows."""

import csv
import io as text
import sys

import numpy as np

from plasmapyro import io, progress
from plasmapyro.commands.outputs import require_writable
from plasmapyro.identification.identify import identify
from plasmapyro.identification.peaks import find
from plasmapyro.readers.spectrum import read_frames
from plasmapyro.refraction import HIGHEST, air_wavelength

NANOMETRE = 1e-9
LEAST_FRAMES = 5  # that tell their own noise
LEAST_PEAKS, FAR = 5, 2.0  # that tell the width of a sharp line, and how far a stated one may be from it
SHOWN = 12  # peaks without a name, strongest first
COLUMNS = ("species", "probability", "log_bayes", "peaks", "temperature_k", "lines_nm", "or_else")


def run(options):
    """Run `plasmapyro identify`: one spectrum in, names out."""
    inputs = [options.spectrum, options.dark]
    require_writable([path for path in (options.out, options.plot) if path], inputs)
    axis, frames = read_frames(options.spectrum)
    noise = _noise(frames) if len(frames) >= LEAST_FRAMES else None
    if options.dark:
        dark_axis, dark = read_frames(options.dark)
        if dark_axis.shape != axis.shape or np.abs(dark_axis - axis).max() > 1e-12:
            raise ValueError(f"{options.dark}: has other wavelengths than {options.spectrum}; take it again")
        noise = np.hypot(noise, _noise(dark)) if noise is not None and len(dark) >= LEAST_FRAMES else noise
        frames = frames - dark.mean(axis=0)
    if axis[-1] > HIGHEST:
        raise ValueError(
            f"{options.spectrum}: wavelengths {axis[0] / NANOMETRE:.0f} to {axis[-1] / NANOMETRE:.0f} nm, but"
            f" lines are known to {HIGHEST / NANOMETRE:.0f} nm; cut it, or say the unit above its column:"
            " 'wavelength [Angstrom]'"
        )
    if options.vacuum:
        axis = air_wavelength(axis)
    signal = _without_gaps(frames.mean(axis=0))
    noise = None if noise is None else _without_gaps(noise)
    stated = options.fwhm_nm and options.fwhm_nm * NANOMETRE
    answer = identify(axis, signal, noise, stated, options.calibrated)
    if stated:
        _hold_against_peaks(stated, find(axis, signal, noise))
    rows = [row(one, answer) for one in answer.named if one.probability >= options.least_probability]
    if options.out:
        table = text.StringIO()
        csv.writer(table, lineterminator="\n").writerows([COLUMNS, *rows])
        io.write_text(table.getvalue(), options.out)
    if options.plot:
        from plasmapyro.plots.identification import draw  # matplotlib, which only pictures need

        draw(answer, options.least_probability, [options.plot])
    sys.stdout.write(words(answer, rows))


def _hold_against_peaks(stated, peaks):
    """Says a stated width [m] of a sharp line that the peaks do not have: names rest on it."""
    seen = float(np.median(peaks.slit))
    if peaks.wavelength.size >= LEAST_PEAKS and not 1 / FAR < stated / seen < FAR:
        progress.warn(
            f"--fwhm-nm is {stated / NANOMETRE:g}, but the sharpest of {peaks.wavelength.size} peaks are"
            f" {seen / NANOMETRE:.2g} nm wide: names rest on the width; leave the option out, or state theirs"
        )


def _noise(frames):
    """Standard deviation (N,) of the mean of frames, from their scatter; at least the median."""
    noise = frames.std(axis=0, ddof=1) / np.sqrt(len(frames))
    return np.maximum(noise, np.nanmedian(noise))


def _without_gaps(signal):
    """A signal (N,), straight across channels that hold no number: no line is found there."""
    held, place = np.isfinite(signal), np.arange(signal.size)
    return np.interp(place, place[held], signal[held]) if held.any() else np.zeros(signal.size)


def row(one, answer):
    """What is said of a named species, in the order of `COLUMNS`."""
    at = answer.peaks.wavelength[one.fit.matched]
    strongest = np.sort(at[np.argsort(-answer.peaks.light[one.fit.matched], kind="stable")[:4]])
    return (
        one.species.name,
        f"{one.probability:.3f}",
        f"{one.fit.log_bayes:.1f}",
        at.size,
        f"{one.fit.temperature:.0f}",
        " ".join(f"{value / NANOMETRE:.2f}" for value in strongest),
        " ".join(one.rivals).replace(" I", "_I"),
    )


def words(answer, rows):
    """The page for the terminal."""
    if not answer.peaks.wavelength.size:
        return "no line or band stands out of the noise\n"
    middle = (answer.peaks.axis[0] + answer.peaks.axis[-1]) / 2
    lines = [
        f"{answer.peaks.wavelength.size} peaks from {answer.peaks.axis[0] / NANOMETRE:.0f} to"
        f" {answer.peaks.axis[-1] / NANOMETRE:.0f} nm"
    ]
    if rows:
        off = float(answer.scale(middle)) / NANOMETRE
        lines[0] += f"; the wavelength scale is {off:+.2f} nm off in the middle"
        table = [COLUMNS, *([str(cell) for cell in one] for one in rows)]
        widths = [max(len(one[k]) for one in table) for k in range(len(COLUMNS))]
        lines += ["  ".join(c.ljust(w) for c, w in zip(one, widths, strict=True)).rstrip() for one in table]
    else:
        lines.append("no known species explains them")
    left = answer.unexplained[np.argsort(-answer.peaks.snr[answer.unexplained], kind="stable")]
    if left.size:
        shown = " ".join(f"{value / NANOMETRE:.2f}" for value in answer.peaks.wavelength[left[:SHOWN]])
        lines.append(f"no known line: {left.size} peaks, strongest at {shown} nm")
    return "\n".join(lines) + "\n"
