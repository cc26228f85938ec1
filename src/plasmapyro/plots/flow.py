"""Figures of the flow field and of what the line of sight crosses."""

import numpy as np
from matplotlib.tri import Triangulation

from plasmapyro.plots import style


def temperature_field(flow, sightline, paths):
    """Figure 4a: temperature in torch and chamber, with the line of sight as far as the domain holds it."""
    drawing, axes = style.figure(size=(7.2, 2.5))
    z, r = flow.node_z.values * 1e3, flow.node_r.values * 1e3
    triangles = Triangulation(z, r, _quarters(flow.face_node.values, flow.face_midnode.values))
    lower = Triangulation(z, -r, triangles.triangles)
    temperature = flow.temperature.values
    scale = {
        "cmap": "inferno",
        "vmin": 300,
        "vmax": temperature.max(),
        "shading": "gouraud",
        "rasterized": True,
    }
    for half in (triangles, lower):
        image = axes.tripcolor(half, temperature, **scale)
    drawing.colorbar(image, ax=axes, label="Temperature [K]", pad=0.01)
    inside = sightline.path_distance.values <= sightline.attrs["exit_distance"]
    axes.plot(
        sightline.axial_position.values[inside] * 1e3,
        sightline.radial_position.values[inside] * 1e3,
        color="cyan",
        lw=1,
        ls="--",
        label=r"line of sight $\zeta$",
    )
    axes.legend(loc="upper left", labelcolor="cyan")
    axes.set(xlabel="Axial position $z$ [mm]", ylabel="Radial position $r$ [mm]", aspect="equal")
    axes.grid(False)
    power = float(flow.numerical_power) / 1e3
    axes.set_title(f"air, {flow.chamber_pressure / 100:.0f} mbar, {power:g} kW", loc="left", fontsize=8)
    style.mark_origin(axes, flow)
    style.save(drawing, paths)


def _quarters(corner, middle):
    """Split each six-node triangle into four three-node ones."""
    a, b, c = corner.T
    ab, bc, ca = middle.T
    return np.concatenate(
        [np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    )


def line_of_sight(sightlines, numerical_power, paths):
    """Figure 4b: temperature and pressure along the line of sight, one line per power.

    Parameters
    ----------
    sightlines : mapping of condition -> Dataset, contract 'sightline', rising power
    numerical_power : sequence of float [W]
    paths : paths of the files to write
    """
    drawing, (upper, lower) = style.figure(size=(4.3, 3.6), nrows=2, height_ratios=(2, 1))
    labels = style.case_labels(sightlines, numerical_power)
    for sightline, colour, label in zip(
        sightlines.values(), style.case_colours(len(labels)), labels, strict=True
    ):
        path = sightline.path_distance * 1e3
        upper.plot(path, sightline.temperature, color=colour, label=label)
        lower.plot(path, sightline.pressure / 1e3, color=colour)
    upper.axvspan(0, 5, color="0.9", zorder=0)
    upper.annotate("5 mm", (6, 200), fontsize=6, color="0.4")
    style.legend_beside(upper)
    upper.set(xlim=(0, 200), xlabel=r"Path distance $\zeta$ [mm]", ylabel="Temperature [K]")
    lower.axvline(1e3 * sightline.attrs["window_distance"], color="0.5", lw=0.7)
    lower.annotate("window", (790, 40), ha="right", fontsize=7)
    lower.set(xlim=(0, 1000), yscale="log", xlabel=r"Path distance $\zeta$ [mm]", ylabel="Pressure [kPa]")
    style.mark_origin(upper, *sightlines.values())
    style.save(drawing, paths)
