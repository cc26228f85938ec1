"""The command line: what it writes, what it refuses, how it ends."""

import csv
import io as io_streams
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import plasmapyro
from plasmapyro import cli, io, progress
from plasmapyro.commands import radiance
from plasmapyro.commands.correct import ESTIMATORS
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.quality.catalogue import OF_CALIBRATION
from plasmapyro.radiation import stage as radiation_stage
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.sightline import neqair

NARROW = ["--wavelength-nm", "770", "785", "--grid-points", "7000"]
NINE_DIGITS = 1e-6  # of radiance: 1e-8 in temperature and density, times E/kT of about 15 and the layers


@pytest.fixture(scope="module")
def sightline():
    temperature = np.array([2000.0, 7000.0, 8000.0, 3000.0])
    return xr.Dataset(
        {
            "temperature": ("path_distance", temperature),
            "pressure": ("path_distance", np.full(4, 5000.0)),
            "number_density": (("species", "path_distance"), number_density(temperature, 5000.0).T),
        },
        {"path_distance": [0.0, 0.01, 0.1, 0.15], "species": list(SPECIES)},
        attrs={"origin": "synthetic"},
    )


@pytest.fixture
def folder(tmp_path, sightline):
    return with_inputs(tmp_path, sightline)


@pytest.fixture(scope="module")
def spectrum(tmp_path_factory, sightline):
    """The file that the command makes of the sight line, its inputs beside it."""
    place = with_inputs(tmp_path_factory.mktemp("made"), sightline)
    assert run(place, "path.nc", "--out", "spectrum.nc") == 0
    return place / "spectrum.nc"


def with_inputs(folder, sightline):
    io.write(sightline, folder / "path.nc", "sightline")
    io.write_text(neqair.compose(sightline), folder / "LOS.dat")
    wavelength = np.linspace(772e-9, 783e-9, 23)
    shape = np.sin(np.pi * (wavelength - 772e-9) / 11e-9)
    response = xr.Dataset(
        {"responsivity_wide": ("wavelength", shape), "responsivity_narrow": ("wavelength", shape**2)},
        {"wavelength": wavelength},
    )
    io.write(response, folder / "response.nc", "response")
    return folder


def run(folder, *arguments):
    return cli.main(
        ["radiance", *(str(folder / word) if "." in word else word for word in arguments), *NARROW]
    )


def test_a_netcdf_sight_line_gives_the_spectrum_of_the_library(spectrum, sightline):
    found = io.read(spectrum, "spectrum")
    expected = line_of_sight_radiance(
        sightline, None, wavelength_range=(770e-9, 785e-9), grid_points=7000, slit_fwhm=0.75e-9
    )
    np.testing.assert_array_equal(found.gas_radiance_component, expected.gas_radiance_component)
    # The slit is 0.75 times 1e-9 m there and 0.75e-9 m here.
    np.testing.assert_allclose(found.gas_radiance_slit, expected.gas_radiance_slit, rtol=1e-12)
    assert "band_signal" not in found
    assert found.attrs["origin"] == "synthetic"
    assert '"grid_points": 7000' in found.attrs["configuration"]
    assert found.attrs["sources"].endswith("path.nc")


def test_text_and_netcdf_of_one_sight_line_give_one_spectrum(folder, spectrum):
    text = (folder / "LOS.dat").read_text().replace("# Line", "! L\u00ednea").replace("E+", "D+")
    (folder / "odd.dat").write_text(text.replace("  ", "\t"), encoding="utf-8-sig", newline="\r\n")
    assert run(folder, "odd.dat", "--out", "text.nc") == 0
    from_netcdf, from_text = io.read(spectrum, "spectrum"), io.read(folder / "text.nc", "spectrum")
    np.testing.assert_allclose(from_text.gas_radiance, from_netcdf.gas_radiance, rtol=NINE_DIGITS)


def test_a_response_adds_the_band_signals(folder):
    assert run(folder, "path.nc", "--out", "r.nc", "--response", "response.nc") == 0
    found = io.read(folder / "r.nc", "radiation")
    assert (found.band_signal > 0).all()


def test_the_same_call_gives_the_same_bytes(spectrum):
    assert run(spectrum.parent, "path.nc", "--out", "again.nc") == 0
    assert (spectrum.parent / "again.nc").read_bytes() == spectrum.read_bytes()


def test_text_comes_out_as_well(folder):
    texts = ["--spectrum-text", "intensity_scanned.out", "--line-of-sight-text", "LOS_out.dat"]
    assert run(folder, "path.nc", "--out", "r.nc", *texts) == 0
    found = io.read(folder / "r.nc", "spectrum")
    columns = np.loadtxt(folder / "intensity_scanned.out", skiprows=2, unpack=True)
    np.testing.assert_allclose(columns[0] * 1e-10, found.wavelength, rtol=1e-9)
    np.testing.assert_allclose(columns[1] * 1e10, found.gas_radiance, rtol=1e-8)
    assert (folder / "LOS_out.dat").read_text() == (folder / "LOS.dat").read_text()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["missing.nc", "--out", "x.nc"], "missing.nc: no such file"),
        (["cut.nc", "--out", "x.nc"], "cut.nc: not a readable netCDF file"),
        (["cut.dat", "--out", "x.nc"], r"cut.dat: line \d+: "),
        (["noise.dat", "--out", "x.nc"], "noise.dat: line 1: column titles must be"),
        (["per_m3.dat", "--out", "x.nc"], r"per_m3.dat: [^;]*pressure: [^;]*; NEQAIR's text has x in cm"),
        (["response.nc", "--out", "x.nc"], "response.nc: not a valid 'sightline' dataset"),
        (["path.nc", "--out", "path.nc"], "path.nc: is an input or another output"),
        (["path.nc", "--out", "x.out", "--spectrum-text", "x.out"], "x.out: is an input or another output"),
        (["path.nc", "--out", "sub.folder"], "sub.folder: is a folder; name a file"),
        (["path.nc", "--out", "x.nc", "--response", "path.nc"], "path.nc: not a valid 'response' dataset"),
        (["path.nc", "--out", "x.nc", "--slit-fwhm-nm", "0"], "--slit-fwhm-nm must lie between 0 and"),
        (
            ["path.nc", "--out", "x.nc", "--slit-fwhm-nm", "50"],
            "between 0 and 3.53 nm for this range; got 50",
        ),
    ],
)
def test_bad_input_is_one_message_and_no_file(folder, capsys, arguments, message):
    (folder / "cut.nc").write_bytes((folder / "path.nc").read_bytes()[:2000])
    (folder / "cut.dat").write_text((folder / "LOS.dat").read_text()[:700])
    dense = neqair.parse((folder / "LOS.dat").read_text())
    dense["number_density"] *= 1e6
    (folder / "per_m3.dat").write_text(neqair.compose(dense))
    (folder / "noise.dat").write_bytes(bytes(range(128, 256)) * 4)
    (folder / "sub.folder").mkdir()
    before = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    assert run(folder, *arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("plasmapyro: ") and "Traceback" not in said.err
    assert re.search(message, said.err), said.err
    assert {path.name: path.stat().st_mtime_ns for path in folder.iterdir()} == before


def test_a_coarse_grid_is_refused_with_the_number_that_would_do(folder, capsys):
    assert run(folder, "path.nc", "--out", "x.nc", "--slit-fwhm-nm", "1") == 0
    (folder / "x.nc").unlink()
    coarse = [str(folder / "path.nc"), "--out", str(folder / "x.nc"), "--wavelength-nm", "770", "785"]
    for points in ("500", "3000"):  # too few for the widest lines; for those of colder gas that shines
        assert cli.main(["radiance", *coarse, "--grid-points", points]) == 2
        assert "grid points must be >= " in capsys.readouterr().err
    assert not (folder / "x.nc").exists()


@pytest.mark.parametrize("words", [["--grid-points", "500"], ["--slit-fwhm-nm", "1e-3"]])
def test_what_needs_no_lines_is_refused_before_they_are_made(folder, capsys, monkeypatch, words):
    def made(*arguments):
        raise AssertionError("line lists were made")

    monkeypatch.setattr(radiation_stage, "line_lists", made)
    narrow = ["--wavelength-nm", "770", "785", "--grid-points", "7000"]
    assert (
        cli.main(["radiance", str(folder / "path.nc"), "--out", str(folder / "x.nc"), *narrow, *words]) == 2
    )
    assert "must be >" in capsys.readouterr().err


def test_a_second_temperature_changes_the_light(folder, sightline, spectrum):
    two = sightline.assign(excitation_temperature=sightline.temperature + 500)
    io.write_text(neqair.compose(two), folder / "two.dat")
    assert run(folder, "two.dat", "--out", "two.nc") == 0
    hot, cold = (
        float(io.read(path, "spectrum").gas_radiance.sum()) for path in (folder / "two.nc", spectrum)
    )
    assert hot > 1.2 * cold  # atoms gain by exp(E/kT * 0.08) with E/kT of 20, molecules less


def test_a_range_without_data_is_refused(folder, capsys):
    words = [str(folder / "path.nc"), "--out", str(folder / "x.nc"), "--wavelength-nm"]
    for edges in (("500", "600"), ("0.7", "1.2")):  # no data; micrometres
        assert cli.main(["radiance", *words, *edges]) == 2
        said = f"within 650 to 2500 nm; got {' '.join(edges)}"
        assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        ["radiance", "path.nc", "--out", "x.nc", "--wavelength-nm", "800", "700"],
        ["trust", "90kW", "--emittance", "0.9", "0.7"],
        ["correct", "test", "--reference-window", "3", "1"],
        ["calibrate", "test", "--instrument-range-k", "973", "973"],
    ],
)
def test_a_range_that_falls_is_refused_before_anything_is_read(words, capsys):
    with pytest.raises(SystemExit) as end:
        cli.main(words)
    assert end.value.code == 2
    assert f"{words[-3]} must be two numbers that rise; got {' '.join(words[-2:])}" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words", [["correct", "test", "--priors", "a.yaml"], ["diagnose", "test", "--with", "a.yaml"]]
)
def test_a_file_of_knowledge_that_is_given_twice_is_refused(words, capsys):
    """The second value would have taken the place of the first without a word."""
    with pytest.raises(SystemExit) as end:
        cli.main([*words, words[-2], "other"])
    assert end.value.code == 2
    assert f"{words[-2]} is given twice" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words", [[], ["radiance"], ["radianze"], ["radiance", "a.nc", "--out", "b.nc", "--grid-points", "0"]]
)
def test_wrong_usage_ends_with_two(words, capsys):
    with pytest.raises(SystemExit) as end:
        cli.main(words)
    assert end.value.code == 2
    assert "usage: plasmapyro" in capsys.readouterr().err


def test_a_fault_of_ours_ends_with_one_and_says_so(folder, capsys, monkeypatch):
    def broken(*arguments, **keywords):
        raise RuntimeError("broken kernel")

    monkeypatch.setattr(radiance, "line_of_sight_radiance", broken)
    assert run(folder, "path.nc", "--out", "x.nc") == 1
    said = capsys.readouterr().err
    assert "broken kernel" in said and "a fault of the program" in said
    assert not (folder / "x.nc").exists()


def test_stopping_it_leaves_nothing(folder, capsys, monkeypatch):
    def stopped(*arguments, **keywords):
        raise KeyboardInterrupt

    monkeypatch.setattr(radiance, "line_of_sight_radiance", stopped)
    assert run(folder, "path.nc", "--out", "x.nc") == 130
    assert "stopped" in capsys.readouterr().err
    assert not (folder / "x.nc").exists()


def test_help_names_units_and_an_example(capsys):
    with pytest.raises(SystemExit) as end:
        cli.main(["radiance", "--help"])
    assert end.value.code == 0
    said = capsys.readouterr().out
    for words in ("[cm]", "[m-3]", "example:\n  plasmapyro radiance LOS.dat --out", "default: 160000", "nm"):
        assert words in said


def test_steps_and_layers_are_told_on_a_terminal_only(folder):
    class Terminal:
        text, closed = "", False

        def __init__(self, is_terminal):
            self.is_terminal = is_terminal

        def isatty(self):
            return self.is_terminal

        def write(self, text):
            self.text += text

        def flush(self):
            pass

    options = cli.parser().parse_args(
        ["radiance", str(folder / "path.nc"), "--out", str(folder / "out.nc"), *NARROW]
    )
    for is_terminal in (True, False):
        stream = Terminal(is_terminal)
        progress.show(stream)
        options.run(options)
        assert bool(stream.text) == is_terminal
        assert ("s] computing 4 layers on 7000 wavelengths" in stream.text) == is_terminal
        assert bool(re.search(r"layers: \d of [1-4]", stream.text)) == is_terminal
    progress.show(io_streams.StringIO())


def test_the_package_installs_the_command():
    code = (
        "import sys; from plasmapyro.cli import main; sys.exit(main(['radiance', 'none', '--out', 'x.nc']))"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert ended.stderr == "plasmapyro: none: no such file; check the name, upper and lower case included\n"


def test_a_command_runs_on_one_thread_whatever_the_environment_says():
    """As the workflow's jobs: small matrices are not waited for, and the bytes are the same."""
    code = (
        "import os, sys; from plasmapyro.cli import main; main(['radiance', 'none', '--out', 'x.nc']);"
        "import numpy as np; np.ones((400, 400)) @ np.ones((400, 400));"
        "print(len(os.listdir('/proc/self/task')))"
    )
    environment = os.environ | dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "3")
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert ended.stdout == "1\n"


HEAVY = set("numpy scipy xarray yaml netCDF4 h5py matplotlib cantera jinja2 importlib.metadata".split())


def called(*words, then="print(*sys.modules)"):
    """Lines that a call of the command writes in a process of its own."""
    code = f"import sys; from plasmapyro import cli\ntry: cli.main({list(words)})\nexcept SystemExit: pass\n"
    ended = subprocess.run([sys.executable, "-c", code + then], capture_output=True, text=True, check=True)
    return ended.stdout.splitlines()


def test_help_loads_nothing_that_computes_and_says_what_the_commands_say():
    *said, loaded = called("--help")
    assert not set(loaded.split()) & HEAVY
    assert not set(called("correct", "--help")[-1].split()) & HEAVY
    assert "\n".join(said) == "\n".join(called("--help", then=""))
    assert cli.parser(()).format_help() == cli.parser().format_help()


def test_words_to_choose_from_are_those_that_the_commands_know():
    with (Path(cli.__file__).parent / "commands/options.csv").open(newline="") as table:
        kinds = {(row["command"], row["option"]): row["kind"].split("|") for row in csv.DictReader(table)}
    assert kinds["correct", "--estimator"] == sorted(ESTIMATORS)
    assert kinds["calibrate", "--accept"] == [rule.name for rule in OF_CALIBRATION]
    assert {name for commands, _ in kinds for name in commands.split("|")} == set(cli.COMMANDS)


def test_check_loads_neither_pictures_nor_what_an_extra_brings():
    loaded = set(called("check", "none")[-1].split())
    assert not loaded & {"matplotlib", "jinja2", "cantera", "h5py", "snakemake"}
    assert not loaded & {"plasmapyro.diagnosis.command", "scipy.stats"}


def test_a_shell_completes_commands_and_options():
    script = "\n".join(called("completion", "bash", then=""))
    asked = "".join(
        f'COMP_WORDS=({words}); COMP_CWORD={place}; _plasmapyro; echo "${{COMPREPLY[@]}}"\n'
        for words, place in (("plasmapyro correct --est", 2), ("plasmapyro cal", 1))
    )
    ended = subprocess.run(["bash"], input=f"{script}\n{asked}", capture_output=True, text=True, check=True)
    assert ended.stdout.splitlines() == ["--estimator", "calibrate"]


def test_the_version_is_that_of_the_installed_package(capsys):
    with pytest.raises(SystemExit) as end:
        cli.main(["--version"])
    assert end.value.code == 0
    assert capsys.readouterr().out == f"plasmapyro {plasmapyro.__version__}\n"


def test_it_runs_as_a_module():
    words = [sys.executable, "-m", "plasmapyro", "check", "none"]
    ended = subprocess.run(words, capture_output=True, text=True)
    assert (ended.returncode, ended.stdout) == (2, "") and "no such folder" in ended.stderr


def test_what_an_extra_would_bring_is_named(folder, capsys, monkeypatch):
    def missing(*arguments, **keywords):
        raise ModuleNotFoundError("No module named 'meshio'", name="meshio")

    monkeypatch.setattr(radiance, "line_of_sight_radiance", missing)
    assert run(folder, "path.nc", "--out", "x.nc") == 2
    assert (
        'this needs meshio, which is not installed: pip install "plasmapyro[cfd]"' in capsys.readouterr().err
    )
