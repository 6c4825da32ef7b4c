"""The tables of docs/reliability.md and docs/step-sizes.md, from the figures of campaigns and the limits of liehom.

    python -m tests.campaigns.report

rewrites the text between the markers ``<!-- begin NAME -->`` and ``<!-- end NAME -->`` of the pages. A campaign without
figures has no table.
"""

import dataclasses
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import liehom as lh
from tests.campaigns import certificates, checked_steps, doors

ROOT = Path(__file__).resolve().parent.parent.parent
FIGURES = Path(__file__).with_name("figures")
Json = Any


def figures(name: str) -> Json:
    file = FIGURES / f"{name}.json"
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else None


def table(header: list[str], rows: list[list[str]], numbers: bool = True) -> str:
    """A Markdown table; all columns but the first hold numbers."""
    line = "|---|" + ("---:|" if numbers else "---|") * (len(header) - 1)
    return "\n".join([f"| {' | '.join(header)} |", line, *(f"| {' | '.join(row)} |" for row in rows)])


def limits_table() -> str:
    """Every limit with its default and what it bounds, from the docstring."""
    text = re.sub(
        r"\n {8,}", " ", (lh.budget.Limits.__doc__ or "").partition("----------\n")[2].partition("Examples")[0]
    )
    meanings = dict(re.findall(r"^ *(\w+) : [^\n]*?(?:int|optional) ([A-Z][^\n]*)$", text, re.MULTILINE))
    defaults = dataclasses.asdict(lh.budget.Limits())
    rows = [
        [f"`{name}`", "none" if value is None else f"{value:,}", meanings[name].rstrip(".")]
        for name, value in defaults.items()
    ]
    return table(["limit", "default", "what it bounds"], rows, numbers=False)


def doors_table() -> str:
    data = figures("doors")
    if data is None:
        return ""
    columns = list(doors.OUTCOMES)
    mended = (
        f" {data['mended']} of these inputs raised another exception or took longer at first. The causes were mended, "
        "and the inputs ran again."
        if data.get("mended")
        else ""
    )
    names = ["read", "rejected", "`LimitError`", "`TypeError`", "anything else"]
    rows = [[row["class"], *(f"{row[key]:,}" for key in columns)] for row in data["rows"]]
    rows.append(["together", *(f"{sum(row[key] for row in data['rows']):,}" for key in columns)])
    return (
        f"{data['count']:,} inputs, seed {data['seed']} (`tests/campaigns/doors.py`). Every input has a deadline of "
        f"{doors.SECONDS:.0f} seconds and {doors.MEMORY >> 30} GiB of memory; none took more than "
        f"{data['slowest']:.0f} seconds of CPU time.{mended}\n\n" + table(["entry point", *names], rows)
    )


def damage_table() -> str:
    """One row for each file."""
    data = figures("damage")
    if data is None:
        return ""
    outcomes = ("noticed", "identical", "believed")
    found: dict[str, list[int]] = {}
    for row in data["rows"]:
        sums = found.setdefault(row["class"].split("; ")[0], [0, 0, 0])
        found[row["class"].split("; ")[0]] = [x + row[key] for x, key in zip(sums, outcomes, strict=True)]
    found["together"] = [sum(column) for column in zip(*found.values(), strict=True)]
    return (
        f"{data['count']:,} damages, seed {data['seed']} (`tests/campaigns/damage.py`): bytes appended, cut, flipped, "
        "replaced or zeroed, numbers edited, files exchanged.\n\n"
    ) + table(
        ["file", "noticed", "content as it was", "believed"],
        [[file, *(f"{x:,}" for x in counts)] for file, counts in found.items()],
    )


def certificates_table() -> str:
    data = figures("certificates")
    return "" if data is None else certificates.table(certificates.Campaign.from_json(data))


PAGES: dict[Path, dict[str, Callable[[], str]]] = {
    ROOT / "docs" / "reliability.md": {
        "limits": limits_table,
        "doors": doors_table,
        "certificates": certificates_table,
        "damage": damage_table,
    },
    ROOT / "docs" / "step-sizes.md": {"checked steps": checked_steps.page_table},
}


def rewritten(page: str, tables: dict[str, Callable[[], str]]) -> str:
    for name, made in tables.items():
        begin, end = f"<!-- begin {name} -->\n", f"<!-- end {name} -->"
        before, _, rest = page.partition(begin)
        _, found, after = rest.partition(end)
        if not found:
            raise ValueError(f"the page has no markers {begin.strip()} and {end}")
        page = f"{before}{begin}\n{made()}\n\n{end}{after}"
    return page


def main() -> None:
    for page, tables in PAGES.items():
        page.write_text(rewritten(page.read_text(encoding="utf-8"), tables), encoding="utf-8")


if __name__ == "__main__":
    main()
