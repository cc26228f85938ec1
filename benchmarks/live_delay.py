"""Measure `plasmapyro live`: the delay of each answer at a steady rate, its end against the joint estimate.

    python benchmarks/live_delay.py FOLDER INSTRUMENT [--rate 100] [--seconds 20] [--out FILE.json]

FOLDER is a test (test.yaml and its files), INSTRUMENT what `calibrate` made. First its signals at that rate
(a running mean of them, interpolated, with the noise of the record) are sent as JSON lines, each when the
answer to the one before has come; Linux says what time an answer took and how long it waited for a processor
(/proc/PID/schedstat). The delay at the rate is that of a queue with these times: a sample begins when it
comes and the one before is done. So it is the delay of a machine that gives `live` a core, also where others
use the machine. Then all samples of the test are sent as they are, and the last temperature of both is
compared with `estimate`.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from plasmapyro import io
from plasmapyro.commands.joint import SETTINGS
from plasmapyro.estimate.noise import signal_noise
from plasmapyro.estimate.prepare import NOISE_BLOCK
from plasmapyro.estimate.stage import estimate
from plasmapyro.readers.stage import read_test

MEAN = 7  # samples of the running mean
LIVE = [sys.executable, "-c", "import sys; from plasmapyro.cli import main; sys.exit(main())", "live"]


def scheduled(process):
    """Seconds that a process has run, and that it has waited for a processor."""
    words = Path(f"/proc/{process}/schedstat").read_text(encoding="ascii").split()
    return np.array([float(words[0]), float(words[1])]) * 1e-9


def replay(options, moments, pair):
    """Answers, and of each sample what it ran and its wall time without waiting for a processor [s]."""
    command = [*LIVE, options.folder, "--instrument", options.instrument, "--stdin"]
    live = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)
    answers, times = [], []
    for moment, (wide, narrow) in zip([moments[0] - 1, *moments], [pair[:, 0], *pair.T], strict=True):
        sample = {"time": float(moment), "signal_wide": float(wide), "signal_narrow": float(narrow)}
        before, own, begin = scheduled(live.pid), scheduled("self"), time.perf_counter()
        live.stdin.write(json.dumps(sample) + "\n")
        line = live.stdout.readline()
        if not line:
            sys.exit(live.wait() or 1)  # it has said why
        ran, waited = scheduled(live.pid) - before
        waited += (scheduled("self") - own)[1]
        times.append((ran, max(time.perf_counter() - begin - waited, ran)))
        answers.append(json.loads(line))
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


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("folder"), words.add_argument("instrument")
    words.add_argument("--rate", type=float, default=100.0)
    words.add_argument("--seconds", type=float, default=20.0)
    words.add_argument("--out", type=Path)
    options = words.parse_args()
    test = read_test(options.folder)
    pair = np.stack([test.signal_wide.values, test.signal_narrow.values])
    moments = np.arange(
        max(test.time.values[0], -2.0), min(test.time.values[-1], options.seconds), 1 / options.rate
    )
    _, times = replay(options, moments, at_rate(test.time.values, pair, moments))
    answers, _ = replay(options, test.time.values, pair)
    response, calibration = (
        io.read(Path(options.instrument) / f"{name}.nc", name) for name in ("response", "calibration")
    )
    alone = test.drop_dims([name for name in ("spectrum_time", "wavelength") if name in test.dims])
    joint = estimate(
        alone,
        calibration,
        response,
        None,
        saturation_counts=65000.0,
        noise_block=50,
        throughput_chance=0.0,  # the filter takes it as stated
        **SETTINGS,
    )
    both = [
        i for i, one in enumerate(answers) if one["temperature"] and np.isfinite(joint.surface_temperature[i])
    ]
    last = both[-1]
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
        "end": {
            "time_s": answers[last]["time"],
            "live_k": answers[last]["temperature"],
            "live_interval_k": [answers[last]["low"], answers[last]["high"]],
            "joint_k": float(joint.surface_temperature[last]),
            "joint_uncertainty_k": float(joint.surface_temperature_uncertainty[last]),
        },
    }
    text = json.dumps(found, indent=1) + "\n"
    sys.stdout.write(text)
    if options.out:
        io.write_text(text, options.out)


if __name__ == "__main__":
    main()
