"""Irreducibility over the reals: tables, and that a reduction shows an invariant subspace."""

import random
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.representations.invariants import irreducibility
from liehom.exact.representations.invariants.irreducibility import Reduction, is_irreducible, reduction
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ
from liehom.testing import random_unimodular

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
MINUS_ROOT2 = NumberField("a", [-2, 0, 1], (-2, -1))


def companion(field: Any, coefficients: list[Any]) -> Any:
    n = len(coefficients)
    rows = [[-field.convert(coefficients[i]) if j == n - 1 else int(i == j + 1) for j in range(n)] for i in range(n)]
    return field.matrix(rows)


def shows_a_subspace(found: Reduction, maps: list[Any], size: int) -> bool:
    """A proper invariant subspace, read off the reduction by other means than those that certificates use."""
    if found.kind == "kernel":
        kernel = found.matrix.null_space()
        moved = [kernel @ a.T for a in maps]
        return 0 < kernel.nrows < size and all((found.matrix @ m.T).is_zero() for m in moved)
    if any(found.matrix @ a != a @ found.matrix for a in maps):
        return False
    parts = np.linalg.eigvals(found.matrix.to_numpy())
    if found.kind == "cut":
        above = int((parts.real > found.matrix.field.to_float(found.cut)).sum())
        return 0 < above < size
    return (
        bool((np.abs(parts.imag) < 1e-6).any()) and irreducibility.evaluated(found.polynomial, found.matrix).is_zero()
    )


def check(maps: list[Any], irreducible: bool, kinds: set[str] | None = None) -> None:
    """In the given basis and in two scrambled ones."""
    size, field = maps[0].nrows, maps[0].field
    rng = random.Random(size)
    for change in (field.identity(size), *(field.matrix(random_unimodular(size, rng)) for _ in range(2))):
        moved = [change @ a @ change.inverse() for a in maps]
        found = reduction(moved, size, field)
        assert is_irreducible(moved, size, field) is irreducible and (found is None) is irreducible
        if found is not None:
            assert shows_a_subspace(found, moved, size)
            assert kinds is None or found.kind in kinds


@pytest.mark.parametrize("k", range(1, 8))
def test_binary_forms_are_irreducible(k: int) -> None:
    check(list(lh.defining(lh.sl(2)).symmetric_power(k).matrices), True)
    check(
        list(lh.defining(lh.sl(2)).symmetric_power(k).direct_sum(lh.representations.trivial(lh.sl(2))).matrices), False
    )


@pytest.mark.parametrize(("name", "irreducible"), [
    ("so(2)", True), ("so(3)", True), ("so(4)", True), ("so(1,1)", False), ("so(2,1)", True), ("su(2)", True),
    ("su(3)", True), ("sp(2)", True), ("gl(1,C)", True), ("sl(2,H)", True), ("g2", True), ("spin(7)", True),
    ("so(3,C)", True), ("so*(6)", True), ("upper(2)", False), ("upper(3)", False), ("strict(3)", False),
    ("diag(1,-1)", False), ("diag(1,2)", False), ("spiral(1,1)", True), ("spiral(1,1,2)", False), ("field(1,0)", True),
    ("field(-2,0)", False), ("field(-2,0,0)", False), ("field(1,1,1,1)", False), ("sl(2,Q(sqrt(2)))", False),
    ("sl(2,Q(sqrt(-2)))", True), ("sl(1,Q(-1,3))", False), ("sl(2,Q(-1,3))", False), ("sl(2,Q(-1,-3))", True),
    ("tensor(sl(4),sl(2))", True), ("sl(2,Q(-1,3))+sl(1,Q(-1,3))", True), ("copies(2,so(3))", False),
    ("copies(2,sl(2))", False), ("copies(3,sl(2))", False), ("sym(3)", False), ("blocks(so(2),so(3))", False),
    ("e6(-26)", True),
])  # fmt: skip
def test_table(name: str, irreducible: bool) -> None:
    check(list(lh.catalog.representation(name).matrices), irreducible)


@pytest.mark.parametrize(("coefficients", "irreducible", "kinds"), [
    ([1, 0], True, None),  # t^2 + 1
    ([1, 1], True, None), ([-2, 0], False, {"eigenvalue"}),
    ([-1, 0], False, {"kernel"}),  # t^2 - 1: eigenvalues in the field
    ([0, 0], False, {"kernel"}),  # nilpotent
    ([1, -2], False, {"kernel"}),  # a Jordan block
    ([1, 0, 2, 0], False, {"kernel"}),  # (t^2 + 1)^2: semisimple part a complex structure
    ([1, 1, 1, 1], False, {"cut"}),  # Q(zeta_5): two pairs of complex eigenvalues
    ([1, 0, 0, 0], False, {"cut"}),  # Q(zeta_8)
    ([2, 0, 4, 0], False, None),  # t^4 + 4 t^2 + 2: imaginary eigenvalues only, different ones
    ([-2, 0, 0], False, {"eigenvalue"}),
    ([5, 0, 0, 0, 0, 0, 0, 0, 0], False, {"cut"}),  # degree 9: a cut in place of the real eigenvalue
    ([1, 0, 6, 0, 9, 0], False, None),  # t^6 + 9 t^4 + 6 t^2 + 1: imaginary eigenvalues
])  # fmt: skip
def test_one_matrix(coefficients: list[int], irreducible: bool, kinds: set[str] | None) -> None:
    a = companion(QQ, coefficients)
    check([a], irreducible, kinds)
    check([a + QQ.identity(a.nrows)], irreducible)


def quaternions(field: Any, a: Any, b: Any) -> list[Any]:
    """Left multiplications by i and j in (a, b) on itself."""
    i = field.matrix([[0, a, 0, 0], [1, 0, 0, 0], [0, 0, 0, a], [0, 0, 1, 0]])
    minus = -field.convert(b)
    j = field.matrix([[0, 0, b, 0], [0, 0, 0, minus], [1, 0, 0, 0], [0, -1, 0, 0]])
    return list(lie_closure([i, j]).matrices)


@pytest.mark.parametrize(("a", "b", "irreducible"), [
    (-1, -1, True), (-1, -3, True), (-2, -5, True), (-1, 3, False), (2, 3, False), (-1, 1, False), (7, -11, False),
])  # fmt: skip
def test_quaternion_algebras(a: int, b: int, irreducible: bool) -> None:
    """Definite or not over the reals; (-1, 3), (2, 3), (7, -11) are division algebras over Q."""
    check(quaternions(QQ, a, b), irreducible)


@pytest.mark.parametrize(("field", "irreducible"), [(ROOT2, False), (MINUS_ROOT2, True)])
def test_the_embedding_decides(field: Any, irreducible: bool) -> None:
    """(-1, a) and K(sqrt(a)) for a^2 = 2: split for a > 0 and division for a < 0."""
    check(quaternions(field, -1, field.generator), irreducible)
    check([companion(field, [-field.generator, 0])], irreducible)


def test_nilpotent_ideals() -> None:
    """Affine maps: a compact Levi part does not make a non-reductive algebra irreducible."""
    rows = [[[0, -1, 0], [1, 0, 0], [0] * 3], [[0, 0, 1], [0] * 3, [0] * 3], [[0] * 3, [0, 0, 1], [0] * 3]]
    check([QQ.matrix(a) for a in rows], False, {"kernel"})


def test_no_matrices_and_the_zero_space() -> None:
    assert is_irreducible([], 1, QQ) and not is_irreducible([], 2, QQ) and not is_irreducible([], 0, QQ)
    assert not lh.representations.trivial(lh.so(3), 0).is_irreducible()


def test_small_combinations_do_not_show_a_zero_divisor() -> None:
    """(2, 3)-like: neither the basis of the commutant nor its sums split, the Gram matrix does."""
    for a, b in ((-1, 2), (-3, 5), (-1, 7), (-5, 2)):
        maps = quaternions(QQ, a, b)
        check(maps, False)
        found = reduction(maps, 4, QQ)
        assert found is not None and found.kind in ("eigenvalue", "kernel", "cut")
        if found.polynomial is not None:
            assert isinstance(found.polynomial, Polynomial) and found.polynomial.count_real_roots() > 0
