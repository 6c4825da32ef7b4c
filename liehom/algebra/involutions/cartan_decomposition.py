"""The Cartan decomposition g = k + p over the field of the algebra, from a Cartan involution that is proved.

An involution theta is a Cartan involution if it is an automorphism and -K(x, theta y) is positive definite; both are
exact checks.  Candidates come from floating point (approximate_involution): in a basis that suits the algebra the best
Cartan involution has small rational entries.  In another basis dimension 3 (over the centroid) is solved directly
(half_turn), simple ideals are taken one by one, and each is first brought to a basis of a large Lie order (lie_order),
where lattice reduction looks for one (rational_involution); where there are nilpotent elements one is constructed
(isotropic_involution), and else random moves lead to others.  Where the centroid excludes one
`NoRationalInvolutionError` is raised before any search (involution_obstruction); where no candidate passes the checks
there may be none: then `UndecidedError` says so, and the decomposition over float64 is at hand.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.involutions.approximate_involution import approximate_involution, numerical_involution
from liehom.algebra.involutions.involution_about_axis import half_turn, half_turn_over_centroid
from liehom.algebra.involutions.involution_obstruction import involution_obstruction
from liehom.algebra.involutions.isotropic_involution import isotropic_involution
from liehom.algebra.involutions.lattice_order import lie_order
from liehom.algebra.involutions.rational_involution import DENOMINATOR, rational_involution
from liehom.algebra.structure.cartan_subalgebra import cartan_subalgebra
from liehom.algebra.structure.direct_sum_decomposition import direct_sum_decomposition
from liehom.algebra.structure.real_splitting import CentroidField, centroid_field
from liehom.errors import InputError, NoRationalInvolutionError, UndecidedError
from liehom.scalars import FloatField, Subspace

ROUNDS = 60
FEW_ROUNDS = 8
SMALL = 12
LATTICE_DIMENSION = 60


@final
@dataclass(frozen=True, slots=True)
class CartanDecomposition:
    """g = k + p for a Cartan involution: k is a maximal compact subalgebra, p its complement for the Killing form.

    Attributes
    ----------
    k : Subalgebra
        The fixed points of theta.
    p : Subspace
        Where theta is -1.
    theta : Matrix
        The involution, (n, n), on columns.
    """

    k: Subalgebra
    p: Subspace
    theta: Any

    def __iter__(self) -> Any:
        return iter((self.k, self.p))


def cartan_decomposition(algebra: LieAlgebra) -> CartanDecomposition:
    """Implements `LieAlgebra.cartan_decomposition`."""
    field, n = algebra.field, algebra.dimension
    killing = algebra.killing_form()
    if killing.rank() < n:
        raise InputError("a Cartan decomposition is that of a semisimple algebra; take the Levi factor")
    if n and isinstance(field, FloatField):
        return _decomposed(algebra, field.from_entries(numerical_involution(algebra).T.ravel().tolist(), n, n))
    theta = field.identity(n) if killing.signature()[0] == 0 else _rational(algebra)
    if theta is None:
        raise UndecidedError(
            f"no Cartan involution of {algebra!r} over {field.name} was found, and none was excluded: lattice "
            f"reduction met none of denominator at most {DENOMINATOR}, and nilpotent elements gave none; "
            "algebra.over(lh.RR).cartan_decomposition() finds one numerically"
        )
    return _decomposed(algebra, theta)


def is_cartan_involution(algebra: LieAlgebra, theta: Any) -> bool:
    """Whether a matrix (n, n), on columns, is a Cartan involution; decided exactly.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.so(3)
    >>> is_cartan_involution(g, g.field.identity(3)), is_cartan_involution(lh.sl(2), g.field.identity(3))
    (True, False)
    """
    n, field = algebra.dimension, algebra.field
    theta = field.read(theta, (n, n))
    if theta.shape != (n, n) or theta @ theta != field.identity(n):
        return False
    form = -(algebra.killing_form() @ theta)
    if form != form.T or not form.is_positive_definite():
        return False
    return bool(algebra.table.changed(theta.T, theta.T) == algebra.table)  # an automorphism, and its own inverse


def _decomposed(algebra: LieAlgebra, theta: Any) -> CartanDecomposition:
    field, n = algebra.field, algebra.dimension
    one = field.identity(n)
    k = (one + theta).T.row_space()
    p = (one - theta).T.row_space()
    # The fixed points of an automorphism.
    return CartanDecomposition(Subalgebra(algebra, k, check=False), Subspace(field, p, n), theta)


def _rational(algebra: LieAlgebra) -> Any:
    """A Cartan involution over the field, on columns, or None."""
    n = algebra.dimension
    rank = cartan_subalgebra(algebra).dimension
    theta = approximate_involution(algebra, rank)
    found = None if theta is None else _searched(algebra, theta, 1)
    if found is not None:
        return found
    if n == 3:
        return half_turn(algebra)
    ideals = direct_sum_decomposition(algebra)
    centres = [centroid_field(ideal) for ideal in ideals]
    _not_excluded(algebra, centres)  # before any search: what excludes it for an ideal does so for the sum
    if len(ideals) > 1:
        return _of_ideals(algebra, ideals)
    (centre,) = centres
    if n == 3 * centre.degree and theta is not None and centre.polynomial.count_real_roots() == centre.degree:
        found = half_turn_over_centroid(centre, theta)
    elif theta is not None and algebra.field.degree == 1:
        found = isotropic_involution(algebra, theta)
    if found is not None and is_cartan_involution(algebra, found):
        return found
    return _in_a_suitable_lattice(algebra, rank, theta)


def _constructed(algebra: LieAlgebra, theta: Any) -> Any:
    """Theta over the field from nilpotent elements, on columns, or None; `theta` is numerical."""
    candidate = isotropic_involution(algebra, theta) if algebra.field.degree == 1 else None
    return candidate if candidate is not None and is_cartan_involution(algebra, candidate) else None


def _not_excluded(algebra: LieAlgebra, centres: list[CentroidField]) -> None:
    for centre in centres:
        reason = involution_obstruction(centre)
        if reason is not None:
            raise NoRationalInvolutionError(
                reason,
                f"{algebra!r} has no Cartan involution with entries in {algebra.field.name}, by proof: for a simple "
                f"ideal of dimension {centre.algebra.dimension}, {reason}; over the reals there is one, and "
                "algebra.over(lh.RR).cartan_decomposition() finds it numerically",
            )


def _of_ideals(algebra: LieAlgebra, ideals: list[Subalgebra]) -> Any:
    """Theta from those of the ideals, or None."""
    field, n = algebra.field, algebra.dimension
    basis = field.stack_rows([ideal.basis for ideal in ideals], n)
    blocks = []
    for ideal in ideals:
        inner = ideal.as_algebra()
        killing = inner.killing_form()
        one = field.identity(ideal.dimension)
        theta = one if killing.signature()[0] == 0 else _rational(inner)
        if theta is None:
            return None
        blocks.append(ideal.basis.T @ theta)
    return field.stack_columns(blocks, n) @ basis.T.inverse()


def _in_a_suitable_lattice(algebra: LieAlgebra, rank: int, theta: Any) -> Any:
    """Theta over the field, on columns, found in the basis of a large order, or None; `theta` is numerical."""
    field, n = algebra.field, algebra.dimension
    basis, current = field.identity(n), algebra
    # Over number fields Z^n is no canonical lattice: little hope.
    orders = (False, True) if field.degree == 1 and n <= LATTICE_DIMENSION else ()
    for thorough in orders:  # most algebras are done before the second order, which costs more
        frame = np.eye(n) if theta is None else _factor(-current.killing_form().to_numpy() @ theta.T)
        basis = lie_order(current, frame, thorough=thorough) @ basis
        current = algebra.change_of_basis(basis)
        theta = approximate_involution(current, rank)  # afresh: more accurate in this basis
        found = None if theta is None else _searched(current, theta, 1)
        if found is None and theta is not None:
            found = _constructed(current, theta)
        if found is not None:
            return basis.T @ found @ basis.T.inverse()
    rounds = max(FEW_ROUNDS, ROUNDS * SMALL**2 // max(n, SMALL) ** 2) if orders else FEW_ROUNDS
    found = None if theta is None else _searched(current, theta, rounds)
    return None if found is None else basis.T @ found @ basis.T.inverse()


def _searched(algebra: LieAlgebra, theta: Any, rounds: int) -> Any:
    """Theta over the field by lattice reduction, on columns, or None; `theta` is numerical."""
    return rational_involution(algebra, theta, lambda candidate: is_cartan_involution(algebra, candidate), rounds)


def _factor(form: Any) -> Any:
    return np.linalg.cholesky((form + form.T) / 2)
