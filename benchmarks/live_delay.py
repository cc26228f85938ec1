"""Measure the delay of `plasmapyro live`: a test streamed at a steady rate, the time to each answer.

    python benchmarks/live_delay.py TEST.nc INSTRUMENT FOLDER [--rate 100] [--seconds 20]

FOLDER holds test.yaml with the facts of the test. The signals are interpolated to the rate; median, 99 %
and largest delay and the CPU time per sample go to standard output.
"""

import argparse
import json
import os
import subprocess
import sys
import threading
import time

import numpy as np

from plasmapyro import io

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("test"), parser.add_argument("instrument"), parser.add_argument("folder")
parser.add_argument("--rate", type=float, default=100.0)
parser.add_argument("--seconds", type=float, default=20.0)
options = parser.parse_args()

test = io.read(options.test, "test")
moments = np.arange(0.0, options.seconds, 1 / options.rate)
wide, narrow = (np.interp(moments, test.time, test[f"signal_{band}"]) for band in ("wide", "narrow"))
command = [sys.executable, "-c", "import sys; from plasmapyro.cli import main; sys.exit(main())", "live"]
command += [options.folder, "--instrument", options.instrument, "--stdin"]
live = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)
sent, came = [], []


def listen():
    for _ in live.stdout:
        came.append(time.monotonic())


listener = threading.Thread(target=listen)
listener.start()
warm = json.dumps({"time": -1.0, "signal_wide": wide[0], "signal_narrow": narrow[0]}) + "\n"
live.stdin.write(warm)
while not came:  # the program has started
    if live.poll() is not None:
        sys.exit(live.returncode)  # it has said why
    time.sleep(0.01)
begin = time.monotonic()
for moment, a, b in zip(moments, wide, narrow, strict=True):
    time.sleep(max(0.0, begin + moment - time.monotonic()))
    sent.append(time.monotonic())
    live.stdin.write(json.dumps({"time": moment, "signal_wide": a, "signal_narrow": b}) + "\n")
before = sum(os.times()[2:4])
live.stdin.close()
listener.join()
live.wait()
delay = 1e3 * (np.array(came[1:]) - np.array(sent))
used = 1e3 * (sum(os.times()[2:4]) - before) / len(sent)
middle, late = np.quantile(delay, (0.5, 0.99))
sys.stdout.write(
    f"{len(sent)} samples at {options.rate:g} Hz: delay {middle:.1f} ms median, {late:.1f} ms 99 %,"
)
sys.stdout.write(f" {delay.max():.1f} ms largest; {used:.1f} ms of CPU per sample, start included\n")
