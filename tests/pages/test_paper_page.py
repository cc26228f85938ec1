"""The page of the paper's equations: every name on it exists, and every function on it shows a number."""

import ast
import csv
import doctest
import re
from importlib import import_module

import pytest
from pages import ROOT

from plasmapyro import contracts

PAGE = (ROOT / "docs/paper.md").read_text(encoding="utf-8")
NUMBERED = range(1, 15)  # the paper's equations


def rows(head):
    """Cells of the rows of the table whose first column is `head`, each as the code spans it holds."""
    table = PAGE.split(f"\n| {head} |", 1)[1].split("\n\n", 1)[0].splitlines()[2:]
    return [[cell.strip() for cell in row.strip("| \n").split(" | ")] for row in table]


def spans(cell):
    return re.findall(r"`([^`]+)`", cell)


EQUATIONS = [[int(row[0]), *map(spans, (*row[2:], "", "")[:4])] for row in rows("eq.")]


def function(name):
    module, _, attribute = name.rpartition(".")
    return getattr(import_module(f"plasmapyro.{module}"), attribute)


def test_every_equation_has_its_row():
    assert [number for number, *_ in EQUATIONS] == list(NUMBERED)


@pytest.mark.parametrize("number, functions", [row[:2] for row in EQUATIONS])
def test_its_functions_cite_it_and_show_a_number_that_is_right(number, functions):
    assert functions
    for name in functions:
        text = function(name).__doc__
        cited = [range(int(a), int(b or a) + 1) for a, b in re.findall(r"eqs?\. (\d+)(?: to (\d+))?", text)]
        cited += [range(int(b), int(b) + 1) for b in re.findall(r"eqs\. \d+ and (\d+)", text)]
        assert any(number in one for one in cited), f"{name} does not cite eq. {number}"
        found = doctest.DocTestFinder(recurse=False).find(
            function(name), name, globs=vars(import_module(function(name).__module__)).copy()
        )
        assert found[0].examples, f"{name} shows no number"
        assert doctest.DocTestRunner().run(found[0]).failed == 0


@pytest.mark.parametrize("name", sorted({test for row in EQUATIONS for test in row[2]}))
def test_its_tests_exist(name):
    path, test = name.split("::")
    tree = ast.parse((ROOT / "tests" / path).read_text(encoding="utf-8"))
    assert test in [node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]


def test_its_figures_are_drawn_by_a_rule():
    drawn = re.findall(r'"([\w{}]+)"', (ROOT / "workflow/rules/figures.smk").read_text(encoding="utf-8"))
    assert not {figure for row in EQUATIONS for figure in row[3]} - set(drawn)


def test_its_claims_are_made():
    with open(ROOT / "tests/reference/claims_full.csv", encoding="utf-8") as table:
        made = {row["claim"] for row in csv.DictReader(table)}
    assert not {claim for row in EQUATIONS for claim in row[4]} - made


def test_what_has_no_number_exists_too():
    text = PAGE.split("Without a number there", 1)[1].split("\n\n", 1)[0]
    assert all(callable(function(name)) for name in spans(text))


@pytest.mark.parametrize("cells", rows("symbol"), ids=lambda cells: cells[0])
def test_its_symbols_are_variables_of_the_results_with_that_unit(cells):
    for name in spans(cells[1]):
        if name != "emittance":  # an attribute
            assert contracts.VARIABLES[name].units == cells[2]
