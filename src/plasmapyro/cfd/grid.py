"""Zones of a foreign grid, and their cells cut into triangles or tetrahedra."""

from dataclasses import dataclass, field

import numpy as np

from plasmapyro.sightline import trace
from plasmapyro.tables import rows

AXES = ("x", "y", "z")
# nodes in the order of VTK, CGNS and Tecplot alike
CELLS = {row["kind"]: row for row in rows("cfd/cells.csv")}


def _lists(words):
    """Lists of indices, as a cell of the table holds them."""
    return tuple(tuple(map(int, part.split())) for part in words.split(";"))


def known_as(program):
    """What a program calls the cells that it may hold -> kind, number of nodes."""
    named = ((row[program], row) for row in CELLS.values() if row[program])
    return {name: (row["kind"], int(row["nodes"])) for name, row in named}


DIMENSION = {kind: int(row["dimension"]) for kind, row in CELLS.items() if row["dimension"] != "1"}
# The simplices that fill a cell; a curved one with middle nodes is cut at them.
SIMPLICES = {kind: _lists(row["filled by"]) for kind, row in CELLS.items() if row["filled by"]}
# ASSUME: of other cells with middle nodes the corners are used; the field is then linear between them.
CORNERS_OF = {kind: row["corners as"] for kind, row in CELLS.items() if row["corners as"]}
# Corners that each middle node of a quadratic cell lies between.
EDGES = {"triangle6": trace.EDGES[3], "tetra10": trace.EDGES[4]}
LOWER = ("vertex", "line", "line3")  # kinds of points and lines: no part of a field
OTHER_CELLS = (
    "cut the cells into triangles or tetrahedra (in ParaView: Filters, Tetrahedralize) and save again"
)
STRAIGHT = 1e-6  # middle nodes nearer to the middle of their edge than this part of its length
FLAT = 1e-12  # simplices smaller than this part of the cube of their longest edge are nothing


@dataclass
class Zone:
    """Part of a grid.

    `cells` : list of (kind, connectivity (M, k)), kinds of VTK as meshio names them, indices from 0
    `point_data` : name -> (N,), the coordinates among them
    `cell_data` : name -> (cells of all kinds in their order,)
    `words` : name of a column that holds words -> what is wrong with it
    """

    name: str
    point_data: dict
    cells: list = field(default_factory=list)
    cell_data: dict = field(default_factory=dict)
    words: dict = field(default_factory=dict)


def kept_cells(zone, dimension):
    """Cells of a zone of one dimension as (kind, connectivity, indices in the zone's cell data)."""
    first = 0
    for kind, connectivity in zone.cells:
        index = np.arange(first, first + len(connectivity))
        first += len(connectivity)
        if DIMENSION.get(kind) == dimension:
            yield kind, connectivity, index


def block_cells(shape):
    """Cells of a structured block of nodes; the last index of `shape` runs fastest."""
    node = np.arange(np.prod(shape)).reshape(shape)
    if len(shape) == 2:
        corners = (node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1])
        return [("quad", np.stack([corner.ravel() for corner in corners], axis=1))]
    corners = [
        part
        for layer in (node[:-1], node[1:])
        for part in (layer[:, :-1, :-1], layer[:, :-1, 1:], layer[:, 1:, 1:], layer[:, 1:, :-1])
    ]
    return [("hexahedron", np.stack([corner.ravel() for corner in corners], axis=1))]


def simplices_of(kind, connectivity, points):
    """Simplices (S, d + 1) of cells (M, k) of one kind, and their middle nodes (S, edges), -1 for none.

    Cells with straight edges and middle nodes stay whole; those with curved edges are cut at their middle
    nodes. Simplices without volume (degenerate cells) are left out.
    """
    dimension = DIMENSION[kind]
    edge_count = len(EDGES["triangle6" if dimension == 2 else "tetra10"])
    if kind in CORNERS_OF:
        kind = CORNERS_OF[kind]
        connectivity = connectivity[:, : int(CELLS[kind]["nodes"])]
    whole = np.empty((0, dimension + 1), dtype=np.int64)
    middles = np.empty((0, edge_count), dtype=np.int64)
    if kind in EDGES:
        straight = _straight(kind, connectivity, points)
        whole, middles = connectivity[straight, : dimension + 1], connectivity[straight, dimension + 1 :]
        connectivity = connectivity[~straight]
    cut = np.concatenate([connectivity[:, list(corners)] for corners in SIMPLICES[kind]])
    simplices = np.concatenate([whole, cut])
    middles = np.concatenate([middles, np.full((len(cut), edge_count), -1)])
    kept = _relative_volume(points, simplices) > FLAT
    return simplices[kept], middles[kept]


def _straight(kind, connectivity, points):
    """Which quadratic cells have their middle nodes in the middle of straight edges."""
    edges = EDGES[kind]
    corner = points[connectivity]
    start, end = corner[:, [a for a, _ in edges]], corner[:, [b for _, b in edges]]
    off = np.linalg.norm(corner[:, -len(edges) :] - (start + end) / 2, axis=2)
    return (off <= STRAIGHT * np.linalg.norm(end - start, axis=2)).all(axis=1)


def _relative_volume(points, simplices):
    """Volume (area) of simplices times d!, over the d-th power of their longest edge from corner 0."""
    edges = points[simplices[:, 1:]] - points[simplices[:, :1]]
    longest = np.linalg.norm(edges, axis=2).max(axis=1)
    volume = np.abs(np.linalg.det(edges))
    scale = np.where(longest > 0, longest, 1.0) ** edges.shape[2]
    return np.where(longest > 0, volume / scale, 0.0)
