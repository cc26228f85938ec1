"""SU2: the mesh in its own text, the solution as restart file, text or binary."""

from pathlib import Path

import numpy as np

from plasmapyro.cfd.grid import AXES, Zone, known_as
from plasmapyro.readers.text import WHOLE, quote, read_lines, refuse, regular_file

LARGEST = 2_000_000_000  # [byte]
CELLS = {int(number): cell for number, cell in known_as("VTK").items()}  # SU2 numbers them like VTK
BINARY_MARK = 535532
NAME_LENGTH = 33  # bytes of a name in a binary restart file
HEADER = 5  # whole numbers at its beginning


def read(path, mesh):
    """The zone of a restart file on its mesh; coordinates x, y (, z) of the mesh.

    Refusal: a file that is cut off or breaks the layout, and a restart file of another mesh.
    """
    if mesh is None:
        refuse(path, "is the solution alone", "name the SU2 mesh it was computed on (`mesh`)")
    zone = read_mesh(mesh)
    values = _read_binary(path) if _is_binary(path) else _read_text(path)
    count = len(zone.point_data["x"])
    found = len(next(iter(values.values())))
    if found != count:
        refuse(path, f"holds {found} points, the mesh {mesh} has {count}", "give the mesh of this solution")
    zone.point_data = {**values, **zone.point_data}
    return [zone]


def read_mesh(path):
    """Cells and points of an SU2 mesh; markers are left out."""
    lines, _ = read_lines(path, LARGEST)
    rows = [
        (number, line.split("%")[0].strip())
        for number, line in enumerate(lines, 1)
        if line.split("%")[0].strip()
    ]
    at = {}
    for place, (_, words) in enumerate(rows):
        key, mark, value = words.partition("=")
        if mark and key.strip() not in at:
            at[key.strip()] = (place, value.split())
    for key in ("NDIME", "NELEM", "NPOIN"):
        if key not in at or not at[key][1] or not WHOLE.fullmatch(at[key][1][0]):
            refuse(path, f"has no line {key}= with a number", "it may be cut off, or no SU2 mesh")
    dimension = int(at["NDIME"][1][0])
    points = np.array(_points(path, rows, at, dimension))
    kinds = {}
    for number, words in _words(path, rows, at, "NELEM"):
        kind, count = CELLS.get(int(words[0]) if WHOLE.fullmatch(words[0]) else -1, (None, 0))
        named = words[1 : 1 + count]
        if kind is None or len(named) < count or not all(map(WHOLE.fullmatch, named)):
            refuse(path, f"{quote(' '.join(words))} is no cell", "correct the line", number)
        nodes = list(map(int, named))
        if max(nodes) >= len(points):
            refuse(
                path, f"a cell names point {max(nodes)} of {len(points)}", "NPOIN and NELEM disagree", number
            )
        kinds.setdefault(kind, []).append(nodes)
    cells = [(kind, np.array(nodes)) for kind, nodes in kinds.items()]
    return Zone("su2", {name: points[:, k] for k, name in enumerate(AXES[:dimension])}, cells)


def _words(path, rows, at, key):
    place, value = at[key]
    count = int(value[0])
    part = rows[place + 1 : place + 1 + count]
    whole = [(number, words.split()) for number, words in part if "=" not in words]
    if len(whole) < count:
        refuse(path, f"{key}= {count} but {len(whole)} lines follow", "the file is cut off; copy it again")
    return whole


def _points(path, rows, at, dimension):
    found = []
    for number, words in _words(path, rows, at, "NPOIN"):
        try:
            found.append([float(words[k]) for k in range(dimension)])
        except (ValueError, IndexError):
            refuse(path, f"{quote(' '.join(words))} holds no {dimension} numbers", "correct the line", number)
    return found


def _is_binary(path):
    path = regular_file(path, LARGEST)
    with open(path, "rb") as file:
        return np.frombuffer(file.read(4).ljust(4, b"\0"), "<i4")[0] == BINARY_MARK


def _read_binary(path):
    content = Path(path).read_bytes()
    _, fields, points = np.frombuffer(content[: 4 * HEADER], "<i4")[:3]
    start = 4 * HEADER + NAME_LENGTH * int(fields)
    end = start + 8 * int(fields) * int(points)
    if fields < 1 or points < 1 or len(content) < end:
        refuse(
            path,
            f"is {len(content)} bytes long, its header asks for {end} or more",
            "the file is cut off; copy it again",
        )
    names = [
        content[at : at + NAME_LENGTH].split(b"\0")[0].decode("latin-1").strip().strip('"')
        for at in range(4 * HEADER, start, NAME_LENGTH)
    ]
    table = np.frombuffer(content[start:end], "<f8").reshape(int(points), int(fields))
    return {name: table[:, k] for k, name in enumerate(names)}


def _read_text(path):
    lines, _ = read_lines(path, LARGEST)
    mark = "," if "," in lines[0] else None
    names = [word.strip().strip('"') for word in lines[0].split(mark)]
    rows = [(number, line) for number, line in enumerate(lines[1:], 2) if line.strip()]
    if "PointID" not in names or not rows:
        refuse(
            path, "has no header with PointID and values below it", "give an SU2 restart file (.csv or .dat)"
        )
    table = np.empty((len(rows), len(names)))
    for place, (number, line) in enumerate(rows):
        words = line.split(mark)
        if len(words) == len(names):
            try:
                table[place] = [float(word) for word in words]
                continue
            except ValueError:
                pass
        if words[0].strip().isidentifier() or "=" in line:
            table = table[:place]  # older files end with lines such as EXT_ITER= 250
            break
        refuse(
            path,
            f"{len(names)} numbers expected; got {quote(line)}",
            "the file may be cut off; copy it again",
            number,
        )
    order = np.argsort(table[:, names.index("PointID")], kind="stable")
    return {name: table[order, k] for k, name in enumerate(names)}
