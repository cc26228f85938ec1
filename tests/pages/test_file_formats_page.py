"""docs/file-formats.md says what the contracts say."""

import sys

from pages import ROOT

from plasmapyro.contracts import DATASETS

sys.path.insert(0, str(ROOT / "workflow"))
import formats  # noqa: E402


def test_the_tables_are_those_of_the_contracts():
    written = formats.PAGE.read_text(encoding="utf-8").partition(formats.MARK)[2]
    assert written.strip() == formats.tables().strip(), "run python workflow/formats.py"


def test_each_contract_has_its_place_and_each_place_a_rule():
    assert DATASETS.keys() <= formats.FILES.keys()
    rules = "".join(path.read_text() for path in (ROOT / "workflow/rules").glob("*.smk"))
    known = [path for contract, path in formats.FILES.items() if path and contract in DATASETS]
    rules = rules.replace("{own}", "")  # of the paper's conditions, or of one's own
    assert not [path for path in known if f'"{path}"' not in rules]
