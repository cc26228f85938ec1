"""Writes the tables of docs/file-formats.md from the contracts that every file is checked against."""

from pathlib import Path

from plasmapyro.contracts import DATASETS, VARIABLES
from plasmapyro.contracts.datasets import AS_IN
from plasmapyro.tables import rows

PAGE = Path(__file__).resolve().parents[1] / "docs" / "file-formats.md"
MARK = "<!-- from here on written by workflow/formats.py -->\n"
REGISTER = rows("contracts/datasets.csv")
# Contract -> where a run leaves it; "" for files that only commands write or read.
FILES = {row["contract"]: row["file"] for row in rows("contracts/files.csv")}


def describe(contract):
    """One section: the variables of a contract, by the dimensions they stand on."""
    where = f": `{FILES[contract]}`" if FILES[contract] else ""
    lines = [f"**{contract}**{where}", ""]
    for row in (row for row in REGISTER if row["contract"] == contract):
        names, dims = row["variables"].split(), row["dimensions"].replace(" ", ", ")
        if row["dimensions"] == AS_IN:
            lines.append(f"- as in {', '.join(f'**{name}**' for name in names)}, each optional")
        else:
            lines.append(f"- {dims or 'single values'}: {'; '.join(map(_told, names))}")
    return "\n".join(lines) + "\n"


def _told(key):
    name = key.rstrip("?")
    return f"`{name}` {VARIABLES[name].units or 'text'}" + (", optional" if key != name else "")


def tables():
    """All sections, in the order of the chain."""
    return "\n".join(describe(contract) for contract in FILES if contract in DATASETS)


if __name__ == "__main__":
    text = PAGE.read_text(encoding="utf-8").partition(MARK)[0]
    PAGE.write_text(f"{text}{MARK}\n{tables()}", encoding="utf-8")
