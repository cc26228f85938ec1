"""From the files of a diagnosis to its page."""

from plasmapyro.page import figures, recommended, tables
from plasmapyro.page.shell import rendered, spoken
from plasmapyro.page.words import for_figures, without_folders

FORMAT = "plasmapyro-diagnosis-1"
STATUS = {  # status: (words, colour of the verdict's edge)
    "null": ("the model explains the data", "fine"),
    "named": ("{causes} named", "finding"),
    "one-of": ("one of several causes", "finding"),
    "named+unknown": ("{causes} named, and something else may be wrong", "open"),
    "unknown": ("something is wrong that no known cause explains", "open"),
    "not-adequate": ("no judgement: the base model does not follow the data", "open"),
}


def write_page(diagnosis, residual_map, temperature, truth=None):
    """The page of a diagnosis: one HTML text that needs nothing else, verdict first.

    `diagnosis` as in diagnosis.json (ValueError for another format), `residual_map` and `temperature`
    ('diagnosis_temperature') beside it; `truth`, of a synthetic test: attribute `hidden`, and
    `surface_temperature` over `time`. Style and figures (SVG) are inside; text of the user is escaped,
    folders of the machine are cut off; the same inputs give the same text.
    """
    schema = diagnosis.get("schema")
    if schema != FORMAT:
        raise ValueError(f"diagnosis: schema must be {FORMAT!r}; got {schema!r}; diagnose again")
    report = without_folders(diagnosis)
    plain = for_figures(report)

    def draw(name, alternative, data=None):
        """SVG text of a figure, with words for those who do not see it."""
        svg = getattr(figures, name)(plain) if data is None else getattr(figures, name)(plain, data)
        return spoken(svg, alternative)

    status, edge = STATUS.get(report["verdict"]["status"], (report["verdict"]["status"], "open"))
    status, edge = recommended.headline(status, edge, report["findings"], temperature.attrs["recommended"])
    count, sentences = len(report["verdict"]["named"]), report["verdict"]["sentences"]
    return rendered(
        "diagnosis.html",
        title=report["dataset"]["title"],
        origin=report["dataset"]["origin"],
        version=report["provenance"]["version"],
        report=report,
        residual_map=residual_map,
        temperature=temperature,
        recommended=recommended,
        because=without_folders(temperature.attrs.get("recommended_because", "")),
        reasons=sentences[1:],
        truth=truth,
        tables=tables,
        draw=draw,
        status=status.format(causes=f"{count} causes are" if count > 1 else "a cause is"),
        edge=edge,
    )
