"""How much better a simulation that one test extended foretells another, where line strengths err as well.

    python benchmarks/shared_error.py results --worlds 12 --seed 5

Each world draws a power that the simulation gets wrong at both conditions (normal, 6 %, between 3 and 9 %),
and a factor on the strength of each radiating system (normal, as it states, 8 % at least), the same in both
tests. The first test is fitted; with the power that its gas asks for, the simulation of the second is taken
along the ladder of powers and held against the second test, which no fit sees. Needs results of the main job.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import xarray as xr

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "workflow"))
from twin import campaign, story

from plasmapyro.diagnosis import command
from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit.whole import fit_test
from plasmapyro.diagnosis.gas.library import gas_library
from plasmapyro.diagnosis.simulation.compare import compare
from plasmapyro.diagnosis.simulation.measured import measured_gas
from plasmapyro.diagnosis.simulation.predicted import foretold
from plasmapyro.radiation.bandsignal import band_signal, respond, responsivities

POWERS = (80, 110)  # [kW] of the two tests
POWER_ERROR, RANGE, STRENGTH = 0.06, (0.03, 0.09), 0.08  # [1]; simulated powers lie 9 % apart
SLIT = 0.75e-9  # [m]
STEADY = {identity: one for identity, one in CATALOGUE.items() if one.steady_gas}


def recorded(results, power, change, factor, seed):
    """A test of a gas whose power and strengths differ from those simulated."""
    read = {kw: xr.load_dataset(results / f"radiation/{kw}kW.nc") for kw in (power - 10, power, power + 10)}
    own = read.pop(power)
    true = story.at_power(change, own, list(read.values()))
    light = true["gas_radiance_component"] * factor[:, None]
    true = true.assign(gas_radiance_component=light, gas_radiance=light.sum("component"))
    response = xr.load_dataset(results / "instrument/response.nc")
    scene = campaign.Scene(condition=f"{power}kW", centred_exposures=True, electric_power=2e3 * power)
    return campaign.record(scene, response, [(1.0, true)], seed)[0]


def along_ladder(inputs, power, change):
    """Radiation of a condition at another power, between those that are simulated."""
    name = f"{power}kW"
    own = inputs.radiation[name]
    factor = gas_library(name, inputs.radiation, None, fwhm=SLIT).power_factor(change)
    light = own["gas_radiance_slit"] * factor
    axis, responded = own["wavelength_slit"].values, inputs.response["wavelength"].values
    weights = [respond(axis, responded, curve) for curve in responsivities(inputs.response)]
    signal = [band_signal(axis, weight, light.values) for weight in weights]
    return own.assign(gas_radiance_slit=light, band_signal=("band", signal))


def world(results, inputs, random):
    """Hidden and found change of the power, and the base and extended prediction of the second test."""
    change = 0.0
    while not RANGE[0] < abs(change) < RANGE[1]:
        change = POWER_ERROR * random.standard_normal()
    stated = inputs.radiation["80kW"]["component_uncertainty"].values
    factor = np.exp(np.maximum(stated, STRENGTH) * random.standard_normal(stated.size))
    seeds = random.integers(1, 10**6, 2)
    first, second = (
        recorded(results, power, change, factor, int(seed)) for power, seed in zip(POWERS, seeds, strict=True)
    )
    instrument = inputs.response, inputs.calibration, inputs.spectrometer_calibration
    with np.errstate(all="ignore"):
        base = fit_test(
            first,
            inputs.radiation,
            inputs.variations["80kW"],
            *instrument,
            saturation_counts=command.SATURATION_COUNTS,
        )
        found = compare(base.model, measured_gas(base.model, base.solution), STEADY, seed=1)
    power, error = found.power
    taken = power if found.power_is_wrong else 0.0
    simulated = [along_ladder(inputs, POWERS[1], size) for size in (0.0, taken)]
    pair = foretold(
        {"other": (second, *simulated)},
        *instrument[1:],
        limits=command.LIMITS,
        saturation_counts=command.SATURATION_COUNTS,
    )["other"]
    return change, np.expm1(power), error, found.power_is_wrong, pair


def main():
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    parser.add_argument("results", type=Path)
    parser.add_argument("--worlds", type=int, default=12)
    parser.add_argument("--seed", type=int, default=5)
    options = parser.parse_args()
    folders = options.results / "radiation", options.results / "instrument"
    inputs = command.load_inputs(*folders, options.results / "radiation_variations")
    rows = []
    print("hidden  found         kelvin base  extended  log score base  extended")
    for place in range(options.worlds):
        hidden, found, error, wrong, (before, after) = world(
            options.results, inputs, np.random.default_rng([options.seed, place])
        )
        both = np.isfinite(before.temperature) & np.isfinite(after.temperature)
        kelvin = [np.sqrt(np.mean(one.temperature[both] ** 2)) for one in (before, after)]
        score = [one.log_score.sum() for one in (before, after)]
        rows.append((*kelvin, *score, wrong, abs(np.log1p(hidden) - np.log1p(found)) < 2 * error))
        said = "" if wrong else "  not named"
        print(
            f"{hidden:+.1%}  {found:+.1%} ± {error:.1%}  {kelvin[0]:8.2f} {kelvin[1]:8.2f}"
            f"  {score[0]:10.1f} {score[1]:10.1f}{said}",
            flush=True,
        )
    rows = np.array(rows, dtype=float)
    factor, scores = rows[:, 0] / rows[:, 1], rows[:, 2] / rows[:, 3]
    for what, ratio in (("kelvin", factor), ("log score", scores)):
        share = np.mean(ratio >= 3)
        print(f"{what}: {np.median(ratio):.1f} times less (median), at least 3 times in {share:.0%}")
    print(f"power named in {rows[:, 4].mean():.0%}, within 2 standard errors in {rows[:, 5].mean():.0%}")


if __name__ == "__main__":
    main()
