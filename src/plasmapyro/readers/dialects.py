"""Lines of a table out of files of another form: arrays, Igor text, LabVIEW, recorders, archives."""

import csv
import json
import re
from collections import Counter
from itertools import zip_longest
from pathlib import Path

import numpy as np

from plasmapyro import foreign
from plasmapyro.readers import clock, units
from plasmapyro.readers.text import BINARY, NUMBER, Refusal, number, quote, read_lines, refuse, regular_file

ARRAYS = {".mat", ".h5", ".hdf5", ".nc", ".cdf", ".npz", ".json", ".jsonl", ".ndjson"}
LARGEST = 1_000_000_000  # [byte] of a file of arrays
MOST_COLUMNS = 50  # of one array
ENOUGH = 3  # arrays: a time and two signals
LOOKED_AT = 50  # first lines, of which some show the habit
ATTACHED = re.compile(rf"\s*({NUMBER.pattern})\s*([A-Za-z\u00b5\u03bc]{{1,4}})\s*", re.ASCII)
MARKS = "\t;,"
PAIR = re.compile(rf"\b([A-Za-z_]\w*)\s*[=:]\s*({NUMBER.pattern})(?![\w.:])", re.ASCII)
STAMP = re.compile(r"\s*[\d:./T-]*\d{1,2}:\d{2}:\d{2}[.,\d]*", re.ASCII)
LONGEST_OF_PAIRS = 2_000_000  # lines
PART = re.compile(r" \d+$")  # of the name of one column of an array of two dimensions
# Columns of an archive of values: what a value is of, the value, its unit; WinCC counts days in millionths.
OF_WHAT = re.compile(
    r"(var|tag|signal|channel|point|sensor)[ _]?(name|id)?|name|kanal|metric|_?field", re.IGNORECASE
)
VALUE = re.compile(r"(var|tag|raw)?[ _]?(value|wert)|reading|messwert", re.IGNORECASE)
UNNAMED = "first column"
TIME, DAYS = re.compile("time|zeit|date|datum", re.IGNORECASE), "Time_ms"


def table_lines(path, limit, wanted=()):
    """Lines of a table, as `read_lines` gives them; a file of another form is written as one.

    Of Matlab, HDF5, netCDF, numpy and JSON files the arrays as long as those called as `wanted`, else of the
    most frequent length (the longest of those that three or more have), are columns by their names. Igor
    text: its waves are. LabVIEW measurements without a column of times get one from their interval, as do
    records of Yokogawa; readings with their unit behind each number ('+1.06E-05A') have it in the header,
    lines of names and numbers ('t=0.5 wide=1e-5') and archives of one value a line become rows. Refusal as
    `read_lines`; or a file of arrays that is damaged, holds no columns, or needs a package.
    """
    if Path(path).suffix.lower() in ARRAYS:
        return _columns(path, _arrays(regular_file(path, LARGEST)), wanted), True
    lines, ended = read_lines(path, limit)
    if not lines:  # nothing but a byte order mark
        return lines, ended
    if lines[0].strip().upper() == "IGOR":
        return _igor(path, lines), True
    head = lines[:LOOKED_AT]
    if any(map(re.compile(r"\*\*\*End|X_Columns\W+No\b").match, head)):
        lines = _labview(lines)
    if any("TraceName" in line for line in head):
        lines = _recorder(lines)
    return _detached(_of_pairs(_archive(path, _aligned(lines)))), ended


def _columns(path, arrays, wanted):
    """Tab-separated lines of those arrays that are as long as the wanted ones, or most; names with units."""
    asked = {name: len(values) for name, (values, _) in arrays.items() if name in wanted}
    if len(set(asked.values())) > 1:
        listed = ", ".join(f"{name} {count}" for name, count in asked.items())
        refuse(
            path, f"holds arrays of different lengths: {listed}", "save time and signals of the same samples"
        )
    plain = {name: pair for name, pair in arrays.items() if not PART.search(name)}
    arrays = plain if len(plain) > 1 else arrays
    sizes = [len(values) for values, _ in arrays.values() if len(values) > 1]
    if len(sizes) < 2:
        listed = ", ".join(arrays) or "none"
        refuse(
            path, f"holds no two columns of numbers of one length ({listed})", "save time and signals in it"
        )
    size = max(set(sizes), key=lambda one: (min(sizes.count(one), ENOUGH), one))
    size = next(iter(asked.values()), size)
    kept = {
        f"{name} [{unit}]" if unit else name: np.asarray(values, dtype=float).tolist()
        for name, (values, unit) in arrays.items()
        if len(values) == size
    }
    rows = ("\t".join(map(repr, row)) for row in zip(*kept.values(), strict=True))
    return ["\t".join(" ".join(name.split()) for name in kept), *rows]


def _arrays(path):
    """Name -> (values, unit or None) of the one-dimensional arrays of a file."""
    with open(path, "rb") as file:
        begin = file.read(8)
    kind = next((one for one in (b"\x89HDF", b"MATLAB 5", b"CDF") if begin.startswith(one)), None)
    try:
        with foreign.memory_for(path):
            if path.suffix.lower() == ".json":
                return _of_json(json.loads("\n".join(read_lines(path, LARGEST)[0])))
            if path.suffix.lower() in (".jsonl", ".ndjson"):
                return _of_json([json.loads(line) for line in read_lines(path, LARGEST)[0] if line.strip()])
            if path.suffix.lower() == ".npz":
                with np.load(path, allow_pickle=False) as found:
                    return _flat(dict(found))
            if kind == b"\x89HDF":
                if found := foreign.elsewhere(path):
                    refuse(path, *found)
                return _of_hdf5(path)
            if kind == b"MATLAB 5":
                from scipy.io import loadmat

                found = loadmat(path, squeeze_me=True, struct_as_record=True)
                return _flat({name: value for name, value in found.items() if not name.startswith("__")})
            if kind == b"CDF":
                from scipy.io import netcdf_file

                with netcdf_file(path, mmap=False) as file:
                    held = file.variables.items()
                    return {
                        name: (one[:].copy(), _word(getattr(one, "units", None)))
                        for name, one in held
                        if len(one.shape) == 1 and one[:].dtype.kind in "fiu"
                    }
    except Refusal:
        raise
    except MemoryError:
        refuse(path, "asks for more memory than its size allows", "save it again")
    except Exception as reason:  # noqa: BLE001  libraries raise anything on a damaged file
        refuse(path, f"cannot be read ({foreign.told(reason)})", "save it again")
    known = next((words for one, words in BINARY.items() if begin.startswith(one)), None)
    refuse(
        path,
        f"is {known[0]}" if known else "is not what its name says",
        "save it again, or export it as text",
    )


def _word(value):
    value = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
    return value.strip() or None if isinstance(value, str) else None


def _flat(found, above=""):
    """Columns of numbers in nested structures: name -> (values, None)."""
    columns = {}
    for name, value in found.items():
        value, name = np.asarray(value), above + name
        if value.dtype.names and value.ndim < 2:  # a structure, or a table whose rows are such
            columns |= _flat({key: value[key][()] for key in value.dtype.names}, f"{name}.")
        elif value.dtype.kind == "O" and value.ndim == 0:
            inner = value[()]
            columns |= _flat({"": inner}, name) if not np.asarray(inner).dtype.kind == "O" else {}
        elif value.dtype.kind in "fiu" and value.ndim == 2 and 1 in value.shape:
            columns[name] = value.ravel(), None
        elif value.dtype.kind in "fiu" and value.ndim == 1:
            columns[name] = value, None
        elif value.dtype.kind in "fiu" and value.ndim == 2 and min(value.shape) <= MOST_COLUMNS:
            rows = value if value.shape[0] < value.shape[1] else value.T
            columns |= {f"{name} {place}": (row, None) for place, row in enumerate(rows, 1)}
    return columns


def _of_hdf5(path):
    import h5py

    columns = {}
    with h5py.File(path, "r", locking=False) as file:

        def look(name, node):
            if isinstance(node, h5py.Dataset) and (node.dtype.kind in "fiu" or node.dtype.names):
                unit = _word(node.attrs.get("units", node.attrs.get("unit")))
                for label, (values, _) in _flat({name: node[()]}).items():
                    columns[label] = values, unit

        file.visititems(look)
    return columns


def _level(row):
    """A mapping with the entries of the mappings within it as its own: 'payload.wide'."""
    parts = ({f"{key}.{k}": v for k, v in _level(one).items()} if isinstance(one, dict) else {key: one}
             for key, one in row.items())  # fmt: skip
    return {key: one for part in parts for key, one in part.items()}


def _of_json(found):
    if isinstance(found, list) and found and all(isinstance(row, dict) for row in found):
        found = [_level(row) for row in found]
        found = {name: [row.get(name) for row in found] for name in found[0]}
    columns = {}
    for name, values in found.items() if isinstance(found, dict) else ():
        if isinstance(values, dict):
            columns |= {f"{name}.{key}": pair for key, pair in _of_json(values).items()}
        elif isinstance(values, list) and values and all(isinstance(one, dict) for one in values):
            for one in values:  # channels: a name, perhaps a unit, and the data
                label, unit = one.get("name", name), _word(one.get("unit", one.get("units")))
                held = [numbers for numbers, _ in _of_json({k: v for k, v in one.items()}).values()]
                columns |= {str(label): (held[0], unit)} if len(held) == 1 else {}
        elif isinstance(values, list) and all(one is None or type(one) in (int, float) for one in values):
            columns[name] = np.array([np.nan if one is None else one for one in values], dtype=float), None
    return columns


def _igor(path, lines):
    """Igor text (Igor Pro manual, Igor Text File Format): blocks of waves; times may be their scale."""
    columns, names, inside = {}, [], False
    scales = {}
    for line in map(str.strip, lines[1:]):
        upper = line.upper()
        if upper.startswith("WAVES"):
            words = re.sub(r"^WAVES\S*", "", line, flags=re.IGNORECASE)
            names = [name.strip("'") for name in re.split(r"[\s,]+", words.strip())]
            columns |= {name: [] for name in names}
        elif upper == "BEGIN":
            inside = True
        elif upper == "END":
            inside = False
        elif inside:
            for name, cell in zip(names, line.split(), strict=False):
                columns[name].append(cell)
        elif upper.startswith("X "):
            for command in re.findall(
                r'SetScale\s*(/P)?\s*([xyd])\s*,?\s*([^,]+),([^,]+),\s*"([^"]*)"\s*,\s*(.+?)(?:;|$)',
                line,
                re.I,
            ):
                for name in command[5].split(","):
                    scales[command[1].lower(), name.strip().strip("'")] = command
    sizes = {len(cells) for cells in columns.values()}
    if len(sizes) != 1 or not columns:
        refuse(path, f"holds waves of {len(sizes)} lengths", "export waves of one length")
    heads = [
        f"{name} [{scales['d', name][4]}]" if scales.get(("d", name), "     ")[4].strip() else name
        for name in columns
    ]
    rows = list(zip(*columns.values(), strict=True))
    step = next((one for (kind, _), one in scales.items() if kind == "x" and one[0] and one[4] == "s"), None)
    if step and not any(name.lower().startswith("t") for name in columns):
        first, each = float(step[2]), float(step[3])
        heads, rows = ["time [s]", *heads], [(repr(first + i * each), *row) for i, row in enumerate(rows)]
    return ["\t".join(heads), *("\t".join(row) for row in rows)]


def _of_pairs(lines):
    """Lines of the same two or more names, each with its number, as a table of them."""
    pairs = [PAIR.findall(line) for line in lines]
    keys = [name for name, _ in pairs[len(pairs) // 2]]
    if len(set(keys)) < 2 or len(lines) > LONGEST_OF_PAIRS:
        return lines
    stamped = [STAMP.match(line) for line in lines]
    rows = [
        ["" if stamp is None else stamp[0], *(value for _, value in found)]
        for found, stamp in zip(pairs, stamped, strict=True)
        if [name for name, _ in found] == keys
    ]
    if 2 * len(rows) < len(lines):
        return lines
    return ["\t".join(["clock", *keys]), *("\t".join(row) for row in rows)]


def _labview(lines):
    """The table of a LabVIEW measurement, with units in its header, and with times if it has none."""
    head = next((i for i, line in enumerate(lines[:LOOKED_AT]) if line.startswith("X_Value\t")), None)
    if head is None:
        return lines
    keys = {line.partition("\t")[0]: line.split("\t") for line in lines[:head]}
    names, stated = lines[head].split("\t"), keys.get("Y_Unit_Label", [])
    names = [f"{name} [{unit}]" if unit else name for name, unit in zip_longest(names, stated[: len(names)])]
    body = lines[head + 1 :]
    if any(line.startswith("\t") for line in body[:1]):
        try:
            first, step = (float(keys[key][1].replace(",", ".")) for key in ("X0", "Delta_X"))
        except (KeyError, IndexError, ValueError):
            return lines
        sign = "," if "," in keys["Delta_X"][1] else "."
        body = [f"{first + i * step:.9g}".replace(".", sign) + line for i, line in enumerate(body)]
    again = {place for place, name in enumerate(names) if place and name.startswith("X_Value")}
    if again:  # each channel has times of its own; the same ones for all are kept once
        rows = [line.split("\t") for line in body]
        if all(row[place] == row[0] for row in rows for place in again & {*range(len(row))}):
            body, names = (
                ["\t".join(cell for place, cell in enumerate(row) if place not in again) for row in rows],
                [name for place, name in enumerate(names) if place not in again],
            )
    return [*[""] * head, "\t".join(["X_Value [s]", *names[1:]]), *body]


def _aligned(lines):
    """Lines of a table whose names stand one column beside their cells, put right.

    R leaves out the name of the column of row names, which is dropped; other programs begin the line of names
    with a delimiter, or leave out the name of times. What only counts the rows is no time.
    """
    start = next((i for i, line in enumerate(lines[:LOOKED_AT]) if re.search(r"[^\W\d]", line)), 0)
    name, body = lines[start], lines[start + 1 : start + 1 + LOOKED_AT]
    mark = next((one for one in MARKS if one in name), " ")
    width = len(name.split(mark))
    cells = [line.split(mark) for line in body]
    if len(body) < 2 or width < 2:
        return lines
    if not name.split(mark)[0].strip() and mark != " " and {len(row) for row in cells} == {width - 1}:
        return [*lines[:start], name.partition(mark)[2], *lines[start + 1 :]]
    if not name.split(mark)[0].strip(' "') and {len(row) for row in cells} == {width}:
        begins = [row[0].strip(' "') for row in cells]
        if not all(begin.isdigit() for begin in begins) and all(begins):  # times as the index of a table
            return [*lines[:start], f"{UNNAMED}{mark}{name.partition(mark)[2]}", *lines[start + 1 :]]
    numbered = [row[0].strip('"') for row in cells] == [str(i) for i in range(1, len(cells) + 1)]
    if numbered and {len(row) for row in cells} == {width + 1} and all(row[-1].strip() for row in cells):
        return [*lines[: start + 1], *(line.partition(mark)[2] for line in lines[start + 1 :])]
    return lines


def _recorder(lines):
    """The table of a record of Yokogawa (DL series): a header of keys, then rows without times."""
    rows = [_cells(line, ",") for line in lines[:LOOKED_AT]]
    keys = {row[0]: row[1:] for row in rows if row[0]}
    body = [line for line in lines if line.startswith(",")]
    try:
        first, step = (float(keys[key][0]) for key in ("HOffset", "HResolution"))
        names = [f"{name} [{unit}]" for name, unit in zip(keys["TraceName"], keys["VUnit"], strict=True)]
        head = [f"time [{keys['HUnit'][0]}]", *names]
    except (KeyError, IndexError, ValueError):
        return lines
    above = [""] * (len(lines) - len(body) - 1)  # numbers of lines stay, where blocks do not part them
    return [*above, ",".join(head), *(f"{first + i * step:.12g}{line}" for i, line in enumerate(body))]


def _archive(path, lines):
    """The table of an archive of one value a line, with the name of what it is of (WinCC, KickStart)."""
    for line in lines[:LOOKED_AT]:
        mark = next((one for one in MARKS if one in line), None)
        names = _cells(line, mark) if mark else []
        which = [[i for i, name in enumerate(names) if form.fullmatch(name)] for form in (OF_WHAT, VALUE)]
        if all(len(found) == 1 for found in which):
            break
    else:
        return lines
    (what,), (value,) = which
    unit = next((i for i, name in enumerate(names) if name.lower() in ("unit", "einheit")), None)
    rows = [_cells(one, mark) for one in lines[lines.index(line) + 1 :]]
    rows = [row for row in rows if len(row) == len(names)]
    seen = Counter(row[what] for row in rows)
    most = max(seen.values(), default=0)
    if not 2 <= len(seen) <= MOST_COLUMNS or most < 2:
        return lines
    of = {name: [row for row in rows if row[what] == name] for name in seen if 2 * seen[name] > most}
    first, *others = of  # what is logged now and then, as alarms are, is left out
    times = [i for i, name in enumerate(names) if TIME.search(name) or clock.looks_like_stamp(rows[0][i])]
    times = [i for i in times if len({row[i] for row in rows}) > 1]
    for name in others:
        for one, other in zip(of[first], of[name], strict=False):
            if apart := [i for i in times if one[i] != other[i]]:
                when = f"({one[apart[-1]]} and {other[apart[-1]]})"
                what = f"{quote(first)} and {quote(name)} are logged at moments of their own {when}"
                refuse(path, what, "export both at the same moments, one row per moment")
    times = [i for i in times if names[i] == DAYS] or times
    heads = ["Time [d]" if names[i] == DAYS else names[i] for i in times]
    heads += [f"{name} [{held[0][unit]}]" if unit is not None else name for name, held in of.items()]
    body = (
        [_in_days(group[0][i]) if names[i] == DAYS else group[0][i] for i in times]
        + [row[value] for row in group]
        for group in zip(*of.values(), strict=False)
    )
    return ["\t".join(row) for row in [heads, *body]]


def _cells(line, mark):
    try:
        return next(csv.reader([line], delimiter=mark), [""]) or [""]
    except csv.Error:  # a cell longer than csv takes
        return line.split(mark)


def _in_days(word):
    sign = "," if "," in word else "."
    found = number(word, sign)
    return word if found is None else repr(found / 1e6).replace(".", sign)


def _detached(lines):
    """Lines whose readings carry their units, with the units in the header; all become those of the first."""
    for i, line in enumerate(lines[:LOOKED_AT]):
        mark = next((one for one in MARKS if one in line), None)
        cells = [ATTACHED.fullmatch(cell) for cell in line.split(mark)] if mark else []
        held = [cell and units.is_unit(cell[2]) for cell in cells]
        plain = (
            number(cell) is not None or clock.looks_like_stamp(cell)
            for cell, has in zip(line.split(mark), held, strict=True)
            if not has
        )
        if any(held) and all(plain) and i:
            names = [name.strip().strip('"') for name in lines[i - 1].split(mark)]
            if len(names) != len(cells):
                return lines
            names = [
                f"{name} [{cell[2]}]" if has and "[" not in name else name
                for name, cell, has in zip(names, cells, held, strict=True)
            ]
            body = [
                mark.join(
                    _in_unit(word, cell[2]) if has else word
                    for word, cell, has in zip(row.split(mark), cells, held, strict=False)
                )
                for row in lines[i:]
            ]
            return [*lines[: i - 1], mark.join(names), *body]
    return lines


def _in_unit(word, unit):
    """A reading ('990 nA') as a number in another unit of the same kind; the word itself where it is none."""
    found = ATTACHED.fullmatch(word)
    if not found or found[2] == unit:
        return found[1] if found else word
    own, other = units.normalised(found[2]), units.normalised(unit)
    known = next((each for each in units.TO_SI.values() if own in each and other in each), None)
    return word if known is None else f"{float(found[1]) * known[own] / known[other]:.12g}"
