"""The linear system of Theorem 5 at a point, solved for any right-hand side.

    e rho(zeta) w_l - l c w_l = r,    zeta in g_m, c real,    e = 1/2 (1 where the correction is a factor of its own)

The system is divided by |w_l|, so it is well posed next to equilibria.  If it has no solution, it is solved in least
squares.  Of several solutions the solver takes the one with the smallest |c| and, among those, the smallest |zeta|; or,
with a weight, the one with the smallest |zeta|^2 + weight^2 c^2.

In an orthonormal basis of the tangent space the unknowns are separated.  Let M = e rho(g_m) u, u = w_l / |w_l|, and
let p = u - M M^+ u be the part of u that isotropy does not reach.  If p is not 0, r determines c; if p = 0, c is free.
Then zeta = M^+ (r + l c u).
"""

from __future__ import annotations

import math
from functools import cached_property, lru_cache
from types import ModuleType
from typing import Any, final

import numpy as np

from liehom.base.errors import InternalError
from liehom.base.typing import BooleanArray, IntegerArray, Values
from liehom.flow.action.frames import orthogonal_decomposition
from liehom.flow.action.maps import applied
from liehom.flow.action.space import Action, IsotropyFrame
from liehom.flow.series.arrays import across_lanes, is_lazy, namespace
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.loop import while_loop

RANK_RTOL = 1e-8  # singular values of M below this fraction of the largest possible one count as 0
REACHED_RTOL = 1e-7  # p counts as 0 if |p| is at most this
REFINEMENTS = 3  # iterations by which extended precision is reached
STEPS = (-2.0, -1.0, 1.0, 2.0)
"""Numbers of steps, backwards and forwards, after which the determinant of `RangeSolver.is_near_cone` is evaluated."""
NEAR_CONE = 1 / 8
"""The cone counts as near if the determinant falls below this fraction of its value at the point. A simple zero between
one and two steps away makes the determinant negative after two steps, and a double zero leaves at most 1/9."""
SMALLEST_SQUARE = float(np.finfo(np.float64).tiny)  # a velocity whose square is below this counts as 0
REGULAR = 1e-12
"""A Gram determinant below this fraction of the product of its diagonal is that of a matrix without full rank."""


@final
class RangeSolver:
    """Solver of the linear system, r -> (zeta, c), at a point with a given w_l.

    Parameters
    ----------
    action : Action
    frame : IsotropyFrame
        At m.
    velocity : array of shape (..., N)
        w_l. If it vanishes, `solve` gives zeta = 0 and c = 0.
    leading : int
        l.
    factor : float
        e.
    weight : float, optional
        Relative weight of c if it is free; None is infinite.

    Notes
    -----
    Section 6 of the paper, (6.1) and (6.2), with the factor e in front of zeta and l in front of c. Singular values
    of M below 1e-8 of the largest possible count as 0.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> action, m = lh.Action(lh.defining(lh.so(3))), np.array([0, 0, 1.0])
    >>> solver = RangeSolver(action, action.isotropy_frame(m, 2), np.array([1.0, 0, 0]), 1, 0.5)
    >>> zeta, c, residual = solver.solve(np.array([0.25, 0.5, 0.0]))
    >>> float(c), np.abs(zeta).round(12).tolist(), bool(abs(residual).max() < 1e-12)
    (-0.25, [1.0, 0.0, 0.0], True)
    >>> int(solver.rank), round(float(solver.singular_value), 12)  # of [rho(g_m) u / 2, u]
    (2, 0.353553390593)
    """

    def __init__(
        self,
        action: Action,
        frame: IsotropyFrame,
        velocity: Values,
        leading: int,
        factor: float,
        weight: float | None = None,
    ) -> None:
        xp = self._xp = namespace(velocity)
        self._frame, self._leading, self._weight = frame, leading, weight
        self._size, unit = _normalized(xp, velocity)
        self._direction = unit
        self._down = xp.swapaxes(frame.tangent, -1, -2)
        if frame.basis is None:
            raise InternalError("a RangeSolver needs a frame with a basis of g_m")
        extended = unit.dtype == np.longdouble
        self._basis = _polished(frame.basis, action.inner_product.matrix) if extended else frame.basis
        moved = action.infinitesimal(xp.swapaxes(self._basis, -1, -2), unit[..., None, :])
        self._action, self._factor = action, factor
        self._moves = factor * (self._down @ xp.swapaxes(moved, -1, -2))
        self._unit = applied(self._down, unit)
        self._cutoff = factor * RANK_RTOL * action.max_norm
        self._inverse = _pseudo_inverse(xp, self._moves, self._cutoff)
        self._reaching = self._generator(self._unit)  # M^+ u
        rest = self._unit - applied(self._moves, self._reaching)
        square = xp.sum(rest * rest, axis=-1, keepdims=True)
        self._determined = square > REACHED_RTOL**2
        self._rest = xp.where(self._determined, rest / xp.where(self._determined, square, 1.0), 0.0)

    @property
    def singular_value(self) -> Values:
        """The d-th singular value of [e rho(g_m) u, u], shape (...,); (6.2) holds if it is not 0."""
        return _entry(self._xp, self._singular_values, self._frame.orbit_dimension)

    @property
    def rank(self) -> IntegerArray:
        """Rank of [e rho(g_m) u, u], shape (...,); the range condition holds if it is d."""
        return (self._singular_values > self._cutoff).sum(axis=-1)

    @property
    def matrix(self) -> Values:
        """The matrix [e rho(g_m) u, u] in orthonormal bases, shape (..., d, s + 1)."""
        return self._xp.concatenate([self._moves, self._unit[..., None]], axis=-1)

    def is_near_cone(self, change: Values) -> BooleanArray:
        """Whether two steps, each with a given change of the velocity, may reach the cone, bool (...,).

        Let A(v) = [e rho(g_m) v, v], which depends linearly on v; the cone is where its rank is less than d. The
        velocity w becomes w + s v for s in [-2, 2], where v is `change` without its component along w. The test is
        whether det A(w + s v) A(w)^T falls below 1/8 of its value at s = 0, at one of s = -2, -1, 1, 2. The ratio does
        not depend on the bases of g_m and of the tangent space, nor on the lengths of w and of the generators.

        Parameters
        ----------
        change : array of shape (..., N)
            The change in one step, a tangent vector in the scale of w_l.

        Examples
        --------
        On the hyperboloid x^2 + y^2 - z^2 = 1 the cone consists of the velocities that are null vectors:

        >>> import numpy as np
        >>> import liehom as lh
        >>> action, m = lh.Action(lh.defining(lh.so(2, 1))), np.array([1.0, 0.0, 0.0])
        >>> solver = RangeSolver(action, action.isotropy_frame(m, 2), np.array([0, 1.0, 0.25]), 1, 0.5)
        >>> [bool(solver.is_near_cone(np.array([0, 0, x]))) for x in (0.25, 0.75)]
        [False, True]
        """
        reach = (2 / _allowed(self._moves.shape[-2])) ** 2 * (1 + (self._factor * operator_bound(self._action)) ** 2)
        square, size = inner(change, change), self._size[..., 0] ** 2
        if is_lazy(change):
            suspicious = square * (reach * self._inverse_square()) > size
            if type(change) is Traced:
                return self._tested_on_tape(change, suspicious)
            v = change / self._size
            return suspicious & self._ratio_is_small(v, self._down, self._moves, self._unit, self._basis)
        along = inner(change, self._direction)
        moved = np.maximum(square - along * along, 0.0) / size
        suspicious = ~(moved * reach < self.singular_value**2)
        result: BooleanArray = np.zeros(np.shape(suspicious), dtype=bool)
        if not bool(suspicious.any()):
            return result
        some = np.flatnonzero(suspicious)
        d, shape = self._moves.shape[-2], suspicious.shape
        rank = np.broadcast_to(self._frame.orbit_dimension, shape).reshape(-1)[some]
        v, down, moves, unit, basis = (
            _lanes(x, shape, some) for x in (change / self._size, self._down, self._moves, self._unit, self._basis)
        )
        filled = np.eye(d) * (np.arange(d) >= rank[:, None])[:, None, :]
        result.reshape(-1)[some] = self._ratio_is_small(
            v, down, moves, unit, basis, filled if int(rank.min()) < d else None
        )
        return result

    def _inverse_square(self) -> Values:
        """Upper bound of |[e rho(g_m) u, u]^+|^2, shape (...,)."""
        xp = self._xp
        of_moves = xp.sum(self._inverse * self._inverse, axis=(-2, -1))
        over, reaching = (xp.sum(x * x, axis=-1) for x in (self._rest, self._reaching))  # 1 / |p|^2 or 0, |M^+ u|^2
        return 2 * of_moves + (1 + 2 * reaching) * over

    def _tested_on_tape(self, change: Traced, suspicious: Values) -> BooleanArray:
        """The test in compiled code, which is skipped unless a lane is suspicious."""

        never: Values = Traced(change.tape, change.tape.false)

        def test(wanted: Values, v: Values, moves: Values, unit: Values) -> tuple[list[Values], Values]:
            near = wanted & self._ratio_is_small(v, self._down, moves, unit, self._basis)
            return [near, v, moves, unit], never

        start = [suspicious, change / self._size, self._moves, self._unit]
        near: Any = while_loop(test, start, change.tape, 1, guarded=True)[0]
        return near

    def _ratio_is_small(
        self, change: Values, down: Values, moves: Values, unit: Values, basis: Values, filled: Values | None = None
    ) -> Values:
        """Whether the ratio of determinants of `is_near_cone` falls below its bound."""
        xp = self._xp
        v = applied(down, change)
        v = v - xp.sum(v * unit, axis=-1, keepdims=True) * unit
        along = applied(xp.swapaxes(down, -1, -2), v)
        turned = self._action.infinitesimal(xp.swapaxes(basis, -1, -2), along[..., None, :])
        moved = self._factor * (down @ xp.swapaxes(turned, -1, -2))
        gram = moves @ xp.swapaxes(moves, -1, -2) + unit[..., :, None] * unit[..., None, :]
        tilt = moved @ xp.swapaxes(moves, -1, -2) + v[..., :, None] * unit[..., None, :]
        if filled is not None:  # zero columns fill the bases of tangent spaces of smaller dimension
            gram = gram + filled
        at_point = _determinant(gram)
        least = _determinant(gram + STEPS[0] * tilt)
        for s in STEPS[1:]:
            least = xp.minimum(least, _determinant(gram + s * tilt))
        diagonal = gram[..., 0, 0]
        for i in range(1, gram.shape[-1]):
            diagonal = diagonal * gram[..., i, i]
        return (least < NEAR_CONE * at_point) & (at_point > REGULAR * diagonal)

    @cached_property
    def _singular_values(self) -> Values:
        return self._xp.linalg.svd(_single(self.matrix), compute_uv=False)

    def solve(self, right: Values) -> tuple[Values, Values, Values]:
        """(zeta (..., dim g), c (...,), residual (..., N)); the residual is r - (e rho(zeta) w - l c w), tangential."""
        target = applied(self._down, right / self._size)
        c = self._clock(target)
        moved = target + self._leading * c[..., None] * self._unit
        zeta = self._generator(moved)
        residual = moved - applied(self._moves, zeta)
        return applied(self._basis, zeta), c, applied(self._frame.tangent, residual * self._size)

    def _clock(self, target: Values) -> Values:
        c = -self._xp.sum(self._rest * target, axis=-1) / self._leading
        if self._weight is None:
            return c
        # zeta = a + l c b with a = M^+ r, b = M^+ u: the least |a + l c b|^2 + weight^2 c^2
        xp, l = self._xp, self._leading
        a, b = self._generator(target) / self._weight, self._reaching / self._weight
        free = -l * xp.sum(a * b, axis=-1) / (1 + l**2 * xp.sum(b * b, axis=-1))
        return xp.where(self._determined[..., 0], c, free)

    def _generator(self, target: Values) -> Values:
        """The product M^+ r, in the basis of the frame."""
        if target.dtype != np.longdouble:
            return applied(self._inverse, target)
        # M^T G^2 M M^T with G = (M M^T)^+ is M^+, also if G is known in lower precision: the iteration stays in the
        # range of M^T, and its fixed points have M^T (r - M y) = 0
        turned = np.swapaxes(self._moves, -1, -2)
        y = np.zeros((*np.broadcast_shapes(target.shape[:-1], turned.shape[:-2]), turned.shape[-2]), target.dtype)
        for _ in range(REFINEMENTS):
            left = applied(self._moves, applied(turned, target - applied(self._moves, y)))
            y = y + applied(turned, applied(self._inverse, left))
        return y


@final
class TightFrameSolver:
    """Solver on orbits with a tight frame (`branch_free_frames`), where there is a solution: with w = w_l, c = -<w, r>
    / (l <w, w>), zeta the component in g_m of G^-1 R^T r / (e mu <w, w>), R = [rho(e_1) w, ...].
    """

    def __init__(
        self,
        action: Action,
        m: Values,
        orbit_dimension: int | IntegerArray,
        velocity: Values,
        leading: int,
        factor: float,
        moving: Values | None = None,
    ) -> None:
        square = inner(velocity, velocity)
        moves = square > SMALLEST_SQUARE
        moves = moves if moving is None else moves & moving
        self._over = np.where(moves, 1.0 / (square if type(square) is Traced else np.where(moves, square, 1.0)), 0.0)
        self._action, self._m, self._dimension, self._velocity = action, m, orbit_dimension, velocity
        self._leading, self._factor = leading, factor

    def solve(self, right: Values) -> tuple[Values, Values, None]:
        """(zeta (..., dim g), c (...,), None); there is no residual."""
        action, tight, w = self._action, self._action.tight_frame, self._velocity
        if tight is None:
            raise InternalError("the action of a TightFrameSolver has no tight frame")
        # r in place of r + l c w, as R^T w has no component in g_m
        turned = action.infinitesimal.right_transposed(w, right)
        y = across_lanes(turned, tight.inverse / (self._factor * tight.isotropy)) * self._over[..., None]
        if not tight.symmetric:
            lift = action.isotropy_frame(self._m, self._dimension).lift
            y = y - applied(lift, action.infinitesimal(y, self._m))
        return y, -(inner(w, right) * self._over) / self._leading, None

    @property
    def singular_value(self) -> Values:
        """The smallest singular value, min(e mu^(1/2), 1), shape (...,); cf. `RangeSolver.singular_value`."""
        isotropy = self._action.tight_frame.isotropy if self._action.tight_frame is not None else 0.0
        return np.full(np.shape(self._over), min(self._factor * isotropy**0.5, 1.0))

    @property
    def rank(self) -> IntegerArray:
        """Rank, the dimension of the orbit, shape (...,)."""
        return np.broadcast_to(self._dimension, np.shape(self._over))


def inner(a: Values, b: Values) -> Values:
    """Inner products of a and b (..., N), shape (...,)."""
    return np.sum(a * b, axis=-1) if type(a) is Traced else namespace(a, b).einsum("...i,...i->...", a, b)


def _allowed(d: int) -> float:
    """The largest q for which |K| <= q implies det(1 + K) >= 1/8, K a matrix of size d."""
    return float(1 - NEAR_CONE ** (1 / d))


@lru_cache(maxsize=64)
def operator_bound(action: Action) -> float:
    """Upper bound of |rho(x)| for |x| = 1 in the inner product of the action."""
    size = action.representation.size
    tensor = np.asarray(action.infinitesimal.right(np.eye(size)) @ action.inner_product.orthonormal_basis())
    rows = np.moveaxis(tensor, -1, 0).reshape(action.dimension, size * size)
    return float(np.linalg.norm(rows, 2)) if rows.size else 0.0


def _lanes(x: Values, shape: tuple[int, ...], some: IntegerArray) -> Values:
    """The entries of some trajectories of the flattened ensemble, in float64."""
    return _single(x.reshape(math.prod(shape), *x.shape[len(shape) :])[some])


def _determinant(matrix: Values) -> Values:
    """Determinants of matrices (..., d, d); of tracers by elimination without pivots, which is exact up to round-off
    where no leading minor vanishes."""
    if type(matrix) is not Traced:
        return namespace(matrix).linalg.det(_single(matrix))
    rows = [[matrix[..., i, j] for j in range(matrix.shape[-1])] for i in range(matrix.shape[-1])]
    product = rows[0][0]
    for k in range(1, len(rows)):
        top = rows[k - 1]
        for i in range(k, len(rows)):
            factor = rows[i][k - 1] / top[k - 1]
            rows[i] = [*rows[i][:k], *(a - factor * b for a, b in zip(rows[i][k:], top[k:], strict=True))]
        product = product * rows[k][k]
    return product


def _polished(basis: Values, gram: Values) -> Values:
    """A basis orthonormal in extended precision (`numpy.longdouble`), from one orthonormal in double precision."""
    square = np.swapaxes(basis, -1, -2) @ gram @ basis
    return basis @ (1.5 * np.eye(basis.shape[-1], dtype=basis.dtype) - square / 2)


def _normalized(xp: ModuleType, vector: Values) -> tuple[Values, Values]:
    """(|v| of shape (..., 1), or 1 if v = 0; v / |v|), without underflow of squares."""
    largest = xp.max(xp.abs(vector), axis=-1, keepdims=True)
    largest = xp.where(largest > 0, largest, 1.0)
    unit = vector / largest
    size = xp.sqrt(xp.sum(unit * unit, axis=-1, keepdims=True))
    size = xp.where(size > 0, size, 1.0)
    return size * largest, unit / size


def _entry(xp: ModuleType, values: Values, d: int | IntegerArray) -> Values:
    """The entry values[d - 1], or 0 if there are fewer than d values."""
    wide = xp.concatenate([0 * values[..., :1], values], axis=-1)
    index = np.where(d <= values.shape[-1], d, 0)
    return xp.take_along_axis(wide, np.broadcast_to(index, wide.shape[:-1])[..., None], axis=-1)[..., 0]


def _single(x: Values) -> Values:
    """x in double precision if it is of type longdouble, for which LAPACK has no routines."""
    return x.astype(np.float64) if x.dtype == np.longdouble else x


def _pseudo_inverse(xp: ModuleType, matrix: Values, cutoff: float) -> Values:
    """M^+ (..., s, d); in extended precision ((M M^T)^+)^2 in double precision, from which M^+ is iterated."""
    turned, extended = xp.swapaxes(matrix, -1, -2), matrix.dtype == np.longdouble
    if type(matrix) is Traced:
        parts = orthogonal_decomposition(matrix, min(matrix.shape[-2:]), cutoff)
        return parts.lift @ xp.swapaxes(parts.image, -1, -2)
    if matrix.shape[-1] == 0:
        return matrix @ turned if extended else turned
    if matrix.shape[-1] == 1 and not extended:  # a column, as on every two-dimensional orbit of so(3)
        square = xp.sum(matrix * matrix, axis=-2, keepdims=True)
        kept = square > cutoff * cutoff
        return xp.where(kept, turned / xp.where(kept, square, 1.0), 0.0)
    left, values, right = xp.linalg.svd(_single(matrix), full_matrices=False)
    kept = values > cutoff
    inverse = xp.where(kept, 1 / xp.where(kept, values, 1.0), 0.0)[..., None, :]
    outer = left * inverse**4 if extended else xp.swapaxes(right, -1, -2) * inverse
    return outer @ xp.swapaxes(left, -1, -2)
