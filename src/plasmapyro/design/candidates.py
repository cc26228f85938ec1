"""Candidates of a design: searched, from a grid, of filters that can be bought, on the shelf, without gas."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from plasmapyro.checks import increasing
from plasmapyro.design import budget, search
from plasmapyro.design.bench import REFERENCE_TEMPERATURE
from plasmapyro.design.judge import CHUNK, reference_name

FILTERS_KEPT = 8
WHOLE_RANGE, WHOLE_STEP = (600e-9, 2500e-9), 2e-9  # [m], where the search without gas looks


@dataclass(frozen=True)
class Entry:
    """A named design: its bands (N,) [m], its detector, how a bench finds its currents (None if none can)."""

    name: str
    kind: str
    detector: str
    shape: str
    centre: np.ndarray
    fwhm: np.ndarray
    score: float = np.nan
    build: Callable | None = None


def boxed(name, kind, detector, shape, centre, fwhm, score=np.nan):
    """The `Entry` of filters before a detector."""

    def build(bench):
        return bench.currents(detector, centre[None], fwhm[None], shape)

    return Entry(name, kind, detector, shape, centre, fwhm, score, build)


def reference(response, judge):
    """The instrument that the judge holds all against."""
    kind = "modelled" if "responsivity" not in response else "stated"
    name = f"{reference_name(response)}, {kind} response"
    none = np.zeros(0)
    return Entry(name, "reference", "silicon", "response", none, none, build=judge.build_reference)


def searched(bench, judge, settings):
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
                found.append(boxed(name, kind, detector, shape, centre, fwhm, value))
    return found


def _best_boxes(bench, detector, judge, settings):
    """Centre and fwhm (2,) [m] of the best pair of boxes on the coarse grid by kind of optimum; None if none
    fits."""
    centre, fwhm, chosen, signal = _boxes(bench, detector, settings["brute_force"])
    if not len(chosen):
        return {"optimum": None, "robust optimum": None}
    error = judge.error(signal)
    best = {"optimum": chosen[np.argmin(error)], "robust optimum": chosen[judge.best(signal, error)]}
    return {kind: (centre[pair], fwhm[pair]) for kind, pair in best.items()}


def brute_force(bench, judge, settings, optimum):
    """Best pair of boxes on a coarse grid for the detector of the optimum; all pairs of all detectors
    as a cloud."""
    cloud, entry = [], None
    for detector in settings["detectors"]:
        centre, fwhm, chosen, signal = _boxes(bench, detector, settings["brute_force"])
        if not len(chosen):
            continue
        scores = np.full(len(chosen), np.nan)
        if detector == optimum.detector:
            scores = judge(signal)
            best, name = chosen[np.argmin(scores)], f"brute force, {detector}, box"
            entry = boxed(name, "brute force", detector, "box", centre[best], fwhm[best], scores.min())
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


def _boxes(bench, detector, settings):
    """Centres and widths (B,) [m] of the boxes on the coarse grid that a detector sees wholly, all pairs of
    them (D, 2) as indices, and their currents (None without a pair)."""
    low, high = bench.usable_range(detector)
    step = settings["centre_step_nm"] * 1e-9
    middles = np.arange(np.ceil(low / step) * step, high, step)
    centre, fwhm = np.meshgrid(middles, np.array(settings["width_nm"]) * 1e-9, indexing="ij")
    return _pairs_of(bench, detector, centre.ravel(), fwhm.ravel())


def _pairs_of(bench, detector, centre, fwhm):
    """As `_boxes`, of boxes (B,) [m] of which those count that the detector sees wholly."""
    low, high = bench.usable_range(detector)
    inside = (centre - fwhm / 2 >= low) & (centre + fwhm / 2 <= high)
    centre, fwhm = centre[inside], fwhm[inside]
    if not len(chosen := search.pairs(centre)):
        return centre, fwhm, chosen, None
    return centre, fwhm, chosen, bench.currents(detector, centre[:, None], fwhm[:, None], "box").pick(chosen)


def _sensitivity_and_limit(bench, judge, signal):
    """Sensitivity (D,) of the ratio and mean over the conditions of the temperature limit (D,)."""
    weights = bench.weights(signal)
    slope = np.abs(budget.sensitivity(signal.black, weights, REFERENCE_TEMPERATURE))
    nominal = signal.gas[..., : judge.cases]
    return slope, judge.limits(signal, weights, judge.coarse, gas=nominal)[:, 0].mean(axis=1)


def from_filters(bench, judge, filters, settings):
    """The best pairs of filters that can be bought, no two with the same centres."""
    ranked = []
    for detector in settings["detectors"]:
        centre, fwhm, chosen, signal = _pairs_of(bench, detector, filters["centre"], filters["fwhm"])
        if not len(chosen):
            continue
        scores = judge.error(signal)
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
        kept.append(boxed(f"filters {text} nm, {detector}", "filters", detector, "box", centre, fwhm, value))
    return kept


def on_the_shelf(bench, pyrometers):
    """Instruments by their published bands; those that reach beyond the radiation data have no currents."""
    found = []
    for row, name in enumerate(pyrometers["instrument"]):
        edges = np.array([[pyrometers[f"{end}_{band}"][row] for end in ("first", "last")] for band in (1, 2)])
        edges = edges[np.isfinite(edges[:, 0])]
        centre, fwhm = edges.mean(axis=1), np.diff(edges, axis=1)[:, 0]
        if edges.min() < bench.edges[0] or edges.max() > bench.edges[-1]:
            found.append(Entry(name, "beyond the data", "", "box", centre, fwhm))
        else:
            reach = bench.detectors["cut_off"] >= edges.max()  # the table begins with the shortest
            detector = str(bench.detectors["detector"][np.argmax(reach)])
            found.append(boxed(name, "shelf", detector, "box", centre, fwhm))
    return found


def without_gas(bench, settings):
    """One- and two-band optimum of each detector without gas, where no radiation data are needed."""
    edges = np.arange(WHOLE_RANGE[0], WHOLE_RANGE[1] + WHOLE_STEP / 2, WHOLE_STEP)
    temperature = increasing("no_gas_temperature_k", settings["no_gas_temperature_k"], "K")
    none = np.zeros((1, edges.size - 1))
    dark = replace(bench, edges=edges, gas=none, scored=1, temperature=temperature)
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
            found.append(Entry(name, "no gas", detector, "box", centre, fwhm, value))
    return found
