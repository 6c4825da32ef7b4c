"""Linear fractional maps X -> (a X + b)(c X + d)^-1: Moebius and projective maps, Riccati equations."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeAlias, Unpack, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, ShapeError
from liehom.base.typing import Array, Values
from liehom.flow.action.components import GeneratorLike, parameters_like
from liehom.flow.action.field import GeneratorField
from liehom.flow.door import Representation, defining
from liehom.flow.engines.arguments import SingleRunOptions
from liehom.flow.propagation.integration import integrate
from liehom.flow.run.solution import Solution
from liehom.flow.series.arrays import namespace
from liehom.flow.steps.step import StepLike

GeneratorMatrix: TypeAlias = "npt.ArrayLike | Callable[..., Any]"


@final
class LinearFractional:
    """The flow on p x q matrices X of a curve of generators M = [[A, B], [C, D]] in gl(p + q).

        X' = A X + B - X C X - X D

    The points are X = U V^-1 with columns of (U, V) in R^(p+q), on which M acts linearly. A trajectory passes through
    infinity, where V is singular, as through any other point.

    Parameters
    ----------
    p, q : int
        (n, 1) for projective maps of R^n, (1, 1) for Moebius maps of the line or the Riemann sphere.
    generator : (p + q, p + q) array_like, or callable
        M, or a function M(X), M(X, t) or M(X, t, args) with values (..., p + q, p + q) for X (..., p, q), written with
        numpy functions. On complex X a constant M may be complex, and a function returns real and imaginary part.
    over : {'R', 'C'}

    Attributes
    ----------
    field : GeneratorField
        The linear field on the columns of (U, V), one after the other.

    Examples
    --------
    >>> import liehom as lh
    >>> turn = lh.LinearFractional(1, 1, [[0, 1], [-1, 0]])  # X' = 1 + X^2, X = tan t
    >>> sol = turn.integrate((0, 3), [[0.0]], t_eval=[0, 1, 2, 3])
    >>> bool(abs(turn.value(sol)[:, 0, 0] - np.tan(sol.t)).max() < 1e-6)
    True
    """

    field: GeneratorField

    def __init__(self, p: int, q: int, generator: GeneratorMatrix, *, over: str = "R") -> None:
        if min(p, q) < 1:
            raise InputError(f"X has p rows and q columns, at least one each, got p = {p}, q = {q}")
        if over not in ("R", "C"):
            raise InputError(f"over is 'R' or 'C', got {over!r}")
        self.p, self.q, self.over = p, q, over
        self._rho: Representation = defining(f"gl({p + q}{',C' * (over == 'C')})")
        basis: Any = self._rho.complex_matrices() if over == "C" else [a.to_numpy() for a in self._rho.matrices]
        self._coordinates: Array = np.asarray(np.linalg.inv(self._parts([np.array(a, dtype=complex) for a in basis])))
        columns = self._rho
        for _ in range(q - 1):
            columns = columns.direct_sum(self._rho)
        self.field = GeneratorField(columns, self._generator(generator))

    def _parts(self, matrices: npt.ArrayLike) -> Array:
        """Real parts of the entries of matrices, one row for each, and behind them the imaginary parts over C."""
        array = np.array(matrices, dtype=complex)
        flat = array.reshape(len(array), -1)
        return np.concatenate([flat.real, flat.imag], axis=-1) if self.over == "C" else flat.real

    def _generator(self, generator: GeneratorMatrix) -> GeneratorLike:
        n = self.p + self.q
        if not callable(generator):
            matrix = np.asarray(generator)
            if matrix.shape != (n, n):
                raise ShapeError(f"the generator has shape {matrix.shape}, expected ({n}, {n})")
            if np.iscomplexobj(matrix) and self.over == "R":
                raise InputError("the generator is complex: give over='C' for complex X")
            return (self._parts([matrix]) @ self._coordinates)[0]

        def psi(m: Values, *rest: object) -> Values:
            parts = generator(self._quotient(m), *rest)
            flat = [part.reshape((*part.shape[:-2], n * n)) for part in (parts if self.over == "C" else (parts,))]
            return namespace(*flat).concatenate(flat, axis=-1) @ self._coordinates

        return parameters_like(generator, psi, "generator", "X")

    def start(self, x: npt.ArrayLike) -> Array:
        """The state (..., N) of matrices X (..., p, q), with V = 1."""
        given = np.asarray(x)
        if given.shape[-2:] != (self.p, self.q):
            raise ShapeError(f"X has shape {given.shape}, expected (..., {self.p}, {self.q})")
        if np.iscomplexobj(given) and self.over == "R":
            raise InputError("X is complex: give over='C'")
        below = np.broadcast_to(np.eye(self.q), (*given.shape[:-2], self.q, self.q))
        columns = np.swapaxes(np.concatenate([given, below], axis=-2), -1, -2)
        columns = columns.reshape(*given.shape[:-2], self.q * (self.p + self.q))
        if self.over == "R":
            return columns.astype(float)
        return np.stack([columns.real, columns.imag], axis=-1).reshape(*columns.shape[:-1], 2 * columns.shape[-1])

    def _columns(self, y: Values) -> Values:
        """(U, V) of shape (..., p + q, q), complex over C."""
        states: Any = y[..., 0::2] + 1j * y[..., 1::2] if self.over == "C" else y
        shape = (*states.shape[:-1], self.q, self.p + self.q)
        return namespace(states).swapaxes(states.reshape(shape), -1, -2)

    def _quotient(self, states: Values) -> Values:
        """U V^-1 for states that may be series or traced."""
        if self.q == 1 and self.over == "R":
            return (states[..., : self.p] / states[..., self.p :])[..., None]
        both: Any = self._columns(states)
        xp = namespace(both)
        above, below = both[..., : self.p, :], both[..., self.p :, :]
        return xp.swapaxes(xp.linalg.solve(xp.swapaxes(below, -1, -2), xp.swapaxes(above, -1, -2)), -1, -2)

    def value(self, y: npt.ArrayLike | Solution) -> Array:
        """X of states (..., N) or of all times of a solution, shape (..., p, q); infinite where V is singular."""
        states = np.swapaxes(y.y, -1, -2) if isinstance(y, Solution) else np.asarray(y, dtype=float)
        both: Any = self._columns(states)
        above, below = both[..., : self.p, :], both[..., self.p :, :]
        singular = np.linalg.det(below) == 0
        inverse = np.linalg.inv(np.where(singular[..., None, None], np.eye(self.q), below))
        values: Array = np.where(singular[..., None, None], np.inf, above @ inverse)
        return values

    def integrate(
        self,
        t_span: Iterable[float],
        x0: npt.ArrayLike,
        *,
        step: StepLike | None = None,
        dt: npt.ArrayLike | None = None,
        **options: Unpack[SingleRunOptions],
    ) -> Solution:
        """The solution of `liehom.integrate` with `field` from X (..., p, q), from which `value` reads X."""
        return integrate(self.field, t_span, self.start(x0), step=step, dt=dt, **options)
