"""Judges of designs: the bench in front of all gases, and what a design is worth there."""

import numpy as np

from plasmapyro.checks import increasing
from plasmapyro.design import budget, gains
from plasmapyro.design.bench import Bench, limit_of
from plasmapyro.radiation.atoms import ATOMS
from plasmapyro.radiation.band_systems import SYSTEMS
from plasmapyro.radiation.bandsignal import bands_of, require_cover, responsivities
from plasmapyro.radiation.path import CONTINUA

STATES = ("nominal", "cold", "hot")
PAPERS = "MR1SB"  # the instrument of the paper
CHUNK = 400  # designs at a time: their errors fit into the cache's neighbourhood
LIMIT_STEP = 25.0  # [K] of the search's temperatures; 5 K of the table that is kept
FINE_STEP = 5.0
POWER_STEP = 10e3  # [W] of the perturbed power


def make_bench(spectra, tables, settings):
    """The `Bench` of `band_design` in front of the gases of all conditions.

    As computed, colder, hotter, and with the strengths of lines of atoms, of bands of molecules and of
    continua weaker and stronger by their uncertainty. `tables`: data tables `detectors`, `silicon`, `air`;
    `settings`: the keys of `design` in the configuration.
    """
    gas = spectra.binned_radiance.transpose("state", "condition", "component", "wavelength").values
    nominal, names = gas[0], spectra.component.values.astype(str)
    groups = [np.isin(names, list(ATOMS)), np.isin(names, list(SYSTEMS)), np.isin(names, CONTINUA)]
    share = np.minimum(spectra.component_uncertainty.values, 1.0)
    changed = [
        nominal.sum(axis=1) + sign * np.einsum("k,ckb->cb", share * group, nominal)
        for group in groups
        for sign in (-1, 1)
    ]
    return Bench(
        spectra.wavelength_edge.values,
        np.concatenate([*gas.sum(axis=2), *changed]),
        len(STATES) * spectra.sizes["condition"],
        increasing("object_temperature_k", settings["object_temperature_k"], "K"),
        increasing("emittance", settings["emittance"], "1"),
        budget.Receiver(**settings["receiver"]),
        budget.Uncertainties(**settings["uncertainties"]),
        tables["detectors"],
        tables["silicon"],
        settings["silicon_thickness_um"] * 1e-6,
        tables["air"],
    )


def covered(response, edges):
    """Responsivities of the reference instrument, of any bands; ValueError if one leaves the spectra."""
    wavelength, curves = response.wavelength.values, responsivities(response)
    for name, curve in zip(bands_of(response), curves, strict=True):
        if "responsivity" in response:
            require_cover((edges[0], edges[-1]), wavelength, curve, name)
    return curves


def reference_name(response):
    """What the reference instrument is called: the paper's, or as its file says."""
    return response.attrs["instrument"] if "responsivity" in response else PAPERS


class Judge:
    """Scores of designs: total error over all gases, and how far the gain leaves its tolerance."""

    def __init__(self, bench, power, response, settings):
        self.bench, self.power, self.cases = bench, power, power.size
        self.level, self.emittance = settings["error_level"], [settings["limit_emittance"]]
        self.tolerance = settings["gain_tolerance"]
        first, last = settings["limit_temperature_k"]
        self.coarse = np.arange(first, last + 1, LIMIT_STEP)
        self.fine = np.arange(first, last + 1, FINE_STEP)
        curves = covered(response, bench.edges)
        self.build_reference = lambda some: some.currents_of(response.wavelength.values, curves)
        self.reference = self.build_reference(bench)
        self.reference_weights = bench.weights(self.reference)
        self.coarse_reference = self.limits(self.reference, self.reference_weights, self.coarse)

    def limits(self, signal, weights, temperature, **changes):
        """(D, state, C) [K] on the gases of the bench, (D, 1, C) on others; NaN where there is none."""
        error = self.bench.gas_error(signal, weights, temperature, self.emittance, **changes)
        return limit_of(temperature, error, self.level).reshape(len(error), -1, self.cases)

    def __call__(self, signal):
        """Total error of each design plus the excess of its gain's change, (D,)."""
        return np.concatenate([self.bench.score(some) + self._excess(some) for some in signal.split(CHUNK)])

    def error(self, signal):
        """Total error alone (D,)."""
        return np.concatenate([self.bench.score(some) for some in signal.split(CHUNK)])

    def best(self, signal, error):
        """Row of the best design by its score; only designs whose `error` alone (D,) could win are judged."""
        order, row, least = np.argsort(error, kind="stable"), 0, np.inf
        for first in range(0, len(order), CHUNK):
            some = order[first : first + CHUNK]
            if error[some[0]] >= least:
                break
            scores = error[some] + self._excess(signal.rows(some))
            if scores.min() < least:
                row, least = some[np.argmin(scores)], scores.min()
        return row

    def _excess(self, some):
        weights = self.bench.weights(some)
        limit = self.limits(some, weights, self.coarse)
        gained = self.coarse_reference - limit
        changed = np.concatenate(
            [gained[:, 1:], gains.at_neighbours(self.power, gained[:, 0], POWER_STEP)], axis=1
        )
        ratio = gains.change(changed, gained[:, :1])
        return gains.excess(ratio, self.tolerance)
