"""Equal objects are equal and hash equal, in this process and in another; names are not compared."""

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from tests.clock import seconds
from tests.sampling import examples

ROOT2 = lh.number_field("sqrt(2)")
SAME = lh.scalars.NumberField("b", [-2, 0, 1], (1, 2))  # the same field by another name
MAKERS: dict[str, Callable[[], Any]] = {
    "matrix": lambda: lh.QQ.matrix([["1/2", 1], [0, 3]]),
    "matrix over a number field": lambda: ROOT2.matrix([["sqrt(2)/2", 1]]),
    "float matrix": lambda: lh.RR.matrix([[0.5, -0.0]]),
    "table": lambda: lh.sl(3).table,
    "algebra": lambda: lh.sl(3),
    "algebra over a number field": lambda: lh.LieAlgebra({(0, 1): {2: "sqrt(2)"}}, dimension=3),
    "float algebra": lambda: lh.so(4).over(lh.RR),
    "large algebra": lambda: lh.simple("E6"),
    "subalgebra": lambda: lh.so(4).subalgebra([[2, 0, 0, 0, 0, 0]]),
    "float subalgebra": lambda: lh.so(3).over(lh.RR).subalgebra([[0.6, 0.8, 0.0]]),
    "homomorphism": lambda: lh.algebra.Homomorphism.identity(lh.sl(2)),
    "representation": lambda: lh.defining(lh.su(2)),
    "float representation": lambda: lh.defining(lh.su(2)).over(lh.RR),
    "pair": lambda: lh.pair("so(4)/so(3)"),
    "full": lambda: lh.decide_fullness(lh.pair("so(4)/so(3)")),
    "not full": lambda: lh.decide_fullness(lh.pair("so(3,1)/so(2,1)")),
    "numerical": lambda: lh.decide_fullness(lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]])),
    "certificate": lambda: lh.decide_fullness(lh.pair("sl(3)/so(3)")).certificate,
    "field": lambda: lh.number_field("sqrt(2)"),
    "number": lambda: ROOT2.convert("1/3 + sqrt(2)"),
    "real form": lambda: lh.RealForm.of_name("so(4,1)"),
}


@pytest.mark.parametrize("name", MAKERS)
def test_equal_objects_hash_equal(name: str) -> None:
    first, second = MAKERS[name](), MAKERS[name]()
    assert first is not second or name in ("field", "real form")  # these are cached
    assert first == second and hash(first) == hash(second)
    assert len({first, second, pickle.loads(pickle.dumps(first))}) == 1


@pytest.mark.parametrize("name", MAKERS)
def test_different_kinds_are_different(name: str) -> None:
    thing = MAKERS[name]()
    assert [other for other, make in MAKERS.items() if make() == thing] == [name]
    assert thing != "text" and thing != 0


def test_equal_objects_hash_equal_in_another_process() -> None:
    """Hashes of strings differ between processes, so a stored hash would be wrong there."""
    things = {make(): name for name, make in MAKERS.items()}
    code = (
        "import pickle, sys; from tests.test_equality import MAKERS; things = pickle.load(sys.stdin.buffer); "
        "print(sum(things[make()] == name for name, make in MAKERS.items()))"
    )
    environment = os.environ | {"PYTHONHASHSEED": "12345", "PYTHONPATH": str(Path(__file__).parents[1])}
    done = subprocess.run(
        [sys.executable, "-c", code], input=pickle.dumps(things), capture_output=True, check=True, env=environment
    )
    assert int(done.stdout) == len(MAKERS)


def test_names_are_not_compared_and_data_are() -> None:
    so3 = lh.so(3)
    named = lh.LieAlgebra(so3.table, basis=["x", "y", "z"], name="rotations")
    assert named == so3 and hash(named) == hash(so3)
    assert lh.Pair(named, [[0, 0, 1]], name="sphere") == lh.Pair(so3, [[0, 0, -2]])
    assert lh.Pair(named, [[0, 1, 0]]) != lh.Pair(so3, [[0, 0, 1]])
    assert so3.over(ROOT2) != so3 and so3.over(ROOT2) == so3.over(SAME)
    assert hash(so3.over(ROOT2)) == hash(so3.over(SAME))
    assert so3.over(lh.RR) != so3
    assert lh.sl(2) != so3


@given(st.lists(st.integers(-6, 6), min_size=9, max_size=9), st.integers(1, 12))
@settings(max_examples=examples(30), deadline=None)
def test_tables_are_compared_by_value(values: list[int], scale: int) -> None:
    """The same constants as integers over a common denominator, as fractions and as another basis and back."""
    rows = lh.QQ.matrix([values[:3], values[3:6], values[6:]]) / scale
    if rows.rank() < 3:
        return
    moved = lh.so(3).change_of_basis(rows)
    again = lh.LieAlgebra(
        {
            (i, j): {k: v for a, b, k, v in moved.structure_constants() if (a, b) == (i, j)}
            for i, j, _, _ in moved.structure_constants()
        },
        dimension=3,
    )
    assert again == moved and hash(again) == hash(moved)
    back = moved.change_of_basis(rows.inverse())
    assert back == lh.so(3) and hash(back) == hash(lh.so(3))
    assert hash(rows * 6 / 6) == hash(rows) and hash(rows + rows) == hash(2 * rows)


def test_rational_elements_of_a_number_field_hash_like_rational_numbers() -> None:
    assert ROOT2.convert("2/3") == lh.QQ.convert("2/3")
    assert hash(ROOT2.convert("2/3")) == hash(lh.QQ.convert("2/3"))
    assert len({ROOT2.convert(2), lh.QQ.convert(2), 2}) == 1


def test_hash_of_a_large_algebra_is_quick() -> None:
    """248 dimensions: the table is hashed as it is held, and no number is constructed."""
    g = lh.simple("E8")
    assert seconds(lambda: hash(g)) < 0.05
    assert g == lh.simple("E8")


def test_float_subspaces_of_other_bases_hash_equal() -> None:
    """Equality over floats is up to the tolerance of the field, and rotated bases are equal."""
    plane = lh.scalars.Subspace(lh.RR, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 3)
    turned = lh.scalars.Subspace(lh.RR, [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0]], 3)
    assert plane == turned and hash(plane) == hash(turned)
    exact = lh.scalars.Subspace(lh.QQ, [[1, 0, 0], [0, 1, 0]], 3)
    assert exact != plane and plane != exact


def test_verdicts_can_be_counted() -> None:
    verdicts = [lh.decide_fullness(lh.pair(name)) for name in ("so(4)/so(3)", "so(3)/so(2)", "so(4)/so(3)")]
    assert len(set(verdicts)) == 2
    assert np.unique([hash(v) for v in verdicts]).size == 2
