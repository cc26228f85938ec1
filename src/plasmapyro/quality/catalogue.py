"""The rules, in the order in which they are said."""

from plasmapyro.quality import agreement, clocks, instrument, pyrometer, sightline, spectra
from plasmapyro.quality.rule import rules_of

OF_TEST = rules_of(agreement, pyrometer, spectra, clocks)
OF_CALIBRATION = rules_of(instrument)
OF_SIGHTLINE = rules_of(sightline)


def table(rules):
    """A Markdown table of rules."""
    rows = [f"| `{r.name}` | {r.looks_at} | {r.limit:g} {r.unit} | {r.reason} |" for r in rules]
    return "\n".join(["| rule | looks at | limit | because |", "|---|---|---|---|", *rows]).replace(
        " 1 |", " |"
    )
