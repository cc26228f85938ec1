"""Our own flow as a file that ParaView and other programs open."""

import meshio
import numpy as np

from plasmapyro import io

SCALARS = ("temperature", "pressure", "joule_heating")


def write_vtu(flow, path):
    """Write a flow field as a VTK XML unstructured grid (.vtu), whole or not at all (`io.store`).

    Six-node triangles with x axial, y radial, z = 0 [m]; `temperature` [K], `pressure` [Pa], `velocity` [m
    s-1], `joule_heating` [W m-3] at the nodes. The same flow gives the same bytes.
    """
    flat = np.zeros(flow.sizes["node"])
    points = np.stack([flow["node_z"].values, flow["node_r"].values, flat], axis=1)
    velocity = np.stack([flow["axial_velocity"].values, flow["radial_velocity"].values, flat], axis=1)
    cells = np.concatenate([flow["face_node"].values, flow["face_midnode"].values], axis=1)
    data = {**{name: flow[name].values for name in SCALARS}, "velocity": velocity}
    mesh = meshio.Mesh(points, [("triangle6", cells.astype(np.int64))], point_data=data)
    io.store(path, lambda part: meshio.vtu.write(str(part), mesh))


def write_vtus(flows, paths):
    """Write several flow fields (see `write_vtu`), each to its path."""
    for flow, path in zip(flows, paths, strict=True):
        write_vtu(flow, path)
