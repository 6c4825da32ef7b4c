"""Frames of isotropy and tangent directions, and the inner product on g for minimal norms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, final

import numpy as np

from liehom.base.errors import InputError
from liehom.base.typing import Array, Real, Values
from liehom.flow.action.maps import matrices_of
from liehom.flow.door import LieAlgebra, Matrix, Representation, copies_of, defining
from liehom.flow.series.arrays import namespace

# The inner product on g for minimal norms: an Ad-invariant one if there is one.
#
# On a compact algebra -tr(rho(x) rho(y)) is Ad-invariant and positive definite; so is minus the Killing form B plus any
# inner product on the centre.  For matrices closed under transposition, tr(rho(x)^T rho(y)) is the trace form of x and
# -theta y with the Cartan involution theta(x) = -x^T; it is invariant under the maximal compact subgroup.  If rho does
# not show the involution, the inner product is -B(x, theta y) with theta from the defining matrices.  Otherwise it is
# the product of coefficients in the given basis.

RTOL = 1e-9
ELEMENTS = 3  # random elements of the algebra on which a linear condition is checked


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
        """The matrix, shape (dim, dim), whose columns are an orthonormal basis of g."""
        return np.linalg.inv(np.linalg.cholesky(self.matrix)).T


def inner_product(representation: Representation) -> InnerProduct:
    """The inner product on g in which correctors minimize norms; Ad-invariant if g has such an inner product.

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
    >>> inner_product(lh.representations.trivial(lh.abelian(2))).name
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
        return _named(algebra, trace, "-tr(rho(x) rho(y))")
    killing = np.asarray(algebra.killing_form().to_numpy()).reshape(n, n)
    if not (np.isfinite(flat).all() and np.isfinite(killing).all()):
        raise InputError("the matrices have numbers beyond the range of floats; scale them before integrating")
    if _is_positive(-killing):
        return _named(algebra, -killing, "minus the Killing form")
    centre = _coefficients_on_the_centre(algebra) if _is_semidefinite(-killing) else None
    if centre is not None and _is_positive(centre - killing):
        return _named(algebra, centre - killing, "minus the Killing form, plus the coefficients on the centre")
    if _is_positive(flat @ flat.T) and _contains(flat, turned):
        return _named(algebra, flat @ flat.T, "tr(rho(x)^T rho(y)) = -tr(rho(x) rho(theta y)), theta = minus transpose")
    conjugate = _by_the_defining_representation(algebra, killing)
    if conjugate is not None:
        return _named(
            algebra, conjugate, "-B(x, theta y), B the Killing form, theta = minus transpose in the defining matrices"
        )
    return _named(algebra, np.eye(n), "coefficients in the given basis")


def exact_gram_matrix(representation: Representation) -> Matrix:
    """The Gram matrix of the first exact candidate of `inner_product`, without centre or defining representation."""
    field, size = representation.field, representation.size**2
    flat = field.stack_rows([a.reshape(1, size) for a in representation.matrices], size)
    turned = field.stack_rows([a.T.reshape(1, size) for a in representation.matrices], size)
    trace = -(flat @ turned.T)
    if trace.is_positive_definite():
        return trace
    killing = -representation.algebra.killing_form()
    if killing.is_positive_definite():
        return killing
    product = flat @ flat.T
    if product.is_positive_definite() and field.stack_rows([flat, turned], size).rank() == flat.rank():
        return product
    return field.identity(representation.algebra.dimension)


def _named(algebra: LieAlgebra, form: Array, name: str) -> InnerProduct:
    form = (form + form.T) / 2
    invariant = _is_invariant(algebra, form)
    return InnerProduct(form, name + ", Ad-invariant" * invariant, invariant)


def _rows(representation: Representation) -> tuple[Array, Array]:
    """The matrices rho(e_i) and their transposes as rows."""
    a, shape = matrices_of(representation), (representation.algebra.dimension, representation.size**2)
    return a.reshape(shape), np.swapaxes(a, -1, -2).reshape(shape)


def _is_invariant(algebra: LieAlgebra, form: Array) -> bool:
    """Whether <[x, y], z> + <y, [x, z]> = 0 for all y and z, to round-off, and some random x; it is linear in x."""
    n, constants = algebra.dimension, list(algebra.structure_constants())
    if not constants:
        return True
    i, j, k = np.array([entry[:3] for entry in constants]).T
    scale = 1 / np.sqrt(np.diagonal(form))  # basis elements of length 1
    values = np.array([algebra.field.to_float(entry[3]) for entry in constants]) * scale[i] * scale[j] / scale[k]
    for x in np.random.default_rng(0).normal(size=(ELEMENTS, n)):
        bracket = np.zeros((n, n))
        np.add.at(bracket, (j, k), values * x[i])
        np.add.at(bracket, (i, k), -values * x[j])
        lowered = bracket @ (scale[:, None] * scale * form)
        if not np.abs(lowered + lowered.T).max() <= RTOL * np.abs(lowered).max():
            return False
    return True


def _is_positive(form: Array) -> bool:
    """Whether a symmetric form is positive definite, whatever the lengths of the basis elements."""
    diagonal = np.diagonal(form)
    if form.size == 0 or not bool(np.all(diagonal > 0)):
        return form.size == 0
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
    coefficients = np.linalg.lstsq(rows.T, others.T, rcond=None)[0]
    return bool(np.abs(rows.T @ coefficients - others.T).max(initial=0.0) <= RTOL * np.abs(rows).max(initial=1.0))


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
    return projector.T @ projector


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


# Isotropy frames and pseudo-inverses with a fixed sequence of operations, for traced steps and JAX.
#
# The singular value decomposition branches and is not differentiable where singular values coincide. A matrix A of
# known rank d is therefore factored as A = U B and B = L V^T. The columns of U come from d columns of A, chosen by
# selection (the longest first), and B = L V^T by rows; both orthogonalizations are repeated once. Then A^+ = V L^-1
# U^T, and 1 - V V^T is the projector on the kernel. If all singular values of A agree, then A^+ = A^T d / tr(A A^T).


class OrthogonalDecomposition(NamedTuple):
    """A complete orthogonal decomposition A = U L V^T of a matrix (..., n, k)."""

    image: Values  # U (..., n, d): orthonormal basis of the range, with zero columns where the rank is below d
    lift: Values  # V L^-1 (..., k, d): column j is the solution of A x = U[:, j] of smallest norm
    rows: Values  # V (..., k, d): orthonormal basis of the orthogonal complement of the kernel


def orthogonal_decomposition(matrix: Values, rank: int, cutoff: Real = 0.0) -> OrthogonalDecomposition:
    """A complete orthogonal decomposition of a matrix of rank at most `rank`."""
    xp = namespace(matrix)
    chosen: list[Values] = []
    columns = [matrix[..., :, j] for j in range(matrix.shape[-1])]
    for _ in range(rank):
        unit = _unit(xp, _longest(xp, columns), chosen, cutoff)
        columns = [c - _dot(xp, unit, c)[..., None] * unit for c in columns]
        chosen.append(unit)
    rows, lifts = _by_rows(xp, [(u[..., None, :] @ matrix)[..., 0, :] for u in chosen], cutoff)
    return OrthogonalDecomposition(*[xp.stack(parts, axis=-1) for parts in (chosen, lifts, rows)])


def _by_rows(xp: Any, rows: list[Values], cutoff: Real) -> tuple[list[Values], list[Values]]:
    """The columns of V and of V L^-1, for the rows of B = L V^T."""
    units: list[Values] = []
    overs: list[Values] = []
    below: list[list[Values]] = []
    for row in rows:
        coefficients = [_dot(xp, v, row) for v in units]
        for c, v in zip(coefficients, units, strict=True):
            row = row - c[..., None] * v
        for v in units:
            row = row - _dot(xp, v, row)[..., None] * v
        over = _over_length(xp, row, cutoff)
        units.append(row * over)
        overs.append(over)
        below.append(coefficients)
    lifts: list[Values] = list(units)
    for j in range(len(units) - 1, -1, -1):
        for i in range(j + 1, len(units)):
            lifts[j] = lifts[j] - below[i][j][..., None] * lifts[i]
        lifts[j] = lifts[j] * overs[j]
    return units, lifts


def _longest(xp: Any, columns: list[Values]) -> Values:
    best, size = columns[0], _dot(xp, columns[0], columns[0])
    for column in columns[1:]:
        square = _dot(xp, column, column)
        longer = square > size
        best = xp.where(longer[..., None], column, best)
        size = xp.where(longer, square, size)
    return best


def _unit(xp: Any, column: Values, before: list[Values], cutoff: Real) -> Values:
    for u in before:
        column = column - _dot(xp, u, column)[..., None] * u
    return column * _over_length(xp, column, cutoff)


def _over_length(xp: Any, v: Values, cutoff: Real) -> Values:
    """1 / |v|, shape (..., 1), or 0 where |v| is not above the cutoff."""
    square = _dot(xp, v, v)
    some = square > cutoff * cutoff
    return xp.where(some, 1.0 / xp.sqrt(xp.where(some, square, 1.0)), 0.0)[..., None]


def _dot(xp: Any, a: Values, b: Values) -> Values:
    return xp.sum(a * b, axis=-1)


class TightFrame(NamedTuple):
    """Data of orbits on which all singular values agree: rho(b_1) m, ..., rho(b_r) m is a tight frame of T_m.

    The linear systems of the correctors then have short closed solutions at all points of the orbits. With the
    projectors P on g_m and Pi on the tangent space, and R = [rho(b_1) u, ...], the isotropy acts by
    R P R^T = mu (Pi - u u^T) for all unit tangent vectors u.
    """

    trace: Array  # (N, N): the form tr(A A^T) of m
    isotropy: float  # mu
    inverse: Array  # (dim g, dim g): of the Gram matrix of the inner product on g
    symmetric: bool  # whether R^T r is in g_m for all tangent r and u, so that no projection is needed
    over: Values | None = None  # rank / tr(A A^T) if the inner product is invariant: constant along orbits
