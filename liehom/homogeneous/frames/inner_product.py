"""The inner product on g for minimal norms: an Ad-invariant one if there is one.

On a compact algebra -tr(rho(x) rho(y)) is Ad-invariant and positive definite; so is minus the Killing form B plus any
inner product on the centre.  For matrices closed under transposition, tr(rho(x)^T rho(y)) is the trace form of x and
-theta y with the Cartan involution theta(x) = -x^T; it is invariant under the maximal compact subgroup.  If rho does
not show the involution, the inner product is -B(x, theta y) with theta from the defining matrices.  Otherwise it is the
product of coefficients in the given basis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.algebra import LieAlgebra
from liehom.errors import InputError
from liehom.representations import Representation, defining
from liehom.representations.core.copies import copies_of
from liehom.scalars import Matrix
from liehom.typing import Array

RTOL = 1e-9


@final
@dataclass(frozen=True, slots=True)
class InnerProduct:
    """A positive definite form on g.

    Attributes
    ----------
    matrix : array of shape (dim, dim)
        The Gram matrix in the basis of g.
    name : str
        The formula, printed in the report of a corrector.
    invariant : bool
        Whether the form is Ad-invariant: <[x, y], z> + <y, [x, z]> = 0.

    Examples
    --------
    >>> import liehom as lh
    >>> inner_product(lh.defining(lh.so(3))).name
    '-tr(rho(x) rho(y)), Ad-invariant'
    """

    matrix: Array
    name: str
    invariant: bool

    def orthonormal_basis(self) -> Array:
        """The matrix, shape (dim, dim), whose columns are an orthonormal basis of g.

        Examples
        --------
        >>> import liehom as lh
        >>> product = inner_product(lh.defining(lh.sl(2)))
        >>> basis = product.orthonormal_basis()
        >>> bool(np.allclose(basis.T @ product.matrix @ basis, np.eye(3)))
        True
        """
        made: Array = np.linalg.inv(np.linalg.cholesky(self.matrix)).T
        return made


def inner_product(representation: Representation) -> InnerProduct:
    """The inner product on g in which correctors minimize norms; Ad-invariant if g has such an inner product.

    Parameters
    ----------
    representation : Representation

    Notes
    -----
    The first positive definite form in this list is chosen: -tr(rho(x) rho(y)); minus the Killing form B, plus the
    coefficients on the centre if g is reductive; tr(rho(x)^T rho(y)) if the matrices are closed under transposition;
    -B(x, theta y) with the Cartan involution theta of the defining matrices; the coefficients in the given basis.
    Positive definiteness is decided numerically, after scaling the diagonal to 1. Ad-invariance is checked on the
    bracket.

    Examples
    --------
    >>> import liehom as lh
    >>> inner_product(lh.defining(lh.so(3, 1))).name
    'tr(rho(x)^T rho(y)) = -tr(rho(x) rho(theta y)), theta = minus transpose'
    >>> inner_product(lh.adjoint(lh.u(2))).name
    'minus the Killing form, plus the coefficients on the centre, Ad-invariant'
    >>> inner_product(lh.trivial(lh.abelian(2))).name
    'coefficients in the given basis, Ad-invariant'
    """
    algebra = representation.algebra
    n = algebra.dimension
    copies = copies_of(representation)
    if copies is not None:
        single = inner_product(copies.single)
        form: Array = np.kron(np.eye(copies.copies), single.matrix).astype(np.float64)
        return InnerProduct(form, single.name, single.invariant)
    flat, turned = _rows(representation)
    trace = -flat @ turned.T
    if _is_positive(trace):
        return _made(algebra, trace, "-tr(rho(x) rho(y))")
    killing = np.asarray(algebra.killing_form().to_numpy()).reshape(n, n)
    if not (np.isfinite(flat).all() and np.isfinite(killing).all()):
        raise InputError("the matrices have numbers beyond the range of floats; scale them before integrating")
    if _is_positive(-killing):
        return _made(algebra, -killing, "minus the Killing form")
    centre = _coefficients_on_the_centre(algebra) if _is_semidefinite(-killing) else None
    if centre is not None and _is_positive(centre - killing):
        return _made(algebra, centre - killing, "minus the Killing form, plus the coefficients on the centre")
    if _is_positive(flat @ flat.T) and _contains(flat, turned):
        return _made(algebra, flat @ flat.T, "tr(rho(x)^T rho(y)) = -tr(rho(x) rho(theta y)), theta = minus transpose")
    conjugate = _by_the_defining_representation(algebra, killing)
    if conjugate is not None:
        return _made(
            algebra, conjugate, "-B(x, theta y), B the Killing form, theta = minus transpose in the defining matrices"
        )
    return _made(algebra, np.eye(n), "coefficients in the given basis")


def exact_gram_matrix(representation: Representation) -> Matrix:
    """The Gram matrix of the inner product on g over the field of the representation.

    The candidates of `inner_product` are tried, except those with a centre or a defining representation.

    Examples
    --------
    >>> import liehom as lh
    >>> print(exact_gram_matrix(lh.defining(lh.so(2))))
    [2]
    """
    field, n = representation.field, representation.algebra.dimension
    size = representation.size**2
    flat: Matrix = field.stack_rows([a.reshape(1, size) for a in representation.matrices], size)
    turned: Matrix = field.stack_rows([a.T.reshape(1, size) for a in representation.matrices], size)
    trace: Matrix = -(flat @ turned.T)
    if trace.is_positive_definite():
        return trace
    killing: Matrix = -representation.algebra.killing_form()
    if killing.is_positive_definite():
        return killing
    product: Matrix = flat @ flat.T
    if product.is_positive_definite() and field.stack_rows([flat, turned], size).rank() == flat.rank():
        return product
    identity: Matrix = field.identity(n)
    return identity


def _made(algebra: LieAlgebra, form: Array, name: str) -> InnerProduct:
    form = (form + form.T) / 2
    invariant = _is_invariant(algebra, form)
    return InnerProduct(form, name + ", Ad-invariant" * invariant, invariant)


def _rows(representation: Representation) -> tuple[Array, Array]:
    """The matrices rho(e_i) and their transposes as rows."""
    n, size = representation.algebra.dimension, representation.size
    a = np.array([m.to_numpy() for m in representation.matrices]).reshape(n, size, size)
    return a.reshape(n, size * size), np.swapaxes(a, -1, -2).reshape(n, size * size)


def _is_invariant(algebra: LieAlgebra, form: Array) -> bool:
    """Whether <[x, y], z> + <y, [x, z]> = 0 on the basis, to round-off."""
    n = algebra.dimension
    bracket = np.zeros((n, n, n))
    for i, j, k, value in algebra.structure_constants():
        bracket[i, j, k] = algebra.field.to_float(value)
        bracket[j, i, k] = -bracket[i, j, k]
    scale = 1 / np.sqrt(np.diagonal(form))
    lowered = scale[:, None, None] * scale[:, None] * scale * (bracket @ form)  # of basis elements of length 1
    defect = np.abs(lowered + np.swapaxes(lowered, 1, 2)).max(initial=0.0)
    return bool(defect <= RTOL * np.abs(lowered).max(initial=0.0))


def _is_positive(form: Array) -> bool:
    """Whether a symmetric form is positive definite, whatever the lengths of the basis elements."""
    if form.size == 0:
        return True
    diagonal = np.diagonal(form)
    if not bool(np.all(diagonal > 0)):
        return False
    scale = 1 / np.sqrt(diagonal)
    values = np.linalg.eigvalsh(scale[:, None] * (form + form.T) / 2 * scale)
    return bool(values[0] > RTOL * abs(values[-1]))


def _is_semidefinite(form: Array) -> bool:
    """Whether a symmetric form has no negative eigenvalue."""
    values = np.linalg.eigvalsh((form + form.T) / 2)
    return bool(values[0] >= -RTOL * np.abs(values).max())


def _contains(rows: Array, others: Array) -> bool:
    """Whether the span of the rows contains the others."""
    if rows.size == 0:
        return True
    found = np.linalg.lstsq(rows.T, others.T, rcond=None)[0]
    return bool(np.abs(rows.T @ found - others.T).max(initial=0.0) <= RTOL * np.abs(rows).max(initial=1.0))


def _coefficients_on_the_centre(algebra: LieAlgebra) -> Array | None:
    """The form <Px, Py> with P the projector on the centre along [g, g], if g is their direct sum and neither is 0."""
    n = algebra.dimension
    centre, derived = algebra.center(), algebra.derived_series()[-1]  # of a reductive algebra it is [g, g]
    if not 0 < centre.dimension < n or centre.dimension + derived.dimension != n:
        return None
    rows = np.concatenate([centre.basis.to_numpy(), derived.basis.to_numpy()])
    if not np.linalg.cond(rows) < 1 / RTOL:
        return None
    # y = rows^T c, and the first entries of c are the coordinates on the centre
    coordinates = np.linalg.inv(rows.T)[: centre.dimension]
    projector = rows[: centre.dimension].T @ coordinates
    form: Array = projector.T @ projector
    return form


def _by_the_defining_representation(algebra: LieAlgebra, killing: Array) -> Array | None:
    """The form -B(x, theta y) with theta(x) = -D(x)^T for the standard matrices D of a semisimple algebra."""
    try:
        flat, turned = _rows(defining(algebra))
    except InputError:
        return None
    if not _contains(flat, turned):
        return None
    theta = -np.linalg.lstsq(flat.T, turned.T, rcond=None)[0]
    form: Array = -killing @ theta
    return form if _is_positive(form) and np.allclose(form, form.T, rtol=0, atol=RTOL * np.abs(form).max()) else None
