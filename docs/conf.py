"""The documents as a site: `make site`, read from build/site/index.html without a network."""

import csv
import re
import shutil
import sys
import tomllib
from pathlib import Path

from docutils.nodes import SkipNode
from latex2mathml.converter import convert
from sphinx.addnodes import pending_xref

from plasmapyro.report.captions import describe

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PACKAGE = ROOT / "src/plasmapyro"
CHAPTERS = {  # parts of the package in the order of the chain
    "gas": "Composition and transport of the gas",
    "flow": "Torch and jet",
    "cfd": "Flows of other programs",
    "sightline": "Line of sight",
    "radiation": "Radiation",
    "instrument": "Instruments",
    "analysis": "What the gas does to a reading",
    "design": "Choice of bands",
    "readers": "Raw files",
    "quality": "Contradictions in data",
    "record": "Record of a test",
    "experiment": "The paper's correction",
    "estimate": "Joint estimate",
    "identification": "Lines of a spectrum",
    "diagnosis": "Diagnosis",
    "campaign": "A campaign of tests",
    "facility": "The real Plasmatron",
    "refraction": "Wavelengths in air and in vacuum",
}
NOTEBOOK = '\n\n<a href="tutorial.ipynb">This page as a notebook of Jupyter.</a>\n'

project, release = PROJECT["name"], PROJECT["version"]
html_title = f"{project} {release}"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["example"]
myst_heading_anchors = 3
html_theme = "furo"
html_show_copyright = html_copy_source = False
html_math_renderer = "mathml"
autodoc_default_options = {"members": True, "member-order": "bysource"}
napoleon_use_rtype = False
autodoc_typehints = "none"  # docstrings say types with units


def write_pages(app):
    """What is made from sources: a page of docstrings per part of the package, what a diagnosis can name, and
    the figures of a run."""
    place = Path(app.srcdir) / "reference"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    for part, title in CHAPTERS.items():
        lines = [f"# {title}", ""]
        for path in sorted([*PACKAGE.glob(f"{part}.py"), *PACKAGE.glob(f"{part}/**/*.py")]):
            if re.search(r"^(def|class) [^_]", path.read_text(encoding="utf-8"), re.MULTILINE):
                name = ".".join(path.relative_to(ROOT / "src").with_suffix("").parts)
                box = ["```{eval-rst}", f".. automodule:: {name}", "```"]
                lines += [f"## {name.partition('.')[2]}", "", *box, ""]
        (place / f"{part}.md").write_text("\n".join(lines), encoding="utf-8")
    (place / "effects.md").write_text("\n".join(effects()), encoding="utf-8")
    lines = ["# Figures of a run", "", "Empty until `make figures` has run here.", ""]
    for path in sorted((ROOT / "results/figures").glob("*.png")):
        shutil.copy(path, place)
        _, caption, words = describe(path.stem)
        lines += [f"![{words}]({path.name})", "", f"`{path.stem}`: {caption}", ""]
    if len(lines) > 4:
        del lines[2:4]
    (place / "figures_of_a_run.md").write_text("\n".join(lines), encoding="utf-8")


def effects():
    """Lines of the page of all effects of the catalogue, from the table that the package reads."""
    yield from ("# What a diagnosis can name", "", "As `diagnose --without` takes them.", "")
    yield from ("| id | cause | size | class | looks like | what would decide |", "|---|---|---|---|---|---|")
    with (PACKAGE / "diagnosis/effects/effects.csv").open(encoding="utf-8", newline="") as file:
        for one in csv.DictReader(file):
            alike = ", ".join(f"`{name}`" for name in one["alike"].split())
            size = f"{one['amplitude']} [{one['unit']}]"
            cells = f"`{one['id']}`", one["name"], size, one["class"], alike, one["measurement"]
            yield f"| {' | '.join(cells)} |"


def write_notebook(app, error):
    """The tutorial as a notebook beside its page."""
    sys.path.insert(0, str(ROOT / "workflow"))
    from notebook import notebook

    text = notebook(Path(app.srcdir) / "tutorial.md")
    (Path(app.outdir) / "tutorial.ipynb").write_text(text, encoding="utf-8")


def link_notebook(app, page, text):
    """Say on the page of the tutorial where its notebook is."""
    if page == "tutorial":
        text[0] += NOTEBOOK


def types_as_text(app, page):
    """Types are prose with units here: 'temperature' in one is not the attribute of some class."""
    for node in list(page.findall(pending_xref)):
        if node["refdomain"] == "py":
            node.replace_self(node.children)


def as_mathml(display):
    """Writes a formula as MathML, which browsers draw with fonts of their own."""

    def visit(translator, node):
        tag = "div" if display == "block" else "span"
        formula = convert(node.astext(), display=display)
        translator.body.append(f'<{tag} style="overflow-x: auto">{formula}</{tag}>')
        raise SkipNode

    return visit, None


def setup(app):
    app.connect("builder-inited", write_pages)
    app.connect("source-read", link_notebook)
    app.connect("doctree-read", types_as_text)
    app.connect("build-finished", write_notebook)
    app.add_html_math_renderer("mathml", as_mathml("inline"), as_mathml("block"))
