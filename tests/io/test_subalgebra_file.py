"""Subalgebra files: round trips, and every kind of bad input named."""

from pathlib import Path
from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import DependentRowsError, FormatError, NotASubalgebraError


def subalgebras() -> dict[str, lh.Subalgebra]:
    radical = lh.LieAlgebra({(0, 1): {1: "sqrt(2)"}}, dimension=3)
    return {
        "line": lh.so(3).subalgebra([[0, 0, 2]]),
        "zero": lh.so(3).subalgebra([]),
        "whole": lh.sl(2).derived_series()[0],
        "named basis": lh.heisenberg(2).center(),
        "of the zero algebra": lh.abelian(0).center(),
        "radicals": radical.subalgebra([["sqrt(2)/2", 1, 0]]),
        "floats": lh.so(3).over(lh.RR).subalgebra([[0.6, 0.8, 0.0]]),
        "fractions": lh.gl(2).subalgebra([["1/2", 0, 0, "-1/3"]]),
    }


@pytest.mark.parametrize("key", sorted(subalgebras()))
def test_what_is_written_is_read_again(key: str, tmp_path: Path) -> None:
    given = subalgebras()[key]
    lh.dump(given, tmp_path / "h.json")
    found = lh.load(tmp_path / "h.json")
    assert isinstance(found, lh.Subalgebra)
    assert found == given and hash(found) == hash(given)
    assert found.basis == given.basis
    assert (found.algebra.name, found.algebra.basis_names) == (given.algebra.name, given.algebra.basis_names)
    assert lh.io.load_pair(tmp_path / "h.json") == lh.Pair(given.algebra, given)
    assert lh.to_json(found) == lh.to_json(given)


def test_the_format_distinguishes_it_from_a_pair() -> None:
    data = lh.to_json(subalgebras()["zero"])
    assert data["format"] == "liehom-subalgebra" and data["version"] == 1
    assert isinstance(lh.from_json({k: v for k, v in data.items() if k not in ("format", "name")}), lh.Pair)
    with pytest.raises(FormatError, match="subalgebra file"):
        lh.io.loads(str(data).replace("'", '"'), problem=True)


@pytest.mark.parametrize(
    ("change", "error", "match"),
    [
        ({"version": 2}, FormatError, "version is 2"),
        ({"point": [1]}, FormatError, "unknown key 'point' in a subalgebra file"),
        ({"subalgebra": [["0", "1"]]}, lh.ShapeError, "subalgebra"),
        ({"subalgebra": [["1", "0", "0"], ["0", "1", "0"]]}, NotASubalgebraError, "rows 0 and 1"),
        ({"subalgebra": [["1", "0", "0"], ["2", "0", "0"]]}, DependentRowsError, "dependent"),
        ({"name": 3}, FormatError, "name is 3"),
        ({"format": ["liehom-subalgebra"]}, FormatError, "format is"),
    ],
)
def test_bad_input_is_named(change: dict[str, Any], error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        lh.from_json({**lh.to_json(subalgebras()["line"]), **change})


@pytest.mark.parametrize("key", ["dimension", "structure_constants", "subalgebra"])
def test_missing_key_is_named(key: str) -> None:
    data = lh.to_json(subalgebras()["line"])
    with pytest.raises(FormatError, match=f"'{key}' is missing in a subalgebra file"):
        lh.from_json({k: v for k, v in data.items() if k != key})


def test_the_command_line_describes_it_as_a_pair(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from liehom.cli.objects import run_describe

    lh.dump(subalgebras()["line"], tmp_path / "h.json")
    assert run_describe(str(tmp_path / "h.json"), False) == 0
    assert "dim g = 3, dim h = 1" in capsys.readouterr().out
