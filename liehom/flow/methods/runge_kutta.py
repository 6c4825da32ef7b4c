"""Tableau: the coefficients of a Runge-Kutta method, with a proof of its order by rooted trees."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property, partial
from itertools import islice, zip_longest
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import FieldError, InputError, ShapeError
from liehom.base.objects import Displayed
from liehom.base.typing import ScalarLike, VectorLike
from liehom.flow.door import RR, AlgebraicNumber, Field, Scalar, common_field

# Rooted trees and the order conditions of Runge-Kutta methods. A method (a, b) has order p if and only if, for every
# rooted tree t with at most p vertices (J. C. Butcher, Numerical Methods for Ordinary Differential Equations, section
# 31),
#     Phi(t) = sum_i b_i s_i(t) = 1/gamma(t),    s(single vertex) = 1,    s([t1, ..., tk]) = prod_j a s(tj),
# products entry by entry. gamma is the density: gamma([t1, ..., tk]) = (number of vertices) prod_j gamma(tj). Every
# tree except the vertex arises in exactly one way by grafting its last subtree v to the root of the rest u, so that s(u
# with v) = s(u) * (a s(v)). This is one product of whole arrays per number of vertices, over exact scalars as over
# floats.

MAX_ORDER = 14
"""The largest number of vertices of a tree: there are 32973 trees with 14 vertices, 53272 with at most 14."""


@final
@dataclass(frozen=True)
class RootedTree:
    """A rooted tree, written as the bracket of the subtrees at its root; the single vertex is ``RootedTree()``."""

    children: tuple[RootedTree, ...] = ()

    @cached_property
    def order(self) -> int:
        """The number of vertices."""
        return 1 + sum(child.order for child in self.children)

    def __str__(self) -> str:
        return f"[{', '.join(map(str, self.children))}]" if self.children else "τ"

    def __repr__(self) -> str:
        return f"<rooted tree {self} of order {self.order}>"


@dataclass(frozen=True, slots=True)
class Level:
    """All trees of one order: tree `start + i` is tree `left[i]` with tree `right[i]` grafted to its root."""

    start: int
    left: npt.NDArray[np.int64]
    right: npt.NDArray[np.int64]
    density: npt.NDArray[np.int64]

    @property
    def count(self) -> int:
        return len(self.left)


@cache
def level_of(order: int) -> Level:
    """All trees of one order, each once, because a grafted tree is not later in the list than those grafted before."""
    if order == 1:
        anything_may_follow = np.array([np.iinfo(np.int64).max])
        return Level(0, np.array([-1]), anything_may_follow, np.array([1]))
    below = level_of(order - 1)
    left, right, density = [], [], []
    for grafted in range(1, order):
        u, v = level_of(order - grafted), level_of(grafted)
        i, j = np.nonzero(v.start + np.arange(v.count) <= u.right[:, None])
        left.append(u.start + i)
        right.append(v.start + j)
        density.append(u.density[i] // (order - grafted) * v.density[j] * order)
    return Level(below.start + below.count, np.concatenate(left), np.concatenate(right), np.concatenate(density))


@cache
def tree_at(index: int) -> RootedTree:
    """The tree at an index in the list of all trees, sorted by order."""
    level, order = level_of(1), 1
    while index >= level.start + level.count:
        order += 1
        level = level_of(order)
    if index == 0:
        return RootedTree()
    left, right = int(level.left[index - level.start]), int(level.right[index - level.start])
    return RootedTree((*tree_at(left).children, tree_at(right)))


def checked_order(order: object, what: str = "order") -> int:
    """The order as an int between 1 and `MAX_ORDER`."""
    if isinstance(order, bool) or not isinstance(order, int | np.integer) or not 1 <= order <= MAX_ORDER:
        raise InputError(f"the {what} is an integer from 1 to {MAX_ORDER}, got {order!r}")
    return int(order)


def elementary_weights(matrix: npt.NDArray[Any], weights: npt.NDArray[Any]) -> Iterator[npt.NDArray[Any]]:
    """Iterator over the arrays of Phi(t) for the trees of order 1, of order 2, and so on through `MAX_ORDER`."""
    stages = np.ones((1, len(weights)), dtype=weights.dtype)  # s(t), one row per tree
    grafts = stages[:0]  # a s(t), likewise
    fresh = stages
    yield fresh @ weights
    for order in range(2, MAX_ORDER + 1):
        grafts = np.concatenate([grafts, fresh @ matrix.T])
        level = level_of(order)
        fresh = stages[level.left] * grafts[level.right]
        stages = np.concatenate([stages, fresh])
        yield fresh @ weights


@final
@dataclass(frozen=True, slots=True)
class Violation:
    """An order condition that does not hold: `weight` is Phi(t), `expected` is 1/gamma(t).

    Examples
    --------
    >>> from liehom.flow.methods import tableau
    >>> print(tableau("heun").first_violation())
    tree [τ, τ] of order 3: weight 1/2, expected 1/3, defect 1/6
    """

    tree: RootedTree
    weight: Scalar
    expected: Fraction
    field: Field

    @property
    def order(self) -> int:
        """The number of vertices of the tree."""
        return self.tree.order

    @property
    def defect(self) -> Scalar:
        """Phi(t) - 1/gamma(t), a number of the field."""
        return self.weight - self.field.convert(self.expected)

    def __str__(self) -> str:
        weight, defect = self.field.format(self.weight), self.field.format(self.defect)
        return f"tree {self.tree} of order {self.order}: weight {weight}, expected {self.expected}, defect {defect}"


def order_checks(
    a: Sequence[Sequence[Scalar]], b: Sequence[Scalar], field: Field, tolerance: float
) -> Iterator[tuple[Violation | None, float]]:
    """Order by order, through `MAX_ORDER`: the first condition that fails, and the largest |Phi(t) - 1/gamma(t)|."""
    by_order = elementary_weights(np.stack([_array(row, field) for row in a]), _array(b, field))
    for order, phi in enumerate(by_order, start=1):
        level = level_of(order)
        gamma = level.density
        if field.exact:  # multiplied out: division is what costs most in a number field
            wrong = [i for i, (x, g) in enumerate(zip(phi, gamma.tolist(), strict=True)) if x * g != 1]
            largest = 0.0
        else:
            defects = np.abs(phi - 1 / gamma)
            wrong, largest = np.flatnonzero(~(defects <= tolerance)).tolist(), float(defects.max())
        if not wrong:
            yield None, largest
            continue
        i = wrong[0]
        weight = phi[i] if field.exact else float(phi[i])
        yield Violation(tree_at(level.start + i), weight, Fraction(1, int(gamma[i])), field), largest


def _array(values: Sequence[Scalar], field: Field) -> npt.NDArray[Any]:
    """A vector of floats, or of objects where the numbers are exact."""
    array = np.empty(len(values), dtype=object if field.exact else np.float64)
    array[:] = values
    return array


# Tableau: the coefficients of a Runge-Kutta method, with a proof of the order that is claimed for them. The method is
# k_i = f(t + c_i h, y + h sum_j a_ij k_j), y' = y + h sum_i b_i k_i, with c_i = sum_j a_ij. The constructor evaluates
# the order conditions of all rooted trees up to the claimed order (`level_of`). Over QQ and real number fields this
# is exact and proves the order; in float64, `residual` is the largest violation.

Row = tuple[Scalar, ...]

TOLERANCE = 1e-13  # default for the largest defect of a condition in float64 that does not count as a violation


@final
@dataclasses.dataclass(frozen=True, slots=True, init=False, repr=False)
class Tableau(Displayed):
    """The coefficients of a Runge-Kutta method, whose order is proved when they are given.

    Parameters
    ----------
    a : array-like (s, s)
        Integers, fractions, strings such as '1/2' or 'sqrt(3)/6', field elements, or floats. An explicit method
        may give row i by its i entries below the diagonal.
    b : array-like (s,)
    order : int, optional
        The claimed order, from 1 to 14: every condition up to it must hold. By default the
        highest order that holds.
    name : str, optional
        What errors and plots call the method.
    c : array-like (s,), optional
        The row sums of a; they are checked if given.
    embedded_b : array-like (s,), optional
        The weights of a second method with the same stages, for estimates of the error.
    embedded_order : int, optional
        Order of the embedded method (default: the highest order that holds).
    field : Field, optional
        Default: float64 if an entry is a float, else the smallest exact field with all entries.
    tolerance : float, optional
        In float64, the largest violation that is accepted; not used over an exact field.

    Attributes
    ----------
    a, b, c, embedded_b : tuples of numbers of the field
    residual : float
        The largest violation of a condition (row sums and order conditions of both methods); 0 over an exact field.

    Raises
    ------
    FieldError, ParseError
        If an entry is not a number, or not in the field.

    Examples
    --------
    >>> import numpy as np
    >>> method = Tableau([[], ["2/3"]], ["1/4", "3/4"], name="two thirds")
    >>> method
    <tableau 'two thirds' of order 2, 2 stages, over QQ>
    >>> method.first_violation().order, method.to_numpy(np.float32)[1]
    (3, array([0.25, 0.75], dtype=float32))
    >>> Tableau([[], ["2/3"]], ["1/2", "1/2"], order=2, name="wrong")
    Traceback (most recent call last):
    ...
    liehom.base.errors.InputError: tableau 'wrong' is claimed to have order 2, but its order condition fails for the \
tree [τ] of order 2: weight 1/3, expected 1/2, defect -1/6; claim order 1, which holds, or correct the coefficients
    """

    name: str
    a: tuple[Row, ...]
    b: Row
    c: Row
    order: int
    embedded_b: Row | None
    embedded_order: int | None
    field: Field
    tolerance: float = dataclasses.field(compare=False)
    residual: float = dataclasses.field(compare=False, init=False)

    def __init__(
        self,
        a: Sequence[Sequence[ScalarLike]] | npt.NDArray[Any],
        b: VectorLike,
        order: int | None = None,
        *,
        name: str = "given",
        c: VectorLike | None = None,
        embedded_b: VectorLike | None = None,
        embedded_order: int | None = None,
        field: Field | None = None,
        tolerance: float = TOLERANCE,
    ) -> None:
        rows, weights = _square(name, a), _list(b, "b")
        nodes = None if c is None else _list(c, "c")
        embedded = None if embedded_b is None else _list(embedded_b, "embedded_b")
        for what, values in (("b", weights), ("c", nodes), ("embedded_b", embedded)):
            if values is not None and len(values) != len(rows):
                raise ShapeError(f"tableau {name!r}: a has {len(rows)} rows, {what} has {len(values)} entries")
        if embedded is None and embedded_order is not None:
            raise InputError(f"tableau {name!r} has an embedded_order and no embedded_b: give its weights")
        entries = [x for row in (*rows, weights, nodes or [], embedded or []) for x in row]
        set_ = object.__setattr__  # fills the frozen object, here and in `_prove` only
        set_(self, "field", field := _field_of(entries) if field is None else field)
        set_(self, "name", str(name))
        set_(self, "a", tuple(_converted(row, field) for row in rows))
        set_(self, "b", _converted(weights, field))
        set_(self, "c", _converted(nodes, field) if nodes is not None else self._row_sums())
        set_(self, "embedded_b", None if embedded is None else _converted(embedded, field))
        set_(self, "tolerance", float(tolerance))
        if not 0 < self.tolerance < 1:
            raise InputError(f"the tolerance of the order conditions lies between 0 and 1, got {tolerance!r}")
        set_(self, "order", max(self.actual_order(), 1) if order is None else checked_order(order))
        self._prove(embedded_order)

    @property
    def stages(self) -> int:
        """The number s of stages."""
        return len(self.b)

    @property
    def exact(self) -> bool:
        """Whether the order is proved in exact arithmetic; if not, see `residual`."""
        return self.field.exact

    @property
    def explicit(self) -> bool:
        """Whether a is strictly lower triangular: each stage needs only the earlier ones."""
        return all(x == 0 for i, row in enumerate(self.a) for x in row[i:])

    def first_violation(self, through: int = MAX_ORDER, *, embedded: bool = False) -> Violation | None:
        """The first order condition that fails, or None if all hold for trees with at most `through` vertices.

        Parameters
        ----------
        through : int
        embedded : bool
            Whether to test the embedded method.

        Examples
        --------
        >>> from liehom.flow.methods import tableau
        >>> tableau("rk4").first_violation(4) is None, tableau("rk4").first_violation().order
        (True, 5)
        """
        weights = self.embedded_b if embedded else self.b
        if weights is None:
            raise InputError(f"tableau {self.name!r} has no embedded method")
        checks = self._checks(weights, checked_order(through, "number of vertices"))
        return next((violation for violation, _ in checks if violation is not None), None)

    def actual_order(self, *, embedded: bool = False) -> int:
        """The highest order (at most 14) whose conditions all hold; 0 if sum b is not 1."""
        violation = self.first_violation(embedded=embedded)
        return MAX_ORDER if violation is None else violation.order - 1

    def to_numpy(
        self, dtype: npt.DTypeLike = np.float64
    ) -> tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any] | None]:
        """(a, b, c, embedded_b or None) as arrays of a real floating type.

        Exact numbers are rounded to that type once, not through float64. Coefficients in float64 do not gain digits in
        ``longdouble``.

        Examples
        --------
        >>> from liehom.flow.methods import tableau
        >>> a, b, c, embedded = tableau("rk23").to_numpy()
        >>> a.shape, c, embedded
        ((4, 4), array([0.  , 0.5 , 0.75, 1.  ]), array([0.29166667, 0.25      , 0.33333333, 0.125     ]))
        """
        kind = np.dtype(dtype)
        if kind.kind != "f":
            raise InputError(f"coefficients are real floating numbers, got dtype {kind}; use float64 or longdouble")

        def array(values: Row) -> npt.NDArray[Any]:
            return np.array([_rounded(x, self.field) for x in values], dtype=np.longdouble).astype(kind)

        a = np.stack([array(row) for row in self.a])
        return a, array(self.b), array(self.c), None if self.embedded_b is None else array(self.embedded_b)

    def __repr__(self) -> str:
        stages = f"{self.stages} stage{'s' if self.stages > 1 else ''}"
        embedded = "" if self.embedded_order is None else f", embedded order {self.embedded_order}"
        residual = "" if self.exact else f", residual {self.residual:.1e}"
        return f"<tableau {self.name!r} of order {self.order}, {stages}{embedded}, over {self.field.name}{residual}>"

    def __str__(self) -> str:
        def shown(x: Scalar) -> str:
            return self.field.format(x) if self.exact else f"{x:.6g}"

        below = [self.b] if self.embedded_b is None else [self.b, self.embedded_b]
        cut = self.explicit
        left = [*map(shown, self.c), *[""] * len(below)]
        right = [[shown(x) for x in (row[:i] if cut else row)] for i, row in enumerate(self.a)]
        right += [[shown(x) for x in row] for row in below]
        widths = [max(map(len, column)) for column in zip_longest(*right, fillvalue="")]
        edge = max(map(len, left))
        lines = [
            f"{c:<{edge}} | {'  '.join(f'{x:<{w}}' for x, w in zip(row, widths, strict=False))}".rstrip()
            for c, row in zip(left, right, strict=True)
        ]
        lines.insert(self.stages, "-" * (edge + 1) + "+" + "-" * (sum(widths) + 2 * len(widths) - 1))
        return "\n".join(lines)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles contain the coefficients; the order is proved again when they are read."""
        names = ("name", "c", "embedded_b", "embedded_order", "field", "tolerance")
        return partial(Tableau, self.a, self.b, self.order, **{name: getattr(self, name) for name in names}), ()

    def _row_sums(self) -> Row:
        return tuple(sum(row, self.field.zero) for row in self.a)

    def _checks(self, weights: Row, through: int) -> Iterator[tuple[Violation | None, float]]:
        return islice(order_checks(self.a, weights, self.field, self.tolerance), through)

    def _prove(self, embedded_order: int | None) -> None:
        """Row sums, then the conditions of both methods; sets `embedded_order` and `residual`."""
        sizes = [0.0]
        for i, (c, total) in enumerate(zip(self.c, self._row_sums(), strict=True)):
            sizes += [] if self.exact else [float(abs(c - total))]
            if c != total if self.exact else not sizes[-1] <= self.tolerance:
                shown = self.field.format
                raise InputError(
                    f"tableau {self.name!r}: c[{i}] = {shown(c)}, but row {i} of a sums to {shown(total)}; "
                    "leave c out, or correct the row"
                )
        sizes += self._proved_order(self.b, self.order, "")
        if self.embedded_b is not None:
            if self.embedded_b == self.b:
                raise InputError(f"tableau {self.name!r}: embedded_b equals b, so that it estimates no error")
            if embedded_order is None:
                embedded_order = max(self.actual_order(embedded=True), 1)  # order 0 is refused by the proof of 1
            embedded_order = checked_order(embedded_order, "embedded order")
            sizes += self._proved_order(self.embedded_b, embedded_order, "the embedded method of ")
        object.__setattr__(self, "embedded_order", embedded_order)
        object.__setattr__(self, "residual", max(sizes))

    def _proved_order(self, weights: Row, order: int, which: str) -> list[float]:
        sizes = []
        for violation, size in self._checks(weights, order):
            if violation is not None:
                fine = violation.order - 1
                advice = f"claim order {fine}, which holds, or" if fine else "its weights must sum to 1:"
                tolerance = "" if self.exact else f" (tolerance {self.tolerance:.0e})"
                raise InputError(
                    f"{which}tableau {self.name!r} is claimed to have order {order}, but its order condition fails "
                    f"for the {violation}{tolerance}; {advice} correct the coefficients"
                )
            sizes.append(size)
        return sizes


def _list(values: object, what: str) -> list[Any]:
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise ShapeError(f"{what} must be a sequence of numbers, got {values!r}")
    return list(values)


def _square(name: str, a: object) -> list[list[Any]]:
    """Rows of a, filled up with zeros if only the entries below the diagonal are given."""
    rows = [_list(row, f"row {i} of a") for i, row in enumerate(_list(a, "a"))]
    lengths = [len(row) for row in rows]
    if rows and lengths == list(range(len(rows))):
        return [[*row, *[0] * (len(rows) - len(row))] for row in rows]
    if not rows or any(length != len(rows) for length in lengths):
        raise ShapeError(
            f"tableau {name!r}: a has {len(rows)} rows of lengths {lengths}; expected s rows of length s, "
            "or for an explicit method row i with its i entries below the diagonal"
        )
    return rows


def _field_of(entries: list[Any]) -> Field:
    """float64 if there is a float, else the field of the algebraic numbers, else the smallest for the strings."""
    if any(isinstance(x, float | np.floating) for x in entries):
        return RR
    own = next((x.field for x in entries if isinstance(x, AlgebraicNumber)), None)
    return own or common_field(str(x) for x in entries if isinstance(x, str) or hasattr(x, "free_symbols"))


def _converted(values: list[Any], field: Field) -> Row:
    return tuple(field.convert(x) for x in values)


def _rounded(value: Scalar, field: Field) -> np.longdouble:
    """The number rounded to ``longdouble``, as a sum of three float64 parts."""
    total, rest = np.longdouble(0), value
    for _ in range(3):
        part = field.to_float(rest)
        if not math.isfinite(part):
            raise FieldError(f"the coefficient {value} is too large for floating numbers")
        total += np.longdouble(part)
        rest = rest - field.convert(Fraction(part))
    return total
