"""Does the measurement that a diagnosis ranks first remove most uncertainty when it is really made?

    python benchmarks/next_measurement.py [--results results] [--cases 60] [--seed 1]

Tests of the first laboratory (`workflow/twin`) with drawn emittance and its stated error, heat flux, length,
noise, error of the ratio, instruments, and with some of the measurements already made. Each other one is
simulated: calibration, lamp, responses or emittance as numbers drawn about the truth and put into a new fit,
further tests by another record and its own fit, whose law of the instruments joins. Measurements within 2 %
of the best count as the best; those expected to leave more than 1.15 times what the first leaves are not
made.
"""

from collections import Counter
from dataclasses import replace

import numpy as np
from first_laboratory import asked  # which finds the workflow

# isort: split
from twin import campaign, runs
from twin.campaign import Scene
from twin.sample import Sample

from plasmapyro.diagnosis.fit.base import fit_base
from plasmapyro.diagnosis.fit.build import base_model
from plasmapyro.diagnosis.fit.inference import Fitter
from plasmapyro.diagnosis.fit.prior import Normal, posterior_of, prior_of, with_prior
from plasmapyro.diagnosis.gas.library import gas_library
from plasmapyro.diagnosis.report.following import AGAIN, OTHER, Following, following, measurements
from plasmapyro.record.record import record_of

ALIKE = 1.02
MADE = 1.15
AT_HAND = "calibration", "fixed_point", "emittance", "response"  # may have been made before
SHARE = 0.4  # of tests, each


def drawn(random):
    """What one case is: true and stated emittance, flux, length, noise, instruments, power."""
    emittance = random.uniform(0.6, 0.92)
    error = float(np.exp(random.uniform(np.log(0.005), np.log(0.1))))
    return {
        "emittance": emittance,
        "error": error,
        "stated": float(np.clip(emittance * (1 + error * random.normal()), 0.3, 0.99)),
        "flux": 4.5e5 * random.uniform(0.6, 1.4),
        "off": random.uniform(50, 150),
        "noise": float(np.exp(random.uniform(np.log(0.001), np.log(0.01)))),
        "ratio": float(np.exp(random.uniform(np.log(0.3), np.log(4)))),  # times the stated error of the ratio
        "instruments": random.choice(["both", "both", "pyrometer", "spectrometer"]),
        "power": random.uniform(7.5e4, 8.5e4),
        "done": [name for name in AT_HAND if random.uniform() < SHARE],
    }


def test_of(case, inputs, gas, seed):
    """A record of a case."""
    scene = Scene(
        condition="80kW",
        end=case["off"] + 40.0,
        plasma_off_time=case["off"],
        stated_emittance=case["stated"],
        stated_emittance_uncertainty=case["error"] * case["stated"],
        sample=Sample(emittance=case["emittance"], cold_wall_heat_flux=case["flux"]),
        pyrometer=replace(Scene(condition="80kW").pyrometer, reading_noise=case["noise"]),
        centred_exposures=True,
    )
    test, _ = campaign.record(scene, inputs.response, [(1.0, runs.gas(gas, case["power"]))], seed)
    if case["instruments"] == "pyrometer":
        return runs.without_spectra(test)
    return test.drop_dims("time") if case["instruments"] == "spectrometer" else test


def fitted(test, case, inputs, random=None):
    """Base fit of a test, with what has been measured before if `random` is given."""
    calibration = None
    if case["instruments"] != "spectrometer":
        calibration = inputs.calibration.copy()
        calibration["sensitivity_ratio_uncertainty"] = (
            inputs.calibration.sensitivity_ratio_uncertainty * case["ratio"]
        )
    calibrations = {"spectrometer": inputs.spectrometer_calibration}
    if calibration is not None:
        calibrations["pyrometer"] = calibration
    record = record_of(test, calibrations, saturation_counts=65000.0)
    fwhm = float(test.attrs["spectrometer_fwhm"])
    with np.errstate(all="ignore"):
        library = gas_library("80kW", inputs.radiation, inputs.variations["80kW"], fwhm=fwhm)
        model = base_model(record, library, calibration, inputs.response, inputs.spectrometer_calibration)
        law = prior_of(model)
        for name in case["done"] if random is not None else ():
            law = observed(law, name, case, random)
        return fit_base(with_prior(model, law))


def joined(law, rows, value, information):
    """A law of the shared numbers with what a measurement says of `rows` of them."""
    prior = np.linalg.inv(law.covariance)
    covariance = np.linalg.inv(prior + rows.T @ information @ rows)
    mean = covariance @ (prior @ law.mean + rows.T @ information @ value)
    return Normal(law.names, mean, (covariance + covariance.T) / 2)


def observed(law, name, case, random):
    """The law after a measurement of its numbers, drawn about the truth."""
    for observes, uncertainty in measurements()[name][1]:
        mine = [p for p, one in enumerate(law.names) if one == observes or one.startswith(f"{observes}_")]
        if not observes or not mine:
            continue
        true = np.zeros(len(mine))  # an instrument as it is stated
        if observes == "emittance":
            true = np.array([np.log(case["emittance"] / case["stated"])])
        value = true + uncertainty * random.normal(size=len(mine))
        law = joined(law, np.eye(len(law.names))[mine], value, np.eye(len(mine)) / uncertainty**2)
    return law


def measured(base, name, case, context, random):
    """Uncertainty [K] of the temperature of a test after a measurement that is simulated."""
    model, fit = base.model, base.solution
    law = prior_of(model)
    known = law
    for observes, _ in measurements()[name][1]:
        if observes.startswith("repeat"):
            known = repeated(base, known, observes, case, context)
    known = observed(known, name, case, random)
    if known is not law:
        fit = Fitter(with_prior(model, known), base.fitter.noise).fit(fit.state)
    state, covariance = Following(model, base.solution), fit.covariance
    if name in ("shelf", "gas_spectrum"):  # what is no number of a prior joins the law after the fit
        covariance = Following(model, fit).after(covariance, measurements()[name][1])
    return state.kelvin(covariance)


def repeated(base, law, kind, case, context):
    """The law after another record: at another power, or of a sample of another emittance."""
    inputs, gas, seed = context
    other = dict(case, power=1.1 * case["power"], flux=1.15 * case["flux"])
    scatter = AGAIN
    if kind != "repeat":
        emittance = 0.9 if case["emittance"] < 0.75 else 0.6
        other, scatter = dict(case, emittance=emittance, stated=emittance), OTHER
    second = fitted(test_of(other, inputs, gas, seed + 7), other, inputs)
    after, before = posterior_of(second.model, second.solution), prior_of(second.model)
    covariance = np.linalg.inv(
        np.linalg.inv(after.covariance) - np.linalg.inv(before.covariance) + 1e-9 * np.eye(len(after.names))
    )
    wide = [min(scatter.get(name, 0.0), 10.0) for name in after.names]
    information = np.linalg.inv(covariance + np.diag(np.square(wide)))
    return joined(law, np.eye(len(law.names)), after.mean, information)


def main():
    """Print one line for each case and the share of right first ranks."""
    options, inputs, gas = asked(__doc__)
    right, firsts = 0, Counter()
    for number in range(options.cases):
        random = np.random.default_rng([options.seed, number])
        case = drawn(random)
        base = fitted(test_of(case, inputs, gas, number), case, inputs, random)
        ranked = [row for row in following(base.model, base.solution) if row["id"] not in case["done"]]
        context = inputs, gas, number
        near = [row for row in ranked if row["kelvin_after"] <= MADE * ranked[0]["kelvin_after"]]
        kelvin = {row["id"]: measured(base, row["id"], case, context, random) for row in near}
        first, best = ranked[0]["id"], min(kelvin, key=kelvin.get)
        right += kelvin[first] <= ALIKE * kelvin[best]
        firsts[first] += 1
        print(
            f"{number:3d} {case['instruments']:12s} done {'+'.join(case['done']) or 'nothing'}:"
            f" {ranked[0]['kelvin_before']:.2f} K; {first} {ranked[0]['kelvin_after']:.2f} expected,"
            f" {kelvin[first]:.2f} made; best {best} {kelvin[best]:.2f}; right {right} of {number + 1}",
            flush=True,
        )
    print(", ".join(f"{name} first {count} times" for name, count in firsts.most_common()))


if __name__ == "__main__":
    main()
