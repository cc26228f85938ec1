"""Guards for physical arguments: each names the culprit, its value and the rule it broke; words of codes."""

import numpy as np


def _refuse_unless(good, name, array, rule, unit):
    if not np.all(good):
        index = tuple(int(i) for i in np.argwhere(~np.atleast_1d(good))[0])
        where = f" at index {index}" if array.ndim else ""
        value = np.atleast_1d(array)[index]
        raise ValueError(f"{name} must {rule}; got {value:g} {unit}{where}".replace(" 1;", ";"))


def positive(name, value, unit):
    """Return `value` as a float array; raise ValueError unless every element is finite and > 0."""
    array = np.asarray(value, dtype=float)
    _refuse_unless((array > 0) & np.isfinite(array), name, array, f"be > 0 {unit}", unit)
    return array


def non_negative(name, value, unit):
    """Return `value` as a float array; raise ValueError unless every element is finite and >= 0."""
    array = np.asarray(value, dtype=float)
    _refuse_unless((array >= 0) & np.isfinite(array), name, array, f"be >= 0 {unit}", unit)
    return array


def within(name, value, low, high, unit):
    """Return `value` as a float array; raise ValueError unless every element lies in [low, high]."""
    array = np.asarray(value, dtype=float)
    _refuse_unless((array >= low) & (array <= high), name, array, f"lie in [{low:g}, {high:g}] {unit}", unit)
    return array


def increasing(name, value, unit):
    """Return `value` as a float array; raise ValueError unless it increases strictly and is finite."""
    array = np.asarray(value, dtype=float)
    if array.ndim != 1 or not np.isfinite(array).all():
        raise ValueError(f"{name} must be one-dimensional and finite [{unit}]")
    steps = np.diff(array) > 0
    if not steps.all():
        first = int(np.argmin(steps))
        raise ValueError(
            f"{name} must increase strictly; got {array[first]:g} {unit} then {array[first + 1]:g} {unit}"
            f" at index {first + 1}"
        )
    return array


def fraction(name, value):
    """Return `value` as a float; raise ValueError unless it lies in (0, 1]."""
    number = float(value)
    if not 0 < number <= 1:
        raise ValueError(f"{name} must lie in (0, 1]; got {number:g}")
    return number


def counted(codes, meanings):
    """How many there are of each code, in words such as '12 valid, 3 missing'; `meanings`: code -> word."""
    found = ((int(np.sum(codes == code)), word) for code, word in meanings.items())
    return ", ".join(f"{count} {word}" for count, word in found if count)


def flags(meanings):
    """CF attributes of a variable of status codes: mapping of code -> word, without blanks."""
    return {
        "flag_values": np.array(list(meanings), dtype="int8"),
        "flag_meanings": " ".join(meanings.values()),
    }
