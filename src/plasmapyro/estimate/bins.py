"""Bins of wavelength: means of spectra over them, and where the instruments need fine ones."""

import numpy as np

from plasmapyro.checks import increasing

EDGE_SPAN = 15e-9  # [m] about the long-pass edge, where a line's place in its bin matters
FINE, COARSE = 1e-9, 3e-9  # [m] there and elsewhere: Planck's law at 1000 K is 1e-4 off a bin's mean
# [m] lines of O I and N I that follow the gas; each keeps a bin of its own.
LINE_BINS = (
    (775.0e-9, 780.0e-9),  # O I 777
    (817.5e-9, 826.5e-9),  # N I 820
    (842.5e-9, 847.5e-9),  # O I 845
    (858.5e-9, 875.5e-9),  # N I 862-873
    (901.5e-9, 908.5e-9),  # N I 905
    (923.5e-9, 930.0e-9),  # O I 926
    (936.5e-9, 942.5e-9),  # N I 939
    (1009.0e-9, 1015.0e-9),  # N I 1011
)
CONTINUUM_BIN = 8e-9  # [m] between the lines


def bin_mean(wavelength, values, edges):
    r"""Mean of piecewise linear spectra over bins; integrals are kept, lines included.

    ValueError if the bins reach beyond the spectrum.

    Parameters
    ----------
    wavelength : (G,) array [m], strictly increasing
    values : (..., G) array
    edges : (B + 1,) array [m], strictly increasing, within the spectrum

    Returns
    -------
    (..., B) ndarray, unit of `values`
    """
    grid, edges = increasing("wavelength", wavelength, "m"), increasing("edges", edges, "m")
    if edges[0] < grid[0] or edges[-1] > grid[-1]:
        raise ValueError(
            f"the bins reach from {edges[0] * 1e9:g} to {edges[-1] * 1e9:g} nm, the spectrum only from"
            f" {grid[0] * 1e9:g} to {grid[-1] * 1e9:g} nm"
        )
    values = np.asarray(values, dtype=float)
    slices = np.diff(grid) * (values[..., 1:] + values[..., :-1]) / 2
    total = np.concatenate([np.zeros((*values.shape[:-1], 1)), np.cumsum(slices, axis=-1)], axis=-1)
    place = np.clip(np.searchsorted(grid, edges) - 1, 0, grid.size - 2)
    step = edges - grid[place]
    slope = (values[..., place + 1] - values[..., place]) / (grid[place + 1] - grid[place])
    return np.diff(total[..., place] + step * (values[..., place] + slope * step / 2)) / np.diff(edges)


def band_edges(wavelength, responsivity):
    """Edges (B + 1,) [m] of bins over a response: fine where it rises out of nothing, coarse elsewhere.

    `responsivity` (R,) [1], of the band that begins first, at `wavelength` (R,) [m].
    """
    wavelength = increasing("wavelength", wavelength, "m")
    rise = np.interp(0.5, np.maximum.accumulate(responsivity / np.max(responsivity)), wavelength)
    low, high = wavelength[0], wavelength[-1]
    first, last = np.clip([rise - EDGE_SPAN, rise + EDGE_SPAN], low, high)
    spans = (low, first, COARSE), (first, last, FINE), (last, high, COARSE)
    return np.append(np.concatenate([_split(*span) for span in spans if span[1] > span[0]]), high)


def _split(low, high, size):
    """Lower edges of equal bins of at most `size`."""
    return np.linspace(low, high, int(np.ceil((high - low) / size)), endpoint=False)


def spectrometer_edges(pixels):
    """Edges (C + 1,) [m] of bins of rising pixels (W,) [m]: one for each gas line, broad ones between."""
    pixels = increasing("pixels", pixels, "m")
    half = (pixels[1] - pixels[0]) / 2
    low, high = pixels[0] - half, pixels[-1] + half
    fixed = [edge for line in LINE_BINS if low < line[0] and line[1] < high for edge in line]
    corners = np.unique([low, *fixed, high])
    lines = {line[0] for line in LINE_BINS}
    parts = [
        _split(a, b, b - a if a in lines else CONTINUUM_BIN)
        for a, b in zip(corners[:-1], corners[1:], strict=True)
    ]
    return np.append(np.concatenate(parts), high)


def pixel_bins(pixels, edges):
    """Bin (W,) of each pixel, as an index."""
    return np.clip(np.searchsorted(edges, pixels, side="right") - 1, 0, len(edges) - 2)
