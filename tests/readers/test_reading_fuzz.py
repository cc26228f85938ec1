"""Thousands of damaged inputs: each ends in a clean dataset or in clear messages, none in anything else.

`PLASMAPYRO_FUZZ=10000 pytest tests/readers/test_reading_fuzz.py` spreads that many over all kinds of files.
A clean dataset is corrected as well, so that what the readers let through cannot fail later.
"""

import contextlib
import io as streams
import os
import tempfile
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import samples
import xarray as xr
from accidents import bounded, damage, no_hang  # noqa: F401 (a fixture)
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plasmapyro import cli, contracts, io
from plasmapyro.experiment.stage import correct_pyrometer
from plasmapyro.readers.calibration import check_calibration, read_exposures, read_points
from plasmapyro.readers.stage import read_test
from plasmapyro.record import inputs

RUNS = 20  # tests below, each kind counted
EXAMPLES = max(int(os.environ.get("PLASMAPYRO_FUZZ", "600")) // RUNS, 10)
LONGEST_MESSAGE = 2000
SETTINGS = settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
KINDS = {  # name -> (parts of test.yaml, files that may be damaged)
    "table": (samples.CSV, {"pyrometer.csv": samples.table().encode()}),
    "burst log": (samples.MARATHON, {"pyrometer.log": samples.log().encode()}),
    **{
        form: (
            samples.SPECTRA,
            {
                "dark.txt": samples.spectrum(form, samples.DARK),
                "spectrometer/a.txt": samples.spectrum(form),
                "spectrometer/b.txt": samples.spectrum(form, samples.COUNTS + 7, second=52),
            },
        )
        for form in samples.FORMS
    },
    "matrix": (
        "spectrometer:\n  file: s.csv\n  background: d.csv\n  quantity: counts\n  unit: count\n",
        {"s.csv": b"t,800.1,800.5,800.9\n0.5,1,2,3\n1.5,4,5,6\n", "d.csv": b"t,800.1,800.5,800.9\n0,0,0,0\n"},
    ),
}


def said(place):
    """Exit status and messages of `plasmapyro check`; no other end is allowed."""
    out, err = streams.StringIO(), streams.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), bounded():
        code = cli.main(["check", str(place)])
    assert code in (0, 2), err.getvalue()
    messages = err.getvalue().strip().split("\n") if err.getvalue() else []
    assert all(words.isprintable() and len(words) < LONGEST_MESSAGE for words in messages), messages
    return code, messages


def clean_or_clear(place):
    """A dataset that honours its contract and can be corrected, or messages and None."""
    code, messages = said(place)
    if code:
        assert messages and all(messages)
        with pytest.raises(contracts.ContractError):
            read_test(place)
        return None
    test = contracts.check(read_test(place), "test")
    assert inputs.faults(test) == []
    if "signal_wide" in test.variables:
        correct_pyrometer(test, CALIBRATION, **CORRECTION)
    return test


CALIBRATION = xr.Dataset(
    {
        "fit_coefficient": ("fit_power", [0.40, 0.12, -0.003]),
        "fit_covariance": (("fit_power", "other_fit_power"), np.diag([1e-6, 2e-6, 2e-6])),
        "fit_range": ("bound", [973.0, 1773.0]),
        "instrument_range": ("bound", [973.0, 2073.0]),
    }
)
CORRECTION = {
    "signal_uncertainty": 0.01,
    "gas_variation": 0.03,
    "detection_level": 2.0,
    "least_surface_share": 0.5,
    "draws": 5,
    "seed": 1,
}


def write(place, files):
    for name, content in files.items():
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_bytes(content)


@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_file_ends_well(kind):
    described, files = KINDS[kind]

    @SETTINGS
    @given(st.data())
    def run(data):
        with tempfile.TemporaryDirectory() as name:
            place = samples.folder(Path(name), described)
            if kind == "matrix":
                words = (place / "test.yaml").read_text()
                (place / "test.yaml").write_text(
                    words.replace("attributes:\n", "attributes:\n  spectrometer_integration_time: 1\n")
                )
            victim = data.draw(st.sampled_from(sorted(files)))
            write(place, files | {victim: data.draw(damage(files[victim]))})
            clean_or_clear(place)

    with tempfile.TemporaryDirectory() as name:
        write(place := samples.folder(Path(name), described), files)
        if kind != "matrix":
            assert said(place)[0] == 0
    run()


def test_a_title_full_of_blanks_is_read_at_once():
    """Took 30 s of the processor by a pattern that tried every blank; found by 10 000 damaged tables."""
    described, files = KINDS["table"]
    with tempfile.TemporaryDirectory() as name:
        place = samples.folder(Path(name), described)
        padded = files["pyrometer.csv"].replace(b"t,", b"t" + b" " * 30_000 + b",", 1)
        write(place, {"pyrometer.csv": padded})
        assert said(place)[0] == 0


@SETTINGS
@given(st.data())
def test_a_damaged_description_ends_well(data):
    with tempfile.TemporaryDirectory() as name:
        place = samples.folder(Path(name), samples.CSV, pyrometer__csv=samples.table())
        content = (place / "test.yaml").read_bytes()
        (place / "test.yaml").write_bytes(data.draw(damage(content)))
        clean_or_clear(place)


def stored(name):
    """A test of the table in `samples` as netCDF; the path and its undamaged dataset."""
    place = samples.folder(Path(name) / "raw", samples.CSV, pyrometer__csv=samples.table())
    test = read_test(place)
    io.write(test, Path(name) / "test.nc", "test")
    return Path(name) / "test.nc", test


@SETTINGS
@given(st.data())
def test_a_damaged_netcdf_ends_well(data):
    with tempfile.TemporaryDirectory() as name:
        path, _ = stored(name)
        content = path.read_bytes()
        length = data.draw(st.integers(0, len(content)))
        flips = data.draw(st.lists(st.integers(0, len(content) - 1), min_size=1, max_size=6))
        changed = bytearray(content)
        for place in [*flips, data.draw(st.integers(0, 96))]:  # the signature and the superblock as well
            changed[place] ^= data.draw(st.integers(1, 255))
        path.write_bytes(bytes(changed[:length] if data.draw(st.booleans()) else changed))
        clean_or_clear(path)


def _cut(test, name, draw):
    return test.isel(time=slice(0, draw(st.integers(0, test.sizes["time"]))))


def _renamed(test, name, draw):
    return test.rename({name: "x"})


def _unit(test, name, draw):
    test[name].attrs["units"] = draw(st.sampled_from(["mA", "nA", "", "ms", "furlong", 3]))
    return test


def _unitless(test, name, draw):
    test[name].attrs.pop("units")
    return test


def _text(test, name, draw):
    return test.assign({name: ("time", np.array(["7"] * test.sizes["time"]))})


def _wide(test, name, draw):
    return test.assign({name: (("time", "other"), np.ones((test.sizes["time"], 2)), test[name].attrs)})


def _scalar(test, name, draw):
    return test.drop_vars(name).assign({name: ((), 1.0, test[name].attrs)})


def _shuffled(test, name, draw):
    return test.isel(time=draw(st.permutations(range(test.sizes["time"]))))


def _repeated(test, name, draw):
    return test.isel(time=draw(st.lists(st.integers(0, test.sizes["time"] - 1), min_size=1, max_size=9)))


def _poisoned(test, name, draw):
    values = test[name].values.copy()
    values[draw(st.integers(0, values.size - 1))] = draw(
        st.sampled_from([np.nan, np.inf, -np.inf, 1e300, -1e300, 5e-324])
    )
    return test.assign({name: ("time", values, test[name].attrs)})


def _attribute(test, name, draw):
    key = draw(st.sampled_from(sorted(set(test.attrs) - {"title"})))
    value = draw(st.sampled_from([None, "x", "", -1.0, 1e300, np.nan, [1.0, 2.0, 3.0], [5.0, 0.0], 0.0]))
    if value is None:
        del test.attrs[key]
    else:
        test.attrs[key] = value
    return test


SURGERY = [
    _cut,
    _renamed,
    _unit,
    _unitless,
    _text,
    _wide,
    _scalar,
    _shuffled,
    _repeated,
    _poisoned,
    _attribute,
]


@SETTINGS
@given(st.data())
def test_a_netcdf_of_another_make_ends_well_and_never_gives_a_wrong_number(data):
    """Every sample that comes out is one of the undamaged file, at its own time."""
    with tempfile.TemporaryDirectory() as name:
        path, test = stored(name)
        truth = {
            float(t): (float(a), float(b)) for t, a, b in zip(*(test[n].values for n in NAMES), strict=True)
        }
        poisoned = False
        for _ in range(data.draw(st.integers(1, 2))):
            variables = [one for one in NAMES if one in test.variables]
            if not variables or "time" not in test.dims or not test.sizes["time"]:
                break
            one, what = data.draw(st.sampled_from(variables)), data.draw(st.sampled_from(SURGERY))
            if what is _unitless and "units" not in test[one].attrs:
                continue
            try:
                test = what(test.copy(deep=True), one, data.draw)
            except ValueError:  # xarray allows no such dataset, so no file of it exists
                continue
            poisoned |= what is _poisoned
        path.unlink()
        test.to_netcdf(path, engine="netcdf4")
        found = clean_or_clear(path)
        if found is not None and set(NAMES) <= set(found.variables) and not poisoned:
            for time, *pair in zip(*(found[n].values for n in NAMES), strict=True):
                assert tuple(pair) == truth[float(time)]


def test_a_file_that_would_not_fit_into_memory_is_refused(tmp_path):
    path, test = stored(tmp_path)
    path.unlink()
    huge = test.isel(time=[0]).assign_coords(wavelength=("wavelength", [8e-7], {"units": "m"}))
    huge.to_netcdf(path, engine="netcdf4")
    with netCDF4.Dataset(path, "a") as file:
        file.createDimension("big", 10**12)
        file.createVariable("bomb", "f8", ("big",), zlib=True, chunksizes=(10**6,))
    code, messages = said(path)
    assert code == 2 and len(messages) == 2 and "says that it holds" in messages[1]


NAMES = ("time", "signal_wide", "signal_narrow")
TDMS = """pyrometer:
  file: log.tdms
  columns:
    time: {name: g/t}
    signal_wide: {name: g/S1}
    signal_narrow: {name: g/S2, unit: nA}
"""


def tdms_bytes():
    nptdms = pytest.importorskip("nptdms")
    rows = np.arange(20.0)
    channels = {"t": (rows, "s"), "S1": (50 + rows, "nA"), "S2": (30 + rows / 2, "")}
    stream = streams.BytesIO()
    with nptdms.TdmsWriter(stream) as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("g", k, v, {"unit_string": u} if u else {})
                for k, (v, u) in channels.items()
            ]
        )
    return stream.getvalue()


@SETTINGS
@given(st.data())
def test_a_damaged_tdms_ends_well(data):
    with tempfile.TemporaryDirectory() as name:
        content = tdms_bytes()
        place = samples.folder(Path(name), TDMS, log__tdms=content)
        assert said(place)[0] == 0
        if data.draw(st.booleans()):
            content = data.draw(damage(content))
        else:
            changed = bytearray(content)
            for spot in data.draw(st.lists(st.integers(0, len(content) - 1), min_size=1, max_size=4)):
                changed[spot] = data.draw(st.sampled_from([0, 1, 127, 128, 255]))
            content = bytes(changed)
        (place / "log.tdms").write_bytes(content)
        clean_or_clear(place)


CALIBRATION_YAML = """origin: synthetic
pyrometer:
  columns: {source_temperature: {name: T, unit: K}, signal_wide: {name: S1}, signal_narrow: {name: S2}}
spectrometer:
  source:
    certificate: lamp.csv
    uncertainty: 0.02
    columns: {wavelength: {name: w}, spectral_radiance: {name: L}}
  exposures: [{light: a.txt, dark: dark.txt}, {light: b.txt, dark: dark.txt}]
  linearity_coefficients: [1.01, -1e-6]
  masked_pixels: [0]
  hot_threshold: 6
"""


def calibration_files():
    example = Path(__file__).resolve().parents[2] / "docs" / "example" / "calibration" / "points.csv"
    rows = [line.split(";") for line in example.read_text().splitlines()[1:]]
    points = "".join(f"{float(t) + 273.15},{wide},{narrow}\n" for t, wide, narrow in rows)
    return {
        "calibration.yaml": CALIBRATION_YAML.encode(),
        "calibration_points.csv": ("T,S1 [nA],S2 [nA]\n" + points).encode(),
        "lamp.csv": b"w [nm],L [W/m2/sr/nm]\n740,10\n770,12\n800,14\n",
        "a.txt": samples.spectrum("spectrasuite"),
        "b.txt": samples.spectrum("oceanview"),
        "dark.txt": samples.spectrum("spectrasuite", samples.DARK),
    }


@pytest.mark.parametrize("victim", ["calibration.yaml", "calibration_points.csv", "lamp.csv", "a.txt"])
def test_a_damaged_calibration_ends_well(victim):
    @SETTINGS
    @given(st.data())
    def run(data):
        with tempfile.TemporaryDirectory() as name:
            files = calibration_files()
            write(Path(name), files)
            (Path(name) / victim).write_bytes(data.draw(damage(files[victim])))
            if victim == "calibration.yaml" and not (Path(name) / victim).exists():
                return
            code, messages = said(Path(name))
            assert check_calibration(name) == [] if code == 0 else messages
            if code == 0:
                for read, contract in (
                    (read_points, "calibration_points"),
                    (read_exposures, "spectrometer_exposures"),
                ):
                    with contextlib.suppress(contracts.ContractError):
                        contracts.check(read(name), contract)

    with tempfile.TemporaryDirectory() as name:
        write(Path(name), calibration_files())
        assert said(Path(name))[0] == 0
    run()


@SETTINGS
@given(st.data())
def test_lines_and_columns_moved_about_never_give_a_wrong_number(data):
    """Every sample that comes out stands in the undamaged file: time, wide and narrow together."""
    header, *rows = [line.split(",") for line in samples.table().splitlines()]
    truth = {float(t): (float(a) * 1e-9, float(b) * 1e-9) for t, a, b in rows}
    order = data.draw(st.permutations(range(3)))
    kept = data.draw(st.lists(st.sampled_from(range(len(rows))), min_size=1, max_size=25))
    mark, decimal = data.draw(st.sampled_from([(",", "."), (";", ","), ("\t", "."), ("\t", ","), (" ", ".")]))
    end = data.draw(st.sampled_from(["\n", "\r\n", "\r"]))
    lines = [
        mark.join(row[i].replace(".", decimal) for i in order) for row in [header, *(rows[k] for k in kept)]
    ]
    text = end.join(lines) + end
    text = text[: data.draw(st.integers(1, len(text)))] if data.draw(st.booleans()) else text
    with tempfile.TemporaryDirectory() as name:
        encoding = data.draw(st.sampled_from(["utf-8", "utf-8-sig", "utf-16"]))
        described = samples.CSV + "  zero: 0\n"
        place = samples.folder(Path(name), described, pyrometer__csv=text.encode(encoding))
        test = clean_or_clear(place)
        if test is not None:
            for time, wide, narrow in zip(test.time, test.signal_wide, test.signal_narrow, strict=True):
                np.testing.assert_allclose([wide, narrow], truth[float(time)], rtol=1e-12)


@SETTINGS
@given(st.data())
def test_spectra_with_columns_moved_about_never_give_a_wrong_number(data):
    """In a table of spectra every count belongs to its time and its wavelength, dark and light alike."""
    pixels, times = np.array([800.1, 800.5, 800.9, 801.3]), np.arange(0.5, 6.0)
    counts = 100 + 10 * np.arange(times.size)[:, None] + np.arange(4)
    order = list(data.draw(st.permutations(range(4))))
    dark_order = order if data.draw(st.booleans()) else list(data.draw(st.permutations(range(4))))

    def text(rows, moments, columns):
        head = ",".join(["t", *(f"{pixels[i]}" for i in columns)])
        body = [
            ",".join([f"{t}", *(f"{row[i]}" for i in columns)]) for t, row in zip(moments, rows, strict=True)
        ]
        return "\n".join([head, *body]) + "\n"

    with tempfile.TemporaryDirectory() as name:
        place = samples.folder(
            Path(name),
            KINDS["matrix"][0] + "  wavelengths: vacuum\n",
            s__csv=text(counts, times, order),
            d__csv=text([[1, 2, 3, 4]], [0.0], dark_order),
        )
        words = (place / "test.yaml").read_text()
        (place / "test.yaml").write_text(
            words.replace("attributes:\n", "attributes:\n  spectrometer_integration_time: 1\n")
        )
        test = clean_or_clear(place)
        assert (test is None) == (order != dark_order)
        if test is not None:
            np.testing.assert_allclose(test.wavelength, pixels * 1e-9, rtol=1e-12)
            np.testing.assert_array_equal(test.counts, counts)
            np.testing.assert_array_equal(test.background_counts, [1, 2, 3, 4])


@pytest.mark.parametrize(
    ("header", "stated", "expected"),
    [
        ("S1 [nA]", "", 1e-9),
        ("S1 [nA]", ", unit: nA", 1e-9),
        ("S1", ", unit: uA", 1e-6),
        ("S1 (mA)", ", unit: A", None),
        ("S1 (mA)", ", unit: mA, scale: 2", 2e-3),
        ("S1", "", None),
        ("S1 [V]", "", None),
        ("S1 [V]", ", unit: A, scale: 1e-6", 1e-6),
    ],
)
def test_a_unit_is_stated_once_and_without_contradiction(tmp_path, header, stated, expected):
    described = samples.CSV.replace("{name: S1, unit: nA}", f"{{name: S1{stated}}}")
    place = samples.folder(tmp_path, described, pyrometer__csv=samples.table(header=f"t,{header},S2"))
    test = clean_or_clear(place)
    assert (test is None) == (expected is None)
    if test is not None:
        np.testing.assert_allclose(test.signal_wide[:2], np.array([50, 51]) * expected, rtol=1e-12)
