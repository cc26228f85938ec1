"""The command that corrects logged readings: one table in, one file out, faults in one sentence."""

import re

import numpy as np
import pytest
from gas_signals import gas

from plasmapyro import cli, io
from plasmapyro.commands.calibrate import RESPONSE
from plasmapyro.commands.correct_reading import read_readings
from plasmapyro.instrument.stage import band_response, ratio_curve


@pytest.fixture
def results(tmp_path):
    folder = tmp_path / "results"
    response = band_response(**RESPONSE)
    curve = ratio_curve(
        response,
        sensitivity_ratio=0.315,
        calibration_temperature=np.arange(300.0, 10000.0, 10.0),
        instrument_range=[973.0, 2073.0],
    )
    io.write(gas(), folder / "analysis/gas_signal.nc", "gas_signal")
    io.write(response, folder / "instrument/response.nc", "response")
    io.write(curve, folder / "instrument/ratio_curve.nc", "ratio_curve")
    return folder


def run(results, table, *more):
    path, out = results.parent / "log.dat", results.parent / "out.nc"
    path.write_text(table)
    status = cli.main(["correct-reading", str(path), "--results", str(results), "--out", str(out), *more])
    return status, out


def test_a_log_becomes_a_file_and_a_summary(results, capsys):
    table = "time [s] \t Ts [K] \n 1.0\t1400.5\n 2.0\t1559\n\n"
    status, out = run(results, table, "--condition", "60kW", "--floor-k", "1264")
    assert status == 0
    found = io.read(out, "corrected_reading")
    assert found.surface_temperature.values == pytest.approx([1398, 1558], abs=3)
    assert "2 two surface temperatures" in capsys.readouterr().out


def test_a_display_that_ends_above_the_surface_tells_no_temperature(results, capsys):
    """While the surface is colder a display shows the least it can: none if stated, asked for if not."""
    shown = np.maximum(1264.0, np.linspace(400.0, 1700.0, 60).round())
    table = "time [s];Ts [K]\n" + "".join(f"{second};{one:g}\n" for second, one in enumerate(shown))
    status, out = run(results, table, "--condition", "60kW", "--floor-k", "1264")
    found = io.read(out, "corrected_reading")
    assert status == 0
    assert np.isnan(found.surface_temperature.values[shown == 1264.0]).all()
    assert np.isfinite(found.surface_temperature.values[shown > 1300.0]).all()
    assert "in a row" not in capsys.readouterr().err
    assert run(results, table, "--condition", "60kW")[0] == 0
    assert "40 readings in a row show 1264 K, from 0 s on, and none shows less" in capsys.readouterr().err


@pytest.mark.parametrize(
    "table",
    [
        "time [s];Ts [K]\n1,25;1400,5\n2,5;1559\n",
        "time [s]\tTs [K]\n1,25\t1400,5\n2,5\t1559\n",
        "time [s]\tTs [K]\n1.25\t1400.5\t\n2.5\t1559\t\n",
        "time [s], Ts [K]\n1.25, 1400.5\n2.5, 1559\n",
        "time [s]  Ts [K]\n1.25   1400.5\n2.5    1559\n",
        "time [s] Ts [K]\n1,25 1400,5\n2,5 1559,0\n",
        "Zeit\tTemperatur\ns\t°C\n1,25\t1127,35\n2,5\t1285,85\n",
        'No,time [ms],T [degC]\n1,"1250,00","1127,35"\n2,"2500,00","1285,85"\n',
        "time [s],slope,Ts [K]\n1.25,1,1400.5\n2.5,1,1559\n",
    ],
    ids=[
        "semicolons",
        "tabs and commas",
        "final tabs",
        "commas",
        "blanks",
        "blanks and commas",
        "units below",
        "quoted commas",
        "a column between",
    ],
)
def test_cells_stand_between_any_usual_marks(tmp_path, table):
    (tmp_path / "log.csv").write_text(table)
    time, reading = read_readings(tmp_path / "log.csv")
    np.testing.assert_array_equal(time, [1.25, 2.5])
    np.testing.assert_allclose(reading, [1400.5, 1559.0], rtol=1e-14)


def test_a_time_of_day_counts_from_the_first_reading_and_fills_are_none(tmp_path):
    rows = "".join(f"12:59:{second}.5;{1400 + second},0\n" for second in range(50, 60))
    (tmp_path / "log.csv").write_text("Uhrzeit;Temperatur [°C]\n" + rows + "13:00:00.5;-9999\n")
    time, reading = read_readings(tmp_path / "log.csv")
    np.testing.assert_allclose(time, np.arange(11.0), atol=1e-9)
    np.testing.assert_allclose(reading[:-1], 1400 + np.arange(50, 60) + 273.15)
    assert np.isnan(reading[-1])


def test_commas_that_may_part_thousands_are_asked_about(tmp_path):
    (tmp_path / "log.csv").write_text("time [s];Ts [K]\n1;1,400\n2;1,559\n")
    with pytest.raises(ValueError, match="decimals or thousands"):
        read_readings(tmp_path / "log.csv")


def test_a_column_of_slope_settings_is_held_against_the_one_that_is_told(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time [s];Slope;Ts [K]\n0;1,05;1350\n1;1,05;1360\n2;1,05;1370\n")
    np.testing.assert_array_equal(read_readings(path, 1.05)[1], [1350, 1360, 1370])
    with pytest.raises(ValueError, match="'Slope' says 1.05, the slope setting is 1; correct the rows"):
        read_readings(path)
    path.write_text(path.read_text().replace("2;1,05", "2;0,98"))
    with pytest.raises(ValueError, match="'Slope' says 0.98 and 1.05, the slope setting is 1.05"):
        read_readings(path, 1.05)


@pytest.mark.parametrize("mark", ["----", "<1264", "> 2073", "EEEE", ""])
def test_a_mark_in_a_short_log_is_a_reading_that_is_missing(tmp_path, mark):
    (tmp_path / "log.csv").write_text(f"time [s];T [K]\n0;1350\n1;{mark}\n2;1370\n3;1380\n")
    if mark == "EEEE":  # could be anything
        with pytest.raises(ValueError, match="'EEEE' in column 'T' is not a number"):
            read_readings(tmp_path / "log.csv")
        return
    np.testing.assert_array_equal(read_readings(tmp_path / "log.csv")[1], [1350, np.nan, 1370, 1380])


def test_a_condition_of_ones_own_is_found_and_only_its_ladder_says_what_power_does(results, capsys):
    nitrogen = gas({"60kW": (1.0, 0.2), "70kW": (1.5, 0.3), "71kW": (3.0, 0.6)})
    nitrogen = nitrogen.assign_coords(condition=["n60", "n70", "air71"])
    stated = nitrogen.assign(first_of_ladder=("condition", ["n60", "n60", "air71"]))
    table = "time [s] Ts [K]\n1 1400\n2 1700\n"
    width = []
    for own in (nitrogen, stated):
        io.write(own, results / "analysis/gas_signal_own.nc", "gas_signal")
        status, out = run(results, table, "--condition", "n70")
        assert status == 0
        found = io.read(out, "corrected_reading")
        width.append(found.surface_temperature_high - found.surface_temperature_low)
    assert float(width[1][1]) < 0.5 * float(width[0][1])
    capsys.readouterr()
    assert run(results, table, "--condition", "air71")[0] == 2
    assert "a second condition that differs in its power only" in capsys.readouterr().err


def test_commas_and_celsius_are_taken(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time [min], temperature [C]\n0.5, 1000\n1, 1100\n")
    time, reading = read_readings(path)
    assert np.array_equal(time, [30.0, 60.0])
    assert np.array_equal(reading, [1273.15, 1373.15])


@pytest.mark.parametrize(
    "table, message",
    [
        ("1 2\n3 4\n", "no columns of numbers named time and temperature; it begins '1 2'"),
        ("time [s] Ts [F]\n1 2\n", "column 'Ts' is in 'F'; write K or °C"),
        ("time [s],T [F]\n1,2300\n2,2310\n", "column 'T' is in 'F'; write K or °C"),
        (
            "t [s],T_1C [C],T_2C [C]\n1,1100,1150\n2,1110,1160\n",
            "columns 'T_1C' and 'T_2C' are temperatures; call that of both colours 'reading'",
        ),
        ("time,Ts [K]\n1,1500\n2,1500\n", "column 'time' has no unit"),
        (
            "time [s] Ts [K]\n" + "".join(f"{n} 1500\n" for n in range(15)) + "16 x\n",
            "line 17: 'x' in column 'Ts'",
        ),
        ("time [s] Ts [K]\n2 1500\n1 1500\n", "the time runs backwards: sample 2 is at 1 s after 2 s"),
        ("time [s] Ts [K]\n", "holds no columns of numbers"),
        ("", "is empty"),
        ("time [s] Ts [K]\n1 1500\n1 1500\n", "remove their copies"),
        (
            "time [s] Ts [K]\n1 1500\n2 0\n",
            "column 'Ts' holds 0 K at 2 s, which no surface has (100 to 10000",
        ),
        ("time [s], Ts [K]\n1400, 1\n1559, 2\n", "holds 1 K at 1400 s, which no surface has"),
        ("time [s]; Ts [K]\n1; 1.400\n2; 1.559\n", "see whether columns, unit and decimal sign are right"),
        ("time [s], Ts [K]\n1,5, 1400,5\n2,5, 1559,2\n", "commas in the numbers as well?"),
    ],
)
def test_bad_tables_are_refused_in_one_sentence(results, capsys, table, message):
    status, out = run(results, table, "--condition", "60kW")
    assert status == 2
    assert message in capsys.readouterr().err
    assert not out.exists()


def test_readings_that_the_instrument_cannot_show_are_doubted(results, capsys):
    kelvin_as_celsius = "time [s] Ts [C]\n1 1400\n2 2559\n3 650\n"
    assert run(results, kelvin_as_celsius, "--condition", "60kW")[0] == 0
    assert "2 of 3 readings lie outside the 973 to 2073 K" in capsys.readouterr().err
    assert run(results, "time [ms],Ts [K]\n1000,NaN\n2000,1559\n3000,OVER\n", "--condition", "60kW")[0] == 0
    said = capsys.readouterr()
    assert "outside" not in said.err
    assert "2 without a reading" in said.out


def test_the_summary_says_what_it_does_not_know(results, capsys):
    celsius_as_kelvin = "time [s] Ts [K]\n1 1400\n2 990\n"
    assert run(results, celsius_as_kelvin, "--condition", "60kW")[0] == 0
    said = capsys.readouterr().out
    assert re.search(r"95 % intervals of the surface \+-\d+\.\d", said)
    assert "ablating surface" in said
    assert re.search(r"1 readings are below 1\d\d\d K, which no surface shows.*Celsius called kelvin", said)


def test_an_unknown_condition_is_refused(results, capsys):
    status, out = run(results, "time [s] Ts [K]\n1 1500\n", "--condition", "61kW")
    assert status == 2
    assert "no condition '61kW'; known: 60kW" in capsys.readouterr().err
    assert not out.exists()
