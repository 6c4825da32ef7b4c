"""The numbers of paper.md and where they come from: `python -m paper.numbers [--update]` in the root of the repository.

A number in the text is followed by `<!--key-->`. With `--update` the numbers are written into the paper, else the
program ends with an error that names those that differ. `tests/test_paper.py` compares them too.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAPER = ROOT / "paper" / "paper.md"
KEYED = re.compile(r"(\d[\d.,]*(?: to \d[\d.,]*)?)<!--(.+?)-->")
PEERS = {"heyoka": "heyoka.py", "dop853": "scipy DOP853", "diffrax": "diffrax", "numba": "numba RK4 by hand"}


def cells(page: str, marker: str) -> list[list[str]]:
    """The rows of the tables between two markers of a page."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    block = text.partition(f"<!-- {marker}: begin -->")[2].partition(f"<!-- {marker}: end -->")[0]
    return [[x.strip() for x in line.strip("|").split("|")] for line in block.splitlines() if line.startswith("|")]


def said(page: str, pattern: str) -> str:
    """The number that the text of a page has in a sentence or row, the same each time."""
    (found,) = set(re.findall(pattern, (ROOT / "docs" / page).read_text(encoding="utf-8"), re.MULTILINE))
    return str(found)


def numbers() -> dict[str, str]:
    """The numbers of the paper, by key."""
    atlas = json.loads((ROOT / "docs/_static/atlas.json").read_text(encoding="utf-8"))
    column = {name: i for i, name in enumerate(atlas["columns"])}
    verdicts = [row[column["full"]] for row in atlas["rows"]]
    values = {
        "atlas": f"{len(verdicts):,}",
        "families": str(len(atlas["counts"])),
        "full": f"{verdicts.count(True):,}",
        "not full": f"{verdicts.count(False):,}",
        "undecided": f"{verdicts.count(None):,}",
        "generic": f"{sum(row[column['range']] is True for row in atlas['rows']):,}",
        "problems": str(len(json.loads((ROOT / "docs/_static/integration.json").read_text())["problems"])),
    }
    rows = {row[0]: row for row in cells("performance.md", "integration")}
    for key, name in PEERS.items():
        values[f"{key} one"], values[f"{key} many"] = rows[name][1], rows[name][3]
    grid = cells("performance-exact.md", "grid")[2:]
    means = [float(row[1]) for row in grid]
    values |= {"questions": str(len(grid)), "gap least": f"{min(means):.1f}", "gap most": f"{max(means):.0f}"}
    theorems = cells("formal.md", "theorems")[2:]
    values["algebras"] = said("performance-exact.md", r"questions are asked of (\d+) algebras")
    values["problems many"] = said("performance.md", r"10,000 trajectories on \d+ of (\d+) problems")
    values["call"] = said("performance.md", r"^\| fixed step size;.*\| ([\d.]+ to [\d.]+) \|$")
    lines = sum(len(file.read_text().splitlines()) for file in (ROOT / "docs/formal/theories").glob("*.v"))
    return values | {"theorems": str(len(theorems)), "coq lines": f"{lines:,}"}


def main() -> None:
    """Compare the paper with its sources, or update it."""
    values, text = numbers(), PAPER.read_text(encoding="utf-8")
    if "--update" in sys.argv:
        PAPER.write_text(KEYED.sub(lambda m: f"{values[m[2]]}<!--{m[2]}-->", text), encoding="utf-8")
    elif stale := [f"{key}: {said}, not {values[key]}" for said, key in KEYED.findall(text) if said != values[key]]:
        sys.exit("\n".join(stale))


if __name__ == "__main__":
    main()
