"""`plasmapyro live`: corrected temperature and alarms while a test is running."""

import json
import sys
import time
from collections import deque
from pathlib import Path

import numpy as np

from plasmapyro import io
from plasmapyro.commands.joint import SETTINGS
from plasmapyro.estimate.live import Filter
from plasmapyro.estimate.renewal import Renewal
from plasmapyro.quality.agreement import throughput_in_doubt
from plasmapyro.readers import description, follow, parts
from plasmapyro.readers.text import Refusal
from plasmapyro.record import status
from plasmapyro.record.emittance import UNTOLD_SLOPE, tilt
from plasmapyro.record.inputs import attribute_faults
from plasmapyro.record.record import Record

STUCK = 10  # samples equal to the last digit in both bands, as in `record.flags`
OFTEN, APART = 50, 3.0  # samples, and the root mean square of their surprise [sd] that contradicts the model
MOST = OFTEN * APART**2 / 5  # of a sample: a single wrong one contradicts nothing
LEAP = 60.0  # [s] from sample to sample, believed when the next one confirms it
TOGETHER = 0.008  # [s] at least between two readings: samples in between are averaged, 100 Hz goes one by one
LAG, WAITED = 2.0, 0.02  # [s] of delay gained and share of the time spent waiting for samples: `behind`
IDLE = 1e-3  # [s] that a sample was waited for: what came before it was done


def run(options):
    """Run `plasmapyro live`: samples in, JSON lines out."""
    path, folder = Path(options.folder) / "test.yaml", Path(options.instrument)
    faults = []
    top = description.Section(description.load(path), path, "", faults)
    facts = parts.attributes(top.section("attributes"))
    known = {"plasma_off_time": 1e9, "window_transmittance_pyrometer": 1.0, "pyrometer_integration_time": 1.0}
    stated = type("Test", (), {"attrs": known | facts})
    faults += [f"{path}: {what}" for what in attribute_faults(stated, ["pyrometer"])]
    if faults:
        raise Refusal(faults)
    if options.stdin:
        samples = follow.samples_of_json(line.decode("utf-8", "replace") for line in _lines(sys.stdin.buffer))
    else:
        section = top.section("pyrometer")
        log = path.parent / (section.file("file", "pyrometer.csv") or "pyrometer.csv")
        samples = follow.samples_of_table(log, section, follow.growing(log, options.stop_after_s))
    calibration = io.read(folder / "calibration.nc", "calibration")
    response = io.read(folder / "response.nc", "response")
    record = record_of(facts)
    filtered = Filter(
        record,
        calibration,
        response,
        SETTINGS,
        tilt(record.emittance_slope, response),
        Renewal(stated.attrs, calibration, response, SETTINGS),
    )
    limits = [facts.get(f"signal_saturation_{band}", np.inf) for band in ("wide", "narrow")]
    for line in readings(samples, filtered, record.injection, limits, options):
        sys.stdout.write(json.dumps(line) + "\n")
        sys.stdout.flush()


def _lines(stream):
    while line := stream.readline(follow.LONGEST):
        yield line


def record_of(facts):
    """The facts of a test as a Record without data; the end of the plasma may be unknown."""
    injection = facts["injection_time"]
    return Record(
        injection,
        facts.get("plasma_off_time", np.inf) - injection,
        tuple(moment - injection for moment in facts["reference_window"]),
        facts["emittance"],
        facts["emittance_uncertainty"],
        facts.get("emittance_slope", 1.0),
        facts.get("emittance_slope_uncertainty", UNTOLD_SLOPE),
        (),
    )


class _Delay:
    """How far what is said lies behind what happens, by this machine's clock.

    What happens: by the first sample, and by those that were waited for; a record that is read through is
    ahead of the first.
    """

    def __init__(self):
        self._least, self._marks, self._waited, self._idle = np.inf, deque(maxlen=OFTEN), 0.0, True

    def waiting(self, samples):
        """The samples; notes how long each was waited for."""
        samples, begun = iter(samples), time.monotonic()
        while (sample := next(samples, self)) is not self:
            waited = time.monotonic() - begun
            self._waited, self._idle = self._waited + waited, self._idle or waited > IDLE
            yield sample
            begun = time.monotonic()

    def behind(self, moment):
        """Whether a sample of `moment` [s] is late, and only because those before it were still in work."""
        now = time.monotonic()
        if self._idle:
            self._least, self._idle = min(self._least, now - moment), False
        self._marks.append((now, self._waited))
        then, waited = self._marks[0]
        return now - moment - self._least > LAG and self._waited - waited < WAITED * (now - then)


def readings(samples, filtered, injection, limits, options):
    """One mapping for JSON per sample of `readers.follow`, or per mean of those that come in `TOGETHER`;
    per fault; per silence.

    `injection` [s] on the clock of the samples: an event may set it anew; signals from `limits` (2,) [A] on
    are saturated; `options` with `alarm_above_k`, `alarm_silence_s`.
    """
    last, silent, before, leapt, equal, pair = time.monotonic(), False, -np.inf, np.inf, 0, None
    surprise, together, due, delay = deque(maxlen=OFTEN), [], -np.inf, _Delay()
    for sample in delay.waiting(samples):
        if sample is None:
            if not silent and time.monotonic() - last > options.alarm_silence_s:
                silent = True
                yield {"alarms": ["silent"]}
            continue
        last, silent = time.monotonic(), False
        if isinstance(sample, str):
            yield {"alarms": ["unreadable"], "because": sample}
        elif "event" in sample:
            if sample["event"] == "plasma_off":
                filtered.off = sample["time"] - injection
            elif filtered.started:
                yield {"alarms": ["unreadable"], "because": "the injection has been"}
            else:
                injection = sample["time"]
        elif sample["time"] <= before:
            yield {"time": sample["time"], "alarms": ["unreadable"], "because": "the time does not rise"}
        elif LEAP < sample["time"] - before < np.inf and sample["time"] < leapt:
            leapt = sample["time"]
            because = (
                f"the time leaps by {leapt - before:.6g} s; it is believed if the next sample confirms it"
            )
            yield {"time": leapt, "alarms": ["unreadable"], "because": because}
        else:
            leapt, before = np.inf, sample["time"]
            earlier, pair = pair, [sample[name] for name in parts.SIGNALS]
            equal = equal + 1 if pair == earlier else 0
            # What came before a pause is not averaged with what comes behind it.
            together = [*(one for one in together if before - one[0] <= TOGETHER), (before, *pair)]
            if before < due:
                continue
            due = before + TOGETHER
            moments, *pairs = np.array(together).T
            together = []
            saturated = any((np.array(limits)[:, None] <= pairs).any(axis=1))
            mean = np.ma.masked_invalid(pairs).mean(axis=1).filled(np.nan)
            kept = [np.nan] * 2 if saturated or equal >= STUCK else mean
            reading = filtered.step(moments.mean() - injection, kept)
            if np.isfinite(reading.surprise):
                surprise.append(min(reading.surprise, MOST))
            contradiction = bool(np.sum(surprise) > OFTEN * APART**2 or filtered.contradictions)
            alarms = {
                "above_limit": reading.temperature > options.alarm_above_k,
                "saturated": saturated,
                "stuck": equal >= STUCK,
                "contradiction": contradiction,
                "behind": delay.behind(before),
                "estimate_lost": filtered.alone,
                "no_reference": filtered.late,
                "throughput_in_doubt": filtered.throughput_chance > throughput_in_doubt.limit,
            }
            state = status.SATURATED if saturated else reading.state
            if contradiction and state in status.WITH_VALUE:
                state = status.CONTRADICTED
            values = [reading.temperature, *map(float, reading.interval)]
            if state == status.CONTRADICTED:
                values = [np.nan] * 3
            yield {
                "time": float(moments.mean()),
                **{
                    name: None if value != value else round(value, 2)
                    for name, value in zip(("temperature", "low", "high"), values, strict=True)
                },
                "status": status.MEANINGS[state],
                "alarms": [name for name, rung in alarms.items() if rung],
            }
