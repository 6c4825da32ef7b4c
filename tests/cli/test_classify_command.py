"""`liehom classify` and `liehom full-pairs`: exit codes, one JSON object with --json, lines without it."""

import pytest

import liehom as lh
from liehom.exact.fullness.classification import Classification
from liehom.exact.fullness.classification_rows import rows
from tests.cli.test_cli import FLOAT, FULL, NOT_FULL, json_of, liehom


def test_classify_names_the_row_of_a_file() -> None:
    result = liehom("classify", FULL)
    assert result.exit_code == 0
    assert result.stdout.startswith("so(4)/so(3): S^3 = SO(4)/SO(3)\n")
    assert "C, d = 3, s = 3, e = 1, centre 0, compact" in result.stdout


def test_classify_shows_the_ideal() -> None:
    result = liehom("classify", "so(4)/u(2)")
    assert "up to an ideal of dimension 3 inside h" in result.stdout
    assert result.stdout.count("(") >= 3


@pytest.mark.parametrize("name", ["so(4)/u(2)", "affine(su(3)+spiral(sqrt(2),1))", "0/0"])
def test_classify_json_holds_the_classification(name: str) -> None:
    data = json_of(liehom("classify", name, "--json"))
    assert data["full"] is True
    assert Classification.from_json(data["classification"]) == lh.classify(lh.pair(name))


@pytest.mark.parametrize(("file", "code", "says"), [(NOT_FULL, 1, "not full: "), (FLOAT, 3, "numerical")])
def test_classify_of_a_pair_without_a_row_gives_the_verdict(file: str, code: int, says: str) -> None:
    result = liehom("classify", file)
    assert result.exit_code == code
    assert says in result.stdout
    assert json_of(liehom("classify", file, "--json"))["classification"] is None


@pytest.mark.parametrize("d", [0, 1, 2, 7])
def test_full_pairs_lists_all_rows(d: int) -> None:
    data = json_of(liehom("full-pairs", str(d), "--json"))
    assert (data["dimension"], data["count"]) == (d, len(rows(d)))
    assert [row["name"] for row in data["pairs"]] == [pair.name for pair in lh.full_pairs(d)]
    assert len(liehom("full-pairs", str(d)).stdout.splitlines()) == 1 + len(rows(d))


def test_full_pairs_of_a_negative_dimension_is_bad_input() -> None:
    assert liehom("full-pairs", "--", "-1").exit_code == 2
