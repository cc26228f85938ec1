"""Grids with a known linear field, and the text of files that hold them, after the published layouts."""

from pathlib import Path

import numpy as np
import xarray as xr

FILES = Path(__file__).with_name("samples")
STATE = {"temperature": {"name": "T", "unit": "K"}, "pressure": {"name": "p", "unit": "Pa"}}


def temperature(x, y, z=0.0):
    """[K]; the field of every sample, also of the files."""
    return 1500 + 4000 * x + 9000 * y + 2000 * z


def pressure(x, y, z=0.0):
    """[Pa]"""
    return 5000 + 100 * x - 200 * y + 50 * z


def settings(geometry="axisymmetric", **changes):
    """A map as YAML gives it; None removes a key."""
    ray = {"origin": [0.29, 0.0], "direction": [-1.0, 0.3]}
    if geometry == "planar":
        ray = {"origin": [0.01, 0.0], "direction": [1.0, 0.3]}
    if geometry == "three_dimensional":
        ray = {"origin": [0.01, 0.01, 0.0], "direction": [1.0, 0.2, 0.2]}
    values = {
        "geometry": geometry,
        "length_unit": "m",
        "variables": dict(STATE),
        "species": "equilibrium",
        "ray": ray,
    }
    values.update(changes)
    return {key: value for key, value in values.items() if value is not None}


def along(path, mapping):
    """Coordinates (x, y, z) [m] of the points of a sight line; y the radius if axisymmetric."""
    count = len(mapping["ray"]["origin"])
    origin, direction = np.zeros(3), np.zeros(3)
    origin[:count], direction[:count] = mapping["ray"]["origin"], mapping["ray"]["direction"]
    x, y, z = (origin + np.outer(path.path_distance, direction / np.linalg.norm(direction))).T
    return (x, np.hypot(y, z), 0.0) if mapping["geometry"] == "axisymmetric" else (x, y, z)


def triangles(columns=7, rows=5, shear=0.05):
    """Nodes (N, 2) and triangles (M, 3) on 0.3 m x 0.1 m, the inner lines sheared."""
    x, y = np.meshgrid(np.linspace(0, 0.3, columns), np.linspace(0, 0.1, rows))
    x = x + shear * np.sin(np.pi * x / 0.3) * (y - 0.05)
    node = np.arange(x.size).reshape(x.shape)
    a, b, c, d = node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]
    cells = np.concatenate([np.stack(part, axis=-1).reshape(-1, 3) for part in ((a, b, c), (a, c, d))])
    return np.stack([x.ravel(), y.ravel()], axis=1), cells


def quads(columns=7, rows=5):
    """Nodes (N, 2) and quadrilaterals (M, 4) on the same rectangle."""
    points, _ = triangles(columns, rows)
    node = np.arange(columns * rows).reshape(rows, columns)
    corners = (node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1])
    return points, np.stack(corners, axis=-1).reshape(-1, 4)


def lines_of(values, per_line=10):
    """Numbers as COOLFluiD prints them: twelve digits, some per line."""
    words = [f"{value:.12e}" for value in values]
    return "\n".join(" ".join(words[k : k + per_line]) for k in range(0, len(words), per_line))


def tecplot_fepoint(points, cells, kind="TRIANGLE"):
    """The older dialect: node by node, F=FEPOINT, ET=."""
    rows = "\n".join(
        f"{x:.12e} {y:.12e} {pressure(x, y):.12e} 1.0 {temperature(x, y):.12e}" for x, y in points
    )
    names = "\n".join(" ".join(str(node + 1) for node in cell) for cell in cells)
    return (
        'TITLE = "Unstructured grid data"\nVARIABLES  =  "x0" "x1" "p" "u" "T"\n'
        f'ZONE   T="P0 ZONE0 Triag", N={len(points)}, E={len(cells)}, F=FEPOINT, ET={kind}, SOLUTIONTIME=0\n'
        f"{rows}\n{names}\n"
    )


def tecplot_block_zone(points, cells, number, shape, kind):
    """One zone of the newer dialect: blocks, values in cells, comment lines between the variables."""
    x, y = points[cells].mean(axis=1).T
    parts = {"x0": points[:, 0], "x1": points[:, 1], "p": pressure(x, y), "u": 0 * x, "T": temperature(x, y)}
    text = (
        f'ZONE   T="P0 ZONE{number} {shape}", STRANDID=1, SOLUTIONTIME=3200, N={len(points)}, E={len(cells)},'
        f' DATAPACKING=BLOCK, ZONETYPE={kind}, AUXDATA CPU="0", AUXDATA TRS="InnerCells",'
        f' AUXDATA Filename="flow.plt", AUXDATA ElementType="{shape}", AUXDATA Iter="3200",'
        ' AUXDATA PhysTime="0", VARLOCATION=( [1-2]=NODAL,[3-5]=CELLCENTERED)\n\n'
    )
    for name, values in parts.items():
        text += f"\n### variable {name}\n\n{lines_of(values)}\n"
    nodes = "\n".join(" ".join(str(node + 1) for node in cell) for cell in cells)
    return f"{text}\n\n### connectivity\n\n{nodes}\n"


def tecplot_block():
    """Two zones in blocks: quadrilaterals up to x = 0.15 m, triangles beyond."""
    text = 'TITLE      = "COOLFluiD Mesh Data"\nVARIABLES  =  "x0" "x1" "p" "u" "T"\n'
    for number, (maker, shape, kind) in enumerate(
        ((quads, "Quad", "FEQUADRILATERAL"), (triangles, "Triag", "FETRIANGLE"))
    ):
        points, cells = maker(9, 5)
        left = points[cells][:, :, 0].mean(axis=1) < 0.15
        cells = cells[left if shape == "Quad" else ~left]
        used, index = np.unique(cells, return_inverse=True)
        text += tecplot_block_zone(points[used], index.reshape(cells.shape), number, shape, kind)
    return text


def tecplot_blocks_of_one_zone(location=""):
    """FEBLOCK with VARLOCATION; without it all values stand at nodes."""
    points, cells = triangles()
    where = points[cells].mean(axis=1) if location else points
    blocks = [*points.T, pressure(*where.T), temperature(*where.T)]
    nodes = "\n".join(" ".join(str(node + 1) for node in cell) for cell in cells)
    return (
        f'TITLE = "t"\nVARIABLES = "x0", "x1", "p", "T"\n'
        f'ZONE T="a" N={len(points)} E={len(cells)} F=FEBLOCK ET=TRIANGLE {location}\n'
        + "\n".join(map(lines_of, blocks))
        + f"\n{nodes}\n"
    )


def vtk_grid(kind):
    """Legacy VTK text of a structured or a rectilinear grid of 7 x 5 nodes."""
    if kind == "STRUCTURED_GRID":
        points, _ = triangles()
        shape = f"POINTS {len(points)} double\n" + "\n".join(f"{x!r} {y!r} 0" for x, y in points.tolist())
    else:
        lines = np.linspace(0, 0.3, 7), np.linspace(0, 0.1, 5), np.zeros(1)
        points = np.stack([part.ravel() for part in np.meshgrid(*lines[:2])], axis=1)
        shape = "\n".join(
            f"{name}_COORDINATES {len(line)} double\n" + " ".join(map(repr, line.tolist()))
            for name, line in zip("XYZ", lines, strict=True)
        )
    fields = "\n".join(
        f"{name} 1 {len(points)} double\n" + "\n".join(map(repr, values.tolist()))
        for name, values in (("T", temperature(*points.T)), ("p", pressure(*points.T)))
    )
    return (
        f"# vtk DataFile Version 3.0\nflow\nASCII\nDATASET {kind}\nDIMENSIONS 7 5 1\n{shape}\n"
        f"POINT_DATA {len(points)}\nFIELD FieldData 2\n{fields}\n"
    )


def vtu_text(cells, types):
    """VTU in text with quadrilaterals of the rectangle under the numbers of VTK's cell types."""
    points, _ = triangles(shear=0.0)
    flat = np.concatenate([points, np.zeros((len(points), 1))], axis=1)

    def array(name, values, kind="Float64", extra=""):
        words = " ".join(map(repr, np.ravel(values).tolist()))
        return f'<DataArray type="{kind}" Name="{name}" format="ascii"{extra}>{words}</DataArray>'

    return (
        '<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">'
        f'<UnstructuredGrid><Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}"><PointData>'
        + array("T", temperature(*points.T))
        + array("p", pressure(*points.T))
        + "</PointData><CellData/><Points>"
        + array("Points", flat, extra=' NumberOfComponents="3"')
        + "</Points><Cells>"
        + array("connectivity", cells, "Int64")
        + array("offsets", 4 * np.arange(1, len(cells) + 1), "Int64")
        + array("types", types, "UInt8")
        + "</Cells></Piece></UnstructuredGrid></VTKFile>"
    )


def tecplot_ordered():
    """An ordered zone, point by point, counts I and J, Fortran exponents and repeat counts."""
    points, _ = triangles()
    rows = [f"{x:.12e} {y:.12e} 2*0.0 {pressure(x, y):.10e} {temperature(x, y):.10e}" for x, y in points]
    text = "\n".join(rows).replace("e+", "D+").replace("e-", "D-")
    return f"variables = x, y, u, v, p, T\nzone i=7, j=5, f=point\n{text}\n"


def su2_mesh(points, cells, code=5):
    """A mesh in SU2's own format, with a comment, node numbers at the line ends and string markers."""
    elements = "\n".join(f"{code} {' '.join(map(str, cell))} {k}" for k, cell in enumerate(cells))
    nodes = "\n".join(f"{' '.join(f'{x:.15e}' for x in point)} {k}" for k, point in enumerate(points))
    return (
        f"% torch, half plane\nNDIME= {points.shape[1]}\nNELEM= {len(cells)}\n{elements}\n"
        f"NPOIN= {len(points)}\n{nodes}\nNMARK= 1\nMARKER_TAG= wall\nMARKER_ELEMS= 1\n3 0 1\n"
    )


def su2_columns(points):
    """PointID, coordinates and values of a restart file."""
    x, y = points.T
    numbers = np.arange(len(points))
    return {"PointID": numbers, "x": x, "y": y, "Pressure": pressure(x, y), "Temperature": temperature(x, y)}


def su2_restart_text(points, order=None):
    columns = su2_columns(points)
    order = np.arange(len(points)) if order is None else order
    rows = [
        ", ".join(
            f"{columns[name][k]:.0f}" if name == "PointID" else f"{columns[name][k]:.15e}" for name in columns
        )
        for k in order
    ]
    return ", ".join(f'"{name}"' for name in columns) + "\n" + "\n".join(rows) + "\n"


def su2_restart_binary(points):
    """Magic number, counts, names of 33 bytes, doubles, then the iteration and eight doubles."""
    columns = {name: values for name, values in su2_columns(points).items() if name != "PointID"}
    head = np.array([535532, len(columns), len(points), 1, 8], dtype="<i4").tobytes()
    names = b"".join(name.encode().ljust(33, b"\0") for name in columns)
    table = np.stack(list(columns.values()), axis=1).astype("<f8").tobytes()
    return head + names + table + np.array([250], dtype="<i4").tobytes() + np.zeros(8).tobytes()


def scattered(points):
    """Comma separated points in no order, with a comment."""
    order = np.random.default_rng(3).permutation(len(points))
    rows = [f"{x},{y},{pressure(x, y)},{temperature(x, y)}" for x, y in points[order]]
    return "# a line of comment\nx,y,p,T\n" + "\n".join(rows) + "\n"


def quadratic_flow(temperature_of, columns=20, rows=8, length=0.3, radius=0.1):
    """Dataset of contract 'flow', as far as a sight line needs it, with six-node triangles."""
    z, r = np.meshgrid(np.linspace(0, length, 2 * columns + 1), np.linspace(0, radius, 2 * rows + 1))
    node = np.arange(z.size).reshape(z.shape)

    def part(dj, di):
        return node[dj : 2 * rows + dj - 1 : 2, di : 2 * columns + di - 1 : 2].ravel()

    a, b, c, d = part(0, 0), part(0, 2), part(2, 2), part(2, 0)
    ab, bc, cd, da, ac = part(0, 1), part(1, 2), part(2, 1), part(1, 0), part(1, 1)
    corner = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    middle = np.concatenate([np.stack([ab, bc, ac], axis=1), np.stack([ac, cd, da], axis=1)])
    z, r = z.ravel(), r.ravel()
    return xr.Dataset(
        {
            "node_z": ("node", z),
            "node_r": ("node", r),
            "face_node": (("face", "corner"), corner),
            "face_midnode": (("face", "corner"), middle),
            "temperature": ("node", temperature_of(z, r)),
            "pressure": ("node", pressure(z, r)),
            "axial_velocity": ("node", 10 * z),
            "radial_velocity": ("node", -5 * r),
            "joule_heating": ("node", 1e6 * r),
        },
        attrs={"stagnation_point_z": length},
    )
