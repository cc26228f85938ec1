"""The rules, in the order in which they are said."""

from pathlib import Path

import numpy as np
import xarray as xr

from plasmapyro.quality import agreement, clocks, instrument, pyrometer, sightline, spectra, window
from plasmapyro.quality.rule import DOUBT, Case, look, rules_of

OF_TEST = rules_of(agreement, window, pyrometer, spectra, clocks)
OF_CALIBRATION = rules_of(instrument)
OF_SIGHTLINE = rules_of(sightline)


def of_test(place, reading, results=(), rules=OF_TEST, **calibrations):
    """What contradicts itself in a test, its results and its calibrations: the one way to all who say it.

    `place`: of the test, for the messages; `reading`: `readers.stage.Reading`; `results`: of the contracts
    'correction' or its two parts, 'joint_estimate', 'emissivity_estimate'; `calibrations` by the names of
    `Case`, None where there is none. The worst finding stands first.
    """
    estimates = [one for one in results if {"surface_temperature", "spectral_temperature"} & set(one)]
    parts = [one for one in results if not any(one is other for other in estimates)]
    case = Case(
        Path(place),
        reading.test,
        reading.files.get("spectrometer", {}),
        result=merged(parts) if parts else None,
        estimate=next(iter(estimates), None),
        **calibrations,
    )
    return look(case, rules)


def merged(parts):
    """The corrections of single instruments (Datasets) as one, contract 'correction'."""
    attributes = {name: value for part in parts for name, value in part.attrs.items()}
    whole = xr.merge(
        list(_on_one_clock(parts)), combine_attrs="override", join="exact", compat="no_conflicts"
    )
    return whole.assign_attrs(attributes)


def _on_one_clock(parts):
    """Times counted from the injection and back may differ in their last bit: those of the first part."""
    first = {}
    for part in parts:
        for axis in {"time", "spectrum_time"} & set(part.coords):
            own, known = part[axis].values, first.setdefault(axis, part[axis].values)
            if own.shape == known.shape and np.allclose(own, known, rtol=1e-12, atol=1e-9):
                part = part.assign_coords({axis: known})
        yield part


def table(rules):
    """A Markdown table of rules."""
    rows = [
        f"| `{r.name}`{'*' * (r.severity == DOUBT)} | {r.looks_at} | {r.limit:g} {r.unit} | {r.reason} |"
        for r in rules
    ]
    return "\n".join(["| rule | looks at | limit | because |", "|---|---|---|---|", *rows]).replace(
        " 1 |", " |"
    )
