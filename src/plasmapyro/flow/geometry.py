"""The torch, the chamber and the probe as a meridian half-plane, and its triangles.

Coordinates: z along the axis from the torch back wall, r from the axis. The flow domain is torch plus chamber
minus probe; a larger box around it carries the induced electric field.
"""

from dataclasses import dataclass

import numpy as np
from netgen.meshing import SetMessageImportance
from netgen.occ import Glue, MoveTo, OCCGeometry, WorkPlane
from skfem import MeshTri

from plasmapyro.checks import increasing, positive
from plasmapyro.flow.condition import WALLS

BOUNDARIES = ("inlet", "top", "outlet", *WALLS)
ON_LINE = 1e-7  # [m]: points nearer to a boundary line than this lie on it
BOX_MARGIN = 0.5  # [m], axially, each side
# ASSUME: E_p = 0 on the box r = 0.6 m, 5.5 coil radii; moving it from 0.4 m changed the power by 4e-5.
BOX_RADIUS = 0.6  # [m]
BOX_CELL = 0.08  # [m]
GRADING = 0.3
PROBE_SHAPES = ("hemisphere", "flat", "blunt", "none")
NO_PROBE = 1.0  # [m]: clearance where there is no probe, larger than any length that matters


@dataclass(frozen=True)
class Torch:
    """Lengths of the facility [m].

    `length`, `radius`: torch tube; `slot_inner_radius`: the annular inlet reaches from here to `radius`;
    `chamber_length`, `chamber_radius`: domain behind the torch exit; `probe_distance`: torch exit to nose;
    `probe_radius`: nose and shaft; `coil_radius`, `coil_positions`: rings in series.
    `probe_shape`: one of `PROBE_SHAPES`; a blunt nose is flat with a rounded shoulder of `shoulder_radius`
    (unused otherwise); with 'none', `probe_distance` only says where lines of sight start.
    """

    length: float
    radius: float
    slot_inner_radius: float
    chamber_length: float
    chamber_radius: float
    probe_distance: float
    probe_radius: float
    coil_radius: float
    coil_positions: tuple
    probe_shape: str = "hemisphere"
    shoulder_radius: float = 0.0

    def __post_init__(self):
        for name in self.__dataclass_fields__:
            if name not in ("coil_positions", "probe_shape", "shoulder_radius"):
                positive(name, getattr(self, name), "m")
        if self.probe_shape not in PROBE_SHAPES:
            raise ValueError(
                f"probe_shape must be one of {', '.join(PROBE_SHAPES)}; got '{self.probe_shape}'"
            )
        if self.probe_shape == "blunt" and not 0 < self.shoulder_radius < self.probe_radius:
            raise ValueError(
                f"shoulder_radius of a blunt probe must lie between 0 and probe_radius "
                f"{self.probe_radius:g} m; got {self.shoulder_radius:g} m"
            )
        increasing("coil_positions", self.coil_positions, "m")
        if not self.slot_inner_radius < self.radius < min(self.chamber_radius, self.coil_radius):
            raise ValueError(
                "radii must satisfy slot_inner_radius < radius < chamber_radius and coil_radius; got "
                f"{self.slot_inner_radius:g}, {self.radius:g}, {self.chamber_radius:g}, "
                f"{self.coil_radius:g} m"
            )
        if self.probe_distance + self.probe_radius >= self.chamber_length:
            raise ValueError(
                f"the probe nose must end inside the chamber; got {self.probe_distance:g} m + "
                f"{self.probe_radius:g} m >= {self.chamber_length:g} m"
            )

    @property
    def end(self):
        """Axial position of the downstream end of the domain [m]."""
        return self.length + self.chamber_length

    @property
    def nose(self):
        """Axial position of the stagnation point [m]."""
        return self.length + self.probe_distance

    @property
    def has_probe(self):
        """Whether a probe stands in the jet."""
        return self.probe_shape != "none"

    @property
    def shoulder(self):
        """Radius of curvature where the nose turns into the shaft [m]: 0 for a sharp edge."""
        return {"hemisphere": self.probe_radius, "blunt": self.shoulder_radius}.get(self.probe_shape, 0.0)

    def boundary_at(self, z, r):
        """Name of the boundary that holds the point (z, r); 'probe' if on no straight line of the outline."""
        if r < ON_LINE:
            return "axis"
        if abs(z) < ON_LINE:
            return "inlet" if r > self.slot_inner_radius else "back_wall"
        if abs(z - self.end) < ON_LINE:
            return "outlet"
        if abs(r - self.chamber_radius) < ON_LINE:
            return "top"
        if abs(r - self.radius) < ON_LINE and z < self.length:
            return "tube_wall"
        if abs(z - self.length) < ON_LINE and r > self.radius:
            return "chamber_wall"
        return "probe"

    def wall_clearance(self, z, r):
        """Distance from the walls of torch and probe [m], for points in the flow."""
        lip = np.hypot(z - self.length, r - self.radius)
        tube = np.where(z < self.length, np.minimum(z, self.radius - r), lip)
        return np.maximum(np.minimum(tube, self.probe_clearance(z, r)), 0.0)

    def probe_clearance(self, z, r):
        """Distance from the probe surface [m], for points outside the probe."""
        if not self.has_probe:
            return np.full(np.shape(z), NO_PROBE)
        ahead = self.nose + self.shoulder - z
        beside = r - (self.probe_radius - self.shoulder)
        corner = np.hypot(np.maximum(ahead, 0), np.maximum(beside, 0))
        return corner + np.minimum(np.maximum(ahead, beside), 0) - self.shoulder


# Cell sizes [m] at mesh_factor 1. The back wall (stagnating back-flow), the slot jet, the sheath and the
# probe nose carry steep gradients; the nose cells resolve the first 2 mm of the line of sight.
EDGE_CELL = {
    "inlet": 0.65e-3,
    "back_wall": 0.6e-3,
    "tube_wall": 2e-3,
    "chamber_wall": 8e-3,
    "top": 9e-3,
    "outlet": 8e-3,
    "probe": 0.2e-3,
    "nose": 0.1e-3,
    "shaft": 1.0e-3,
}
NOSE_CAP = 4e-3  # [m] along the probe from the stagnation point, where the cells of 'nose' apply
CORE_CELL = 5.3e-3


def _graded_regions(torch):
    """Rectangles (z0, r0, z1, r1 [m], cell [m]), the first that covers a point sets its cell size."""
    nose = (
        (torch.nose - 2.5e-3, 0.0, torch.nose + 0.5e-3, 2.5e-3, 0.25e-3),
        (torch.nose - 8e-3, 0.0, torch.nose + 4e-3, 8e-3, 0.9e-3),
    )
    return (
        *(nose if torch.has_probe else ()),
        (0.0, torch.radius - 0.012, 0.12, torch.radius, 1.8e-3),
        (0.10, torch.radius - 0.016, torch.length, torch.radius, 3.0e-3),
        (torch.length, torch.radius - 0.022, torch.length + 0.16, torch.radius + 0.023, 3.6e-3),
        (torch.nose - 0.03, 0.0, torch.nose + 0.03, 0.05, 2.2e-3),
        (torch.length + 0.16, 0.0, torch.end, 0.12, 5.0e-3),
    )


def _rectangle(z0, r0, z1, r1):
    return MoveTo(z0, r0).Rectangle(z1 - z0, r1 - r0).Face()


def _outline(torch):
    """Flow domain as one face, edges with their cell size."""
    path = WorkPlane().MoveTo(0, 0)
    if torch.has_probe:
        path.LineTo(torch.nose, 0)
        _probe_outline(path, torch)
        path.LineTo(torch.end, torch.probe_radius)
    else:
        path.LineTo(torch.end, 0)
    path.LineTo(torch.end, torch.chamber_radius)
    path.LineTo(torch.length, torch.chamber_radius).LineTo(torch.length, torch.radius)
    path.LineTo(0, torch.radius).LineTo(0, torch.slot_inner_radius).LineTo(0, 0)
    return path.Face()


def _probe_outline(path, torch):
    """Draw the nose from the stagnation point to the shaft; the cap is an edge of its own."""
    flat, shoulder = torch.probe_radius - torch.shoulder, torch.shoulder
    if flat > 0:
        cap = min(NOSE_CAP, flat / 2)
        path.LineTo(torch.nose, cap).LineTo(torch.nose, flat).Direction(0, 1)
        if shoulder > 0:
            path.Arc(shoulder, -90)
    else:
        cap = min(np.degrees(NOSE_CAP / shoulder), 45.0)
        path.Direction(0, 1).Arc(shoulder, -cap).Arc(shoulder, cap - 90)


def _shapes(torch, mesh_factor):
    """Flow parts and box, glued, each with its name and cell size."""
    outline = _outline(torch)
    for edge in outline.edges:
        middle = edge.center
        name = torch.boundary_at(middle.x, middle.y)
        if name == "probe" and np.hypot(middle.x - torch.nose, middle.y) < NOSE_CAP:
            name = "nose"
        elif name == "probe" and middle.x > torch.nose + torch.shoulder + ON_LINE:
            name = "shaft"
        if name in EDGE_CELL:
            edge.maxh = EDGE_CELL[name] * mesh_factor
    box = _rectangle(-BOX_MARGIN, 0, torch.end + BOX_MARGIN, BOX_RADIUS) - outline
    box.faces.name = "box"
    box.faces.maxh = BOX_CELL
    parts, rest = [], outline
    for z0, r0, z1, r1, cell in _graded_regions(torch):
        region = _rectangle(z0, r0, z1, r1)
        part = rest * region
        part.faces.maxh = cell * mesh_factor
        rest = rest - region
        parts.append(part)
    rest.faces.maxh = CORE_CELL * mesh_factor
    for part in (*parts, rest):
        part.faces.name = "flow"
    return Glue([*parts, rest, box])


def build_mesh(torch, mesh_factor):
    """Triangles of flow domain and box; `mesh_factor` > 0 multiplies every cell size of the flow domain.

    Subdomains 'flow' and 'box'; boundaries 'far' (outside of the box) and 'axis'. ASSUME: straight edges; the
    sagitta at the nose is 3 um for edges of 0.8 mm.
    """
    SetMessageImportance(0)
    geometry = OCCGeometry(_shapes(torch, float(positive("mesh_factor", mesh_factor, "1"))), dim=2)
    meshed = geometry.GenerateMesh(maxh=0.1, grading=GRADING)
    points = np.asarray(meshed.Coordinates())[:, :2]
    elements = meshed.Elements2D().NumPy()
    triangles = elements["nodes"][:, :3].astype(np.int64) - 1
    in_flow = np.array([meshed.GetMaterial(int(i)) != "box" for i in elements["index"]])
    return named_mesh(points.T, triangles.T, in_flow, torch)


def named_mesh(points, triangles, in_flow, torch):
    """Mesh of vertices (2, N) and triangles (3, F) with the names of `build_mesh`; `in_flow`: (F,) bool."""
    mesh = MeshTri(np.ascontiguousarray(points), np.ascontiguousarray(triangles))
    subdomains = {"flow": np.flatnonzero(in_flow), "box": np.flatnonzero(~in_flow)}
    sides = {
        "axis": lambda x: x[1] < ON_LINE,
        "far": lambda x: (
            (x[1] > BOX_RADIUS - ON_LINE)
            | (x[0] < -BOX_MARGIN + ON_LINE)
            | (x[0] > torch.end + BOX_MARGIN - ON_LINE)
        ),
    }
    return mesh.with_subdomains(subdomains).with_boundaries(sides)


def flow_mesh(mesh, torch):
    """The triangles of the subdomain 'flow' as a mesh of their own with named boundaries.

    Boundaries: `BOUNDARIES` and 'axis'. The order of the triangles is that of `mesh.subdomains['flow']`.
    """
    flow = mesh.restrict("flow")
    facets = flow.boundary_facets()
    middle = flow.p[:, flow.facets[:, facets]].mean(axis=1)
    names = np.array([torch.boundary_at(z, r) for z, r in middle.T])
    return MeshTri(flow.p, flow.t).with_boundaries(
        {name: facets[names == name] for name in ("axis", *BOUNDARIES)}
    )
