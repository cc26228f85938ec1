"""LabVIEW TDMS files, through npTDMS (optional)."""

import logging
from contextlib import contextmanager

import numpy as np

from plasmapyro import foreign
from plasmapyro.readers.columns import GAIN_OF, divisors, over_gain, to_si
from plasmapyro.readers.text import quote, refuse, regular_file

LARGEST = 1_000_000_000  # [byte]
MOST_SAMPLES = 50_000_000  # of one channel
EPOCH = np.datetime64("2000-01-01")


def read_tdms(path, columns, joined=False):
    """Channels (N,) of a TDMS file in SI by their names, 'time' included.

    `columns`: name -> `Column` of a channel 'group/channel'. Without a column for time, the channels must be
    waveforms: their start offset and increment give it. `joined`: the file is one of several of a record, and
    'start' [s] since 2000 (wf_start_time) is given as well, so that the files share one clock. Refusal:
    npTDMS is not installed, the file is damaged, a channel is absent, or lengths and times differ.
    """
    TdmsFile = _of_nptdms(path)
    path, wanted, gains = regular_file(path, LARGEST), columns, divisors(columns)
    columns = wanted | {GAIN_OF + name: column for name, column in gains.items()}
    # npTDMS trusts what the file says about itself: a damaged one can raise anything.
    try:
        with (
            foreign.memory_for(path),
            _complaints() as complaints,
            open(path, "rb") as stream,
            TdmsFile.open(stream) as file,
        ):
            channels = {f"{group.name}/{c.name}": c for group in file.groups() for c in group.channels()}
            absent = [column.header for column in columns.values() if column.header not in channels]
            if not absent and all(len(channels[c.header]) <= MOST_SAMPLES for c in columns.values()):
                found = {name: _channel(path, columns[name], channels) for name in columns}
                first = channels[next(iter(columns.values())).header]
                start = _start(path, first) if joined and "time" not in columns else None
            else:
                found = None
    except ImportError:
        raise
    except MemoryError:
        refuse(path, "asks for more memory than its size allows", "export it again from LabVIEW")
    except Exception as reason:  # noqa: BLE001
        if type(reason).__module__.startswith("plasmapyro"):
            raise
        refuse(path, f"is not a readable TDMS file ({quote(reason)})", "export it again from LabVIEW")
    if complaints:
        refuse(
            path,
            f"is damaged or cut off ({quote(complaints[0])})",
            "copy it again; if the log was interrupted, open and save it in LabVIEW",
        )
    if absent:
        listed = ", ".join(sorted(channels)[:10]) or "none"
        refuse(path, f"no channel {', '.join(map(quote, absent))}", f"name one of those it holds: {listed}")
    if found is None:
        refuse(path, f"a channel holds more than {MOST_SAMPLES} samples", "cut it to the test")
    result = _joined(path, found) | ({} if start is None else {"start": start})
    for name in gains:
        result[name] = over_gain(path, wanted[name], result[name], result.pop(GAIN_OF + name))
    return result


def channels(path):
    """Channels of a TDMS file: 'group/channel' -> (unit or None, whether it carries times)."""
    TdmsFile = _of_nptdms(path)
    try:
        with _complaints(), TdmsFile.read_metadata(regular_file(path, LARGEST)) as file:
            return {
                f"{group.name}/{c.name}": (
                    str(c.properties.get("unit_string", "")).strip() or None,
                    "wf_increment" in c.properties,
                )
                for group in file.groups()
                for c in group.channels()
            }
    except Exception as reason:  # noqa: BLE001  as in `read_tdms`
        refuse(path, f"is not a readable TDMS file ({quote(reason)})", "export it again from LabVIEW")


def _of_nptdms(path):
    """Its class of files; Refusal where it is not installed."""
    try:
        from nptdms import TdmsFile
    except ImportError:
        refuse(path, "reading TDMS needs npTDMS", "install it: pip install 'plasmapyro[tdms]'")
    return TdmsFile


@contextmanager
def _complaints():
    """Collects what npTDMS only warns of: it reads on with what is left of a damaged file."""
    found = []

    class Listener(logging.Handler):
        def emit(self, record):
            found.append(record.getMessage())

    listener, log = Listener(logging.WARNING), logging.getLogger("nptdms")
    log.addHandler(listener)
    before, log.propagate = log.propagate, False
    try:
        yield found
    finally:
        log.removeHandler(listener)
        log.propagate = before


def _channel(path, column, channels):
    channel = channels[column.header]
    values = np.asarray(channel[:])
    if values.dtype.kind not in "fiu" or values.ndim != 1 or not values.size:
        refuse(path, f"channel {quote(column.header)} holds no numbers", "name a channel of numbers")
    properties = channel.properties
    values = to_si(path, column, values.astype(float), str(properties.get("unit_string", "")).strip() or None)
    step = properties.get("wf_increment")
    track = None
    if step is not None:
        track = float(properties.get("wf_start_offset", 0.0)) + float(step) * np.arange(values.size)
    return values, track


def _start(path, channel):
    """Start time of a channel [s] since 2000."""
    start = channel.properties.get("wf_start_time")
    if start is None:
        refuse(
            path,
            f"channel {quote(channel.name)} has no start time (wf_start_time)",
            "name a time channel in test.yaml, or join the files in LabVIEW",
        )
    return float((np.datetime64(start) - EPOCH) / np.timedelta64(1, "us")) * 1e-6


def _joined(path, found):
    sizes = {values.size for values, _ in found.values()}
    if len(sizes) > 1:
        refuse(path, "the channels differ in length", "export channels of one and the same rate")
    result = {name: values for name, (values, _) in found.items()}
    if "time" not in result:
        tracks = [track for _, track in found.values()]
        if tracks[0] is None or any(t is None or not np.array_equal(t, tracks[0]) for t in tracks):
            refuse(
                path, "the channels carry no common time (wf_increment)", "name a time channel in test.yaml"
            )
        result["time"] = tracks[0]
    return result
