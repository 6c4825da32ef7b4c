"""docs/atlas.md: the data of its table is that of the library, its counts are those of the data, its script works."""

import json
import random
import re
from collections import Counter
from functools import cache
from pathlib import Path

import pytest

import liehom as lh
from liehom.studies.atlas.sweeps import COLUMNS, COUNTS, MISSING, table_row
from tests import sampling
from tests.browser import dom, needs_browser
from tests.sampling import examples

DOCS = Path(__file__).resolve().parents[3] / "docs"
PAGE = (DOCS / "atlas.md").read_text(encoding="utf-8")
FILE = DOCS / "_static" / "atlas.json"
DATA = json.loads(FILE.read_text(encoding="utf-8"))
ROWS = [dict(zip(COLUMNS, cells, strict=True)) for cells in DATA["rows"]]


@cache
def entries() -> dict[tuple[str, str], lh.atlas.Entry]:
    return {(entry.family, entry.name): entry for entry in lh.atlas.read_entries(DOCS / "_static" / "atlas.jsonl")}


def test_the_file_is_small_and_has_the_columns() -> None:
    assert FILE.stat().st_size < 1_000_000 and DATA["columns"] == list(COLUMNS)


@pytest.mark.parametrize("family", lh.atlas.FAMILIES)
def test_the_file_has_all_pairs_once_and_a_sample_is_computed_again(family: str) -> None:
    recipes = list(lh.atlas.recipes([family]))
    assert {recipe.family for recipe in recipes} == {family}
    stored = {row["pair"]: row for row in ROWS if row["family"] == family}
    assert list(stored) == [recipe.name for recipe in recipes]
    largest = 30 if sampling.whole else 15
    small = [recipe for recipe in recipes if stored[recipe.name]["dim g"] <= largest]
    sample = random.Random(family).sample(small, min(examples(6), len(small)))
    for number, entry in lh.atlas.iter_sweep(sample, facts=True):
        assert dict(zip(COLUMNS, table_row(entry), strict=True)) == stored[entry.name]
        assert entries()[family, entry.name].verify(sample[number].pair())


def test_the_rows_are_those_of_the_entries_with_certificates() -> None:
    assert lh.atlas.table(entries().values()) == DATA and all(entry.verified for entry in entries().values())
    assert (DOCS / "_static" / "atlas.jsonl").stat().st_size < 5_000_000


def test_counts_of_the_page_are_those_of_its_rows() -> None:
    by_family = {family: [row for row in ROWS if row["family"] == family] for family in lh.atlas.FAMILIES}
    assert list(DATA["counts"]) == list(by_family)
    for family, rows in by_family.items():
        full = Counter(row["full"] for row in rows)
        counted = dict(zip(COUNTS, (len(rows), full[True], full[False], full[None]), strict=False))
        counted |= {letter: sum(row["letter"] == letter for row in rows) for letter in "ABC"}
        counted["range holds"] = sum(row["range"] is True for row in rows)
        counted["facts missing"] = sum(MISSING in row.values() for row in rows)
        assert {key: DATA["counts"][family][key] for key in COUNTS} == counted
        cells = re.search(rf"^\| {family} \| (.*) \|$", PAGE, flags=re.MULTILINE)
        assert cells is not None
        assert [int(n) for n in cells[1].split(" | ")[:-1]] == [counted[key] for key in COUNTS]


def test_every_pair_is_decided_and_every_full_one_has_a_row() -> None:
    for row in ROWS:
        assert row["full"] in (True, False) and (row["letter"] in ("A", "B", "C")) is row["full"]
        if row["full"]:
            assert row["range"] is True and row["orbit"] == row["dim g/h"]
            assert row["open orbits"] == (2 if row["dim g/h"] == 1 else 1)


def test_the_proposition_on_symmetric_pairs_holds_in_the_table() -> None:
    rows = [row for row in ROWS if row["rank"] is not None and row["family"] in ("symmetric", "group")]
    ranks = Counter(row["rank"] for row in rows)
    for row in rows:
        assert row["orbit"] == row["dim g/h"] - row["rank"] + 1 and row["range"] is (row["rank"] == 1)
        if row["rank"] == 1:
            assert row["degree"] == 2 and (row["open orbits"] == 1) is row["full"]
    for rank, count in ranks.items():
        holds = count if rank == 1 else 0
        assert f"| {rank} | {count} | {holds} | {count - holds} |" in PAGE


@pytest.mark.slow
@needs_browser
def test_the_script_searches_filters_and_sorts(tmp_path: Path) -> None:
    """The script in a page of its own, with a second script that uses the controls and prints what is shown."""
    uses = """
    const rows = () => [...document.querySelectorAll(".atlas-box tbody tr")].map((tr) => tr.cells[0].textContent);
    const [family, full] = document.querySelectorAll("select");
    const choose = (select, value) => { select.value = value; select.dispatchEvent(new Event("change")); };
    const box = document.querySelector("input");
    const search = (text) => { box.value = text; box.dispatchEvent(new Event("input")); };
    const out = {};
    out.first = rows().length;
    choose(family, "symmetric"); choose(full, "yes"); out.full = rows();
    search("so(3) S^2"); out.found = rows();
    search(""); document.querySelectorAll("th button")[4].click(); out.sorted = rows();
    document.querySelectorAll("th button")[4].click(); out.reversed = rows();
    out.sort = document.querySelectorAll("th")[4].getAttribute("aria-sort");
    choose(family, ""); choose(full, ""); document.querySelector(".atlas-more").click(); out.all = rows().length;
    document.body.replaceChildren(JSON.stringify(out));
    """
    data = FILE.read_text(encoding="utf-8")
    head = f'<meta charset="utf-8"><script type="application/json" id="atlas-data">{data}</script>'
    script = (DOCS / "_static" / "atlas.js").read_text(encoding="utf-8")
    page = f'{head}<div id="atlas"></div><script>{script}</script><script>{uses}</script>'
    (tmp_path / "page.html").write_text(page, encoding="utf-8")
    shown = dom(tmp_path / "page.html")
    out = json.loads(re.search(r"<body>(.*)</body>", shown, flags=re.DOTALL)[1])  # type: ignore[index]
    assert out["first"] == 300 and out["all"] == len(ROWS)
    full = {row["pair"]: row["dim g/h"] for row in ROWS if row["family"] == "symmetric" and row["full"]}
    assert out["full"] == list(full) and "so(3)/so(2)" in out["found"] and set(out["found"]) <= set(full)
    assert [full[name] for name in out["sorted"]] == sorted(full.values())
    assert [full[name] for name in out["reversed"]] == sorted(full.values(), reverse=True)
    assert out["sort"] == "descending"
