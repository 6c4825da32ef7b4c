"""Action: a representation with an exponential, the numerical description of a homogeneous space: rho(x) m, Exp(x) m,
the bracket, an inner product on g, and the isotropy subalgebra at a point in an orthonormal basis.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import final, overload

import numpy as np

from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.typing import IntegerArray, Values, ValuesLike
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
