"""Mixtures are counted by a list of pairs where one is given, whatever this code names of their parts."""

from pathlib import Path

import made_spectra as made
import numpy as np
import pytest


@pytest.fixture
def species(monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).resolve().parents[2] / "benchmarks")
    import species

    return species


@pytest.fixture
def folder(tmp_path):
    for name, lines in (("Cu", made.COPPER), ("Na", made.SODIUM)):
        axis, counts = made.spectrum(lines, peak=5e4)
        np.savetxt(
            tmp_path / f"{name}.csv",
            np.column_stack([axis * 1e9, counts]),
            delimiter=",",
            header="wavelength,spectrum",
            comments="",
        )
    return tmp_path


def test_a_list_of_pairs_is_read_as_it_was_written(species, folder, tmp_path):
    pairs = species.pairs_of(species.single(folder))
    assert {(one.host, one.admixture, one.element) for one in pairs} == {
        ("Cu", "Na", "Na"),
        ("Na", "Cu", "Cu"),
    }
    assert all(set(one.shown) == {"Cu", "Na"} and one.snr > species.CLEAR for one in pairs)
    species.write(tmp_path / "pairs.csv", pairs)
    assert species.read(tmp_path / "pairs.csv") == pairs


@pytest.mark.parametrize(("shown", "snr"), [(("Cu", "Na"), 1e4), (("Cu",), 1e4), (("Cu", "Na"), 0.0)])
def test_a_list_says_which_names_are_false_and_which_lines_count(species, folder, shown, snr):
    """Sodium is named at all shares; who listed the pair may not have seen it, or no clear line of it."""
    listed = [species.Pair("Cu", "Na", "Na", shown, snr)]
    _, clear, first, sure, false, _, count = np.sum(species.board(folder, 9, seed=1, pairs=listed), axis=0)
    assert count == len(species.SHARES)
    assert clear == first == sure == (count if snr else 0)
    assert false == (0 if "Na" in shown else count)
