"""Reading YAML configuration against a closed schema; says all that is wrong, where, and what was meant."""

from difflib import get_close_matches
from pathlib import Path

import yaml
from jsonschema import Draft202012Validator


class ConfigurationError(ValueError):
    """A configuration does not fit its schema; the message lists every fault."""


def load(path, schema):
    """Read one YAML file and return its mapping, checked against `schema` (see `check`)."""
    try:
        values = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as fault:
        raise ConfigurationError(f"{path}: not readable as YAML: {fault}") from None
    return check(values, schema, path)


def load_folder(selection, schema, order=None):
    """Read the YAML files of a folder, each checked against `schema`; the file name is the key.

    Parameters
    ----------
    selection : mapping with `folder` (path) and `only` (names to keep; empty for all)
    schema : path of the schema
    order : key of the files to sort by; by name otherwise

    Returns
    -------
    dict of name -> mapping
    """
    folder, only = Path(selection["folder"]), selection["only"]
    found = {path.stem: path for path in sorted(folder.glob("*.yaml"))}
    missing = sorted(set(only) - set(found))
    if missing:
        near = get_close_matches(missing[0], found, n=1)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise ConfigurationError(f"no file {folder / missing[0]}.yaml{hint} (listed under 'only')")
    cases = {name: load(path, schema) for name, path in found.items() if not only or name in only}
    return dict(sorted(cases.items(), key=lambda case: case[1][order])) if order else cases


def check(values, schema, source):
    """Return `values` if they fit the JSON schema in the YAML file `schema`.

    Raises
    ------
    ConfigurationError
        Names the source, and for each fault the key, its value, the rule and the nearest valid key.
    """
    rules = yaml.safe_load(Path(schema).read_text(encoding="utf-8"))
    faults = sorted(
        Draft202012Validator(rules).iter_errors(values), key=lambda fault: list(map(str, fault.path))
    )
    if faults:
        lines = [line for fault in faults for line in _explain(fault)]
        raise ConfigurationError(f"{source} does not fit {schema}:\n  " + "\n  ".join(lines))
    return values


def check_names(config, conditions, tests):
    """Refuse names in the configuration (and in synthetic tests) that are no condition or test.

    Parameters
    ----------
    config : the main configuration
    conditions, tests : mappings as from `load_folder`
    """
    wanted = {
        "figures.field_condition": [config["figures"]["field_condition"]],
        "analysis.transient.conditions": config["analysis"]["transient"]["conditions"],
        "experiment.compare_with": config["experiment"]["compare_with"],
        **{f"twin.gas of test {name}": test["twin"]["gas"] for name, test in tests.items() if "twin" in test},
    }
    faults = [_unknown(key, name, conditions) for key, names in wanted.items() for name in names]
    faults.append(_unknown("claims.test", config["claims"]["test"], tests))
    if any(faults):
        raise ConfigurationError(
            "\n  ".join(["the configuration names what is not there:", *filter(None, faults)])
        )


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
            yield f"unknown key '{f'{where}.' if where else ''}{key}'; {hint}"
    else:
        about = fault.schema.get("description", "") if isinstance(fault.schema, dict) else ""
        yield f"{where or 'top level'}: {fault.message}" + (f" ({about.strip()})" if about else "")
