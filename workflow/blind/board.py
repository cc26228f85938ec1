"""The scoreboard: rates with their confidence intervals, against the bars."""

from collections import Counter, defaultdict
from operator import itemgetter

import numpy as np
from scipy.stats import beta

from blind import reasons

LEVEL = 0.95
GAS = {"P_eff", "T_exc", "T_vib", "ripple", "selfabs", "contin", "bl", "gas_drift", "refl"}
BIASED = 10.0  # [K] from which a temperature counts as wrong
MIX = {  # cases of a full set, by kind and SNR; of two effects either would be right
    ("null", None): 400,
    **{("single", snr): 120 for snr in (2.0, 3.0, 5.0)},
    **{("single", snr): 168 for snr in (8.0, 12.0, 20.0, 35.0, 50.0)},
    ("outside", None): 200,
}
BINS = 10  # of stated probabilities
RESAMPLED = 1000  # draws behind the intervals of medians and means


def clopper_pearson(hits, trials):
    """Exact confidence interval of a proportion; (0, 1) without trials."""
    if trials == 0:
        return 0.0, 1.0
    tail = (1 - LEVEL) / 2
    low = beta.ppf(tail, hits, trials - hits + 1) if hits else 0.0
    high = beta.ppf(1 - tail, hits + 1, trials - hits) if hits < trials else 1.0
    return float(low), float(high)


def rate(values):
    """{hits, trials, rate, low, high} of truth values."""
    values = [bool(value) for value in values]
    low, high = clopper_pearson(sum(values), len(values))
    share = sum(values) / len(values) if values else None
    return {"hits": sum(values), "trials": len(values), "rate": share, "low": low, "high": high}


def statistic(values, function):
    """{value, low, high, trials} of a function of the rows of `values`, interval by resampling them."""
    values = np.array([value for value in values if value is not None], dtype=float)
    if not len(values):
        return {"value": None, "low": None, "high": None, "trials": 0}
    random = np.random.default_rng(1)
    drawn = [function(values[random.integers(len(values), size=len(values))]) for _ in range(RESAMPLED)]
    low, high = np.quantile(drawn, [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return {"value": float(function(values)), "low": float(low), "high": float(high), "trials": len(values)}


def summary(records, apart=True):
    """All scores of a set of finished cases (dicts of case, kind, effects, score, cost).

    `apart`: by world and by simulation as well, where there are several.
    """
    done = [one | one["score"] for one in records if one["outcome"] == "scored"]
    kinds = defaultdict(list)
    for one in done:
        kinds[one["kind"]].append(one)
    single = kinds["single"]
    board = {
        "cases": dict(Counter(one["kind"] for one in done)),
        "skipped": dict(Counter(one["kind"] for one in records if one["outcome"] == "beyond range")),
        "failed": dict(Counter(one["kind"] for one in records if one["outcome"] == "failed")),
        "false_alarms": rate(one["alarm"] for one in kinds["null"]),
        "not_adequate_nulls": rate(one["status"] == "not-adequate" for one in kinds["null"]),
        "false_alarms_wrong_noise": rate(one["alarm"] for one in kinds["liar"]),
        "false_alarms_by_noise": _rates(kinds["liar"], itemgetter("noise"), itemgetter("alarm")),
        "ladder": {f"{snr:g}": _naming(group) for snr, group in sorted(_grouped(single, _snr).items())},
        "at_least_8": _naming(_from(8, single)),
        "at_least_20": _naming(_from(20, single)),
        "double": {
            "both_classes": rate(map(_of_class, kinds["double"])),
            "both_exact": rate(all(one["exact"]) for one in kinds["double"]),
            "spurious": rate(one["extra"] for one in kinds["double"]),
        },
        "outside": {
            "unknown": rate(one["unknown"] for one in kinds["outside"]),
            "confident_wrong": rate(one["confident_wrong"] for one in kinds["outside"]),
            "by_effect": _rates(kinds["outside"], _first, itemgetter("unknown")),
        },
        "without": {
            "unknown_or_sibling": rate(map(_sibling, kinds["without"])),
            "confident_wrong": rate(one["confident_wrong"] for one in kinds["without"]),
        },
        "sabotage": {"still_exact": rate(any(one["exact"]) for one in kinds["sabotage"])},
        "puzzle": {
            "right": rate(map(_solved, kinds["puzzle"])),
            "by_explanation": _rates(kinds["puzzle"], _first, _solved),
        },
        "temperature": _temperature(done),
        "calibration_error": statistic(stated(done), calibration_error),
        "reliability": reliability(done),
        "mean_log_score": _mean(one["log_score"] for one in done),
        "mean_brier": _mean(one["brier"] for one in done),
        "cost": _cost(done),
        "by_effect": {
            effect: _naming(_from(8, group)) for effect, group in sorted(_grouped(single, _first).items())
        },
        "confusion": _confusion(single),
    }
    board["bars"] = _bars(board, kinds, done)
    told = [one for one in records if "simulation" in one]
    for name, groups in (
        ("worlds", _grouped(records, lambda one: one.get("world", "first"))),
        ("simulations", _grouped(told, itemgetter("simulation"))),
    ):
        if apart and len(groups) > 1:
            board[name] = {key: summary(group, apart=False) for key, group in sorted(groups.items())}
    return board


def _beyond_gas(one):
    """Whether a name of surface, path, instrument or clock was given."""
    return bool(set(one["named"]) - GAS)


def _placed(one):
    """Whether a fault that no name fits is called unknown, with the right instrument and axis."""
    instrument, axis = one["effects"][0]["truth"]
    seen = one["seen"] or {"instrument": "", "axis": ""}
    right = instrument == "ps" or seen["instrument"] == {"p": "pyrometer", "s": "spectrometer"}[instrument]
    return one["unknown"] and right and axis in seen["axis"]


def _grouped(records, key):
    groups = defaultdict(list)
    for one in records:
        groups[key(one)].append(one)
    return groups


def _rates(records, key, good):
    """Rate of good ones by a key of the records."""
    return {name: rate(map(good, group)) for name, group in _grouped(records, key).items()}


def _first(one):
    return one["effects"][0]["effect"]


def _snr(one):
    return one["effects"][0]["snr"]


def _from(least, records):
    return [one for one in records if _snr(one) >= least]


def _of_class(one):
    return all(one["class"])


def _exact(one):
    return one["top"] == _first(one)


def _sibling(one):
    return one["unknown"] or any(one["class"])


def _of_known(function):
    """A function of the values that are not None; None without any."""

    def found(values):
        values = [value for value in values if value is not None]
        return float(function(values)) if values else None

    return found


_mean, _median = _of_known(np.mean), _of_known(np.median)


def _naming(group):
    return {
        "detected": rate(one["alarm"] for one in group),
        "class": rate(one["class"][0] for one in group),
        "exact": rate(map(_exact, group)),
        "in_set": rate(one["in_set"][0] for one in group),
        "extra": rate(one["extra"] for one in group),
        "set_size": _median(max((len(part) for part in one["set"]), default=0) for one in group),
    }


SAME = ({"ripple", "P_eff"},)  # explanations that count as one


def _solved(one):
    truth, answers = _first(one), {one["closest"], *one["named"]}
    return any(truth == answer or {truth, answer} in SAME for answer in answers)


def _temperature(done):
    rows = [one["temperature"] for one in done if one["kind"] in ("null", "single", "double")]
    named = [one for one in done if one["kind"] in ("single", "double") and one["named"]]
    known = [one for one in named if _of_class(one)]
    strong = [one["temperature"] for one in _from(8, [one for one in done if one["kind"] == "single"])]
    return {
        "coverage_extended_named": statistic(
            (one["temperature"]["extended"]["coverage"] for one in known), np.mean
        ),
        "coverage_base_all": _mean(row["base"]["coverage"] for row in rows),
        "coverage_extended_all": _mean(row["extended"]["coverage"] for row in rows),
        "rms": {name: _median(row[name]["rms"] for row in rows) for name in ("paper", "base", "extended")},
        "rms_named": {
            name: _median(one["temperature"][name]["rms"] for one in known)
            for name in ("paper", "base", "extended")
        },
        "reduction_where_biased": statistic(_ratios(strong, "base"), np.median),
        "reduction_of_paper_where_biased": statistic(_ratios(strong, "paper"), np.median),
        "worse_than_base": rate(_worse(row) for row in rows if row["extended"]["rms"] is not None),
    }


def _worse(row):
    """Whether the extended temperature errs more than the base one by a standard deviation."""
    if row["base"]["rms"] is None:  # no time of the test is judged
        return False
    return row["extended"]["rms"] > row["base"]["rms"] + row["base"]["sigma"]


def _ratios(rows, which):
    """Error of one temperature over that of the extended one, where the former has a bias."""
    return [
        row[which]["rms"] / row["extended"]["rms"]
        for row in rows
        if (row[which]["bias"] or 0) >= BIASED and row["extended"]["rms"]
    ]


def rung(one):
    """Place of a case in the mix."""
    return one["kind"], one["effects"][0]["snr"] if one["kind"] == "single" else None


def weights(cases):
    """How often each of some cases stands in a full set, over how often in these."""
    number = Counter(map(rung, cases))
    return [MIX[rung(one)] / number[rung(one)] for one in cases]


def _places(probability):
    return np.minimum((probability * BINS).astype(int), BINS - 1)


def calibration_error(rows):
    """Expected calibration error of rows (stated probability, right or not, weight) (n, 3)."""
    stated, right, weight = rows.T
    place, excess = _places(stated), weight * (stated - right)
    return sum(abs(excess[place == one].sum()) for one in range(BINS)) / weight.sum()


def stated(done):
    """Probabilities of the most probable answers, whether these are right, and the weights of the cases."""
    used = [one for one in done if one["stated"] is not None and rung(one) in MIX]
    return [
        (one["stated"], one["stated_right"], weight) for one, weight in zip(used, weights(used), strict=True)
    ]


def reliability(done):
    """How often answers of about one stated probability are right: rows (stated, right, number)."""
    rows = np.array(stated(done), dtype=float).reshape(-1, 3)
    place = _places(rows[:, 0])
    groups = [rows[place == one] for one in range(BINS)]
    return [
        [*map(float, np.average(group[:, :2], axis=0, weights=group[:, 2])), len(group)]
        for group in groups
        if len(group)
    ]


def _cost(done):
    wall = [one["cost"]["wall"] for one in done]
    processor = [one["cost"]["processor"] for one in done]
    if not wall:
        return None
    return {
        "wall_median": float(np.median(wall)),
        "wall_worst": max(wall),
        "processor_median": float(np.median(processor)),
        "processor_worst": max(processor),
    }


def _confusion(single):
    table = defaultdict(Counter)
    for one in _from(8, single):
        answer = one["top"] or {"null": "none"}.get(one["status"], one["status"])
        table[_first(one)][answer] += 1
    return {truth: dict(row) for truth, row in sorted(table.items())}


def _bars(board, kinds, done):
    """Each bar with its value, interval, whether it holds, and why not as far as the cases tell."""
    temperature, naming = board["temperature"], board["at_least_8"]
    doubles, outside = board["double"], board["outside"]
    at8, at20 = (_from(least, kinds["single"]) for least in (8, 20))
    known = [one for one in kinds["single"] + kinds["double"] if one["named"] and all(one["class"])]

    def quiet(one):
        return not one["alarm"]

    def better(one):
        return not _worse(one["temperature"])

    cost = board["cost"] or {}
    nulls, placed = kinds["null"], [one for one in kinds["outside"] if one["effects"][0].get("truth")]
    at12, strong = _naming(_from(12, kinds["single"])), _from(15, kinds["double"])
    held = statistic((one["temperature"]["extended"]["coverage"] for one in done), np.mean)
    power = [one["power_held"] for one in done if one.get("power_held") is not None]
    alone = {"low": None, "high": None, "trials": len(done)}
    median, worst, slowest = (
        alone | {"value": cost.get(name)} for name in ("processor_median", "processor_worst", "wall_worst")
    )
    rows = [
        ("nothing hidden: a name of surface, path, instrument or clock", rate(map(_beyond_gas, nulls)),
         "<=", 0.03, reasons.extras(nulls)),
        ("nothing hidden: a confident name of the gas",
         rate(one["confident_wrong"] for one in nulls), "<=", 0.05, reasons.extras(nulls)),
        ("one effect, SNR >= 12: exact", at12["exact"], ">=", 0.85, None),
        ("one effect, SNR >= 12: class", at12["class"], ">=", 0.93, None),
        ("two effects, SNR >= 15: both classes", rate(map(_of_class, strong)),
         ">=", 0.85, None),
        ("outside the catalogue, SNR >= 15: unknown, with instrument and axis",
         rate(map(_placed, _from(15, placed))), ">=", 0.85, None),
        ("95 % interval of the temperature, all cases", held, ">=", 0.92, None),
        ("95 % interval, all cases, from above", held, "<=", 0.98, None),
        ("95 % interval of the power of the gas", rate(power), ">=", 0.92, None),
        ("diagnoses that contradict themselves",
         rate(one.get("contradictions") for one in done), "<=", 0.0, None),
        ("processor time, median [s]", median, "<=", 60.0, None),
        ("processor time, worst [s]", worst, "<=", 300.0, None),
        ("false alarms, right noise", board["false_alarms"], "<=", 0.05,
         reasons.misses(kinds["null"], quiet)),
        ("false alarms, wrong noise", board["false_alarms_wrong_noise"], "<=", 0.08,
         reasons.misses(kinds["liar"], quiet)),
        ("class named, SNR >= 8", naming["class"], ">=", 0.90, reasons.misses(at8, _of_class)),
        ("exact name, SNR >= 8", naming["exact"], ">=", 0.80, reasons.misses(at8, _exact)),
        ("class named, SNR >= 20", board["at_least_20"]["class"], ">=", 0.97,
         reasons.misses(at20, _of_class)),
        ("exact name, SNR >= 20", board["at_least_20"]["exact"], ">=", 0.92, reasons.misses(at20, _exact)),
        ("two effects, SNR >= 12: both classes", doubles["both_classes"], ">=", 0.90,
         reasons.misses(kinds["double"], _of_class)),
        ("two effects, SNR >= 12: spurious third", doubles["spurious"], "<=", 0.08,
         reasons.extras(kinds["double"])),
        ("outside the catalogue, SNR >= 12: unknown", outside["unknown"], ">=", 0.90,
         reasons.misses(kinds["outside"], itemgetter("unknown"))),
        ("outside the catalogue: confident wrong name", outside["confident_wrong"], "<=", 0.03,
         reasons.extras(kinds["outside"])),
        ("left out of the catalogue, SNR 20: unknown or sibling", board["without"]["unknown_or_sibling"],
         ">=", 0.85, reasons.misses(kinds["without"], _sibling)),
        ("sabotaged formula: still named exactly", board["sabotage"]["still_exact"], "<=", 0.50, None),
        ("95 % temperature interval, named and extended", temperature["coverage_extended_named"], ">=", 0.92,
         reasons.uncovered(known)),
        ("the same, from above", temperature["coverage_extended_named"], "<=", 0.98, None),
        ("error of the base fit over that of the extended one, base bias >= 10 K, SNR >= 8",
         temperature["reduction_where_biased"], ">=", 3.0, reasons.hot(at8, BIASED)),
        ("error of the paper's correction over that of the extended fit, its bias >= 10 K, SNR >= 8",
         temperature["reduction_of_paper_where_biased"], ">=", 3.0, reasons.hot(at8, BIASED)),
        ("extended worse than base by a sigma", temperature["worse_than_base"], "<=", 0.05,
         reasons.misses(kinds["single"] + kinds["double"] + kinds["null"], better)),
        ("six explanations of 60 against 85 kW", board["puzzle"]["right"], ">=", 0.90,
         reasons.misses(kinds["puzzle"], _solved)),
        ("calibration error of stated probabilities", board["calibration_error"], "<=", 0.05,
         _worst_bin(board["reliability"])),
        ("screening and refits together, one core, worst by the clock [s]", slowest, "<=", 60.0, None),
    ]  # fmt: skip
    return [_bar(*row) for row in rows]


def _bar(name, entry, sign, bar, why):
    value = entry["rate"] if "rate" in entry else entry["value"]
    held = None if value is None else bool(value <= bar if sign == "<=" else value >= bar)
    return {
        "bar": name,
        "value": value,
        "low": entry["low"] if entry["trials"] else None,
        "high": entry["high"] if entry["trials"] else None,
        "cases": entry["trials"],
        "rule": f"{sign} {bar:g}",
        "held": held,
        "why": why if held is False else None,
    }


def _worst_bin(rows):
    """Sentence about the stated probabilities that err most."""
    if not rows:
        return None
    said, right, number = max(rows, key=lambda row: abs(row[0] - row[1]) * row[2])
    return f"Of {number} answers stated as {said:.2f} on average {right:.2f} are right."
