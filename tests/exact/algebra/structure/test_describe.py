"""The summary of an algebra is correct in any basis, over QQ and QQ(sqrt(2)), within seconds."""

import random
import time
from typing import Any

import pytest

import liehom as lh
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.roots.real_form import complex_form

LIMIT = 3.0  # seconds of processor time
SQRT2 = lh.number_field("sqrt(2)")


def scrambled(algebra: LieAlgebra) -> LieAlgebra:
    n, rng, field = algebra.dimension, random.Random(algebra.dimension), algebra.field
    rows: list[list[Any]] = [[rng.randint(-2, 2) + 7 * (i == j) for j in range(n)] for i in range(n)]
    if field.degree > 1:
        rows[0] = [field.convert(x) + field.convert("sqrt(2)") for x in rows[0]]
    return algebra.change_of_basis(rows)


CASES: dict[str, tuple[LieAlgebra, list[str]]] = {
    "so(4,1)": (lh.so(4, 1), [
        "simple, real form so(4,1), rank 2, real rank 1, maximal compact so(4)",
        "complex type B2, restricted roots A1 with multiplicity 3",
        "Killing form of signature (4, 6, 0) (positive, negative, zero)",
    ]),
    "so(5,3)": (lh.simple("D4", "so(5,3)"), [
        "simple, real form so(5,3), rank 4, real rank 3, maximal compact so(5)+so(3)",
        "complex type D4, restricted roots B3 with multiplicities 2 (short), 1 (long)",
    ]),
    "so(5,C)": (lh.simple("B2", complex_form("B2").name), [
        "simple, real form so(5,C), rank 4, real rank 2, maximal compact so(5)",
        "complex type B2 + B2, restricted roots B2 with multiplicities 2 (short), 2 (long)",
    ]),
    "g2": (lh.simple("G2", "compact"), [
        "simple, real form g2, rank 2, real rank 0, maximal compact g2",
        "complex type G2, compact",
    ]),
    "sum": (lh.direct_sum(lh.so(4), lh.su(2, 1), lh.sl(2)), [
        "semisimple, real form so(3) + so(3) + sl(2,R) + su(2,1), rank 5, real rank 2, "
        "maximal compact so(3)+so(3)+so(2)+su(2)+u(1)",
    ]),
    "poincare": (lh.poincare(3, 1), [
        "neither solvable nor semisimple: Levi factor of dimension 6, radical of dimension 4",
        "Levi factor: simple, real form sl(2,C), rank 2, real rank 1, maximal compact so(3)",
        "nilradical of dimension 4, centre of dimension 0",
        "derived series 10, lower central series 10",
    ]),
    "gl(3)": (lh.gl(3), [
        "reductive: Levi factor of dimension 8, radical of dimension 1",
        "Levi factor: simple, real form sl(3,R), rank 2, real rank 2, maximal compact so(3)",
        "nilradical of dimension 1, centre of dimension 1",
    ]),
    "nilpotent": (lh.heisenberg(2), [
        "nilpotent of class 2",
        "derived series 5 > 1 > 0, lower central series 5 > 1 > 0",
    ]),
    "solvable": (lh.euclidean(2), ["solvable, not nilpotent", "nilradical of dimension 2, centre of dimension 0"]),
    "abelian": (lh.abelian(5), ["abelian", "nilradical of dimension 5, centre of dimension 5"]),
    "zero": (lh.abelian(0), ["dimension 0 over QQ", "the zero algebra"]),
    "so(4,4) over sqrt(2)": (lh.so(4, 4).over(SQRT2), [
        "dimension 28 over QQ(sqrt(2))",
        "simple, real form so(4,4), rank 4, real rank 4, maximal compact so(4)+so(4)",
        "complex type D4, restricted roots D4 with multiplicity 1",
    ]),
    "euclidean over sqrt(2)": (lh.euclidean(3).over(SQRT2), [
        "neither solvable nor semisimple: Levi factor of dimension 3, radical of dimension 3",
        "Levi factor: simple, real form so(3), rank 1, real rank 0, maximal compact so(3)",
    ]),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_summary_is_the_same_in_a_scrambled_basis(name: str) -> None:
    natural, lines = CASES[name]
    algebra = scrambled(natural)
    start = time.process_time()
    summary = algebra.describe().splitlines()
    assert time.process_time() - start < LIMIT
    assert summary[0].endswith(f"dimension {algebra.dimension} over {algebra.field.name}")
    for line in lines:
        assert line in (summary[0].split(", ", 1)[1], *(text.strip() for text in summary)), summary
