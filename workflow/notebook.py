"""Runs the boxes of a page: `python workflow/notebook.py docs/tutorial.md` renews its answers and pictures.

Boxes of Python share one namespace, as in a notebook. What one prints stands in a box of text behind it;
what it draws is the picture linked next.
"""

import argparse
import base64
import contextlib
import io
import os
import re
from pathlib import Path

import nbformat

BOX = re.compile(r"```python\n(.*?)```\n(?:\n```text\n(.*?)```\n)?(?:\n!\[[^\]]*\]\(([^)]+)\)\n)?", re.DOTALL)
DPI = 100


def run(page, pictures):
    """What each box prints, as (text on the page, text printed); draws into the folder `pictures`."""
    os.environ.setdefault("MPLBACKEND", "Agg")
    import matplotlib
    from matplotlib import pyplot

    namespace, answers = {}, []
    pyplot.close("all")
    with matplotlib.rc_context():  # pictures as a new session draws them
        matplotlib.rcdefaults()
        for code, text, picture in BOX.findall(page.read_text(encoding="utf-8")):
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                exec(compile(code, page.name, "exec"), namespace)
            answers.append((text, printed.getvalue()))
            if picture:
                pyplot.gcf().savefig(pictures / Path(picture).name, dpi=DPI)
                pyplot.close("all")
    return answers


def notebook(page):
    """The page with its answers and pictures as a notebook of Jupyter."""
    make, text, cells, end = nbformat.v4, page.read_text(encoding="utf-8"), [], 0
    for box in BOX.finditer(text):
        code, printed, picture = box.groups()
        outputs = [make.new_output("stream", text=printed)] if printed else []
        if picture:
            image = base64.b64encode((page.parent / picture).read_bytes()).decode()
            outputs.append(make.new_output("display_data", {"image/png": image}))
        cells.append(make.new_markdown_cell(text[end : box.start()].strip()))
        cells.append(make.new_code_cell(code.strip(), outputs=outputs))
        end = box.end()
    cells.append(make.new_markdown_cell(text[end:].strip()))
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"  # a random one by default
    return nbformat.writes(make.new_notebook(cells=cells))


def main():
    """Write the answers into the page and the pictures beside it."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("page", type=Path)
    page = options.parse_args().page
    answers = iter(run(page, page.parent / "figures"))

    def answered(box):
        code, _, picture = box.groups()
        printed = next(answers)[1]
        text = f"```python\n{code}```\n" + (f"\n```text\n{printed}```\n" if printed else "")
        return text + (box[0][box[0].rindex("\n![") :] if picture else "")

    page.write_text(BOX.sub(answered, page.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
