"""Long stages say how far they are: on a terminal, nowhere else."""

import io as streams
import logging
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from plasmapyro import progress
from plasmapyro.design.search import optimise

ROOT = Path(__file__).resolve().parents[1]
LONG_STAGES = {  # module -> how it speaks: a step, or a record of its log, which the terminal shows as well
    "flow/continuation.py": "log.info(",
    "radiation/table.py": "step(",
    "radiation/path.py": "step(",
    "experiment/correction.py": "step(",
    "estimate/smoother.py": "step(",
    "diagnosis/fit/base.py": "step(",
    "diagnosis/select/selection.py": "step(",
    "design/search.py": "step(",
}


class Terminal(streams.StringIO):
    def isatty(self):
        return True


@pytest.fixture(autouse=True)
def quiet_afterwards():
    yield
    progress.show(streams.StringIO())
    progress.LOG.propagate = True
    progress.ALL.setLevel(logging.NOTSET)


def search():
    return optimise(
        lambda centre, fwhm: np.sum((centre - 9e-7) ** 2, axis=1) * 1e14,
        1,
        (7e-7, 1.2e-6),
        (1e-8, 1e-7),
        seed=1,
        population=5,
        generations=3,
    )


def test_a_terminal_sees_one_line_that_is_written_over(monkeypatch):
    monkeypatch.setattr(progress, "PERIOD", 0.0)
    terminal = Terminal()
    progress.show(terminal)
    search()
    text = terminal.getvalue()
    assert "search of 1 bands, generation: 2 of 3, score" in text
    assert "\n" not in text and text.count("\r\033[K") >= 2


def test_what_the_flow_logs_is_drawn_too():
    terminal = Terminal()
    progress.show(terminal)
    logging.getLogger("plasmapyro.flow.continuation").info("residual %.0e", 1e-3)
    assert "residual 1e-03" in terminal.getvalue()


def test_a_line_is_drawn_at_most_ten_times_a_second():
    terminal = Terminal()
    progress.show(terminal)
    for done in range(1000):
        progress.step("table", done, 1000)
    assert terminal.getvalue().count("\r") <= 3


def test_files_and_pipes_see_nothing_and_the_search_finds_the_same():
    pipe = streams.StringIO()
    progress.show(pipe)
    quiet = search()
    progress.show(Terminal())
    assert pipe.getvalue() == ""
    assert [np.asarray(part).tolist() for part in search()] == [np.asarray(part).tolist() for part in quiet]


def test_what_a_command_says_stays_and_a_warning_is_said_anywhere():
    terminal, pipe = Terminal(), streams.StringIO()
    for stream in (terminal, pipe):
        progress.show(stream)
        progress.step("table", 1, 2)
        progress.say("reading a.nc")
        progress.warn("a surface in the window")
    assert re.search(r"\r\033\[K\[ +\d\.\d s\] reading a.nc\n", terminal.getvalue())
    assert "plasmapyro: warning: a surface in the window\n" in terminal.getvalue()
    assert pipe.getvalue() == "plasmapyro: warning: a surface in the window\n"


def test_a_warning_of_a_stage_reaches_terminal_and_pipe_once():
    """Spectra that are not corrected, or bands that are left out, had been said to nobody."""
    words = "no exposure lies within the reference window"
    said = f"plasmapyro: warning: {words}\n"
    for stream in (Terminal(), streams.StringIO()):
        progress.show(stream)
        logging.getLogger("plasmapyro.commands.correct").warning(words)
        assert stream.getvalue().endswith(said) and stream.getvalue().count(said) == 1


def test_what_is_said_after_the_stream_is_closed_is_no_error():
    """A caller in Python that ran a command with a stream of its own, and goes on with stages."""
    stream = streams.StringIO()
    progress.show(stream)
    stream.close()
    logging.getLogger("plasmapyro.diagnosis").warning("left out")


def test_the_log_of_a_job_stays_quiet(tmp_path):
    code = f"""
import logging
from plasmapyro import io, progress
io.log_to({str(tmp_path / "job.log")!r})
progress.step("table", 1, 2)
logging.getLogger("plasmapyro.flow").info("a step of the solver")
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.returncode == 0 and run.stderr == ""
    log = (tmp_path / "job.log").read_text()
    assert "a step of the solver" in log and "table" not in log


@pytest.mark.parametrize("module", LONG_STAGES)
def test_a_long_stage_speaks(module):
    assert LONG_STAGES[module] in (ROOT / "src/plasmapyro" / module).read_text(encoding="utf-8")
