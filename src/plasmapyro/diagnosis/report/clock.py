"""Times of a diagnosis, which count from the injection, on the clock of the test."""

from dataclasses import replace

TIMES = ("time", "start", "end", "at_time", "plasma_off_time")  # keys of a report that hold seconds


def on_clock(diagnosis, injection):
    """The diagnosis with every time on the clock of the test, where the injection is at `injection` [s]."""
    if injection == 0:
        return diagnosis
    return replace(
        diagnosis,
        report=_moved(diagnosis.report, injection),
        residual_map=_with_times(diagnosis.residual_map, injection),
        temperature=_with_times(diagnosis.temperature, injection),
    )


def _moved(part, shift, key=None):
    if isinstance(part, dict):
        return {name: _moved(value, shift, name) for name, value in part.items()}
    if isinstance(part, list):
        return [_moved(value, shift, key) for value in part]
    return part + shift if key in TIMES and isinstance(part, float) else part


def _with_times(dataset, shift):
    moved = dataset.assign_coords(time_bin=dataset["time_bin"].values + shift)
    if "time_edge" in dataset:
        moved["time_edge"] = dataset["time_edge"].dims, dataset["time_edge"].values + shift
    return moved
