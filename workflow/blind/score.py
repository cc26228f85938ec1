"""Compares a diagnosis with the truth of its case."""

import numpy as np

from blind.consistent import contradictions

ALIKE = 15.0  # degrees: below, two causes are one class
WARM = 18.0  # [s] from which temperatures are judged
CONFIDENT = 0.8
RUN = 9  # successive temperatures whose mean error is a bias, not noise
NAMED = ("named", "one-of", "named+unknown")
UNKNOWN = ("unknown", "named+unknown")
NORMAL_95 = 1.96  # standard deviations
PROBABILITY_FLOOR = 1e-4


def score(made, report, temperature, angle):
    """One flat record of how a diagnosis did.

    Parameters
    ----------
    made : Made
    report : dict, the diagnosis
    temperature : Dataset with time_bin and paper_, base_, extended_temperature, these with _low and _high
    angle : callable(effect, effect) -> degrees between signatures, base parameters projected out
    """
    verdict = report["verdict"]
    named, status = list(verdict["named"]), verdict["status"]
    sets = [list(group) for group in verdict["set"]]
    true = [one["effect"] for one in made.effects]
    found = [_found(effect, named, sets, angle) for effect in true]
    top = named[0] if named else None
    # Every named term that is neither true nor like a true one is an extra.
    extra = [name for name in named if not any(_alike(name, effect, angle) for effect in true)]
    probability = verdict["probability"]
    key = _truth_key(made.case.kind, true)
    given = float(probability.get(key, 0.0))
    return {
        "status": status,
        "named": named,
        "set": sets,
        "top": top,
        "alarm": status in (*NAMED, "unknown"),
        "exact": [one["exact"] for one in found],
        "class": [one["class"] for one in found],
        "in_set": [one["in_set"] for one in found],
        "extra": extra,
        "unknown": status in UNKNOWN,
        "confident_wrong": any(probability.get(name, 0.0) > CONFIDENT for name in extra),
        "closest": _closest(report),
        "log_score": float(np.log(max(given, PROBABILITY_FLOOR))),
        "brier": float(
            sum((p - (name == key)) ** 2 for name, p in probability.items()) + (key not in probability)
        ),
        "uncalibrated": float(verdict["uncalibrated"]),
        "stated": float(max(probability.values())) if probability else None,
        "stated_right": bool(probability) and max(probability, key=probability.get) == key,
        "adequate": bool(report["base"]["adequate"]),
        "chi2_per_dof": report["base"]["chi2"] / max(report["base"]["dof"], 1),
        "temperature": judge_temperature(made, temperature),
        "power_held": _power_held(made, report["simulation"]),
        "discrepancy": report.get("discrepancy", {}).get("class"),
        "seen": verdict["unknown"],
        "basis": _basis(status, named, report),
        "contradictions": contradictions(report),
    }


def _truth_key(kind, true):
    if kind in ("null", "liar"):
        return "none"
    return true[0] if kind in ("single", "double", "sabotage", "puzzle") else "unknown"


def _alike(name, effect, angle):
    return name == effect or angle(name, effect) < ALIKE


def _found(effect, named, sets, angle):
    """Whether a true effect was named exactly, by class, and stands in an ambiguity set."""
    in_set = effect in named or any(effect in group for group in sets)
    return {
        "exact": effect in named,
        "class": any(_alike(name, effect, angle) for name in named) or in_set,
        "in_set": in_set,
    }


def _power_held(made, simulation):
    """Whether the power of the gas lies in its 95 % interval; None where nobody knows it."""
    true = getattr(made, "power", None)
    if true is None or not simulation.get("power_error"):
        return None
    return bool(abs(np.log(simulation["power"] / true)) < NORMAL_95 * simulation["power_error"])


def _basis(status, named, report):
    """Row of the table of stated probabilities: the status, or `gas` where the gas alone has names."""
    of_gas = {row["id"] for row in report["simulation"]["gains"]}
    return "gas" if named and set(named) <= of_gas else status


def _closest(report):
    plane = report["show"].get("line_hump")
    return plane["closest"] if plane else None


def judge_temperature(made, temperature):
    """Errors [K] of the paper's, the base and the extended temperature, and how often intervals hold."""
    time = np.asarray(temperature["time_bin"].values, dtype=float)
    off = getattr(made, "plasma_off", 300.0)
    judged = (time >= WARM) & ((time < off - 1) | (time > off + 2))
    truth = made.temperature(np.sort(time))[np.argsort(np.argsort(time))]
    judged &= truth >= getattr(made, "coldest", 0.0)
    record = {}
    for which in ("paper", "base", "extended"):
        error = (temperature[f"{which}_temperature"].values - truth)[judged]
        error = error[np.isfinite(error)]
        record[which] = {
            "rms": float(np.sqrt(np.mean(error**2))) if error.size else None,
            "worst": float(np.abs(error).max()) if error.size else None,
            "mean": float(error.mean()) if error.size else None,
            "bias": float(np.abs(np.convolve(error, np.full(RUN, 1 / RUN), "valid")).max())
            if error.size >= RUN
            else None,
        }
        if which == "paper":
            continue
        low, high = (temperature[f"{which}_temperature_{end}"].values for end in ("low", "high"))
        inside = ((low <= truth) & (truth <= high))[judged & np.isfinite(low)]
        record[which]["coverage"] = float(inside.mean()) if inside.size else None
        width = (high - low)[judged & np.isfinite(low)]
        record[which]["sigma"] = float(np.median(width) / (2 * NORMAL_95)) if width.size else None
    return record
