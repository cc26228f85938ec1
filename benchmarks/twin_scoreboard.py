"""Scoreboard of the joint estimate against the paper's subtraction, on synthetic tests of known truth.

    python benchmarks/twin_scoreboard.py --twins 120 --seed 5

Each twin comes from the independent generator (`workflow/twin`) with its own sample, gas, noise and
errors of calibration, drawn by `draw`. Needs results/radiation and results/instrument/response.nc.
Writes docs/figures/twin_scoreboard.json (the table) and docs/figures/twin_scoreboard.png.
"""

import argparse
import dataclasses
import json
import sys
from pathlib import Path

import numpy as np
import xarray as xr

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "workflow"))

from blind.page import data
from twin import campaign, sample
from twin.plasma import Plasma
from twin.sensors import Pyrometer

from plasmapyro.commands import joint
from plasmapyro.estimate.stage import estimate
from plasmapyro.experiment.stage import correct_pyrometer
from plasmapyro.instrument.stage import pyrometer_calibration, spectrometer_calibration
from plasmapyro.record.status import EXTRAPOLATED, VALID

EMITTANCE_UNCERTAINTY = 0.05  # standard; the stated emittance is drawn within two of them
SOURCE_UNCERTAINTY = 3.0  # [K] standard, as in the paper; the twin draws it from a uniform law
SIGNAL_UNCERTAINTY = 0.01  # standard, of a calibration point
BAND_SHIFT = 1e-9  # [m] standard, of each response along the wavelength
HEATING = (10.0, 80.0)  # [s]
PAPER_LIMIT = 5.0  # [K] below this error of the paper's method there is nothing to gain
USABLE = 0.02  # relative: stated standard uncertainty and true error of a usable temperature
USABLE_SPAN, USABLE_SHARE = 5.0, 0.9  # [s] in which that share of the samples must be usable
SETTINGS = {  # of the joint estimate, as in config/config.yaml
    **joint.SETTINGS,
    "band_shift_uncertainty": BAND_SHIFT,
    "saturation_counts": 65000.0,
    "noise_block": 50,
}


@dataclasses.dataclass(frozen=True)
class Draw:
    """What is true about one twin, and what its laboratory believes."""

    emittance: float
    stated_emittance: float
    steady_temperature: float  # [K]
    power: float  # [kW]
    drift: float
    noise: float
    before_injection: float
    band_shift: tuple  # [m] wide, narrow
    seed: int


def draw(seed, number):
    """One twin: emittance 0.3 to 0.95, 1100 to 2000 K, 50 to 130 kW, drift to 20 %, noise 0.5 to 2 %."""
    random = np.random.default_rng([seed, number])
    emittance = random.uniform(0.3, 0.95)
    stated = np.nan
    while not (abs(stated - emittance) <= 2 * EMITTANCE_UNCERTAINTY and stated < 1):
        stated = random.normal(emittance, EMITTANCE_UNCERTAINTY)
    return Draw(
        emittance,
        stated,
        random.uniform(1100, 2000),
        random.uniform(50, 130),
        random.uniform(-0.2, 0.2),
        random.uniform(0.005, 0.02),
        random.uniform(1.2, 2.0),
        tuple(BAND_SHIFT * random.standard_normal(2)),
        int(random.integers(2**31)),
    )


def heat_flux(disc, steady):
    """Cold-wall heat flux [W m-2] at which a sample settles at a temperature [K]."""
    inward = disc.contact * disc.holder_loss / (disc.contact + disc.holder_loss)
    lost = disc.emittance * sample.STEFAN_BOLTZMANN * (steady**4 - disc.surroundings**4)
    return (lost + inward * (steady - disc.initial_temperature)) / (1 - steady / disc.recovery_temperature)


def true_response(response, shifts):
    """The response that the instrument really has: each band moved along the wavelength."""
    grid = response.wavelength.values
    moved = {
        f"responsivity_{band}": (
            "wavelength",
            np.interp(grid - shift, grid, response[f"responsivity_{band}"].values),
        )
        for band, shift in zip(("wide", "narrow"), shifts, strict=True)
    }
    return response.assign(moved)


def mixed_gas(radiations, power):
    """Weights and spectra of a gas between two simulated powers [kW], not on their grid."""
    nodes = sorted(radiations)
    upper = int(np.clip(np.searchsorted(nodes, power), 1, len(nodes) - 1))
    share = (power - nodes[upper - 1]) / (nodes[upper] - nodes[upper - 1])
    return [(1 - share, radiations[nodes[upper - 1]]), (share, radiations[nodes[upper]])]


def exposure(device, twin, gas):
    """Integration time [s] that keeps the brightest pixel below three quarters of full scale."""
    from twin.light import planck

    brightest = twin.before_injection * 1.2 * sum(weight * one.gas_radiance_slit for weight, one in gas)
    brightest = np.interp(device.wavelength, one_axis(gas), brightest.values)
    surface = twin.emittance * planck(device.wavelength, twin.steady_temperature + 50)
    rate = (device.rate_per_radiance(planck) * np.maximum(brightest, surface + brightest)).max()
    return float(
        np.clip(np.floor(0.75 * device.full_scale / rate / campaign.TICK) * campaign.TICK, 0.05, 1.0)
    )


def one_axis(gas):
    """Wavelengths of the slit-convolved gas spectra."""
    return gas[0][1].wavelength_slit.values


def make(twin, response, radiations):
    """Files of one twin: test, truth, calibration of both instruments."""
    source = campaign.Source(
        bias=np.sqrt(3) * SOURCE_UNCERTAINTY,
        reading=np.sqrt(3 * campaign.Source.readings) * SIGNAL_UNCERTAINTY,
    )
    disc = sample.Sample(emittance=twin.emittance)
    disc = dataclasses.replace(disc, cold_wall_heat_flux=heat_flux(disc, twin.steady_temperature))
    gas = mixed_gas(radiations, twin.power)
    device = campaign.Spectrometer()
    scene = campaign.Scene(
        condition="80kW",
        stated_emittance=twin.stated_emittance,
        stated_emittance_uncertainty=EMITTANCE_UNCERTAINTY,
        spectrometer_integration_time=exposure(device, twin, gas),
        sample=disc,
        plasma=Plasma(drift=twin.drift, before_injection=twin.before_injection),
        pyrometer=Pyrometer(reading_noise=twin.noise),
    )
    true = true_response(response, twin.band_shift)
    test, truth = campaign.record(scene, true, gas, twin.seed)
    calibration = pyrometer_calibration(
        response,
        campaign.calibration_points(true, twin.seed, source),
        source_temperature_uncertainty=SOURCE_UNCERTAINTY,
        signal_uncertainty=SIGNAL_UNCERTAINTY,
        instrument_range=(973.0, 2073.0),
        calibration_temperature=np.arange(400.0, 4001.0, 100.0),
        draws=50,
        seed=1,
    )
    counts = spectrometer_calibration(
        campaign.spectrometer_counts(twin.seed, source),
        source_temperature_uncertainty=SOURCE_UNCERTAINTY,
        saturation_counts=65000.0,
        least_net_counts=50.0,
        noise_block=50,
    )
    return test, truth, calibration, counts


def score(twin, response, radiations, instruments):
    """Numbers of one twin for the paper's method and the joint estimate with some instruments."""
    test, truth, calibration, counts = make(twin, response, radiations)
    paper = correct_pyrometer(
        test,
        calibration,
        signal_uncertainty=twin.noise,
        gas_variation=0.03,
        detection_level=2.0,
        least_surface_share=0.5,
        draws=60,
        seed=2,
    )
    trusted = np.isin(paper.corrected_status, (VALID, EXTRAPOLATED))
    theirs = np.where(trusted, paper.corrected_temperature - truth.surface_temperature, np.nan)
    their_spread = paper.corrected_temperature_uncertainty.values
    time, right = truth.time.values, truth.surface_temperature.values
    shining = (time >= 0) & (time <= test.attrs["plasma_off_time"])
    row = dataclasses.asdict(twin) | {
        "paper_start": usable_from(time, theirs, their_spread, right, shining),
        # Averaged, and judged by its true error alone: the most that can be said for the subtraction.
        "paper_averaged_start": usable_from(
            time, averaged(theirs, shining), np.zeros(time.size), right, shining
        ),
        "paper_share": float(np.isfinite(theirs[heating(time)]).mean()),
    }
    for name in instruments:
        data = test if name == "both" else test.drop_dims(["spectrum_time", "wavelength"])
        found = estimate(data, calibration, response, counts, **SETTINGS)
        ours = found.surface_temperature.values - right
        low, high = found.surface_temperature_interval.values
        held = (low <= right) & (right <= high)
        shared = heating(time) & np.isfinite(theirs) & np.isfinite(ours)
        every = np.isfinite(ours)
        row[name] = {
            "rms_paper": rms(theirs[shared]),
            "rms_joint": rms(ours[shared]),
            "rms_paper_averaged": rms(averaged(theirs, heating(time))[shared]),
            "rms_joint_all": rms(ours[heating(time)]),
            "joint_share": float(every[heating(time)].mean()),
            "coverage": float(held[every].mean()),
            "coverage_heating": float(held[every & heating(time)].mean())
            if every[heating(time)].any()
            else None,
            "pull_steady": float(
                np.nanmean((ours / found.surface_temperature_uncertainty.values)[shining & (time > 200)])
            ),
            "uncertainty_steady": float(
                np.nanmean(found.surface_temperature_uncertainty.values[shining & (time > 200)])
            ),
            "start": usable_from(time, ours, found.surface_temperature_uncertainty.values, right, shining),
            "gas_error": rms((found.gas_amplitude / truth.gas_scale - 1).values[shining & (time > 10)]),
            "steps": int(found.attrs["steps"]),
        }
    return row


def heating(time):
    return (time >= HEATING[0]) & (time <= HEATING[1])


def rms(values):
    """Root mean square of what is finite, None without any."""
    good = np.isfinite(values)
    return float(np.sqrt(np.mean(values[good] ** 2))) if good.any() else None


def averaged(error, chosen, samples=20):
    """Error of the running mean of two seconds of what the subtraction gives; NaN where it gives nothing."""
    good = (np.isfinite(error) & chosen).astype(float)
    kernel = np.ones(2 * (samples // 2) + 1)
    total = np.convolve(np.where(good > 0, error, 0.0), kernel, "same")
    mean = total / np.maximum(np.convolve(good, kernel, "same"), 1)
    return np.where(good > 0, mean, np.nan)


def usable_from(time, error, spread, right, shining):
    """First time [s] from which on, for `USABLE_SPAN`, stated and true errors stay small; None if never."""
    good = (np.abs(error) < USABLE * right) & (spread < USABLE * right)
    step = time[1] - time[0]
    width = round(USABLE_SPAN / step)
    ahead = np.convolve(good, np.ones(width), "full")[width - 1 :] / width
    first = np.flatnonzero(good & shining & (ahead >= USABLE_SHARE) & (time <= time[-1] - USABLE_SPAN))
    return float(time[first[0]]) if first.size else None


def summary(rows, name):
    """The bars of the comparison over all twins."""
    part = [row[name] for row in rows]
    both = [p for p in part if p["rms_paper"] is not None and p["rms_joint"] is not None]
    large = [p for p in both if p["rms_paper"] > PAPER_LIMIT]
    gain = [p["rms_paper"] / p["rms_joint"] for p in large]
    averaged_gain = [p["rms_paper_averaged"] / p["rms_joint"] for p in large]
    worse = [p for p in both if p["rms_joint"] > 1.1 * p["rms_paper"]]
    own = [row[name]["start"] for row in rows if row[name]["start"] is not None]
    return {
        "twins": len(rows),
        "compared": len(both),
        "paper_above_5K": len(large),
        "rms_paper_pooled_K": float(np.sqrt(np.mean([p["rms_paper"] ** 2 for p in large]))),
        "rms_joint_pooled_K": float(np.sqrt(np.mean([p["rms_joint"] ** 2 for p in large]))),
        "gain_median": float(np.median(gain)),
        "gain_of_pooled": float(
            np.sqrt(
                np.mean([p["rms_paper"] ** 2 for p in large]) / np.mean([p["rms_joint"] ** 2 for p in large])
            )
        ),
        "share_with_gain_3": float(np.mean(np.array(gain) >= 3)),
        "gain_lowest": float(np.min(gain)),
        "gain_median_against_averaged_paper": float(np.median(averaged_gain)),
        "share_worse_by_10_percent": len(worse) / len(both),
        "coverage": float(np.mean([p["coverage"] for p in part])),
        "coverage_heating": float(
            np.mean([p["coverage_heating"] for p in part if p["coverage_heating"] is not None])
        ),
        "pull_rms_steady": float(np.sqrt(np.mean([p["pull_steady"] ** 2 for p in part]))),
        "median_uncertainty_steady_K": float(np.median([p["uncertainty_steady"] for p in part])),
        "median_start_s": float(np.median(own)),
        "paper_never_usable": sum(row["paper_start"] is None for row in rows),
        "joint_never_usable": sum(row[name]["start"] is None for row in rows),
        **{
            f"start_gain_{key}": gain_of_start(rows, name, key)
            for key in ("paper_start", "paper_averaged_start")
        },
    }


def gain_of_start(rows, name, key):
    """How much earlier [s] the joint estimate is usable; a method that never is counts as late as can be."""
    ours = [np.inf if row[name]["start"] is None else row[name]["start"] for row in rows]
    theirs = [np.inf if row[key] is None else row[key] for row in rows]
    pairs = [(a, b) for a, b in zip(ours, theirs, strict=True) if np.isfinite(a) or np.isfinite(b)]
    median = float(np.median([b - a for a, b in pairs])) if pairs else np.nan
    both = [b - a for a, b in pairs if np.isfinite(a) and np.isfinite(b)]
    return {
        "median_s": median if np.isfinite(median) else None,  # None: more than half never become usable
        "median_where_both_s": float(np.median(both)) if both else None,
        "both": len(both),
        "earlier": sum(a < b for a, b in pairs),
        "later": sum(a > b for a, b in pairs),
    }


def load(results):
    """Response and radiances of all conditions, by power [kW]."""
    response = xr.load_dataset(results / "instrument/response.nc")
    radiations = {
        float(path.stem.removesuffix("kW")): xr.load_dataset(path)[["gas_radiance", "gas_radiance_slit"]]
        for path in (results / "radiation").glob("*kW.nc")
    }
    return response, radiations


def figure(rows, path):
    """Error of both methods, and the pulls of the joint estimate."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    drawing, axes = plt.subplots(1, 3, figsize=(9.6, 3.2), layout="constrained")
    for name, mark, colour in (("pyrometer", "o", "#2166ac"), ("both", "s", "#b2182b")):
        pairs = np.array(
            [(r[name]["rms_paper"], r[name]["rms_joint"]) for r in rows if r[name]["rms_paper"] is not None]
        )
        axes[0].loglog(*pairs.T, mark, ms=3, color=colour, label=f"joint, {name}")
        starts = [row[name]["start"] for row in rows if row[name]["start"] is not None]
        axes[1].plot(
            np.sort(starts), np.arange(1, len(starts) + 1) / len(rows), color=colour, label=f"joint, {name}"
        )
        pulls = np.sort([row[name]["pull_steady"] for row in rows])
        axes[2].plot(pulls, (np.arange(pulls.size) + 0.5) / pulls.size, color=colour, label=name)
    ends = np.array([5.0, 100.0])
    for factor, style in ((1, "-"), (3, "--")):
        axes[0].plot(ends, ends / factor, "k" + style, lw=0.7)
    axes[0].annotate("3x better", (5.2, 2.6), fontsize=7)
    axes[0].set(xlabel="rms error of the subtraction [K]", ylabel="rms error of the joint estimate [K]")
    starts = [row["paper_start"] for row in rows if row["paper_start"] is not None]
    axes[1].plot(np.sort(starts), np.arange(1, len(starts) + 1) / len(rows), "0.4", label="subtraction")
    axes[1].set(xlabel="usable from [s]", ylabel="share of twins", xlim=(0, 120), ylim=(0, 1))
    from scipy.stats import norm

    grid = np.linspace(-3.5, 3.5, 100)
    axes[2].plot(grid, norm.cdf(grid), "k--", lw=0.7, label="normal")
    axes[2].set(xlabel="error over stated uncertainty, steady", ylabel="share of twins", xlim=(-3.5, 3.5))
    for one in axes:
        one.legend(fontsize=7, frameon=False)
    drawing.suptitle(f"{len(rows)} synthetic twins", fontsize=9)
    drawing.savefig(path, dpi=160)


def main():
    """Run, print the summary, write the table and the figure."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--twins", type=int, default=120)
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--first", type=int, default=0, help="number of the first twin")
    parser.add_argument(
        "--join", type=Path, nargs="+", help="tables of parts to put together, nothing is run"
    )
    parser.add_argument("--results", type=Path, default=ROOT / "results")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "figures")
    options = parser.parse_args()
    if options.join:
        tables = [json.loads(path.read_text(encoding="utf-8")) for path in options.join]
        rows = [row for table in tables for row in table["twins"]]
    else:
        response, radiations = load(options.results)
        rows = []
        for number in range(options.first, options.first + options.twins):
            rows.append(score(draw(options.seed, number), response, radiations, ("pyrometer", "both")))
            print(
                number,
                *(f"{name}: {rows[-1][name]['rms_joint']}" for name in ("pyrometer", "both")),
                flush=True,
            )
    table = {
        "origin": "synthetic",
        "seed": options.seed,
        "summary": {name: summary(rows, name) for name in ("pyrometer", "both")},
        "twins": rows,
    }
    print(json.dumps(table["summary"], indent=1))
    (options.out / "twin_scoreboard.json").write_text(data(table), encoding="utf-8")
    figure(rows, options.out / "twin_scoreboard.png")


if __name__ == "__main__":
    main()
