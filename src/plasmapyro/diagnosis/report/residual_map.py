"""Measured, modelled, and the difference over its standard deviation, on the bins of both instruments."""

import numpy as np
import xarray as xr

SHORTEST = 1e-3  # [s], width of a bin


def residual_map(findings):
    """Data, models and residuals, contract 'residual_map'."""
    times = findings.times
    edges = np.stack([times, times], axis=1)
    variables, coordinates = {}, {"time_bin": times, "model": ["base", "extended"]}
    fits = (findings.base.solution, findings.final)
    for which, instrument in enumerate(findings.model.instruments):
        place = np.searchsorted(times, instrument.time)
        half = np.maximum(2 * instrument.moment.std(axis=1, keepdims=True), SHORTEST) * np.sqrt(3) / 2
        edges[place] = instrument.time[:, None] + half * np.array([-1.0, 1.0])

        def laid(values, place=place):
            rows = np.full((times.size, values.shape[1]), np.nan)
            rows[place] = values
            return rows

        measured = laid(instrument.value)
        modelled = np.array([laid(fit.prediction[which]) for fit in fits])
        residual = np.array([laid(residuals[which]) for residuals in findings.residuals])
        if instrument.kind == "spectrometer":
            dims = ("time_bin", "wavelength_bin")
            coordinates["wavelength_bin"] = instrument.wavelength
            variables["measured_radiance"] = (dims, measured)
            variables["modelled_radiance"] = (("model", *dims), modelled)
            variables["radiance_residual"] = (("model", *dims), residual)
            variables["wavelength_edge"] = (("wavelength_bin", "bound"), _edges(instrument.wavelength))
        else:
            dims = ("band", "time_bin")
            coordinates["band"] = list(instrument.band)
            variables["measured_signal"] = (dims, measured.T)
            variables["modelled_signal"] = (("model", *dims), modelled.transpose(0, 2, 1))
            variables["signal_residual"] = (("model", *dims), residual.transpose(0, 2, 1))
    variables["time_edge"] = (("time_bin", "bound"), edges)
    return xr.Dataset(
        variables,
        coordinates,
        {
            "title": "Measured, modelled, and the difference over its standard deviation",
            "origin": str(findings.record.attributes.get("origin", "measured")),
        },
    )


def _edges(centre):
    """Ends (n, 2) of cells about some middles (n,)."""
    middle = (centre[1:] + centre[:-1]) / 2
    ends = 2 * centre[[0, -1]] - middle[[0, -1]]
    bounds = np.concatenate([ends[:1], middle, ends[1:]])
    return np.stack([bounds[:-1], bounds[1:]], axis=1)
