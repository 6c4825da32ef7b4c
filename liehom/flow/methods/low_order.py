"""Euler, backward Euler, Heun and LieTaylor, and steps with several exponentials."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache, reduce
from operator import add
from typing import Any, NamedTuple, final

import numpy as np

from liehom.base.errors import InputError, checked_integer
from liehom.base.typing import Values
from liehom.flow.action.exponential import TrueExponential
from liehom.flow.action.space import Action
from liehom.flow.methods.rkmk import exact_like
from liehom.flow.series.arrays import as_values, is_exact, namespace, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.steps.corrected import least_generator
from liehom.flow.steps.expansion import Flow, flow_series, step_series
from liehom.flow.steps.implicit import reach_of, solve_implicitly
from liehom.flow.steps.step import (
    Factors,
    Generator,
    LocalStep,
    OneExponential,
    Step,
    apply_factors,
    polynomial,
    step_variable,
)


@final
@dataclass(frozen=True)
class Euler(OneExponential):
    """xi = h psi(m): order 1, section 3 of the paper.

    Examples
    --------
    >>> Euler().order
    1
    """

    order = 1

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        return _along_series(action, m, [psi(m, t)])


@final
@dataclass(frozen=True)
class BackwardEuler(OneExponential):
    """xi = h psi(Exp(xi) m, t + h): order 1, implicit.

    Examples
    --------
    >>> BackwardEuler().order
    1
    """

    order = 1

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        start = zeros(m, (*np.shape(m)[:-1], action.dimension))
        return solve_implicitly(lambda x: h * psi(action.act(x, m), t + h), start, h, reach=reach_of(action))


@final
@dataclass(frozen=True)
class Heun(OneExponential):
    """xi = (h/2)(psi(m) + psi(Exp(h psi(m)) m)): order 2, the paper's RK2.

    Examples
    --------
    >>> Heun().order
    2
    """

    order = 2

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        first = psi(m, t)
        return h / 2 * (first + psi(action.act(h * first, m), t + h))


@final
@dataclass(frozen=True)
class LieTaylor(OneExponential):
    """xi = xi_1 h + ... + xi_n h^n, the series with Exp(xi(h)) m = F_h(m) to order n, for any n and any Exp.

    Parameters
    ----------
    n : int
        The order, at least 1.

    Notes
    -----
    xi' = dExp^-1_xi (psi(F_t m)): the Magnus series of the generator along the flow; for the Cayley transform on
    so(3) and n = 4 the paper's xi^sy4. For an Exp whose differential is not known, xi_k is psi_(k-1)/k plus the
    generator of minimal norm for which order k holds.

    Examples
    --------
    >>> LieTaylor(6)
    LieTaylor(n=6)
    """

    n: int

    def __post_init__(self) -> None:
        checked_integer(self.n, "the order of a Taylor step")

    @property
    def order(self) -> int:
        return int(self.n)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        flow = flow_series(psi.field, m, self.order + error_terms, t[..., 0] if np.ndim(t) else t)
        series = action.exponential.logarithmic_series(Jet.from_node(flow.generator.node))
        if series is None:
            coefficients = _fitted(action, psi, flow, m, self.order)
        else:
            coefficients = [series.coefficient(k) for k in range(1, self.order + 1)]
        local = _along_series(action, m, coefficients)
        if error_terms:
            flow.note(local, self.order + error_terms)
            step = step_series(action, local, m, self.order + error_terms)
            local.defects = tuple(
                (k, namespace(m).linalg.norm(flow.point(k) - step.coefficient(k), axis=-1))
                for k in range(self.order + 1, self.order + error_terms + 1)
            )
        return local


def _along_series(action: Action, m: Values, coefficients: Sequence[Values]) -> LocalStep:
    """The step xi(h) = xi_1 h + ... + xi_n h^n."""
    local = LocalStep(action, m, lambda h: (polynomial([None, *coefficients], h),))
    local.quick = True
    return local


def _fitted(action: Action, psi: Generator, flow: Flow, m: Values, order: int) -> list[Values]:
    """Coefficients xi_1, ..., xi_n for an Exp of which only the action is known."""
    frame = action.isotropy_frame(as_values(m), psi.orbit_dimension)
    coefficients: list[Values] = []
    for k in range(1, order + 1):
        guess = flow.psi(k - 1) / k
        step = step_series(action, _along_series(action, m, [*coefficients, guess]), m, k)
        missing = flow.point(k) - step.coefficient(k)
        coefficients.append(guess + least_generator(frame, missing))
    return coefficients


# Steps with several exponentials: Crouch-Grossman of order 3, and the commutator-free method of order 4. Each stage has
# a point Y_i, reached from an earlier one by exponentials of combinations of F_j = psi(Y_j, t + c_j h):
#     Y_i = Exp(h sum_j a_i2j F_j) Exp(h sum_j a_i1j F_j) Y_s(i),    c_i = c_s(i) + sum of its coefficients,
# starting with Y_1 = m. The result is reached in the same way. These methods do not use the differential of Exp; their
# orders hold for the true exponential.

RTOL = 1e-10  # relative tolerance in the comparison of the series of an exponential with that of exp


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
        times = [Fraction(0)]
        for start, rows in self._read[1:]:
            times.append(sum((x for row in rows for x in row), times[start]))
        return tuple(times)


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
        """Generators x_1, ..., x_s of the result."""
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
        return self if order == self.order else self.with_prepared(order=order)


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
    >>> action, psi = lh.Action(field.representation), lh.steps.Generator(field, 1)
    >>> factors = CrouchGrossman3().factors(action, psi, np.array([1.0, 0.0]), np.array([0.0]), np.array([0.5]))
    >>> len(factors), sum(factors).round(12)
    (3, array([0.25]))
    """

    order = 3
    scheme = Scheme(((0, "3/4"), (0, "119/216; 0 17/108"), (0, "13/51; 0 -2/3; 0 0 24/17")))


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
    >>> action, psi = lh.Action(field.representation), lh.steps.Generator(field, 1)
    >>> factors = CommutatorFree4().factors(action, psi, np.array([1.0, 0.0]), np.array([0.0]), np.array([1.0]))
    >>> len(factors), sum(factors).round(12)
    (2, array([1.]))
    """

    order = 4
    scheme = Scheme(((0, "1/2"), (0, "0 1/2"), (1, "-1/2 0 1"), (0, "1/4 1/6 1/6 -1/12; -1/12 1/6 1/6 1/4")))


def check_exponential(action: Action, order: int) -> None:
    """Raise InputError unless an exponential equals exp through a given order."""
    agrees = order_with(action, order)
    if agrees < order:
        raise InputError(
            f"{action.exponential.name} differs from exp at h^{agrees + 1}, so a product of exponentials cannot have "
            f"order {order} with it: take exponential='exp', an RKMK or LieTaylor step, or Corrected(step, {order}), "
            f"which raises the order {agrees} that it has"
        )


@lru_cache(maxsize=64)
def order_with(action: Action, order: int) -> int:
    """The order, at most `order`, through which an exponential equals exp, tested by a series at a generic point."""
    if order <= 2 or isinstance(action.exponential, TrueExponential):
        return order
    rng = np.random.default_rng(0)
    x, m = rng.normal(size=action.dimension), rng.normal(size=action.representation.size)
    curve: Any = action.act(x * step_variable(order, x), m)
    term: Any = m
    for k in range(1, order + 1):
        term = action.infinitesimal(x, term) / k
        if float(np.abs(curve.coefficient(k) - term).max()) > RTOL * (1 + float(np.abs(term).max())):
            return k - 1
    return order


def _combined(rows: tuple[tuple[Fraction, ...], ...], velocities: Sequence[Values], m: Values) -> Factors:
    """Generators sum_j row[j] velocities[j], one for each row."""
    terms = ([v * _number(x, m) for x, v in zip(row, velocities, strict=False) if x] for row in rows)
    return tuple(reduce(add, parts) for parts in terms)


def _number(value: Fraction, like: Values) -> Any:
    """A fraction as a number of the type of the array `like`, rounded once."""
    if is_exact(like):
        return exact_like(value, like)
    if like.dtype == np.longdouble:
        return np.longdouble(value.numerator) / np.longdouble(value.denominator)
    return float(value)
