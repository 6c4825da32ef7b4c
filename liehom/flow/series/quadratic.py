"""Taylor coefficients of x' = rho(psi(x)) x for a traced generator psi of degree 1.

Two forms of the recurrence are known, of which the one with fewer operations is taken.

* By products of two coordinates, each of which is expanded once. The newest coefficient comes last, by one matrix, so
  that the rest is computed meanwhile (J is the derivative of the field at x_0):

      (k + 1) x_(k+1) = sum_(0 < l < k) rho(psi'(x_l)) x_(k-l) + J x_k.

* By columns, (k + 1) x_(k+1) = sum_(l <= k) rho(psi_l) x_(k-l), from the products of the entries of psi and of
  coordinates, or of combinations of coordinates whose columns in a matrix rho_a are multiples of each other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import reduce
from itertools import chain
from operator import add
from typing import Any, NamedTuple, TypeAlias, final

from liehom.base.typing import Values
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Expr, Tape, needed

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
    columns, x = _columns(move, m.tape, len(m), len(psi)), [list(m.entries)]
    # operations: of the sums of products, of the rows that they make, and of the linear maps J and psi
    terms = sum(len(e) == 2 for row in rows for e in row) + sum(len({a for e in row for a in e}) for row in rows)
    by_products = (order - 1) * (order - 2) / 2 * sum(1 + (a != b) for a, b in products) + 2 * order * terms
    terms = sum(len(c.image) for c in columns if not c.is_single) + sum(map(len, affine))
    if len(products) <= REGISTERS and by_products <= order * (order + 1) * len(columns) + 2 * order * terms:
        return AffineFlow(_by_products(x, rows, products, order), affine)
    return AffineFlow(_by_columns(x, affine, columns, order), affine)


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


def _by_products(
    x: list[list[Expr]], rows: Sequence[Quadratic], products: Iterable[tuple[int, ...]], order: int
) -> list[list[Expr]]:
    """The coefficients x_0, ..., x_n, which are appended to x, from products of coordinates."""
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
        factor = 1 / (k + 1)
        known = {e: _product(x, k, *e) for e in products} if k > 1 else {}
        older = [_tree([c * factor * known[e] for e, c in row.items() if e in known] or [zero]) for row in rows]
        newest = [_sum([zero, *[s * x[k][j] for s, j in terms]]) for terms in jacobian]
        x.append([a + b * factor for a, b in zip(older, newest, strict=True)])
    return x


def _linear(affine: Sequence[Quadratic], x: Sequence[Expr], *, constant: bool = False) -> list[Expr]:
    """The linear part of polynomials of degree 1 at x, or all of it."""
    zero = x[0].tape.zero
    return [_sum([zero, *[c * x[e[0]] if e else c for e, c in row.items() if e or constant]]) for row in affine]


class _Column(NamedTuple):
    """A column of rho_a, and the combination of the coordinates whose columns are multiples of it."""

    generator: int
    form: list[tuple[int, float]]
    image: list[tuple[int, float]]

    @property
    def is_single(self) -> bool:
        """Whether its products are summed in the row of the image, without a sum of their own."""
        return len(self.image) == 1


def _columns(move: Callable[[Any, Any], Values], tape: Tape, n: int, count: int) -> list[_Column]:
    """The columns of the matrices rho_a."""
    vector: Any = move(Traced.inputs(tape, n, count), Traced.inputs(tape, 0, n))
    entries: dict[tuple[int, ...], list[tuple[int, float]]] = {}
    for i, row in enumerate(_quadratics(list(vector.entries), n + count)):  # type: ignore[arg-type]  # it is bilinear
        for (j, a), c in row.items():
            entries.setdefault((a - n, j), []).append((i, c.value))
    columns: list[list[_Column]] = [[] for _ in range(count)]
    for (a, j), image in entries.items():
        for known in columns[a]:
            ratio = image[0][1] / known.image[0][1]
            if image == [(i, ratio * c) for i, c in known.image]:
                known.form.append((j, ratio))
                break
        else:
            columns[a].append(_Column(a, [(j, 1.0)], image))
    return list(chain.from_iterable(columns))


def _by_columns(
    x: list[list[Expr]], affine: Sequence[Quadratic], columns: Sequence[_Column], order: int
) -> list[list[Expr]]:
    """The coefficients x_0, ..., x_n, which are appended to x, from the columns."""
    psi, forms = list[list[Expr]](), list[list[Expr]]()
    for k in range(order):
        psi.append(_linear(affine, x[k], constant=k == 0))
        forms.append([_sum([c * x[k][j] for j, c in column.form]) for column in columns])
        total = [x[0][0].tape.zero] * len(x[0])
        for l in _newest_last(0, k):
            for column, form in zip(columns, forms[k - l], strict=True):
                if column.is_single:
                    i, c = column.image[0]
                    total[i] = total[i] + c * psi[l][column.generator] * form
        for place, column in enumerate(columns):
            if not column.is_single:
                product = _sum([psi[l][column.generator] * forms[k - l][place] for l in _newest_last(0, k)])
                for i, c in column.image:
                    total[i] = total[i] + c * product
        x.append([e * (1 / (k + 1)) for e in total])
    return x


def _newest_last(first: int, k: int) -> list[int]:
    return sorted(range(first, k + 1 - first), key=lambda l: max(l, k - l))


def _product(x: Sequence[Sequence[Expr]], k: int, a: int, b: int) -> Expr:
    """The sum of x_l,a x_(k-l),b over 0 < l < k."""
    if a != b:
        return _sum([x[l][a] * x[k - l][b] for l in _newest_last(1, k)])
    halves = [2.0 * x[l][a] * x[k - l][a] for l in _newest_last(1, k) if 2 * l < k]
    return _sum([*([x[k // 2][a] * x[k // 2][a]] if k % 2 == 0 else []), *halves])


def _sum(terms: Sequence[Expr]) -> Expr:
    return reduce(add, terms)


def _tree(terms: Sequence[Expr]) -> Expr:
    """A sum whose terms do not wait for each other."""
    half = len(terms) // 2
    return terms[0] if not half else _tree(terms[:half]) + _tree(terms[half:])
