"""Where a calibration is looked for."""

import shutil

import pytest

from plasmapyro.commands.instrument import calibration_of


@pytest.mark.parametrize("given", [".", "my_test", "my_test/test.yaml/..", "whole path"])
def test_the_folder_beside_a_test_is_found_wherever_one_stands(tmp_path, monkeypatch, capsys, given):
    test, beside = tmp_path / "my_test", tmp_path / "calibration"
    test.mkdir()
    beside.mkdir()
    (beside / "calibration.nc").touch()
    monkeypatch.chdir(test if given == "." else tmp_path)
    with calibration_of(test if given == "whole path" else given) as found:
        assert found.resolve() == beside
    shutil.rmtree(beside)
    with (
        pytest.raises(ValueError, match=r"neither .*calibration nor .*calibration is there"),
        calibration_of(given),
    ):
        pass
