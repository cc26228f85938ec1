"""Stage: diagnoses of a campaign in; its laws, what does not belong, and the prior of the next test out."""

from dataclasses import dataclass, replace
from datetime import date

import numpy as np

from plasmapyro.campaign.hierarchy import SCATTERS, Campaign, Joint, Test, group_of
from plasmapyro.diagnosis.fit.prior import Normal

HOT = 1000.0  # [K] from which temperatures are compared
NEXT = "next"
WORDS = {
    "ratio": "sensitivity ratio (relative)",
    "lamp": "temperature of the calibration source, K",
    "edge_wide": "edges of the wide band, nm",
    "edge_narrow": "edges of the narrow band, nm",
    "tail": "long-wave tail of the responses (relative)",
}
SHOWN = ("power", "gain_pyrometer", "gain_spectrometer", "emittance", "ratio")


@dataclass(frozen=True)
class Row:
    """One test in the campaign.

    `pulls` {number: how far its data move what all others say, in standard deviations}; `odd` groups that do
    not belong; `sigma` (3,) [K] of its temperature where it is hot: alone, with the tests before it, with
    all; `shift` [K] by all; `prior` law before its data, from the tests before it.
    """

    test: Test
    pulls: dict
    odd: tuple
    sigma: tuple
    shift: float
    prior: Normal | None


@dataclass(frozen=True)
class Found:
    """What a campaign finds: the joint law, its tests, and the law of the next one."""

    joint: Joint
    rows: tuple
    next: Normal
    coming: Test
    reference_power: float


def tests_of(plan, reports):
    """Tests of a plan (by `campaign.schema.yaml`) in the order of their dates, the coming one last.

    `reports`: name -> `diagnosis.json`. ValueError: dates that do not rise, names twice, a report without a
    posterior, all diagnosed with priors.
    """
    entries = [*plan["tests"], plan.get("next", {}) | {"name": NEXT}]
    last = entries[-2]
    entries[-1] = {key: last[key] for key in ("date", "electric_power_kw", "material")} | entries[-1]
    names = [one["name"] for one in entries]
    faults = [f"tests: '{name}' is listed twice" for name in dict.fromkeys(names) if names.count(name) > 1]
    days, cleanings, wrong = _days([one["date"] for one in entries], plan.get("cleanings", []))
    faults += wrong or [
        f"tests: {entry['name']} of {entry['date']} stands after a later one"
        for entry, day, later in zip(entries[1:], days[1:], days, strict=False)
        if day < later
    ]
    faults += [
        f"{one['diagnosis']}: holds no posterior; diagnose this test with this version"
        for one in plan["tests"]
        if "posterior" not in reports[one["name"]]
    ]
    faults += _spellings([one["material"] for one in entries])
    faults = faults or [*_same(plan, reports), *_other_calibrations(plan, reports)]
    if faults:
        raise ValueError("\n  ".join(faults))
    found = [
        Test(
            name=entry["name"],
            run=run,
            cleanings=sum(one <= day for one in cleanings),
            electric_power=1e3 * entry["electric_power_kw"],
            material=entry["material"],
            **(_laws(reports[entry["name"]]["posterior"]) if entry["name"] != NEXT else {}),
        )
        for run, (entry, day) in enumerate(zip(entries, days, strict=True))
    ]
    if not any(one.own_prior for one in found[:-1]):
        raise ValueError("tests: one of them at least must be diagnosed without --priors")
    return found


def _days(dates, cleanings):
    """Days of tests and of cleanings, and faults: of days that no calendar has."""
    faults = []

    def day(text):
        try:
            return date.fromisoformat(text)
        except ValueError as reason:
            faults.append(f"{text}: {reason}")

    return [day(one) for one in dates], [day(one) for one in cleanings], list(dict.fromkeys(faults))


def _spellings(materials):
    """Faults: materials that differ by capitals and signs alone, which would count as two."""
    known = {}
    for one in dict.fromkeys(materials):
        first = known.setdefault("".join(sign for sign in one.lower() if sign.isalnum()), one)
        if first != one:
            yield f"tests: materials '{first}' and '{one}'; write one in one way, or name two apart"


def _same(plan, reports):
    """Faults: tests of the same data, which would count twice."""
    seen = {}
    for one in plan["tests"]:
        told = reports[one["name"]]["posterior"]
        first = seen.setdefault((*told["mean"], *told["temperature"]["value"]), one["name"])
        if first != one["name"]:
            yield f"tests: {first} and {one['name']} hold the same diagnosis, which would count twice"


def _other_calibrations(plan, reports):
    """Faults: tests that were diagnosed with other files of the instruments than the first."""
    first = {}
    for one in plan["tests"]:
        for name, digest in calibrations_of(reports[one["name"]]).items():
            whose, known = first.setdefault(name, (one["name"], digest))
            if digest != known:
                yield (
                    f"tests: {one['name']} was diagnosed with another {name} than {whose}; a campaign lies"
                    " between two calibrations: list those of one, or diagnose both with the same file"
                )


def calibrations_of(report):
    """Digests {file: sha256} of the calibrations behind a report; none of one that does not tell."""
    files = report.get("provenance", {}).get("files", {})
    return {name: digest for name, digest in files.items() if name.endswith("calibration.nc")}


def _laws(told):
    names = tuple(told["names"])
    return {
        "after": Normal(names, np.array(told["mean"]), np.array(told["covariance"])),
        "before": Normal(names, np.array(told["prior"]["mean"]), np.array(told["prior"]["covariance"])),
        "misfit": told["misfit"],
        "own_prior": not told["with_priors"],
        "temperature": {name: np.array(values) for name, values in told["temperature"].items()},
    }


def campaign(tests, reference_power):
    """`Found` of tests in the order of their dates, the last one without data; `reference_power` [W]."""
    whole = Campaign(tests, reference_power)
    odd = whole.odd_ones()
    joint = whole.joint(odd)
    rows = tuple(_row(place, tests, whole, odd, joint, reference_power) for place in range(len(tests) - 1))
    coming = law_of(joint, NEXT, dict.fromkeys(name for one in tests[:-1] for name in one.after.names))
    return Found(joint, rows, coming, tests[-1], reference_power)


def _row(place, tests, whole, odd, joint, reference_power):
    test = tests[place]
    names = test.after.names
    others = tuple(pair for pair in odd if pair[0] != test.name)
    pair = whole.joint(others), whole.joint(others, without=test.name)
    prior, so_far = None, test.after
    if any(one.own_prior for one in tests[:place]):
        past = tuple(pair for pair in odd if pair[0] in {one.name for one in tests[: place + 1]})
        blank = replace(test, after=None, before=None)
        earlier = [one for one in past if one[0] != test.name]
        prior = law_of(Campaign([*tests[:place], blank], reference_power).joint(earlier), test.name, names)
        so_far = law_of(Campaign(tests[: place + 1], reference_power).joint(past), test.name, names)
    final = law_of(joint, test.name, names)
    hot = test.temperature["value"] > HOT
    kelvin = [temperature(test, law) for law in (test.after, so_far, final)]
    return Row(
        test=test,
        pulls={name: _pull(*pair, f"{name} {test.name}") for name in SHOWN if name in names},
        odd=tuple(group for name, group in odd if name == test.name),
        sigma=tuple(_rms(sigma[hot]) for _, sigma in kelvin),
        shift=float(np.mean((kelvin[2][0] - test.temperature["value"])[hot])) if hot.any() else 0.0,
        prior=prior,
    )


def _rms(values):
    return float(np.sqrt(np.mean(values**2))) if values.size else float("nan")


def _pull(with_it, without, name):
    (mean, sigma), (other, wider) = with_it.number(name), without.number(name)
    spread = wider**2 - sigma**2
    return float((mean - other) / np.sqrt(spread)) if spread > 1e-6 * wider**2 else 0.0


def law_of(joint, test, names):
    """`Normal` law of those numbers of a test that the campaign has."""
    names = [name for name in names if f"{name} {test}" in joint.index]
    at = [joint.index[f"{name} {test}"] for name in names]
    return Normal(tuple(names), joint.mean[at], joint.covariance[np.ix_(at, at)])


def temperature(test, law):
    r"""Temperature (t,) [K] of a test and its standard deviation, with another law of what it shares.

    .. math:: T' = T + B\,(x' - x), \qquad C' = C + B\,(S' - S)\,B^T
    """
    told, old = test.temperature, test.after.covariance * test.misfit
    new = old if law is test.after else law.covariance
    change = np.einsum("td,de,te->t", told["slope"], new - old, told["slope"])
    variance = np.maximum(told["sigma"] ** 2 + change, 0.0)
    return told["value"] + told["slope"] @ (law.mean - test.after.mean), np.sqrt(variance)


def law_numbers(found):
    """Rows (name, mean, standard deviation) of the laws that a campaign finds.

    The efficiency itself instead of its logarithm; windows in per cent that a run takes.
    """
    joint = found.joint
    mean, sigma = joint.number("efficiency")
    yield f"efficiency at {found.reference_power / 1e3:g} kW", np.exp(mean), sigma * np.exp(mean)
    yield ("exponent of the efficiency in the electric power", *joint.number("exponent"))
    for what, tried in zip(("the efficiency", "a window"), SCATTERS.T, strict=True):
        yield f"scatter of {what} (relative)", joint.weight @ tried, float("nan")
    for name in joint.index:
        if name.startswith("fouling") and _seen(found, name.split()[1]):
            yield (f"loss of the {name.split('_')[1]}'s window in a run", *joint.number(name))
    for name in joint.index:
        if name.startswith("emittance of "):
            mean, sigma = joint.number(name)
            yield name, np.exp(mean), sigma * np.exp(mean)
    for name in found.next.names:
        if group_of(name) == "instrument":
            yield (WORDS.get(name, f"scale of the spectrometer at {name[6:]} nm"), *joint.number(name))


def _seen(found, name):
    return any(name in row.test.after.names for row in found.rows)


def priors_text(found, calibrations=None):
    """YAML text of the prior of the coming test, by `priors.schema.yaml`.

    `calibrations` {file: sha256}: those of the instruments of its tests.
    """
    law = found.next
    root = law.sigma
    correlation = law.covariance / np.outer(root, root)
    lines = [
        "# What a campaign says before its next test, for `--priors` of `plasmapyro diagnose` and `correct`.",
        "# Numbers are logarithms for emittance and power [W]; else 0 is an instrument as it is stated.",
        f"tests: [{', '.join(row.test.name for row in found.rows)}]",
        *(["calibrations:"] if calibrations else []),
        *(f"  {name}: {digest}" for name, digest in sorted((calibrations or {}).items())),
        f"names: [{', '.join(law.names)}]",
        f"mean: [{', '.join(map(_digits, law.mean))}]",
        f"sigma: [{', '.join(map(_digits, root))}]",
        "correlation:",
        *(f"  - [{', '.join(map(_digits, row))}]" for row in correlation),
    ]
    return "\n".join(lines) + "\n"


def _digits(number):
    """All digits, with a point before an exponent: without it YAML reads a word."""
    text = repr(float(number))
    return text.replace("e", ".0e") if "e" in text and "." not in text else text
