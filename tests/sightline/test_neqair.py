"""Line-of-sight text in both layouts of NEQAIR: what others wrote is read, what we write reads back."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.constants import BOLTZMANN
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.sightline import neqair

NINTH_DIGIT = 1e-8  # relative
EIGHTH_DIGIT = 2e-7  # of thickness: two positions of 8 digits each

# The head of a file as the public programs that prepare such files write it, numbers of our own.
BLOCKS = """\
********************************************************************************
               LOS file for a sample case

       An unlimited number of comment lines can go here.

********************************************************************************
         aaaaaaaa       aaaaaaaa       aaaaaaaa       aaaaaaaa    (2x,(7x,a8))
         E-             N              N+             NO          :Species Symbols.
         N2             O

--------------------------------------------------------------------------------
    no.   x,cm   total partcc       t        tr        tv        te  (i5,f8.3,
iiiii rrrrrrr rrrrrrrrrrrrrr rrrrrrrrr rrrrrrrrr rrrrrrrrr rrrrrrrrre15.6,4f10.1
      rrrrrrrrrrrrrr rrrrrrrrrrrrrr rrrrrrrrrrrrrr rrrrrrrrrrrrr   (6x,4e15.6)
      Include these 9 lines (from --- to --- lines) for first grid point only!!
      End each grid point entry with a blank line.
      End data file with a line of zeros as shown on the next line.
   0     0.0            0.0       0.0       0.0       0.0       0.0
--------------------------------------------------------------------------------
    1   0.000   4.620000E+16    9000.0    9000.0    9000.0    9000.0
       1.000000E+15   2.000000E+16   1.000000E+15   2.000000E+14
       4.000000E+15   2.000000E+16

    2  10.160   4.620000E+16    8000.0    8000.0    8000.0    8000.0
       1.000000E+15   2.000000D+16   1.000000E+15   2.000000+14
       4.000000E+15   2.000000E+16

    3  12.160   4.620000E+16    7000.0    7000.0    7000.0    7000.0
       1.000000E+15   2.000000E+16   1.000000E+15   2.000000E+14
       4.000000E+15   2.000000E+16

    0     0.0            0.0       0.0       0.0       0.0       0.0
"""
COLUMNS = """\
#15.0
#

n        x        ntot        Tt        N2        N        E-
0        0.0        3e+16        8000        1e16        1.5e16        5e+15
1        0.5        3e+16        8000        1e16        1.5e16        5e+15
2        1.5        3e+16        7000        1e16        1.5e16        5e+15
"""


def layers(sightline):
    """Thickness, temperature and densities of the engine's layers, equal neighbours as one."""
    distance = sightline.path_distance.values
    edges = np.concatenate([distance[:1], (distance[1:] + distance[:-1]) / 2, distance[-1:]])
    state = np.vstack([sightline.temperature.values, sightline.number_density.values])
    new = np.concatenate([[True], (np.diff(state, axis=1) != 0).any(axis=0)])
    return np.diff(np.concatenate([edges[:-1][new], edges[-1:]])), state[:, new]


@pytest.fixture(scope="module")
def path():
    distance = np.array([0.0, 1e-5, 1e-3, 4e-3, 0.02, 0.1, 0.3, 1.0])
    temperature = np.array([351.25, 1234.5, 4321.0, 6000.25, 7123.5, 6900.75, 800.5, 300.0])
    density = number_density(temperature, 5000.0).T
    return xr.Dataset(
        {
            "temperature": ("path_distance", temperature),
            "pressure": ("path_distance", np.full(8, 5000.0)),
            "number_density": (("species", "path_distance"), density),
        },
        {"path_distance": distance, "species": list(SPECIES)},
    )


def test_blocks_as_public_programs_write_them():
    found = neqair.parse(BLOCKS)
    contracts.check(contracts.label(found, "sightline"), "sightline")
    thickness, state = layers(found)
    # The state of the first grid point is not used: it only sets the origin.
    assert thickness == pytest.approx([0.1016, 0.02], rel=1e-12)
    assert state[0].tolist() == [8000.0, 7000.0]
    density = dict(zip(SPECIES, state[1:, 0], strict=True))
    expected = {"e-": 1e21, "N": 2e22, "N+": 1e21, "NO": 2e20, "N2": 4e21, "O": 2e22}
    assert {name: n for name, n in density.items() if n} == pytest.approx(expected)
    assert float(found.pressure[0]) == pytest.approx(4.62e22 * BOLTZMANN * 8000)


def test_columns_as_public_programs_write_them():
    thickness, state = layers(neqair.parse(COLUMNS))
    assert thickness == pytest.approx([0.005, 0.01], rel=1e-12)
    assert state[0].tolist() == [8000.0, 7000.0]
    assert state[1 + SPECIES.index("N"), 0] == pytest.approx(1.5e22)
    assert state[1 + SPECIES.index("e-"), 0] == pytest.approx(5e21)


def test_columns_need_neither_number_nor_total_and_may_use_commas():
    text = "15\n x, Tt, Te, N, e-\n0, 5000, 5000, 1e16, 1e10\n1, 5e3, 5e3, 1e16, 0\n"
    found = neqair.parse(text)
    assert found.path_distance.values.tolist() == [0.0, 0.01]
    assert float(found.number_density.sel(species="N")[1]) == pytest.approx(1e22)


def test_what_is_written_reads_back_as_the_same_layers(path):
    before, after = layers(path), layers(neqair.parse(neqair.compose(path)))
    assert after[0] == pytest.approx(before[0], rel=EIGHTH_DIGIT, abs=1e-7)
    assert after[1] == pytest.approx(before[1], rel=NINTH_DIGIT, abs=1e-6)


def test_a_second_round_changes_nothing(path):
    first = neqair.parse(neqair.compose(path))
    again = neqair.parse(neqair.compose(first))
    ours, theirs = layers(first), layers(again)
    assert theirs[0] == pytest.approx(ours[0], rel=EIGHTH_DIGIT, abs=1e-7)
    np.testing.assert_array_equal(theirs[1], ours[1])


def test_the_layout_is_that_of_version_15(path):
    columns = neqair.compose(path).splitlines()
    assert columns[0] == "#15.0"
    titles = next(line for line in columns if not line.startswith("#")).split()
    assert titles[:7] == ["n", "x", "ntot", "Tt", "Tr", "Tv", "Te"] and titles[-1] == "E-"


def test_two_temperatures_come_through():
    text = BLOCKS.replace("8000.0    8000.0\n", "6500.0    6500.0\n")
    found = neqair.parse(text)
    assert found.temperature.values.tolist() == [8000.0, 8000.0, 7000.0, 7000.0]
    assert found.excitation_temperature.values.tolist() == [6500.0, 6500.0, 7000.0, 7000.0]
    assert float(found.pressure[0]) == pytest.approx(BOLTZMANN * (4.52e22 * 8000 + 1e21 * 6500))
    contracts.check(contracts.label(found, "sightline"), "sightline")
    again = neqair.parse(neqair.compose(found))
    np.testing.assert_array_equal(again.excitation_temperature[[0, -1]], [6500.0, 7000.0])


def changed(text, old, new):
    assert text.count(old) >= 1
    return text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: the file is empty"),
        (BLOCKS[:700], r"line 1\d: the file ends before the second line of hyphens"),
        (BLOCKS[: BLOCKS.index("    3  12")], "line 27: the file ends before the closing line of zeros"),
        (
            BLOCKS[: BLOCKS.rindex("       4.000000E+15")],
            "line 29: the file ends within a grid point, after 4 of 6 densities",
        ),
        (
            changed(BLOCKS, "4.000000E+15   2.0", "4.000000E+1Z   2.0"),
            "line 22: '4.000000E\\+1Z' is not a number",
        ),
        (changed(BLOCKS, "    8000.0    8000.0    8000.0", "    8000.0"), "line 24: .* 5 words found"),
        (changed(BLOCKS, "NO  ", "Xe  "), "line 8: unknown species 'Xe'; known are N2, O2"),
        (changed(BLOCKS, "NO  ", "N+  "), r"line 8: species 'N\+' is listed twice"),
        (changed(BLOCKS, "  10.160", "  -0.160"), "line 24: x must increase; got 0 cm then -0.16 cm"),
        (changed(BLOCKS, "2.000000+14", "-2.00000+14"), "line 24: number densities must be >= 0 cm-3"),
        (changed(BLOCKS, "2.000000+14", "2.000000+16"), "line 24: the species add up to 6.6e\\+16 cm-3"),
        (
            changed(BLOCKS, "8000.0    8000.0\n", "8000.0    9000.0\n"),
            "line 24: these .* TV = 8000 K and TE = 9000 K",
        ),
        (
            changed(BLOCKS, "   8000.0    8000.0", "   8000.0    7000.0"),
            "line 24: these .* T = 8000 K and TR = 7000",
        ),
        (changed(COLUMNS, "Tt", "Te"), "line 4: no translational temperature"),
        (changed(BLOCKS, "   7000.0", "  -7000.0"), "line 28: temperatures must be > 0 K; got -7000 K"),
        (
            changed(BLOCKS, "4.620000E+16    8000.0", "         nan    8000.0"),
            "line 24: 'nan' is not a number",
        ),
        (COLUMNS[: COLUMNS.rindex("        5e+15")], "line 7: 7 columns expected, 6 found"),
        (COLUMNS[:8], "line 2: the file ends before the line of column titles"),
        (
            COLUMNS[: COLUMNS.index("1        0.5")],
            "line 5: a line of sight needs at least 2 grid points; got 1",
        ),
        (changed(COLUMNS, "Tt", "Q"), "line 4: column titles must be"),
        (changed(COLUMNS, "ntot", "rho"), "line 4: columns before the temperatures must be n, x and ntot"),
        (changed(COLUMNS, "E-", "He"), "line 4: unknown species 'He'"),
        (
            changed(COLUMNS, "1.5        3e", "0.5        3e"),
            "line 7: x must increase; got 0.5 cm then 0.5 cm",
        ),
        (changed(COLUMNS, "0.5        3e+16", "0.5        3e+16x"), "line 6: '3e\\+16x' is not a number"),
    ],
)
def test_a_garbled_file_is_refused_with_the_line(text, message):
    with pytest.raises(ValueError, match=message):
        neqair.parse(text)


@pytest.mark.parametrize("written", [True, False])
def test_a_file_cut_off_anywhere_within_a_number_is_refused_with_one_line(path, written):
    text, shares = (neqair.compose(path), (0.1, 0.3, 0.5, 0.7, 0.9)) if written else (BLOCKS, (0.7, 0.8, 0.9))
    for share in shares:
        cut = text[: text.rindex("E", 0, int(share * len(text)))]
        with pytest.raises(ValueError, match=r"^line \d+: ") as refusal:
            neqair.parse(cut)
        assert "\n" not in str(refusal.value)
