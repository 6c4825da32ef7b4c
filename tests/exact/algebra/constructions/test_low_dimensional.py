"""A_{n,k}: the tabulated invariants, the algebras that have other names, and what is not in the table."""

import random

import pytest

import liehom as lh
from liehom.base.errors import InputError

PARAMETERS: dict[tuple[int, int], list[tuple[str, ...]]] = {
    (3, 5): [("1/2",), ("-1/3",)], (3, 7): [("2",), ("sqrt(2)",)], (4, 2): [("1",), ("-2",), ("1/2",)],
    (4, 5): [("-1", "1"), ("-1/2", "1/3"), ("1", "1")], (4, 6): [("1", "0"), ("-2", "1")],
    (4, 9): [("0",), ("1",), ("-1/2",)], (4, 11): [("1",), ("1/3",)],
}  # fmt: skip
LAST = {1: 1, 2: 1, 3: 9, 4: 12}
ALL = [(n, k, p) for n in LAST for k in range(1, LAST[n] + 1) for p in PARAMETERS.get((n, k), [()])]
CASIMIRS = {
    (1, 1): 1, (2, 1): 0, **{(3, k): 1 for k in range(1, 10)}, **{(4, k): 2 for k in (1, 2, 3, 4, 5, 6, 8, 10)},
    **{(4, k): 0 for k in (7, 9, 11, 12)},
}  # fmt: skip
"""The numbers of invariants of the coadjoint representation in the paper of Patera, Sharp, Winternitz, Zassenhaus."""


def index(g: lh.LieAlgebra) -> int:
    """dim g minus the rank of the matrix of all brackets at a random point of the dual."""
    rng, n = random.Random(1), g.dimension
    point = lh.QQ.matrix([[rng.randint(1, 99)] for _ in range(n)])
    rows = [[0] * n for _ in range(n)]
    for i, j, k, v in g.structure_constants():
        rows[i][j] = rows[i][j] + v * point[k, 0]
        rows[j][i] = -rows[i][j]
    return n - g.field.matrix(rows, (n, n)).rank()


@pytest.mark.parametrize(("n", "k", "parameters"), ALL)
def test_invariants(n: int, k: int, parameters: tuple[str, ...]) -> None:
    g = lh.low_dimensional(n, k, *parameters)
    assert g.dimension == n and g.basis_names == tuple(f"e{i + 1}" for i in range(n))
    assert index(g) == CASIMIRS[n, k]
    assert len(g.direct_sum_decomposition()) == 1 if g.is_semisimple() else g.is_solvable()
    assert g.center().dimension == (1 if (n, k) in {(1, 1), (3, 1), (4, 1), (4, 3), (4, 8), (4, 10)} else 0)
    assert g.is_nilpotent() == ((n, k) in {(1, 1), (3, 1), (4, 1)})
    unimodular = all(g.ad(x).trace() == 0 for x in g.field.identity(n))
    listed = {(1, 1), (3, 1), (3, 4), (3, 6), (3, 8), (3, 9), (4, 1), (4, 8), (4, 10)}
    assert unimodular == ((n, k) in listed or (n, k, parameters) in {(4, 2, ("-2",)), (4, 6, ("-2", "1"))})


def test_algebras_with_other_names() -> None:
    assert lh.low_dimensional(3, 9) == lh.bianchi("IX")
    assert lh.low_dimensional(3, 8).real_form() == "sl(2,R)" and lh.low_dimensional(3, 9).real_form() == "so(3)"
    assert lh.low_dimensional(3, 1).change_of_basis([[0, 1, 0], [0, 0, 1], [1, 0, 0]]) == lh.heisenberg(1)
    flipped = lh.low_dimensional(4, 1).change_of_basis([[0, 0, 0, -1], [0, 0, 1, 0], [0, 1, 0, 0], [1, 0, 0, 0]])
    assert flipped == lh.algebra.filiform(4)
    rows = [[0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1], [0, 1, 0, 0]]  # x, y, ix, iy
    assert lh.low_dimensional(4, 12).change_of_basis(rows) == lh.algebra.realification({(0, 1): {1: 1}}).algebra


@pytest.mark.parametrize(("n", "k", "parameters", "match"), [
    (7, 1, (), "dimensions go up to 6"), (6, 23, (), "A6,1 to A6,22"), (4, 13, (), "A4,1 to A4,12"),
    (4, 2, (), "1 parameter.*a != 0; got 0"),
    (4, 1, (1,), "0 parameter"), (3, 5, (1,), "0 < abs"), (3, 5, (0,), "another name"),
    (4, 5, (1, "1/2"), "a <= b"), (4, 9, (-1,), "-1 < b"),
])  # fmt: skip
def test_what_is_not_in_the_table_is_refused(n: int, k: int, parameters: tuple[object, ...], match: str) -> None:
    with pytest.raises(InputError, match=match):
        lh.low_dimensional(n, k, *parameters)  # type: ignore[arg-type]
