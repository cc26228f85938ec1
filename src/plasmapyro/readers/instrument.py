"""An instrument of any number of bands, as a file describes it."""

from pathlib import Path

import numpy as np
import xarray as xr

from plasmapyro.readers import description
from plasmapyro.readers.spectrum import read_frames
from plasmapyro.readers.text import Refusal, checked, fault
from plasmapyro.tables import ORIGINS

CALIBRATIONS = ("absolute", "relative", "readings")
MOST_BANDS = 200
LEAST_NODES = 3  # of a response
FLANK, STEP = 0.05e-9, 1e-9  # [m] half the rise of a band that is stated by its edges; spacing of samples
GUIDE = "see docs/your-own-data.md"


def read_instrument(path):
    """Bands of an instrument (contract 'response') and what is known of it, from a YAML file.

    `bands`: a list of mappings with a `name` and `edges_nm`, or `centre_nm` and `width_nm`, or `response`,
    the name of a file beside it with wavelengths [nm] in vacuum and responses. `calibration`: 'absolute';
    'relative', if a level common to all bands is not known; 'readings', if it shows kelvin.
    `signal_uncertainty` [1], `range_k` [K, K]. Attributes: `instrument`, `calibration`, `signal_uncertainty`,
    `instrument_range` [K], `origin`. Refusal with one sentence per fault.
    """
    path, faults = Path(path), []
    top = description.Section(description.load(path), path, "", faults)
    facts = {
        "instrument": top.text("name", needed=True),
        "origin": top.text("origin", "modelled", choices=ORIGINS),
        "calibration": top.text("calibration", needed=True, choices=CALIBRATIONS),
        "signal_uncertainty": top.number("signal_uncertainty", above=0, needed=True),
        "instrument_range": top.numbers("range_k", 2, needed=True),
    }
    listed = top.raw("bands", needed=True)
    top.close()
    bands = {}
    if not isinstance(listed, list) or not 0 < len(listed) <= MOST_BANDS:
        top.blame("bands", f"must be a list of 1 to {MOST_BANDS} bands", GUIDE)
        listed = []
    for number, values in enumerate(listed):
        band = description.Section(values, path, f"bands[{number}]", faults)
        name, curve = band.text("name", needed=True), _curve(band)
        if name in bands:
            band.blame("name", f"{name!r} stands twice", "give each band its own")
        if curve is not None:
            bands[name] = curve
    if faults:
        raise Refusal(faults)
    wavelength = np.unique(np.concatenate([nodes for nodes, _ in bands.values()]))
    curves = [np.interp(wavelength, *curve, left=0.0, right=0.0) for curve in bands.values()]
    dataset = xr.Dataset(
        {"responsivity": (("band", "wavelength"), curves)},
        {"wavelength": wavelength, "band": list(bands)},
        facts,
    )
    return checked(dataset, "response", path)


def _curve(band):
    """Nodes [m] and responses of a band, or None after a fault."""
    edges, before = None, len(band.faults)
    if "response" in band:
        name = band.file("response")
        band.close()
        if len(band.faults) > before:
            return None
        wavelength, frames = read_frames(band.path.parent / name, LEAST_NODES)
        peak = frames[0].max()
        if not (frames[0] >= 0).all() or not peak > 0:
            band.faults.append(fault(band.path.parent / name, "a response must be >= 0", "correct it"))
            return None
        return wavelength, frames[0] / peak
    if "edges_nm" in band:
        edges = band.numbers("edges_nm", 2)
    else:
        centre, width = (band.number(key, above=0, needed=True) for key in ("centre_nm", "width_nm"))
        if None not in (centre, width):
            edges = [centre - width / 2, centre + width / 2]
    band.close()
    if edges is None or len(band.faults) > before:
        return None
    low, high = (edge * 1e-9 for edge in edges)
    inside = np.linspace(low + FLANK, high - FLANK, max(int((high - low) / STEP), 2))
    if not 0 < low < high - 4 * FLANK:
        band.blame("edges_nm", f"must rise by more than 0.2 nm; got {edges}", "correct them")
        return None
    return np.concatenate([[low - FLANK], inside, [high + FLANK]]), np.concatenate(
        [[0.0], np.ones(inside.size), [0.0]]
    )
