"""The generator of minimal norm of a vector field that is tangent to the orbits.

With A = [rho(b_1) m, ..., rho(b_r) m] for an orthonormal basis b of g, psi = A^+ X in this basis.  At a point
A = U S V^T, and R = S^-1 U^T A is V^T.  Along a curve through the point, with U and S held fixed, the rows of R still
span the rows of A, so that psi = R^T (R R^T)^-1 S^-1 U^T X.  This formula is expanded in series; no singular vector is
differentiated.
"""

from __future__ import annotations

import sys
from typing import Any, final

import numpy as np

from liehom.errors import InputError, TangencyError
from liehom.homogeneous.exponentials.matrix_functions import inverse, solve
from liehom.homogeneous.fields.components import Components, GeneratorLike
from liehom.homogeneous.frames.inner_product import inner_product
from liehom.homogeneous.maps import action_map
from liehom.representations import Representation
from liehom.series import recurrences
from liehom.series.arrays import is_exact, is_jax, is_traced, namespace
from liehom.series.jet import Jet
from liehom.typing import Array, Pytree, Real, Values, ValuesLike

RANK_RTOL = 1e-9
NOISE_RTOL = 1e-13
TANGENCY_RTOL = 1e-8


@final
class LeastNorm:
    """The function (m, t) -> generator of minimal norm of a vector field.

    Parameters
    ----------
    representation : Representation
    field : callable or sequence
        X in one of the forms of `Components`, with N components.
    orbit_dimension : int, optional
        The dimension of the orbits (default: the numerical rank at each point).
    rtol : float
        Largest admissible normal component of X, relative to X.

    Raises
    ------
    TangencyError
        On evaluation at points where X is not tangent to the orbit.
    InputError
        If `orbit_dimension` is not a possible dimension of orbits.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> psi = LeastNorm(lh.defining(lh.so(3)), ["-m1", "m0", 0])
    >>> np.abs(psi(np.array([0.6, 0.0, 0.8])).round(12)).tolist()  # the angular velocity normal to m
    [0.36, 0.0, 0.48]
    """

    components: Components
    time_dependent: bool

    __slots__ = ("_action", "_basis", "_dimension", "_rtol", "_size", "components", "time_dependent")

    def __init__(
        self,
        representation: Representation,
        field: GeneratorLike,
        orbit_dimension: int | None = None,
        rtol: float = TANGENCY_RTOL,
        time_dependent: bool | None = None,
    ) -> None:
        size = representation.size
        self.components = Components(field, size, (size,), "the vector field", time_dependent)
        self.time_dependent = self.components.time_dependent
        self._action = action_map(representation)
        self._basis = inner_product(representation).orthonormal_basis()
        most = min(size, representation.algebra.dimension)
        if orbit_dimension is not None and not 0 < orbit_dimension <= most:
            raise InputError(f"orbit_dimension is {orbit_dimension!r}, expected an integer from 1 to {most}")
        if not rtol > 0:
            raise InputError(f"rtol is {rtol!r}, expected a positive number")
        self._dimension, self._rtol = orbit_dimension, rtol
        flat = np.array([a.to_numpy() for a in representation.matrices]).reshape(len(self._basis), size * size)
        self._size = float(np.linalg.norm(self._basis.T @ flat, axis=-1).max(initial=0.0))

    def __call__(self, m: ValuesLike, t: Real = 0.0) -> Values:
        """The generator at m (..., N) and t: array or Jet of shape (..., dim g)."""
        x = self.components(m, t)
        value: Values = m.value if isinstance(m, Jet) else namespace(m).asarray(m)
        if is_exact(value):
            raise InputError("the generator of minimal norm is computed in floats; give psi itself for exact numbers")
        down, right, kept = self._decomposed(value, x.value if isinstance(x, Jet) else x)
        xp = namespace(value)

        def lifted(rows: Values, y: Values) -> Values:
            made: Values = (xp.swapaxes(rows, -1, -2) @ y)[..., 0] @ self._basis.T
            return made

        def image(v: Values) -> Values:
            column: Values = v[..., None]
            return down @ column

        series = isinstance(m, Jet) or isinstance(x, Jet)
        if not series and xp is np and value.dtype == np.float64:
            return lifted(right, image(x))

        def rows_at(v: Values) -> Values:
            return down @ self._columns(v)

        rest = (~kept)[..., None] * xp.eye(kept.shape[-1], dtype=value.dtype)
        if not series:
            rows = rows_at(value)
            return lifted(rows, solve(rows @ xp.swapaxes(rows, -1, -2) + rest, image(x)))
        order = min(v.order for v in (m, x) if isinstance(v, Jet))
        operands = (m if isinstance(m, Jet) else value, x)
        points, field = (v.node if isinstance(v, Jet) else recurrences.constant(v, order) for v in operands)
        along = recurrences.linear(rows_at, [points])
        gram = recurrences.multilinear(lambda a, b: a @ xp.swapaxes(b, -1, -2), [along, along])
        gram = recurrences.add(gram, recurrences.constant(rest, order))
        first = inverse(gram.value)
        y = recurrences.solution(recurrences.linear(image, [field]), gram, _product, lambda a, _: first @ a)
        return Jet.from_node(recurrences.multilinear(lifted, [along, y]))

    @property
    def takes_args(self) -> bool:
        """Whether the vector field is a function with args."""
        return self.components.takes_args

    @property
    def bound(self) -> tuple[Pytree, ...]:
        """(args,) that the vector field is called with, or ()."""
        return self.components.bound

    def with_args(self, args: Pytree) -> LeastNorm:
        """A LeastNorm for the vector field with these args.

        Examples
        --------
        >>> import liehom as lh
        >>> psi = LeastNorm(lh.defining(lh.so(2)), lambda m, t, args: args * m[..., ::-1] * [-1, 1])
        >>> float(psi.with_args(3.0)(np.array([0.6, 0.8]))[0].round(12))
        3.0
        """
        made = object.__new__(LeastNorm)
        for name in self.__slots__:
            setattr(made, name, getattr(self, name))
        made.components = self.components.with_args(args)
        return made

    def check(self, m: ValuesLike, t: Real = 0.0) -> None:
        """Check that X is finite at initial points and tangent to their orbits."""
        self.components.check(m, t)
        self(m, t)

    def _columns(self, m: Values) -> Values:
        """The matrix A = [rho(b_1) m, ..., rho(b_r) m], shape (..., N, r)."""
        return self._action.right(m) @ self._basis

    def _decomposed(self, value: Values, field: Values) -> tuple[Values, Values, Values]:
        """S^-1 U^T, V^T, and the mask of the rows that belong to tangent directions (the other rows are 0)."""
        xp = namespace(value)
        at: Any = self._columns(value)
        if is_jax(value):
            at = sys.modules["jax"].lax.stop_gradient(at)
        elif value.dtype == np.longdouble:
            at, field = at.astype(np.float64), field.astype(np.float64)
        left, sizes, right = xp.linalg.svd(at, full_matrices=False)
        if self._dimension is None:
            noise = NOISE_RTOL * self._size * _length(value)[..., None]
            kept = sizes > xp.maximum(RANK_RTOL * sizes[..., :1], noise)
        else:
            kept = (np.arange(sizes.shape[-1]) < self._dimension) & (sizes > 0)
        if not is_jax(value):
            most = int(kept.sum(axis=-1).max(initial=0))
            left, sizes, right, kept = left[..., :most], sizes[..., :most], right[..., :most, :], kept[..., :most]
        up = xp.swapaxes(left * kept[..., None, :], -1, -2)
        if not is_traced(at) and not is_traced(field):
            self._check_tangent(np.asarray(value), np.asarray(field), np.asarray(up))
        return up / xp.where(kept, sizes, 1.0)[..., None], right * kept[..., None], kept

    def _check_tangent(self, m: Array, field: Array, up: Array) -> None:
        normal = field - (np.swapaxes(up, -1, -2) @ (up @ field[..., None]))[..., 0]
        sizes = _length(normal)
        # a normal component below rtol * 1e-6 |m| counts as round-off
        bound = self._rtol * (_length(field) + 1e-6 * _length(m))
        if bool(np.any(sizes > bound)):
            index = np.unravel_index(int(np.argmax(np.where(sizes > bound, sizes, -1.0))), sizes.shape)
            place = tuple(int(i) for i in index)
            where = f" of trajectory {place[0] if len(place) == 1 else place}" if place else ""
            raise TangencyError(
                normal[index],
                f"the vector field is not tangent to the orbit at m = {m[index]}{where}: X = {field[index]} has the "
                f"normal component {normal[index]} of size {sizes[index]:.3g}",
            )


def _length(v: Values) -> Values:
    xp = namespace(v)
    made: Values = xp.sqrt(xp.einsum("...i,...i->...", v, v))
    return made


def _product(a: Values, b: Values) -> Values:
    return a @ b
