"""The action (x, m) -> rho(x) m and the bracket (x, y) -> [x, y] as bilinear maps on arrays and Jets.

In floats, and over exact scalars (object arrays of numbers of the representation's field) in the field's own
numbers.  Imports representations, series.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, final

from liehom.representations import Representation
from liehom.series.arrays import is_exact
from liehom.series.bilinear import Bilinear
from liehom.series.jet import Jet

Entries = Iterable[tuple[int, int, int, Any]]


@final
class FieldMap:
    """A bilinear map with coefficients in a field: floats for float arguments, exact for exact ones.

    Parameters
    ----------
    entries : iterable of (i, j, k, value)
        As in `liehom.series.Bilinear`, with values in the field.
    shape : (a, b, c)
    field : Field

    Examples
    --------
    >>> import liehom as lh
    >>> action_map(lh.defining(lh.so(2)))([1.0], [1.0, 0.0]).tolist()
    [0.0, 1.0]
    """

    __slots__ = ("_entries", "_exact", "_field", "floating")

    def __init__(self, entries: Entries, shape: tuple[int, int, int], field: Any) -> None:
        self._entries = list(entries)
        self._field = field
        self._exact: Bilinear | None = None
        self.floating = Bilinear([(i, j, k, field.to_float(v)) for i, j, k, v in self._entries], shape)

    def __call__(self, x: Any, y: Any) -> Any:
        """B(x, y) for arrays or Jets."""
        return self._for(x, y)(x, y)

    def left(self, x: Any) -> Any:
        """The matrix of y -> B(x, y)."""
        return self._for(x).left(x)

    def right(self, y: Any) -> Any:
        """The matrix of x -> B(x, y)."""
        return self._for(y).right(y)

    def _for(self, *arguments: Any) -> Bilinear:
        values = [a.value if isinstance(a, Jet) else a for a in arguments]
        if not self._field.exact or not any(is_exact(v) for v in values):
            return self.floating
        if self._exact is None:
            self._exact = Bilinear(self._entries, self.floating.shape)
        return self._exact


def action_map(representation: Representation) -> FieldMap:
    """(x, m) -> rho(x) m for x (..., dim g) and m (..., N).

    Examples
    --------
    >>> import liehom as lh
    >>> action_map(lh.defining(lh.so(3))).left([1.0, 0.0, 0.0]).shape
    (3, 3)
    """
    n = representation.size
    entries = []
    for a, matrix in enumerate(representation.matrices):
        rows = matrix.to_rows()
        entries += [(a, j, i, rows[i][j]) for i in range(n) for j in range(n) if rows[i][j] != 0]
    return FieldMap(entries, (representation.algebra.dimension, n, n), representation.field)


def bracket_map(representation: Representation) -> FieldMap:
    """The bracket of the algebra on coefficient vectors.

    Examples
    --------
    >>> import liehom as lh
    >>> bracket_map(lh.defining(lh.so(3)))([1.0, 0, 0], [0, 1.0, 0]).tolist()
    [0.0, 0.0, 1.0]
    """
    entries = []
    for i, j, k, value in representation.algebra.structure_constants():
        entries += [(i, j, k, value), (j, i, k, -value)]
    return FieldMap(entries, (representation.algebra.dimension,) * 3, representation.field)
