"""Datasets against their contracts, and the labels that the register gives them."""

import numpy as np

from plasmapyro.contracts.datasets import CONDITION, DATASETS, OF_A_CONDITION, WITH_GAPS
from plasmapyro.contracts.variables import VARIABLES


class ContractError(ValueError):
    """A dataset does not honour its contract; the message lists every breach."""


def _breaches_of(found, name, dims, rule, gaps):
    if found.dims != dims:
        yield f"{name}: dims {found.dims}, expected {dims}"
    if rule.units == "":
        if found.dtype.kind not in "OUST":
            yield f"{name}: must be text, is {found.dtype}"
        return
    if found.attrs.get("units") != rule.units:
        yield f"{name}: units {found.attrs.get('units')!r}, expected {rule.units!r}"
    values = np.asarray(found.values)
    if values.dtype.kind not in "fiu":
        yield f"{name}: must be numbers, is {values.dtype}"
        return
    if not (rule.nan_allowed or gaps) and np.isnan(values).any():
        yield f"{name}: NaN not allowed"
    outside = (values < rule.low) | (values > rule.high)
    if outside.any():
        yield f"{name}: {values[outside].flat[0]:g} {rule.units} outside [{rule.low:g}, {rule.high:g}]"


def _breaches_of_attributes(attributes):
    for name in CONDITION:
        value, rule = attributes.get(name), VARIABLES.get(name)
        if value is None:
            continue
        if rule is None and not isinstance(value, str):
            yield f"attribute {name}: must be text, is {value!r}"
        elif rule is not None and not (
            isinstance(value, int | float | np.number) and rule.low < value <= rule.high
        ):
            yield f"attribute {name}: {value!r} is no number of ({rule.low:g}, {rule.high:g}] {rule.units}"


def check(dataset, contract):
    """Raise ContractError naming all breaches of `contract` in `dataset`; return the dataset."""
    breaches = list(_breaches_of_attributes(dataset.attrs)) if contract in OF_A_CONDITION else []
    for key, dims in DATASETS[contract].items():
        name = key.rstrip("?")
        if name in dataset.variables:
            breaches += _breaches_of(dataset[name], name, dims, VARIABLES[name], contract in WITH_GAPS)
        elif key == name:
            breaches.append(f"{name}: missing")
    if breaches:
        raise ContractError(f"not a valid '{contract}' dataset:\n  " + "\n  ".join(breaches))
    return dataset


def label(dataset, contract):
    """Return a copy of `dataset` whose variables carry the registered units, long and standard names."""
    dataset = dataset.copy()
    for key in DATASETS[contract]:
        name = key.rstrip("?")
        if name in dataset.variables:
            rule = VARIABLES[name]
            attributes = {"long_name": rule.long_name}
            if rule.units:
                attributes["units"] = rule.units
            if rule.standard_name:
                attributes["standard_name"] = rule.standard_name
            dataset[name].attrs.update(attributes)
    return dataset
