"""Stages of the design: spectra of the gas in bins, and the pyrometers that it disturbs least."""

from dataclasses import replace

import numpy as np
import xarray as xr

from plasmapyro.analysis.error import error_limit
from plasmapyro.checks import increasing
from plasmapyro.design import budget, gains, search
from plasmapyro.design.bench import REFERENCE_TEMPERATURE, Bench
from plasmapyro.design.spectra import HOTTEST, AirSpectra, heated
from plasmapyro.gas.species import nitrogen_of
from plasmapyro.radiation.atoms import ATOMS
from plasmapyro.radiation.band_systems import SYSTEMS
from plasmapyro.radiation.bandsignal import bands_of, require_cover, responsivities
from plasmapyro.radiation.path import CONTINUA
from plasmapyro.sightline.stage import surface_view

STATES = ("nominal", "cold", "hot")
LARGEST_BANDS = 3
PAPERS = "MR1SB"  # the instrument of the paper
CHUNK = 400  # designs at a time: their errors fit into the cache's neighbourhood
LIMIT_STEP = 25.0  # [K] of the search's temperatures; 5 K of the table that is kept
FINE_STEP = 5.0
POWER_STEP = 10e3  # [W] of the perturbed power
FILTERS_KEPT = 8
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
WHOLE_RANGE, WHOLE_STEP = (600e-9, 2500e-9), 2e-9  # [m], where the search without gas looks


def gas_spectra(
    sightlines,
    flows,
    *,
    wavelength_range,
    grid_points,
    table_nodes,
    bin_width,
    temperature_change,
    thinning,
    mirror_angle,
    directions,
    core_angle,
    ray_points,
):
    """Binned spectra of every line of sight, as computed, colder and hotter, and of what hits the sample.

    Parameters
    ----------
    sightlines, flows : mappings condition -> Dataset, contracts 'sightline' and 'flow'
    wavelength_range, bin_width : [m]
    grid_points, table_nodes : int
    temperature_change : float [1]
        Of the colder and hotter state, 0.05 for 5 %.
    thinning : int
        Every how many path points of a sight line are used; ends are kept.
    mirror_angle, core_angle : float [rad]
    directions, ray_points : int, as in `sightline.stage.surface_view`

    Returns
    -------
    Dataset, contract 'gas_spectra', sorted by power

    Notes
    -----
    ASSUME: the mirrored ray is the line of sight (axisymmetric jet). Conditions of one chamber pressure share
    an emission table; the pressure of the table sets line widths only.
    """
    views = {
        name: surface_view(
            flow,
            mirror_angle=mirror_angle,
            directions_count=directions,
            core_angle=core_angle,
            points=ray_points,
        )
        for name, flow in flows.items()
    }
    factors = (1.0, 1 - temperature_change, 1 + temperature_change)
    hottest = max(
        *(float(case.temperature.max()) * factors[2] for case in sightlines.values()),
        *(float(view.ray_temperature.max()) for view in views.values()),
    )
    tables = {}
    own, incident = [], []
    for name, case in sightlines.items():
        # That of the chamber: at the stagnation point each power has its own, and would want its own table.
        pressure = float(flows[name].chamber_pressure)
        if pressure not in tables:
            tables[pressure] = AirSpectra(
                pressure,
                min(hottest, HOTTEST),
                wavelength_range=wavelength_range,
                grid_points=grid_points,
                nodes=table_nodes,
                bin_width=bin_width,
            )
        air = tables[pressure]
        points = np.unique(
            np.append(np.arange(0, case.sizes["path_distance"], thinning), case.sizes["path_distance"] - 1)
        )
        thin = case.isel(path_distance=points)
        states = [
            heated(thin.temperature.values, thin.pressure.values, factor, nitrogen_of(thin))
            if factor != 1
            else None
            for factor in factors
        ]
        states[0] = thin.temperature.values, thin.number_density.values
        own.append([air.radiance(thin.path_distance.values, *state) for state in states])
        incident.append([own[-1][0].sum(axis=0), _diffuse(air, views[name])])
    spectra = xr.Dataset(
        {
            "binned_radiance": (("condition", "state", "component", "wavelength"), own),
            "incident_binned": (("condition", "reflection", "wavelength"), incident),
            "wavelength_edge": ("edge", air.edges),
            "component_uncertainty": ("component", air.uncertainty),
            "numerical_power": ("condition", [float(flow.numerical_power) for flow in flows.values()]),
        },
        {
            "condition": list(sightlines),
            "state": list(STATES),
            "component": list(air.components),
            "reflection": ["specular", "diffuse"],
            "wavelength": (air.edges[1:] + air.edges[:-1]) / 2,
        },
        {"origin": "modelled", "temperature_change": float(temperature_change)},
    )
    return spectra.sortby(["numerical_power", "condition"])


def _diffuse(air, view):
    """Hemispherical mean (B,) of the light that comes down on the stagnation point."""
    mean = 0.0
    for number in np.flatnonzero(view.ray_weight.values > 0):
        ray = view.isel(ray=number)
        distance = ray.ray_distance.values[::-1]
        radiance = air.radiance(
            distance[0] - distance,
            ray.ray_temperature.values[::-1],
            ray.ray_number_density.values[:, ::-1],
            apart=False,
        )
        mean = mean + float(ray.ray_weight) * radiance
    return mean


def make_bench(spectra, tables, settings):
    """The bench of `band_design` in front of the gases of all conditions: as computed, colder, hotter, and
    with the strengths of lines of atoms, of bands of molecules and of continua weaker and stronger by their
    uncertainty.

    Parameters
    ----------
    spectra : Dataset, contract 'gas_spectra'
    tables : mapping with `detectors`, `silicon`, `air`, data tables
    settings : mapping, see the keys of `design` in the configuration

    Returns
    -------
    Bench
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


class _Judge:
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
        limit, status = self.bench.gas_limit(
            signal, weights, temperature, self.emittance, self.level, **changes
        )
        limit = np.where(status == -1, temperature[0], limit)[..., 0]
        return limit.reshape(len(limit), -1, self.cases)

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
        gained = gains.gain(self.coarse_reference, limit)
        changed = np.concatenate(
            [gained[:, 1:], gains.at_neighbours(self.power, gained[:, 0], POWER_STEP)], axis=1
        )
        ratio = gains.change(changed, gained[:, :1])
        return gains.excess(ratio, self.tolerance)


def band_design(spectra, response, tables, *, settings):
    """Search, confirm and rank pyrometers by the error that they make behind the gas.

    Parameters
    ----------
    spectra : Dataset, contract 'gas_spectra'
    response : Dataset, contract 'response', of the reference instrument
    tables : mapping with the tables `detectors`, `silicon`, `air`, `filters`, `pyrometers`
    settings : mapping, the keys of `design` in the configuration

    Returns
    -------
    Dataset, contract 'band_design'

    Notes
    -----
    What is minimised: the root mean square of the total error over conditions (each as computed, colder and
    hotter), temperatures and emittances. For a robust optimum, the excess of the change of its gain over the
    tolerance is added, in all gases of the bench and in that of 10 kW less and more. ASSUME: errors of
    different sources are independent.
    """
    bench = make_bench(spectra, tables, settings)
    judge = _Judge(bench, spectra.numerical_power.values, response, settings)
    name = (
        f"{reference_name(response)}, {'modelled' if 'responsivity' not in response else 'stated'} response"
    )
    found = [_Entry(name, "reference", "silicon", "response", build=judge.build_reference)]
    found += _searched(bench, judge, settings)
    optimum = min((entry for entry in found if entry.kind == "robust optimum"), key=lambda entry: entry.score)
    grid, candidates = _brute_force(bench, judge, settings, optimum)
    found.append(grid)
    found += _from_filters(bench, judge, tables["filters"], settings)
    found += _on_the_shelf(bench, tables["pyrometers"])
    found += _without_gas(bench, settings, tables)
    result = _tabulate(found, bench, judge, spectra, settings)
    result = result.assign(candidates)
    result.attrs |= {
        "origin": "modelled",
        "best_two_band": optimum.name,
        "lowest_two_band": min(
            (entry for entry in found if entry.kind == "optimum" and entry.centre.size == 2),
            key=lambda entry: entry.score,
        ).name,
        "error_level": float(judge.level),
        "limit_emittance": float(judge.emittance[0]),
    }
    return result


class _Entry:
    """A named design: its bands, its detector, and how a bench finds its currents (None if none can)."""

    def __init__(self, name, kind, detector, shape, *, centre=(), fwhm=(), build=None, score=np.nan):
        self.name, self.kind, self.detector, self.shape = name, kind, detector, shape
        self.centre, self.fwhm, self.build, self.score = np.asarray(centre), np.asarray(fwhm), build, score


def _entry(name, kind, detector, shape, centre, fwhm, score=np.nan):
    def build(bench):
        return bench.currents(detector, np.asarray(centre)[None], np.asarray(fwhm)[None], shape)

    return _Entry(name, kind, detector, shape, centre=centre, fwhm=fwhm, build=build, score=score)


def _searched(bench, judge, settings):
    """The optimum of every detector, number of bands and filter shape; of two bands also the robust one."""
    width = np.asarray(settings["width_nm"]) * 1e-9
    kinds = [(bands, "optimum", judge.error, settings["shapes"][:1]) for bands in settings["band_counts"]]
    kinds.append((2, "robust optimum", judge, settings["shapes"]))
    found = []
    for detector in settings["detectors"]:
        reach, starts = bench.usable_range(detector), _best_boxes(bench, detector, judge, settings)
        for bands, kind, value_of, shapes in kinds:
            for shape in shapes:
                centre, fwhm, value = search.optimise(
                    lambda c, f, d=detector, s=shape, v=value_of: v(bench.currents(d, c, f, s)),
                    bands,
                    reach,
                    width,
                    **settings["search"],
                    start=starts[kind] if bands == 2 else None,
                )
                name = f"{bands}-band {kind}, {detector}, {shape}"
                found.append(_entry(name, kind, detector, shape, centre, fwhm, value))
    return found


def _best_boxes(bench, detector, judge, settings):
    """Centre and fwhm (2,) [m] of the best pair of boxes on the coarse grid by kind of optimum; None if none
    fits."""
    centre, fwhm = _grid(bench.usable_range(detector), settings["brute_force"])
    chosen = search.pairs(centre)
    if not len(chosen):
        return {"optimum": None, "robust optimum": None}
    signal = bench.currents(detector, centre[:, None], fwhm[:, None], "box").pick(chosen)
    error = judge.error(signal)
    best = {"optimum": chosen[np.argmin(error)], "robust optimum": chosen[judge.best(signal, error)]}
    return {kind: (centre[pair], fwhm[pair]) for kind, pair in best.items()}


def _brute_force(bench, judge, settings, optimum):
    """Best pair of boxes on a coarse grid for the detector of the optimum; all pairs of all detectors
    as a cloud."""
    cloud, entry = [], None
    for detector in settings["detectors"]:
        centre, fwhm = _grid(bench.usable_range(detector), settings["brute_force"])
        chosen = search.pairs(centre)
        if not len(chosen):
            continue
        signal = bench.currents(detector, centre[:, None], fwhm[:, None], "box").pick(chosen)
        scores = np.full(len(chosen), np.nan)
        if detector == optimum.detector:
            scores = judge(signal)
            best, name = chosen[np.argmin(scores)], f"brute force, {detector}, box"
            entry = _entry(name, "brute force", detector, "box", centre[best], fwhm[best], scores.min())
        slope, limit = (
            np.concatenate(rows)
            for rows in zip(
                *(_sensitivity_and_limit(bench, judge, some) for some in signal.split(CHUNK)), strict=True
            )
        )
        cloud.append((slope, limit, scores, centre[chosen], fwhm[chosen]))
    slope, limit, scores, centre, fwhm = (np.concatenate(rows) for rows in zip(*cloud, strict=True))
    return entry, {
        "candidate_sensitivity": ("candidate", slope),
        "candidate_limit": ("candidate", limit),
        "candidate_score": ("candidate", scores),
        "candidate_on_front": ("candidate", search.pareto_front(slope, limit).astype("int8")),
        "candidate_centre": (("candidate", "pair"), centre),
        "candidate_width": (("candidate", "pair"), fwhm),
    }


def _grid(reach, settings):
    """Centres and widths of the boxes on the coarse grid that lie wholly within a range."""
    low, high = reach
    step = settings["centre_step_nm"] * 1e-9
    middles = np.arange(np.ceil(low / step) * step, high, step)
    centre, fwhm = np.meshgrid(middles, np.array(settings["width_nm"]) * 1e-9, indexing="ij")
    inside = (centre - fwhm / 2 >= low) & (centre + fwhm / 2 <= high)
    return centre[inside], fwhm[inside]


def _sensitivity_and_limit(bench, judge, signal):
    """Sensitivity (D,) of the ratio and mean over the conditions of the temperature limit (D,)."""
    weights = bench.weights(signal)
    slope = np.abs(budget.sensitivity(signal.black, weights, REFERENCE_TEMPERATURE))
    nominal = signal.gas[..., : judge.cases]
    return slope, judge.limits(signal, weights, judge.coarse, gas=nominal)[:, 0].mean(axis=1)


def _from_filters(bench, judge, filters, settings):
    """The best pairs of filters that can be bought, no two with the same centres."""
    ranked = []
    for detector in settings["detectors"]:
        low, high = bench.usable_range(detector)
        centre, fwhm = filters["centre"], filters["fwhm"]
        inside = (centre - fwhm / 2 >= low) & (centre + fwhm / 2 <= high)
        centre, fwhm = centre[inside], fwhm[inside]
        if np.unique(centre).size < 2:
            continue
        singles = bench.currents(detector, centre[:, None], fwhm[:, None], "box")
        chosen = search.pairs(centre)
        scores = judge.error(singles.pick(chosen))
        for place in np.argsort(scores, kind="stable")[: 20 * FILTERS_KEPT]:
            ranked.append((scores[place], detector, centre[chosen[place]], fwhm[chosen[place]]))
    ranked.sort(key=lambda row: row[0])
    kept, seen = [], set()
    for value, detector, centre, fwhm in ranked:
        key = (detector, *np.round(centre * 1e9))
        if key in seen or len(kept) == FILTERS_KEPT:
            continue
        seen.add(key)
        text = " + ".join(f"{c * 1e9:.0f}/{w * 1e9:.0f}" for c, w in zip(centre, fwhm, strict=True))
        kept.append(_entry(f"filters {text} nm, {detector}", "filters", detector, "box", centre, fwhm, value))
    return kept


def _on_the_shelf(bench, pyrometers):
    """Instruments by their published bands; those that reach beyond the radiation data have no currents."""
    found = []
    for row, name in enumerate(pyrometers["instrument"]):
        edges = np.array([[pyrometers[f"{end}_{band}"][row] for end in ("first", "last")] for band in (1, 2)])
        edges = edges[np.isfinite(edges[:, 0])]
        centre, fwhm = edges.mean(axis=1), np.diff(edges, axis=1)[:, 0]
        if edges.min() < bench.edges[0] or edges.max() > bench.edges[-1]:
            found.append(_Entry(name, "beyond the data", "", "box", centre=centre, fwhm=fwhm))
        else:
            reach = bench.detectors["cut_off"] >= edges.max()  # the table begins with the shortest
            detector = str(bench.detectors["detector"][np.argmax(reach)])
            found.append(_entry(name, "shelf", detector, "box", centre, fwhm))
    return found


def _without_gas(bench, settings, tables):
    """One- and two-band optimum of each detector without gas, where no radiation data are needed."""
    edges = np.arange(WHOLE_RANGE[0], WHOLE_RANGE[1] + WHOLE_STEP / 2, WHOLE_STEP)
    dark = Bench(
        edges,
        np.zeros((1, edges.size - 1)),
        1,
        increasing("no_gas_temperature_k", settings["no_gas_temperature_k"], "K"),
        bench.emittance,
        bench.receiver,
        bench.uncertainties,
        tables["detectors"],
        tables["silicon"],
        bench.silicon_thickness,
        tables["air"],
    )
    width = np.asarray(settings["width_nm"]) * 1e-9
    found = []
    for detector in settings["detectors"]:
        for bands in (1, 2):
            centre, fwhm, value = search.optimise(
                lambda c, f, d=detector: dark.score(dark.currents(d, c, f, "box")),
                bands,
                dark.usable_range(detector),
                width,
                **settings["search"],
            )
            name = f"{bands}-band optimum without gas, {detector}"
            found.append(_Entry(name, "no gas", detector, "box", centre=centre, fwhm=fwhm, score=value))
    return found


def _tabulate(found, bench, judge, spectra, settings):
    """All designs side by side: bands, errors by source, limits and gains in every condition and
    perturbation."""
    cases, perturbations = judge.cases, _perturbations(spectra)
    emittance = np.asarray(settings["map_emittance"], dtype=float)
    binned = (
        spectra.binned_radiance.sel(state="nominal").transpose("condition", "component", "wavelength").values
    )
    split = replace(bench, gas=binned.reshape(-1, binned.shape[-1]))
    reference = _perturbed_limits(judge, judge.build_reference, split, spectra, perturbations)
    axes = {
        "design": np.array([entry.name for entry in found], dtype=object),
        "error_source": list(budget.SOURCES),
        "perturbation": list(perturbations),
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
        gained = gains.gain(reference, limit)
        table["design_limit"][row], table["design_gain"][row] = limit[0], gained[0]
        table["gain_change"][row] = gains.change(gained, gained[:1])
        error = np.abs(bench.gas_error(signal, weights, judge.fine, emittance, gas=signal.gas[..., :cases]))
        level, status = error_limit(judge.fine, error, judge.level)
        table["map_limit"][row] = np.where(status == -1, judge.fine[0], level)[0]
    words = {
        f"design_{name}": ("design", np.array([getattr(entry, name) for entry in found], dtype=object))
        for name in ("kind", "detector", "shape")
    }
    numbers = {name: (("design", *dims), table[name]) for name, dims in TABLE.items()}
    power = {"numerical_power": ("condition", spectra.numerical_power.values)}
    return xr.Dataset(numbers | words | power, axes)


def _perturbations(spectra):
    """Names of the changed gases: temperature, power, and every component's strength up and down."""
    names = ["nominal", "cold", "hot", "10 kW less", "10 kW more"]
    return names + [f"{name} {sign}" for name in spectra.component.values for sign in ("weaker", "stronger")]


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
