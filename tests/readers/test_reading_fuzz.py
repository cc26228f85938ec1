"""Thousands of damaged inputs: each ends in a clean dataset or in clear messages, none in anything else.

`PLASMAPYRO_FUZZ=10000 pytest tests/readers/test_reading_fuzz.py` runs that many of each kind.
"""

import os
import tempfile
from pathlib import Path

import numpy as np
import pytest
import samples
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plasmapyro import contracts, io
from plasmapyro.experiment import inputs
from plasmapyro.readers.stage import check_test, read_test

EXAMPLES = int(os.environ.get("PLASMAPYRO_FUZZ", "60"))
LONGEST_MESSAGE = 2000
SETTINGS = settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
POISON = [
    b"",
    b"\0",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
    b"NaN",
    b"inf",
    b"1e999",
    b"-",
    b"1_0",
    b"1,2,3",
    b"\xb2",
    b'"',
]
POISON += [
    b"\n",
    b"\r",
    b";",
    b"\t",
    b",",
    b".",
    b"9" * 400,
    b">>>>>",
    b"[ms]",
    b"&a",
    b"*a",
    b"{",
    b": ",
    b"\xc2\xb5",
]
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


@st.composite
def damage(draw, content):
    """Bytes made from `content` by a few of the accidents that happen to files."""
    for _ in range(draw(st.integers(1, 3))):
        place = draw(st.integers(0, max(len(content) - 1, 0)))
        what = draw(
            st.sampled_from(["cut", "insert", "replace", "remove", "repeat", "swap", "recode", "noise"])
        )
        lines = content.splitlines(keepends=True)
        index = draw(st.integers(0, max(len(lines) - 1, 0)))
        if what == "cut":
            content = content[:place]
        elif what == "insert":
            content = content[:place] + draw(st.sampled_from(POISON)) + content[place:]
        elif what == "replace":
            content = content[:place] + draw(st.binary(min_size=1, max_size=4)) + content[place + 1 :]
        elif what == "remove":
            content = b"".join(lines[:index] + lines[index + 1 :])
        elif what == "repeat" and lines:
            content = b"".join([*lines[:index], lines[index], *lines[index:]])
        elif what == "swap" and len(lines) > 1:
            lines[index], lines[0] = lines[0], lines[index]
            content = b"".join(lines)
        elif what == "recode":
            target = draw(st.sampled_from(["utf-16", "utf-8-sig", "utf-32"]))
            content = content.decode("latin-1").encode(target)
        elif what == "noise":
            content = draw(st.binary(max_size=200))
    return content


def clean_or_clear(place):
    """A dataset that honours its contract, or messages; the same verdict from both functions."""
    found = check_test(place)
    if found:
        assert all(isinstance(words, str) and 0 < len(words) < LONGEST_MESSAGE for words in found), found
        assert all(words.replace("\n", "").isprintable() for words in found), found
        with pytest.raises(contracts.ContractError):
            read_test(place)
        return None
    test = contracts.check(read_test(place), "test")
    assert inputs.faults(test) == []
    return test


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
            assert check_test(place) == []
    run()


@SETTINGS
@given(st.data())
def test_a_damaged_description_ends_well(data):
    with tempfile.TemporaryDirectory() as name:
        place = samples.folder(Path(name), samples.CSV, pyrometer__csv=samples.table())
        content = (place / "test.yaml").read_bytes()
        (place / "test.yaml").write_bytes(data.draw(damage(content)))
        clean_or_clear(place)


@SETTINGS
@given(st.data())
def test_a_damaged_netcdf_ends_well(data):
    with tempfile.TemporaryDirectory() as name:
        place = samples.folder(Path(name) / "raw", samples.CSV, pyrometer__csv=samples.table())
        stored = Path(name) / "test.nc"
        io.write(read_test(place), stored, "test")
        content = stored.read_bytes()
        length = data.draw(st.integers(0, len(content)))
        flip = data.draw(st.integers(0, 96))  # the signature and the superblock
        changed = bytearray(content[:length])
        if flip < length:
            changed[flip] ^= data.draw(st.integers(1, 255))
        stored.write_bytes(bytes(changed))
        clean_or_clear(stored)


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
