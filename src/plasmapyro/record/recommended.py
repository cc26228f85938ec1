"""The one temperature of a test to take away: the rule that chooses among estimates, and the series."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.record import budget, status
from plasmapyro.record.level import EFFECTIVE

# Rules of `quality` that say: instruments, or one and its calibration, contradict each other.
CONTRADICTIONS = (
    "instruments_disagree",
    "clocks_apart",
    "ratio_outside_calibration",
    "level_against_ratio",
    "emittance_of_spectra",
    "emittance_jumps",
    "shape_of_spectra",
    "swapped_bands",
    "two_clocks",
)
BEST_FIRST = ("extended", "base", "emissivity", "joint", "subtraction", "spectra")
WORDS = {
    "extended": "the diagnosis with the causes that it named",
    "base": "the base model of the diagnosis",
    "joint": "the joint estimate",
    "emissivity": "the estimate of temperature and emissivity",
    "subtraction": "the paper's subtraction of the reference",
    "spectra": "the Planck fits to the corrected spectra",
}
SINGULAR = [[words] for one, words in WORDS.items() if one != "spectra"]  # lists of one that stand alone
NONE = "No temperature is recommended"
SERIES = {  # estimate: its temperature and its status in a file of a correction
    "joint": ("surface_temperature", "estimate_status"),
    "emissivity": ("spectral_temperature", "spectral_status"),
    "subtraction": ("corrected_temperature", "corrected_status"),
    "spectra": ("scaled_temperature", "spectrum_status"),
}
OF_ESTIMATE = {"contradictions", "degenerate", "strained"}  # attributes that the recommended series has not


class Facts(NamedTuple):
    """What the choice depends on.

    `given`: estimates with a value; `against`: sentences of instruments that contradict each other;
    `missing`: {estimate: why it has none}; of a diagnosis its `verdict`, whether the extension is `applied`,
    and names of `strained` numbers of a calibration, which the fit moved out of what was known (of the joint
    estimate: a sentence);
    `instruments` that are compared, and whether they contradict each other `partly`, for some time.
    """

    given: tuple
    against: tuple = ()
    missing: dict = {}
    verdict: str = ""
    applied: bool = False
    strained: tuple = ()
    instruments: tuple = ()
    partly: bool = False


class Choice(NamedTuple):
    """The estimate to take, None for no recommendation, and one sentence why."""

    estimate: str | None
    why: str


def recommended(facts):
    """The `Choice` of the temperature to take away, by one rule for all commands.

    1. Instruments that contradict each other, and no confirmed cause: none. Level and ratio of a single
       instrument are two numbers: held-out data of the same two confirm any cause that moves either.
    2. A diagnosis that follows the data: its extension if held-out data confirm it, else its base model. If
       the fit moved a calibration out of what was known of it and nothing confirmed says why, the paper's
       method, which needs no absolute level.
    3. Else temperature and emissivity from a radiometer or spectra alone; the joint estimate, which uses all
       light; the paper's subtraction; Planck fits.
    """
    given = [one for one in BEST_FIRST if one in facts.given]
    confirmed = facts.applied and "extended" in given and len(facts.instruments) != 1
    if facts.against and not confirmed:
        return Choice(None, f"No temperature is recommended: {facts.against[0]}.")
    if not given:
        return Choice(
            None, "No temperature is recommended: no estimate has one, see the status of each sample."
        )
    others = _beside(given)
    if facts.verdict:
        return _of_diagnosis(facts, given)
    best = given[0]
    why = {
        "joint": f"it uses all light of {listed(facts.instruments)}"
        + (", which agree" if len(facts.instruments) > 1 else " and no second instrument contradicts it")
        + (f", though {facts.strained[0]}, which its interval holds" if facts.strained else "")
        + (" but where the status is contradicted" if facts.partly else ""),
        "emissivity": "it lets the emissivity depend on wavelength and time",
        "subtraction": "no joint estimate stands beside it",
        "spectra": "there are spectra alone behind a plasma, and the surface is taken as grey",
    }[best]
    for one in BEST_FIRST[: BEST_FIRST.index(best)]:
        if one in facts.missing:
            why += f"; {WORDS[one]} is not to be had: {facts.missing[one]}"
    return Choice(best, f"Recommended: {WORDS[best]}, because {why}{others(best)}.")


def _of_diagnosis(facts, given):
    others, paper = _beside(given), "subtraction" in given
    if facts.verdict == "not-adequate":
        best, why = "subtraction", "the base model of the diagnosis does not follow the data"
    elif facts.applied:
        best, why = "extended", "data that the fit has not seen confirm them"
    elif facts.strained and paper:
        best = "subtraction"
        why = (
            f"the fit moved the {facts.strained[0]} out of what is known of it and nothing confirmed says why"
        )
    else:
        best = "base"
        why = {
            "null": "it explains the data",
            "unknown": "what is wrong has no name; what it may cost is in the interval",
        }.get(facts.verdict, "held-out data do not confirm what was named; its cost is in the interval")
    if best not in given:
        return Choice(None, f"{NONE}: {why}, and there is none by {WORDS[best]}.")
    if best == "extended" and facts.verdict == "named+unknown":
        why += "; what remains without a name is in the interval"
    return Choice(best, f"Recommended: {WORDS[best]}, because {why}{others(best)}.")


def _beside(given):
    def words(best):
        rest = [WORDS[one] for one in given if one != best and (best, one) != ("extended", "base")]
        return f"; {listed(rest)} {'stands' if rest in SINGULAR else 'stand'} beside it" if rest else ""

    return words


def listed(words):
    """Words as a list in a sentence: a, b and c."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words) or "the instrument"


def series(time, temperature, state, inputs, half_width=None, axis="time"):
    """The recommended series over `axis` ('time' or 'time_bin') as a dataset, contract 'temperature'.

    NaN where the status is one without a value; attributes are not set. `half_width` (t,) [K] of the 95 %
    interval is that of a normal law by default; `inputs`: of `budget.Input`.
    """
    known = np.isin(state, status.WITH_VALUE) & np.isfinite(temperature)
    blank = np.where(known, 1.0, np.nan)
    inputs = [one._replace(contribution=one.contribution * blank) for one in inputs]
    deviation = budget.combined(inputs)
    half = budget.NORMAL_95 * deviation if half_width is None else half_width
    middle = temperature * blank
    return xr.Dataset(
        {
            "recommended_temperature": (axis, middle),
            "recommended_temperature_uncertainty": (axis, deviation),
            "recommended_temperature_interval": (("bound", axis), np.stack([middle - half, middle + half])),
            "recommended_status": (axis, state.astype("int8"), status.flags()),
            **budget.variables(inputs, axis),
        },
        {axis: time},
    )


def of_correction(parts, found=(), missing=None):
    """The recommended series (contract 'temperature') of a correction, from the results of the estimators.

    `parts`: of any of the contracts 'pyrometer_correction', 'spectrometer_correction', 'correction',
    'joint_estimate', 'emissivity_estimate'; `found`: entries of `quality.rule.Finding`; `missing`: see
    `Facts`.
    """
    holding = {one: part for one, (name, _) in SERIES.items() for part in parts if name in part.variables}
    given = tuple(one for one, part in holding.items() if np.isfinite(part[SERIES[one][0]].values).any())
    against = tuple(entry["saw"] for entry in found if entry["rule"] in CONTRADICTIONS)
    # A radiometer's joint estimate holds the emissivity constant, which the other one does not.
    alone = "joint" in holding and "emissivity" not in holding
    if alone and "joint" not in given and holding["joint"].attrs.get("contradictions"):
        against += (holding["joint"].attrs["contradictions"],)
    instruments = [
        name
        for name, kind in (("pyrometer", "corrected_temperature"), ("spectrometer", "scaled_temperature"))
        if any(kind in part.variables for part in parts)
    ]
    partly = "joint" in given and bool(holding["joint"].attrs.get("contradictions"))
    if "joint" in given:
        instruments = holding["joint"].attrs["instruments"].split()
    strained = holding["joint"].attrs.get("strained") if "joint" in given else ""
    facts = {"instruments": tuple(instruments), "partly": partly, "strained": (strained,) if strained else ()}
    choice = recommended(Facts(given, against, missing or {}, **facts))
    best = choice.estimate or next(one for one in BEST_FIRST if one in holding)
    part, (name, state) = holding[best], SERIES[best]
    (axis,) = part[name].dims
    states = part[state].values.copy()
    if choice.estimate is None and against:
        states[np.isfinite(part[name].values)] = status.CONTRADICTED
    inputs = [*_inputs(part, name), *_of_spot(part.attrs.get("temperature_spread", 0.0), part[name].values)]
    result = series(part[axis].values, part[name].values, states, inputs)
    kept = {key: value for key, value in part.attrs.items() if key not in OF_ESTIMATE}
    return result.assign_attrs(kept | attributes(choice))


def attributes(choice):
    """Attributes of a file with a recommended series."""
    return {"recommended": choice.estimate or "none", "recommended_because": choice.why}


def _of_spot(spread, kelvin):
    r"""Input of a surface whose temperature differs over the spot; none where nothing is stated.

    .. math:: u = \frac{s^2}{2}\left(\frac{c_2}{\lambda} - 2T\right)

    is by how much the level of its light reads more than the mean temperature (t,) [K]; the ratio of two
    bands reads twice as much more, which lies within 95 %. s, `spread` [1]: relative standard deviation of
    the temperature over the spot; :math:`\lambda`: `level.EFFECTIVE`; second order of Wien's law in s.
    """
    if not spread:
        return []
    excess = np.maximum(spread**2 / 2 * (SECOND_RADIATION / EFFECTIVE - 2 * kelvin), 0.0)
    return [budget.Input("temperature that differs over the spot", "unnamed misfit", excess, spread, "1")]


def _inputs(part, name):
    """The budget of a temperature; one row for all where its uncertainty is known as a whole alone."""
    if name != "scaled_temperature":
        return budget.inputs_of(part)
    whole = part[f"{name}_uncertainty"].values
    return [budget.Input("noise, calibration and gas together (Monte Carlo)", "noise", whole)]
