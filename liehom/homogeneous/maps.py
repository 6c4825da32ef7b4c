"""The action (x, m) -> rho(x) m and the bracket (x, y) -> [x, y] as bilinear maps on arrays and Jets.

    B(x, y)_k = sum_(i, j) v_ijk x_i y_j,   v_ijk in the field of the representation

The maps are evaluated in float64, in extended precision, on JAX arrays, on traced values and on exact numbers of the
field. In extended precision each v_ijk is a sum of two floats, so that 1/3 or sqrt(2) is as precise as the arithmetic.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal, final, overload

import numpy as np

from liehom.errors import InputError, ShapeError
from liehom.representations import Representation
from liehom.representations.core.copies import copies_of
from liehom.scalars import Field, Matrix, Scalar
from liehom.series import recurrences
from liehom.series.arrays import across_lanes, in_lanes, is_exact, is_lazy, namespace, zeros
from liehom.series.bilinear import Bilinear
from liehom.series.jet import Jet
from liehom.series.node import Node
from liehom.tracing.array import Traced
from liehom.typing import Array, Values, ValuesLike

Entries = Iterable[tuple[int, int, int, Scalar]]

# a dense table is faster than a sparse one for tables of up to this many coefficients, and for larger ones with more
# than this fraction of non-zero coefficients
DENSE_SIZE = 32768
DENSE_FRACTION = 0.2
# measured: for L trajectories, products of columns are faster than a product of matrices if
# non-zeros * (COLUMN_OVERHEAD + L) <= L * (ROW_COST + size of the table / ENTRIES_PER_COST)
COLUMN_OVERHEAD, ROW_COST, ENTRIES_PER_COST = 2000, 20, 8


@final
class FieldMap:
    """A bilinear map with coefficients in a field: floats for float arguments, exact for exact ones.

    Parameters
    ----------
    entries : iterable of (i, j, k, value)
        B(e_i, e_j) has `value`, a number of the field, in component k.
    shape : (a, b, c)
    field : Field

    Raises
    ------
    ShapeError
        If an argument does not have a, or b, components on its last axis.

    Examples
    --------
    >>> import liehom as lh
    >>> action_map(lh.defining(lh.so(2)))([1.0], [1.0, 0.0]).tolist()
    [0.0, 1.0]
    """

    shape: tuple[int, int, int]

    __slots__ = (
        "_entries",
        "_exact",
        "_field",
        "_floating",
        "_floats",
        "_many",
        "_pulled",
        "_rest",
        "_root",
        "_table",
        "_turned",
        "shape",
    )

    def __init__(self, entries: Entries, shape: tuple[int, int, int], field: Field) -> None:
        self._entries = list(entries)
        self._field = field
        self.shape = shape
        rounded = [field.to_float(v) for *_, v in self._entries]
        if not np.isfinite(rounded).all():
            raise InputError("a bilinear map has numbers beyond the range of floats; scale them")
        places = [entry[:3] for entry in self._entries]
        # products with coefficient 1 come first: `_by_columns` starts each sum with one that needs no factor
        self._floats = sorted(((*p, v) for p, v in zip(places, rounded, strict=True)), key=lambda entry: entry[3] != 1)
        self._floating = Bilinear(self._floats, shape)
        rests = [remainder(field, v, near) for (*_, v), near in zip(self._entries, rounded, strict=True)]
        left = [(*p, r) for p, r in zip(places, rests, strict=True) if r != 0]
        self._rest = Bilinear(left, shape) if left else None
        self._exact: Bilinear | None = None
        a, b, c = shape
        dense = a * b * c <= DENSE_SIZE or len(places) > DENSE_FRACTION * a * b * c
        gain = ROW_COST + a * b * c / ENTRIES_PER_COST - len(places)
        self._many = COLUMN_OVERHEAD * len(places) / gain if gain > 0 else np.inf
        self._turned: Array | None = None
        self._pulled: FieldMap | None = None
        self._root: Array | None = None
        self._table: Array | None = np.ascontiguousarray(self._floating.tensor().reshape(a, b * c)) if dense else None

    @overload
    def __call__(self, x: Jet, y: ValuesLike | Jet) -> Jet: ...
    @overload
    def __call__(self, x: ValuesLike, y: Jet) -> Jet: ...
    @overload
    def __call__(self, x: ValuesLike, y: ValuesLike) -> Values: ...
    def __call__(self, x: ValuesLike, y: ValuesLike) -> Values:
        """B(x, y) for x (..., a) and y (..., b): array or Jet of shape (..., c)."""
        if isinstance(x, Jet):
            if isinstance(y, Jet):
                self._check(x.shape, y.shape)
                return Jet.from_node(recurrences.bilinear(self._apply, x.node, y.node, self._zero(x.node, y.node)))
            right = _array(y)
            self._check(x.shape, right.shape)
            return Jet.from_node(recurrences.linear(lambda v: self._apply(v, right), [x.node]))
        left = _array(x)
        if isinstance(y, Jet):
            self._check(left.shape, y.shape)
            return Jet.from_node(recurrences.linear(lambda v: self._apply(left, v), [y.node]))
        right = _array(y)
        self._check(left.shape, right.shape)
        return self._apply(left, right)

    def _zero(self, x: Node, y: Node) -> Values | None:
        """Zeros of the shape of B(x, y) if x or y is 0 at 0 and both are numpy arrays of one dtype, else None."""
        a, b = x.value, y.value
        if (x.known[0] is None or y.known[0] is None) and type(a) is type(b) is np.ndarray and a.dtype == b.dtype:
            return zeros(a, (*np.broadcast_shapes(a.shape[:-1], b.shape[:-1]), self.shape[2])) if a.size else None
        return None

    @overload
    def left(self, x: Jet) -> Jet: ...
    @overload
    def left(self, x: ValuesLike) -> Values: ...
    def left(self, x: ValuesLike) -> Values:
        """The matrix of y -> B(x, y), shape (..., c, b)."""
        x = x if isinstance(x, Jet) else _array(x)
        self._check(x.shape, (self.shape[1],))
        if self._table is not None and type(x) is np.ndarray and x.dtype == np.float64:
            made: Array = (x @ self._table).reshape(*x.shape[:-1], self.shape[1], self.shape[2]).swapaxes(-1, -2)
            return made
        return self._matrix(x, "left")

    @overload
    def right(self, y: Jet) -> Jet: ...
    @overload
    def right(self, y: ValuesLike) -> Values: ...
    def right(self, y: ValuesLike) -> Values:
        """The matrix of x -> B(x, y), shape (..., c, a)."""
        y = y if isinstance(y, Jet) else _array(y)
        self._check((self.shape[0],), y.shape)
        if self._table is not None and type(y) is np.ndarray and y.dtype == np.float64:
            if self._turned is None:
                table = self._table.reshape(self.shape).transpose(1, 2, 0)
                self._turned = np.ascontiguousarray(table.reshape(self.shape[1], -1))
            made: Array = (y @ self._turned).reshape(*y.shape[:-1], self.shape[2], self.shape[0])
            return made
        return self._matrix(y, "right")

    def right_transposed(self, y: ValuesLike, z: ValuesLike) -> Values:
        """R^T z for the matrix R of x -> B(x, y): the transpose of ``right(y)`` on z (..., c), shape (..., a)."""
        if self._pulled is None:
            a, b, c = self.shape
            self._pulled = FieldMap([(j, k, i, v) for i, j, k, v in self._entries], (b, c, a), self._field)
        return self._pulled(y, z)

    def works_by_columns(self, x: Values, y: Values) -> bool:
        """Whether B(x, y) is computed by products of columns: for ensembles that are large compared to the table."""
        return (
            self._table is not None
            and type(x) is np.ndarray
            and type(y) is np.ndarray
            and x.ndim > 1
            and x.shape[:-1] == y.shape[:-1]
            and x.size >= self._many * self.shape[0]
            and x.dtype == np.float64
            and y.dtype == np.float64
        )

    def frobenius_norms(self, x: Values) -> Array:
        """The Frobenius norms of the matrices ``left(x)``, shape (...,), for x (..., a), without these matrices."""
        if self._root is None:
            table = self._floating.tensor().reshape(self.shape[0], self.shape[1] * self.shape[2])
            values, vectors = np.linalg.eigh(table @ table.T)
            self._root = vectors * np.sqrt(np.maximum(values, 0.0))
        turned = across_lanes(x, self._root)
        made: Array = np.sqrt(np.einsum("...i,...i->...", turned, turned))
        return made

    def _matrix(self, x: Values, side: Literal["left", "right"]) -> Values:
        if type(x) is Traced:
            count = self.shape[1] if side == "left" else self.shape[0]
            columns = self._traced(
                *((x[..., None, :], np.eye(count)) if side == "left" else (np.eye(count), x[..., None, :]))
            )
            transposed: Values = np.swapaxes(columns, -1, -2)
            return transposed
        if is_exact(x.value if isinstance(x, Jet) else x):
            exact: Values = getattr(self._exactly(), side)(x)
            return exact
        made: Values = getattr(self._floating, side)(x)
        return made if self._rest is None or x.dtype != np.longdouble else made + getattr(self._rest, side)(x)

    def _apply(self, x: Values, y: Any) -> Values:
        if self._table is not None and type(x) is np.ndarray and x.dtype == y.dtype == np.float64:
            if x.ndim == y.ndim == 1:
                one: Array = y.dot(x.dot(self._table).reshape(self.shape[1:]))
                return one
            if self.works_by_columns(x, y):
                return self._by_columns(in_lanes(x), in_lanes(y))
            matrix = (x @ self._table).reshape(*x.shape[:-1], *self.shape[1:])
            many: Array = np.einsum("...b,...bc->...c", y, matrix)
            return many
        if type(x) is Traced or type(y) is Traced:
            return self._traced(x, y)
        if is_exact(x) or is_exact(y):
            exact: Values = self._exactly()(x, y)
            return exact
        made: Values
        if self._table is not None:
            xp = namespace(x, y)
            matrix = (x @ xp.asarray(self._table, dtype=x.dtype)).reshape(*x.shape[:-1], *self.shape[1:])
            made = xp.einsum("...b,...bc->...c", y, matrix)
        else:
            made = self._floating(x, y)
        extended = self._rest is not None and made.dtype == np.longdouble
        return made + self._rest(x, y) if extended and self._rest is not None else made

    def _by_columns(self, x: Array, y: Array) -> Array:
        """B(x, y) by one product of columns for each coefficient; faster for large ensembles and sparse tables."""
        out, spare = np.empty((self.shape[2], *x.shape[:-1])), np.empty(x.shape[:-1])
        left, right = [x[..., i] for i in range(self.shape[0])], [y[..., j] for j in range(self.shape[1])]
        begun = [False] * self.shape[2]
        for i, j, k, value in self._floats:
            term = np.multiply(left[i], right[j], out=spare if begun[k] else out[k])
            if value not in (1, -1) or (value == -1 and not begun[k]):
                term *= value
            if begun[k]:
                (np.subtract if value == -1 else np.add)(out[k], term, out=out[k])
            begun[k] = True
        for k, some in enumerate(begun):
            if not some:
                out[k] = 0.0
        return out.T if out.ndim == 2 else np.moveaxis(out, 0, -1)

    def _traced(self, x: Values, y: Values) -> Traced:
        """B(x, y) by one traced product for each non-zero coefficient."""
        tape = next(v.tape for v in (x, y) if type(v) is Traced)
        left, right = Traced(tape, x).entries, Traced(tape, y).entries
        lead = np.broadcast_shapes(left.shape[:-1], right.shape[:-1])
        out = np.empty((*lead, self.shape[2]), dtype=object)
        out.fill(tape.zero)
        for i, j, k, value in self._entries:
            out[..., k] = out[..., k] + left[..., i] * right[..., j] * self._field.to_float(value)
        return Traced(tape, out)

    def _exactly(self) -> Bilinear:
        if not self._field.exact:
            return self._floating
        if self._exact is None:
            self._exact = Bilinear(self._entries, self.shape)
        return self._exact

    def _check(self, x: tuple[int, ...], y: tuple[int, ...]) -> None:
        a, b, _ = self.shape
        if not x or not y or x[-1] != a or y[-1] != b:
            raise ShapeError(
                f"arguments of shapes {x} and {y}, expected (..., {a}) and (..., {b}), components on the last axis"
            )


@final
class FieldMatrix:
    """A linear map x -> M x on the last axis with entries in a field, on the arguments that a `FieldMap` takes.

    Parameters
    ----------
    matrix : Matrix
        M, over a field.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> third = FieldMatrix(lh.QQ.matrix([["1/3", 0]]))
    >>> third(np.array([3.0, 1.0])), third(np.array([lh.QQ.one, lh.QQ.zero]))
    (array([1.]), array([1/3], dtype=object))
    """

    __slots__ = ("_exact", "_floating", "_rest")

    def __init__(self, matrix: Matrix) -> None:
        field = matrix.field
        self._floating = np.ascontiguousarray(matrix.to_numpy().T)
        exact = np.empty(matrix.shape, dtype=object)
        rest = np.zeros(matrix.shape)
        for i, row in enumerate(matrix.to_rows()):
            for j, value in enumerate(row):
                exact[i, j] = value
                rest[i, j] = remainder(field, value, self._floating[j, i])
        self._exact = exact.T if field.exact else self._floating
        self._rest = rest.T if rest.any() else None

    @overload
    def __call__(self, x: Jet) -> Jet: ...
    @overload
    def __call__(self, x: ValuesLike) -> Values: ...
    def __call__(self, x: ValuesLike) -> Values:
        """M x for x (..., n), array or Jet."""
        given: Any = x
        value = x.value if isinstance(x, Jet) else given
        if is_exact(value):
            exact: Values = given @ self._exact
            return exact
        made: Values = given @ namespace(value).asarray(self._floating)
        return made if self._rest is None or value.dtype != np.longdouble else made + given @ self._rest


def remainder(field: Field, value: Scalar, near: float) -> float:
    """The float value - near, for the float `near` nearest to a number: their sum has twice the precision.

    Examples
    --------
    >>> import liehom as lh
    >>> remainder(lh.QQ, lh.QQ.convert("1/3"), 1 / 3)
    1.850371707708594e-17
    """
    if not field.exact or near in (0.0, 1.0, -1.0):
        return 0.0
    top, bottom = float(near).as_integer_ratio()
    return field.to_float(value - field.convert(f"{top}/{bottom}"))


def action_map(representation: Representation) -> FieldMap:
    """The bilinear map (x, m) -> rho(x) m for x (..., dim g) and m (..., N).

    Examples
    --------
    >>> import liehom as lh
    >>> action_map(lh.defining(lh.so(3))).left([1.0, 0.0, 0.0]).shape
    (3, 3)
    """
    n = representation.size
    return FieldMap(action_entries(representation), (representation.algebra.dimension, n, n), representation.field)


def action_entries(representation: Representation) -> list[tuple[int, int, int, Scalar]]:
    """The entries (a, j, i, value) of rho(e_a) in row i and column j that are not 0.

    Examples
    --------
    >>> import liehom as lh
    >>> action_entries(lh.defining(lh.so(2)))
    [(0, 1, 0, -1), (0, 0, 1, 1)]
    """
    copies = copies_of(representation)
    if copies is not None:
        return copies.entries()
    n = representation.size
    entries = []
    for a, matrix in enumerate(representation.matrices):
        rows = matrix.to_rows()
        entries += [(a, j, i, rows[i][j]) for i in range(n) for j in range(n) if rows[i][j] != 0]
    return entries


def bracket_map(representation: Representation) -> FieldMap:
    """The bilinear map (x, y) -> [x, y] on coefficient vectors.

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


def _array(x: ValuesLike) -> Any:
    if type(x) is np.ndarray and x.dtype.kind == "f":
        return x
    if is_lazy(x):
        return x
    array = np.asarray(x)
    return array.astype(np.float64) if array.dtype.kind in "iub" else array
