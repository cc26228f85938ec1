"""From which temperature on, and how long after injection, a reading can be trusted."""

from dataclasses import replace

import numpy as np
import xarray as xr

from plasmapyro.analysis.transient import step_response
from plasmapyro.design import budget
from plasmapyro.design.bench import REFERENCE_TEMPERATURE, limit_of
from plasmapyro.design.judge import FINE_STEP, STATES, covered, make_bench, reference_name

SURFACES = {"mirror": 0.0, "matt": 1.0}  # share of diffuse reflection
LATEST = 1e5  # [s]
AS_READ, SUBTRACTED, SIMULATED = "as read", "reference after injection subtracted", "computed gas subtracted"


def time_to_reach(temperature, initial_temperature, gain, natural_frequency):
    """Time [s] from the injection until a sample reaches a temperature [K]: 0 at the start, NaN if never.

    The others as in `analysis.transient.step_response`.
    """
    if not temperature < initial_temperature + gain:
        return np.nan
    if temperature <= initial_temperature:
        return 0.0

    def missing(time):
        return float(step_response(time, initial_temperature, gain, natural_frequency)) - temperature

    from scipy.optimize import brentq  # 0.2 s, which the pages of the table do not cost

    return brentq(missing, 0.0, LATEST, xtol=1e-6) if missing(LATEST) > 0 else np.nan


def trust(spectra, designs, response, tables, *, settings, instruments=()):
    """Temperatures and times from which each setup reads within given levels, for every condition.

    Setups: the reference instrument as read; with the reference of the cold sample subtracted, wrong by the
    variation of the gas; with the computed gas of the line of sight subtracted, when the gas is in truth
    hotter or colder; the best pair of filters, and the best single band, each as read; the best two-band
    design with its own reference subtracted. The worst emittance of the range counts.

    ASSUME: the sample heats as a critically damped second-order system (Fagnani et al., sec. 4.5); grey.
    The levels are those of the gas alone; `own_uncertainty` is what the instrument adds.

    ValueError: unknown instrument, or one whose bands reach beyond the radiation data.

    Parameters
    ----------
    spectra, designs, response : Datasets, contracts 'gas_spectra', 'band_design', 'response'
    tables : as in `stage.band_design`
    settings : mapping, the keys of `design` in the configuration
    instruments : names of further designs, as read and with the reference subtracted

    Returns
    -------
    Dataset, contract 'trust'
    """
    keys = settings["trust"]
    bench, cases = make_bench(spectra, tables, settings), spectra.sizes["condition"]
    emittance = np.linspace(*keys["emittance_range"], 3)
    first, last = settings["limit_temperature_k"]
    temperature = np.arange(first, last + 1, FINE_STEP)
    light = replace(bench, gas=spectra.incident_binned.sel(reflection="diffuse").values)
    curves, name = covered(response, bench.edges), reference_name(response)

    def reference(some):
        return some.currents_of(response.wavelength.values, curves)

    def of_design(row):
        def build(some):
            bands = np.isfinite(row.band_centre.values)
            centre, fwhm = (row[name].values[None, bands] for name in ("band_centre", "band_width"))
            return some.currents(str(row.design_detector.values), centre, fwhm, str(row.design_shape.values))

        return build

    filters, single = (_first(designs, kind, bands) for kind, bands in (("filters", 2), ("optimum", 1)))
    best, lowest = (designs.sel(design=designs.attrs[name]) for name in ("best_two_band", "lowest_two_band"))
    setups = [
        (f"{name}, {AS_READ}", reference, AS_READ),
        (f"{name}, {SUBTRACTED}", reference, SUBTRACTED),
        (f"{name}, {SIMULATED}", reference, SIMULATED),
        (f"{filters.design.item()}, {AS_READ}", of_design(filters), AS_READ),
        (f"{single.design.item()}, {AS_READ}", of_design(single), AS_READ),
        (f"{lowest.design.item()}, {AS_READ}", of_design(lowest), AS_READ),
        (f"{best.design.item()}, {AS_READ}", of_design(best), AS_READ),
        (f"{best.design.item()}, {SUBTRACTED}", of_design(best), SUBTRACTED),
    ]
    for name in instruments:
        row = _known(designs, name)
        setups += [(f"{name}, {mode}", of_design(row), mode) for mode in (AS_READ, SUBTRACTED)]
    levels = np.asarray(keys["levels"], dtype=float)
    limits = np.empty((cases, len(SURFACES), len(setups), levels.size))
    own = np.empty(len(setups))
    for place, (_, build, mode) in enumerate(setups):
        signal = build(bench)
        weights, diffuse = bench.weights(signal), build(light).gas
        parts = bench.parts(signal, weights)[1:, 0, :cases]
        at_reference = np.abs(bench.temperature - REFERENCE_TEMPERATURE).argmin()
        own[place] = budget.total(parts)[..., at_reference].mean()
        for number, mix in enumerate(SURFACES.values()):
            error = _worst(
                bench, signal, weights, diffuse, mix, mode, keys["gas_variation"], temperature, emittance
            )
            for column, level in enumerate(levels):
                limits[:, number, place, column] = limit_of(temperature, error, level)
    heating = [keys[name] for name in ("initial_temperature_k", "gain_k", "natural_frequency_per_s")]
    times = np.vectorize(lambda value: time_to_reach(value, *heating), otypes=[float])(limits)
    dims = ("condition", "surface", "setup", "trust_level")
    return xr.Dataset(
        {
            "trust_temperature": (dims, limits),
            "trust_time": (dims, times),
            "own_uncertainty": ("setup", own),
            "numerical_power": spectra.numerical_power,
        },
        {
            "condition": spectra.condition.values,
            "surface": list(SURFACES),
            "setup": [name for name, _, _ in setups],
            "trust_level": levels,
        },
        {
            "origin": "modelled",
            "emittance_range": list(map(float, keys["emittance_range"])),
            "gas_variation": float(keys["gas_variation"]),
            "heating": f"{heating[0]:g} K to {heating[0] + heating[1]:g} K, {heating[2]:g} 1/s",
        },
    )


def _first(designs, kind, bands):
    """The design of a kind and number of bands with the smallest score."""
    count = np.isfinite(designs.band_centre).sum("design_band")
    chosen = designs.isel(design=np.flatnonzero((designs.design_kind == kind) & (count == bands)))
    return chosen.isel(design=int(np.argmin(chosen.design_score.values)))


def _known(designs, name):
    """The named design; ValueError with those that can be judged if it is not one of them."""
    judged = designs.isel(
        design=np.flatnonzero(np.isfinite(designs.total_error) & (designs.design_detector != ""))
    )
    judged = judged.isel(design=np.flatnonzero(np.isfinite(judged.band_centre[:, 0])))
    if name not in judged.design.values:
        listed = "\n  ".join(map(str, judged.design.values))
        raise ValueError(f"instrument must be one of\n  {listed}\ngot {name!r}")
    return judged.sel(design=name)


def _worst(bench, signal, weights, diffuse, mix, mode, variation, temperature, emittance):
    """Largest size of the gas error (C, T) over the emittances and the signs of what is not known."""
    nominal, cold, hot = np.split(signal.gas[..., : bench.scored], len(STATES), axis=-1)
    back = (1 - mix) * nominal + mix * diffuse
    if mode == AS_READ:
        left = [(nominal, back)]
    elif mode == SUBTRACTED:
        left = [(sign * variation * nominal, sign * variation * back) for sign in (1, -1)]
    else:
        left = [(other - nominal, (1 - mix) * other + mix * diffuse) for other in (cold, hot)]
    sizes = [
        np.abs(bench.gas_error(signal, weights, temperature, emittance, gas=gas, reflected=light))[0]
        for gas, light in left
    ]
    return np.max(np.nan_to_num(sizes, nan=np.inf), axis=(0, 2))


def as_markdown(result, condition):
    """The page of one condition of a result of `trust`; ValueError for an unknown condition."""
    known = [str(name) for name in result.condition.values]
    if condition not in known:
        raise ValueError(f"condition must be one of {', '.join(known)}; got {condition!r}")
    case = result.sel(condition=condition)
    low, high = result.attrs["emittance_range"]
    lines = [
        f"# When can I trust it? {condition}",
        "",
        f"{float(case.numerical_power) / 1e3:g} kW in the plasma, emittance {low:g} to {high:g}, heating"
        f" {result.attrs['heating']} (critically damped). Temperatures from which the gas shifts the reading"
        " by less than the level, for the worst emittance; in brackets the time after injection."
        " Modelled, not measured.",
        "",
    ]
    for surface in case.surface.values:
        lines += [
            f"## {str(surface).capitalize()} sample",
            "",
            "| instrument | "
            + " | ".join(f"{100 * level:g} %" for level in case.trust_level.values)
            + " | own (1 s.d.) |",
            "|---|" + "---|" * (case.sizes["trust_level"] + 1),
        ]
        lines += [_row(case.sel(surface=surface, setup=setup)) for setup in case.setup.values]
        lines += ["", _advice(case.sel(surface=surface)), ""]
    return "\n".join(lines)


def _row(row):
    cells = [
        "not below 3000 K"
        if np.isnan(limit)
        else f"{limit:.0f} K ({'never' if np.isnan(time) else f'{time:.1f} s'})"
        for limit, time in zip(row.trust_temperature.values, row.trust_time.values, strict=True)
    ]
    return f"| {row.setup.item()} | " + " | ".join(cells) + f" | {100 * float(row.own_uncertainty):.1f} % |"


def _advice(case):
    """Which second measurement lowers the one-level temperature most."""
    first = case.isel(trust_level=0).trust_temperature
    others = first.isel(setup=slice(1, None)).dropna("setup")
    best = others.isel(setup=int(np.argmin(others.values)))
    gained = float(first.isel(setup=0)) - float(best)
    much = f"{gained:.0f} K lower" if np.isfinite(gained) else "where the instrument alone never gets there"
    return f"**What helps most:** {best.setup.item()}: {float(best):.0f} K, {much}."
