"""`.pyro.plot()` of results: the picture that one looks at first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from plasmapyro.record import status

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NANOMETRE, LINE_WIDTH = 1e9, 0.8
COLOURS = 10  # before they begin again
OF_TIME = {  # temperature -> its axis, its status, its standard uncertainty or the ends of its interval
    "corrected_temperature": ("time", "corrected_status", "corrected_temperature_uncertainty"),
    "spectrometer_temperature": ("spectrum_time", "spectrum_status", "spectrometer_temperature_uncertainty"),
    "surface_temperature": ("time", "estimate_status", "surface_temperature_uncertainty"),
}


@xr.register_dataset_accessor("pyro")
class Pictures:
    """`.pyro` of a dataset that this package made."""

    def __init__(self, result: xr.Dataset) -> None:
        self._result = result

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw the result; temperatures against time with the status of each sample, or spectra.

        Parameters
        ----------
        axes : matplotlib Axes, optional
            The current ones if left out.

        Returns
        -------
        Axes

        Raises
        ------
        ValueError
            A dataset that has no picture.
        """
        from matplotlib import pyplot

        axes = pyplot.gca() if axes is None else axes
        found = self._result
        if any(name in found for name in OF_TIME):
            _temperatures(axes, found)
        elif "extended_temperature" in found:
            _intervals(axes, found)
        elif "gas_radiance_component_slit" in found:
            _spectra(axes, found)
        elif "model_residual" in found:
            axes.plot(found.source_temperature, 100 * found.model_residual.T, "o-", label="modelled curve")
            axes.plot(found.source_temperature, 100 * found.fit_residual.T, "s--", label="quadratic")
            _named(axes, "temperature of the source / K", "residual of the ratio / %")
        else:
            raise ValueError(
                f"no picture of {found.attrs.get('contract', 'such a dataset')}; plot its variables"
            )
        axes.legend()
        return axes


@xr.register_datatree_accessor("pyro")
class TreePictures:
    """`.pyro` of a calibration or a diagnosis: the part that one looks at first."""

    def __init__(self, tree: xr.DataTree) -> None:
        self._tree = tree

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw the temperature of a diagnosis, the residuals of a pyrometer; see `Pictures.plot`."""
        first = next((name for name in ("temperature", "calibration") if name in self._tree.children), None)
        if first is None:
            raise ValueError(f"plot one of {', '.join(self._tree.children)}")
        return Pictures(self._tree[first].to_dataset()).plot(axes)


def _named(axes: Axes, across: str, up: str) -> None:
    axes.set_xlabel(across)
    axes.set_ylabel(up)


def _temperatures(axes: Axes, found: xr.Dataset) -> None:
    """Temperatures with their standard uncertainty, one marker for each status that may be believed."""
    for name, (axis, state, error) in OF_TIME.items():
        if name not in found:
            continue
        time, values, sigma = found[axis].values, found[name].values, found[error].values
        for code, word in status.MEANINGS.items():
            chosen = (found[state].values == code) & np.isfinite(values)
            if chosen.any():
                axes.errorbar(
                    time[chosen], values[chosen], sigma[chosen], fmt=".", elinewidth=LINE_WIDTH,
                    label=f"{name.split('_')[0]}: {word.replace('_', ' ')}",
                )  # fmt: skip
    _named(axes, "time / s", "temperature / K")


def _intervals(axes: Axes, found: xr.Dataset) -> None:
    """Temperature of a diagnosis with and without the effects it named, 95 % intervals."""
    for kind, word in (("base", "simulation as it is"), ("extended", "with what was named")):
        low, high = (found[f"{kind}_temperature_{end}"] for end in ("low", "high"))
        (line,) = axes.plot(found.time_bin, found[f"{kind}_temperature"], label=word)
        axes.fill_between(found.time_bin, low, high, color=line.get_color(), alpha=0.3, linewidth=0)
    _named(axes, "time / s", "temperature / K")


def _spectra(axes: Axes, found: xr.Dataset) -> None:
    """Spectrum through the slit, and that of each radiating system."""
    wavelength = NANOMETRE * found.wavelength_slit
    for number, name in enumerate(found.component.values):
        values = found.gas_radiance_component_slit.sel(component=name)
        style = "-" if number < COLOURS else ":"
        axes.plot(wavelength, values, style, linewidth=LINE_WIDTH, label=str(name))
    axes.plot(wavelength, found.gas_radiance_slit, "k", linewidth=LINE_WIDTH, label="all")
    axes.set_yscale("log")
    _named(axes, "vacuum wavelength / nm", "spectral radiance / W m$^{-2}$ sr$^{-1}$ m$^{-1}$")
