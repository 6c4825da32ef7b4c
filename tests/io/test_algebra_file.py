"""Algebra files: round trips, and every kind of bad input named."""

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base import errors
from tests.sampling import examples

SO3: dict[str, Any] = {
    "format": "liehom-algebra",
    "version": 1,
    "name": "so(3)",
    "dimension": 3,
    "structure_constants": [[0, 1, 2, "1"], [0, 2, 1, "-1"], [1, 2, 0, "1"]],
}
FIELD = {"name": "a", "minpoly": ["-2", "0", "0", "1"], "interval": ["1", "2"]}


def algebras() -> dict[str, lh.LieAlgebra]:
    return {
        "zero": lh.abelian(0),
        "abelian": lh.abelian(3),
        "named basis": lh.heisenberg(2),
        "simple": lh.so(3, 1),
        "fractions": lh.so(4).change_of_basis([[i + 1 if i == j else j % 2 for j in range(6)] for i in range(6)]),
        "radicals": lh.LieAlgebra({(0, 1): {1: "sqrt(2)/2 + 1"}}, dimension=3),
        "floats": lh.LieAlgebra({(0, 1): {1: 0.1}}, dimension=2),
    }


@pytest.mark.parametrize("key", sorted(algebras()))
def test_what_is_written_is_read_again(key: str, tmp_path: Path) -> None:
    algebra = algebras()[key]
    lh.dump(algebra, tmp_path / "g.json")
    found = lh.load(tmp_path / "g.json")
    assert isinstance(found, lh.LieAlgebra)
    assert found == algebra
    assert (found.name, found.basis_names, found.field) == (algebra.name, algebra.basis_names, algebra.field)


def test_a_number_field_is_stated() -> None:
    read = lh.from_json({**SO3, "field": FIELD, "structure_constants": [[0, 1, 2, "a**4 - 2*a"]]})
    assert read.is_abelian()
    read = lh.from_json({**SO3, "field": FIELD, "structure_constants": [[0, 1, 2, "a**2"]]})
    assert lh.to_json(read)["field"]["minpoly"] == FIELD["minpoly"]
    assert lh.from_json(lh.to_json(read)) == read


def test_the_format_must_be_stated() -> None:
    """Without it the file is a pair file whose subalgebra was forgotten; the message names both ways out."""
    with pytest.raises(errors.FormatError, match=r"'subalgebra' is missing.*\"format\": \"liehom-algebra\""):
        lh.from_json({k: v for k, v in SO3.items() if k not in ("format", "name")})


@pytest.mark.parametrize("key", ["dimension", "structure_constants"])
def test_missing_key_is_named(key: str) -> None:
    with pytest.raises(errors.FormatError, match=f"'{key}' is missing in an algebra file"):
        lh.from_json({k: v for k, v in SO3.items() if k != key})


@pytest.mark.parametrize("key", ["subalgebra", "matrices", "point", "Name"])
def test_unknown_key_is_named(key: str) -> None:
    with pytest.raises(errors.FormatError, match=f"unknown key '{key}' in an algebra file"):
        lh.from_json({**SO3, key: []})


@pytest.mark.parametrize("name", ["", 7, None, "a\nb", "x" * 101])
def test_unprintable_or_long_name_raises(name: Any) -> None:
    with pytest.raises(errors.FormatError, match=r"name is .*expected a printable name"):
        lh.from_json({**SO3, "name": name})


def test_a_name_too_long_for_a_file_is_left_out() -> None:
    long = lh.LieAlgebra({(0, 1): {1: 1}}, name="x" * 101)
    assert lh.from_json(lh.to_json(long)) == long
    assert "name" not in lh.to_json(long)


def test_jacobi_failure_is_refused() -> None:
    with pytest.raises(errors.JacobiError) as caught:
        lh.from_json({**SO3, "structure_constants": [[0, 1, 2, "1"], [1, 2, 1, "1"]]})
    assert caught.value.indices == (0, 1, 2)


def test_a_float_is_refused_with_the_fraction_to_write() -> None:
    with pytest.raises(errors.FormatError, match=r"structure_constants\[0\].*\"1/10\".*float64"):
        lh.from_json({**SO3, "structure_constants": [[0, 1, 2, 0.1]]})


def test_an_algebra_is_neither_a_pair_nor_a_problem(tmp_path: Path) -> None:
    lh.dump(lh.so(3), tmp_path / "g.json")
    with pytest.raises(errors.FormatError, match="an algebra file"):
        lh.io.load_pair(tmp_path / "g.json")
    with pytest.raises(errors.FormatError, match="an algebra file"):
        lh.io.load_problem(tmp_path / "g.json")


small = st.integers(-3, 3)


@settings(max_examples=examples(15))
@given(st.lists(st.lists(small, min_size=3, max_size=3), min_size=3, max_size=3), st.integers(1, 10**40))
def test_round_trip_in_every_basis(rows: list[list[int]], scale: int) -> None:
    matrix = lh.QQ.matrix([[x + (7 * scale if i == j else 0) for j, x in enumerate(row)] for i, row in enumerate(rows)])
    algebra = lh.sl(2).change_of_basis(matrix)  # diagonally dominant, so invertible
    assert lh.loads(json.dumps(lh.to_json(algebra))) == algebra


def test_files_keep_the_tolerance_of_floats() -> None:
    rough = lh.so(3).over(lh.FloatField(1e-6))
    pair = lh.Pair(rough, [[0.1, 0.2, 0.3]])
    for made in (rough, pair, pair.subalgebra):
        data = lh.to_json(made)
        assert data["tolerance"] == 1e-6
        assert lh.from_json(data) == made
    assert lh.from_json(lh.to_json(lh.adjoint(rough))).field == rough.field  # the algebra is generated anew
    assert "tolerance" not in lh.to_json(lh.so(3).over(lh.RR))


@pytest.mark.parametrize("tolerance", [None, 0.0, 1.0, -1e-9, 1, True, "1e-6", []])
def test_a_tolerance_is_a_float_between_0_and_1(tolerance: object) -> None:
    data = lh.to_json(lh.so(3).over(lh.RR))
    with pytest.raises(lh.FormatError, match="tolerance is"):
        lh.from_json({**data, "tolerance": tolerance})


def test_an_exact_file_has_no_tolerance() -> None:
    with pytest.raises(lh.FormatError, match="tolerance is"):
        lh.from_json({**lh.to_json(lh.so(3)), "tolerance": 1e-6})
