"""CGNS files in HDF5: structured and unstructured zones, solutions at vertices or in cells."""

import h5py
import numpy as np

from plasmapyro.cfd.grid import DIMENSION, Zone, block_cells, known_as
from plasmapyro.foreign import elsewhere, told
from plasmapyro.readers.text import Refusal, refuse, regular_file

LARGEST = 8_000_000_000  # [byte]
CELLS = {int(number): cell for number, cell in known_as("CGNS").items()}  # as the standard numbers them
NODE, MIXED = 2, 20
DATA = " data"


def read(path):
    """Zones of a CGNS file; coordinates CoordinateX ... are also named x, y, z.

    Refusal: no HDF5, no zone, a cut-off file, data in other files, more claimed than the file can hold, or
    cells that are not read (polyhedra).

    Source: CGNS Standard Interface Data Structures 4.4 and its File Mapping to HDF5.
    """
    path = regular_file(path, LARGEST)
    try:
        if found := elsewhere(path):
            refuse(path, *found)
        with h5py.File(path, "r") as file:
            bases = _labelled(file, "CGNSBase_t")
            dimension = int(_data(bases[0])[0]) if bases else 0
            zones = [_zone(path, node, dimension) for base in bases for node in _labelled(base, "Zone_t")]
    except (Refusal, MemoryError):
        raise
    except Exception as reason:  # a damaged file lacks nodes anywhere in its tree
        refuse(
            path,
            f"cannot be read as CGNS in HDF5 ({told(reason)})",
            "it may be cut off, or in the older ADF layout: convert it with adf2hdf",
        )
    if not zones:
        refuse(path, "holds no zone", "export it with its grid and solution")
    return zones


def _labelled(group, label):
    """Children of a node with a label, in the order of their names."""
    return [
        node
        for node in group.values()
        if hasattr(node, "values") and _text(node.attrs.get("label", b"")) == label
    ]


def _text(value):
    return bytes(value).split(b"\0")[0].decode("ascii") if not isinstance(value, str) else value


def _data(node):
    return node[DATA][()]


def _zone(path, node, dimension):
    name = node.name.rpartition("/")[2]
    coordinates = [
        (title, _data(part))
        for grid in _labelled(node, "GridCoordinates_t")
        for title, part in grid.items()
        if DATA in part
    ]
    points = {}
    for title, values in coordinates:
        points[title] = values.ravel()
        if title.startswith("Coordinate") and len(title) == len("CoordinateX"):
            points[title[-1].lower()] = values.ravel()
    kinds = _labelled(node, "ZoneType_t")
    structured = bool(kinds) and _data(kinds[0]).tobytes().startswith(b"Structured")
    zone = Zone(name, points)
    count = len(next(iter(points.values()))) if points else 0
    if structured and points:
        zone.cells = block_cells(coordinates[0][1].shape)
    else:
        zone.cells = _sections(path, node, dimension)
    cell_count = sum(len(cells) for kind, cells in zone.cells if DIMENSION.get(kind) == dimension)
    for solution in _labelled(node, "FlowSolution_t"):
        places = _labelled(solution, "GridLocation_t")
        in_cells = bool(places) and _data(places[0]).tobytes().startswith(b"CellCenter")
        for title, part in solution.items():
            if _text(part.attrs.get("label", b"")) != "DataArray_t":
                continue
            values = _data(part).ravel()
            wanted = cell_count if in_cells else count
            if len(values) != wanted:
                refuse(
                    path,
                    f"{title} of zone {name!r} has {len(values)} values for {wanted}"
                    f" {'cells' if in_cells else 'nodes'}",
                    "the file is damaged, or has rind cells: export it without",
                )
            (zone.cell_data if in_cells else zone.point_data)[title] = values
    zone.cells = [(kind, cells) for kind, cells in zone.cells if DIMENSION.get(kind) == dimension]
    return zone


def _sections(path, node, dimension):
    """Cells of an unstructured zone in the order of their numbers."""
    sections = sorted(
        _labelled(node, "Elements_t"), key=lambda part: int(_data(part["ElementRange"]).ravel()[0])
    )
    cells = []
    for section in sections:
        number = int(_data(section).ravel()[0])
        connectivity = _data(section["ElementConnectivity"]).ravel().astype(np.int64)
        if number == MIXED:
            blocks = _mixed(connectivity)
        elif number in CELLS:
            kind, size = CELLS[number]
            blocks = [(kind, connectivity.reshape(-1, size) - 1)]
        elif number == NODE:
            blocks = []
        else:
            refuse(
                path, f"holds cells of type {number} (polyhedra)", "export triangles, tetrahedra or bricks"
            )
        cells += [(kind, block) for kind, block in blocks if DIMENSION.get(kind, 1) == dimension]
    return cells


def _mixed(connectivity):
    """Runs of cells of one kind from a list of type and nodes, cell by cell."""
    blocks, place = [], 0
    while place < len(connectivity):
        kind, size = CELLS[int(connectivity[place])]
        nodes = connectivity[place + 1 : place + 1 + size] - 1
        if not blocks or blocks[-1][0] != kind:
            blocks.append((kind, []))
        blocks[-1][1].append(nodes)
        place += 1 + size
    return [(kind, np.array(nodes)) for kind, nodes in blocks]
