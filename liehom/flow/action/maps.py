"""The action and the bracket as bilinear maps, and functions of matrices for exponentials."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from math import ceil, log, log2
from typing import Any, Literal, TypeVar, final

import numpy as np

from liehom.base.errors import InputError, SingularError
from liehom.base.typing import Array, IntegerArray, ObjectArray, Values, ValuesLike
from liehom.flow.door import Field, Matrix, Representation, Scalar, copies_of
from liehom.flow.series import arrays
from liehom.flow.series.arrays import NumbersLike, across_lanes, in_lanes, is_exact, is_jax, namespace
from liehom.flow.series.jet import Jet
from liehom.flow.series.lie_series import Bilinear, values_of
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Expr, Tape

# The action (x, m) -> rho(x) m and the bracket (x, y) -> [x, y] as bilinear maps on arrays and Jets.
#
#     B(x, y)_k = sum_(i, j) v_ijk x_i y_j,   v_ijk in the field of the representation
#
# The maps are evaluated in float64, in extended precision, on JAX arrays, on traced values and on exact numbers of the
# field. In extended precision each v_ijk is a sum of two floats, so that 1/3 or sqrt(2) is as precise as the
# arithmetic.

Entries = Iterable[tuple[int, int, int, Scalar]]

# a dense table is faster than a sparse one for tables of up to this many coefficients, and for larger ones with more
# than this fraction of non-zero coefficients
DENSE_SIZE = 32768
DENSE_FRACTION = 0.2
# measured: for L trajectories, products of columns are faster than a product of matrices if
# non-zeros * (COLUMN_OVERHEAD + L) <= L * (ROW_COST + size of the table / ENTRIES_PER_COST)
COLUMN_OVERHEAD, ROW_COST, ENTRIES_PER_COST = 2000, 20, 8


@final
class FieldMap(Bilinear):
    """A bilinear map with coefficients in a field: floats for float arguments, exact for exact ones."""

    __slots__ = (
        "_entries", "_exact", "_field", "_floats", "_many", "_pulled", "_rest", "_root", "_table", "_turned",
    )  # fmt: skip

    def __init__(self, entries: Entries, shape: tuple[int, int, int], field: Field) -> None:
        self._entries, self._field = list(entries), field
        rounded = [field.to_float(v) for *_, v in self._entries]
        if not np.isfinite(rounded).all():
            raise InputError("a bilinear map has numbers beyond the range of floats; scale them")
        places = [entry[:3] for entry in self._entries]
        # products with coefficient 1 come first: `_by_columns` starts each sum with one that needs no factor
        self._floats = sorted(((*p, v) for p, v in zip(places, rounded, strict=True)), key=lambda entry: entry[3] != 1)
        super().__init__(self._floats, shape)
        rests = [remainder(field, v, near) for (*_, v), near in zip(self._entries, rounded, strict=True)]
        left = [(*p, r) for p, r in zip(places, rests, strict=True) if r != 0]
        self._rest = Bilinear(left, shape) if left else None
        self._exact: Bilinear | None = None
        a, b, c = shape
        size = a * b * c
        dense = size <= DENSE_SIZE or len(places) > DENSE_FRACTION * size
        gain = ROW_COST + size / ENTRIES_PER_COST - len(places)
        self._many = COLUMN_OVERHEAD * len(places) / gain if gain > 0 else np.inf
        self._turned: Array | None = None
        self._pulled: FieldMap | None = None
        self._root: Array | None = None
        self._table: Array | None = np.ascontiguousarray(self.tensor().reshape(a, b * c)) if dense else None

    @property
    def scale(self) -> float:
        """The largest modulus of a coefficient."""
        return max((abs(value) for *_, value in self._floats), default=0.0)

    def left(self, x: ValuesLike | NumbersLike) -> Values:
        """The matrix of y -> B(x, y), shape (..., c, b)."""
        v = values_of(x)
        self._check(v.shape, (self.shape[1],))
        if self._table is not None and type(v) is np.ndarray and v.dtype == np.float64:
            return (v @ self._table).reshape(*v.shape[:-1], self.shape[1], self.shape[2]).swapaxes(-1, -2)
        return self._matrix(v, "left")

    def right(self, y: ValuesLike | NumbersLike) -> Values:
        """The matrix of x -> B(x, y), shape (..., c, a)."""
        v = values_of(y)
        self._check((self.shape[0],), v.shape)
        if self._table is not None and type(v) is np.ndarray and v.dtype == np.float64:
            if self._turned is None:
                table = self._table.reshape(self.shape).transpose(1, 2, 0)
                self._turned = np.ascontiguousarray(table.reshape(self.shape[1], -1))
            return (v @ self._turned).reshape(*v.shape[:-1], self.shape[2], self.shape[0])
        return self._matrix(v, "right")

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
            table = self.tensor().reshape(self.shape[0], self.shape[1] * self.shape[2])
            values, vectors = np.linalg.eigh(table @ table.T)
            self._root = vectors * np.sqrt(np.maximum(values, 0.0))
        turned = across_lanes(x, self._root)
        return np.sqrt(np.einsum("...i,...i->...", turned, turned))

    def _matrix(self, x: Values, side: Literal["left", "right"]) -> Values:
        if type(x) is Traced:
            row = x[..., None, :]
            pair = (row, np.eye(self.shape[1])) if side == "left" else (np.eye(self.shape[0]), row)
            return np.swapaxes(self._traced(*pair), -1, -2)
        if is_exact(x.value if isinstance(x, Jet) else x):
            return getattr(self._exactly(), side)(x)
        matrix: Values = getattr(super(), side)(x)
        return matrix if self._rest is None or x.dtype != np.longdouble else matrix + getattr(self._rest, side)(x)

    def _apply(self, x: Values, y: Any) -> Values:
        if self._table is not None and type(x) is type(y) is np.ndarray and x.dtype == y.dtype == np.float64:
            if x.ndim == y.ndim == 1:
                return y.dot(x.dot(self._table).reshape(self.shape[1:]))
            if self.works_by_columns(x, y):
                return self._by_columns(in_lanes(x), in_lanes(y))
            matrix = (x @ self._table).reshape(*x.shape[:-1], *self.shape[1:])
            return np.einsum("...b,...bc->...c", y, matrix)
        if type(x) is Traced or type(y) is Traced:
            return self._traced(x, y)
        if is_exact(x) or is_exact(y):
            return self._exactly()(x, y)
        result: Values = super()._apply(x, y)
        return result if self._rest is None or result.dtype != np.longdouble else result + self._rest(x, y)

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
        if tape.least_loop is not None:
            out.reshape(-1)[:] = self._in_loops(tape, left, right, lead)
            return Traced(tape, out)
        out.fill(tape.zero)
        for i, j, k, value in self._entries:
            out[..., k] = out[..., k] + left[..., i] * right[..., j] * self._field.to_float(value)
        return Traced(tape, out)

    def _in_loops(self, tape: Tape, left: ObjectArray, right: ObjectArray, lead: tuple[int, ...]) -> list[Expr]:
        """The entries of B(x, y) as one operation of a graph."""
        places = np.array([entry[:3] for entry in self._entries], dtype=np.int64).reshape(-1, 3)
        copies = np.arange(int(np.prod(lead, dtype=int)))[:, None]

        def operand(x: ObjectArray, place: IntegerArray) -> tuple[list[Expr], IntegerArray]:
            own = np.broadcast_to(np.arange(x.size // x.shape[-1]).reshape(x.shape[:-1]), lead).reshape(-1, 1)
            return list(x.reshape(-1)), (own * x.shape[-1] + place).reshape(-1)

        factors = np.tile([self._field.to_float(entry[3]) for entry in self._entries], len(copies))
        row = (copies * self.shape[2] + places[:, 2]).reshape(-1)
        operands = operand(left, places[:, 0]), operand(right, places[:, 1])
        return tape.summed(len(copies) * self.shape[2], row, factors, *operands)

    def _exactly(self) -> Bilinear:
        if self._exact is None:
            self._exact = Bilinear(self._entries if self._field.exact else self._floats, self.shape)
        return self._exact


@final
class FieldMatrix:
    """A linear map x -> M x on the last axis with entries in a field, on the arguments that a `FieldMap` takes."""

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

    def __call__(self, x: ValuesLike) -> Values:
        """M x for x (..., n), array or Jet."""
        values: Any = x
        value = values.value if isinstance(x, Jet) else values
        if is_exact(value):
            return values @ self._exact
        image: Values = values @ namespace(value).asarray(self._floating)
        return image if self._rest is None or value.dtype != np.longdouble else image + values @ self._rest


def remainder(field: Field, value: Scalar, near: float) -> float:
    """The float value - near, for the float `near` nearest to a number: their sum has twice the precision."""
    if not field.exact or near in (0.0, 1.0, -1.0):
        return 0.0
    top, bottom = float(near).as_integer_ratio()
    return field.to_float(value - field.convert(f"{top}/{bottom}"))


_latest: tuple[Representation, FieldMap] | None = None


def action_map(representation: Representation) -> FieldMap:
    """The bilinear map (x, m) -> rho(x) m for x (..., dim g) and m (..., N); one object for calls in a row."""
    global _latest
    known = _latest
    if known is None or known[0] is not representation:
        n, entries = representation.size, action_entries(representation)
        shape = (representation.algebra.dimension, n, n)
        known = _latest = representation, FieldMap(entries, shape, representation.field)
    return known[1]


def matrices_of(representation: Representation) -> Array:
    """The matrices rho(e_a) as floats, shape (dim g, N, N)."""
    return np.ascontiguousarray(np.swapaxes(action_map(representation).tensor(), 1, 2))


def action_entries(representation: Representation) -> list[tuple[int, int, int, Scalar]]:
    """The entries (a, j, i, value) of rho(e_a) in row i and column j that are not 0."""
    copies = copies_of(representation)
    if copies is not None:
        return copies.entries()
    return [
        (a, j, i, value)
        for a, matrix in enumerate(representation.matrices)
        for i, row in enumerate(matrix.to_rows())
        for j, value in enumerate(row)
        if value != 0
    ]


def connected(pairs: Iterable[Iterable[int]], size: int) -> list[list[int]]:
    """The classes of the numbers below a size that pairs connect, each in ascending order, by their least elements."""
    parent = list(range(size))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for i, j in pairs:
        parent[root(i)] = root(j)
    classes: dict[int, list[int]] = {}
    for i in range(size):
        classes.setdefault(root(i), []).append(i)
    return list(classes.values())


def bracket_map(representation: Representation) -> FieldMap:
    """The bilinear map (x, y) -> [x, y] on coefficient vectors."""
    constants = representation.algebra.structure_constants()
    entries = [entry for i, j, k, value in constants for entry in ((i, j, k, value), (j, i, k, -value))]
    return FieldMap(entries, (representation.algebra.dimension,) * 3, representation.field)


# Functions of matrices (..., n, n) for exponentials: exp(a) - 1, 2 artanh(a/2), and linear systems.
#
# They run in float64, in extended precision (which LAPACK does not support), and on JAX arrays with a fixed number of
# operations. A matrix that is not finite gives nan and does not affect the others of a batch.

S = TypeVar("S")

MAX_SQUARINGS = 60
MAX_TERMS = 60
JAX_SQUARINGS = 12
JAX_TERMS = 14
SERIES_RADIUS = 0.35
MAX_HALVINGS = 12
MAX_ITERATIONS = 60
# Newton steps for the square root in each halving under JAX; they reach round-off for |a| up to a few hundred
JAX_ITERATIONS = (16, 7, 6)


def norms(a: Values) -> Values:
    """The Frobenius norms of matrices, shape (...,)."""
    if type(a) is np.ndarray and a.ndim == 2:
        flat = a.ravel()
        return np.sqrt(flat.dot(flat))
    xp = namespace(a)
    return xp.sqrt(xp.einsum("...ij,...ij->...", a, a))


def applied(a: Values, x: Values) -> Any:
    """The vectors a x for matrices a (..., n, k) and vectors x (..., k)."""
    return (a @ x[..., None])[..., 0]


def identity(a: Values) -> Values:
    """The identity matrix of the size and dtype of a matrix."""
    return namespace(a).eye(a.shape[-1], dtype=a.dtype)


def expm1(a: Values) -> Values:
    """The matrices exp(a) - 1, with errors relative to their norms.

    The Taylor polynomial is evaluated at b = a / 2^s. Then exp(2b) - 1 = 2 (exp(b) - 1) + (exp(b) - 1)^2 is applied s
    times, which loses no digits for small a. Matrices of norm beyond 2^60 give nan: no digit of their exponential is
    determined.
    """
    if is_jax(a):
        result = _doubled(_taylor(a / 2**JAX_SQUARINGS, JAX_TERMS), JAX_SQUARINGS)
        return namespace(a).where((norms(a) < 2 ** (JAX_SQUARINGS - 1))[..., None, None], result, np.nan)
    a, bad, size = _finite(a, 2.0**MAX_SQUARINGS)
    squarings = max(0, ceil(log2(2 * size))) if size > 0 else 0
    terms = series_terms(size / 2**squarings, float(np.finfo(a.dtype).eps))
    return _marked(_doubled(_taylor(a / 2**squarings, terms), squarings), bad)


def series_terms(size: float, eps: float) -> int:
    """Number of terms after which size^j / j! is below eps / 8, at most 60."""
    j, bound = 1, size
    while bound > eps / 8 and j < MAX_TERMS:
        j += 1
        bound *= size / j
    return j


def _taylor(a: Values, terms: int) -> Values:
    """The sum a + a^2/2 + ... by Horner's rule."""
    return _repeated(_horner, terms - 1, (a, a / terms, terms - 1))[1]


def _horner(_: int, state: tuple[Values, Values, int]) -> tuple[Values, Values, int]:
    a, total, k = state
    return a, (a + a @ total) / k, k - 1


def _doubled(e: Values, times: int) -> Values:
    return _repeated(lambda _, e: 2 * e + e @ e, times, e)


def _repeated(body: Callable[[int, S], S], times: int, state: S) -> S:
    """The state after body(i, state) for i < times; under JAX in one loop, compiled once and differentiable."""
    if any(is_jax(x) for x in (state if isinstance(state, tuple) else (state,))):
        return sys.modules["jax"].lax.fori_loop(0, times, body, state)
    for i in range(times):
        state = body(i, state)
    return state


def cayley_logarithm(a: Values) -> Values:
    """The y = 2 artanh(a/2) = a + a^3/12 + a^5/80 + ... with exp(y) = (1 - a/2)^-1 (1 + a/2).

    artanh(z) = 2 artanh(z / (1 + sqrt(1 - z^2))) is applied until z is small enough for the series.
    """
    if is_jax(a):
        z, factor = a / 2, 2
        for iterations in JAX_ITERATIONS:
            z, factor = _halved(z, iterations), 2 * factor
        return factor * _artanh(z, 16)
    z, bad, size = _finite(a / 2, 1e100)
    factor = 2
    while not size < SERIES_RADIUS and factor < 2 ** (MAX_HALVINGS + 1):
        z, factor = _halved(z, None), 2 * factor
        size = float(norms(z).max(initial=0.0))
    # size^(2 terms) is below round-off
    terms = 2 + int(log(float(np.finfo(a.dtype).eps)) / (2 * log(max(size, 1e-20))))
    return _marked(factor * _artanh(z, terms), bad)


def _halved(z: Values, iterations: int | None) -> Values:
    """The matrix tanh(artanh(z) / 2)."""
    one = identity(z)
    b = one - z @ z
    start = b, namespace(b).broadcast_to(one, b.shape)
    if iterations is not None:
        return solve(one + _repeated(_newton, iterations, start)[0], z)
    root = _square_root(b, start)
    # if 1 - z^2 has a negative eigenvalue, no square root is a function of it, and others do not commute with z
    if root is None or not bool(np.all(norms(root @ z - z @ root) <= 1e-6 * norms(root) * norms(z))):
        raise SingularError(
            "the Cayley transform of x is on no one-parameter group: its matrix has a real eigenvalue beyond 2 in "
            "size; take a smaller step, or exponential='exp'"
        )
    return solve(one + root, z)


def _newton(_: int, state: tuple[Values, Values]) -> tuple[Values, Values]:
    """One step of the coupled iteration that takes (b, 1) to (sqrt(b), 1/sqrt(b))."""
    y, p = state
    return (y + inverse(p)) / 2, (p + inverse(y)) / 2


def _square_root(b: Values, state: tuple[Values, Values]) -> Values | None:
    """The square root of b, or None if the iteration does not converge."""
    for i in range(MAX_ITERATIONS):
        y, p = _newton(i, state)
        if _has_converged(y, p, state[0], b):
            return y
        state = y, p
    return None


def _has_converged(y: Values, p: Values, before: Values, b: Values) -> bool:
    spread = norms(y) * norms(p)  # the condition number, to which round-off is proportional
    bound = 8 * b.shape[-1] * float(np.finfo(b.dtype).eps) * norms(y) * spread
    return bool(np.all(norms(y - before) <= bound)) and bool(np.all(norms(y @ y - b) <= 1e-6 * norms(b)))


def _artanh(z: Values, terms: int) -> Values:
    """The sum z + z^3/3 + z^5/5 + ... by Horner's rule."""
    start = z @ z, z, z / (2 * terms - 1), 2 * terms - 3
    return _repeated(_odd_horner, terms - 1, start)[2]


def _odd_horner(_: int, state: tuple[Values, Values, Values, int]) -> tuple[Values, Values, Values, int]:
    square, z, total, k = state
    return square, z, z / k + square @ total, k - 2


def solve(a: Values, b: Values) -> Values:
    """The solution x of a x = b, for b of shape (..., n, k)."""
    try:
        return arrays.solve(a, b)
    except np.linalg.LinAlgError:
        raise SingularError("a linear system is singular: 1 - x/2, for a Cayley transform of x") from None


def inverse(a: Values) -> Values:
    """The inverse matrix, in the precision of a."""
    return solve(a, namespace(a).broadcast_to(identity(a), a.shape))


def _finite(a: Values, limit: float) -> tuple[Values, Values | None, float]:
    """The matrices with 0 for those too large or not finite, the mask of these (or None), and the largest norm."""
    size = norms(a)
    bad = ~(size < limit)
    if not bool(np.any(bad)):
        return a, None, float(np.max(size, initial=0.0))
    return np.where(bad[..., None, None], 0, a), bad, float(np.max(np.where(bad, 0, size), initial=0.0))


def _marked(a: Values, bad: Values | None) -> Values:
    return a if bad is None else np.where(bad[..., None, None], a.dtype.type(np.nan), a)
