"""Equation: x = F(A x) for the stages of an implicit step, with derivatives of F by Jets of order 1.

x has the shape (S, ..., n): S stages, the axes of the ensemble, n coordinates. A mixes the stages only, and stage i of
F depends on y_i = (A x)_i only, so that the derivative of F has one n x n block for each stage and trajectory.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy as np

from liehom.errors import LiehomError
from liehom.series.arrays import is_lazy, namespace
from liehom.series.jet import Jet
from liehom.series.node import Node
from liehom.typing import Array, Values

Stage: TypeAlias = Any
"""An array, Jet or tracer of shape (..., n), or None for 0."""
SparseRow: TypeAlias = tuple[tuple[int, Any], ...]
"""(index, entry) of the nonzero entries of a row of coefficients."""
Stages: TypeAlias = Callable[[list[Any]], Sequence[Any]]
"""From y_1, ..., y_S, None for 0, to F_1(y_1), ..., F_S(y_S)."""

DIFFERENCE = 2.0**-26
"""Size of the differences that replace Jets, the root of the round-off of float64."""
NOT_ON_JETS = (LiehomError, TypeError, ValueError, IndexError, AttributeError, NotImplementedError)
"""Errors of a function of arrays that does not run on Jets, or not on an additional first axis."""


def combined(row: SparseRow, terms: Sequence[Values] | Values) -> Stage:
    """sum_j row[j] terms[j]; None if the row has no entries.

    Examples
    --------
    >>> import numpy as np
    >>> combined(((0, 0.5), (2, 2.0)), np.array([1.0, 7.0, 3.0]))
    np.float64(6.5)
    """
    total = None
    parts: Any = terms
    for j, weight in row:
        term = parts[j] * weight
        total = term if total is None else total + term
    return total


@final
class Equation:
    """The equation x = F(A x).

    Parameters
    ----------
    function : callable
        F, from the list of the y_i (None for 0) to the list of its stages.
    rows : sequence of sparse rows
        The matrix A.

    Examples
    --------
    >>> import numpy as np
    >>> equation = Equation(lambda y: [np.sin(y[0])], [((0, 2.0),)])
    >>> x = np.array([[0.25]])
    >>> bool(equation.value(x) == np.sin(0.5)), equation.blocks(x).round(6).tolist()  # cos(1/2)
    (True, [[[0.877583]]])
    """

    def __init__(self, function: Stages, rows: Sequence[SparseRow]) -> None:
        self.function, self.rows = function, rows
        self._on_jets = self._at_once = True
        self._checked = False

    @property
    def matrix(self) -> Array:
        """A as an array (S, S)."""
        made = np.zeros((len(self.rows),) * 2)
        for i, row in enumerate(self.rows):
            for j, weight in row:
                made[i, j] = weight
        return made

    def arguments(self, x: Values) -> list[Any]:
        """The list of y_i = (A x)_i, None for rows without entries."""
        return [combined(row, x) for row in self.rows]

    def value(self, x: Values) -> Values:
        """F(A x), of the shape of x."""
        made = self.function(self.arguments(x))
        found: Values = namespace(*made).stack(made)
        return found

    def blocks(self, x: Values) -> Values:
        """The derivatives of F_i by y_i, shape (S, ..., n, n); the last axis is that of the direction."""
        y, n = self.arguments(x), x.shape[-1]
        directions = np.eye(n)
        columns: Any = self._batched(y, x) if self._at_once else None
        if columns is None:
            columns = [self._derivative(y, [None if v is None else 0 * v + e for v in y], x) for e in directions]
        found: Values = namespace(*columns).stack(columns, axis=-1)
        return found

    def along(self, x: Values, v: Values) -> Values:
        """The derivative of F(A x) in the direction v, of the shape of x."""
        return self._derivative(self.arguments(x), self.arguments(v), x)

    def _batched(self, y: list[Any], x: Values) -> list[Any] | None:
        """The columns of `blocks` from one evaluation with the directions on an additional first axis.

        None if F does not run on such an axis, as psi of one trajectory may be written with m[0].
        """
        if type(x) is not np.ndarray or not self._on_jets:
            return None
        n = x.shape[-1]
        e = np.eye(n, dtype=x.dtype).reshape(n, *[1] * (x.ndim - 2), n)
        try:
            jets = [None if v is None else _in_directions(v, e) for v in y]
            found = [_parts(k) for k in self.function(jets)]
            values = [value for value, _ in found] if self._checked else self.function(y)
            if any(is_lazy(k) for k in values):
                return None
        except NOT_ON_JETS:
            self._at_once = False
            return None
        for (value, _), wanted in [] if self._checked else zip(found, values, strict=True):
            scale = float(np.abs(wanted).max(initial=0.0))
            if value.shape not in ((n, *np.shape(wanted)), np.shape(wanted)) or not np.allclose(
                value, wanted, rtol=0, atol=1e-9 * scale, equal_nan=True
            ):
                self._at_once = False
                return None
        self._checked = True
        slopes = np.stack([np.broadcast_to(slope, (n, *x.shape[1:])) for _, slope in found], axis=1)
        return list(slopes)

    def _derivative(self, y: list[Any], directions: list[Any], x: Values) -> Values:
        """The derivative of F at y in the given directions, stacked; by differences if F does not run on Jets."""
        if self._on_jets:
            try:
                made = self.function(
                    [None if v is None else Jet.variable(v, 1, d) for v, d in zip(y, directions, strict=True)]
                )
                slopes = [0 * x[0] + _parts(k)[1] for k in made]
                found: Values = namespace(*slopes).stack(slopes)
                return found
            except NOT_ON_JETS:
                self._on_jets = False
        ahead = [None if v is None else v + DIFFERENCE * d for v, d in zip(y, directions, strict=True)]
        pairs = zip(self.function(ahead), self.function(y), strict=True)
        quotients = [(new - old) / DIFFERENCE for new, old in pairs]
        differences: Values = namespace(*quotients).stack(quotients)
        return differences


def _in_directions(v: Array, e: Array) -> Jet:
    """v + e t for all directions e at once; the value is a view, so that exponentials of it are computed once."""
    value = np.broadcast_to(v, np.broadcast_shapes(v.shape, e.shape))
    return Jet.from_node(Node(1, value, [value, np.broadcast_to(e, value.shape)]))


def _parts(k: Stage) -> tuple[Any, Any]:
    """Value and slope of a stage, which is a Jet of order 1 unless it does not depend on its argument."""
    return (k.coefficient(0), k.coefficient(1)) if isinstance(k, Jet) else (k, 0 * k)
