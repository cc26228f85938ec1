"""Table of designs: bands, errors by source, limits and gains in every condition and changed gas."""

from dataclasses import replace

import numpy as np
import xarray as xr

from plasmapyro.design import budget, gains
from plasmapyro.design.bench import REFERENCE_TEMPERATURE, limit_of
from plasmapyro.design.judge import POWER_STEP, STATES

LARGEST_BANDS = 3
TABLE = {  # numbers of each design: their further dimensions
    "band_centre": ["design_band"],
    "band_width": ["design_band"],
    "band_weight": ["design_band"],
    "total_error": [],
    "error_by_source": ["error_source"],
    "ratio_sensitivity": [],
    "design_score": [],
    "design_limit": ["condition"],
    "design_gain": ["condition"],
    "gain_change": ["perturbation", "condition"],
    "map_limit": ["condition", "emittance"],
}


def tabulate(found, bench, judge, spectra, settings):
    """All designs side by side: bands, errors by source, limits and gains in every condition and
    perturbation."""
    # Changed gases: temperature, power, and every component's strength up and down.
    perturbations = ["nominal", "cold", "hot", "10 kW less", "10 kW more"]
    perturbations += [f"{one} {sign}" for one in spectra.component.values for sign in ("weaker", "stronger")]
    cases = judge.cases
    emittance = np.asarray(settings["map_emittance"], dtype=float)
    binned = (
        spectra.binned_radiance.sel(state="nominal").transpose("condition", "component", "wavelength").values
    )
    split = replace(bench, gas=binned.reshape(-1, binned.shape[-1]))
    reference = _perturbed_limits(judge, judge.build_reference, split, spectra, perturbations)
    axes = {
        "design": np.array([entry.name for entry in found], dtype=object),
        "error_source": list(budget.SOURCES),
        "perturbation": perturbations,
        "condition": spectra.condition.values,
        "emittance": emittance,
    }
    sizes = {name: len(values) for name, values in axes.items()}
    sizes["design_band"] = max(LARGEST_BANDS, judge.reference_weights.shape[1])
    table = {
        name: np.full([len(found), *(sizes[one] for one in dims)], np.nan) for name, dims in TABLE.items()
    }
    table["design_score"] = np.array([entry.score for entry in found])
    for row, entry in enumerate(found):
        bands = entry.centre.size
        table["band_centre"][row, :bands], table["band_width"][row, :bands] = entry.centre, entry.fwhm
        if entry.build is None:
            continue
        signal = entry.build(bench)
        weights = bench.weights(signal)
        table["band_weight"][row, : weights.shape[1]] = weights[0]
        parts = bench.parts(signal, weights)[:, 0, :cases]
        table["total_error"][row] = np.sqrt(np.mean(budget.total(parts) ** 2))
        table["error_by_source"][row] = np.sqrt(np.mean(parts**2, axis=(1, 2, 3)))
        slope = budget.sensitivity(signal.black, weights, REFERENCE_TEMPERATURE)[0]
        table["ratio_sensitivity"][row] = abs(slope)
        limit = _perturbed_limits(judge, entry.build, split, spectra, perturbations)
        gained = reference - limit
        table["design_limit"][row], table["design_gain"][row] = limit[0], gained[0]
        table["gain_change"][row] = gains.change(gained, gained[:1])
        error = bench.gas_error(signal, weights, judge.fine, emittance, gas=signal.gas[..., :cases])
        table["map_limit"][row] = limit_of(judge.fine, error, judge.level)[0]
    words = {
        f"design_{name}": ("design", np.array([getattr(entry, name) for entry in found], dtype=object))
        for name in ("kind", "detector", "shape")
    }
    numbers = {name: (("design", *dims), table[name]) for name, dims in TABLE.items()}
    power = {"numerical_power": ("condition", spectra.numerical_power.values)}
    return xr.Dataset(numbers | words | power, axes)


def _perturbed_limits(judge, build, split, spectra, names):
    """Limits (perturbation, C) [K] of one design; NaN where a neighbouring power is missing."""
    cases = judge.cases
    signal = build(judge.bench)
    nominal, cold, hot = np.split(signal.gas[..., : judge.bench.scored], len(STATES), axis=-1)
    gases = [nominal, cold, hot]
    gases += [
        gains.neighbour_signals(spectra.numerical_power.values, nominal, step)
        for step in (-POWER_STEP, POWER_STEP)
    ]
    parts = build(split).gas.reshape(*nominal.shape[:2], cases, -1)
    for component, uncertainty in enumerate(spectra.component_uncertainty.values):
        gases += [nominal + max(sign * uncertainty, -1.0) * parts[..., component] for sign in (-1, 1)]
    gases = np.concatenate(gases, axis=-1)
    missing = np.isnan(gases).any(axis=(0, 1)).reshape(len(names), cases)
    weights = judge.bench.weights(signal)
    limit = judge.limits(signal, weights, judge.fine, gas=np.nan_to_num(gases))[0]
    return np.where(missing, np.nan, limit)
