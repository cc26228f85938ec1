"""Effects that are taken as given: the entries that a diagnosis writes and that tests and conditions hold."""

import hashlib
from dataclasses import dataclass, replace
from difflib import get_close_matches
from math import isfinite
from types import MappingProxyType

import numpy as np

from plasmapyro.diagnosis.effects.gas import proposed
from plasmapyro.diagnosis.fit.setting import Setting, free_numbers

FITTED = "fitted_to"  # key: mark of the data that a diagnosis fitted the numbers of an entry to
KEYS = ("id", "amplitude", "uncertainty", "shape", "shape_uncertainty", FITTED)
SIGNALS = (
    "signal_wide",
    "signal_narrow",
    "radiometer_signal",
    "radiometer_reading",
    "counts",
    "spectral_radiance",
)
AMPLITUDE = "amplitude"


@dataclass(frozen=True)
class Term:
    """A setting that is taken as given, with the standard `uncertainty` {number: u} of its numbers > 0.

    `fitted_to`: mark of the data that the numbers were fitted to, "" if none; `own`: they are those of the
    test at hand, which must not count twice: the numbers start there, with the priors that they had.
    """

    setting: Setting
    uncertainty: dict
    fitted_to: str = ""
    own: bool = False

    def mark(self, data):
        """Mark of these numbers as fitted to data of some digest: not theirs any more if they are edited."""
        text = text_of([replace(self, own=False)])
        return hashlib.sha256(f"{data}\n{text}".encode()).hexdigest()[:16]

    def prior(self):
        """Normal law {number: (centre, standard deviation)} of what is uncertain, before the test at hand."""
        if not self.own:
            return {name: (self.numbers[name], sigma) for name, sigma in self.uncertainty.items()}
        free = {one.name or AMPLITUDE: one for one in free_numbers((self.setting,))}
        return {name: (free[name].centre, free[name].sigma) for name in self.uncertainty}

    @property
    def numbers(self):
        """Amplitude and shape {name: value}."""
        return {AMPLITUDE: self.setting.amplitude} | self.setting.shape

    def at(self, changed):
        """The setting with some of its numbers {name: value} changed, within what the effect allows."""
        effect, numbers = self.setting.effect, self.numbers | changed
        for name, value in numbers.items():
            low, high = bounds_of(effect, name)
            numbers[name] = float(min(max(value, low), high))
        return Setting(effect, numbers.pop(AMPLITUDE), numbers)


def digest_of(test):
    """Digest of the signals of a test (Dataset, contract 'test')."""
    found = hashlib.sha256()
    for name in SIGNALS:
        if name in test:
            found.update(name.encode() + np.ascontiguousarray(test[name].values, dtype=float).tobytes())
    return found.hexdigest()


def with_own(terms, test):
    """Terms, `own` where a diagnosis fitted them to the data of this very test (tuple)."""
    data = digest_of(test) if any(term.fitted_to for term in terms) else ""
    return tuple(replace(one, own=bool(one.fitted_to) and one.fitted_to == one.mark(data)) for one in terms)


def bounds_of(effect, name):
    """Least and largest value of the amplitude, or of another number of an effect."""
    return effect.bounds if name == AMPLITUDE else effect.shape_bounds[name]


def terms_of(entries, effects, where="effects", elsewhere=MappingProxyType({})):
    """Terms of a list of entries as `text_of` writes them.

    Those of amplitude 0 that are known exactly change nothing and are left out.

    Parameters
    ----------
    entries : list of mappings with `id` and `amplitude` (in the unit of the effect), and if wanted
        `uncertainty` (standard, of the amplitude), `shape` {number: value}, `shape_uncertainty`; `fitted_to`
    effects : mapping id -> Effect, those that may be named
    where : str
        What messages call the list.
    elsewhere : mapping id -> folder of files
        Where effects belong.

    Returns
    -------
    tuple of Term

    Raises
    ------
    ValueError
        Every fault, with its place and the nearest name.
    """
    if not isinstance(entries, list):
        raise ValueError(f"{where}: must be a list of entries with id and amplitude; got {entries!r}")
    faults, terms = [], []
    for place, entry in enumerate(entries):
        at = f"{where}.{place}"
        if not isinstance(entry, dict) or not isinstance(entry.get("id"), str):
            faults.append(f"{at}: must be a mapping with an id and an amplitude; got {entry!r}")
            continue
        faults += [_unknown(f"{at}.{key}", key, KEYS) for key in entry if key not in KEYS]
        effect = effects.get(entry["id"]) or proposed(entry["id"])
        if effect is None:
            whose = elsewhere.get(entry["id"])
            belongs = f"{at}.id: '{entry['id']}' belongs to {whose}; valid here: {', '.join(effects)}"
            faults.append(belongs if whose else _unknown(f"{at}.id", entry["id"], effects))
            continue
        found = list(_faults(at, entry, effect))
        faults += found
        if not found:
            terms.append(_term(entry, effect))
    ids = [term.setting.id for term in terms]
    faults += [f"{where}: '{name}' is given twice" for name in sorted({i for i in ids if ids.count(i) > 1})]
    if faults:
        raise ValueError("\n  ".join(faults))
    return tuple(term for term in terms if term.setting.amplitude or term.uncertainty)


def _term(entry, effect):
    shape = {name: float(value) for name, value in entry.get("shape", {}).items()}
    sigma = {AMPLITUDE: entry.get("uncertainty", 0.0)} | entry.get("shape_uncertainty", {})
    uncertainty = {name: float(value) for name, value in sigma.items() if value > 0}
    return Term(Setting(effect, float(entry["amplitude"]), shape), uncertainty, entry.get(FITTED, ""))


def _faults(at, entry, effect):
    """What is wrong with an entry of a known effect."""
    unit = "" if effect.unit == "1" else f" {effect.unit}"
    if "amplitude" not in entry:
        yield f"{at}.amplitude: missing ({effect.amplitude} [{effect.unit}])"
    else:
        yield from _number(f"{at}.amplitude", entry["amplitude"], *effect.bounds, unit)
    yield from _number(f"{at}.uncertainty", entry.get("uncertainty", 0), 0, float("inf"), unit)
    if not isinstance(entry.get(FITTED, ""), str):
        yield f"{at}.{FITTED}: must be the word that a diagnosis wrote, in quotes; got {entry[FITTED]!r}"
    for key in ("shape", "shape_uncertainty"):
        given = entry.get(key, {})
        if not isinstance(given, dict):
            yield f"{at}.{key}: must be a mapping of numbers; got {given!r}"
            continue
        for name, value in given.items():
            if name not in effect.shape_bounds:
                yield _unknown(f"{at}.{key}.{name}", name, effect.shape_bounds)
            else:
                ends = effect.shape_bounds[name] if key == "shape" else (0, float("inf"))
                yield from _number(f"{at}.{key}.{name}", value, *ends, "")
    if isinstance(entry.get("shape", {}), dict):
        for name in effect.shapes[0]:
            if name not in entry.get("shape", {}):
                low, high = effect.shape_bounds[name]
                yield f"{at}.shape.{name}: missing ({low:g} to {high:g})"


def _number(where, value, low, high, unit):
    number = isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
    if not number or not low <= value <= high:
        yield f"{where}: must be a number from {low:g} to {high:g}{unit}; got {value!r}"


def _unknown(where, name, known):
    near = get_close_matches(str(name), known, n=1, cutoff=0.5)
    hint = f"did you mean '{near[0]}'?" if near else f"valid: {', '.join(known) or 'none'}"
    return f"{where}: unknown; {hint}"


def _digits(number):
    """Six digits, with a point before an exponent: without it YAML reads a word."""
    text = f"{number:.6g}"
    return text.replace("e", ".0e") if "." not in text else text


def text_of(terms, indent="", data=""):
    """YAML text of terms under the key `effects`, as `terms_of` reads them; `own` ones marked by a digest."""
    if not terms:
        return f"{indent}effects: []\n"
    lines = ["effects:"]
    for term in terms:
        effect, sigma = term.setting.effect, dict(term.uncertainty)
        lines += [
            f"  - id: {effect.id}  # {effect.name}",
            f"    amplitude: {_digits(term.setting.amplitude)}  # {effect.amplitude} [{effect.unit}]",
            f"    uncertainty: {_digits(sigma.pop(AMPLITUDE, 0.0))}",
        ]
        for key, numbers in (("shape", term.setting.shape), ("shape_uncertainty", sigma)):
            if numbers:
                inside = ", ".join(f"{name}: {_digits(value)}" for name, value in numbers.items())
                lines.append(f"    {key}: {{{inside}}}")
        if term.own:
            lines.append(f'    {FITTED}: "{term.mark(data)}"  # this test: not counted twice')
    return "".join(f"{indent}{line}\n" for line in lines)
