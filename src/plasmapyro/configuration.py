"""Reading YAML configuration against a closed schema; says all that is wrong, where, and what was meant."""

import re
from contextlib import suppress
from difflib import get_close_matches
from functools import cache
from math import inf, isfinite
from pathlib import Path

import yaml
from jsonschema import Draft202012Validator, ValidationError
from jsonschema.validators import extend
from referencing import Registry
from referencing.jsonschema import DRAFT202012

from plasmapyro.foreign import Strict, printable, quote, unfit
from plasmapyro.gas.species import AIR

LARGEST_FILE = 250_000  # [byte]
MOST_FAULTS, LONGEST_LINE, LONGEST_VALUE = 40, 500, 200  # that a message shows; the others in characters
OF_CONDITION = re.compile(
    r"results/(?:flow|sightline|radiation|radiation_variations|surface_view|reflection|facility)/([^/]+)\.nc"
)
# Of what becomes part of file names and of patterns of the workflow.
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+-]*")
MEANT = re.compile(r"\.ya?ml(\.txt)?$", re.IGNORECASE)  # to be a .yaml


class ConfigurationError(ValueError):
    """A configuration does not fit its schema; the message lists every fault."""


class _Loader(Strict, yaml.SafeLoader):
    """Safe and strict; refuses digits that YAML 1.1 takes in another base, 050 as 40 and 1:30 as 90."""

    def construct_yaml_int(self, node):
        number, words = super().construct_yaml_int(node), node.value.replace("_", "").lstrip("+-")
        if (words.isdigit() and number not in (int(words), -int(words))) or ":" in words:
            what = f"{quote(node.value)} would be read as {number}; write it without a leading zero or colons"
            raise yaml.MarkedYAMLError(problem=what, problem_mark=node.start_mark)
        return number


_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_yaml_int)


def _rising(_, count, instance, __):
    """Schema keyword `rising: n`: the first n numbers of a list increase strictly."""
    head = instance[:count] if isinstance(instance, list) else []
    if not all(isinstance(number, int | float) for number in head):
        return  # the keyword `type` says so
    if any(later <= earlier for earlier, later in zip(head, head[1:], strict=False)):
        yield ValidationError(f"{head} must rise")


def _path(_, __, instance, ___):
    """Schema keyword `path`: the name of a file or folder that the workflow takes as it stands."""
    if isinstance(instance, str) and set(instance) & set("{}"):
        yield ValidationError(
            f"{instance!r} holds braces, which the workflow takes for a name to fill in; rename it"
        )


_Validator = extend(Draft202012Validator, {"rising": _rising, "path": _path})


def read(path):
    """The values of one YAML file.

    ConfigurationError if it is no plain file, not YAML, larger than a configuration can be, holds an alias,
    or a key stands in it twice; the message names file and line.
    """
    if found := unfit(path, LARGEST_FILE):
        raise ConfigurationError(f"{path}: {'; '.join(found)}")
    try:
        return yaml.load(Path(path).read_text(encoding="utf-8"), _Loader)
    except Exception as fault:  # a tag on a word that it does not fit (`!!int ''`) breaks the parser anywhere
        words = (
            fault
            if isinstance(fault, OSError | ValueError | yaml.YAMLError)
            else "a tag does not fit its word"
        )
        raise ConfigurationError(printable(f"{path}: not readable as YAML: {words}")) from None


def load(path, schema):
    """Read one YAML file and return its mapping, checked against `schema` (see `check`)."""
    return check(read(path), schema, path)


def load_folder(selection, schema, order=None):
    """Values by file name of the YAML files of a folder, each checked against `schema`.

    `selection`: `folder` (path) and `only` (names to keep; empty for all); sorted by name, or by the key
    `order`, those without it last.
    """
    folder, only = Path(selection["folder"]), selection["only"]
    meant = [path for path in sorted(folder.glob("[!.]*")) if MEANT.search(path.name)]
    if unread := [path for path in meant if not path.name.endswith(".yaml")]:
        raise ConfigurationError(f"{unread[0]}: is not read; let its name end in .yaml, or take it elsewhere")
    found = {path.stem: path for path in meant}
    odd = [name for name in found if not NAME.fullmatch(name)]
    if odd:
        raise ConfigurationError(
            f"{folder / odd[0]}.yaml: the name of the file becomes part of other names; use letters, digits,"
            " '_', '.', '+' and '-' only"
        )
    missing = sorted(set(only) - set(found))
    if missing:
        near = get_close_matches(missing[0], found, n=1)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise ConfigurationError(f"no file {folder / missing[0]}.yaml{hint} (listed under 'only')")
    cases, faults = {}, []
    for name, path in found.items():
        if not only or name in only:
            try:
                cases[name] = load(path, schema)
            except ConfigurationError as fault:
                faults.append(str(fault))
    if faults:
        raise ConfigurationError("\n".join(faults))
    return dict(sorted(cases.items(), key=lambda case: case[1].get(order, inf))) if order else cases


def ladder(conditions, name):
    """Conditions that may share all but the power with one of them, itself included; one of each power."""

    def gas_of(case):
        own = {"nitrogen_mole_fraction": AIR["N2"], "argon_mole_fraction": 0.0, **case}
        own = {key: value for key, value in own.items() if key not in ("numerical_power_kw", "emittance")}
        return own | {"cfd": {k: v for k, v in own.get("cfd", {}).items() if k not in ("file", "mesh")}}

    by_power = {conditions[name].get("numerical_power_kw"): name}
    for one in sorted(conditions):
        power = conditions[one].get("numerical_power_kw")
        if None not in (power, *by_power) and gas_of(conditions[one]) == gas_of(conditions[name]):
            by_power.setdefault(power, one)
    return [one for one in conditions if one in by_power.values()]


def check(values, schema, source):
    """Return `values` if they fit the JSON schema in the YAML file `schema`; it may refer to files beside it.

    ConfigurationError names the source, and for each fault the key, its value, the rule and the nearest valid
    key.
    """
    rules = _rules(schema)
    others = Registry(retrieve=lambda name: DRAFT202012.create_resource(_rules(Path(schema).with_name(name))))
    found = _Validator(rules, registry=others).iter_errors(values)
    faults = sorted(found, key=lambda fault: list(map(str, fault.path)))
    lines = [line for fault in faults for line in _explain(fault)]
    lines += [f"{where}: {number} is not a finite number" for where, number in _endless(values)]
    if lines:
        more = [f"and {len(lines) - MOST_FAULTS} more"] if len(lines) > MOST_FAULTS else []
        said = [line if len(line) <= LONGEST_LINE else f"{line[:LONGEST_LINE]}..." for line in lines]
        words = "\n  ".join([f"{source} does not fit {schema}:", *said[:MOST_FAULTS], *more])
        raise ConfigurationError(printable(words))
    return values


@cache
def _rules(schema):
    return yaml.safe_load(Path(schema).read_text(encoding="utf-8"))


def _endless(values, where=""):
    """Places of NaN and infinity in nested mappings and lists."""
    if isinstance(values, dict | list):
        pairs = values.items() if isinstance(values, dict) else enumerate(values)
        for key, value in pairs:
            yield from _endless(value, f"{where}.{key}".lstrip("."))
    elif isinstance(values, float) and not isfinite(values):
        yield where, values


OF_ANOTHER_FLOW = "held against computed flows only; the flow of this condition is another program's (cfd)"
NO_FACILITY = "needs the section 'facility' of the configuration; copy it from config/config.yaml"


def check_together(config, conditions, tests):
    """Refuse values that are right one by one but not together: unknown names, and ranges that do not fit."""
    paper = config["claims"]["conditions"]
    shown = {
        "figures.field_condition": [config["figures"]["field_condition"]],
        "analysis.transient.conditions": config["analysis"]["transient"]["conditions"],
    }
    twins = {name: test["twin"] for name, test in tests.items() if "twin" in test}
    wanted = {
        "claims.conditions": paper,
        **shown,
        "experiment.compare_with": config["experiment"]["compare_with"],
        "diagnosis.condition": [config["diagnosis"]["condition"]],
        **{
            f"readings.{name}.condition": [one["condition"]]
            for name, one in config.get("readings", {}).items()
        },
        **{f"twin.gas of test {name}": twin["gas"] for name, twin in twins.items()},
        **{f"twin.condition of test {name}": [twin["condition"]] for name, twin in twins.items()},
    }
    faults = [_unknown(key, name, conditions) for key, names in wanted.items() for name in names]
    if "bands" not in config["instrument"]:  # tests of another instrument show no claim of the paper
        faults.append(_unknown("claims.test", config["claims"]["test"], tests))
    faults += [
        f"{key}: '{name}' is not in claims.conditions, the set that the paper's figures show"
        for key, names in shown.items()
        for name in names
        if name in conditions and name not in paper
    ]
    faults += _no_ladder({name: conditions[name] for name in paper if name in conditions})
    drawn = config["figures"]["field_condition"]
    computed = [name for name, case in conditions.items() if "cfd" not in case]
    if computed and drawn in conditions and drawn not in computed:
        faults.append(
            f"figures.field_condition: '{drawn}' brings its own flow field (cfd), which is not drawn; name"
            f" one of {', '.join(computed)}"
        )
    lowest, highest = min(config["gas"]["pressure_mbar"]), max(config["gas"]["pressure_mbar"])
    cases = {"flow.start": config["flow"]["start"], **conditions}
    faults += [
        f"chamber_pressure_mbar of {name}: {case['chamber_pressure_mbar']} mbar lies outside"
        f" gas.pressure_mbar ({lowest} to {highest} mbar)"
        for name, case in cases.items()
        if "cfd" not in case and not lowest <= case["chamber_pressure_mbar"] <= highest
    ]
    faults += [
        f"measured of {name}: {reason}"
        for name, case in conditions.items()
        for reason in ["cfd" in case and OF_ANOTHER_FLOW, "facility" not in config and NO_FACILITY]
        if "measured" in case and reason
    ]
    faults += [
        f"flow of {name}: says what a computed flow holds; that of this condition is another program's (cfd)"
        for name, case in conditions.items()
        if "cfd" in case and "flow" in case
    ]
    if config["sightline"]["window_distance_mm"] >= config["sightline"]["instrument_distance_mm"]:
        faults.append("sightline: window_distance_mm must be less than instrument_distance_mm")
    if any(faults):
        raise ConfigurationError(
            "\n  ".join(["the configuration does not fit together:", *filter(None, faults)])
        )


def check_compared(tests, conditions):
    """Refuse tests that are to be compared with conditions (test -> its name) that are not there."""
    faults = [
        f"{_unknown(f'condition of test {test}', name, conditions)}; or leave the test out with tests.only"
        for test, name in tests.items()
        if name not in conditions
    ]
    if faults:
        raise ConfigurationError("\n  ".join(["tests name conditions that are not there:", *faults]))


def _no_ladder(cases):
    """What keeps the conditions of the claims from differing in their power only."""
    first, reference = next(iter(cases.items()), ("", {}))
    for name, case in cases.items():
        if case.get("nitrogen_mole_fraction", AIR["N2"]) != AIR["N2"] or case.get("argon_mole_fraction"):
            yield f"claims.conditions: '{name}' is no air as the paper's; its figures and claims are"
        if case.get("flow") != reference.get("flow"):
            yield f"claims.conditions: '{name}' has another flow than '{first}'; only their power may differ"
        for key in ("chamber_pressure_mbar", "mass_flow_rate_g_s", "emittance"):
            if case[key] != reference[key]:
                yield (
                    f"claims.conditions: {key} is {case[key]:g} in '{name}' and {reference[key]:g} in"
                    f" '{first}'; the conditions of the paper's figures differ in their power only"
                )
        power = case.get("numerical_power_kw")
        if power is None:
            yield f"claims.conditions: '{name}' lacks numerical_power_kw"
        twin = next(one for one in cases if cases[one].get("numerical_power_kw") == power)
        if twin != name and power is not None:
            yield f"claims.conditions: '{twin}' and '{name}' have the same numerical_power_kw"


def check_targets(targets, conditions, selection):
    """Refuse files that are asked for of a condition which is not among those of the run."""
    faults = []
    for match in filter(None, map(OF_CONDITION.fullmatch, map(str, targets))):
        path, name = match[0], match[1]
        if name not in conditions and (Path(selection["folder"]) / f"{name}.yaml").exists():
            only = f"[{', '.join([*selection['only'], name])}]"
            faults.append(
                f"{path}: conditions.only leaves '{name}' out; add --config 'conditions={{only: {only}}}'"
            )
        else:
            faults.append(_unknown(path, name, conditions))
    if faults := [fault for fault in faults if fault]:
        raise ConfigurationError("\n".join(faults))


def _unknown(key, name, known):
    if name in known:
        return None
    near = get_close_matches(name, known, n=1)
    hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(known)}"
    return f"{key}: no file for '{name}'; {hint}"


def _explain(fault):
    where = ".".join(map(str, fault.absolute_path))
    if fault.validator == "additionalProperties" and isinstance(fault.instance, dict):
        valid = list(fault.schema.get("properties", {}))
        for key in sorted(set(fault.instance) - set(valid), key=str):
            near = get_close_matches(str(key), valid, n=1, cutoff=0.5)
            hint = f"did you mean '{near[0]}'?" if near else f"valid keys: {', '.join(valid)}"
            yield f"unknown key {quote(f'{where}.{key}'.lstrip('.'))}; {hint}"
    else:
        about = fault.schema.get("description", "") if isinstance(fault.schema, dict) else ""
        shown, value = fault.message, repr(fault.instance)
        if len(value) > LONGEST_VALUE:
            shown = shown.replace(value, f"{value[:LONGEST_VALUE]}...")
        if fault.validator_value == "number" and isinstance(fault.instance, str):
            with suppress(ValueError):
                shown += f"; write {float(fault.instance):.12g}"
        yield f"{where or 'top level'}: {shown}" + (f" ({about.strip()})" if about else "")
