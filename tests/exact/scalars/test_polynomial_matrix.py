"""Matrices of polynomials: ranks, null spaces and where the rank drops, against exact matrices at points."""

from typing import Any

from hypothesis import given, settings, strategies as st

from liehom.exact.scalars.polynomial_matrix import PolynomialMatrix
from liehom.exact.scalars.rational import QQ
from tests.sampling import examples

EXPONENTS = [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0)]
entries = st.dictionaries(st.sampled_from(EXPONENTS), st.integers(-2, 2), max_size=2)


def value(polynomial: Any, point: list[int]) -> Any:
    total = QQ.zero
    for exponents, c in polynomial.to_dict().items():
        for x, e in zip(point, exponents, strict=True):
            c = c * x**e
        total = total + c
    return total


@settings(deadline=None, max_examples=examples(100))
@given(data=st.data())
def test_ranks_at_points(data: st.DataObject) -> None:
    nrows, ncols = data.draw(st.integers(1, 4)), data.draw(st.integers(1, 4))
    table = [[data.draw(entries) for _ in range(ncols)] for _ in range(nrows)]
    M = PolynomialMatrix(2, table, (nrows, ncols))
    rows, dependent = M.null_space
    conditions, sharp = M.rank_conditions()
    assert len(rows) == ncols - M.rank
    point = data.draw(st.lists(st.integers(-3, 3), min_size=2, max_size=2))
    exact = QQ.matrix([[value(v, point) for v in row] for row in M.table], (nrows, ncols))
    kernel = QQ.matrix([[value(v, point) for v in row] for row in rows], (len(rows), ncols))
    assert (exact @ kernel.T).is_zero() and exact.rank() <= M.rank
    generic = all(value(p, point) != 0 for p in conditions)
    assert not generic or exact.rank() == M.rank
    assert not sharp or generic == (exact.rank() == M.rank)
    if generic and all(value(p, point) != 0 for p in dependent):
        assert kernel.rank() == len(rows)


def test_a_hypersurface_without_real_points_is_left_out() -> None:
    """The determinant of the matrix of multiplication by 1 + i x is 1 + x^2."""
    M = PolynomialMatrix(1, [[{(0,): 1}, {(1,): -1}], [{(1,): 1}, {(0,): 1}]], (2, 2))
    assert M.rank_conditions() == ([], True)


def test_dependent_null_vectors_are_replaced() -> None:
    """The null space of (x, y, 0), (0, 0, 0) has the basis (y, -x, 0), (0, 0, 1); Cramer's rule gives it at once.

    For (x, 0, y, z) two of the three vectors of Cramer's rule agree at x = 0, so x stays.
    """
    x, y, z = ({tuple(int(i == k) for i in range(3)): 1} for k in range(3))
    rows, dependent = PolynomialMatrix(3, [[x, y, {}], [{}, {}, {}]], (2, 3)).null_space
    assert len(rows) == 2 and not dependent
    rows, dependent = PolynomialMatrix(3, [[x, {}, y, z]], (1, 4)).null_space
    assert len(rows) == 3 and [str(p) for p in dependent] == ["x0"]


def test_a_condition_inside_another_one_is_left_out() -> None:
    """The real zeros of x^2 + y^2 are the axis x = y = 0, on which x is 0 and z is not."""
    squares, x, z = {(2, 0, 0): 1, (0, 2, 0): 1}, {(1, 0, 0): 1}, {(0, 0, 1): 1}
    for other, kept in ((x, ["x0"]), (z, ["x2", "x0^2+x1^2"])):
        conditions, sharp = PolynomialMatrix(3, [[squares, {}], [{}, other]], (2, 2)).rank_conditions()
        assert sharp and [str(p).replace(" ", "") for p in conditions] == kept


def test_conditions_of_a_constant_matrix() -> None:
    M = PolynomialMatrix(2, [[{(0, 0): 1}, {(0, 0): 1}], [{}, {(0, 0): 1}]], (2, 2))
    conditions, _ = M.rank_conditions()
    assert M.rank == 2 and all(value(p, [0, 0]) != 0 for p in conditions)
