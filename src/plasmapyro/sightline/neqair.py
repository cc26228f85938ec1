"""Line-of-sight text of NEQAIR: blocks of version 14 and earlier are read, columns of 15 read and written."""

import re
from collections import deque
from dataclasses import dataclass

import numpy as np
import xarray as xr

from plasmapyro.constants import BOLTZMANN
from plasmapyro.foreign import quote
from plasmapyro.gas.species import SPECIES, TRACES

KNOWN = (*SPECIES, *TRACES)
CENTIMETRE, PER_CUBIC_CENTIMETRE = 1e-2, 1e6  # [m], [m-3]
ELECTRON_NAMES = {"E", "E-", "e", "e-"}
HEAVY, EXCITED = ("T", "TT", "TR"), ("TV", "TE")  # titles: translation and rotation; vibration and electrons
BLOCK_TEMPERATURES = ("T", "TR", "TV", "TE")
TOTAL_RTOL = 0.01  # between the total density of a line and the sum of its species
SAME_TEMPERATURE = 0.11  # [K]; the block layout rounds to 0.1 K
SMALLEST = 1e-99  # [cm-3]; Fortran prints exponents of two digits
DIGITS = r"\d{1,40}\.?\d{0,40}|\.\d{1,40}"  # bounded, or a long word would take hours
NUMBER = re.compile(rf"([-+]?(?:{DIGITS}))(?:[ED]?([-+]\d{{1,3}})|[ED](\d{{1,3}}))?", re.ASCII)


@dataclass(frozen=True)
class _Point:
    """One grid point: line number, position [cm], total density or None, temperatures by title, densities."""

    line: int
    position: float
    total: float | None
    temperatures: dict
    densities: list


def parse(text):
    r"""Sight line from the text of a NEQAIR line-of-sight file.

    The layout is told by the first line: asterisks begin the blocks of version 14 and earlier, a version
    number or a comment the columns of version 15. Grid point i gives the state of the layer between grid
    points i - 1 and i; the first one only sets the origin. The light travels from the first point to the
    last. Each layer becomes two path points, a quarter of the thinnest layer inside its ends, so that half
    the way between neighbours lies on the grid points.

    Source: description and code of NEQAIR_DATA (D. Saunders, NASA Ames, CFD Utilities, 2013-2019), which
    writes both layouts, and the header of the files of version 14. ASSUME: two temperatures at most; files in
    which rotation differs from translation or vibration from the electrons are refused.

    ValueError: one message with the number of the line: missing header, unknown or repeated species, no
    number where one is due, negative density, positions that do not increase, a total that is not the sum of
    the species, temperatures that no two-temperature gas has, a file that ends too early.

    Parameters
    ----------
    text : str

    Returns
    -------
    Dataset, contract 'sightline'
        Species that the file does not list have density 0; pressure from the densities and temperatures.
        Where vibration and electrons differ from translation and rotation, with `excitation_temperature`.
    """
    lines = text.splitlines()
    if not any(line.strip() for line in lines):
        raise ValueError("line 1: the file is empty")
    species, points = _blocks(lines) if lines[0].lstrip().startswith("****") else _columns(lines)
    if len(points) < 2:
        raise ValueError(
            f"line {len(lines)}: a line of sight needs at least 2 grid points; got {len(points)}"
        )
    for before, point in zip([None, *points], points, strict=False):
        _check(point, before)
    return _sightline(species, points)


def compose(sightline):
    r"""Text of a NEQAIR 15 line-of-sight file from a sight line.

    Source: as `parse`.

    Parameters
    ----------
    sightline : Dataset, contract 'sightline'
        Path from the far end of the light's way to the observer, as NEQAIR integrates. Rotational,
        vibrational and electron temperatures are written where it has them.

    Returns
    -------
    str
        One grid point more than the path has points: grid points lie half the way between path points, where
        layers meet. Densities below 1e-99 cm-3 become 0.
    """
    distance = (sightline["path_distance"].values - float(sightline["path_distance"][0])) / CENTIMETRE
    position = np.concatenate([[0.0], (distance[1:] + distance[:-1]) / 2, distance[-1:]])
    heavy = sightline["temperature"].values
    excited = sightline.get("excitation_temperature", sightline["temperature"]).values
    density = sightline["number_density"].values.T / PER_CUBIC_CENTIMETRE
    density = np.where(density < SMALLEST, 0.0, density)
    others = [
        sightline.get(f"{name}_temperature", xr.DataArray(usual, dims="path_distance")).values
        for name, usual in (("rotational", heavy), ("vibrational", excited), ("electron", excited))
    ]
    layers = np.column_stack([density.sum(axis=1), heavy, *others, density])
    names = [str(name) for name in sightline["species"].values]
    titles = ["x", "ntot", "Tt", "Tr", "Tv", "Te", *("E-" if name == "e-" else name for name in names)]
    lines = [
        "#15.0",
        "# Line of sight in the column layout of NEQAIR 15; x [cm], densities [cm-3], temperatures [K]",
        "   n" + "".join(f"{title:>16}" for title in titles),
    ]
    # The first grid point only sets the origin.
    for number, values in enumerate(np.column_stack([position, layers[[0, *range(len(heavy))]]]), start=1):
        lines.append(f"{number:4d}" + "".join(f" {value:15.8E}" for value in values))
    return "\n".join(lines) + "\n"


def _number(word, line):
    """A Fortran number: with E, D or, before a signed exponent, no letter."""
    found = NUMBER.fullmatch(word.upper())
    value = float(f"{found[1]}E{found[2] or found[3] or 0}") if found else np.inf
    if not np.isfinite(value):
        raise ValueError(f"line {line}: {quote(word)} is not a number")
    return value


def _names(words, line):
    """Species in our spelling."""
    names = ["e-" if word in ELECTRON_NAMES else word for word in words]
    for name in names:
        if name not in KNOWN:
            raise ValueError(
                f"line {line}: unknown species {quote(name)}; known are {', '.join(KNOWN)} (E- for electrons)"
            )
        if names.count(name) > 1:
            raise ValueError(f"line {line}: species {name!r} is listed twice")
    return names


def _columns(lines):
    """Species and points of the column layout."""
    rows = [
        (index, line.replace(",", " ").split())
        for index, line in enumerate(lines, start=1)
        if line.strip() and not line.lstrip().startswith(("#", "!"))
    ]
    if rows and len(rows[0][1]) == 1 and NUMBER.fullmatch(rows[0][1][0]):
        rows = rows[1:]  # a version number without a comment sign
    if not rows:
        raise ValueError(f"line {len(lines)}: the file ends before the line of column titles")
    at, titles = rows[0]
    upper = [title.upper() for title in titles]
    hot = [k for k, title in enumerate(upper) if title in HEAVY + EXCITED]
    if not hot or hot != list(range(hot[0], hot[-1] + 1)) or "X" not in upper[: hot[0]]:
        raise ValueError(f"line {at}: column titles must be [n] x [ntot] T..., then the species")
    if not set(upper) & set(HEAVY):
        raise ValueError(f"line {at}: no translational temperature among the column titles")
    if set(upper[: hot[0]]) - {"N", "X", "NTOT"}:
        raise ValueError(f"line {at}: columns before the temperatures must be n, x and ntot")
    species = _names(titles[hot[-1] + 1 :], at)
    if not species:
        raise ValueError(f"line {at}: no species among the column titles")
    points = []
    for line, words in rows[1:]:
        if len(words) != len(titles):
            raise ValueError(f"line {line}: {len(titles)} columns expected, {len(words)} found")
        values = [_number(word, line) for word in words]
        total = values[upper.index("NTOT")] if "NTOT" in upper[: hot[0]] else None
        temperatures = {upper[k]: values[k] for k in hot}
        points.append(_Point(line, values[upper.index("X")], total, temperatures, values[hot[-1] + 1 :]))
    return species, points


def _blocks(lines):
    """Species and points of the block layout."""
    dashes = [k for k, line in enumerate(lines) if line.lstrip().startswith("-----")]
    if len(dashes) < 2:
        raise ValueError(f"line {len(lines)}: the file ends before the second line of hyphens")
    stars = [k for k, line in enumerate(lines[: dashes[0]]) if line.lstrip().startswith("****")]
    words, at = [], stars[-1] + 2
    for k in range(stars[-1] + 1, dashes[0]):
        if "aaaa" not in lines[k]:
            words += lines[k].partition(":")[0].split()
            at = k + 1 if lines[k].strip() else at
            _names(words, at)
    species = _names(words, at)
    if not species:
        raise ValueError(f"line {dashes[0] + 1}: no species above the first line of hyphens")
    return species, list(_block_points(lines, dashes[1] + 1, len(species)))


def _block_points(lines, start, count):
    """Points until the line of zeros; each a head line and `count` densities on the lines after it."""
    rows = deque((k + 1, lines[k].split()) for k in range(start, len(lines)) if lines[k].strip())
    while rows:
        line, head = rows.popleft()
        if head[0] == "0":
            return
        if len(head) != 3 + len(BLOCK_TEMPERATURES):
            raise ValueError(
                f"line {line}: number, x, total and 4 temperatures expected, {len(head)} words found"
            )
        values = [_number(word, line) for word in head[1:]]
        densities, at = [], line
        while len(densities) < count:
            if not rows:
                found = f"{len(densities)} of {count}"
                raise ValueError(f"line {at}: the file ends within a grid point, after {found} densities")
            at, words = rows.popleft()
            if len(words) > count - len(densities):
                raise ValueError(
                    f"line {at}: {count - len(densities)} densities expected, {len(words)} found"
                )
            densities += [_number(word, at) for word in words]
        temperatures = dict(zip(BLOCK_TEMPERATURES, values[2:], strict=True))
        yield _Point(line, values[0], values[1], temperatures, densities)
    raise ValueError(f"line {len(lines)}: the file ends before the closing line of zeros")


def _check(point, before):
    """Refuse a point that no gas can be in, or that does not lie behind the one before."""
    if before is not None and not point.position > before.position:
        raise ValueError(
            f"line {point.line}: x must increase; got {before.position:g} cm then {point.position:g} cm"
        )
    for titles in (HEAVY, EXCITED):
        found = {title: point.temperatures[title] for title in titles if title in point.temperatures}
        if found and min(found.values()) <= 0:
            raise ValueError(f"line {point.line}: temperatures must be > 0 K; got {min(found.values()):g} K")
        if found and max(found.values()) - min(found.values()) > SAME_TEMPERATURE:
            values = " and ".join(f"{title} = {value:g} K" for title, value in found.items())
            raise ValueError(f"line {point.line}: these temperatures must agree; got {values}")
    if min(point.densities) < 0:
        raise ValueError(
            f"line {point.line}: number densities must be >= 0 cm-3; got {min(point.densities):g}"
        )
    total = sum(point.densities)
    if point.total is not None and abs(total - point.total) > TOTAL_RTOL * point.total:
        raise ValueError(
            f"line {point.line}: the species add up to {total:g} cm-3, the total says {point.total:g} cm-3"
        )


def _sightline(species, points):
    """Dataset of contract 'sightline': two path points for each layer between two grid points."""
    edge = np.array([point.position for point in points]) * CENTIMETRE
    inset = np.diff(edge).min() / 4
    distance = np.ravel(np.column_stack([edge[:-1] + inset, edge[1:] - inset]))
    distance[0], distance[-1] = edge[0], edge[-1]
    heavy = np.repeat([_first(point, HEAVY) for point in points[1:]], 2)
    excited = np.repeat([_first(point, EXCITED + HEAVY) for point in points[1:]], 2)
    names = [*SPECIES, *(name for name in species if name not in SPECIES)]
    density = np.zeros((len(names), len(distance)))
    for k, name in enumerate(species):
        values = [point.densities[k] * PER_CUBIC_CENTIMETRE for point in points[1:]]
        density[names.index(name)] = np.repeat(values, 2)
    electrons = density[names.index("e-")]
    pressure = BOLTZMANN * ((density.sum(axis=0) - electrons) * heavy + electrons * excited)
    sightline = xr.Dataset(
        {
            "temperature": ("path_distance", heavy),
            "pressure": ("path_distance", pressure),
            "number_density": (("species", "path_distance"), density),
        },
        {"path_distance": distance, "species": names},
        attrs={"origin": "modelled", "title": "Line of sight read from NEQAIR-style text"},
    )
    if np.abs(excited - heavy).max() > SAME_TEMPERATURE:
        sightline["excitation_temperature"] = ("path_distance", excited)
    return sightline


def _first(point, titles):
    """The first temperature that a point has of several [K]."""
    return next(point.temperatures[title] for title in titles if title in point.temperatures)
