"""From the zones of a file to one field of simplices with the mapped variables in SI."""

from difflib import get_close_matches

import numpy as np
from scipy.spatial import Delaunay, QhullError

from plasmapyro.cfd import cgns, columns, su2, tecplot, vtk_files
from plasmapyro.cfd.grid import AXES, DIMENSION, LOWER, OTHER_CELLS, kept_cells, simplices_of
from plasmapyro.cfd.nodes import to_nodes
from plasmapyro.foreign import PACKED, memory_for
from plasmapyro.readers.text import quote, refuse, regular_file
from plasmapyro.sightline.trace import Field

ENDINGS = {
    ".vtu": "vtk",
    ".vtk": "vtk",
    ".dat": "tecplot",
    ".tec": "tecplot",
    ".plt": "tecplot",
    ".tp": "tecplot",
    ".cgns": "cgns",
    ".csv": "points",
    ".txt": "points",
    ".out": "table",
    ".srun": "table",
}
READERS = {
    "vtk": vtk_files.read,
    "tecplot": tecplot.read,
    "cgns": cgns.read,
    "points": columns.read,
    "table": columns.read,
}
OTHER_PROGRAMS = (".pvtu", ".pvd", ".vtm", ".vts", ".vtr", ".vti", ".szplt", ".foam", ".cas", ".h5", ".exo")
LARGEST = 8_000_000_000  # [byte]
SHOWN = 25  # names that a message lists
SIDE = 1e-9  # of the extent: nodes nearer to the mirror plane or the axis than this lie on it


def read_zones(path, mapping, mesh=None):
    """Zones of a file that a `Mapping` selects; `mesh`: path of the SU2 mesh, or None.

    Refusal as of the readers; also if the kind of file is not known, or a zone that is named is not there.
    """
    ending = "." + str(path).lower().rpartition(".")[2]
    kind = mapping.format or ("su2" if mesh else ENDINGS.get(ending))
    if ending == ".su2":
        refuse(path, "is a mesh, not a solution", "give the restart file, and the mesh as `mesh`")
    if kind is None and ending in OTHER_PROGRAMS:
        refuse(
            path,
            f"is of a kind that is not read ({ending})",
            "save it as one .vtu file (ParaView reads most kinds)",
        )
    if kind is None:
        refuse(path, f"is of a kind that its name does not tell ({ending})", "state `format` in the map")
    try:
        with memory_for(regular_file(mesh or path, LARGEST)):
            zones = su2.read(path, mesh) if kind == "su2" else READERS[kind](path)
    except MemoryError:
        refuse(path, "asks for far more memory than a file of its size can need", PACKED)
    if not mapping.zones:
        return zones
    chosen = []
    for wanted in mapping.zones:
        found = [zone for number, zone in enumerate(zones, 1) if wanted in (zone.name, number)]
        if not found:
            known = ", ".join(f"{number}: {zone.name!r}" for number, zone in enumerate(zones, 1))
            refuse(path, f"has no zone {wanted!r}", f"zones are {known}")
        chosen += found
    return chosen


def wanted_names(mapping):
    """Quantity -> Source of all that is read from the file: variables, then species."""
    return {**mapping.variables, **{f"species {name}": part for name, part in mapping.species.items()}}


def build(zones, mapping, path):
    """One `Field` of triangles or tetrahedra from the zones of a file, by a `Mapping`.

    Coordinates (axial, radial), (x, y) or (x, y, z) [m] by its geometry; values in SI, keys as in
    `wanted_names`. Refusal: a name that the file does not hold, and a file without cells of the right
    dimension.
    """
    dimension = len(mapping.coordinates)
    parts = [part for zone in zones if (part := _zone_field(zone, mapping, path, dimension)) is not None]
    if not parts:
        kinds = sorted({kind for zone in zones for kind, _ in zone.cells})
        refuse(
            path,
            f"holds no cells of a {mapping.geometry} field (kinds: {', '.join(kinds) or 'none'})",
            "correct `geometry` in the map, or export the volume and not its surface",
        )
    starts = np.cumsum([0, *(len(part.points) for part in parts)])[:-1]
    points = np.concatenate([part.points for part in parts])
    simplices = np.concatenate([part.simplices + start for part, start in zip(parts, starts, strict=True)])
    middles = np.concatenate(
        [
            np.where(part.middles < 0, -1, part.middles + start)
            for part, start in zip(parts, starts, strict=True)
        ]
    )
    values = {name: np.concatenate([part.values[name] for part in parts]) for name in parts[0].values}
    field = Field(points, simplices, middles, values)
    if mapping.geometry == "axisymmetric":
        field = _upper_half(field, path)
    for name, place in mapping.mirror.items():
        field = _mirrored(field, AXES.index(name), place, path)
    return field


def table(zones, mapping, path):
    """Columns of a table without cells, in SI: the distance [m] where the map names it, and the variables."""
    zone = zones[0]
    found = {}
    if mapping.geometry == "profile":
        found["distance"] = (
            _column(zone, mapping.coordinates[0], "coordinates.distance", path) * mapping.length
        )
    rows = len(next(iter(zone.point_data.values()), ()))
    for quantity, source in wanted_names(mapping).items():
        found[quantity] = _si(zone, source, quantity, rows, path)
    return found


def _si(zone, source, quantity, count, path):
    """Values (count,) of a quantity in SI."""
    if source.name is None:
        return source.si(np.full(count, float(source.value)))
    return source.si(_column(zone, source.name, quantity, path))


def _zone_field(zone, mapping, path, dimension):
    """Field of one zone, or None if it has no cells of that dimension."""
    coordinates = [
        _column(zone, name, f"coordinates ({name})", path) * mapping.length for name in mapping.coordinates
    ]
    points = np.stack(coordinates, axis=1)
    if not np.isfinite(points).all():
        node = int(np.argmax(~np.isfinite(points).all(axis=1)))
        refuse(path, f"node {node + 1} of zone {zone.name!r} has no finite coordinates", "export it again")
    if not zone.cells and zone.name == "table":
        zone.cells = [_triangulated(points, mapping.largest_cell, path)]
    _require_readable(zone, dimension, path)
    kept = [block for block in kept_cells(zone, dimension) if len(block[1])]
    if not kept:
        return None
    _require_whole(zone, kept, len(points), path)
    values, in_cells = {}, {}
    for quantity, source in wanted_names(mapping).items():
        if source.name is not None and source.name not in zone.point_data and source.name in zone.cell_data:
            data = zone.cell_data[source.name]  # of all cells, in one array or one per kind
            whole = np.concatenate(data) if isinstance(data, list) else data
            in_cells[quantity] = source.si(whole[np.concatenate([index for _, _, index in kept])])
        else:
            values[quantity] = _si(zone, source, quantity, len(points), path)
    if in_cells:
        blocks = [connectivity for _, connectivity, _ in kept]
        at_nodes = to_nodes(points, blocks, np.stack(list(in_cells.values()), axis=1))
        values |= dict(zip(in_cells, at_nodes.T, strict=True))
    cut = [simplices_of(kind, connectivity, points) for kind, connectivity, _ in kept]
    simplices, middles = (np.concatenate(part) for part in zip(*cut, strict=True))
    return Field(points, simplices, middles, {name: values[name] for name in wanted_names(mapping)})


def _require_readable(zone, dimension, path):
    """Refuse cells that would be left out and leave a hole, and surfaces of a volume taken for a plane."""
    for kind, connectivity in zone.cells:
        if not len(connectivity) or kind in LOWER:
            continue
        if kind not in DIMENSION:
            refuse(path, f"zone {zone.name!r} holds cells of kind {kind}, which are not read", OTHER_CELLS)
        if DIMENSION[kind] > dimension:
            refuse(
                path,
                f"zone {zone.name!r} holds volumes ({kind}), not a plane",
                "set `geometry: three_dimensional`, or export a slice",
            )


def _require_whole(zone, kept, count, path):
    """Refuse cells that name nodes, and data that belong to cells, that the zone does not have."""
    for kind, connectivity, _ in kept:
        bad = (connectivity < 0) | (connectivity >= count)
        if bad.any():
            cell = int(np.argmax(bad.any(axis=1)))
            refuse(
                path,
                f"{kind} {cell + 1} of zone {zone.name!r} names node {connectivity[cell][bad[cell]][0] + 1}"
                f" of {count}",
                "the file is damaged; export it again",
            )
    cells = sum(len(connectivity) for _, connectivity in zone.cells)
    for name, values in zone.cell_data.items():
        found = sum(map(len, values)) if isinstance(values, list) else len(values)
        if found != cells:
            refuse(
                path, f"{name} has {found} values for {cells} cells", "the file is damaged; export it again"
            )


def _column(zone, name, quantity, path):
    """Values at nodes of a name in the file."""
    if name in zone.point_data:
        values = np.asarray(zone.point_data[name], dtype=float)
        first = next(iter(zone.point_data.values()))
        if len(values) != len(first):
            refuse(path, f"{name} has {len(values)} values for {len(first)} nodes", "export the file again")
        return values
    if name in zone.words:
        refuse(path, zone.words[name], "correct it, or name another column")
    known = [*zone.point_data, *zone.cell_data, *zone.words]
    near = get_close_matches(name, known, n=1)
    listed = ", ".join(map(quote, known[:SHOWN])) + (", ..." if len(known) > SHOWN else "")
    hint = f"did you mean {quote(near[0])}? It" if near else "it"
    refuse(path, f"has no variable {quote(name)} ({quantity})", f"{hint} holds {listed}")


def _triangulated(points, largest_cell, path):
    """Delaunay triangles or tetrahedra of scattered points, those with a longer edge left out."""
    try:
        simplices = Delaunay(points).simplices.astype(np.int64)
    except (QhullError, ValueError) as reason:
        words = str(reason).splitlines()[0]
        refuse(path, f"points cannot be joined to triangles ({words})", "give points that span the field")
    if largest_cell is not None:
        corners = points[simplices]
        edges = corners - np.roll(corners, 1, axis=1)
        longest = np.linalg.norm(edges, axis=2).max(axis=1)
        if points.shape[1] == 3:
            across = np.linalg.norm(corners[:, [0, 1]] - corners[:, [2, 3]], axis=2).max(axis=1)
            longest = np.maximum(longest, across)
        simplices = simplices[longest <= largest_cell]
    return ("triangle" if points.shape[1] == 2 else "tetra"), simplices


def _upper_half(field, path):
    """Cells on one side of the axis, the distance from it positive."""
    radial = field.points[:, 1]
    side = SIDE * max(np.abs(field.points).max(), np.finfo(float).tiny)
    if radial.min() >= -side:
        kept = slice(None)
    else:
        centre = radial[field.simplices].mean(axis=1)
        upper = centre > 0 if radial.max() > side else centre < 0
        kept = np.flatnonzero(upper)
        if (np.sign(np.where(np.abs(radial) > side, radial, 0))[field.simplices[kept]] < 0).any() and (
            radial.max() > side
        ):
            refuse(path, "cells of the axisymmetric field lie across its axis", "give one half of the plane")
    points = np.stack([field.points[:, 0], np.abs(radial)], axis=1)
    return Field(points, field.simplices[kept], field.middles[kept], field.values)


def _mirrored(field, axis, place, path):
    """The field and its mirror image at the plane where coordinate `axis` is `place`."""
    offset = field.points[:, axis] - place
    side = 1e-6 * max(np.ptp(field.points[:, axis]), np.finfo(float).tiny)
    if offset.min() < -side and offset.max() > side:
        refuse(path, f"lies on both sides of the mirror plane {AXES[axis]} = {place:g} m", "correct `mirror`")
    image = field.points.copy()
    image[:, axis] = place - offset
    count = len(field.points)
    return Field(
        np.concatenate([field.points, image]),
        np.concatenate([field.simplices, field.simplices + count]),
        np.concatenate([field.middles, np.where(field.middles < 0, -1, field.middles + count)]),
        {key: np.concatenate([value, value]) for key, value in field.values.items()},
    )
