"""The report: everything a run found, on one page that needs nothing but itself."""

import json
import re

import numpy as np

from plasmapyro.page import templates
from plasmapyro.record.status import EXTRAPOLATED, VALID
from plasmapyro.report.captions import describe
from plasmapyro.versions import versions

CHAPTERS = ["Test", "Diagnosis", "Errors", "Gas radiance", "Flow", "Instrument", "Design"]


def compose(
    figures, claims, corrections, findings=(), diagnoses=(), timings=(), configuration=None, without=()
):
    """The whole report as HTML text.

    `figures`: (name without suffix, PNG); `claims`: contract 'claims', or None with another instrument than
    the paper's; `corrections`: (test, Dataset of contract 'temperature', 'pyrometer_correction',
    'spectrometer_correction' or 'joint_estimate'); `findings`: what contradicts itself in the tests, as in
    their `findings.json`; `diagnoses`: (test, its page); `timings`: (job, row that `cost` noted: `s` [s],
    `max_rss` [MB], `cpu_time` [s]); `configuration` is shown as it is; `without`: tests that the run left
    out. KeyError if a figure has no words (see `captions`).
    """
    described = sorted(((name, *describe(name), picture) for name, picture in figures), key=_natural)
    attributes = {} if claims is None else claims.attrs
    made_by = {"plasmapyro": attributes["plasmapyro_version"]} if "plasmapyro_version" in attributes else {}
    known = [(chapter, [rest for rest in described if rest[1] == chapter]) for chapter in CHAPTERS]
    return (
        templates("plasmapyro.report")
        .get_template("template.html")
        .render(
            chapters=[(chapter, shown) for chapter, shown in known if shown],
            claims=[] if claims is None else list(_claim_rows(claims)),
            counts={} if claims is None else _verdicts(claims),
            without=without,
            tests=[_summary(name, corrected) for name, corrected in corrections],
            findings=sorted(findings, key=lambda one: one["severity"]),
            diagnoses=diagnoses,
            timings=_times(timings),
            versions=dict(versions()) | made_by,
            configuration=json.dumps(configuration or {}, indent=1, default=str),
            sources=attributes.get("sources", "").splitlines(),
        )
    )


def _natural(figure):
    """Sorts fig9a before fig10a."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", figure[0])]


def _claim_rows(claims):
    for place in range(claims.sizes["claim"]):
        row = claims.isel(claim=place)
        words = {
            name: str(row[name].values) for name in ("section", "statement", "printed", "verdict", "remark")
        }
        value = float(row.value)
        words["here"] = "–" if np.isnan(value) else f"{value:.4g} {row.unit.values}".removesuffix(" 1")
        words["kind"] = _kind(words["verdict"])
        words["synthetic"] = str(row.basis.values) == "synthetic"
        yield words


def _verdicts(claims):
    """Verdict -> (from the simulation, on synthetic data)."""
    first = [_kind(str(verdict)) for verdict in claims.verdict.values]
    synthetic = claims.basis.values.astype(str) == "synthetic"
    pairs = list(zip(first, synthetic, strict=True))
    return {word: (pairs.count((word, False)), pairs.count((word, True))) for word in sorted(set(first))}


def _kind(verdict):
    """A verdict without its numbers: 'reproduced', 'differs', 'no value here' or 'not testable here'."""
    return verdict.split()[0] if verdict.startswith(("reproduced", "differs")) else verdict


RESULTS_OF = {  # temperature that a file is looked through for -> name of the instrument, time and status
    "recommended_temperature": ("to take away", "time", "recommended_status"),
    "surface_temperature": ("joint estimate", "time", "estimate_status"),
    "corrected_temperature": ("pyrometer", "time", "corrected_status"),
    "scaled_temperature": ("spectrometer", "spectrum_time", "spectrum_status"),
}


def _summary(name, corrected):
    """What a reader wants to know first of a corrected test: the first valid value, and the readable ones."""
    quantity = next(one for one in RESULTS_OF if one in corrected)
    instrument, axis, status = RESULTS_OF[quantity]
    time = corrected[axis].values
    temperature = corrected[quantity].where(corrected[status].isin((VALID, EXTRAPOLATED))).values
    valid = np.isfinite(temperature) & (corrected[status].values == VALID)
    spread = corrected[f"{quantity}_uncertainty"].values
    end = corrected.attrs.get("plasma_off_time", time[-1])
    during = (time > corrected.attrs.get("injection_time", time[0])) & (time < end)
    there, valid = np.isfinite(temperature) & during, valid & during
    steady = there & (time > end - 0.1 * (end - time[there][0] if there.any() else 0.0))
    return {
        "name": name,
        "instrument": instrument,
        "origin": corrected.attrs.get("origin", ""),
        "condition": corrected.attrs.get("condition", "–"),
        "first": f"{time[valid][0]:.1f} s" if valid.any() else "–",
        "steady": f"{np.median(temperature[steady]):.0f} K" if steady.any() else "–",
        "spread": f"{np.nanmedian(spread[steady]):.0f} K" if steady.any() else "–",
        "highest": f"{temperature[there].max():.0f} K" if there.any() else "–",
    }


def _times(timings):
    """One row per rule: number of jobs, longest and total time, CPU time, largest memory."""
    rules = {}
    for name, row in timings:
        rules.setdefault(name, []).append(row)
    return [
        {
            "rule": name,
            "jobs": len(rows),
            "longest": f"{max(row['s'] for row in rows):.1f}",
            "total": f"{sum(row['s'] for row in rows):.1f}",
            "cpu": f"{sum(row['cpu_time'] for row in rows):.1f}",
            "memory": f"{max(row['max_rss'] for row in rows):.0f}",
        }
        for name, rows in sorted(rules.items(), key=lambda item: -sum(row["s"] for row in item[1]))
    ]
