"""Recurrences for Taylor coefficients: linear and multilinear maps, quotients, powers, elementary functions.

Each is one formula.  A multilinear map B has B(a, b)_k = sum_i B(a_i, b_(k-i)).  An elementary function F
with F' = G has k F_k = sum_i i u_i G_(k-i), where G is again a series: exp' = exp, tan' = 1 + tan^2 and so on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from liehom.errors import SeriesError
from liehom.series.arrays import constant_like, elementary, namespace, power, zeros
from liehom.series.node import Coefficient, Node
from liehom.typing import Number, Values


def constant(value: Values, order: int) -> Node:
    """Node of a constant series."""
    return Node(order, value, [value], (), _nothing)


def _nothing(k: int) -> None:
    return None


def linear(function: Callable[..., Values], operands: Sequence[Node]) -> Node:
    """Node of function(a, b, ...), jointly linear in the operands, such as a sum, a stack, a transpose, an index."""
    order = min(o.order for o in operands)

    def rule(k: int) -> Coefficient:
        if all(o.known[k] is None for o in operands):
            return None
        return function(*[zeros(o.value, _shape(o.value)) if o.known[k] is None else o.known[k] for o in operands])

    value = function(*[o.value for o in operands])
    first = None if all(o.known[0] is None for o in operands) else value
    return Node(order, value, [first], tuple((o, 0) for o in operands), rule)


def add(a: Node, b: Node, sign: int = 1) -> Node:
    """Node of a + b, or of a - b for sign = -1, with broadcasting."""
    value = a.value + b.value if sign > 0 else a.value - b.value
    shape = _shape(value)

    def rule(k: int) -> Coefficient:
        x, y = a.known[k], b.known[k]
        if y is None:
            return None if x is None else _spread(x, shape)
        if x is None:
            return _spread(y if sign > 0 else -y, shape)
        found: Coefficient = x + y if sign > 0 else x - y
        return found

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
            term = function(*parts)
            total = term if total is None else total + term
        return total

    value = function(*[o.value for o in operands])
    first = None if any(starts) else value
    lags = tuple((o, sum(starts) - start) for o, start in zip(operands, starts, strict=True))
    return Node(order, value, [first], lags, rule)


def bilinear(function: Callable[[Any, Any], Values], a: Node, b: Node, value: Values | None = None) -> Node:
    """Node of function(a, b), linear in both, the most frequent operation; `value` is its value at 0, if known."""
    first, second = a.known, b.known
    start, end = (1 if first[0] is None else 0), (0 if second[0] is None else 1)

    def rule(k: int) -> Coefficient:
        total = None
        for i in range(start, k + end):
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
    return solution(a, b, _times, lambda y, x: y / x)


def solution(a: Node, b: Node, product: Callable[[Any, Any], Values], divide: Callable[[Any, Any], Values]) -> Node:
    """Node of q with product(b, q) = a, where divide(y, b_0) solves product(b_0, q) = y."""
    value = divide(a.value, b.value)
    shape = _shape(value)
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
                term = term if i == 1 else i * term
                total = term if total is None else total + term
        return None if total is None else total / (sign * k)

    return rule


def product(a: Node, b: Node) -> Node:
    """Node of the product of a and b, entry by entry."""
    return multilinear(_times, [a, b])


def _times(x: Values, y: Values) -> Values:
    return x * y


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
            return result if result is not None else u
        u = product(u, u)


def real_power(u: Node, exponent: Fraction | Number | float, value: Values | None = None) -> Node:
    """Node of y = u ** (p / q) for u_0 != 0, by q k u_0 y_k = sum_i (p i - q (k - i)) u_i y_(k-i).

    Parameters
    ----------
    u : Node
    exponent : Fraction or number
        One number; a Fraction if the values are exact.
    value : array, optional
        u_0 ** exponent, if it has been computed more precisely.
    """
    p: Any = exponent
    q = 1
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
                term = (p * i - q * (k - i)) * u.known[i] * node.known[k - i]
                total = term if total is None else total + term
        return None if total is None else total / (q * k * u.value)

    node.depends((u, 0), (node, 1), rule=rule)
    return node


def _root(u: Node, exponent: Fraction, name: str) -> Node:
    """Node of a root, with its value at 0 by the numpy function of this name."""
    return real_power(u, exponent, elementary(name, u.value))


def _inverse_root(u: Node) -> Node:
    """Node of u ** (-1/2)."""
    return _over_one(_root(u, Fraction(1, 2), "sqrt"))


def _multiple(u: Node, name: str, argument: int, divide: bool = False) -> Node:
    """Node of u times, or divided by, the number name(argument), such as log 2."""
    number = elementary(name, _one(u.value) * argument)
    return linear((lambda x: x / number) if divide else (lambda x: x * number), [u])


def _plus(node: Node, number: int) -> Node:
    return add(node, constant(_one(node.value) * number, node.order))


def _one(value: Values) -> Values:
    return zeros(value, ()) + 1


def _over_one(node: Node) -> Node:
    return quotient(constant(_one(node.value), node.order), node)


def _negative(node: Node) -> Node:
    return linear(lambda x: -x, [node])


def _square(node: Node) -> Node:
    return product(node, node)


def _pair(u: Node, first: str, second: str, sign: int) -> tuple[Node, Node]:
    """Nodes of sin and cos (sign -1) or sinh and cosh (sign 1), for which first' = second, second' = sign first."""
    values = elementary(first, u.value), elementary(second, u.value)
    one, other = Node(u.order, values[0], [values[0]]), Node(u.order, values[1], [values[1]])
    one.depends((u, 0), (other, 1), rule=_chain_rule(u, other))
    other.depends((u, 0), (one, 1), rule=_chain_rule(u, one, sign))
    return one, other


# name of the numpy function -> its series; a new function is one line
FUNCTIONS: dict[str, Callable[[Node], Node]] = {
    "exp": lambda u: chain(u, elementary("exp", u.value), lambda f: f),
    "expm1": lambda u: chain(u, elementary("expm1", u.value), lambda f: _plus(f, 1)),
    "log": lambda u: chain(u, elementary("log", u.value), lambda _: _over_one(u)),
    "log1p": lambda u: chain(u, elementary("log1p", u.value), lambda _: _over_one(_plus(u, 1))),
    "sin": lambda u: _pair(u, "sin", "cos", -1)[0],
    "cos": lambda u: _pair(u, "sin", "cos", -1)[1],
    "tan": lambda u: chain(u, elementary("tan", u.value), lambda f: _plus(_square(f), 1)),
    "sinh": lambda u: _pair(u, "sinh", "cosh", 1)[0],
    "cosh": lambda u: _pair(u, "sinh", "cosh", 1)[1],
    "tanh": lambda u: chain(u, elementary("tanh", u.value), lambda f: _plus(_negative(_square(f)), 1)),
    "arctan": lambda u: chain(u, elementary("arctan", u.value), lambda _: _over_one(_plus(_square(u), 1))),
    "arcsin": lambda u: chain(
        u, elementary("arcsin", u.value), lambda _: _inverse_root(_plus(_negative(_square(u)), 1))
    ),
    "arccos": lambda u: chain(
        u, elementary("arccos", u.value), lambda _: _negative(_inverse_root(_plus(_negative(_square(u)), 1)))
    ),
    "arcsinh": lambda u: chain(u, elementary("arcsinh", u.value), lambda _: _inverse_root(_plus(_square(u), 1))),
    "arccosh": lambda u: chain(
        u, elementary("arccosh", u.value), lambda _: product(_inverse_root(_plus(u, -1)), _inverse_root(_plus(u, 1)))
    ),
    "arctanh": lambda u: chain(u, elementary("arctanh", u.value), lambda _: _over_one(_plus(_negative(_square(u)), 1))),
    "exp2": lambda u: chain(u, elementary("exp2", u.value), lambda f: _multiple(f, "log", 2)),
    "log2": lambda u: chain(u, elementary("log2", u.value), lambda _: _multiple(_over_one(u), "log", 2, divide=True)),
    "log10": lambda u: chain(
        u, elementary("log10", u.value), lambda _: _multiple(_over_one(u), "log", 10, divide=True)
    ),
    "sqrt": lambda u: _root(u, Fraction(1, 2), "sqrt"),
    "cbrt": lambda u: _root(u, Fraction(1, 3), "cbrt"),
    "square": _square,
    "reciprocal": _over_one,
    "negative": _negative,
}


def _shape(value: Values) -> tuple[int, ...]:
    return tuple(np.shape(value))


def _spread(x: Values, shape: tuple[int, ...]) -> Values:
    return x if _shape(x) == shape else namespace(x).broadcast_to(x, shape)
