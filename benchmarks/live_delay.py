"""Measure `plasmapyro live`: the delay of each answer at a steady rate, its end against the joint estimate.

    python benchmarks/live_delay.py FOLDER INSTRUMENT [--also TEST INSTRUMENT] [--out FILE.json]

FOLDER is a test (test.yaml and its files), INSTRUMENT what `calibrate` made. First its signals at a rate
(a running mean of them, interpolated, with the noise of the record) are sent as JSON lines, each at its
moment, or when the answer to the one before has come; Linux says what time an answer took and how long it
waited for a processor (/proc/PID/schedstat). The delay at the rate is that of a queue with these times: a
sample begins when it comes and the one before is done. So it is the delay of a machine that gives `live` a
core, also where others use the machine. Then all samples of this test, and of others, are sent as they are,
and the last temperature while the plasma burns and the last of all are compared with the joint estimate of
all samples until then, of the pyrometer alone. Beside a synthetic test lies what is true.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from plasmapyro import io
from plasmapyro.commands.joint import SETTINGS
from plasmapyro.estimate.prepare import NOISE_BLOCK
from plasmapyro.estimate.stage import estimate
from plasmapyro.readers.stage import read_test
from plasmapyro.record.budget import NORMAL_95
from plasmapyro.record.inputs import NUMBERS
from plasmapyro.record.noise import signal_noise

BEFORE = 1.0  # [s] the end of the plasma, where a last temperature in its light is taken
MEAN = 7  # samples of the running mean
LIVE = [sys.executable, "-c", "import sys; from plasmapyro.cli import main; sys.exit(main())", "live"]


def scheduled(process):
    """Seconds that a process has run, and that it has waited for a processor."""
    words = Path(f"/proc/{process}/schedstat").read_text(encoding="ascii").split()
    return np.array([float(words[0]), float(words[1])]) * 1e-9


def replay(folder, instrument, moments, pair, paced=False):
    """Answers, and of each sample what it ran and its wall time without waiting for a processor [s].

    `paced`: none is sent before its moment.
    """
    command = [*LIVE, str(folder), "--instrument", instrument, "--stdin"]
    live = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)
    answers, times, start = [], [], None
    for moment, (wide, narrow) in zip([moments[0] - 1, *moments], [pair[:, 0], *pair.T], strict=True):
        sample = {"time": float(moment), "signal_wide": float(wide), "signal_narrow": float(narrow)}
        if paced and start is not None:
            time.sleep(max(start + moment - time.monotonic(), 0))
        before, own, begin = scheduled(live.pid), scheduled("self"), time.perf_counter()
        live.stdin.write(json.dumps(sample) + "\n")
        line = live.stdout.readline()
        if not line:
            sys.exit(live.wait() or 1)  # it has said why
        ran, waited = scheduled(live.pid) - before
        waited += (scheduled("self") - own)[1]
        times.append((ran, max(time.perf_counter() - begin - waited, ran)))
        answers.append(json.loads(line))
        start = start or time.monotonic() - moments[0]
    live.stdin.close()
    live.wait()
    return answers[1:], np.array(times[1:])


def at_rate(time, pair, moments):
    """Signals (2, n) at other moments; mere straight lines between theirs would hold no noise."""
    floor, relative = signal_noise(pair, NOISE_BLOCK)
    mean = [np.convolve(np.pad(row, MEAN // 2, "edge"), np.full(MEAN, 1 / MEAN), "valid") for row in pair]
    dense = np.stack([np.interp(moments, time, row) for row in mean])
    noise = np.random.default_rng(1).standard_normal(dense.shape)
    return dense + np.hypot(floor[:, None], relative[:, None] * dense) * noise


def queued(moments, service):
    """Delays [s] of samples that come at `moments` and are done one after another, each in its own time."""
    done, delays = -np.inf, []
    for moment, needed in zip(moments, service, strict=True):
        done = max(moment, done) + needed
        delays.append(done - moment)
    return np.array(delays)


def compared(place, instrument):
    """Of one test: what `live` ends with, while the plasma burns and at last, beside the joint estimate."""
    path = Path(place)
    test = io.read(path, "test") if path.is_file() else read_test(place)
    alone = test.drop_dims([name for name in ("spectrum_time", "wavelength") if name in test.dims])
    with tempfile.TemporaryDirectory() as folder:
        facts = {
            name: np.asarray(test.attrs[name]).tolist()
            for name in ("origin", "reference_window", *NUMBERS)
            if name in test.attrs
        }
        text = json.dumps({"attributes": facts})  # which is YAML
        (Path(folder) / "test.yaml").write_text(text, encoding="utf-8")
        pair = np.stack([test.signal_wide.values, test.signal_narrow.values])
        answers, _ = replay(folder, instrument, test.time.values, pair)
    known = [i for i, one in enumerate(answers) if one["temperature"]]
    for burning in (True, False):
        burnt = test.time.values[known] > test.attrs["plasma_off_time"] - BEFORE
        last = known[np.flatnonzero(~burnt)[-1] if burning else -1]
        until = alone.isel(time=slice(None, last + 1))
        joint = estimate(
            until,
            *(io.read(Path(instrument) / f"{name}.nc", name) for name in ("calibration", "response")),
            saturation_counts=65000.0,
            noise_block=50,
            **SETTINGS,
        ).isel(time=-1)
        one = answers[last]
        own = one["temperature"] * np.log(one["high"] / one["low"]) / 2 / NORMAL_95
        middle, spread = float(joint.surface_temperature), float(joint.surface_temperature_uncertainty)
        row = {
            "test": path.parent.name if path.is_file() else path.name,
            "time_s": one["time"],
            "live_k": one["temperature"],
            "live_uncertainty_k": round(float(own), 2),
            "joint_k": round(middle, 2),
            "joint_uncertainty_k": round(spread, 2),
            "apart": round((one["temperature"] - middle) / spread, 2),
        }
        truth = path.with_name("truth.nc")
        if path.is_file() and truth.exists():
            true = io.read(truth, "truth")
            row["truth_k"] = round(float(np.interp(one["time"], true.time, true.surface_temperature)), 2)
        yield row


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("folder"), words.add_argument("instrument")
    words.add_argument("--rate", type=float, default=100.0)
    words.add_argument("--seconds", type=float, default=20.0)
    words.add_argument("--also", nargs=2, action="append", default=[], metavar=("TEST", "INSTRUMENT"))
    words.add_argument("--out", type=Path)
    options = words.parse_args()
    test = read_test(options.folder)
    pair = np.stack([test.signal_wide.values, test.signal_narrow.values])
    moments = np.arange(
        max(test.time.values[0], -2.0), min(test.time.values[-1], options.seconds), 1 / options.rate
    )
    dense = at_rate(test.time.values, pair, moments)
    _, times = replay(options.folder, options.instrument, moments, dense, paced=True)
    found = {
        "samples": len(moments),
        "rate_hz": options.rate,
        "cpu_ms_per_sample": 1e3 * float(times[:, 0].mean()),
        **{
            name: dict(
                zip(("median", "99 %", "largest"), 1e3 * np.quantile(one, (0.5, 0.99, 1.0)), strict=True)
            )
            for name, one in (
                ("delay_ms", queued(moments, times[:, 0])),
                ("delay_with_pipes_ms", queued(moments, times[:, 1])),
            )
        },
        "ends": [
            row for pair in ((options.folder, options.instrument), *options.also) for row in compared(*pair)
        ],
    }
    text = json.dumps(found, indent=1) + "\n"
    sys.stdout.write(text)
    if options.out:
        io.write_text(text, options.out)


if __name__ == "__main__":
    main()
