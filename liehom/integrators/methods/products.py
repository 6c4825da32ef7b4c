"""Steps with several exponentials: Crouch-Grossman of order 3, and the commutator-free method of order 4.

Each stage has a point Y_i, reached from an earlier one by exponentials of combinations of F_j = psi(Y_j, t + c_j h):

    Y_i = Exp(h sum_j a_i2j F_j) Exp(h sum_j a_i1j F_j) Y_s(i),    c_i = c_s(i) + sum of its coefficients,

starting with Y_1 = m. The result is reached in the same way. These methods do not use the differential of Exp; their
orders hold for the true exponential.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any, NamedTuple, final

import numpy as np

from liehom.correctors.step import Factors, Generator, Step, apply_factors, step_variable
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.homogeneous.exponentials.exponential import TrueExponential
from liehom.integrators.methods.rkmk import exact_like
from liehom.series.arrays import is_exact
from liehom.typing import Values

RTOL = 1e-10
"""Relative tolerance in the comparison of the series of an exponential with that of exp."""


class StagePoint(NamedTuple):
    """The recipe of a point Y_i: index of the earlier point, and rows of coefficients in the order of application."""

    start: int
    rows: tuple[tuple[Fraction, ...], ...]


@final
@dataclass(frozen=True)
class Scheme:
    """Coefficients of a method with several exponentials.

    Parameters
    ----------
    points : tuple of (int, str)
        For each point after Y_1 = m the index (from 0) of the point it starts from, and its rows of coefficients:
        fractions separated by spaces, rows separated by ``;``. The last point is the result.

    Raises
    ------
    InputError
        If the result does not start from m, or its weights do not sum to 1.

    Examples
    --------
    >>> scheme = Scheme(((0, "1/2"), (1, "0 1/2"), (0, "0 1/2; 0 0 1/2")))
    >>> [str(c) for c in scheme.nodes], len(scheme.result.rows)
    (['0', '1/2', '1'], 2)
    """

    points: tuple[tuple[int, str], ...]

    def __post_init__(self) -> None:
        if self.result.start != 0 or self._times[-1] != 1:
            raise InputError(
                f"the result of a product of exponentials starts from m (0) with weights that sum to 1, got "
                f"{self.points[-1]!r}"
            )

    @property
    def stages(self) -> tuple[StagePoint, ...]:
        """Recipes of Y_1 = m, Y_2, ...."""
        return self._read[:-1]

    @property
    def result(self) -> StagePoint:
        """Recipe of the result."""
        return self._read[-1]

    @property
    def nodes(self) -> tuple[Fraction, ...]:
        """c_i, one for each stage."""
        return self._times[:-1]

    @cached_property
    def _read(self) -> tuple[StagePoint, ...]:
        rest = (
            StagePoint(s, tuple(tuple(map(Fraction, row.split())) for row in rows.split(";")))
            for s, rows in self.points
        )
        return (StagePoint(0, ()), *rest)

    @cached_property
    def _times(self) -> tuple[Fraction, ...]:
        found = [Fraction(0)]
        for start, rows in self._read[1:]:
            found.append(sum((x for row in rows for x in row), found[start]))
        return tuple(found)


class ProductStep(Step, ABC):
    """A step with several exponentials, given by a `Scheme`; a subclass defines `order` and `scheme`.

    Examples
    --------
    The midpoint method, in two halves of which the second starts at the midpoint:

    >>> import liehom as lh
    >>> class Halves(ProductStep):
    ...     order = 2
    ...     scheme = Scheme(((0, "1/2"), (0, "0 1/2; 0 1/2")))
    ...
    >>> Halves().one_exponential
    False
    """

    @property
    @abstractmethod
    def scheme(self) -> Scheme:
        """The coefficients, a `Scheme`."""

    def factors(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Factors:
        """Generators x_1, ..., x_s of the result.

        Raises
        ------
        InputError
            If the exponential differs from exp at a power of h that the order counts.
        """
        check_exponential(action, self.order)
        scheme = self.scheme
        points: list[Values] = []
        velocities: list[Values] = []
        for (start, rows), c in zip(scheme.stages, scheme.nodes, strict=True):
            points.append(apply_factors(action, _combined(rows, velocities, m), points[start]) if rows else m)
            velocities.append(h * psi(points[-1], t + h * _number(c, m) if c else t))
        return _combined(scheme.result.rows, velocities, m)

    def with_exponential_of(self, action: Action) -> Step:
        """The step, of the order that it has with the exponential of an action."""
        order = order_with(action, self.order)
        return self if order == self.order else _OfLowerOrder(self, order)


@final
class _OfLowerOrder(ProductStep):
    """A step with an exponential that differs from exp at a power of h that the order of the step counts."""

    def __init__(self, step: ProductStep, order: int) -> None:
        self._step, self._order = step, order

    @property
    def order(self) -> int:
        return self._order

    @property
    def scheme(self) -> Scheme:
        return self._step.scheme

    def __repr__(self) -> str:
        return repr(self._step)


@final
@dataclass(frozen=True)
class CrouchGrossman3(ProductStep):
    """Three exponentials of single velocities, order 3.

    The coefficients are those of B. Owren and A. Marthinsen, Runge-Kutta methods adapted to manifolds and based on
    rigid frames, BIT 39 (1999).  Order 3 needs more conditions than for a Runge-Kutta method.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["2*t"])
    >>> action, psi = lh.Action(field.representation), lh.correctors.Generator(field, 1)
    >>> made = CrouchGrossman3().factors(action, psi, np.array([1.0, 0.0]), np.array([0.0]), np.array([0.5]))
    >>> len(made), sum(made).round(12)
    (3, array([0.25]))
    """

    @property
    def order(self) -> int:
        return 3

    @property
    def scheme(self) -> Scheme:
        return CROUCH_GROSSMAN_3


@final
@dataclass(frozen=True)
class CommutatorFree4(ProductStep):
    """Two exponentials of combinations of four velocities, order 4.

    E. Celledoni, A. Marthinsen, B. Owren, Commutator-free Lie group methods, Future Gener. Comput. Syst. 19 (2003):
    the classical Runge-Kutta method if all velocities commute.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["4*t**3"])
    >>> action, psi = lh.Action(field.representation), lh.correctors.Generator(field, 1)
    >>> made = CommutatorFree4().factors(action, psi, np.array([1.0, 0.0]), np.array([0.0]), np.array([1.0]))
    >>> len(made), sum(made).round(12)
    (2, array([1.]))
    """

    @property
    def order(self) -> int:
        return 4

    @property
    def scheme(self) -> Scheme:
        return COMMUTATOR_FREE_4


CROUCH_GROSSMAN_3 = Scheme(((0, "3/4"), (0, "119/216; 0 17/108"), (0, "13/51; 0 -2/3; 0 0 24/17")))
COMMUTATOR_FREE_4 = Scheme(
    ((0, "1/2"), (0, "0 1/2"), (1, "-1/2 0 1"), (0, "1/4 1/6 1/6 -1/12; -1/12 1/6 1/6 1/4")),
)


def check_exponential(action: Action, order: int) -> None:
    """Raise InputError unless an exponential equals exp through a given order.

    Raises
    ------
    InputError
        If the exponential differs from exp at a power of h up to `order`.

    Examples
    --------
    >>> import liehom as lh
    >>> check_exponential(lh.Action(lh.defining(lh.so(3))), 4)
    >>> check_exponential(lh.Action(lh.defining(lh.so(3)), "cayley"), 3)
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: Cayley differs from exp at h^3, so a product of exponentials cannot have order 3 with \
it: take exponential='exp', an RKMK or LieTaylor step, or Corrected(step, 3), which raises the order 2 that it has
    """
    found = order_with(action, order)
    if found < order:
        raise InputError(
            f"{action.exponential.name} differs from exp at h^{found + 1}, so a product of exponentials cannot have "
            f"order {order} with it: take exponential='exp', an RKMK or LieTaylor step, or Corrected(step, {order}), "
            f"which raises the order {found} that it has"
        )


@lru_cache(maxsize=64)
def order_with(action: Action, order: int) -> int:
    """The order, at most `order`, through which an exponential equals exp, tested by a series at a generic point.

    Examples
    --------
    >>> import liehom as lh
    >>> order_with(lh.Action(lh.defining(lh.so(3)), "cayley"), 4)
    2
    """
    if order <= 2 or isinstance(action.exponential, TrueExponential):
        return order
    rng = np.random.default_rng(0)
    x, m = rng.normal(size=action.dimension), rng.normal(size=action.representation.size)
    made: Any = action.act(x * step_variable(order, x), m)
    term: Any = m
    for k in range(1, order + 1):
        term = action.infinitesimal(x, term) / k
        if float(np.abs(made.coefficient(k) - term).max()) > RTOL * (1 + float(np.abs(term).max())):
            return k - 1
    return order


# -- private helpers -------------------------------------------------------------------------------------
def _combined(rows: tuple[tuple[Fraction, ...], ...], velocities: Sequence[Values], m: Values) -> Factors:
    """Generators sum_j row[j] velocities[j], one for each row."""
    made = []
    for row in rows:
        terms = [velocity * _number(x, m) for x, velocity in zip(row, velocities, strict=False) if x]
        made.append(sum(terms[1:], terms[0]))
    return tuple(made)


def _number(value: Fraction, like: Values) -> Any:
    """A fraction as a number of the type of the array `like`, rounded once."""
    if is_exact(like):
        return exact_like(value, like)
    if like.dtype == np.longdouble:
        return np.longdouble(value.numerator) / np.longdouble(value.denominator)
    return float(value)
