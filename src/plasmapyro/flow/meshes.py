"""The meshes of one torch: made once, handed on in the file of the cold start, and rebuilt where it has none.

Netgen needs 5 s for the three meshes of the error estimate, which are the same at every condition.
"""

import numpy as np

from plasmapyro.flow.geometry import build_mesh, named_mesh

SAME_FACTOR = 1e-9  # relative


class Meshes:
    """Function mesh_factor -> mesh as from `geometry.build_mesh`; `known`: pairs of both."""

    def __init__(self, torch, known=()):
        self._torch, self._known = torch, list(known)

    def __call__(self, mesh_factor):
        for factor, mesh in self._known:
            if abs(factor - mesh_factor) <= SAME_FACTOR * mesh_factor:
                return mesh
        mesh = build_mesh(self._torch, mesh_factor)
        self._known.append((mesh_factor, mesh))
        return mesh


def meshes_of(dataset, torch):
    """Meshes of `torch`, those among them that a flow dataset holds."""
    if "solver_mesh_factor" not in dataset:
        return Meshes(torch)
    vertices = np.stack([dataset.solver_vertex_z.values, dataset.solver_vertex_r.values])
    triangles = dataset.solver_triangle.values.T.astype(np.int64)
    in_flow = dataset.solver_triangle_flow.values == 1
    known = []
    for index, factor in enumerate(dataset.solver_mesh_factor.values):
        own = dataset.solver_triangle_mesh.values == index
        points = vertices[:, dataset.solver_vertex_mesh.values == index]
        known.append((float(factor), named_mesh(points, triangles[:, own], in_flow[own], torch)))
    return Meshes(torch, known)


def mesh_variables(meshes, factors):
    """Variables of contract 'flow' that hold the meshes of some factors, for `meshes_of`."""
    found = [meshes(factor) for factor in factors]
    in_flow = [np.isin(np.arange(mesh.nelements), mesh.subdomains["flow"]) for mesh in found]
    z, r = np.concatenate([mesh.p for mesh in found], axis=1)

    def numbered(sizes):
        return np.repeat(np.arange(len(found), dtype=np.int8), sizes)

    return {
        "solver_mesh_factor": ("solver_mesh", np.array(factors, dtype=float)),
        "solver_vertex_mesh": ("solver_vertex", numbered([mesh.nvertices for mesh in found])),
        "solver_vertex_z": ("solver_vertex", z),
        "solver_vertex_r": ("solver_vertex", r),
        "solver_triangle_mesh": ("solver_face", numbered([mesh.nelements for mesh in found])),
        "solver_triangle_flow": ("solver_face", np.concatenate(in_flow).astype(np.int8)),
        "solver_triangle": (
            ("solver_face", "corner"),
            np.concatenate([mesh.t for mesh in found], axis=1).T.astype(np.int32),
        ),
    }
