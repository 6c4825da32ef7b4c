"""The solvable radical, the nilradical, and what they decide: solvable, nilpotent, semisimple.

    rad(g) = {x : K(x, [g, g]) = 0},    nil(g) = {x in rad(g) : ad x is nilpotent},

K the Killing form (Cartan's criterion; Jacobson, Lie Algebras, chapters II and III).  Characteristic 0.
"""

from __future__ import annotations

import random
from typing import Any

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra, lower_central_series, products
from liehom.errors import FieldError, InternalError
from liehom.scalars import Polynomial

ATTEMPTS = 20


def radical(algebra: LieAlgebra) -> Subalgebra:
    """The solvable radical: the largest solvable ideal.

    Examples
    --------
    >>> import liehom as lh
    >>> radical(lh.euclidean(3)).dimension, radical(lh.gl(3)).dimension
    (3, 1)
    """
    field, n = algebra.field, algebra.dimension
    killing = algebra.killing_form()
    if n == 0 or (field.exact and int(killing.modulo().rank()) == n):
        return Subalgebra(algebra, field.zeros(0, n), check=False)  # Cartan's criterion: semisimple
    whole = field.identity(n)
    derived = products(algebra, whole, whole)
    found = (derived @ killing).null_space() if derived.nrows else whole
    return Subalgebra(algebra, found, check=False)  # the radical is an ideal


def is_semisimple(algebra: LieAlgebra) -> bool:
    """Whether the Killing form is nondegenerate (Cartan's criterion); the zero algebra is semisimple.

    Examples
    --------
    >>> import liehom as lh
    >>> is_semisimple(lh.so(4)), is_semisimple(lh.gl(2))
    (True, False)
    """
    return bool(algebra.killing_form().rank() == algebra.dimension)


def is_solvable(algebra: LieAlgebra) -> bool:
    """Whether the derived series ends in 0: K(g, [g, g]) = 0.

    Examples
    --------
    >>> import liehom as lh
    >>> is_solvable(lh.euclidean(2)), is_solvable(lh.so(3))
    (True, False)
    """
    return radical(algebra).dimension == algebra.dimension


def is_nilpotent(algebra: LieAlgebra) -> bool:
    """Whether the lower central series ends in 0.

    Examples
    --------
    >>> import liehom as lh
    >>> is_nilpotent(lh.heisenberg(2)), is_nilpotent(lh.euclidean(2))
    (True, False)
    """
    return lower_central_series(algebra)[-1].dimension == 0


def nilradical(algebra: LieAlgebra) -> Subalgebra:
    """The nilradical: the largest nilpotent ideal.

    Raises
    ------
    FieldError
        Over float64: whether a matrix is nilpotent is no numerical question.

    Notes
    -----
    It contains [g, rad(g)]. On the composition factors of g the radical acts by weights, and the nilradical is
    the common kernel of these. With s the number of distinct non-zero eigenvalues of ad y, y in rad(g), all
    elements of the nilradical satisfy tr(ad x (ad y)^k) = 0 for k = 1, ..., s; for generic y there are no other
    solutions in rad(g), which is checked: each element of a basis of the solutions must be ad-nilpotent.

    Examples
    --------
    >>> import liehom as lh
    >>> nilradical(lh.euclidean(2)).dimension, nilradical(lh.heisenberg(1)).dimension
    (2, 3)
    """
    field, n = algebra.field, algebra.dimension
    if not field.exact:
        raise FieldError("the nilradical is computed exactly: build the algebra over QQ or a number field")
    solvable = radical(algebra)
    inner = products(algebra, field.identity(n), solvable.basis)
    if inner.nrows == solvable.dimension:
        return Subalgebra(algebra, inner, check=False)  # [g, rad g] is a nilpotent ideal
    outer = _complement(solvable.basis, inner)
    rng = random.Random(n)
    for _ in range(ATTEMPTS):
        kept = _killed_by_weights(algebra, outer, field.matrix([[rng.randint(-9, 9) for _ in range(outer.nrows)]]))
        if all(_is_ad_nilpotent(algebra, kept.select(rows=[i])) for i in range(kept.nrows)):
            rows = field.stack_rows([inner, kept], n).row_space()
            return Subalgebra(algebra, rows, check=False)  # the nilradical is an ideal
    raise InternalError("no element of the radical separates its weights")


def _complement(space: Any, part: Any) -> Any:
    """Rows of `space` that span a complement of the row space `part` in it."""
    field, n = space.field, space.ncols
    joined = field.stack_rows([part, space], n)
    pivots = joined.T.echelon()[1]
    return space.select(rows=[i - part.nrows for i in pivots if i >= part.nrows])


def _killed_by_weights(algebra: LieAlgebra, outer: Any, coefficients: Any) -> Any:
    """The combinations x of rows with tr(ad x (ad y)^k) = 0 for all k >= 1, y the combination given."""
    field = algebra.field
    adjoints = [algebra.ad(outer.select(rows=[i])) for i in range(outer.nrows)]
    y = algebra.ad(coefficients @ outer)
    characteristic = Polynomial(field, y.characteristic_coefficients())  # type: ignore[arg-type]
    distinct = sum(f.degree for f, _ in characteristic.squarefree_parts())
    conditions, power = [], field.identity(algebra.dimension)
    for _ in range(distinct):
        power = power @ y
        conditions.append([(a @ power).trace() for a in adjoints])
    return field.matrix(conditions, (distinct, outer.nrows)).null_space() @ outer


def _is_ad_nilpotent(algebra: LieAlgebra, row: Any) -> bool:
    coefficients = algebra.ad(row).characteristic_coefficients()
    return all(c == 0 for c in coefficients[:-1])
