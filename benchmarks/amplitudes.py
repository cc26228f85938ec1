"""Do stated amplitudes of effects hold, given their names? Simulation-based calibration: ranks and ECDF.

    python benchmarks/amplitudes.py [--results results] [--cases 60] [--seed 1]

Each case is a test of the first laboratory (`workflow/twin`) at 160 kW with one hidden effect, its amplitude
drawn from the prior of the catalogue; ratio, scale, windows and emittance err as a laboratory states, gains
wander as the diagnosis assumes. The base model is fitted, then with the effect from zero. Effects whose
formulas are the same in both, and that the base model does not hold itself.
"""

from dataclasses import replace

import numpy as np
from first_laboratory import asked  # which finds the workflow

# isort: split
from blind.ranks import ranks
from twin import campaign, hidden, runs

from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit.setting import Setting, numbers_of
from plasmapyro.diagnosis.fit.whole import fit_test

EFFECTS = "winD", "winE", "eps_T", "nonlin_p", "nonlin_s", "clock"
PLAN = {"tests": [{"date": "2026-03-02", "electric_power_kw": 160, "material": "C/SiC"}]}
WANDER = {"pyrometer": 2e-3, "ratio": 1e-3, "spectrometer": 3e-3}  # standard deviations, `fit.persistent`
MEMORY = 0.25  # of the record
STEADY = {"pyrometer": 0.0, "spectrometer": 0.0}  # windows that foul are effects of their own


def wandering(scene, random):
    """The scene with gains that wander (Ornstein-Uhlenbeck) and a gas that only flickers."""
    knots = np.linspace(scene.start, scene.end, 60)
    apart = np.abs(np.subtract.outer(knots, knots)) / (MEMORY * (scene.end - scene.start))
    root = np.linalg.cholesky(np.exp(-apart) + 1e-12 * np.eye(knots.size))
    path = {name: sigma * (root @ random.normal(size=knots.size)) for name, sigma in WANDER.items()}
    before, rates = scene.pyrometer_output, scene.spectrometer_output

    def signals(clean, time):
        both, ratio = (np.interp(time, knots, path[name]) for name in ("pyrometer", "ratio"))
        return before(clean, time) * np.exp([both + ratio / 2, both - ratio / 2])

    def counts(clean, time):
        return rates(clean, time) * np.exp(np.interp(time, knots, path["spectrometer"]))[:, None]

    steady = replace(scene.plasma, drift=0.0, swing=0.0)  # a gas that drifts is an effect of its own
    return replace(scene, pyrometer_output=signals, spectrometer_output=counts, plasma=steady)


def case(identity, inputs, gas, seed):
    """(effect, true amplitude, its estimate, standard error) of a drawn test."""
    effect, known = CATALOGUE[identity], hidden.CATALOGUE[identity]
    random = np.random.default_rng([seed, 73])
    amplitude = effect.sigma * random.normal()
    if known.low == 0.0:
        amplitude = abs(amplitude)
    amplitude = float(np.clip(amplitude, known.low, known.high))
    true = runs.truth(PLAN, seed)[0] | {"loss": STEADY}
    scene = hidden.hide(wandering(runs.scene(PLAN["tests"][0], true), random), identity, amplitude, None)
    test, _ = campaign.record(scene, inputs.response, [(1.0, runs.gas(gas, true["power"]))], seed)
    instrument = inputs.response, inputs.calibration, inputs.spectrometer_calibration
    varied = inputs.variations[scene.condition]
    with np.errstate(all="ignore"):
        base = fit_test(test, inputs.radiation, varied, *instrument, saturation_counts=65000.0)
        settings = (Setting(effect, 0.0),)
        start = replace(base.solution.state, amplitudes=numbers_of(settings))
        found = base.fitter.fit(start, settings)
    place = base.model.size + len(base.model.parameters)
    return identity, amplitude, found.settings[0].amplitude, float(np.sqrt(found.covariance[place, place]))


def main():
    """Print each case, then the ranks of all."""
    options, inputs, gas = asked(__doc__)
    rows = []
    for number in range(options.cases):
        rows.append(case(EFFECTS[number % len(EFFECTS)], inputs, gas, 1000 * options.seed + number))
        identity, true, found, error = rows[-1]
        off = (found - true) / error
        print(f"{number:3d} {identity:9s} {true:+.4f}: {found:+.4f} +- {error:.4f}, {off:+.1f}", flush=True)
    for name, value in ranks(rows).items():
        if name != "ecdf":
            print(f"{name}: {value}")


if __name__ == "__main__":
    main()
