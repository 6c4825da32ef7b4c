"""The Cartan decomposition g = k + p over the field of the algebra, from a Cartan involution that is proved.

An involution theta is a Cartan involution if it is an automorphism and -K(x, theta y) is positive definite; both are
exact checks.  Candidates come from these sources, in order of cost.

1. Floating point (approximate_involution), because a well-chosen basis gives one with small rational entries.
2. Rotations by pi about an axis, for dimension 3 over the centroid (involution_about_axis).
3. Lattice reduction (rational_involution), nilpotent elements (isotropic_involution) and elements with a compact
   centralizer (elliptic_involution), for each simple ideal in the basis of a large Lie order (lattice_order).
4. Random inner automorphisms of the candidates of lattice reduction.

If the centroid excludes a Cartan involution over the field, no source is tried (involution_obstruction). If a prime
excludes one, the second order and source 4 are not tried (local_obstruction). With `extend`, the default,
sources 1 to 3 are followed by involutions over a larger real number field (extended_involution). Otherwise
`NoRationalInvolutionError` is raised after a proof. If no candidate passes the checks, `UndecidedError` is raised; the
decomposition over float64 always exists.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.base.errors import InputError, NoRationalInvolutionError, UndecidedError
from liehom.base.typing import Array
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.involutions.cartan_involution import (
    approximate_involution,
    numerical_involution,
    orthonormal_frame,
)
from liehom.exact.algebra.involutions.field_involutions import (
    elliptic_elements,
    elliptic_involution,
    extended_involution,
    involution_about_axis,
    involution_about_axis_over_centroid,
    involution_obstruction,
    local_obstruction,
)
from liehom.exact.algebra.involutions.rational_involution import (
    DENOMINATOR,
    isotropic_involution,
    lattice_order,
    rational_involution,
)
from liehom.exact.algebra.structure.ideals import CentroidField, centroid_field, direct_sum_decomposition
from liehom.exact.algebra.structure.root_spaces import cartan_subalgebra, diagonal_weights, simple_roots
from liehom.exact.scalars.exact_field import ExactField, as_exact
from liehom.exact.scalars.field import Field, Matrix, MatrixLike
from liehom.exact.scalars.floating import FloatField
from liehom.exact.scalars.subspaces import Subspace

ROUNDS = 60  # lattice reductions up to dimension `SMALL`; fewer, by the square of the dimension, above it
FEW_ROUNDS = 8  # lattice reductions at least
SMALL = 12
LATTICE_DIMENSION = 60  # dimension up to which orders are computed


@final
@dataclass(frozen=True, slots=True)
class CartanDecomposition:
    """The decomposition g = k + p for a Cartan involution, with k maximal compact and p its Killing complement.

    The involution may be over a larger field than g (``cartan_decomposition(extend=True)``); then k and p are those of
    the algebra ``k.algebra`` over that field.

    Attributes
    ----------
    k : Subalgebra
        The fixed points of theta, a maximal compact subalgebra.
    p : Subspace
        The eigenspace of theta for -1, the complement of k for the Killing form.
    theta : Matrix
        The involution, (n, n), on columns.
    """

    k: Subalgebra
    p: Subspace
    theta: Matrix

    @property
    def field(self) -> Field:
        """The field of theta.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4, 1).cartan_decomposition().field
        QQ
        """
        return self.k.algebra.field

    def __iter__(self) -> Iterator[Any]:
        return iter((self.k, self.p))


def cartan_decomposition(algebra: LieAlgebra, *, extend: bool = True) -> CartanDecomposition:
    """Implements `LieAlgebra.cartan_decomposition`."""
    field, n = algebra.field, algebra.dimension
    killing = algebra.killing_form()
    if not algebra.is_semisimple():
        raise InputError("only a semisimple algebra has a Cartan decomposition; take the Levi factor")
    if n and isinstance(field, FloatField):
        return _decomposed(algebra, field.from_entries(numerical_involution(algebra).T.ravel().tolist(), n, n))
    if killing.signature()[0] == 0:
        return _decomposed(algebra, field.identity(n))
    failure = UndecidedError(
        f"no Cartan involution of {algebra!r} over {field.name} was found, and none was excluded: lattice "
        f"reduction met none of denominator at most {DENOMINATOR}, and nilpotent and elliptic elements gave none; "
        f"cartan_decomposition(extend={not extend}) looks "
        + ("longer for one over the same field" if extend else "for one over a larger real number field")
        + ", and algebra.over(lh.RR).cartan_decomposition() finds one numerically"
    )
    try:
        theta = _rational(algebra, long=not extend)
    except NoRationalInvolutionError as proof:
        theta, failure = None, proof
    if theta is not None:
        return _decomposed(algebra, theta)
    extended = extended_involution(algebra, is_cartan_involution) if extend and isinstance(field, ExactField) else None
    if extended is None:
        raise failure
    return _decomposed(*extended)


def is_cartan_involution(algebra: LieAlgebra, theta: MatrixLike) -> bool:
    """Whether a matrix (n, n), on columns, is a Cartan involution; decided exactly."""
    n, field = algebra.dimension, algebra.field
    candidate: Matrix = field.read(theta, (n, n))
    if candidate.shape != (n, n) or candidate @ candidate != field.identity(n):
        return False
    form = -(algebra.killing_form() @ candidate)
    if form != form.T or not form.is_positive_definite():
        return False
    # an automorphism, which is its own inverse
    return bool(algebra.table.changed(candidate.T, candidate.T) == algebra.table)


def _decomposed(algebra: LieAlgebra, theta: Matrix) -> CartanDecomposition:
    field, n = algebra.field, algebra.dimension
    k, p = (rows.T.row_space() for rows in (field.identity(n) + theta, field.identity(n) - theta))
    # no check: k are the fixed points of an automorphism
    return CartanDecomposition(Subalgebra(algebra, k, check=False), Subspace(field, p, n), theta)


def _rational(algebra: LieAlgebra, *, long: bool = True) -> Matrix | None:
    """A Cartan involution over the field, on columns, or None; `long` adds random automorphisms."""
    n = algebra.dimension
    cartan = cartan_subalgebra(algebra)
    rank, candidate = cartan.dimension, _split_involution(algebra, cartan)
    if candidate is not None and is_cartan_involution(algebra, candidate):
        return candidate
    theta = approximate_involution(algebra, rank)
    candidate = None if theta is None else _searched(algebra, theta, 1)
    if candidate is not None:
        return candidate
    if n == 3:
        return involution_about_axis(algebra)
    ideals = direct_sum_decomposition(algebra)
    centroids = [centroid_field(ideal) for ideal in ideals]
    _not_excluded(algebra, centroids)  # before any search; a sum has no Cartan involution if an ideal has none
    if len(ideals) > 1:
        return _of_ideals(algebra, ideals, long)
    (centroid,) = centroids
    if n == 3 * centroid.degree and theta is not None and centroid.polynomial.count_real_roots() == centroid.degree:
        candidate = involution_about_axis_over_centroid(centroid, theta)
    elif theta is not None and algebra.field.degree == 1:
        candidate = isotropic_involution(algebra, theta)
    if candidate is not None and is_cartan_involution(algebra, candidate):
        return candidate
    return _in_a_large_order(algebra, rank, theta, long)


def _split_involution(algebra: LieAlgebra, cartan: Subalgebra) -> Matrix | None:
    """The involution e_i -> -f_i, f_i -> -e_i, on columns, in a basis of root vectors; None in other bases."""
    torus, n = as_exact(cartan.basis), algebra.dimension
    field, weights = torus.field, diagonal_weights(algebra, torus)
    place = {} if weights is None else {w: field.unit(n, j) for j, w in enumerate(weights) if any(w)}
    if weights is None or len(place) + torus.nrows != n:
        return None
    simple = [list(place)[i] for i in simple_roots(field.matrix(list(place)))]
    up, down, raise_, lower = {}, {}, {}, {}
    for a in simple:
        e, f = place[a], place[tuple(-x for x in a)]
        image = e @ algebra.ad(f @ algebra.ad(e).T).T  # [[e, f], e] = alpha([e, f]) e
        f = f.scale(2 / next(x for x in image.row(0) if x != 0))
        up[a], down[a] = -e, f
        raise_[a], lower[a] = algebra.ad(e).T, algebra.ad(-f).T
    frontier = simple
    while frontier:
        new = {}
        for b in frontier:
            for a in simple:
                c = tuple(x + y for x, y in zip(a, b, strict=True))
                if c in place and c not in up:
                    up[c], down[c], new[c] = up[b] @ raise_[a], down[b] @ lower[a], c
        frontier = list(new)
    rows = field.stack_rows([torus, *up.values(), *down.values()], n)
    return (rows.inverse() @ field.stack_rows([-torus, *down.values(), *up.values()], n)).T


def _constructed(algebra: LieAlgebra, theta: Array) -> Matrix | None:
    """A Cartan involution over the field from nilpotent or elliptic elements, on columns, or None."""
    candidate = isotropic_involution(algebra, theta) if algebra.field.degree == 1 else None
    if candidate is not None and is_cartan_involution(algebra, candidate):
        return candidate
    for element in elliptic_elements(algebra, theta)[-1:]:
        elliptic = elliptic_involution(algebra, element, 1)
        if elliptic is not None and is_cartan_involution(algebra, elliptic[1]):
            return elliptic[1]
    return None


def _not_excluded(algebra: LieAlgebra, centroids: list[CentroidField]) -> None:
    """Raise `NoRationalInvolutionError` if the centroid of a simple ideal excludes a Cartan involution."""
    for centroid in centroids:
        if (reason := involution_obstruction(centroid)) is not None:
            raise _excluded(algebra, centroid.algebra, reason)


def _excluded(algebra: LieAlgebra, ideal: LieAlgebra, reason: str) -> NoRationalInvolutionError:
    return NoRationalInvolutionError(
        reason,
        f"{algebra!r} has no Cartan involution with entries in {algebra.field.name}, by proof: for a simple ideal of "
        f"dimension {ideal.dimension}, {reason}; over the reals there is one: extend=True looks for it over fields of "
        "small degree, and algebra.over(lh.RR).cartan_decomposition() finds it numerically",
    )


def _of_ideals(algebra: LieAlgebra, ideals: list[Subalgebra], long: bool) -> Matrix | None:
    """The Cartan involution that combines Cartan involutions of the ideals, or None if one is missing."""
    field, n = algebra.field, algebra.dimension
    basis = field.stack_rows([ideal.basis for ideal in ideals], n)
    blocks = []
    for ideal in ideals:
        inner = ideal.as_algebra()
        compact = inner.killing_form().signature()[0] == 0
        theta: Matrix | None = field.identity(ideal.dimension) if compact else _rational(inner, long=long)
        if theta is None:
            return None
        blocks.append(ideal.basis.T @ theta)
    return field.stack_columns(blocks, n) @ basis.T.inverse()


def _in_a_large_order(algebra: LieAlgebra, rank: int, theta: Array | None, long: bool) -> Matrix | None:
    """A Cartan involution, on columns, by searches in the bases of large orders, or None; `theta` is numerical."""
    field, n = algebra.field, algebra.dimension
    basis, current = field.identity(n), algebra
    # Over number fields Z^n is not a canonical lattice, so orders in it rarely help.
    orders = (False, True) if field.degree == 1 and n <= LATTICE_DIMENSION else ()
    for thorough in orders:  # most algebras are done before the second order, which costs more
        frame = np.eye(n) if theta is None else orthonormal_frame(current, theta)
        basis = lattice_order(current, frame, thorough=thorough) @ basis
        current = algebra.change_of_basis(basis)
        theta = approximate_involution(current, rank)  # more accurate when it is computed in this basis
        if theta is not None:
            exact = _searched(current, theta, 1)
            exact = _constructed(current, theta) if exact is None else exact
            if exact is not None:
                return basis.T @ exact @ basis.T.inverse()
        if not thorough and (reason := local_obstruction(current)) is not None:
            raise _excluded(algebra, algebra, reason)
    rounds = max(FEW_ROUNDS, ROUNDS * SMALL**2 // max(n, SMALL) ** 2) if orders else FEW_ROUNDS
    exact = _searched(current, theta, rounds) if long and theta is not None else None
    return None if exact is None else basis.T @ exact @ basis.T.inverse()


def _searched(algebra: LieAlgebra, theta: Array, rounds: int) -> Matrix | None:
    """A Cartan involution over the field by lattice reduction, on columns, or None; `theta` is numerical."""
    return rational_involution(algebra, theta, lambda candidate: is_cartan_involution(algebra, candidate), rounds)
