"""Lines of a table out of files of another form: arrays of Matlab and HDF5, Igor text, LabVIEW."""

import json
import re
from itertools import zip_longest
from pathlib import Path

import numpy as np

from plasmapyro import foreign
from plasmapyro.readers import units
from plasmapyro.readers.text import BINARY, NUMBER, Refusal, number, read_lines, refuse, regular_file

ARRAYS = {".mat", ".h5", ".hdf5", ".nc", ".cdf", ".npz", ".json", ".jsonl", ".ndjson"}
LARGEST = 1_000_000_000  # [byte] of a file of arrays
MOST_COLUMNS = 50  # of one array
LOOKED_AT = 50  # first lines, of which some show the habit
ATTACHED = re.compile(rf"\s*({NUMBER.pattern})\s*([A-Za-z\u00b5\u03bc]{{1,4}})\s*", re.ASCII)
MARKS = "\t;,"
PAIR = re.compile(rf"\b([A-Za-z_]\w*)\s*[=:]\s*({NUMBER.pattern})(?![\w.:])", re.ASCII)
STAMP = re.compile(r"\s*[\d:./T-]*\d{1,2}:\d{2}:\d{2}[.,\d]*", re.ASCII)
LONGEST_OF_PAIRS = 2_000_000  # lines
PART = re.compile(r" \d+$")  # of the name of one column of an array of two dimensions


def table_lines(path, limit):
    """Lines of a table, as `read_lines` gives them; a file of another form is written as one.

    Of Matlab, HDF5, netCDF, numpy and JSON files the arrays of the most frequent length, by their names, are
    columns. Igor text: its waves are. LabVIEW measurements without a column of times get one from their
    interval, readings with their unit behind each number ('+1.06E-05A') have it in the header, and lines of
    names and numbers ('t=0.5 wide=1e-5') become rows.

    Raises
    ------
    Refusal
        As `read_lines`; or a file of arrays that is damaged, holds no columns, or needs a package.
    """
    if Path(path).suffix.lower() in ARRAYS:
        return _columns(path, _arrays(regular_file(path, LARGEST))), True
    lines, ended = read_lines(path, limit)
    if not lines:  # nothing but a byte order mark
        return lines, ended
    if lines[0].strip().upper() == "IGOR":
        return _igor(path, lines), True
    head = lines[:LOOKED_AT]
    if any(map(re.compile(r"\*\*\*End|X_Columns\W+No\b").match, head)):
        lines = _labview(lines)
    return _detached(_of_pairs(lines)), ended


def _columns(path, arrays):
    """Tab-separated lines of those arrays that are as long as most are; names with their units."""
    plain = {name: pair for name, pair in arrays.items() if not PART.search(name)}
    arrays = plain if len(plain) > 1 else arrays
    sizes = [len(values) for values, _ in arrays.values() if len(values) > 1]
    if len(sizes) < 2:
        listed = ", ".join(arrays) or "none"
        refuse(
            path, f"holds no two columns of numbers of one length ({listed})", "save time and signals in it"
        )
    size = max(set(sizes), key=lambda one: (sizes.count(one), one))
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
        if value.dtype.names and value.ndim == 0:
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
            if isinstance(node, h5py.Dataset) and node.dtype.kind in "fiu":
                unit = _word(node.attrs.get("units", node.attrs.get("unit")))
                for label, (values, _) in _flat({name: node[()]}).items():
                    columns[label] = values, unit

        file.visititems(look)
    return columns


def _of_json(found):
    if isinstance(found, list) and found and all(isinstance(row, dict) for row in found):
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
    return [*[""] * head, "\t".join(["X_Value [s]", *names[1:]]), *body]


def _detached(lines):
    """Lines whose readings carry their units, with the units in the header."""
    for i, line in enumerate(lines[:LOOKED_AT]):
        mark = next((one for one in MARKS if one in line), None)
        cells = [ATTACHED.fullmatch(cell) for cell in line.split(mark)] if mark else []
        held = [cell and units.is_unit(cell[2]) for cell in cells]
        plain = (
            number(cell) is not None for cell, has in zip(line.split(mark), held, strict=True) if not has
        )
        if any(held) and all(plain) and i:
            names = lines[i - 1].split(mark)
            if len(names) != len(cells):
                return lines
            names = [
                f"{name} [{cell[2]}]" if has and "[" not in name else name
                for name, cell, has in zip(names, cells, held, strict=True)
            ]
            body = [
                mark.join(
                    found[1] if has and (found := ATTACHED.fullmatch(word)) and found[2] == cell[2] else word
                    for word, cell, has in zip(row.split(mark), cells, held, strict=False)
                )
                for row in lines[i:]
            ]
            return [*lines[: i - 1], mark.join(names), *body]
    return lines
