"""Cartan involutions over a real number field that is larger than the field of the algebra.

Each simple ideal is put in the basis of a large order.  Elements with a compact centralizer (elliptic_involution) and
elements whose eigenvalues are real (hyperbolic_involution) give involutions over fields of small degree.  The fields of
the ideals are joined.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.involutions.approximate_involution import approximate_involution, orthonormal_frame
from liehom.algebra.involutions.elliptic_involution import elliptic_elements, elliptic_involution
from liehom.algebra.involutions.hyperbolic_involution import hyperbolic_involution
from liehom.algebra.involutions.lattice_order import lattice_order
from liehom.algebra.structure.cartan_subalgebra import cartan_subalgebra
from liehom.algebra.structure.direct_sum_decomposition import direct_sum_decomposition
from liehom.algebra.structure.real_splitting import over_extension
from liehom.errors import InternalError
from liehom.scalars import ExactMatrix, Polynomial, as_exact
from liehom.scalars.roots.extension import Extension, adjoin_root, real_roots, trivial_extension
from liehom.typing import Array

DEGREE = 6  # largest degree, over the field of the algebra, of the field for one ideal
ELEMENTS = 3  # elliptic elements, the best ones, for which larger fields are tried
BITS = 128  # precision of the roots of polynomials of generators

Proof = Callable[[LieAlgebra, ExactMatrix], bool]
"""Whether a matrix, on columns, is proved to be a Cartan involution of an algebra."""


def extended_involution(algebra: LieAlgebra, proved: Proof) -> tuple[LieAlgebra, ExactMatrix] | None:
    """The algebra over a larger field and a Cartan involution of it, (n, n) on columns, or None.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.involutions.cartan_decomposition import is_cartan_involution
    >>> g, theta = extended_involution(lh.so(4, 1), is_cartan_involution)
    >>> g.field, is_cartan_involution(g, theta)
    (QQ, True)
    """
    n, field = algebra.dimension, as_exact(algebra.killing_form()).field
    whole, basis, images = trivial_extension(field), field.zeros(0, n), field.zeros(0, n)
    for ideal in direct_sum_decomposition(algebra):
        found = _of_ideal(ideal.as_algebra(), proved)
        if found is None:
            return None
        up, theta = found
        before, after = _joined(whole, up)
        whole = whole.then(before)
        rows = whole.matrix(as_exact(ideal.basis))
        basis = whole.field.stack_rows([before.matrix(basis), rows], n)
        images = whole.field.stack_rows([before.matrix(images), after.matrix(theta).T @ rows], n)
    combined, larger = (basis.inverse() @ images).T, over_extension(algebra, whole)
    return (larger, combined) if proved(larger, combined) else None


def _of_ideal(algebra: LieAlgebra, proved: Proof) -> tuple[Extension, ExactMatrix] | None:
    """An extension and a Cartan involution over it, on columns, of a simple algebra, or None."""
    n, field = algebra.dimension, as_exact(algebra.killing_form()).field
    if algebra.killing_form().signature()[0] == 0:
        return trivial_extension(field), field.identity(n)
    rank = cartan_subalgebra(algebra).dimension
    theta = approximate_involution(algebra, rank)
    if field.degree == 1:
        frame = np.eye(n) if theta is None else orthonormal_frame(algebra, theta)
        basis = lattice_order(algebra, frame, thorough=False)
        current = algebra.change_of_basis(basis)
        theta = approximate_involution(current, rank)
    else:
        basis, current = field.identity(n), algebra
    if theta is None:
        return None
    for up, candidate in _candidates(current, theta):
        if proved(over_extension(current, up), candidate):
            change = up.matrix(basis)
            return up, change.T @ candidate @ change.T.inverse()
    return None


def _candidates(algebra: LieAlgebra, theta: Array) -> list[tuple[Extension, ExactMatrix]]:
    """Extensions and maps that may be Cartan involutions over them, those over small fields first."""
    found = [elliptic_involution(algebra, x, DEGREE) for x in elliptic_elements(algebra, theta)[-ELEMENTS:]]
    made = [entry for entry in (*found, hyperbolic_involution(algebra, theta, DEGREE)) if entry is not None]
    return sorted(made, key=lambda entry: entry[0].field.degree)


def _joined(first: Extension, second: Extension) -> tuple[Extension, Extension]:
    """Two extensions of one field in a field that contains both, as extensions of these two fields."""
    small, field = second.field, first.field
    if second.is_trivial:
        return trivial_extension(field), first
    modulus = Polynomial(field, small.modulus_coefficients())
    generator = trivial_extension(small).powers[1]
    near = float(small.to_float(generator))
    choices = [
        (abs(float(root.mid()) - near), f, index)
        for f, _ in modulus.factor()
        for index, root in enumerate(real_roots(f, BITS))
    ]
    if not choices:
        raise InternalError("a real field has no real generator")
    _, f, index = min(choices, key=lambda choice: choice[0])
    before, root = adjoin_root(f, index)
    powers = tuple(root**i if i else before.field.one for i in range(small.degree))
    return before, Extension(small, before.field, powers)
