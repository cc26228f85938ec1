"""The claims table: each number or statement of the paper beside what this chain gives."""

import numpy as np
import xarray as xr

from plasmapyro.claims.analysis import error_claims, radiance_claims, threshold_claims, visibility_claims
from plasmapyro.claims.claim import untestable_claims
from plasmapyro.claims.experiment import calibration_claims, correction_claims, spectrometer_claims
from plasmapyro.claims.flow import flow_claims
from plasmapyro.claims.premises import design_claims, gas_claims, reflection_claims


def claims_table(
    *,
    sightlines,
    radiances,
    surface,
    response,
    visibility,
    reading,
    errors,
    history,
    calibration,
    pyrometer,
    spectra,
    gas,
    variations=None,
    reflection=None,
    designs=None,
):
    """All claims as one table, contract 'claims', from Datasets of the contracts that the arguments name.

    `sightlines`, `radiances`: lists, of rising power. `variations`, `reflection` and `designs`
    ('band_design') may be None: their claims have no value then.
    """
    claims = [
        *reflection_claims(reflection),
        *flow_claims(sightlines),
        *gas_claims(sightlines, radiances, variations, response, gas),
        *radiance_claims(radiances, surface, response),
        *visibility_claims(visibility),
        *error_claims(reading, errors, history),
        *calibration_claims(calibration),
        *correction_claims(pyrometer),
        *spectrometer_claims(pyrometer, spectra),
        *threshold_claims(reading),
        *design_claims(designs),
        *untestable_claims(),
    ]
    words = {
        name: ("claim", [getattr(claim, name) for claim in claims])
        for name in ("section", "statement", "unit", "printed", "verdict", "remark", "basis")
    }
    return xr.Dataset(
        {
            **words,
            "value": ("claim", [float(claim.value) for claim in claims]),
            "printed_low": ("claim", [float(claim.low) for claim in claims]),
            "printed_high": ("claim", [float(claim.high) for claim in claims]),
        },
        {"claim": [claim.key for claim in claims]},
    )


def as_markdown(table):
    """The claims table as Markdown text, with a count of the verdicts on top."""
    verdicts = table.verdict.values.astype(str)
    synthetic = table.basis.values.astype(str) == "synthetic"

    def count(word, rows):
        return int((np.char.startswith(verdicts, word) & rows).sum())

    summary = (
        f"{len(verdicts)} claims. From the simulation: {count('reproduced', ~synthetic)} reproduced, "
        f"{count('differs', ~synthetic)} differ, {count('no value', ~synthetic)} without a value here, "
        f"{count('not testable', ~synthetic)} not testable here. On synthetic data: "
        f"{count('reproduced', synthetic)} reproduced, {count('differs', synthetic)} differ, "
        f"{count('no value', synthetic)} without a value."
    )
    lines = [
        "# What the paper says, and what this chain gives",
        "",
        summary,
        "",
        "No constant was tuned to hit a printed number. Words such as 'about' are read as the range shown."
        " 'Synthetic data' marks claims on the measured test, of which only a synthetic twin is public here.",
        "",
        "| sec. | the paper says | printed | here | verdict | how, and why |",
        "|---|---|---|---|---|---|",
    ]
    for place in range(len(verdicts)):
        row = table.isel(claim=place)
        value, unit = float(row.value), str(row.unit.values)
        here = "–" if np.isnan(value) else f"{value:.4g} {unit}".removesuffix(" 1")
        printed = str(row.printed.values).removesuffix(" 1")
        cells = [str(row[name].values) for name in ("section", "statement")]
        cells += [printed, here, str(row.verdict.values), str(row.remark.values)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"
