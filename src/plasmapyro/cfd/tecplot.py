"""Tecplot text files: FE and ordered zones, point by point or in blocks, values at nodes or in cells."""

import re
from math import prod

import numpy as np

from plasmapyro.cfd.grid import Zone, block_cells, known_as
from plasmapyro.readers.text import WHOLE, quote, read_lines, refuse

LARGEST = 2_000_000_000  # [byte]
CELLS = known_as("Tecplot")
RECORDS = re.compile(
    r"^\s*(TITLE|FILETYPE|VARIABLES|ZONE|TEXT|GEOMETRY|CUSTOMLABELS|DATASETAUXDATA|VARAUXDATA|USERREC)\b",
    re.I,
)
NUMERIC = re.compile(r"^\s*([-+.]?\d|[-+]?(nan|inf)\b|[-+]?\.\d)", re.I)
SETTING = re.compile(r"""\b(\w++)\s*+=\s*("[^"]*"|'[^']*'|\([^)]*\)|[^\s,]+)""")
NAME = re.compile(r'"([^"]*)"|([^\s,"]+)')
LOCATION = re.compile(r"(?:\[([^\]]*)\]|(\d+))\s*=\s*(NODAL|CELLCENTERED)", re.I)
SPAN = re.compile(r"\s*(\d{1,9})\s*(?:-\s*(\d{1,9})\s*)?", re.ASCII)
REPEATED = re.compile(r"(?<!\S)(\d{1,15})\*(\S+)", re.ASCII)
LONGEST_LOCATION = 10_000  # characters of VARLOCATION
FORTRAN_EXPONENT = re.compile(r"([\d.])[dD]([-+]?\d)")
SHARED = ("VARSHARELIST", "CONNECTIVITYSHAREZONE", "PASSIVEVARLIST")


def read(path):
    """All zones of a Tecplot text file; the coordinates are among the point data, by their names.

    Reads FEPOINT, FEBLOCK, DATAPACKING=POINT and BLOCK with VARLOCATION, and ordered zones; lines that begin
    with # may stand anywhere. Zones of line segments are left out. Refusal: binary or broken files, counts of
    nodes or cells that the data do not have, and zones that share data.

    Source: Tecplot 360 Data Format Guide, chapter ASCII data; and the two layouts that COOLFluiD writes.
    """
    lines, _ = read_lines(path, LARGEST)
    names, zones = [], []
    place = 0
    while place < len(lines):
        record = RECORDS.match(lines[place])
        kind = record.group(1).upper() if record else None
        if kind == "VARIABLES":
            words, place = _header(lines, place)
            names = [a or b for a, b in NAME.findall(words.partition("=")[2])]
        elif kind == "ZONE":
            start = place + 1
            words, place = _header(lines, place)
            if not names:
                refuse(path, "a ZONE without VARIABLES before it", "export it with its header", start)
            zone, place = _zone(path, names, words, lines, place, start, len(zones) + 1)
            zones.append(zone)
        elif NUMERIC.match(lines[place]):
            refuse(path, "numbers stand before the first ZONE", "export it with its header", place + 1)
        else:
            place += 1
    if not zones:
        refuse(path, "holds no ZONE", "export it as Tecplot text (ASCII), not binary (.plt)")
    return zones


def _header(lines, place):
    """Words of a record that may go on over several lines, and the place of the line after it."""
    words = [lines[place]]
    place += 1
    while place < len(lines) and not NUMERIC.match(lines[place]) and not RECORDS.match(lines[place]):
        if not lines[place].lstrip().startswith("#"):
            words.append(lines[place])
        place += 1
    return " ".join(words), place


def _zone(path, names, words, lines, place, start, number):
    """One zone, and the place of the line after it."""
    settings = {key.upper(): value.strip("\"'") for key, value in SETTING.findall(words)}
    title = settings.get("T", f"zone {number}").strip()
    shared = [key for key in SHARED if key in settings] + ["D"] * ("D" in settings)
    if shared:
        refuse(
            path, f"zone {title!r} shares data ({shared[0]})", "export every zone with its own data", start
        )
    shape = settings.get("ZONETYPE", settings.get("ET", "ORDERED")).upper().removeprefix("FE")
    packing = settings.get("DATAPACKING", settings.get("F", "POINT")).upper().removeprefix("FE")
    if packing not in ("POINT", "BLOCK") or shape not in (*CELLS, "ORDERED"):
        refuse(
            path,
            f"zone {title!r} is of kind {shape}, {packing}",
            f"kinds that are read: {', '.join(CELLS)} and ordered, POINT or BLOCK",
            start,
        )
    if shape == "ORDERED":
        sizes = [_count(path, settings, (key,), start, title, 1) for key in "IJK"]
        nodes, cells, per_cell = prod(sizes), prod(max(size - 1, 1) for size in sizes), 0
    else:
        nodes = _count(path, settings, ("N", "NODES"), start, title)
        cells = _count(path, settings, ("E", "ELEMENTS"), start, title)
        per_cell = CELLS[shape][1]
    in_cells = _cell_centred(path, settings.get("VARLOCATION", ""), len(names), start)
    if in_cells and packing == "POINT":
        refuse(path, f"zone {title!r} holds values in cells point by point", "export it in blocks", start)
    lengths = [cells if k in in_cells else nodes for k in range(len(names))]
    wanted = sum(lengths) + cells * per_cell
    numbers, count, place, last = _numbers(path, lines, place, wanted)
    if count != wanted:
        refuse(
            path,
            f"zone {title!r} needs {wanted} numbers ({nodes} nodes, {cells} cells, {len(names)} variables);"
            f" {count} stand there",
            "the file is cut off, or the counts in its header are wrong",
            last,
        )
    if packing == "POINT":
        columns = numbers[: nodes * len(names)].reshape(nodes, len(names)).T
    else:
        columns = np.split(numbers[: sum(lengths)], np.cumsum(lengths)[:-1])
    zone = Zone(title, {name: columns[k] for k, name in enumerate(names) if k not in in_cells})
    zone.cell_data = {names[k]: columns[k] for k in sorted(in_cells)}
    if shape == "ORDERED":
        zone.cells = _ordered_cells(sizes)
    else:
        connectivity = numbers[sum(lengths) :].reshape(cells, per_cell)
        bad = ~((connectivity >= 1) & (connectivity <= nodes))
        bad |= np.where(bad, 1, connectivity) % 1 != 0
        if bad.any():
            cell = int(np.argmax(bad.any(axis=1)))
            refuse(
                path,
                f"cell {cell + 1} of zone {title!r} names node {connectivity[cell][bad[cell]][0]:g}"
                f" of {nodes}",
                "the node count in its header is wrong, or the file is damaged",
                last,
            )
        zone.cells = [(CELLS[shape][0], connectivity.astype(np.int64) - 1)]
    return zone, place


def _count(path, settings, keys, start, title, default=None):
    for key in keys:
        if WHOLE.fullmatch(settings.get(key, "")):
            return int(settings[key])
    if default is None or any(key in settings for key in keys):
        refuse(path, f"zone {title!r} has no {keys[0]}= with a number", "export it with its header", start)
    return default


def _cell_centred(path, location, count, start):
    """Indices of the variables that VARLOCATION puts in cells: by number, or one word per variable."""
    found = set()
    if len(location) > LONGEST_LOCATION:
        refuse(path, f"VARLOCATION has {len(location)} characters", "export the file again", start)
    words = location.strip().strip("()").replace(",", " ").upper().split()
    if words and set(words) <= {"NODAL", "CELLCENTERED"}:
        found = {k for k, word in enumerate(words) if word == "CELLCENTERED"}
    for group, single, where in LOCATION.findall(location):
        for part in (group or single).split(","):
            numbers = SPAN.fullmatch(part)
            first, last = (int(numbers[1]), int(numbers[2] or numbers[1])) if numbers else (0, 0)
            if not 1 <= first <= last <= count:
                refuse(
                    path,
                    f"VARLOCATION names variable {quote(part)} of {count}",
                    "correct it, or export the file again",
                    start,
                )
            span = set(range(first - 1, last))
            found = found | span if where.upper() == "CELLCENTERED" else found - span
    return found


def _numbers(path, lines, place, wanted):
    """All numbers up to the next record, their count, the place after them, and their last line.

    No more than `wanted` are made out of repeated ones (400000000*1.0): None where there would be more.
    """
    part = []
    while place < len(lines) and not RECORDS.match(lines[place]):
        line = lines[place].strip()
        if line and not line.startswith("#"):
            part.append(place)
        place += 1
    text = " ".join(lines[k] for k in part).replace(",", " ")
    last = part[-1] + 1 if part else place
    if "*" in text:
        repeats = [int(found[1]) for found in REPEATED.finditer(text)]
        count = len(text.split()) + sum(repeats) - len(repeats)
        if count > wanted:
            return None, count, place, last
        text = REPEATED.sub(lambda found: " ".join([found[2]] * int(found[1])), text)
    try:
        numbers = np.array(FORTRAN_EXPONENT.sub(r"\1e\2", text).split(), dtype=float)
        return numbers, len(numbers), place, last
    except ValueError as reason:
        word = str(reason).rpartition(": ")[2].strip("'")
        line = next((k + 1 for k in part if word in lines[k]), last)
        refuse(path, f"{quote(word)} is not a number", "correct it, or export the file again", line)


def _ordered_cells(sizes):
    """Quadrilaterals or hexahedra of a block of I x J x K nodes, I running fastest."""
    used = [size for size in sizes if size > 1]
    return block_cells(used[::-1]) if len(used) > 1 else []
