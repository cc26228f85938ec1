"""Marks between thousands: read where they can be nothing else, asked about where they may be decimals."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro import cli
from plasmapyro.readers.columns import read_table
from plasmapyro.readers.spectra_table import read_matrix
from plasmapyro.readers.stage import check_test


@pytest.mark.parametrize(
    ("habit", "decimal"),
    [
        (lambda value: f"{value:,.0f}", None),
        (lambda value: f"{value:,.0f}".replace(",", "."), None),
        (lambda value: f"{value:,.1f}".replace(",", " ").replace(".", ","), None),
        (lambda value: f"{value / 100:,.0f}", "."),
    ],
    ids=["1,234,567", "1.234.567", "1 234 567,0", "12,345 with `decimal`"],
)
@pytest.mark.parametrize("mark", [";", "\t"])
def test_thousands_of_a_whole_table_are_told_by_the_cells_that_can_be_nothing_else(
    tmp_path, habit, decimal, mark
):
    signal = 9.8e5 + 12_345.0 * np.arange(12)
    rows = [mark.join((str(time), habit(one), habit(one / 2))) for time, one in enumerate(signal)]
    table = mark.join(("Time [s]", "S1 [nA]", "S2 [nA]")) + "\n" + "\n".join(rows) + "\n"
    (tmp_path / "log.csv").write_text(table)
    names = {"time": "Time", "signal_wide": "S1"}
    columns = {
        key: SimpleNamespace(header=name, name=key, unit=None, scale=1.0, format=None)
        for key, name in names.items()
    }
    found = read_table(tmp_path / "log.csv", columns, None, decimal)["signal_wide"]
    np.testing.assert_allclose(found, signal / (100 if decimal else 1) * 1e-9, atol=1e-9)


def test_one_group_of_thousands_is_asked_about_once_and_not_guessed_by_init(tmp_path):
    rows = "".join(f"{time};{10 + time},511;{2 + time},192\n" for time in range(12))
    (tmp_path / "pyrometer.csv").write_text("Time [s];S1 [nA];S2 [nA]\n" + rows)
    assert cli.main(["init", str(tmp_path)]) == 0
    assert "  decimal:" not in (tmp_path / "test.yaml").read_text()
    faults = [one for one in check_test(tmp_path) if "pyrometer.csv" in one]
    assert len(faults) == 1
    assert "decimals or thousands?; state `decimal`" in faults[0]


def test_counts_of_a_table_of_spectra_are_parted_where_the_sign_is_stated(tmp_path):
    (tmp_path / "spectra.csv").write_text("time;750.12;751.98\n0.5;2,345;1,001\n")
    np.testing.assert_array_equal(read_matrix(tmp_path / "spectra.csv", ";", ".")[2], [[2345, 1001]])


def test_numbers_of_two_decimal_signs_are_one_fault_beside_the_words(tmp_path):
    (tmp_path / "test.yaml").write_text(
        "pyrometer:\n  columns:\n    time: {name: t, unit: s}\n"
        "    signal_wide: {name: S1, unit: nA}\n    signal_narrow: {name: S2, unit: nA}\n"
    )
    (tmp_path / "pyrometer.csv").write_text("t;S1;S2\n0.25;1.234.567;1,5\n0.50;1.234.568;1,5O\n")
    faults = [one for one in check_test(tmp_path) if "pyrometer.csv" in one]
    assert ["mixed" in one for one in faults] == [True, False]
    assert "'1,5O'" in faults[1]
