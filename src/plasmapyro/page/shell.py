"""What all pages share: one look of the HTML, one of the figures in it."""

import io
import re
from importlib.resources import files

import jinja2
from markupsafe import Markup
from matplotlib import rc_context
from matplotlib.figure import Figure

SIZE = (4.0, 2.9)  # [inch]: 8 points are 9 pixels when a phone shows it 340 wide
SETTINGS = {
    "font.size": 10,
    "font.family": "sans-serif",
    "legend.fontsize": 8,
    "legend.framealpha": 0.75,
    "legend.edgecolor": "none",
    "legend.markerscale": 1.8,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "grid.linewidth": 0.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.4,
    "svg.fonttype": "none",
    "mathtext.default": "regular",
    "axes.unicode_minus": True,
}


def drawn(draw, name, size=SIZE, **options):
    """SVG text of a figure made by draw(axes); the same bytes for the same content, no fixed width."""
    with rc_context(SETTINGS | {"svg.hashsalt": name}):
        figure = Figure(figsize=size, layout="constrained")
        draw(figure.subplots(**options))
        buffer = io.StringIO()
        figure.savefig(
            buffer, format="svg", transparent=True, dpi=150, metadata={"Date": None, "Creator": None}
        )
    svg = buffer.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    return re.sub(
        r'(<svg[^>]*?) width="[^"]*"',
        r"\1",
        re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", svg, count=1),
        count=1,
    )


def spoken(svg, alternative):
    """SVG text as markup, with words for those who do not see it."""
    return Markup(svg.replace("<svg", Markup('<svg role="img" aria-label="{}"').format(alternative), 1))


def rendered(template, **values):
    """HTML text of a page, with its style inside."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("plasmapyro.page", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    style = Markup(files("plasmapyro.page").joinpath("style.css").read_text(encoding="utf-8"))
    return environment.get_template(template).render(style=style, **values).lstrip()
