"""Pairs of the rows of the classification, and extensions of them by ideals inside h."""

import itertools
import random
from collections.abc import Callable
from typing import Any

import liehom as lh
from liehom.exact.fullness import certificate_writer
from liehom.exact.fullness.classification import Classification
from liehom.exact.fullness.classification_rows import Key, Row
from liehom.exact.representations.invariants.intertwiners import invariant_forms
from tests.exact.fullness.support import enlarged


def pair_of(row: Row, c: str = "2/3") -> lh.Pair:
    """The pair of a row; of a family the member with this c."""
    return lh.pair(row.name.replace("(c,1)", f"({c},1)"))


def expected_key(row: Row, c: str = "2/3") -> Key:
    value = lh.QQ.convert(c)
    return row.key._replace(parameter=value * value) if row.is_family else row.key


def classified(pair: lh.Pair) -> Classification:
    """The row of a pair that is full by construction, without a decision."""
    return lh.classify(pair, lh.fullness.Full(pair, certificate_writer.trivial(pair.field), "by construction"))  # type: ignore[arg-type]


# -- extensions by a direct summand, for every pair ----------------------------------------------------------
SUMMANDS: dict[int, list[Callable[[], lh.LieAlgebra]]] = {
    1: [lambda: lh.abelian(1)],
    2: [lambda: lh.abelian(2), lambda: lh.low_dimensional(2, 1)],
    3: [lambda: lh.so(3), lambda: lh.sl(2), lambda: lh.heisenberg(1), lambda: lh.low_dimensional(3, 4)],
    4: [lambda: lh.gl(2), lambda: lh.low_dimensional(4, 8)],
    5: [lambda: lh.heisenberg(2), lambda: lh.direct_sum(lh.sl(2), lh.low_dimensional(2, 1))],
    6: [lambda: lh.so(4), lambda: lh.euclidean(3), lambda: lh.so(3, 1), lambda: lh.direct_sum(lh.so(3), lh.abelian(3))],
}
"""For each dimension, algebras: abelian, solvable, nilpotent, simple, semisimple, and others."""


def with_summand(pair: lh.Pair, dimension: int, rng: random.Random) -> lh.Pair:
    """The pair with a direct summand of this dimension added to g and h."""
    return enlarged(pair, lh.direct_sum(pair.algebra, rng.choice(SUMMANDS[dimension])().over(pair.field)))


# -- extensions that do not split, or split without being a direct sum ---------------------------------------
def with_module(row: Row) -> lh.Pair | None:
    """g + M over h + M for the module M on which g acts by the matrices of its name, if they have size at most 6."""
    pair = pair_of(row)
    if row.key.letter == "A":
        if not 2 <= row.key.d <= 6:
            return None
        size = pair.dimension
        acting = [*pair.isotropy_matrices(), *[pair.field.zeros(size, size)] * size]
    else:
        acting = list(lh.catalog.representation(row.name.split("/")[0]).matrices)
        size = acting[0].nrows
        if size > 6:
            return None
    return enlarged(pair, lh.semidirect_sum(pair.algebra, acting, size=size))


def over_free_nilpotent(pair: lh.Pair) -> lh.Pair:
    """h + V + L^2 V over h + L^2 V, for an affine pair h + V: the brackets of V are its bivectors."""
    d, field = pair.dimension, pair.field
    index = {ij: d + a for a, ij in enumerate(itertools.combinations(range(d), 2))}
    nilpotent = lh.LieAlgebra({ij: {a: 1} for ij, a in index.items()}, dimension=d + len(index), field=field)
    return _over(pair, nilpotent, [_on_bivectors(a, index, d) for a in pair.isotropy_matrices()])


def _on_bivectors(matrix: Any, index: dict[tuple[int, int], int], d: int) -> Any:
    """The matrix on V + L^2 V of a matrix on V."""
    field, size = matrix.field, d + len(index)
    out = [[field.zero] * size for _ in range(size)]
    for r, c in itertools.product(range(d), range(d)):
        out[r][c] = matrix[r, c]
    for (i, j), column in index.items():
        for r in range(d):  # A e_i ^ e_j + e_i ^ A e_j
            for left, right, x in ((r, j, matrix[r, i]), (i, r, matrix[r, j])):
                if left != right:
                    sign = 1 if left < right else -1
                    row = index[min(left, right), max(left, right)]
                    out[row][column] = out[row][column] + sign * x
    return field.matrix(out)


def over_heisenberg(pair: lh.Pair) -> lh.Pair | None:
    """h + V + Z over h + Z, with brackets of V in Z by at most 6 invariant skew forms; None if there is no form."""
    d, field = pair.dimension, pair.field
    matrices = pair.isotropy_matrices()
    one = field.identity(d)
    traceless = [a - one.scale(a.trace() / d) for a in matrices]
    forms = invariant_forms(traceless, d, field).skew[:6]
    if not forms:
        return None
    size = d + len(forms)
    brackets = {
        (i, j): {d + a: form[i, j] for a, form in enumerate(forms) if form[i, j] != 0}
        for i, j in itertools.combinations(range(d), 2)
    }
    nilpotent = lh.LieAlgebra({ij: x for ij, x in brackets.items() if x}, dimension=size, field=field)
    acting = []
    for a in matrices:
        rows = [[a[r, c] if max(r, c) < d else field.zero for c in range(size)] for r in range(size)]
        for z in range(d, size):
            rows[z][z] = 2 * a.trace() / d
        acting.append(field.matrix(rows))
    return _over(pair, nilpotent, acting)


def _over(pair: lh.Pair, nilpotent: lh.LieAlgebra, acting: list[Any]) -> lh.Pair:
    """h + N over h + [N, N], for matrices of h on N; the construction proves the Jacobi identity."""
    h = pair.subalgebra.as_algebra()
    joined = lh.semidirect_sum(h, acting, nilpotent)
    k, n, d = h.dimension, joined.dimension, pair.dimension
    return lh.Pair(joined, pair.field.identity(n).select(rows=[*range(k), *range(k + d, n)]))
