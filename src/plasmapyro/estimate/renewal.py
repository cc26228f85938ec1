"""The joint estimate of all samples so far, made by another process, from which a filter goes on."""

import multiprocessing
import signal
import time
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from plasmapyro.estimate.dynamics import RATE, SIZE, TEMPERATURE, Dynamics
from plasmapyro.estimate.instrument import from_straight
from plasmapyro.estimate.stage import KICK, posterior
from plasmapyro.instrument.wander import WANDER
from plasmapyro.radiation.bandsignal import BANDS

FASTER = 0.8  # [1] of the time between samples in which they come: they were taken before
LEAST, MOST = 100, 2000  # samples of the chain; more take more than some seconds
OF_LIVE = {"saturation_counts": np.inf, "noise_block": 1, "least_samples": LEAST, "most_samples": MOST}


@dataclass(frozen=True)
class State:
    """Where a filter may go on: the last state and the constants of a joint estimate."""

    time: float  # [s] from the injection
    names: tuple  # of the constants
    mean: np.ndarray  # (4 + p,)
    covariance: np.ndarray  # (4 + p, 4 + p)
    dynamics: Dynamics
    contradictions: tuple  # words
    throughput_chance: float  # [1] that it, or the ratio, is not as stated


def state_of(test, calibration, response, settings):
    """State at the end of a test; None where its samples tell nothing yet.

    Modes of what drifts and wanders are one constant each: where they have led.
    """
    try:
        made = posterior(test, calibration, response, None, **settings | OF_LIVE)
    except ValueError:
        return None
    names = made.fixed.names
    leading = made.observations[0]
    led = {"ratio_wander": leading.parting[-1] / WANDER["ratio"], "band_drift": 1.0}
    left = [name for name in names if name not in led]
    kept = np.flatnonzero([name not in led for name in names])
    whole = np.zeros((SIZE + len(kept) + len(led), SIZE + len(names)))
    whole[np.arange(SIZE), np.arange(SIZE)] = 1.0
    whole[SIZE + np.arange(len(kept)), SIZE + kept] = 1.0
    for row, (name, modes) in enumerate(led.items()):
        whole[SIZE + len(kept) + row, SIZE + made.fixed.where(name)] = modes
    last, dynamics = made.found.path[-1].copy(), made.found.dynamics
    last[TEMPERATURE], slope = from_straight(last[TEMPERATURE])
    last[RATE] *= slope
    whole[[TEMPERATURE, RATE]] *= slope  # of kelvin by what the path is in
    against, words = made.contradicted()
    return State(
        float(made.samples.time[-1]),
        (*left, *led),
        np.concatenate([last, whole[SIZE:, SIZE:] @ made.found.values]),
        whole @ made.spread.last @ whole.T,
        replace(  # the kick of the end of the plasma is still to come
            dynamics, kick=KICK, quiet=dynamics.quiet * slope**2, bending=dynamics.bending * slope**2
        ),
        tuple(words) if against[-1] else (),
        made.doubts["throughput_chance"] + made.doubts["ratio_chance"],
    )


class Renewal:
    """Another process that is asked for a `State`, and answers when it has one."""

    def __init__(self, attributes, *instrument_and_settings):
        """`attributes`: of the test; the rest: as `state_of` takes it."""
        self._attributes = attributes
        context = multiprocessing.get_context("spawn")
        self._pipe, other = context.Pipe()
        self._process = context.Process(target=_serve, args=(other, *instrument_and_settings), daemon=True)
        self._process.start()
        other.close()

    @property
    def lost(self):
        """Whether the process has ended: nothing answers any more."""
        return not self._process.is_alive()

    def ask(self, samples, off):
        """`samples` (n, 3): time [s] and both signals [A]; `off`: end of the plasma; from the injection."""
        self._begun = time.monotonic()
        with suppress(OSError):
            self._pipe.send(test_of(samples, off, self._attributes))

    def ready(self, span):
        """Whether the answer is there, or may be waited for: `span` [s] have passed for the samples since.

        Samples that come as they are taken never wait; those of a record that is read through do, so that
        what is said of them does not depend on how fast that is.
        """
        return self.lost or self._pipe.poll() or time.monotonic() - self._begun < FASTER * span

    def answer(self):
        """What was asked for, waited for; None where samples tell nothing yet, or the process is gone."""
        try:
            return self._pipe.recv()
        except (EOFError, OSError):
            return None


def test_of(samples, off, attributes):
    """A test as Dataset of samples (n, 3) and the end of the plasma as `Renewal.ask` takes them."""
    moment, *pair = np.asarray(samples).T
    injection = attributes["injection_time"]
    ampere = {"units": "A"}
    signals = {f"signal_{band}": ("time", row, ampere) for band, row in zip(BANDS, pair, strict=True)}
    axis = ("time", moment + injection, {"units": "s"})
    return xr.Dataset(signals, {"time": axis}, attributes | {"plasma_off_time": off + injection})


def _serve(pipe, *instrument_and_settings):
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # who stops `live` stops this process with it
    with suppress(EOFError, OSError):  # `live` has ended
        while True:
            pipe.send(state_of(pipe.recv(), *instrument_and_settings))
