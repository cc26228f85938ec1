"""Figures of the flow: pixels hold the field, shares add up, every file is drawn and the same twice."""

import json

import numpy as np
import pytest
import xarray as xr

from plasmapyro.facility.sections import sections
from plasmapyro.gas.stage import gas_table
from plasmapyro.plots import flow as figures

PIXEL_RTOL = 1e-12  # linear interpolation of a linear field


def field(columns=6, rows=4, length=0.12, radius=0.04):
    """Six-node triangles on a rectangle with a linear temperature."""
    z, r = np.meshgrid(np.linspace(0, length, 2 * columns + 1), np.linspace(0, radius, 2 * rows + 1))
    node = np.arange(z.size).reshape(z.shape)
    corner, middle = [], []
    for j in range(0, 2 * rows, 2):
        for i in range(0, 2 * columns, 2):
            for shape in (((0, 0), (0, 2), (2, 2)), ((0, 0), (2, 2), (2, 0))):
                corner.append([node[j + a, i + b] for a, b in shape])
                pairs = zip(shape, (*shape[1:], shape[0]), strict=True)
                middle.append([node[j + (p[0] + q[0]) // 2, i + (p[1] + q[1]) // 2] for p, q in pairs])
    z, r = z.ravel(), r.ravel()
    history = {name: ("iteration", [1.0, 0.1]) for name in ("velocity_change", "temperature_change")}
    return xr.Dataset(
        {
            "node_z": ("node", z),
            "node_r": ("node", r),
            "face_node": (("face", "corner"), np.array(corner)),
            "face_midnode": (("face", "corner"), np.array(middle)),
            "temperature": ("node", 500 + 30000 * z + 40000 * r),
            "axial_velocity": ("node", 10 + 0 * z),
            "radial_velocity": ("node", 100 * r),
            "joule_heating": ("node", 1e7 * r),
            "numerical_power": ((), 90e3),
            "chamber_pressure": ((), 5000.0),
            "coil_current": ((), 640.0),
            "energy_imbalance": ((), 1e-3),
            "mass_imbalance": ((), -1e-4),
            "boundary": ("boundary", np.array(["inlet", "outlet", "probe", "back_wall"], dtype=object)),
            "boundary_enthalpy_flow": ("boundary", [-900.0, 60e3, 0.0, 0.0]),
            "boundary_heat_flow": ("boundary", [0.0, 0.0, 9e3, 21.9e3]),
            "residual_norm": ("iteration", [1e-2, 1e-4]),
            **history,
        }
    )


SIGHTLINE = xr.Dataset(
    {"axial_position": ("path_distance", [0.1, 0.05]), "radial_position": ("path_distance", [0.0, 0.04])},
    {"path_distance": [0.0, 0.06]},
    attrs={"exit_distance": 0.06},
)


def test_pixels_hold_the_field():
    flow = field()
    raster = figures._raster(flow)
    picture = raster.image(flow.temperature.values)
    rows, columns = picture.shape
    z = (np.arange(columns) + 0.5) * 0.12 / columns
    r = (np.arange(rows) + 0.5)[:, None] * 0.04 / rows
    assert picture == pytest.approx(500 + 30000 * z + 40000 * r, rel=PIXEL_RTOL)


def test_pixels_outside_the_field_are_empty():
    flow = field()
    centre = flow.node_z.values[flow.face_node.values].mean(axis=1)
    cut = flow.isel(
        face=np.flatnonzero((centre < 0.06) | (flow.node_r.values[flow.face_node].mean(1) < 0.02))
    )
    picture = figures._raster(cut).image(cut.temperature.values)
    rows, columns = picture.shape
    assert np.isnan(picture[rows * 3 // 4, columns * 3 // 4])
    assert np.isfinite(picture[rows // 4, columns * 3 // 4])


def test_shares_of_the_power_add_up_to_all_that_leaves():
    shares = figures._shares(field())
    assert shares == pytest.approx([100 * 60 / 90, 100 * 21.9 / 90, 10.0, 0.0, -1.0], rel=1e-12)


@pytest.fixture(scope="module")
def gas():
    return gas_table(temperature=np.arange(300.0, 7001.0, 100.0), pressure=[5000.0])


def in_a_tube():
    """A tube of 40 mm with gas of 500 K at 30 m/s, 4 Pa above the chamber, heated evenly."""
    flow = field()
    uniform = {"temperature": 500.0, "axial_velocity": 30.0, "pressure": 5004.0, "joule_heating": 2e6}
    flow = flow.assign(
        {name: ("node", np.full(flow.sizes["node"], value)) for name, value in uniform.items()}
    )
    stated = {"wall_temperature": 300.0, "stagnation_point_z": 0.12, "torch": json.dumps({"length": 0.08})}
    return flow.assign_attrs(stated)


def test_sections_carry_what_a_uniform_stream_carries(gas):
    found, area = sections(in_a_tube(), gas), np.pi * 0.04**2
    density, enthalpy = (
        float(np.interp(500, gas.temperature, gas[name][0])) for name in ("density", "enthalpy")
    )
    enthalpy -= float(gas.enthalpy[0, 0])
    assert found["momentum"] == pytest.approx(density * 900 * area, rel=1e-3)
    assert np.all(found["hot_momentum"] == 0)
    assert found["pressure_force"] == pytest.approx(4 * area, rel=1e-3)
    assert found["enthalpy"] == pytest.approx(density * 30 * enthalpy * area, rel=5e-3)
    assert found["heating"][-1] == pytest.approx(2e6 * area * 0.12, rel=1e-3)


def test_every_figure_is_drawn_and_the_same_twice(tmp_path, gas):
    flows = {"80kW": field(), "90kW": field()}
    for turn in ("a", "b"):
        folder = tmp_path / turn
        folder.mkdir()
        paths = [[folder / f"{name}.svg"] for name in flows]
        figures.fields(flows.values(), [SIGHTLINE] * 2, paths)
        figures.convergence(flows, [folder / "convergence.svg"])
        figures.balances(flows, [folder / "balances.svg"])
        figures.budgets(in_a_tube(), sections(in_a_tube(), gas), [folder / "budgets.svg"])
    names = sorted(path.name for path in (tmp_path / "a").iterdir())
    assert names == ["80kW.svg", "90kW.svg", "balances.svg", "budgets.svg", "convergence.svg"]
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
