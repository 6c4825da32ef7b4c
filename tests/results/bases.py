"""Random bases, which depend on a seed alone."""

import random
from fractions import Fraction
from typing import Any

import liehom as lh

DENSE = 12
"""Up to this dimension changes of basis are dense, with denominators; above they are sparse and unimodular."""


def change(field: Any, n: int, rng: random.Random) -> Any:
    """An invertible matrix (n, n) over the field."""
    order = rng.sample(range(n), n)
    rows = [[Fraction(rng.choice((-1, 1)) if j == order[i] else 0) for j in range(n)] for i in range(n)]
    if n <= DENSE:
        rows = [[x * Fraction(rng.randint(1, 3), rng.randint(1, 3)) for x in row] for row in rows]
    for _ in range(2 * n if n <= DENSE else n // 2):
        if n > 1:
            i, j = rng.sample(range(n), 2)
            factor = rng.choice((-1, 1)) * (Fraction(1, rng.randint(1, 2)) if n <= DENSE else 1)
            rows[i] = [a + factor * b for a, b in zip(rows[i], rows[j], strict=True)]
    return field.matrix(rows, (n, n))


def scrambled(pair: lh.Pair, seed: str) -> lh.Pair:
    """The pair in a random basis of g, and h in a random basis of its own."""
    rng = random.Random(seed)
    moved = pair.change_of_basis(change(pair.field, pair.algebra.dimension, rng))
    return lh.Pair(moved.algebra, change(pair.field, pair.subalgebra.dimension, rng) @ moved.subalgebra.basis)


def over(pair: lh.Pair, field: Any) -> lh.Pair:
    h = pair.subalgebra
    return lh.Pair(pair.algebra.over(field), field.matrix(h.basis.to_rows(), (h.dimension, pair.algebra.dimension)))
