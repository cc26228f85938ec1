"""Kinds of numbers that commands take, each refused in words when it means nothing."""

import argparse

import numpy as np


def option(group, flag, kind, default, words):
    """Add an option with a number of some kind and its default in the help."""
    group.add_argument(flag, type=kind, default=default, metavar="X", help=f"{words} (default: {default:g})")


def _number(word, rule, holds, kind=float):
    try:
        value = kind(word)
    except ValueError:
        value = None
    if value is None or not holds(value):
        raise argparse.ArgumentTypeError(f"{rule}; got {word!r}")
    return value


def positive(word):
    """A number > 0."""
    return _number(word, "must be a number > 0", lambda value: 0 < value < np.inf)


def not_negative(word):
    """A number >= 0."""
    return _number(word, "must be a number >= 0", lambda value: 0 <= value < np.inf)


def share(word):
    """A number from 0 to 1."""
    return _number(word, "must be a number from 0 to 1", lambda value: 0 <= value <= 1)


def count(word):
    """A number of things to average over."""
    return _number(word, "must be a whole number from 3 to 100000", lambda value: 3 <= value <= 100_000, int)


def seed(word):
    """A seed of random numbers."""
    return _number(word, "must be a whole number >= 0", lambda value: value >= 0, int)


def picture(word):
    """Name of a file for a picture."""
    if not word.endswith((".png", ".svg")):
        raise argparse.ArgumentTypeError(f"must end in .png or .svg; got {word!r}")
    return word


def plot_option(command, shows):
    """Add `--plot FILE`."""
    command.add_argument("--plot", type=picture, metavar="FILE", help=f"draw {shows} (.png or .svg)")
