"""Results are what they were in 0.1.0, and the comparison can fail."""

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from tests.results import compare, record

BEFORE = Path(__file__).with_name("0.1.0.json")
FLOATS = ("[eta_numerical]", "[smallest_singular_value]", "[gap]")  # their last bits depend on libraries and processor
ADVICE = "; if only the wording has changed, say so in REWORDED in tests/results/record.py"


def before() -> dict[str, Any]:
    data: dict[str, Any] = json.loads(BEFORE.read_text(encoding="utf-8"))
    return data


def difference(section: str, name: str) -> list[str]:
    after = json.loads(json.dumps(record.recorded(section, name)))
    lines = compare.differences({section: {name: before()[section][name]}}, {section: {name: after}})
    return [line for line in lines if not any(key in line for key in FLOATS)]


@pytest.mark.parametrize(("section", "name"), [(s, name) for s, cases in record.SECTIONS.items() for name in cases])
def test_exact_results_are_those_of_0_1_0(section: str, name: str) -> None:
    found = difference(section, name)
    assert not found, "\n".join(found) + ADVICE


def test_the_committed_file_has_all_cases() -> None:
    data = before()
    assert data["header"]["liehom"] == "0.1.0"
    assert {name: list(cases) for name, cases in record.SECTIONS.items()} == {
        name: list(cases) for name, cases in data.items() if name != "header"
    }
    assert [len(cases) for cases in record.SECTIONS.values()] == [100, 40]


# -- negative controls -------------------------------------------------------------------------------------
def test_another_certificate_is_noticed() -> None:
    long = record.decisions.CASES["so(4)/so(3)"]()["certificate"]
    short = long.short()
    long.value["eta"][0] += " + 0"
    assert long.short() != short


def test_each_difference_is_printed_and_the_exit_status_is_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    after = before()
    assert compare.main([str(BEFORE), str(BEFORE)]) == 0
    after["decisions"]["so(4)/so(3)"]["full"] = False
    after["cards"]["so(3)"]["real form"] = "sl(2,R)"
    del after["cards"]["gl(3)"]
    after["cards"]["another"] = {}
    after["header"]["numpy"] = "0"
    changed = tmp_path / "after.json"
    changed.write_text(json.dumps(after))
    capsys.readouterr()
    assert compare.main([str(BEFORE), str(changed)]) == 1
    printed = capsys.readouterr().out
    for text in ("[so(4)/so(3)] [full]", "[so(3)] [real form]", "[gl(3)] only before", "[another] only after"):
        assert text in printed
    assert "numpy: " in printed and "4 differences in 140 cases" in printed


def test_words_are_compared_as_they_were(monkeypatch: pytest.MonkeyPatch) -> None:
    one = record.recorded("cards", "aff(1)")
    monkeypatch.setattr(record, "REWORDED", {"solvable": "soluble"})
    assert record.recorded("cards", "aff(1)")["card"] == one["card"].replace("solvable", "soluble") != one["card"]
    monkeypatch.setattr(record, "REWORDED", {})
    assert not compare.differences({"cards": {"aff(1)": one}}, {"cards": {"aff(1)": copy.deepcopy(one)}})
