"""What all pages share: one look of the HTML, one of the figures in it."""

import io
import re
from importlib.resources import files
from pathlib import Path

from markupsafe import Markup
from matplotlib import rc_context, rc_params_from_file

from plasmapyro.page import templates
from plasmapyro.plots.laid import Laid

SIZE = (4.0, 2.9)  # [inch]: 8 points are 9 pixels when a phone shows it 340 wide
SETTINGS = rc_params_from_file(Path(__file__).with_name("figures.mplstyle"), use_default_template=False)


def drawn(draw, name, size=SIZE, **options):
    """SVG text of a figure made by draw(axes); the same bytes for the same content, no fixed width."""
    with rc_context(SETTINGS | {"svg.hashsalt": name}):
        figure = Laid(figsize=size, layout="constrained")
        draw(figure.subplots(**options))
        buffer = io.StringIO()
        figure.savefig(
            buffer, format="svg", transparent=True, dpi=150, metadata={"Date": None, "Creator": None}
        )
    svg = buffer.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    for side in ("height", "width"):
        svg = re.sub(rf'(<svg[^>]*?) {side}="[^"]*"', r"\1", svg, count=1)
    return svg


def spoken(svg, alternative):
    """SVG text as markup, with words for those who do not see it."""
    return Markup(svg.replace("<svg", Markup('<svg role="img" aria-label="{}"').format(alternative), 1))


def rendered(template, **values):
    """HTML text of a page, with its style inside."""
    style = Markup(files("plasmapyro.page").joinpath("style.css").read_text(encoding="utf-8"))
    return templates("plasmapyro.page").get_template(template).render(style=style, **values).lstrip()
