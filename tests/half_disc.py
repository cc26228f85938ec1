"""An invented flow field on triangles with middles: temperature a function of the distance from one point."""

import numpy as np
import xarray as xr

POINT = 1.0  # [m] on the axis


def flow(temperature, distance, centre=POINT, rays=241):
    """A flow field about `centre` [m]: temperature(distance) [K] on the nodes of shells (D,) [m]."""
    angle = np.linspace(0.0, np.pi, rays)
    d, a = np.meshgrid(distance, angle, indexing="ij")
    z, r = (centre - d * np.cos(a)).ravel(), (d * np.sin(a)).ravel()
    number = np.arange(z.size).reshape(d.shape)
    one, two, three, four = (
        part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    )
    corner = np.concatenate([np.stack([one, two, three], 1), np.stack([one, three, four], 1)])
    sides = np.sort(np.stack([corner, np.roll(corner, -1, axis=1)], -1), axis=-1)
    ends, place = np.unique(sides.reshape(-1, 2), axis=0, return_inverse=True)
    z, r = (np.concatenate([values, values[ends].mean(axis=1)]) for values in (z, r))
    away = np.clip(np.hypot(centre - z, r), distance[0], distance[-1])
    return xr.Dataset(
        {
            "node_z": ("node", z),
            "node_r": ("node", r),
            "temperature": ("node", temperature(away)),
            "face_node": (("face", "corner"), corner),
            "face_midnode": (("face", "corner"), d.size + place.reshape(-1, 3)),
        },
        attrs={"stagnation_point_z": POINT},
    )
