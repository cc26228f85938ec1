"""Instruments of one, two and five bands, from raw files to temperatures; light made by another integral."""

import json

import numpy as np
import pytest

from plasmapyro import cli, io, shipped
from plasmapyro.readers.stage import check_test

H, C, K = 6.62607015e-34, 299792458.0, 1.380649e-23
BANDS = {"b1": (690, 710), "b2": (790, 810), "b3": (890, 910), "b4": (990, 1010), "b5": (1090, 1110)}
INSTRUMENTS = "config/instruments"
GAIN = {"b1": 3e-6, "b2": 1e-6, "b3": 5e-7, "b4": 4e-7, "b5": 2e-7}  # signal per W m-2 sr-1
FACTS = """attributes:
  origin: synthetic
  condition: {condition}
  emittance: 0.8
  emittance_uncertainty: 0.16
"""
PLASMA = """  injection_time: 0.0
  plasma_off_time: 40.0
  reference_window: [0.0, 5.0]
  window_transmittance_radiometer: 0.9
  radiometer_integration_time: 0.01
"""
FURNACE = "  window_transmittance_radiometer: 0.9\n  radiometer_integration_time: 0.01\n"
COLUMNS = "radiometer:\n  columns:\n    time: {name: t, unit: s}\n"


def planck(wavelength, kelvin):
    return 2 * H * C**2 / wavelength**5 / np.expm1(H * C / (wavelength * K * kelvin))


def light(edges, kelvin, emissivity=lambda _: 1.0):
    """Radiance of a band by Gauss and Legendre's rule."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    low, high = np.array(edges) * 1e-9
    at = (low + high) / 2 + (high - low) / 2 * nodes
    return (
        np.sum(weights * emissivity(at) * planck(at, np.asarray(kelvin)[..., None]), axis=-1)
        * (high - low)
        / 2
    )


def table(path, columns):
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(columns), *(",".join(f"{value:.9e}" for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n")


def run(*words):
    return cli.main([str(word) for word in words])


@pytest.fixture
def place(tmp_path, pytestconfig):
    """A folder of a calibration and one for a test, and how an instrument gets its calibration."""

    def calibrated(instrument, **points):
        lab = tmp_path / "calibration"
        lab.mkdir()
        text = (pytestconfig.rootpath / INSTRUMENTS / f"{instrument}.yaml").read_text()
        (lab / "instrument.yaml").write_text(text)
        names = "".join(f"    {name}: {{name: {name}}}\n" for name in points if name != "T")
        source = "    source_temperature: {name: T, unit: K}\n"
        described = f"  columns:\n{source}{names}" if points else ""
        (lab / "calibration.yaml").write_text(
            "origin: synthetic\nradiometer:\n  instrument: instrument.yaml\n" + described
        )
        if points:
            table(lab / "calibration_points.csv", points)
        assert run("check", lab) == 0
        words = ("calibrate", lab, "--out", tmp_path / "lab", "--source-temperature-uncertainty-k", 1)
        assert run(*words) == 0
        return tmp_path / "lab"

    (tmp_path / "test").mkdir()
    return tmp_path / "test", calibrated


def five_points(rng):
    kelvin = np.arange(1100.0, 2001.0, 150.0)
    return {"T": kelvin} | {
        name: GAIN[name] * light(edges, kelvin) * rng.normal(1, 0.003, kelvin.size)
        for name, edges in BANDS.items()
    }


TILTED, CURVED = (
    (lambda at: 0.8 * (at / 0.9e-6) ** -0.5),
    (lambda at: 0.7 + 1.5 * ((at - 0.75e-6) / 1e-6) ** 2),
)


@pytest.mark.parametrize("emissivity", [TILTED, CURVED], ids=["tilted", "curved"])
def test_five_bands_through_a_plasma(place, emissivity, capsys):
    rng = np.random.default_rng(4)
    test, calibrated = place
    lab = calibrated("five_band", **five_points(rng))
    time = np.arange(0.0, 50.0, 0.5)
    kelvin = 350 + 1350 / (1 + np.exp(-(time - 12) / 2.5))
    flicker = 1 + 0.01 * rng.normal(size=time.size)
    signals = {"t": time}
    for name, edges in BANDS.items():
        gas = 0.05 * light(edges, 1600.0) * flicker * (time < 40)
        whole = 0.9 * GAIN[name] * (light(edges, kelvin, emissivity) + gas)
        signals[name] = whole * rng.normal(1, 0.003, time.size)
    table(test / "radiometer.csv", signals)
    names = "".join(f"    {name}: {{name: {name}}}\n" for name in BANDS)
    (test / "test.yaml").write_text(FACTS.format(condition="90kW") + PLASMA + COLUMNS + names)
    assert check_test(test) == []
    assert run("check", test, "--instrument", lab) == 0
    out = test.parent / "t.nc"
    assert run("correct", test, "--instrument", lab, "--out", out) == 0
    found = io.read(out, "correction")
    assert found.attrs["recommended"] == "emissivity"
    good = found.spectral_status.values == 0
    hot = (time > 15) & (np.abs(time - 40) > 0.6)
    assert good[hot].all() and not good[time < 8].any()
    for name in ("spectral", "surface"):  # the second is the joint estimate
        low, high = found[f"{name}_temperature_interval"].values[:, hot]
        assert ((low < kelvin[hot]) & (high > kelvin[hot])).mean() > 0.9
    # The ratio of the outer bands with a grey assumption errs by more than twice as much.
    first, last = (light(BANDS[name], kelvin[hot], emissivity) for name in ("b1", "b5"))
    curve = np.arange(900.0, 2400.0)
    grey = np.interp(first / last, light(BANDS["b1"], curve) / light(BANDS["b5"], curve), curve)
    off = np.abs(found.spectral_temperature.values[hot] - kelvin[hot]).mean()
    assert off < np.abs(grey - kelvin[hot]).mean() / 2
    assert run("correct", test, "--instrument", lab, "--out", out, "--estimator", "reference") == 2
    assert "takes no radiometer" in capsys.readouterr().err


def test_an_emissivity_that_is_set_anew_during_the_test_does_not_move_the_temperature(place):
    test, calibrated = place
    lab, time, kelvin = calibrated("one_colour"), np.arange(0.0, 20.0), 1500.0
    setting = np.where(time < 10, 1.0, 0.8)
    curve = np.arange(1000.0, 2000.0, 0.5)
    shown = np.interp(0.8 * light((800, 1100), [kelvin]) / setting, light((800, 1100), curve), curve)
    assert shown[0] < 1490 and abs(shown[-1] - kelvin) < 1
    table(test / "radiometer.csv", {"t": time, "T": shown - 273.15, "E": setting})
    reading = "    reading: {name: T, unit: degC}\n    setting: {name: E}\n  bands: [si]\n"
    (test / "test.yaml").write_text(FACTS.format(condition="none") + COLUMNS + reading)
    assert run("correct", test, "--instrument", lab, "--out", test.parent / "t.nc") == 0
    found = io.read(test.parent / "t.nc", "emissivity_estimate")
    # 0.5 K steps of the curve, and a band whose edges rise over 0.1 nm
    assert np.abs(found.spectral_temperature.values - kelvin).max() < 1.0
    # 20 % of emissivity: u(T)/T = 0.2 lambda T / c2 = 2 % at 0.95 um
    error = found.spectral_temperature_uncertainty.values / kelvin
    assert ((error > 0.015) & (error < 0.025)).all()


def test_a_display_may_lack_readings_and_is_asked_whether_it_ends(place, capsys):
    """An empty cell, or a 0, is no reading; the least, ten times in a row, may be any colder surface."""
    test, calibrated = place
    lab, time = calibrated("one_colour"), np.arange(0.0, 30.0)
    shown = np.maximum(1250.0, 1100.0 + 10.0 * time)
    shown[[0, 20]] = np.nan, 0.0
    table(test / "radiometer.csv", {"t": time, "T": shown})
    reading = "    reading: {name: T, unit: K}\n  bands: [si]\n"
    (test / "test.yaml").write_text(FACTS.format(condition="none") + COLUMNS + reading)
    assert run("correct", test, "--instrument", lab, "--out", test.parent / "t.nc") == 0
    assert "15 readings in a row show 1250 K, from 1 s on, and none shows less" in capsys.readouterr().err
    found = io.read(test.parent / "t.nc", "emissivity_estimate")
    assert np.isnan(found.spectral_temperature.values[[0, 20]]).all()
    assert np.isfinite(found.spectral_temperature.values[[19, 21]]).all()


def test_the_slope_of_a_ratio_pyrometer_is_undone(place):
    test, calibrated = place
    lab, time, kelvin = calibrated("ratio"), np.arange(0.0, 20.0), 1500.0
    slope = np.where(time < 10, 1.0, 1.05)
    short, long = (925, 975), (1025, 1075)
    curve = np.arange(1000.0, 2500.0, 0.5)
    ratio = light(short, curve) / light(long, curve)
    shown = np.interp(light(short, [kelvin]) / light(long, [kelvin]) / slope, ratio, curve)
    assert shown[0] - shown[-1] > 60
    table(test / "radiometer.csv", {"t": time, "T": shown, "s": slope})
    reading = "    reading: {name: T, unit: K}\n    setting: {name: s}\n  bands: [short, long]\n"
    (test / "test.yaml").write_text(FACTS.format(condition="none") + COLUMNS + reading)
    assert run("correct", test, "--instrument", lab, "--out", test.parent / "t.nc") == 0
    found = io.read(test.parent / "t.nc", "emissivity_estimate")
    assert np.abs(found.spectral_temperature.values - kelvin).max() < 8.0  # 0.3 %: the bands' own uncertainty
    with np.errstate(invalid="ignore"):
        assert (found.emissivity_interval[1] / found.emissivity_interval[0] > 1.5).all()  # no level is known


def test_a_ratio_of_many_samples_keeps_the_emissivity_that_is_stated(place, capsys):
    test, calibrated = place
    lab, time = calibrated("ratio"), np.arange(0.0, 60.0, 0.5)
    kelvin, slope = 1400 + 150 * np.tanh((time - 20) / 8), np.where(time < 30, 1.0, 1.03)
    short, long, curve = (925, 975), (1025, 1075), np.arange(1000.0, 2500.0, 0.5)
    ratio = light(short, curve) / light(long, curve)
    seen = 0.8 * light(short, kelvin) / (0.78 * light(long, kelvin))
    table(test / "radiometer.csv", {"t": time, "T": np.interp(seen / slope, ratio, curve), "s": slope})
    reading = "    reading: {name: T, unit: K}\n    setting: {name: s}\n  bands: [short, long]\n"
    points = "[[925, 0.8], [975, 0.8], [1025, 0.78], [1075, 0.78]]"
    facts = FACTS.format(condition="none").replace("emittance: 0.8", f"emittance: {points}")
    (test / "test.yaml").write_text(facts + COLUMNS + reading)
    out = test.parent / "t.nc"
    assert run("correct", test, "--instrument", lab, "--out", out) == 0
    found = io.read(out, "emissivity_estimate")
    assert (found.spectral_status == 0).all()  # also where the slope is set anew
    assert np.abs(found.spectral_temperature.values - kelvin).max() < 1.0  # nothing else moves it
    assert run("diagnose", test, "--instrument", lab, "--out", test.parent / "d") == 2
    assert "a displayed ratio has no level" in capsys.readouterr().err
    table(test / "radiometer.csv", {"t": time, "T": kelvin, "s": 80 * slope})  # in percent
    assert run("check", test) == 2 and "a wrong unit" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("edges_nm: [690, 710]", "edges_nm: [710, 690]", "edges_nm must be 2 rising numbers"),
        ("calibration: absolute", "calibration: sure", "calibration must be one of"),
        ("name: b2", "name: b1", "stands twice"),
        ("edges_nm: [690, 710]", "response: none.csv", "none.csv"),
    ],
)
def test_an_instrument_file_that_means_nothing_is_refused(place, pytestconfig, capsys, old, new, words):
    lab = place[0].parent / "wrong"
    lab.mkdir()
    text = (pytestconfig.rootpath / INSTRUMENTS / "five_band.yaml").read_text()
    (lab / "instrument.yaml").write_text(text.replace(old, new))
    (lab / "calibration.yaml").write_text("origin: synthetic\nradiometer: {instrument: instrument.yaml}\n")
    assert run("check", lab) == 2
    assert words in capsys.readouterr().err


def triangle(centre, width, kelvin):
    """Radiance of a band whose response rises to its centre [nm] and falls again."""
    share = lambda at: 1 - np.abs(at * 1e9 - centre) / width  # noqa: E731
    return light((centre - width, centre), kelvin, share) + light((centre, centre + width), kelvin, share)


@pytest.mark.parametrize(
    ("count", "form", "kind"),
    [(1, "edges", "absolute"), (1, "file", "relative"), (3, "file", "relative"), (25, "centre", "absolute")],
)
def test_a_furnace_before_any_number_of_bands(place, capsys, count, form, kind):
    test, lab, rng = place[0], place[0].parent / "calibration", np.random.default_rng(count)
    lab.mkdir()
    centres, width, names = np.linspace(650, 1050, count), 14, [f"b{n}" for n in range(count)]
    seen = triangle if form == "file" else lambda middle, w, t: light((middle - w / 2, middle + w / 2), t)
    rows = []
    for name, at in zip(names, centres, strict=True):
        table(lab / f"{name}.csv", {"nm": np.array([at - width, at, at + width]), "r": np.array([0.0, 1, 0])})
        own = {
            "edges": f"edges_nm: [{at - width / 2}, {at + width / 2}]",
            "centre": f"centre_nm: {at}, width_nm: {width}",
            "file": f"response: {name}.csv",
        }
        rows.append(f"  - {{name: {name}, {own[form]}}}\n")
    head = f"name: any\ncalibration: {kind}\nsignal_uncertainty: 0.003\nrange_k: [900, 2600]\nbands:\n"
    (lab / "instrument.yaml").write_text(head + "".join(rows))
    points, time = np.arange(1100.0, 2001.0, 150.0), np.arange(0.0, 30.0)
    kelvin, gains = 1300 + 10 * time, np.exp(rng.normal(size=count))
    level = 0.8 * (0.6 if kind == "relative" else 1.0)
    for path, first, lit in (
        (lab / "calibration_points.csv", {"T": points}, points),
        (test / "radiometer.csv", {"t": time}, kelvin),
    ):
        share = 1.0 if lit is points else level
        signals = {
            name: gain * share * seen(at, width, lit) * rng.normal(1, 0.003, lit.size)
            for name, at, gain in zip(names, centres, gains, strict=True)
        }
        table(path, first | signals)
    columns = "".join(f"    {name}: {{name: {name}}}\n" for name in names)
    source = "    source_temperature: {name: T, unit: K}\n"
    (lab / "calibration.yaml").write_text(
        "origin: synthetic\nradiometer:\n  instrument: instrument.yaml\n  columns:\n" + source + columns
    )
    (test / "test.yaml").write_text(FACTS.format(condition="none") + COLUMNS + columns)
    out = test.parent / "lab"
    assert run("calibrate", lab, "--out", out) == 0
    told = run("correct", test, "--instrument", out, "--out", test.parent / "t.nc")
    if count == 1 and kind == "relative":
        assert told == 2 and "which a relative calibration leaves open" in capsys.readouterr().err
        assert run("diagnose", test, "--instrument", out, "--out", test.parent / "d") == 2
        return
    found = io.read(test.parent / "t.nc", "emissivity_estimate")
    assert told == 0 and (found.recommended_status == 0).all()
    low, high = found.recommended_temperature_interval.values
    assert ((low < kelvin) & (kelvin < high)).mean() > 0.9 and (high - low < 200).all()


FIVE = {"b1": (740, 760), "b2": (795, 815), "b3": (880, 900), "b4": (990, 1010), "b5": (1080, 1100)}


def diagnosed(place, cut=None, bands=FIVE, plasma=True):
    """Report and temperatures of a diagnosis of bands behind the shipped gas of 90 kW; truth (t,) [K].

    `cut`: (time (t,), band) -> what reaches the band of its light. Without a plasma: a furnace that is warm
    from the first sample on, and no gas.
    """
    gas, rng = shipped.by_condition()["90kW"], np.random.default_rng(1)
    test, root = place, place.parent
    lab = root / "calibration"
    lab.mkdir()
    rows = "".join(f"  - {{name: {one}, edges_nm: {list(edges)}}}\n" for one, edges in bands.items())
    head = "name: five\ncalibration: absolute\nsignal_uncertainty: 0.003\nrange_k: [900, 2600]\nbands:\n"
    (lab / "instrument.yaml").write_text(head + rows)
    kelvin = np.arange(1100.0, 2001.0, 150.0)
    points = {"T": kelvin} | {
        one: GAIN[one] * light(edges, kelvin) * rng.normal(1, 0.003, kelvin.size)
        for one, edges in bands.items()
    }
    names = "".join(f"    {name}: {{name: {name}}}\n" for name in bands)
    source = "    source_temperature: {name: T, unit: K}\n"
    (lab / "calibration.yaml").write_text(
        "origin: synthetic\nradiometer:\n  instrument: instrument.yaml\n  columns:\n" + source + names
    )
    table(lab / "calibration_points.csv", points)
    assert run("calibrate", lab, "--out", root / "lab", "--source-temperature-uncertainty-k", 2) == 0
    time = np.arange(-3.0, 70.0, 0.1)
    kelvin = 350 + 1300 / (1 + np.exp(-(time - 14) / 3.0)) - 15 * np.maximum(time - 60, 0)
    if not plasma:
        kelvin = 1300 + 200 * np.tanh((time - 30) / 12)
    noise, flicker = rng.normal(size=time.size), np.zeros(time.size)
    for n in range(1, time.size):  # correlated over 0.3 s
        flicker[n] = np.exp(-1 / 3) * flicker[n - 1] + np.sqrt(1 - np.exp(-2 / 3)) * noise[n]
    signals = {"t": time}
    for name, edges in bands.items():
        inside = np.abs(gas.wavelength_slit.values * 1e9 - np.mean(edges)) < np.ptp(edges) / 2
        own = np.trapezoid(gas.gas_radiance_slit.values[inside], gas.wavelength_slit.values[inside])
        own = own * (1 + 0.01 * flicker) * np.where(time < 0, 1.5, 1.0) * (time < 60) * plasma
        surface = light(edges, kelvin, lambda at: 0.78 * (at / 0.9e-6) ** -0.25)
        surface = surface * ((time >= 0) | (not plasma))
        share = 1.0 if cut is None else cut(time, name)
        signals[name] = 0.9 * GAIN[name] * share * (own + surface) * rng.normal(1, 0.003, time.size)
    table(test / "radiometer.csv", signals)
    facts = FACTS.format(condition="90kW" if plasma else "none") + (PLASMA if plasma else FURNACE)
    facts = facts.replace("40.0", "60.0").replace("0.16", "0.05")
    (test / "test.yaml").write_text(facts + COLUMNS + names)
    assert run("diagnose", test, "--instrument", root / "lab", "--out", root / "d") == 0
    found = io.read(root / "d/temperature.nc", "diagnosis_temperature")
    assert "signal" in (root / "d/index.html").read_text()
    return json.loads((root / "d/diagnosis.json").read_text()), found, np.interp(found.time_bin, time, kelvin)


def test_a_deposit_before_five_bands_is_named(place):
    report, found, truth = diagnosed(place[0], lambda time, _: 1 - 0.1 * np.clip(time / 60, 0, 1))
    assert [entry["id"] for entry in report["extended"]["terms"]] == ["winD"]
    loss = report["extended"]["terms"][0]["parameters"]["amplitude"]
    assert loss == pytest.approx(0.1, abs=0.02)  # its stated error is 0.005
    hot = truth > 1000
    inside = (found.extended_temperature_low < truth) & (found.extended_temperature_high > truth)
    assert inside[hot].mean() > 0.95
    off = {kind: np.abs(found[f"{kind}_temperature"] - truth)[hot].max() for kind in ("base", "extended")}
    assert off["extended"] < off["base"] / 1.5


def test_a_gain_of_one_of_five_bands_is_found_in_that_band(place):
    report, _, _ = diagnosed(place[0], lambda time, band: np.where((time > 35) & (band == "b3"), 1.04, 1.0))
    assert report["verdict"]["status"] in ("unknown", "named+unknown")
    assert "band b3" in " ".join(report["verdict"]["sentences"])


def held(found, truth, least):
    """Whether the recommended interval holds the truth (t,) in at least a share of the hot samples."""
    low, high = found.recommended_temperature_interval.values
    hot = (truth > 1100) & np.isfinite(low)
    assert hot.sum() > 0.8 * (truth > 1100).sum()
    return ((low < truth) & (high > truth))[hot].mean() >= least


@pytest.mark.parametrize("plasma", [True, False], ids=["plasma", "furnace"])
def test_one_band_is_enough_for_a_diagnosis(place, plasma):
    report, found, truth = diagnosed(place[0], bands={"b3": FIVE["b3"]}, plasma=plasma)
    assert report["verdict"]["status"] == "null" and held(found, truth, 0.95)


def test_a_furnace_is_diagnosed_without_a_gas(place):
    report, found, truth = diagnosed(place[0], plasma=False)
    assert report["verdict"]["status"] == "null" and held(found, truth, 0.95)
    assert report["simulation"]["sentences"] == ["There is no plasma: nothing to compare."]
    assert found.time_bin[0] < -2.0  # from the first sample on


def test_a_gain_of_a_band_before_a_furnace_is_found(place):
    cut = lambda time, band: np.where((time > 35) & (band == "b3"), 1.04, 1.0)  # noqa: E731
    report, _, _ = diagnosed(place[0], cut, plasma=False)
    assert report["verdict"]["status"] in ("unknown", "named+unknown")
    assert "band b3" in " ".join(report["verdict"]["sentences"])


def test_a_display_that_shows_dashes_before_the_surface_shines_bounds_the_gas(place, capsys):
    """Below its range it shows no reading: the gas then is less than the least that it shows."""
    test, calibrated = place
    lab, time, rng = calibrated("one_colour"), np.arange(-5.0, 60.0, 0.2), np.random.default_rng(2)
    kelvin = np.where(time < 0, 300.0, 350 + 1150 * -np.expm1(-np.maximum(time, 0) / 12))
    gas, edges, curve = 0.3 * light((800, 1100), 900.0), (800, 1100), np.arange(800.0, 2000.0, 0.5)
    whole = 0.9 * (0.8 * light(edges, kelvin) * (time >= 0) + gas * (time < 40))
    shown = np.interp(whole * rng.normal(1, 0.002, time.size) / 0.72, light(edges, curve), curve)
    dark = shown < 900.0
    rows = [
        f"{t:.1f};{'---' if off else f'{one:.1f}'};0.72"
        for t, one, off in zip(time, shown, dark, strict=True)
    ]
    (test / "radiometer.csv").write_text("t;T;E\n" + "\n".join(rows) + "\n")
    reading = "    reading: {name: T, unit: K}\n    setting: {name: E}\n  bands: [si]\n"
    facts = FACTS.format(condition="90kW").replace("uncertainty: 0.16", "uncertainty: 0.04") + PLASMA
    (test / "test.yaml").write_text(facts + COLUMNS + reading)
    assert run("correct", test, "--instrument", lab, "--out", test.parent / "t.nc") == 0
    found = io.read(test.parent / "t.nc", "correction")
    good = found.recommended_status.values == 0
    assert good[(time > 12) & (np.abs(time - 40) > 0.5)].all() and not good[dark].any()
    low, high = found.recommended_temperature_interval.values[:, good]
    assert ((low < kelvin[good]) & (high > kelvin[good])).all()


def test_a_displayed_ratio_behind_a_plasma_is_told_where_to_go(place, capsys):
    test, calibrated = place
    lab, time = calibrated("ratio"), np.arange(-5.0, 60.0)
    table(test / "radiometer.csv", {"t": time, "T": 1400.0 + time, "s": np.ones(time.size)})
    reading = "    reading: {name: T, unit: K}\n    setting: {name: s}\n  bands: [short, long]\n"
    (test / "test.yaml").write_text(FACTS.format(condition="90kW") + PLASMA + COLUMNS + reading)
    assert run("correct", test, "--instrument", lab, "--out", test.parent / "t.nc", "--keep-window") == 2
    assert "correct-reading" in capsys.readouterr().err
