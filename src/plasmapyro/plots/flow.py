"""Figures of the flow field and of what the line of sight crosses."""

from dataclasses import dataclass

import numpy as np
from matplotlib.tri import Triangulation

from plasmapyro.plots import style

PIXEL = 0.8  # [mm] of the fields drawn for every condition
STREAM_EVERY = 4  # pixels between the samples that streamlines are drawn from
STREAM_DENSITY = (0.9, 0.4)
EXACT = {"interpolation": "none"}  # pixels as they are, several times faster
SHORT_BAR = 0.85  # colour bars as long as the axes, which their aspect shrinks
FAINT = 0.5  # [%], a share that no eye finds in its bar
PARTS = {  # boundaries whose power the balance shows, and their colours
    "outlet": ("jet, at the outlet", "#f28e2b"),
    "back_wall": ("back wall", "#4e79a7"),
    "probe": ("probe", "#59a14f"),
    "tube_wall": ("tube wall", "#af7aa1"),
    "others": ("other boundaries", "#9c9c9c"),
}


def temperature_field(flow, sightline, paths):
    """Figure 5a: temperature in torch and chamber, with the line of sight as far as the domain holds it."""
    drawing, axes = style.figure(size=(7.2, 2.5))
    upper, temperature = _mesh(flow), flow.temperature.values
    lower = Triangulation(upper.x, -upper.y, upper.triangles)
    scale = {"cmap": "inferno", "vmin": 300, "vmax": temperature.max(), "shading": "gouraud"}
    for half in (upper, lower):
        image = axes.tripcolor(half, temperature, rasterized=True, **scale)
    drawing.colorbar(image, ax=axes, label="Temperature [K]", pad=0.01)
    _sight_line(axes, sightline)
    axes.legend(loc="upper left", labelcolor="0.3")
    axes.set(xlabel="Axial position $z$ [mm]", ylabel="Radial position $r$ [mm]", aspect="equal")
    axes.grid(False)
    axes.set_title(_named(flow), loc="left", fontsize=8)
    style.save(axes, paths, flow)


def _sight_line(axes, sightline):
    """The line of sight as far as the domain holds it."""
    inside = sightline.path_distance.values <= sightline.attrs["exit_distance"]
    place = (1e3 * sightline[name].values[inside] for name in ("axial_position", "radial_position"))
    axes.plot(*place, color="cyan", lw=1, ls="--", label=r"line of sight $\zeta$")


def _mesh(flow):
    """Mesh [mm] of a flow, each triangle of six nodes split into four of three."""
    a, b, c = flow.face_node.values.T
    ab, bc, ca = flow.face_midnode.values.T
    quarters = [np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return Triangulation(flow.node_z.values * 1e3, flow.node_r.values * 1e3, np.concatenate(quarters))


def line_of_sight(sightlines, paths):
    """Figure 5b: temperature and pressure along the line of sight, one line per condition, of rising power.

    The path is drawn on a scale of its square root, which shows the boundary layer, the jet and the window.
    """
    _, (upper, lower) = style.figure(size=(4.6, 3.6), nrows=2, height_ratios=(2, 1), sharex=True)
    for sightline, curve in zip(sightlines.values(), style.curves_of(sightlines), strict=True):
        path = sightline.path_distance * 1e3
        upper.plot(path, sightline.temperature, **curve.options)
        lower.plot(path, sightline.pressure / 1e3, **curve.drawn)
    upper.axvspan(0, 5, color="0.9", zorder=0)
    upper.annotate("5 mm", (5.5, 200), fontsize=7, color="0.3")
    style.legend_beside(upper)
    upper.set(ylabel="Temperature [K]")
    window = 1e3 * sightline.attrs["window_distance"]
    lower.axvline(window, color="0.5", lw=0.7)
    lower.annotate("window", (window - 15, 40), ha="right", fontsize=7)
    root = (lambda path: np.sqrt(np.maximum(path, 0)), np.square)
    lower.set(xlim=(0, 1e3 * float(sightline.path_distance[-1])), yscale="log", ylabel="Pressure [kPa]")
    lower.set_xscale("function", functions=root)
    lower.set_xticks([0, 5, 20, 50, 100, 150, 300, 500, 800, 1000])
    lower.set_xlabel(r"Path distance $\zeta$ [mm], scale of its square root")
    style.save(upper, paths, *sightlines.values())


@dataclass(frozen=True)
class _Raster:
    """Pixels of the half plane: extent [mm], middles of columns and rows [mm], corner nodes and weights
    (pixels, 3), those inside."""

    extent: tuple
    column: np.ndarray
    row: np.ndarray
    nodes: np.ndarray
    weight: np.ndarray
    inside: np.ndarray

    def image(self, values):
        """Values (rows, columns) at the pixels, NaN outside the field."""
        picture = np.full(self.inside.shape, np.nan)
        picture[self.inside] = (values[self.nodes] * self.weight).sum(axis=1)
        return picture


def _raster(flow):
    """Linear interpolation on the quarters of the triangles, at the middle of each pixel."""
    mesh = _mesh(flow)
    z, r = mesh.x, mesh.y
    extent = (z.min(), z.max(), 0.0, r.max())
    columns, rows = (int(np.ceil(length / PIXEL)) for length in (extent[1] - extent[0], extent[3]))
    column = extent[0] + (np.arange(columns) + 0.5) * (extent[1] - extent[0]) / columns
    row = (np.arange(rows) + 0.5) * extent[3] / rows
    x, y = np.meshgrid(column, row)
    face = mesh.get_trifinder()(x, y)
    inside = face >= 0
    nodes = mesh.triangles[face[inside]]
    corner_x, corner_y = z[nodes], r[nodes]
    to_x, to_y = corner_x - x[inside][:, None], corner_y - y[inside][:, None]
    ahead_x, ahead_y = np.roll(to_x, -1, axis=1), np.roll(to_y, -1, axis=1)
    area = np.roll(to_x * ahead_y - to_y * ahead_x, -1, axis=1)
    return _Raster(extent, column, row, nodes, area / area.sum(axis=1, keepdims=True), inside)


def fields(flows, sightlines, paths):
    """Temperature with line of sight and streamlines, Joule heating and axial velocity, one figure each.

    `flows`, `sightlines` and `paths` (of its files) for each condition.
    """
    raster = drawn = None
    for flow, sightline, targets in zip(flows, sightlines, paths, strict=True):
        if drawn is None or not _same_mesh(flow, drawn):
            raster, drawn = _raster(flow), flow
        _field(flow, sightline, raster, targets)


def _same_mesh(flow, other):
    return all(
        np.array_equal(flow[name].values, other[name].values) for name in ("node_z", "node_r", "face_node")
    )


def _field(flow, sightline, raster, paths):
    drawing, (upper, lower) = style.figure(size=(7.2, 4.5), nrows=2, sharex=True)
    first, last, _, outer = raster.extent
    whole = (first, last, -outer, outer)
    temperature = raster.image(flow.temperature.values)
    both = np.concatenate([temperature[::-1], temperature])
    image = upper.imshow(both, extent=whole, origin="lower", cmap="inferno", vmin=300, **EXACT)
    drawing.colorbar(image, ax=upper, label="Temperature [K]", pad=0.01, shrink=SHORT_BAR)
    _sight_line(upper, sightline)
    _streamlines(upper, flow, raster)
    upper.legend(loc="upper left", labelcolor="0.3")
    title = f"{_named(flow)}; coil {float(flow.coil_current):.0f} A"
    upper.set_title(title, loc="left", fontsize=8)
    style.mark_origin(upper, flow)
    heating = raster.image(flow.joule_heating.values / 1e6)
    hot = lower.imshow(
        heating, extent=(first, last, 0, outer), origin="lower", cmap="magma_r", vmin=0, **EXACT
    )
    speed = raster.image(flow.axial_velocity.values)[::-1]
    largest = np.nanmax(np.abs(speed))
    fast = lower.imshow(
        speed,
        extent=(first, last, -outer, 0),
        origin="lower",
        cmap="RdBu_r",
        vmin=-largest,
        vmax=largest,
        **EXACT,
    )
    drawing.colorbar(fast, ax=lower, label="Axial velocity [m/s]", pad=0.01, shrink=SHORT_BAR)
    drawing.colorbar(hot, ax=lower, label="Joule heating [W/cm$^3$]", pad=0.01, shrink=SHORT_BAR)
    lower.axhline(0, color="0.3", lw=0.5)
    for words, place in (("Joule heating", outer - 12), ("axial velocity", 12 - outer)):
        lower.annotate(words, (15, place), va="center", fontsize=7, color="0.3")
    for axes in (upper, lower):
        axes.set(ylabel="Radial position $r$ [mm]", aspect="equal")
        axes.set(xlim=(first - 10, last + 10), ylim=(-outer - 10, outer + 10))
        axes.grid(False)
    lower.set(xlabel="Axial position $z$ [mm]")
    style.save(upper, paths)


def _streamlines(axes, flow, raster):
    """In the lower half, where the radial axis points down."""
    every = slice(None, None, STREAM_EVERY)
    # Matplotlib leaves out masked places, so that no line crosses the probe.
    along, outward = (
        np.ma.masked_invalid(raster.image(flow[name].values)[every, every])
        for name in ("axial_velocity", "radial_velocity")
    )
    axes.streamplot(
        raster.column[every],
        -raster.row[every][::-1],
        along[::-1],
        -outward[::-1],
        density=STREAM_DENSITY,
        color="white",
        linewidth=0.4,
        arrowsize=0.4,
        broken_streamlines=False,
    )


def convergence(flows, paths):
    """Change of velocity and temperature and residual of each step of the last part, by condition."""
    _, panels = style.figure(size=(4.3, 5.0), nrows=3, sharex=True)
    shown = {
        "velocity_change": "Velocity change [m/s]",
        "temperature_change": "Rel. temperature change",
        "residual_norm": "Residual norm",
    }
    for flow, curve in zip(flows.values(), _curves(flows), strict=True):
        for axes, name in zip(panels, shown, strict=True):
            values = flow[name].values
            axes.plot(np.arange(1, len(values) + 1), values, **curve.options, marker=".", ms=3)
    for axes, label in zip(panels, shown.values(), strict=True):
        axes.set(yscale="log", ylabel=label)
    panels[-1].set(xlabel="Newton step of the last part of the way")
    style.legend_beside(panels[1])
    style.save(panels[0], paths, *flows.values())


def _curves(flows):
    stated = [
        [float(flow[name]) for flow in flows.values()] for name in ("numerical_power", "chamber_pressure")
    ]
    return style.curves(list(flows), *stated)


def balances(flows, paths):
    """Where the power goes, as shares of the Joule power, and what does not close, for each condition."""
    _, (upper, lower) = style.figure(size=(4.8, 3.9), nrows=2, sharex=True, height_ratios=(2, 1))
    place = np.arange(len(flows))
    shares = np.array([_shares(flow) for flow in flows.values()])
    bottom = np.zeros(len(flows))
    for (label, colour), share in zip(PARTS.values(), shares.T, strict=True):
        faint = f" (< {max(share.max(), 0.05):.1f} %)" if share.max() < FAINT else ""
        upper.bar(place, share, bottom=bottom, color=colour, label=label + faint, width=0.8)
        bottom += share
    upper.axhline(100, color="0.2", lw=0.7)
    upper.set(ylabel="Share of Joule power [%]", ylim=(0, 106))
    style.legend_beside(upper, title=None)
    for name, label, offset in (("energy_imbalance", "energy", -0.2), ("mass_imbalance", "mass", 0.2)):
        values = [100 * float(flow[name]) for flow in flows.values()]
        lower.bar(place + offset, values, width=0.35, label=label)
    lower.axhline(0, color="0.2", lw=0.7)
    style.legend_beside(lower, title=None)
    lower.set(ylabel="Imbalance [%]", xticks=place, xlabel="Numerical power")
    lower.set_xticklabels([curve.label for curve in _curves(flows)], rotation=45)
    style.save(upper, paths, *flows.values())


def budgets(flow, found, paths):
    """Momentum and power through the `facility.sections.sections` of torch and jet, up to the probe."""
    _, (upper, lower) = style.figure(size=(5.6, 4.2), nrows=2, sharex=True)
    z = 1e3 * found["position"]
    upper.plot(z, found["momentum"], color="0.1", label="momentum of all gas")
    upper.plot(z, found["hot_momentum"], color="#d62728", label="of gas above 3000 K")
    upper.plot(z, found["pressure_force"], color="#4e79a7", ls="--", label="pressure above chamber")
    upper.set(ylabel="Force over a section [N]")
    lower.plot(z, 1e-3 * found["heating"], color="#f28e2b", label="Joule heat upstream")
    lower.plot(z, 1e-3 * found["enthalpy"], color="0.1", label="enthalpy of the gas")
    lost = found["heating"] - found["enthalpy"]
    lower.plot(z, 1e-3 * lost, color="#4e79a7", ls="--", label="lost upstream")
    lower.set(ylabel="Power through a section [kW]", xlabel="Axial position $z$ [mm]")
    exit_position = 1e3 * found["exit"]
    for axes in (upper, lower):
        axes.axvline(exit_position, color="0.6", lw=0.7)
        axes.axhline(0, color="0.6", lw=0.7)
        style.legend_beside(axes, title=None)
    upper.annotate("torch exit", (exit_position + 6, 0.85 * upper.get_ylim()[1]), fontsize=7, color="0.3")
    upper.set_title(_named(flow), loc="left", fontsize=8)
    style.save(upper, paths, flow)


def _named(flow):
    """Gas, pressure and power of a flow, for a title."""
    gas, power = flow.attrs.get("gas", "air"), float(flow.numerical_power) / 1e3
    return f"{gas}, {flow.chamber_pressure / 100:.0f} mbar, {power:g} kW"


def _shares(flow):
    """Power leaving through each of `PARTS` over the Joule power [%]."""
    leaving = {
        str(name): float(enthalpy + heat)
        for name, enthalpy, heat in zip(
            flow.boundary.values,
            flow.boundary_enthalpy_flow.values,
            flow.boundary_heat_flow.values,
            strict=True,
        )
    }
    named = [leaving.pop(name, 0.0) for name in list(PARTS)[:-1]]
    return [100 * value / float(flow.numerical_power) for value in (*named, sum(leaving.values()))]
