"""RKMK: Runge-Kutta-Munthe-Kaas steps, any Runge-Kutta method carried to homogeneous spaces, with one exponential.

u(t) in g with Exp(u(t)) m = F_t(m) solves u' = dExp^-1_u psi(Exp(u) m, t), u(0) = 0.  A Runge-Kutta method for it is

    k_i = h dExp^-1_{u_i} psi(Exp(u_i) m, t + c_i h),   u_i = sum_j a_ij k_j,   xi = sum_i b_i k_i

(H. Munthe-Kaas, High order Runge-Kutta methods on manifolds, Appl. Numer. Math. 29, 1999).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cached_property, partial
from typing import Any, NamedTuple, final

import numpy as np

from liehom.base.errors import InputError
from liehom.base.typing import Values
from liehom.flow.action.space import Action
from liehom.flow.door import QQ
from liehom.flow.methods.runge_kutta import Tableau
from liehom.flow.methods.tableaux import tableau as tableau_of
from liehom.flow.run.check import widest_gap
from liehom.flow.series.arrays import is_exact, is_jax, zeros
from liehom.flow.steps.implicit import SparseRow, combined, reach_of, solve_implicitly
from liehom.flow.steps.step import Generator, LastSize, LocalStep, OneExponential


class Coefficients(NamedTuple):
    """Coefficients of a tableau in the numbers of a computation; `difference` is b - embedded_b."""

    a: tuple[SparseRow, ...]
    b: SparseRow
    c: tuple[Any, ...]
    difference: SparseRow
    widest_gap: float = 1.0  # between the nodes of the stages on which step and estimate depend, in units of the step


@final
@dataclasses.dataclass(frozen=True, init=False, repr=False)
class RKMK(OneExponential):
    """The Runge-Kutta-Munthe-Kaas step of a tableau, explicit or implicit, of the order of the tableau.

    Parameters
    ----------
    tableau : Tableau or str
        A name such as "rk4", "gauss2", "dop853": see `tableau_names`.

    Raises
    ------
    ConvergenceError
        In an implicit step, if the iteration does not converge because the step size is too large.

    Notes
    -----
    A method of order p uses the terms ad_u^0, ..., ad_u^(p-2) of dexp^-1_u (`terms`). That is enough: along the
    solution ad_u psi = O(h^2), as u = h psi + O(h^2), so the neglected terms change the equation by
    ad_u^(p-1) psi = O(h^p). For order at most 2 the differential is not needed, and Exp is arbitrary.

    If the tableau has an embedded method, ``at(...)`` returns an `EmbeddedStep`. Its ``estimate(h)`` is the difference
    of the two methods as a vector in V, of the order ``estimate_order`` in h. Both methods share their stages; stages
    with zero weight are computed only for the estimate. Both share the terms of dexp^-1 too, so the estimate does not
    see those that are missing. Therefore a pair uses one more, ad_u^(p-1), which is zero for even p > 2.

    Coefficients are rounded once to the type of m. Over exact scalars they are exact, and so are expansions in h.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> RKMK("rk4"), RKMK("gauss2").order
    (RKMK('rk4'), 4)
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["2*t"])
    >>> action, psi = lh.Action(field.representation), lh.steps.Generator(field, 1)
    >>> local = RKMK("rk45").at(action, psi, np.array([1.0, 0.0]), np.array([0.0]))
    >>> local.factors(np.array([0.5]))[0].round(12), local.estimate(np.array([0.5])).round(12) + 0.0
    (array([0.25]), array([0., 0.]))
    """

    tableau: Tableau
    _floating: dict[str, Coefficients] = dataclasses.field(compare=False)

    def __init__(self, tableau: Tableau | str) -> None:
        object.__setattr__(self, "tableau", tableau_of(tableau))
        object.__setattr__(self, "_floating", {})

    @property
    def order(self) -> int:
        return self.tableau.order

    @property
    def terms(self) -> int:
        """Number of terms of the series of dexp^-1 in use, at least 1: the order minus 1, or the order for a pair."""
        pair = self.order > 2 and self.tableau.embedded_b is not None
        return max(self.order - 1 + pair, 1)

    def coefficients(self, like: Values) -> Coefficients:
        """The nonzero coefficients in the numbers of the array `like`."""
        if is_exact(like):
            return self._exact(like)
        kind = "g" if like.dtype == np.longdouble and not is_jax(like) else "d"
        if kind not in self._floating:
            a, b, c, embedded = self.tableau.to_numpy(np.dtype(kind))
            number = np.longdouble if kind == "g" else float
            numbers = _coefficients(
                [[number(x) for x in row] for row in (*a, b, c, b if embedded is None else embedded)]
            )
            gap = widest_gap([numbers.c[i] for i, _ in (*numbers.b, *numbers.difference)])
            self._floating[kind] = numbers._replace(widest_gap=gap)
        return self._floating[kind]

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        stages = Stages(self, action, psi, m, t)
        return stages.combined(stages.numbers.b, h)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        if self.tableau.embedded_b is None:
            return super().at(action, psi, m, t, error_terms=error_terms)
        stages = Stages(self, action, psi, m, t)
        generator, difference = (partial(stages.combined, row) for row in (stages.numbers.b, stages.numbers.difference))
        return EmbeddedStep(action, m, generator, difference, estimate_order(self.tableau), stages.numbers.widest_gap)

    def __repr__(self) -> str:
        return f"RKMK({self.tableau.name!r})"

    def _exact(self, like: Values) -> Coefficients:
        tableau = self.tableau
        if not tableau.exact:
            raise InputError(
                f"the coefficients of {tableau.name!r} are floats and the point is exact: take an exact tableau, or "
                "the point in floats"
            )
        embedded = tableau.b if tableau.embedded_b is None else tableau.embedded_b
        rows = (*tableau.a, tableau.b, tableau.c, embedded)
        if tableau.field == QQ:
            return _coefficients(
                [[exact_like(Fraction(int(x.p), int(x.q)), like) for x in map(QQ.convert, row)] for row in rows]
            )
        return _coefficients([list(row) for row in rows])


class EmbeddedStep(LocalStep):
    """A step with one exponential at one point, and its difference from another generator as estimate of its error."""

    def __init__(
        self, action: Action, m: Values, generator: Callable[[Values], Values], difference: Callable[[Values], Values],
        order: int | None, gap: float,
    ) -> None:  # fmt: skip
        super().__init__(action, m, lambda h: (generator(h),))
        self.estimate_order, self.widest_gap, self._difference = order, gap, difference

    def estimate(self, h: Values) -> Values:
        """rho(x) m with x the difference, for h (..., 1) or a Jet, to leading order the error; shape (..., N)."""
        return self.action.infinitesimal(self._difference(h), self.m)


def estimate_order(tableau: Tableau) -> int:
    """The order in h of the difference of the two methods of a tableau."""
    return min(tableau.order, tableau.embedded_order or tableau.order) + 1


@final
class Stages:
    """Stages k_i of a method at one point, on demand for the last h."""

    def __init__(self, method: RKMK, action: Action, psi: Generator, m: Values, t: Values) -> None:
        self.method, self.action, self.psi, self.m, self.t = method, action, psi, m, t
        self.numbers: Coefficients = method.coefficients(m)
        # a row without entries beyond its diagonal needs no later stage
        self._sequential = all(j <= i for i, row in enumerate(self.numbers.a) for j, _ in row)
        self._shape = (*np.shape(m)[:-1], action.dimension)
        self._known: LastSize[list[Values]] = LastSize(lambda h: [])
        self.solver: Callable[[Values], list[Values]] = self._solved  # of all stages at once

    def combined(self, weights: SparseRow, h: Values) -> Values:
        """sum_i weights[i] k_i, by the stages that are needed."""
        return combined(weights, self.through(h, weights[-1][0] + 1))

    def through(self, h: Values, count: int) -> Sequence[Values]:
        """The first `count` stages; later ones are computed only if the method is implicit in all of them."""
        known = self._known(h)
        if not self._sequential and not known:
            known += self.solver(h)
        while len(known) < count:
            known.append(self._next(known, h))
        return known

    def _next(self, known: list[Values], h: Values) -> Values:
        """The stage after the known ones, by an equation for it alone if a_ii is not zero."""
        i = len(known)
        row = self.numbers.a[i]
        if not row or row[-1][0] < i:
            return self._stage(i, combined(row, known), h)
        before, (_, diagonal) = combined(row[:-1], known), row[-1]

        def stage(k: Values) -> Values:
            return self._stage(i, k * diagonal if before is None else before + k * diagonal, h)

        return solve_implicitly(stage, zeros(self.m, self._shape), h, reach=reach_of(self.action))

    def _solved(self, h: Values) -> list[Values]:
        """All stages of an implicit method, from one equation for an array with a first axis for the stages."""
        rows, start = self.numbers.a, zeros(self.m, (len(self.numbers.a), *self._shape))

        def stages(u: list[Any]) -> list[Values]:
            return [self._stage(i, x, h) for i, x in enumerate(u)]

        k = solve_implicitly(stages, start, h, rows=rows, reach=reach_of(self.action))
        return [k[i] for i in range(len(rows))]

    @cached_property
    def _start(self) -> Values:
        return self.psi(self.m, self.t)

    def _stage(self, i: int, u: Values | None, h: Values) -> Values:
        """k_i for the generator u of its point, None for u = 0."""
        c = self.numbers.c[i]
        if u is None and c == 0:
            return h * self._start
        time = self.t + h * c
        if u is None:
            return h * self.psi(self.m, time)
        velocity = self.psi(self.action.act(u, self.m), time)
        if self.method.terms > 1:
            velocity = self.action.exponential.differential_inverse(u, velocity, self.method.terms)
        return h * velocity


def exact_like(value: Fraction, like: Values) -> Any:
    """A fraction as an exact number of the kind in the array `like`."""
    return (zeros(like, ())[()] + 1) * value.numerator / value.denominator


def _coefficients(rows: Sequence[Sequence[Any]]) -> Coefficients:
    """Coefficients from the rows of a, and b, c and the embedded weights as last rows."""
    *a, b, c, embedded = rows
    weights, difference = sparse_row(b), sparse_row([x - y for x, y in zip(b, embedded, strict=True)])
    return Coefficients(tuple(sparse_row(row) for row in a), weights, tuple(c), difference)


def sparse_row(row: Sequence[Any]) -> SparseRow:
    """The nonzero entries of a row."""
    return tuple((j, x) for j, x in enumerate(row) if x != 0)
