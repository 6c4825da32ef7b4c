"""Pairs of a classical algebra or G2 and a subalgebra that acts irreducibly, from modules with rational matrices.

Let h act irreducibly on V. If it preserves bilinear forms, the stabilizer g of all of them is so(p,q), sp(2n,R),
sp(p,q), so*(2n) or a complex algebra, according to the commutant. For h of type A1 on R^7, the stabilizer of the
invariant trilinear form is g2 or g2(2). Everything is linear algebra over QQ.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liehom.algebra import Subalgebra
from liehom.algebra.matrices import exterior_power
from liehom.algebra.matrices.named_matrices import classical_matrices, linear_lie_algebra
from liehom.catalog.linear import linear_matrices
from liehom.catalog.names import parse_expression
from liehom.catalog.subalgebras import coordinates, preserving
from liehom.errors import InputError
from liehom.representations import Pair, real_module
from liehom.representations.invariants.intertwiners import invariant_forms, invariant_vectors
from liehom.scalars import QQ, ExactMatrix, as_exact
from liehom.typing import IntegerArray


def module_pair(name: str, form: str, weight: tuple[int, ...]) -> Pair:
    """The pair of the stabilizer of the invariant bilinear forms of an irreducible real module, and the algebra on it.

    Parameters
    ----------
    name : str
        The name G/H of the pair.
    form : str
        The name of a simple real algebra.
    weight : tuple of int
        The highest weight of the module, as in `liehom.real_module`.

    Raises
    ------
    InputError
        If the module has no invariant bilinear form.

    Examples
    --------
    >>> module_pair("so(3,2)/sl(2)_irr", "sl(2,R)", (4,)).algebra.real_form()
    'so(3,2)'
    """
    return _stabilizer_of_forms(name, _matrices_of_module(form, weight))


def linear_pair(name: str, linear: str) -> Pair:
    """The pair of the stabilizer of the invariant bilinear forms of a linear Lie algebra of the catalogue, and itself.

    Examples
    --------
    >>> linear_pair("sp(6,R)/tensor(sp(2,R),so(2,1))", "tensor(sp(2,R),so(2,1))").dimension
    15
    """
    return _stabilizer_of_forms(name, linear_matrices(parse_expression(linear)))


def cross_product_pair(name: str, form: str, weight: tuple[int, ...]) -> Pair:
    """The pair of the stabilizer of the invariant trilinear form of a module of dimension 7, and the algebra on it.

    Examples
    --------
    >>> cross_product_pair("g2/so(3)_irr", "so(3)", (6,)).algebra.real_form()
    'g2'
    """
    matrices = _matrices_of_module(form, weight)
    cubes = [_exact(x) for x in exterior_power(matrices, 3)]
    (invariant,) = invariant_vectors(cubes, cubes[0].nrows, QQ).basis.to_rows()
    (point,) = _integral([QQ.matrix([invariant])])
    whole = classical_matrices("gl", matrices.shape[1], "R")
    rows = preserving(exterior_power(whole, 3), points=[point.ravel()])
    return _of_matrices(name, np.tensordot(rows, whole, 1), matrices)


def _stabilizer_of_forms(name: str, matrices: IntegerArray) -> Pair:
    size = matrices.shape[1]
    forms = invariant_forms([_exact(x) for x in matrices], size, QQ)
    found = _integral([*forms.symmetric, *forms.skew])
    if not found:
        raise InputError(f"the module of {name} has no invariant bilinear form")
    whole = classical_matrices("gl", size, "R")
    return _of_matrices(name, np.tensordot(preserving(whole, forms=found), whole, 1), matrices)


def _of_matrices(name: str, whole: IntegerArray, part: IntegerArray) -> Pair:
    """The pair of two Lie algebras of matrices."""
    algebra = linear_lie_algebra(whole, name.partition("/")[0])
    rows = coordinates(whole, part)
    if rows is None:
        raise InputError(f"the second factor of {name} is not in the first")
    return Pair(algebra, Subalgebra(algebra, QQ.from_integers(rows.ravel().tolist(), *rows.shape)), name=name)


def _matrices_of_module(form: str, weight: tuple[int, ...]) -> IntegerArray:
    matrices = real_module(form, weight).representation.matrices
    return np.array(_integral([as_exact(x) for x in matrices]))


def _exact(matrix: IntegerArray) -> ExactMatrix:
    return QQ.from_integers(matrix.ravel().tolist(), *matrix.shape)


def _integral(matrices: Sequence[ExactMatrix]) -> list[IntegerArray]:
    """Positive integer multiples of rational matrices."""
    return [
        np.array([int(x) for x in m.parts[0].entries()], dtype=np.int64).reshape(m.shape)
        for m in (m.primitive() for m in matrices)
    ]
