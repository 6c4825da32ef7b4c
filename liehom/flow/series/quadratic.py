"""Taylor coefficients of x' = rho(psi(x)) x for a traced generator psi of degree 1.

    (k + 1) x_(k+1) = sum_(0 < l < k) rho(psi'(x_l)) x_(k-l) + J x_k,   J the derivative of the field at x_0.

The newest coefficient comes last, by one matrix, so that the rest is computed meanwhile. The sum is computed as it is
written, or from the products of two coordinates, of which each is expanded once. On CP^2 there are 64 products, and by
them a step takes 1.5 to 1.8 times as long as by the sum with as many operations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial, reduce
from operator import add
from typing import Any, TypeAlias, final

from liehom.base.typing import Values
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Expr, needed

REGISTERS = 32  # products of coordinates up to which code by products keeps them all in vector registers

Quadratic: TypeAlias = dict[tuple[int, ...], Expr]
"""A polynomial of degree 2 at most: a coefficient for each product of coordinates, () for 1."""


@final
class AffineFlow:
    """The expansion of the flow for a traced generator psi of degree 1, with the methods of a `Flow`."""

    def __init__(self, points: Sequence[Sequence[Expr]], affine: Sequence[Quadratic]) -> None:
        self._points, self._affine, self._tape = points, affine, points[0][0].tape

    def point(self, k: int) -> Traced:
        """Coefficient k of the flow, shape (N,)."""
        return Traced(self._tape, self._points[k])

    def psi(self, k: int) -> Traced:
        """Coefficient k of the generator along it, shape (dim g,)."""
        return Traced(self._tape, _linear(self._affine, self._points[k], constant=k == 0))


def affine_flow(m: Traced, psi: Traced, move: Callable[[Any, Any], Values], order: int) -> AffineFlow | None:
    """The expansion to an order at inputs m, for psi(m) and move(x, m) = rho(x) m; None if psi is not affine."""
    vector: Any = move(psi, m)
    rows, affine = _quadratics(list(vector.entries), len(m)), _quadratics(list(psi.entries), len(m))
    if rows is None or affine is None or any(len(e) > 1 for row in affine for e in row):
        return None
    products = {e for row in rows for e in row if len(e) == 2}
    # operations that differ, for each pair of coefficients and for each order
    moved = len(_operations(vector.entries)) - len(_operations(psi.entries)) + len(m)
    pairs, orders = (order - 1) * (order - 2) / 2, 2 * (order - 2)
    by_products = pairs * sum(1 + (a != b) for a, b in products)
    by_products += orders * sum(len(e) == 2 for row in rows for e in row)
    as_written = pairs * moved + orders * sum(len(e) == 1 for row in affine for e in row)
    x = [list(m.entries)]
    if len(products) <= REGISTERS and by_products <= as_written:
        return AffineFlow(_points(x, rows, order, partial(_by_products, x, rows, products)), affine)
    return AffineFlow(_points(x, rows, order, partial(_as_written, x, affine, move)), affine)


def _operations(outputs: Iterable[Expr]) -> list[Expr]:
    """Operations in the graph of some numbers."""
    return [x for x in needed(list(outputs)) if x.args]


def _quadratics(outputs: Sequence[Expr], size: int) -> list[Quadratic] | None:
    """Numbers of a graph as polynomials in the inputs 0, ..., size - 1; None if one is not of degree 2."""
    tape: Any = outputs[0].tape
    known: dict[int, Quadratic | None] = {}
    for x in needed(outputs):
        args = [known[a.index] for a in x.args]
        result: Quadratic | None = None
        if x.op == "input" and 0 <= x.value < size:
            result = {(x.value,): tape.one}
        elif x.op == "input":
            result = {(): x} if x.value < 0 else None
        elif all(a is not None and not any(a) for a in args):  # of constants
            result = {(): x}
        elif x.op in ("add", "sub", "neg", "mul") and None not in args:
            result = _combined(x.op, args)  # type: ignore[arg-type]
        known[x.index] = result
    rows = [known[x.index] for x in outputs]
    return None if None in rows else rows  # type: ignore[return-value]


def _combined(op: str, args: Sequence[Quadratic]) -> Quadratic | None:
    """The sum, difference, negative or product of polynomials; None if its degree is above 2."""
    total: Quadratic = {}
    if op == "mul":
        terms = [(tuple(sorted((*a, *b))), x * y) for a, x in args[0].items() for b, y in args[1].items()]
    else:
        signed = [args[0], {e: -c for e, c in args[-1].items()}] if op == "sub" else args
        terms = [(e, -c if op == "neg" else c) for part in signed for e, c in part.items()]
    for e, c in terms:
        total[e] = total[e] + c if e in total else c
    total = {e: c for e, c in total.items() if not (c.constant and c.value == 0)}
    return None if any(len(e) > 2 for e in total) else total


def _points(
    x: list[list[Expr]], rows: Sequence[Quadratic], order: int, inner: Callable[[int, float], list[Expr]]
) -> list[list[Expr]]:
    """The coefficients x_0, ..., x_n, which are appended to x."""
    n, zero = len(rows), x[0][0].tape.zero
    # J, and X(x_0) = (J + L) x_0 / 2 + constants
    slopes: list[list[list[Expr]]] = [[[] for _ in range(n)] for _ in range(n)]
    for row, slope in zip(rows, slopes, strict=True):
        for e, c in row.items():
            for place, a in enumerate(e):
                slope[a].append(c if len(e) == 1 else c * x[0][e[1 - place]])
    jacobian = [[(_sum(terms), j) for j, terms in enumerate(slope) if terms] for slope in slopes]
    first = []
    for row, terms in zip(rows, jacobian, strict=True):
        linear = [(s + row[(j,)] if (j,) in row else s, j) for s, j in terms]
        first.append(_sum([row.get((), zero), *[0.5 * s * x[0][j] for s, j in linear]]))
    x.append(first)
    for k in range(1, order):
        older = inner(k, 1 / (k + 1)) if k > 1 else [zero] * n
        newest = [_sum([zero, *[s * x[k][j] for s, j in terms]]) for terms in jacobian]
        x.append([a + b * (1 / (k + 1)) for a, b in zip(older, newest, strict=True)])
    return x


def _linear(affine: Sequence[Quadratic], x: Sequence[Expr], *, constant: bool = False) -> list[Expr]:
    """The linear part of polynomials of degree 1 at x, or all of it."""
    zero = x[0].tape.zero
    return [_sum([zero, *[c * x[e[0]] if e else c for e, c in row.items() if e or constant]]) for row in affine]


def _as_written(
    x: list[list[Expr]], affine: Sequence[Quadratic], move: Callable[[Any, Any], Values], k: int, factor: float
) -> list[Expr]:
    """factor times the sum over 0 < l < k."""
    tape: Any = x[0][0].tape
    terms = [move(Traced(tape, _linear(affine, x[l])), Traced(tape, x[k - l])) for l in _newest_last(k)]
    total: Any = reduce(add, terms)
    return [factor * e for e in total.entries]


def _by_products(
    x: list[list[Expr]], rows: Sequence[Quadratic], products: Iterable[tuple[int, ...]], k: int, factor: float
) -> list[Expr]:
    """The sums (N,) of the recurrence, from products of coordinates."""
    tape: Any = x[0][0].tape
    known = {e: _product(x, k, *e) for e in products}
    return [_tree([c * factor * known[e] for e, c in row.items() if e in known] or [tape.zero]) for row in rows]


def _newest_last(k: int) -> list[int]:
    return sorted(range(1, k), key=lambda l: max(l, k - l))


def _product(x: Sequence[Sequence[Expr]], k: int, a: int, b: int) -> Expr:
    """The sum of x_l,a x_(k-l),b over 0 < l < k."""
    if a != b:
        return _sum([x[l][a] * x[k - l][b] for l in _newest_last(k)])
    halves = [2.0 * x[l][a] * x[k - l][a] for l in _newest_last(k) if 2 * l < k]
    return _sum([*([x[k // 2][a] * x[k // 2][a]] if k % 2 == 0 else []), *halves])


def _sum(terms: Sequence[Expr]) -> Expr:
    return reduce(add, terms)


def _tree(terms: Sequence[Expr]) -> Expr:
    """A sum whose terms do not wait for each other."""
    half = len(terms) // 2
    return terms[0] if not half else _tree(terms[:half]) + _tree(terms[half:])
