"""Action: a representation with an exponential, the numerical description of a homogeneous space: rho(x) m, Exp(x) m,
the bracket, an inner product on g, and the isotropy subalgebra at a point in an orthonormal basis.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, final, overload

import numpy as np

from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.typing import Array, BooleanArray, IntegerArray, Values, ValuesLike
from liehom.flow.action.custom_exponential import ExponentialLike, exponential_of
from liehom.flow.action.exponential import Exponential
from liehom.flow.action.frames import InnerProduct, TightFrame, inner_product, orthogonal_decomposition
from liehom.flow.action.maps import FieldMap, action_map, bracket_map, matrices_of
from liehom.flow.door import Representation, copies_of
from liehom.flow.series.arrays import is_jax, namespace
from liehom.flow.series.jet import Jet
from liehom.flow.tracing.array import Traced


@final
class Action:
    """A representation together with an exponential.

    Parameters
    ----------
    representation : Representation
    exponential : str, Exponential or callable
        "exp" (default), "cayley", "expm", "series", "rodrigues", an `Exponential`, or a function (x, m) -> Exp(x) m
        written with numpy functions; see `liehom.action.exponential_of`.

    Attributes
    ----------
    infinitesimal : function
        (x, m) -> rho(x) m.
    bracket : function
        (x, y) -> [x, y], as steps of order 3 and more need it.
    max_norm : float
        The largest Frobenius norm of rho(x) for x in an orthonormal basis of g.
    tight_frame : TightFrame or None
        The data of orbits on which all singular values agree; see `with_tight_frame`.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> action = lh.Action(lh.defining(lh.so(3)), "cayley")
    >>> m = action.act(np.array([0.1, 0.2, 0.3]), np.array([0.0, 0.0, 1.0]))
    >>> round(float(m @ m), 14)
    1.0
    """

    representation: Representation

    __slots__ = (
        "_basis", "bracket", "exponential", "infinitesimal", "inner_product", "max_norm", "representation",
        "tight_frame",
    )  # fmt: skip

    def __init__(self, representation: Representation, exponential: ExponentialLike = "exp") -> None:
        if not isinstance(representation, Representation):
            raise InputError(f"expected a Representation, got {displayed(representation)}")
        self.representation = representation
        self.exponential: Exponential = exponential_of(representation, exponential)
        self.infinitesimal: FieldMap = action_map(representation)
        self.bracket: FieldMap = bracket_map(representation)
        self.inner_product: InnerProduct = inner_product(representation)
        self._basis = self.inner_product.orthonormal_basis()
        self.tight_frame: TightFrame | None = None
        self.max_norm: float
        copies = copies_of(representation)
        if copies is not None:
            self.max_norm = Action(copies.single).max_norm
            return
        shape = (representation.algebra.dimension, representation.size**2)
        tensor = matrices_of(representation).reshape(shape)
        self.max_norm = float(np.linalg.norm(self._basis.T @ tensor, axis=1).max(initial=0.0))

    @property
    def dimension(self) -> int:
        """Dimension of the algebra."""
        return self.infinitesimal.shape[0]

    @overload
    def act(self, x: Jet, m: ValuesLike) -> Jet: ...
    @overload
    def act(self, x: ValuesLike, m: Jet) -> Jet: ...
    @overload
    def act(self, x: ValuesLike, m: ValuesLike) -> Values: ...
    def act(self, x: ValuesLike, m: ValuesLike) -> Values:
        """The points Exp(x) m for x (..., dim) and m (..., N), arrays or Jets with x(0) = 0."""
        if np.shape(x)[-1:] != (self.dimension,) or np.shape(m)[-1:] != (self.representation.size,):
            raise ShapeError(
                f"x of shape {np.shape(x)} and m of shape {np.shape(m)}, expected (..., {self.dimension}) and "
                f"(..., {self.representation.size})"
            )
        return self.exponential(x, m)

    def isotropy_frame(self, m: Values, orbit_dimension: int | IntegerArray) -> IsotropyFrame:
        """Orthonormal bases of the isotropy subalgebra and of the tangent space at m, of known dimension.

        Parameters
        ----------
        m : array of shape (..., N)
        orbit_dimension : int or array of shape (...,)
            The dimension is constant along an orbit, so no tolerance is needed.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> lh.Action(lh.defining(lh.so(3))).isotropy_frame(np.array([0, 0, 1.0]), 2).basis.shape
        (3, 1)
        """
        if self.tight_frame is not None and not is_jax(m):
            return self._frame_of_tight(self.tight_frame, m, orbit_dimension)
        if type(m) is Traced:
            return self._branch_free_frame(m, int(np.max(orbit_dimension)))
        xp = namespace(m)
        columns = self.infinitesimal.right(m) @ self._basis
        extended = columns.dtype == np.longdouble
        wide = columns.shape[-1] > columns.shape[-2]  # else the last right singular vectors span the kernel
        left, sizes, right = xp.linalg.svd(columns.astype(np.float64) if extended else columns, full_matrices=wide)
        rank = np.asarray(orbit_dimension)
        lowest, highest = int(rank.min()), int(rank.max())
        kernel = xp.swapaxes(right[..., lowest:, :], -1, -2)
        tangent = left[..., :, :highest]
        lengths = sizes[..., None, :highest]
        lift = xp.swapaxes(right[..., :highest, :], -1, -2) / xp.where(lengths > 0, lengths, 1.0)
        if lowest != highest:
            kernel = kernel * (np.arange(lowest, self.dimension) >= rank[..., None])[..., None, :]
            tangible = (np.arange(highest) < rank[..., None])[..., None, :]
            tangent, lift = tangent * tangible, lift * tangible
        if extended:
            kernel, tangent, lift = _refined(columns, kernel, tangent, lift)
        return IsotropyFrame(self._basis @ kernel, tangent, self._basis @ lift, rank)

    def with_tight_frame(self, frame: TightFrame | None) -> Action:
        """A copy of this action whose points (except JAX arrays) lie on orbits with this tight frame; None removes it.

        Its isotropy frames have no basis of g_m, and the standard basis of V in place of a tangent basis.
        """
        action = copy(self)
        action.tight_frame = frame
        return action

    def _frame_of_tight(self, tight: TightFrame, m: Values, orbit_dimension: int | IntegerArray) -> IsotropyFrame:
        columns = self.infinitesimal.right(m)
        rank = np.asarray(orbit_dimension)
        over = np.max(rank) / np.sum((m @ tight.trace) * m, axis=-1) if tight.over is None else tight.over
        lift = tight.inverse @ np.swapaxes(columns, -1, -2) * over[..., None, None]
        return IsotropyFrame(None, np.eye(m.shape[-1]), lift, rank)

    def _branch_free_frame(self, m: Values, rank: int) -> IsotropyFrame:
        """The frame with the projector on g_m in place of a basis: only the range of the matrix is used."""
        xp = namespace(m)
        image, lift, rows = orthogonal_decomposition(self.infinitesimal.right(m) @ xp.asarray(self._basis), rank)
        kernel = np.eye(self.dimension) - rows @ xp.swapaxes(rows, -1, -2)
        return IsotropyFrame(self._basis @ kernel, image, self._basis @ lift, np.asarray(rank))

    def __repr__(self) -> str:
        return f"<action by {self.exponential.name} of {displayed(self.representation)}>"


@final
@dataclass(frozen=True, slots=True)
class IsotropyFrame:
    """The isotropy subalgebra and the tangent space at a point, in orthonormal bases.

    Attributes
    ----------
    basis : array of shape (..., dim, s), or None
        Columns span g_m, orthonormal in the inner product of the action. If the orbits of an ensemble have different
        dimensions, zero columns fill the array. None for a tight frame, where no basis is needed.
    tangent : array of shape (..., N, d)
        Columns span T_m M, orthonormal, filled with zero columns.
    lift : array of shape (..., dim, d)
        Column j is the generator x of minimal norm with rho(x) m = tangent[:, j].
    orbit_dimension : array of shape (...,)
    """

    basis: Values | None
    tangent: Values
    lift: Values
    orbit_dimension: IntegerArray


def _refined(columns: Values, kernel: Values, tangent: Values, lift: Values) -> tuple[Values, Values, Values]:
    """Kernel, tangent and lift in extended precision, by two Newton steps from their values in float64."""
    inverse = lift @ np.swapaxes(tangent, -1, -2)
    for _ in range(2):
        kernel = kernel - inverse @ (columns @ kernel)
        kernel = kernel @ _towards_orthonormal(kernel)
    lift = lift - kernel @ (np.swapaxes(kernel, -1, -2) @ lift)
    tangent = columns @ lift
    for _ in range(2):
        turn = _towards_orthonormal(tangent)
        tangent, lift = tangent @ turn, lift @ turn
    return kernel, tangent, lift


def _towards_orthonormal(a: Values) -> Values:
    """The factor (3 - A^T A) / 2: A times it has columns closer to orthonormal ones, and the same zero columns."""
    return (3 * np.eye(a.shape[-1], dtype=a.dtype) - np.swapaxes(a, -1, -2) @ a) / 2


# Tight frames: orbits on which all singular values of x -> rho(x) m agree.

TIGHT_RTOL = 1e-11
"""Largest defect of a condition, relative to its terms."""
SAMPLES = 16
"""Number of points at least that are moved along their orbits; fewer initial points are used several times."""
POINTS_AT_ONCE = 4096
"""Points whose matrices are in memory at once."""
OWN_STREAM = 20011
"""Second word of the seed: points that a caller drew with the same seed must not be the random tangent vectors too."""


def tight_frame(action: Action, points: Array, rank: int, seed: int = 0) -> TightFrame | None:
    """The tight frame of the orbits of points, all of one dimension, or None if their singular values differ.

    Both conditions, on the singular values of A and on the action of the isotropy on tangent vectors, are identities
    between polynomials. An orbit of a connected group is irreducible, so such an identity holds on all of it if it
    holds at a random point of it. It says nothing about another orbit. Therefore the conditions are checked, to
    round-off, on the orbit of each of the points, and `isotropy` must be one number for all of them. Where the group
    acts by orthogonal matrices on V and on g, both conditions hold on a whole orbit if they hold at one point of it,
    and the points themselves are used. Otherwise they are moved by random elements of the group.
    """
    if rank < 2 or not len(points):
        return None
    points = points / np.abs(points).max(axis=-1, keepdims=True)  # the conditions are of degree 3 in them
    rng = np.random.default_rng((seed, OWN_STREAM))
    basis = action.inner_product.orthonormal_basis()
    rows = np.arange(max(len(points), SAMPLES)) % len(points)
    mu, symmetric, orthogonal = None, True, _acts_orthogonally(action)
    for first in range(0, len(rows), POINTS_AT_ONCE):
        some = points[rows[first : first + POINTS_AT_ONCE]]
        if not bool(is_tight(action.infinitesimal.right(some) @ basis, rank).all()):
            return None
        if not orthogonal:
            x = rng.normal(size=(len(some), action.dimension))
            some = np.asarray(action.act(x / max(1.0, float(action.max_norm)), some))
            if not bool(is_tight(action.infinitesimal.right(some) @ basis, rank).all()):
                return None
        constant = _isotropy_constant(action, some, rank, rng, mu)
        if constant is None:
            return None
        mu, symmetric = constant[0], symmetric and constant[1]
    if mu is None:
        return None
    inverse: Any = np.linalg.inv(action.inner_product.matrix)
    corners = action.infinitesimal.right(np.eye(points.shape[-1]))
    trace = np.einsum("pia,ab,qib->pq", corners, inverse, corners)
    near = float(Fraction(mu).limit_denominator(256))
    return TightFrame(trace, near if abs(near - mu) <= 1e-12 * mu else mu, inverse, symmetric)


def _acts_orthogonally(action: Action) -> bool:
    """Whether the matrices rho(e_i) are skew-symmetric and the inner product on g is Ad-invariant."""
    matrices = action.infinitesimal.right(np.eye(action.infinitesimal.shape[1]))  # [j, :, i]: rho(e_i) e_j
    defect = np.abs(matrices + np.swapaxes(matrices, 0, 1)).max(initial=0.0)
    return action.inner_product.invariant and bool(defect <= TIGHT_RTOL * np.abs(matrices).max(initial=0.0))


def _isotropy_constant(
    action: Action, points: Array, rank: int, rng: np.random.Generator, before: float | None
) -> tuple[float, bool] | None:
    """`isotropy` and `symmetric` of a `TightFrame` at points; None unless `isotropy` is one number (`before`)."""
    basis = action.inner_product.orthonormal_basis()
    columns = action.infinitesimal.right(points) @ basis
    square = np.sum(columns * columns, axis=(-2, -1))[:, None, None] / rank
    tangent = columns @ np.swapaxes(columns, -1, -2) / square
    kernel = np.eye(columns.shape[-1]) - np.swapaxes(columns, -1, -2) @ columns / square
    u = (tangent @ rng.normal(size=(*points.shape, 1)))[..., 0]
    u = u / np.sqrt(np.sum(u * u, axis=-1, keepdims=True))
    across = action.infinitesimal.right(u) @ basis @ kernel
    squares = across @ np.swapaxes(across, -1, -2)
    normal = tangent - u[:, :, None] * u[:, None, :]
    mu = float(np.trace(squares[0]) / (rank - 1)) if before is None else before
    if not (mu > TIGHT_RTOL and float(np.abs(squares - mu * normal).max()) <= TIGHT_RTOL * max(mu, 1.0)):
        return None
    r = (tangent @ rng.normal(size=(*points.shape, 1)))[..., 0]
    turned = np.swapaxes(action.infinitesimal.right(u) @ basis, -1, -2) @ r[..., None]
    outside = np.abs(turned - kernel @ turned).max()
    return mu, bool(outside <= TIGHT_RTOL * max(1.0, float(np.abs(turned).max())))


def is_tight(matrix: Values, rank: int) -> BooleanArray:
    """Mask, shape (...,), of the matrices with A A^T A = lambda A, lambda = tr(A A^T) / rank."""
    a = np.ascontiguousarray(np.moveaxis(np.asarray(matrix), (-2, -1), (0, 1)))  # sums over all matrices at once
    square = np.einsum("pq...,pq...->...", a, a) / rank
    left = np.einsum("pr...,qr...->pq...", a, a)
    defect = np.einsum("pr...,rq...->pq...", left, a) - square * a
    return np.abs(defect).max(axis=(0, 1)) <= TIGHT_RTOL * (square * np.abs(a).max(axis=(0, 1)))
