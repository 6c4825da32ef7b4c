"""The solvable radical and the nilradical.

    rad(g) = {x : K(x, [g, g]) = 0},    nil(g) = {x in rad(g) : ad x is nilpotent},

with K the Killing form (Cartan's criterion; Jacobson, Lie Algebras, chapters II and III).  Both formulas hold in
characteristic 0.
"""

from __future__ import annotations

import random
from typing import Any

import numpy as np

from liehom.algebra.core.balancing import balanced
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra, complement_rows, products
from liehom.algebra.structure.exact_field import exact_field
from liehom.errors import InternalError
from liehom.scalars import ExactMatrix, FloatMatrix, Polynomial, as_exact

ATTEMPTS = 20  # random elements of the radical


def radical(algebra: LieAlgebra) -> Subalgebra:
    """Implements `LieAlgebra.radical`."""
    field, n = algebra.field, algebra.dimension
    if not field.exact:
        return _over_floats(algebra)
    killing = algebra.killing_form()
    if n == 0 or (isinstance(killing, ExactMatrix) and int(killing.modulo().rank()) == n):
        return Subalgebra(algebra, field.zeros(0, n), check=False)  # Cartan's criterion: semisimple
    whole = field.identity(n)
    derived = products(algebra, whole, whole)
    found = (derived @ killing).null_space() if derived.nrows else whole
    return Subalgebra(algebra, found, check=False)  # the radical is an ideal


def _over_floats(algebra: LieAlgebra) -> Subalgebra:
    """The radical over floats, in a basis in which the structure constants have similar sizes."""
    field, n, question = algebra.field, algebra.dimension, "the dimension of the radical"
    if algebra.is_semisimple():
        return Subalgebra(algebra, field.zeros(0, n), check=False)
    table, lengths = balanced(algebra.table)
    inner = LieAlgebra(table, check=False)  # a basis of the same algebra
    whole = field.identity(n)
    derived = products(inner, whole, whole)
    if not derived.nrows:
        return Subalgebra(algebra, whole, check=False)
    found: Any = (derived @ inner.killing_form()).null_space(question)
    back = (found @ FloatMatrix(found.field, np.diag(lengths), 0.0)).row_space(question)
    return Subalgebra(algebra, back, check=False)  # the radical is an ideal


def nilradical(algebra: LieAlgebra) -> Subalgebra:
    """Implements `LieAlgebra.nilradical`."""
    field, n = exact_field(algebra, "nilradicals"), algebra.dimension
    solvable = radical(algebra)
    basis = as_exact(solvable.basis)
    inner = products(algebra, field.identity(n), basis)
    if inner.nrows == solvable.dimension:
        return Subalgebra(algebra, inner, check=False)  # [g, rad g] is a nilpotent ideal
    outer = complement_rows(basis, inner)
    rng = random.Random(n)
    for _ in range(ATTEMPTS):
        kept = _annihilated_by_weights(algebra, outer, field.matrix([[rng.randint(-9, 9) for _ in range(outer.nrows)]]))
        if all(_is_ad_nilpotent(algebra, kept.select(rows=[i])) for i in range(kept.nrows)):
            rows = field.stack_rows([inner, kept], n).row_space()
            return Subalgebra(algebra, rows, check=False)  # the nilradical is an ideal
    raise InternalError("no element of the radical separates its weights")


def _annihilated_by_weights(algebra: LieAlgebra, outer: ExactMatrix, coefficients: ExactMatrix) -> ExactMatrix:
    """The combinations x of rows with tr(ad x (ad y)^k) = 0 for all k >= 1, for one combination y with coefficients."""
    field = outer.field
    adjoints = [algebra.ad(outer.select(rows=[i])) for i in range(outer.nrows)]
    y = algebra.ad(coefficients @ outer)
    characteristic = Polynomial(field, y.characteristic_coefficients())
    distinct = sum(f.degree for f, _ in characteristic.squarefree_parts())
    conditions, power = [], field.identity(algebra.dimension)
    for _ in range(distinct):
        power = power @ y
        conditions.append([(a @ power).trace() for a in adjoints])
    return field.matrix(conditions, (distinct, outer.nrows)).null_space() @ outer


def _is_ad_nilpotent(algebra: LieAlgebra, row: ExactMatrix) -> bool:
    coefficients = algebra.ad(row).characteristic_coefficients()
    return all(c == 0 for c in coefficients[:-1])
