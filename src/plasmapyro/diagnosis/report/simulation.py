"""What the measured gas says about the simulation: systems, lines, effects, and sentences."""

import numpy as np

from plasmapyro.diagnosis.effects.effect import REGISTER
from plasmapyro.diagnosis.fit.setting import free_numbers
from plasmapyro.diagnosis.report.sentences import candidate_sentence, system_sentence
from plasmapyro.diagnosis.simulation.compare import FAR
from plasmapyro.diagnosis.simulation.fitter import LEVEL
from plasmapyro.diagnosis.simulation.systems import LEAST

NANOMETRE = 1e-9
WITH_SAMPLE = {True: ", since the injection", False: ", before the injection too", None: ""}


def simulation(findings):
    """Entry of the report: measured over simulated gas, what a wrong power would do, what remains."""
    found = findings.comparison
    systems = sorted(found.systems, key=lambda one: -abs(np.log(max(one.ratio, LEAST) / one.by_power)))
    rows = [
        {
            "name": one.name,
            "wavelength": list(one.wavelength),
            "ratio": one.ratio,
            "error": one.error,
            "stated": one.stated,
            "by_power": one.by_power,
            "beyond": one.beyond,
        }
        for one in systems
    ]
    lines = [
        {"wavelength": one.wavelength, "strength": one.strength, "error": one.error} for one in found.lines
    ]
    return {
        "p": found.p_value,
        "threshold": found.threshold,
        "power": float(np.exp(found.base.power)),
        "brightness": float(np.exp(found.base.brightness)),
        "power_error": float(np.sqrt(found.base.covariance[0, 0])),
        "systems": rows,
        "lines": lines,
        "gains": [
            {"id": identity, "gain_chi2": float(value)}
            for identity, value in sorted(found.gains.items(), key=lambda one: -one[1])
        ],
        "sentences": [*_sentences(found, systems), *foreign_sentences(findings.foreign)],
    }


def _sentences(found, systems):
    """What differs, in words: at most one sentence for each system that is off and each line."""
    if not found.systems and not found.gains:
        return ["There is no plasma: nothing to compare."]
    lines = [found.silence] if found.silence else []
    lines += power_sentences(found)
    lines += [system_sentence(one) for one in systems if one.beyond]
    whole = not lines and not found.final.settings
    if whole and found.p_value <= LEVEL:
        size = f", {np.exp(found.base.brightness):.2g} times as bright," if found.unlike else ""
        lines.append(
            f"The measured gas differs from the simulated one{size} as a whole (p = {found.p_value:.1g}), and"
            " no single radiating system does."
        )
    lines += [
        f"{'A line' if one.strength > 0 else 'Less light'} at {one.wavelength / NANOMETRE:.1f} nm that the"
        f" simulation lacks: {abs(one.strength):.2g} ± {one.error:.1g} of its mean light."
        for one in found.lines
    ]
    lines += slit_sentences(found)
    if whole and not lines:
        lines.append(
            "The measured gas agrees with the simulated one, within the errors that this one states."
        )
    return lines


def foreign_sentences(foreign):
    """Which species are in the gas and not in its simulation, in words."""
    return [
        f"{one['species']}, with probability {one['probability']:.2f}, is in the gas, not in the simulation:"
        f" lines at {', '.join(f'{place / NANOMETRE:.1f}' for place in one['lines'])} nm in air"
        f"{WITH_SAMPLE[one['with_sample']]}."
        for one in foreign
    ]


def slit_sentences(found):
    """What lines of atoms say against the stated slit, in words; a list of one sentence or none."""
    seen = found.slit
    if seen is None or abs(seen.extra) < FAR * seen.error:
        return []
    return [
        f"{seen.lines} lines of atoms are {seen.ratio:.3g} ± {seen.ratio_error:.1g} times as wide as the"
        " stated slit makes them."
    ]


def power_sentences(found):
    """What is wrong with the simulated power, in words; a list of one sentence or none."""
    if not found.power_is_wrong:
        return []
    change, error = found.power
    size, rivals = np.expm1(change), [REGISTER[identity]["name"] for identity in found.rivals_of_power]
    also = f" Alike at the simulated power: {'; '.join(rivals)}." if rivals else ""
    return [
        f"The gas shines as one of {abs(size):.1%} {'more' if size > 0 else 'less'} power than simulated"
        f" (± {error * (1 + size):.1%}); a simulation of that power is proposed.{also}"
    ]


def entries_of(findings):
    """Entries, as those of `candidates`, of the effects that the gas asks of the simulation."""
    found, rank = findings.comparison, len(findings.final.settings)
    numbers = free_numbers(found.final.settings)
    for place, setting in enumerate(found.final.settings):
        effect = setting.effect
        (row,) = (j for j, one in enumerate(numbers) if one.place == place and one.name is None)
        error = float(np.sqrt(found.final.covariance[2 + row, 2 + row]))
        shape = {name: float(value) for name, value in setting.shape.items()}
        paper, when = findings.paper_shift(effect, setting.amplitude, shape)
        entry = {
            "id": effect.id,
            "name": effect.name,
            "class": effect.klass,
            "stage": effect.stage,
            "rank": rank + place + 1,
            "amplitude": float(setting.amplitude),
            "standard_error": error,
            "interval95": [setting.amplitude - 1.96 * error, setting.amplitude + 1.96 * error],
            "unit": effect.unit,
            "amplitude_name": effect.amplitude,
            "shape": shape,
            "gain_chi2": float(found.gains[effect.id]),
            "log_evidence": 0.5 * float(found.gains[effect.id]),
            "probability": float(findings.probability[0].get(effect.id, 0.0)),
            "significance": float(abs(setting.amplitude) / error),
            "angle_to_next": None,
            "next": next(iter(found.rivals[effect.id]), None),
            "temperature_shift": {"paper": paper, "base": 0.0, "at_time": when},
            "phases": list(effect.phases),
            "instruments": list(effect.instruments),
            "sentence": "",
        }
        yield entry | {"sentence": candidate_sentence(entry)}
