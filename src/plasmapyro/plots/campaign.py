"""Figure of a campaign: the law of the efficiency, what the windows lose, and which test does not belong."""

import numpy as np

from plasmapyro.plots import style

COLOURS = {"gain_pyrometer": "#4e79a7", "gain_spectrometer": "#f28e2b"}


def laws(found, paths):
    """Efficiency against electric power, and throughputs of the windows from run to run."""
    _, (left, right) = style.figure(size=(7.4, 3.0), ncols=2, layout="constrained")
    _efficiency(left, found)
    _windows(right, found)
    style.save(left, paths)


def _measured(row, name):
    law = row.test.after.of([name])
    return float(law.mean[0]), float(law.sigma[0])


def _efficiency(axes, found):
    power = np.array([row.test.electric_power for row in found.rows])
    axis = np.linspace(0.9 * power.min(), 1.1 * power.max(), 60)
    at = [found.joint.index[name] for name in ("efficiency", "exponent")]
    rows = np.stack([np.ones_like(axis), np.log(axis / found.reference_power)])
    mean = found.joint.mean[at] @ rows
    sigma = np.sqrt(np.einsum("ik,ij,jk->k", rows, found.joint.covariance[np.ix_(at, at)], rows))
    ends = np.exp([mean - 1.96 * sigma, mean + 1.96 * sigma])
    axes.fill_between(axis / 1e3, *ends, color="0.85")
    axes.plot(axis / 1e3, np.exp(mean), color="0.3", label="law, with its 95 % interval")
    for row, one in zip(found.rows, power, strict=True):
        if "power" not in row.test.after.names:
            continue
        value, error = _measured(row, "power")
        ratio, odd = np.exp(value) / one, "efficiency" in row.odd
        axes.errorbar(
            one / 1e3,
            ratio,
            1.96 * error * ratio,
            fmt="o",
            ms=3,
            capsize=2,
            color="#d62728" if odd else "0.1",
        )
        if odd:
            axes.annotate(
                row.test.name, (one / 1e3, ratio), xytext=(4, 4), textcoords="offset points", fontsize=7
            )
    axes.set(xlabel="Electric power [kW]", ylabel="Simulated over electric power")
    axes.legend(fontsize=7, frameon=False)


def _windows(axes, found):
    runs = np.arange(len(found.rows) + 1)
    for name, colour in COLOURS.items():
        if not any(name in row.test.after.names for row in found.rows):
            continue
        names = [*(row.test.name for row in found.rows), "next"]
        law = np.array([found.joint.number(f"{name} {one}") for one in names])
        mean, sigma = 100 * law.T
        axes.fill_between(runs, mean - 1.96 * sigma, mean + 1.96 * sigma, color=colour, alpha=0.25, lw=0)
        axes.plot(runs, mean, color=colour, marker="o", ms=3, label=f"window of the {name[5:]}")
        for run, row in enumerate(found.rows):
            if "window" in row.odd:
                axes.plot(run, 100 * _measured(row, name)[0], marker="x", color="#d62728")
                axes.annotate(
                    row.test.name, (run, 100 * _measured(row, name)[0]), xytext=(4, 4),
                    textcoords="offset points", fontsize=7,
                )  # fmt: skip
    cleanings = [row.test.cleanings for row in found.rows] + [found.coming.cleanings]
    for run in np.flatnonzero(np.diff(cleanings)):
        axes.axvline(run + 0.5, color="0.5", ls=":", lw=0.8)
        axes.text(run + 0.55, axes.get_ylim()[1], "cleaned", rotation=90, va="top", fontsize=7, color="0.4")
    axes.set_xticks(runs, [*(row.test.name for row in found.rows), "next"], rotation=60, fontsize=6)
    axes.set(ylabel="Throughput, change since calibration [%]")
    axes.legend(fontsize=7, frameon=False, loc="lower left")
