"""Writes the tables of docs/file-formats.md from the contracts that every file is checked against."""

from pathlib import Path

from plasmapyro.contracts import DATASETS, VARIABLES
from plasmapyro.tables import rows

PAGE = Path(__file__).resolve().parents[1] / "docs" / "file-formats.md"
MARK = "<!-- from here on written by workflow/formats.py -->\n"
# Contract -> where a run leaves it; "" for files that only commands write or read.
FILES = {row["contract"]: row["file"] for row in rows("contracts/files.csv")}


def describe(contract):
    """One section: the variables of a contract, by the dimensions they stand on."""
    groups = {}
    for key, dims in DATASETS[contract].items():
        name = key.rstrip("?")
        units = VARIABLES[name].units or "text"
        groups.setdefault(dims, []).append(
            f"`{name}` {units}" + (", optional" if key.endswith("?") and contract != "correction" else "")
        )
    where = f": `{FILES[contract]}`" if FILES[contract] else ""
    lines = [f"**{contract}**{where}", ""]
    lines += [f"- {', '.join(dims) or 'single values'}: {'; '.join(found)}" for dims, found in groups.items()]
    return "\n".join(lines) + "\n"


def tables():
    """All sections, in the order of the chain."""
    return "\n".join(describe(contract) for contract in FILES if contract in DATASETS)


if __name__ == "__main__":
    text = PAGE.read_text(encoding="utf-8").partition(MARK)[0]
    PAGE.write_text(f"{text}{MARK}\n{tables()}", encoding="utf-8")
