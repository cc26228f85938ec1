"""Curves of conditions: labels that tell them apart, and colours that do so for every eye and in grey."""

import numpy as np
import pytest
import xarray as xr
from matplotlib import rc_context
from matplotlib.figure import Figure

from plasmapyro.plots import style
from plasmapyro.plots.experiment import after_injection
from plasmapyro.plots.laid import Laid

# Machado, Oliveira & Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291: full deficiency, linear RGB.
EYES = {
    "normal": np.eye(3),
    "protan": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deutan": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "tritan": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
TO_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
TELLS_APART = 11.0  # CIE 1976 colour difference; 2.3 is just noticeable side by side
NEIGHBOURS = 20.0


def lab(colours, eye):
    """CIELAB of sRGB colours as an eye sees them."""
    colours = np.asarray(colours)[:, :3]
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    white = np.array([0.95047, 1.0, 1.08883])
    xyz = np.clip(linear @ EYES[eye].T, 0, 1) @ TO_XYZ.T / white
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], axis=1)


@pytest.mark.parametrize("eye", EYES)
def test_nine_powers_are_nine_colours_for_every_eye(eye):
    seen = lab(style.case_colours(9), eye)
    apart = np.linalg.norm(seen[:, None] - seen, axis=-1)
    assert apart[~np.eye(9, dtype=bool)].min() > TELLS_APART
    assert np.diagonal(apart, 1).min() > NEIGHBOURS


def test_in_grey_more_power_is_darker():
    light = lab(style.case_colours(9), "normal")[:, 0]
    assert (np.diff(light) < -3).all() and light[0] < 85


def test_neighbours_differ_in_their_line_too():
    dashes = [curve.dash for curve in style.curves("abcd", [1e3, 2e3, 3e3, 4e3], [5e3] * 4)]
    assert all(one != other for one, other in zip(dashes[1:], dashes[:-1], strict=True))


def labels(names, power, pressure):
    return [curve.label for curve in style.curves(names, power, pressure)]


def test_labels_keep_their_style_whatever_a_condition_is_called():
    assert labels(["50kW", "mine"], [50e3, 95e3], [5e3, 5e3]) == ["50 kW", "95 kW"]


def test_pressures_are_told_where_they_differ_and_have_lines_of_their_own():
    curves = style.curves(["a", "b", "c"], [90e3, 90e3, 95e3], [5e3, 2e3, 5e3])
    assert [curve.label for curve in curves] == ["90 kW, 50 mbar", "90 kW, 20 mbar", "95 kW, 50 mbar"]
    assert curves[0].dash == curves[2].dash != curves[1].dash
    assert [style.curves("a", [75e3], [one])[0].label for one in (3e3, 5e3)] == ["75 kW, 30 mbar", "75 kW"]


def test_names_stand_where_power_and_pressure_do_not_tell():
    assert labels(["first", "second", "third"], [90e3, 90e3, np.nan], [5e3] * 3) == [
        "first",
        "second",
        "third",
    ]


def test_a_mapping_of_files_says_what_its_conditions_are():
    files = {
        "mine": xr.Dataset(attrs={"numerical_power": 80e3, "chamber_pressure": 5e3}),
        "bare": xr.Dataset(),
    }
    assert [curve.label for curve in style.curves_of(files)] == ["80 kW, 50 mbar", "bare"]


def test_results_are_drawn_over_the_time_since_the_injection():
    made = xr.Dataset(
        {"signal": ("time", [1.0, 2.0])},
        {"time": [110.0, 130.0]},
        {"injection_time": 100.0, "plasma_off_time": 125.0},
    )
    moved = after_injection(made)
    assert list(moved.time) == [10.0, 30.0]
    assert (moved.attrs["injection_time"], moved.attrs["plasma_off_time"]) == (0.0, 25.0)


def test_a_figure_is_laid_out_for_its_first_file_and_drawn_once_for_the_others(tmp_path, monkeypatch):
    drawn = []
    draw = Figure.draw
    monkeypatch.setattr(Figure, "draw", lambda self, renderer: drawn.append(renderer) or draw(self, renderer))
    _, axes = style.figure(size=(2, 2))
    style.save(axes, [tmp_path / "one.svg", tmp_path / "one.png", tmp_path / "two.png"])
    assert len(drawn) == 3  # the layout takes no drawing of its own


def test_a_figure_that_is_laid_out_without_a_drawing_is_the_same(tmp_path):
    made = []
    for kind in (Figure, Laid):
        figure = kind(figsize=(4, 2), layout="constrained")
        left, right = figure.subplots(ncols=2)
        left.semilogy([1, 1e5], [1e-3, 2e4], label="a curve")
        left.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
        right.set_aspect("equal")
        figure.colorbar(right.scatter([0, 2], [0, 1], c=[0, 1]), label="colour")
        with rc_context({"svg.hashsalt": "the same"}):
            figure.savefig(tmp_path / "one.svg", metadata={"Date": None})
        made.append((tmp_path / "one.svg").read_bytes())
    assert made[0] == made[1]
