"""Bilinear maps of series, and series in Lie algebras."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from fractions import Fraction
from math import factorial
from operator import matmul
from typing import Any, TypeAlias

import flint
import numpy as np
import numpy.typing as npt

from liehom.base.errors import SeriesError, ShapeError
from liehom.base.typing import Values
from liehom.flow.series import node as recurrences
from liehom.flow.series.arrays import NumbersLike, as_values, constant_like, is_jax, is_traced, namespace, owned, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.series.node import Coefficient, Node, plus

# Bilinear: a bilinear map with constant sparse coefficients, such as the bracket or the action rho(x) m, on numpy
# arrays, JAX arrays, exact scalars and Jets: B(x, y)_k = sum over entries (i, j, k, v) of v x_i y_j.

DENSE_UP_TO_ENTRIES = 4096
DENSE_FROM_FRACTION = 0.2
"""A map is applied as one dense matrix if a b c is at most DENSE_UP_TO_ENTRIES, or more than this fraction of its
entries is not 0."""


class Bilinear:
    """Bilinear map K^a x K^b -> K^c with constant coefficients.

    Parameters
    ----------
    entries : iterable of (i, j, k, value)
        B(e_i, e_j) has value in component k; entries with the same indices add up.
    shape : (a, b, c)

    Examples
    --------
    >>> cross = Bilinear([(0, 1, 2, 1.0), (1, 0, 2, -1.0)], (2, 2, 3))
    >>> cross([1.0, 0.0], [0.0, 1.0])
    array([0., 0., 1.])
    """

    __slots__ = ("__weakref__", "_cache", "_dense", "_i", "_j", "_k", "_starts", "_values", "shape")

    def __init__(self, entries: Iterable[tuple[int, int, int, Any]], shape: tuple[int, int, int]) -> None:
        rows = sorted(entries, key=lambda entry: (entry[2], entry[0], entry[1]))
        for i, j, k, _ in rows:
            if not (0 <= i < shape[0] and 0 <= j < shape[1] and 0 <= k < shape[2]):
                raise ShapeError(f"entry ({i}, {j}, {k}) of a bilinear map of shape {shape}")
        self.shape: tuple[int, int, int] = shape
        self._i, self._j, self._k = (np.array([row[a] for row in rows], dtype=int) for a in range(3))
        self._values = np.empty(len(rows), dtype=object)
        self._values[:] = [int(v) if isinstance(v, np.integer) else v for *_, v in rows]
        self._starts = np.flatnonzero(np.r_[True, self._k[1:] != self._k[:-1]]) if rows else np.zeros(0, dtype=int)
        size = shape[0] * shape[1] * shape[2]
        self._dense = size <= DENSE_UP_TO_ENTRIES or len(rows) > DENSE_FROM_FRACTION * size
        self._cache: dict[Hashable, npt.NDArray[Any]] = {}

    def tensor(self) -> npt.NDArray[Any]:
        """Coefficients as an array of shape (a, b, c), of floats, or of objects if a coefficient is exact or symbolic.

        Examples
        --------
        >>> Bilinear([(0, 1, 0, 2)], (1, 2, 1)).tensor().tolist()
        [[[0.0], [2.0]]]
        """
        plain = all(isinstance(v, int | float | np.floating) for v in self._values)
        return self._filled(self._values.astype(np.float64) if plain else self._values)

    def __call__(self, x: NumbersLike, y: NumbersLike) -> Any:
        """B(x, y), array of shape (..., c), for x (..., a) and y (..., b); a Jet if x or y is one."""
        a, b = values_of(x), values_of(y)
        self._check(a.shape, b.shape)
        if isinstance(a, Jet):
            if isinstance(b, Jet):
                return Jet.from_node(recurrences.bilinear(self._apply, a.node, b.node, self._zero(a.node, b.node)))
            right = owned(b)
            return Jet.from_node(recurrences.linear(lambda left: self._apply(left, right), [a.node]))
        if isinstance(b, Jet):
            left = owned(a)
            return Jet.from_node(recurrences.linear(lambda right: self._apply(left, right), [b.node]))
        return self._apply(a, b)

    def _check(self, x: tuple[int, ...], y: tuple[int, ...]) -> None:
        a, b, _ = self.shape
        if not x or not y or x[-1] != a or y[-1] != b:
            raise ShapeError(
                f"arguments of shapes {x} and {y}, expected (..., {a}) and (..., {b}), components on the last axis"
            )

    def _zero(self, x: Node, y: Node) -> Values | None:
        """Zeros of the shape of B(x, y) if x or y is 0 at 0 and both are numpy arrays of one dtype, else None."""
        a, b = x.value, y.value
        if (x.known[0] is None or y.known[0] is None) and type(a) is type(b) is np.ndarray and a.dtype == b.dtype:
            return zeros(a, (*np.broadcast_shapes(a.shape[:-1], b.shape[:-1]), self.shape[2])) if a.size else None
        return None

    def left(self, x: NumbersLike) -> Values:
        """The matrix of y -> B(x, y), shape (..., c, b).

        Examples
        --------
        >>> Bilinear([(0, 1, 2, 1.0)], (2, 2, 3)).left([2.0, 0.0])[2].tolist()
        [0.0, 2.0]
        """
        return self._contracted("...i,ijk->...kj", x)

    def right(self, y: NumbersLike) -> Values:
        """The matrix of x -> B(x, y), shape (..., c, a)."""
        return self._contracted("...j,ijk->...ki", y)

    def _contracted(self, subscripts: str, x: NumbersLike) -> npt.NDArray[Any]:
        factor = values_of(x)
        xp, value = (np, factor.value) if isinstance(factor, Jet) else (namespace(factor), factor)
        tensor = self._cached("tensor", value, lambda: self._filled(self._coefficients(value)))
        return xp.einsum(subscripts, factor, tensor)

    def _filled(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        out = np.zeros(self.shape, dtype=values.dtype)
        np.add.at(out, (self._i, self._j, self._k), values)
        return out

    def _apply(self, x: Values, y: Any) -> Values:
        a, b, c = self.shape
        kind: Any = x if x.dtype == y.dtype else np.broadcast_to(np.zeros((), np.result_type(x.dtype, y.dtype)), (1,))
        if kind.dtype == object:
            kind = x if x.dtype == object else y
        elif self._dense:
            matrix = self._cached("matrix", kind, lambda: self._filled(self._coefficients(kind)).reshape(a * b, c))
            if matrix.dtype != object:
                pairs = x[..., :, None] * y[..., None, :]
                xp, flat = namespace(pairs), pairs.reshape(*pairs.shape[:-2], a * b)
                return flat @ (matrix if xp is np else xp.asarray(matrix))
        products: Any = (
            x[..., self._i] * y[..., self._j] * self._cached("values", kind, lambda: self._coefficients(kind))
        )
        return self._collected(products, kind)

    def _collected(self, products: npt.NDArray[Any], kind: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Array (..., c) of the sums of the products that belong to each component."""
        shape = (*products.shape[:-1], self.shape[2])
        if is_jax(products):
            blank: Any = zeros(products, shape)
            return blank.at[..., self._k].add(products)
        out = zeros(products if products.size else kind, shape)
        if len(self._starts):
            out[..., self._k[self._starts]] = np.add.reduceat(products, self._starts, axis=-1)
        return out

    def _coefficients(self, like: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Coefficients as numbers of the kind of `like`."""
        if like.dtype == object:
            return constant_like(like, self._values)
        dtype = np.zeros((), like.dtype).real.dtype
        try:
            return np.array([constant_like(np.zeros((), dtype), v)[()] for v in self._values], dtype=dtype)
        except TypeError:  # symbols
            return self._values

    def _cached(self, name: str, like: npt.NDArray[Any], make: Callable[[], npt.NDArray[Any]]) -> npt.NDArray[Any]:
        """The value of make(), cached by its name and the kind of numbers in `like`."""
        key: Hashable = (name, np.dtype(like.dtype))
        if like.dtype == object:
            kind = type(like.flat[0]) if like.size else None
            if kind is None or not issubclass(kind, Fraction | flint.fmpq):
                return make()
            key = (name, kind)
        if key not in self._cache:
            self._cache[key] = make()
        return self._cache[key]


def values_of(x: NumbersLike) -> Any:
    """A Jet, or an array of floats or exact numbers."""
    return x if isinstance(x, Jet) or (type(x) is np.ndarray and x.dtype.kind in "fcO") else as_values(x)


# Series in Lie algebras: dexp and its inverse, Magnus, Baker-Campbell-Hausdorff, Cayley, to any order.
#
#     dexp_x y = sum_k ad_x^k y / (k + 1)!,      dexp_x^-1 y = sum_k B_k ad_x^k y / k!      (B_1 = -1/2)
#
# With [a, b] = a b - b a, exp(x(t)) solves Y' = a Y, Y(0) = 1, if and only if x' = dexp_x^-1 a, x(0) = 0; and
# cay(x(t)), cay(x) = (1 - x/2)^-1 (1 + x/2), if and only if x' = (1 - x/2) a (1 + x/2).  For z = log(exp x exp y)
#
#     z' = dexp_z^-1 (dexp_x x') + dexp_(-z)^-1 (dexp_(-y) y').
#
# Each coefficient is computed from as few coefficients of the operands as possible, in floats, JAX arrays or exactly.

Bracket: TypeAlias = Callable[[Any, Any], Any]
"""A bilinear map on arrays and Jets: a `Bilinear` on coefficient vectors (..., dim), `commutator` on matrices."""


def commutator(a: Values, b: Values) -> Values:
    """a b - b a for matrices (..., n, n); the bracket of a matrix Lie algebra.

    Examples
    --------
    >>> import numpy as np
    >>> commutator(np.array([[0, 1], [0, 0]]), np.array([[0, 0], [1, 0]])).tolist()
    [[1, 0], [0, -1]]
    """
    return a @ b - b @ a


def bernoulli(n: int) -> list[Fraction]:
    """The Bernoulli numbers B_0, ..., B_n, with B_1 = -1/2.

    Examples
    --------
    >>> [str(b) for b in bernoulli(4)]
    ['1', '-1/2', '1/6', '0', '-1/30']
    """
    return [Fraction(int(b.p), int(b.q)) for b in map(flint.fmpq.bernoulli, range(n + 1))]


# -- the derivative of the exponential -----------------------------------------------------------------------
def dexp(bracket: Bracket, x: NumbersLike, y: NumbersLike, terms: int | None = None) -> Values:
    """dexp_x y = sum_(k < terms) ad_x^k y / (k + 1)!, where (exp x(t))' = dexp_x(x') exp(x).

    Parameters
    ----------
    bracket : callable
        Bilinear, on arrays: a `Bilinear` on coefficient vectors (..., dim), or `commutator` on matrices.
    x, y : array_like or Jet
    terms : int, optional
        Number of terms. Default: as many as the order needs for a Jet x with x(0) = 0; else `SeriesError`.

    Examples
    --------
    >>> x, y = [[0.0, 1.0], [0.0, 0.0]], [[0.0, 0.0], [6.0, 0.0]]
    >>> dexp(commutator, x, y, 3).tolist()
    [[3.0, -2.0], [6.0, -3.0]]
    """
    return _series_in_ad(bracket, x, y, [Fraction(1, factorial(k + 1)) for k in range(_count(x, y, terms))])


def dexp_inverse(bracket: Bracket, x: NumbersLike, y: NumbersLike, terms: int | None = None) -> Values:
    """dexp_x^-1 y = sum_(k < terms) B_k ad_x^k y / k!; see `dexp` for the arguments.

    Examples
    --------
    >>> x, y = [[0.0, 1.0], [0.0, 0.0]], [[3.0, -2.0], [6.0, -3.0]]
    >>> dexp_inverse(commutator, x, y, 3).tolist()
    [[0.0, 0.0], [6.0, 0.0]]
    """
    numbers = bernoulli(_count(x, y, terms) - 1)
    return _series_in_ad(bracket, x, y, [b / factorial(k) for k, b in enumerate(numbers)])


def _count(x: NumbersLike, y: NumbersLike, terms: int | None) -> int:
    """Number of terms; ad_x^k y begins at t^k if x begins at t."""
    if terms is not None:
        if terms < 1:
            raise SeriesError(f"a series in ad_x has at least one term, got terms={terms}")
        return terms
    if not isinstance(x, Jet) or x.node.known[0] is not None:
        raise SeriesError(
            "the number of terms is needed unless x is a series without a constant term (see without_constant)"
        )
    order = min(x.order, y.order) if isinstance(y, Jet) else x.order
    return max(1, order if isinstance(y, Jet) and y.node.known[0] is None else order + 1)


def _series_in_ad(bracket: Bracket, x: NumbersLike, y: NumbersLike, weights: list[Fraction]) -> Values:
    """The sum over k of weights[k] ad_x^k y."""
    while len(weights) > 1 and not weights[-1]:
        weights = weights[:-1]
    if isinstance(x, Jet) or isinstance(y, Jet):
        order = min(v.order for v in (x, y) if isinstance(v, Jet))
        above, term = (v.node if isinstance(v, Jet) else recurrences.constant(as_values(v), order) for v in (x, y))
        powers = [term]
        for _ in weights[1:]:
            powers.append(recurrences.multilinear(bracket, [above, powers[-1]]))
        return Jet.from_node(_weighted(powers, weights))
    element, power = as_values(x), as_values(y)
    total = _scaled(power, weights[0])
    for weight in weights[1:]:
        power = bracket(element, power)
        if weight:
            total = total + _scaled(power, weight)
    return total


def _weighted(nodes: Sequence[Node], weights: Sequence[Fraction], first: Values | None = None) -> Node:
    """Node of sum_i weights[i] nodes[i], with coefficient 0 replaced by `first` if given."""
    used = [(node, weight) for node, weight in zip(nodes, weights, strict=True) if weight]

    def rule(k: int) -> Coefficient:
        total = None
        for node, weight in used:
            if node.known[k] is not None:
                total = plus(total, _scaled(node.known[k], weight))
        return total

    value = first
    if value is None:
        value = _scaled(used[0][0].value, used[0][1])
        for node, weight in used[1:]:
            value = value + _scaled(node.value, weight)
        first = None if all(node.known[0] is None for node, _ in used) else value
    return Node(min(node.order for node, _ in used), value, [first], tuple((node, 0) for node, _ in used), rule)


def _scaled(x: Values, weight: Fraction) -> Values:
    """weight * x, exact, or with the weight rounded once in the type of x."""
    if weight == 1:
        return x
    top, bottom = weight.numerator, weight.denominator
    if not is_jax(x):
        if x.dtype == object:
            product = x if top == 1 else x * top
            return product if bottom == 1 else product / bottom
        if x.dtype.char in "gG":
            return x * (np.longdouble(top) / np.longdouble(bottom))
    return x * float(weight)


# -- the Cayley transform ------------------------------------------------------------------------------------
def dcayley_inverse(x: Values, y: Values) -> Values:
    """(1 - x/2) y (1 + x/2) for matrices or Jets of matrices, where (cay x)' = a cay(x) gives x' with y = a.

    Examples
    --------
    >>> import numpy as np
    >>> dcayley_inverse(np.array([[0.0, 2.0], [0.0, 0.0]]), np.eye(2))
    array([[1., 0.],
           [0., 1.]])
    """
    half = y - (x @ y) / 2
    return half + (half @ x) / 2


def cayley_series(x: Jet) -> Jet:
    """cay(x(t)) = (1 - x/2)^-1 (1 + x/2) for matrices x(t) (..., n, n) with x(0) = 0, else `SeriesError`.

    Examples
    --------
    >>> cayley_series(Jet([[[0.0]], [[1.0]], [[0.0]], [[0.0]]])).coefficients.ravel()
    array([1.  , 1.  , 0.5 , 0.25])
    """
    x = _square_matrices(without_constant(x, check=True))
    return cayley_moved(matmul, x, recurrences.identities(x.node.value))


def cayley_moved(action: Callable[[Any, Any], Any], x: Jet, m: Values) -> Jet:
    """The Jet z = m + x (m + z)/2, coefficient by coefficient, for x without constant term."""
    start: Any = m if isinstance(m, Jet) else Jet.constant(m, x.order)
    z = Jet.growing(start.value, min(x.order, start.order))
    right: Jet = start + action(x, start + z) / 2
    z.node.depends((right.node, 0), rule=lambda k: right.node.known[k])
    return z


def cayley_magnus(a: Jet) -> Jet:
    """x(t) with x(0) = 0 such that cay(x(t)) solves Y' = a Y, Y(0) = 1: x' = (1 - x/2) a (1 + x/2).

    The matrices a(t) (..., n, n) are in an algebra that is closed under y -> x y x, such as that of a quadratic group.
    The series a may be growing, as for `magnus`.

    Examples
    --------
    >>> cayley_magnus(Jet([[[2.0]], [[0.0]], [[0.0]]])).coefficients.ravel()  # 2 tanh t
    array([ 0.        ,  2.        ,  0.        , -0.66666667])
    """
    return _integral(_square_matrices(a), lambda x: dcayley_inverse(x, a))


# -- the exponential -----------------------------------------------------------------------------------------
def exp_series(x: Jet) -> Jet:
    """exp(x(t)) for matrices x(t) (..., n, n) with x(0) = 0, else `SeriesError`.

    Examples
    --------
    >>> exp_series(Jet([[[0.0]], [[1.0]], [[0.0]], [[0.0]]])).coefficients.ravel()
    array([1.        , 1.        , 0.5       , 0.16666667])
    """
    node = _square_matrices(without_constant(x, check=True)).node
    return _matrix_series(node, [Fraction(1, factorial(k)) for k in range(1, max(node.order, 1) + 1)], one=True)


def log_series(y: Jet) -> Jet:
    """log(y(t)) for matrices y(t) (..., n, n) with y(0) = 1, else `SeriesError`; coefficient 0 is structurally zero.

    Examples
    --------
    >>> log_series(Jet([[[1.0]], [[1.0]], [[0.0]], [[0.0]]])).coefficients.ravel()
    array([ 0.        ,  1.        , -0.5       ,  0.33333333])
    """
    first = _square_matrices(y).value
    if not is_traced(first) and bool(np.any(np.asarray(first != recurrences.identities(first)))):
        raise SeriesError("log_series needs y(0) = 1: for another value factor it out first")
    node = without_constant(y).node
    return _matrix_series(node, [Fraction((-1) ** (k + 1), k) for k in range(1, max(node.order, 1) + 1)], one=False)


def _matrix_series(node: Node, weights: list[Fraction], one: bool) -> Jet:
    """sum_(k >= 1) weights[k-1] x^k, plus the identity if `one`."""
    powers = [node]
    for _ in weights[1:]:
        powers.append(recurrences.multilinear(lambda a, b: a @ b, [node, powers[-1]]))
    return Jet.from_node(_weighted(powers, weights, recurrences.identities(node.value) if one else None))


def magnus(bracket: Bracket, a: Jet) -> Jet:
    """x(t) with x(0) = 0 such that exp(x(t)) solves Y' = a Y, Y(0) = 1: x' = dexp_x^-1 a, with a bracket as for `dexp`.

    The series a may be growing: coefficient k + 1 of the result needs a up to coefficient k. The order of the result is
    that of a, plus 1. In Taylor coefficients x_1 = a_0, x_2 = a_1 / 2, x_3 = a_2 / 3 + [a_1, a_0] / 12.

    Examples
    --------
    >>> import numpy as np
    >>> a = Jet([[1.0, 0.0, 0.0], [0.0, 12.0, 0.0], [0.0, 0.0, 0.0]])
    >>> magnus(np.cross, a).coefficient(3)
    array([ 0.,  0., -1.])
    """
    return _integral(a, lambda x: dexp_inverse(bracket, x, a, a.order + 1))


def _integral(a: Jet, slope: Callable[[Jet], Any]) -> Jet:
    """Jet x with x(0) = 0 and x' = slope(x), of the shape of a."""
    node = Node(a.order + 1, zeros(a.value, a.shape), [None])
    derivative = slope(Jet.from_node(node)).node
    node.depends((derivative, 1), rule=lambda k: _over(k, derivative.known[k - 1]))
    return Jet.from_node(node)


def _over(k: int, x: Coefficient) -> Coefficient:
    return None if x is None else x / k


def bch(bracket: Bracket, x: NumbersLike, y: NumbersLike, order: int | None = None) -> Jet:
    """z = log(exp x exp y) as a series, with a bracket as for `dexp`.

    Parameters
    ----------
    x, y : array_like or Jet
        Elements of the algebra, which stand for t x and t y, so that coefficient k is the term of degree k of
        the Baker-Campbell-Hausdorff series; or Jets x(t), y(t) with x(0) = y(0) = 0.
    order : int, optional
        The last degree; needed (else `SeriesError`) if x and y are elements, by default that of the Jets.

    Notes
    -----
    t z' = sum_(k even) B_k ad_z^k (p + q) / k! + [z, q - p] / 2 with p = dexp_x(t x') and q = dexp_(-y)(t y'):
    every coefficient follows from the lower ones. For elements p = t x and q = t y.

    Examples
    --------
    >>> import numpy as np
    >>> z = bch(np.cross, [12.0, 0.0, 0.0], [0.0, 1.0, 0.0], 3)
    >>> z.coefficient(2)[2], z.coefficient(3)
    (np.float64(6.0), array([ -1., -12.,   0.]))
    """
    orders = [v.order for v in (x, y) if isinstance(v, Jet)] + ([] if order is None else [order])
    if not orders or min(orders) < 1:
        raise SeriesError("the order of the Baker-Campbell-Hausdorff series is a number from 1 on")
    degree = min(orders)
    p, q = _velocity(bracket, x, degree, 1), _velocity(bracket, y, degree, -1)
    both, difference = recurrences.add(p, q), recurrences.add(q, p, -1)
    node = Node(degree, zeros(both.value, tuple(np.shape(both.value))), [None])
    z = Jet.from_node(node)
    even = [b / factorial(k) if k % 2 == 0 else Fraction(0) for k, b in enumerate(bernoulli(max(degree - 1, 0)))]
    symmetric: Any = _series_in_ad(bracket, z, Jet.from_node(both), even)
    slope = _weighted(
        [symmetric.node, recurrences.multilinear(bracket, [node, difference])], [Fraction(1), Fraction(1, 2)]
    )
    # slope_k holds z up to k - 1 only, because p and q begin at t
    node.depends((slope, 0), rule=lambda k: _over(k, slope.known[k]))
    return z


def _velocity(bracket: Bracket, x: NumbersLike, order: int, sign: int) -> Node:
    """dexp_(sign x)(t x'); for an element that stands for t x it is t x."""
    if not isinstance(x, Jet):
        value = as_values(x)
        return Node(order, zeros(value, value.shape), [None, value, *[None] * (order - 1)])
    node = without_constant(x, check=True).node

    def rule(k: int) -> Coefficient:
        return None if node.known[k] is None else k * node.known[k]

    moving = Node(node.order, node.value, [None], ((node, 0),), rule)
    weights = [Fraction(sign**k, factorial(k + 1)) for k in range(order)]
    velocity: Any = _series_in_ad(bracket, Jet.from_node(node), Jet.from_node(moving), weights)
    return velocity.node


# -- what the series need of their arguments -----------------------------------------------------------------
def without_constant(x: Jet, *, check: bool = False) -> Jet:
    """x(t) - x(0), as a series whose coefficient 0 is structurally zero.

    With `check` it raises `SeriesError` if x(0) is not zero; traced values must then be structurally zero.

    Examples
    --------
    >>> without_constant(Jet([3.0, 1.0])).coefficients
    array([0., 1.])
    """
    node = x.node
    if node.known[0] is None:
        return x
    if check and (is_traced(node.value) or bool(np.any(np.asarray(node.value != 0)))):
        raise SeriesError("the series must vanish at t = 0; without_constant(x) drops its coefficient 0")
    return Jet.from_node(Node(node.order, zeros(node.value, x.shape), [None], ((node, 0),), lambda k: node.known[k]))


def _square_matrices(x: Jet) -> Jet:
    if x.ndim < 2 or x.shape[-1] != x.shape[-2]:
        raise ShapeError(f"the values must be square matrices (..., n, n), got shape {x.shape}")
    return x
