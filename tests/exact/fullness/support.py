"""Pairs in other coordinates, and what every verdict must satisfy; shared by the tests of the decision."""

import json
import random
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import liehom as lh
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.fullness import certificate_writer
from liehom.testing import random_unimodular

DENSE_DIMENSION = 80


def scrambled(pair: lh.Pair, rng: random.Random) -> lh.Pair:
    """The pair in a random unimodular basis of g, and h in a random basis of its own."""
    n, k = pair.algebra.dimension, pair.subalgebra.dimension
    operations = None if n <= DENSE_DIMENSION else 2 * n
    rows = pair.field.matrix(random_unimodular(n, rng, operations), (n, n))
    mixed = pair.field.matrix(random_unimodular(k, rng, None if k <= DENSE_DIMENSION else 2 * k), (k, k))
    return in_basis(pair, rows, mixed)


def in_basis(pair: lh.Pair, rows: Any, mixed: Any = None) -> lh.Pair:
    """The pair in the basis `rows` of g, h in the basis `mixed` (in terms of its old one)."""
    moved = pair.change_of_basis(rows)
    if mixed is None:
        return moved
    return lh.Pair(moved.algebra, lh.Subalgebra(moved.algebra, mixed @ moved.subalgebra.basis, check=False))


def random_invertible(field: Any, n: int, entry: Any) -> Any:
    """An invertible matrix (n, n) with entries from `entry()`."""
    while True:
        rows = field.matrix([[entry() for _ in range(n)] for _ in range(n)], (n, n))
        if rows.rank() == n:
            return rows


def fraction(rng: random.Random, bound: int) -> Fraction:
    return Fraction(rng.randint(-bound, bound), rng.randint(1, bound))


def turned(pair: lh.Pair, change: Any) -> lh.Pair:
    """The pair with V in another basis, the rows of `change` in that of the complement, and h as it is.

    A reduction of the lattice of g does not undo this: h and its complement are spanned by unit vectors.
    """
    data = pair.subalgebra.quotient()
    return pair.change_of_basis(pair.field.stack_rows([data.subspace, change @ data.lift], pair.algebra.dimension))


def over(pair: lh.Pair, field: Any) -> lh.Pair:
    """The pair over a larger field."""
    h = pair.subalgebra
    rows = field.matrix(h.basis.to_rows(), (h.dimension, pair.algebra.dimension))
    return lh.Pair(pair.algebra.over(field), rows)


def enlarged(pair: lh.Pair, algebra: lh.LieAlgebra) -> lh.Pair:
    """The pair of h + k in an algebra g + k with the basis of g first, for an ideal k."""
    n, size, field, h = pair.algebra.dimension, algebra.dimension, pair.field, pair.subalgebra
    rows = field.stack_columns([h.basis, field.zeros(h.dimension, size - n)], h.dimension)
    return lh.Pair(algebra, field.stack_rows([rows, field.identity(size).select(rows=range(n, size))], size))


def affine(matrices: Sequence[Any], field: Any = None) -> lh.Pair:
    """h + V over h, h the linear Lie algebra that the matrices generate."""
    built = lie_closure(matrices, field=field, independent=True)
    g = lh.semidirect_sum(built.algebra, built.matrices, size=built.matrices[0].nrows)
    k = built.algebra.dimension
    return lh.Pair(g, g.field.identity(g.dimension).select(rows=range(k)))


def companion(coefficients: Sequence[Any]) -> list[list[Any]]:
    """The companion matrix of t^n + c_(n-1) t^(n-1) + ... + c_0."""
    n = len(coefficients)
    return [[-coefficients[i] if j == n - 1 else int(i == j + 1) for j in range(n)] for i in range(n)]


def proved(pair: lh.Pair, full: bool, **options: Any) -> Any:
    """Decide; the verdict must be `full`, proved, and survive writing to JSON; the rank must drop at an exact eta."""
    verdict = lh.decide_fullness(pair, **options)
    assert verdict.full is full
    text = json.dumps(verdict.certificate.to_json(), allow_nan=False)
    assert lh.verify_certificate(pair, json.loads(text)) is True
    assert lh.Certificate.from_json(json.loads(text)) == verdict.certificate
    json.dumps(verdict.to_json(), allow_nan=False)
    if not full and verdict.eta is not None:
        assert verdict.rank == rank_at(over(pair, verdict.eta_field), verdict.eta) < pair.dimension
    return verdict


def rank_at(pair: lh.Pair, eta: Sequence[Any]) -> int:
    """rank [[h, eta], eta] in g/h, all of it computed in g; 0 for eta in h."""
    g, h = pair.algebra, pair.subalgebra
    moved = h.basis @ g.ad(eta).T
    return int(g.field.stack_rows([h.basis, g.row(eta), moved], g.dimension).rank()) - h.dimension


def without_cheap_points(action: Any, rng: random.Random) -> tuple[Any, Any]:
    """In place of the sample points of the decision: large random points only, so that the later steps are reached."""
    for _ in range(20):
        x = action.field.from_integers([rng.randint(-(10**6), 10**6) for _ in range(action.size)], action.size, 1)
        if action.rank_at(x) == action.size:
            return x, None
    return x, certificate_writer.rational_witness(action, x, action.action_rows(x).null_space().select(rows=[0]))
