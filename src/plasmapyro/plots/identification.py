"""Figure of a spectrum with the names of its lines."""

import numpy as np

from plasmapyro.plots import style

NANOMETRE = 1e-9
FAINTEST = 0.3  # of the median noise, lower end of the axis
LABELS = 5  # lines with a label, per species


def draw(answer, least, paths):
    """Spectrum above what is broad, with the strongest lines of each species likelier than `least`."""
    peaks = answer.peaks
    _, axes = style.figure(size=(7.0, 3.2))
    floor = max(FAINTEST * float(np.median(peaks.above[peaks.above > 0], axis=None)), 1e-30)
    axes.semilogy(peaks.axis / NANOMETRE, np.maximum(peaks.above, floor), color="0.55", lw=0.5)
    shown = [one for one in answer.named if one.probability >= least]
    for one, colour in zip(shown, style.case_colours(len(shown)), strict=True):
        strongest = one.fit.matched[np.argsort(-peaks.light[one.fit.matched], kind="stable")]
        at = peaks.wavelength[strongest] / NANOMETRE
        height = np.interp(peaks.wavelength[strongest], peaks.axis, peaks.above)
        axes.plot(at, height, "v", ms=2.5, color=colour, label=f"{one.species.name} ({one.probability:.2f})")
        for place, top in zip(at[:LABELS], height[:LABELS], strict=True):
            axes.annotate(
                one.species.name, (place, 1.3 * top), rotation=90, fontsize=5, ha="center", color=colour
            )
    left = peaks.wavelength[answer.unexplained]
    axes.plot(
        left / NANOMETRE,
        np.interp(left, peaks.axis, peaks.above),
        "x",
        ms=2.5,
        color="k",
        label="no known line",
    )
    axes.set(xlabel="Wavelength in air [nm]", ylabel="Signal above what is broad")
    axes.set_ylim(floor, 8 * peaks.above.max())
    axes.legend(ncols=1, bbox_to_anchor=(1.01, 1), loc="upper left")
    style.save(axes, paths)
