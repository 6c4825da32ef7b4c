"""Power series on demand: nodes, and recurrences of their coefficients."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from operator import mul, neg
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.errors import SeriesError
from liehom.base.typing import Number, Values
from liehom.flow.series.arrays import constant_like, elementary, namespace, power, zeros

# Node: a power series that computes its Taylor coefficients one after the other, on demand.
#
# Coefficient k of a sum or product needs coefficients up to k of the operands; of an integral or a recurrence, up to
# k - 1 (its lag). So a series may depend on itself with a lag, as in the solution of a differential equation. No
# coefficient is computed twice, and an expansion to order n costs O(n^2) products. None is a structural zero.

Coefficient: TypeAlias = Values | None
"""A Taylor coefficient; None is a structural zero."""

Rule: TypeAlias = Callable[[int], Coefficient]


@final
class Node:
    """A series with coefficients on demand; users see it as a `Jet`.

    Parameters
    ----------
    order : int
        The last index that may be asked for.
    value : array
        The value at 0. If coefficient 0 is a structural zero, it still gives shape and dtype.
    known : list
        Coefficients from 0 on, None for a structural zero; at least the first.
    operands : tuple of (Node, lag)
    rule : callable, optional
        k -> coefficient k, for k = len(known), .... Without a rule the coefficients are appended from outside.

    Examples
    --------
    >>> one = Node(3, 1.0, [1.0], (), lambda k: None)
    >>> exponential = Node(3, 1.0, [1.0])
    >>> exponential.depends((exponential, 1), rule=lambda k: exponential.known[k - 1] / k)
    >>> exponential.coefficient(3)
    0.16666666666666666
    """

    __slots__ = ("known", "operands", "order", "rule", "value")

    def __init__(
        self, order: int, value: Values, known: list[Any], operands: tuple[tuple[Node, int], ...] = (),
        rule: Rule | None = None,
    ) -> None:  # fmt: skip
        self.order, self.value, self.known, self.operands, self.rule = order, value, known, operands, rule

    def depends(self, *operands: tuple[Node, int], rule: Rule) -> None:
        """Set operands and rule after construction, for a series that depends on itself."""
        self.operands, self.rule = operands, rule

    def coefficient(self, k: int) -> Coefficient:
        """Coefficient k, or None if it is a structural zero; missing coefficients of operands are computed first."""
        if 0 <= k < len(self.known):
            return self.known[k]
        if k < 0:
            raise SeriesError(f"the coefficients of a series begin with 0, got {k}")
        if k > self.order:
            raise SeriesError(f"coefficient {k} of a series of order {self.order} is not known")
        stack: list[tuple[Node, int]] = [(self, k)]
        while stack:
            node, wanted = stack[-1]
            have = len(node.known)
            if have > wanted:
                stack.pop()
                continue
            missing = [(o, have - lag) for o, lag in node.operands if len(o.known) <= have - lag]
            if missing:
                stack.extend(missing)
            elif node.rule is None:
                raise SeriesError(f"coefficient {have} of a growing series is asked for before it is given")
            else:
                node.known.append(node.rule(have))
        return self.known[k]


def rewind(root: Node, source: Node, k: int) -> None:
    """Forget the coefficients of the nodes under `root` that depend on coefficient k of `source`.

    Called after coefficient k >= 1 of a growing `source` was replaced. A node that needs `source` with lag l
    forgets its coefficients from k + l on, and so do the nodes that depend on it.

    Examples
    --------
    >>> x = Node(2, 1.0, [1.0, 1.0])
    >>> y = Node(2, 2.0, [2.0], ((x, 0),), lambda k: 2 * x.known[k])
    >>> y.coefficient(1)
    2.0
    >>> x.known[1] = 5.0
    >>> rewind(y, x, 1)
    >>> y.coefficient(1)
    10.0
    """
    users: dict[int, list[tuple[Node, int]]] = {}
    seen, stack = {id(root)}, [root]
    while stack:
        node = stack.pop()
        for below, lag in node.operands:
            users.setdefault(id(below), []).append((node, lag))
            if id(below) not in seen:
                seen.add(id(below))
                stack.append(below)
    first, pending = {id(source): k}, deque([source])
    while pending:
        below = pending.popleft()
        for node, lag in users.get(id(below), []):
            start = first[id(below)] + lag
            if node is not source and start < first.get(id(node), len(node.known)):
                first[id(node)] = start
                del node.known[start:]
                pending.append(node)


def plus(total: Coefficient, term: Values) -> Values:
    """total + term."""
    return term if total is None else total + term


# Recurrences for Taylor coefficients: linear and multilinear maps, quotients, powers, elementary functions.
#
# A multilinear map B has B(a, b)_k = sum_i B(a_i, b_(k-i)).  An elementary function F
# with F' = G has k F_k = sum_i i u_i G_(k-i), where G is again a series: exp' = exp, tan' = 1 + tan^2 and so on.


def constant(value: Values, order: int) -> Node:
    """Node of a constant series."""
    return Node(order, value, [value], (), lambda k: None)


def linear(function: Callable[..., Values], operands: Sequence[Node]) -> Node:
    """Node of function(a, b, ...), jointly linear in the operands, such as a sum, a stack, a transpose, an index."""
    order = min(o.order for o in operands)

    def rule(k: int) -> Coefficient:
        if all(o.known[k] is None for o in operands):
            return None
        return function(*[zeros(o.value, np.shape(o.value)) if o.known[k] is None else o.known[k] for o in operands])

    value = function(*[o.value for o in operands])
    known = [None if all(o.known[0] is None for o in operands) else value]
    return Node(order, value, known, tuple((o, 0) for o in operands), rule)


def add(a: Node, b: Node, sign: int = 1) -> Node:
    """Node of a + b, or of a - b for sign = -1, with broadcasting."""
    value = a.value + b.value if sign > 0 else a.value - b.value
    shape = np.shape(value)

    def rule(k: int) -> Coefficient:
        x, y = a.known[k], b.known[k]
        if y is None:
            return None if x is None else _spread(x, shape)
        if x is None:
            return _spread(y if sign > 0 else -y, shape)
        return x + y if sign > 0 else x - y

    first = None if a.known[0] is None and b.known[0] is None else value
    return Node(min(a.order, b.order), value, [first], ((a, 0), (b, 0)), rule)


def multilinear(function: Callable[..., Values], operands: Sequence[Node]) -> Node:
    """Node of function(a, b, ...), linear in each operand.

    Coefficient k is the sum of function(a_i, b_j, ...) over i + j + ... = k. If another operand begins with a
    structural zero, it needs an operand only up to k - 1.
    """
    if len(operands) == 2:
        return bilinear(function, operands[0], operands[1])
    order = min(o.order for o in operands)
    starts = [1 if o.known[0] is None else 0 for o in operands]
    known = [o.known for o in operands]

    def rule(k: int) -> Coefficient:
        total = None
        for parts in _parts(known, starts, k):
            total = plus(total, function(*parts))
        return total

    value = function(*[o.value for o in operands])
    lags = tuple((o, sum(starts) - start) for o, start in zip(operands, starts, strict=True))
    return Node(order, value, [None if any(starts) else value], lags, rule)


def bilinear(function: Callable[[Any, Any], Values], a: Node, b: Node, value: Values | None = None) -> Node:
    """Node of function(a, b), linear in both, the most frequent operation; `value` is its value at 0, if known."""
    first, second = a.known, b.known
    start, end = (1 if first[0] is None else 0), (0 if second[0] is None else 1)

    def rule(k: int) -> Coefficient:
        total = None
        # the newest coefficients come last, so that compiled code need not wait for them
        for i in sorted(range(start, k + end), key=lambda i: max(i, k - i)):
            x, y = first[i], second[k - i]
            if x is not None and y is not None:
                term = function(x, y)
                total = term if total is None else total + term
        return total

    if value is None:
        value = function(a.value, b.value)
    known = [None if start or not end else value]
    return Node(min(a.order, b.order), value, known, ((a, 1 - end), (b, start)), rule)


def _parts(known: list[list[Any]], starts: list[int], k: int) -> Iterator[tuple[Values, ...]]:
    """Iterator over the tuples of non-zero coefficients whose indices add up to k."""
    if len(known) == 1:
        if k >= starts[0] and known[0][k] is not None:
            yield (known[0][k],)
        return
    for i in range(starts[0], k + 1 - sum(starts[1:])):
        if known[0][i] is not None:
            for rest in _parts(known[1:], starts[1:], k - i):
                yield (known[0][i], *rest)


def quotient(a: Node, b: Node) -> Node:
    """Node of q = a / b, with q_k = (a_k - sum_(i >= 1) b_i q_(k-i)) / b_0."""
    return solution(a, b, mul, lambda y, x: y / x)


def solution(a: Node, b: Node, product: Callable[[Any, Any], Values], divide: Callable[[Any, Any], Values]) -> Node:
    """Node of q with product(b, q) = a, where divide(y, b_0) solves product(b_0, q) = y."""
    value = divide(a.value, b.value)
    shape = np.shape(value)
    node = Node(min(a.order, b.order), value, [None if a.known[0] is None else value])

    def rule(k: int) -> Coefficient:
        total = a.known[k]
        for i in range(1, k + 1):
            if b.known[i] is not None and node.known[k - i] is not None:
                term = product(b.known[i], node.known[k - i])
                total = -term if total is None else total - term
        return None if total is None else _spread(divide(total, b.value), shape)

    node.depends((a, 0), (b, 0), (node, 1), rule=rule)
    return node


def chain(u: Node, value: Values, derivative: Callable[[Node], Node]) -> Node:
    """Node of F(u) with F(u_0) = value and F' = derivative(node of F(u))."""
    node = Node(u.order, value, [value])
    slope = derivative(node)
    node.depends((u, 0), (slope, 1), rule=_chain_rule(u, slope))
    return node


def _chain_rule(u: Node, slope: Node, sign: int = 1) -> Callable[[int], Coefficient]:
    """The rule k -> (sign / k) sum_i i u_i slope_(k-i)."""

    def rule(k: int) -> Coefficient:
        total = None
        for i in range(1, k + 1):
            if u.known[i] is not None and slope.known[k - i] is not None:
                term = u.known[i] * slope.known[k - i]
                total = plus(total, term if i == 1 else i * term)
        return None if total is None else total / (sign * k)

    return rule


def product(a: Node, b: Node) -> Node:
    """Node of the product of a and b, entry by entry."""
    return bilinear(mul, a, b)


def integer_power(u: Node, n: int) -> Node:
    """Node of u ** n for n >= 0, by repeated squaring, so that u may vanish."""
    if n == 0:
        return constant(u.value**0, u.order)
    result: Node | None = None
    while True:
        if n & 1:
            result = u if result is None else product(result, u)
        n >>= 1
        if not n:
            return result or u
        u = product(u, u)


def real_power(u: Node, exponent: Fraction | Number | float, value: Values | None = None) -> Node:
    """Node of y = u ** (p / q) for u_0 != 0, by q k u_0 y_k = sum_i (p i - q (k - i)) u_i y_(k-i).

    The exponent p / q is one number, a Fraction if the values are exact; `value` is u_0 ** (p / q), if it is known.
    """
    p: Any
    p, q = exponent, 1
    if isinstance(exponent, Fraction):
        if getattr(u.value, "dtype", np.dtype(object)).kind == "O":
            p, q = exponent.as_integer_ratio()
            if value is None:
                value = power(u.value, exponent)
            if any(x == 0 for x in np.asarray(u.value).flat):
                raise SeriesError(f"the power {exponent} of a series has no expansion if its value is 0")
        else:
            p = constant_like(u.value, exponent)[()]
    if value is None:
        value = u.value**p
    node = Node(u.order, value, [value])

    def rule(k: int) -> Coefficient:
        total = None
        for i in range(1, k + 1):
            if u.known[i] is not None and node.known[k - i] is not None:
                total = plus(total, (p * i - q * (k - i)) * u.known[i] * node.known[k - i])
        return None if total is None else total / (q * k * u.value)

    node.depends((u, 0), (node, 1), rule=rule)
    return node


def _multiple(u: Node, name: str, argument: int, divide: bool = False) -> Node:
    """Node of u times, or divided by, the number name(argument), such as log 2."""
    number = elementary(name, _one(u.value) * argument)
    return linear((lambda x: x / number) if divide else (lambda x: x * number), [u])


def _one(value: Values) -> Values:
    return zeros(value, ()) + 1


def identities(like: Values) -> Values:
    """Identity matrices with numbers of the kind of `like`, broadcast to its shape (..., n, n)."""
    eye = namespace(like).eye(like.shape[-1])
    return zeros(like, tuple(like.shape)) + eye.astype(int if like.dtype == object else like.dtype)


def _over_one(node: Node) -> Node:
    return quotient(constant(_one(node.value), node.order), node)


def _pair(u: Node, first: str, second: str, sign: int) -> tuple[Node, Node]:
    """Nodes of sin and cos (sign -1) or sinh and cosh (sign 1), for which first' = second, second' = sign first."""
    values = elementary(first, u.value), elementary(second, u.value)
    one, other = Node(u.order, values[0], [values[0]]), Node(u.order, values[1], [values[1]])
    one.depends((u, 0), (other, 1), rule=_chain_rule(u, other))
    other.depends((u, 0), (one, 1), rule=_chain_rule(u, one, sign))
    return one, other


# name of the numpy function -> its series; `jet_functions` adds those that follow from their slopes
FUNCTIONS: dict[str, Callable[[Node], Node]] = {
    "sin": lambda u: _pair(u, "sin", "cos", -1)[0],
    "cos": lambda u: _pair(u, "sin", "cos", -1)[1],
    "sinh": lambda u: _pair(u, "sinh", "cosh", 1)[0],
    "cosh": lambda u: _pair(u, "sinh", "cosh", 1)[1],
    "exp2": lambda u: chain(u, elementary("exp2", u.value), lambda f: _multiple(f, "log", 2)),
    "log2": lambda u: chain(u, elementary("log2", u.value), lambda _: _multiple(_over_one(u), "log", 2, divide=True)),
    "log10": lambda u: chain(
        u, elementary("log10", u.value), lambda _: _multiple(_over_one(u), "log", 10, divide=True)
    ),
    "sqrt": lambda u: real_power(u, Fraction(1, 2), elementary("sqrt", u.value)),
    "cbrt": lambda u: real_power(u, Fraction(1, 3), elementary("cbrt", u.value)),
    "square": lambda u: product(u, u),
    "reciprocal": _over_one,
    "negative": lambda u: linear(neg, [u]),
}


def _spread(x: Values, shape: tuple[int, ...]) -> Values:
    return x if np.shape(x) == shape else namespace(x).broadcast_to(x, shape)
