"""Pairs of the rows of the classification, and ideals inside h."""

from __future__ import annotations

import random
from typing import Any

import liehom as lh
from liehom.fullness.classification import Key, Row


def pair_of(row: Row, c: str = "2/3") -> lh.Pair:
    """The pair of a row; of a family the one with c = p/q."""
    p, _, q = c.partition("/")
    return lh.pair(row.name.replace("(c,1)", f"({p},{q or 1})"))


def expected_key(row: Row, c: str = "2/3") -> Key:
    value = lh.QQ.convert(c)
    return row.key._replace(parameter=value * value) if row.is_family else row.key


def with_ideal(pair: lh.Pair, dimension: int, rng: random.Random) -> lh.Pair:
    """A pair with an ideal of this dimension inside h, whose quotient is the given pair.

    The ideal is a module of g, or a direct summand: abelian, solvable, simple, nilpotent. A change of basis by a map
    from g to the ideal makes the extension look like one that does not split.
    """
    g = pair.algebra
    kinds: list[Any] = [lambda: lh.abelian(dimension)]
    if dimension == 2:
        kinds.append(lambda: lh.low_dimensional(2, 1))
    if dimension in (3, 6):
        kinds += [
            lambda: lh.direct_sum(*[lh.so(3)] * (dimension // 3)),
            lambda: lh.direct_sum(*[lh.sl(2)] * (dimension // 3)),
        ]
    if dimension == 5:
        kinds.append(lambda: lh.heisenberg(2))
    ideal = rng.choice(kinds)()
    whole = lh.direct_sum(g, ideal.over(g.field)) if ideal.field != g.field else lh.direct_sum(g, ideal)
    n, k = g.dimension, pair.subalgebra.dimension
    field = pair.field
    top = field.stack_columns([pair.subalgebra.basis, field.zeros(k, dimension)], k)
    bottom = field.stack_columns([field.zeros(dimension, n), field.identity(dimension)], dimension)
    return lh.Pair(whole, field.stack_rows([top, bottom], n + dimension))
