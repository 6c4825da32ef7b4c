"""Steps for stiff fields: implicit RKMK, Rosenbrock and exponential Rosenbrock steps."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import factorial, sqrt
from typing import Any, NamedTuple, final

import numpy as np

from liehom.base.errors import InputError, TraceError, displayed
from liehom.base.typing import Lanes, Real, Values
from liehom.flow.action.maps import applied, identity, inverse, solve
from liehom.flow.action.space import Action
from liehom.flow.methods.rkmk import RKMK, EmbeddedStep, Stages, estimate_order, sparse_row
from liehom.flow.methods.runge_kutta import Tableau
from liehom.flow.methods.tableaux import tableau as tableau_of
from liehom.flow.run.check import repeated, widest_gap
from liehom.flow.series.arrays import is_lazy, namespace, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.steps.implicit import (
    DIFFERENCE,
    MAX_TRACED,
    NOT_ON_JETS,
    Equation,
    SparseRow,
    Stage,
    combined,
    reach_of,
)
from liehom.flow.steps.step import Generator, LastSize, LocalStep, OneExponential, length, polynomial
from liehom.flow.tracing.array import Traced

# Linearization: u' = f(u, s) in the algebra at a point, with f(u, s) = dexp^-1_u psi(Exp(u) m, t + s).


@final
class Linearization:
    """f and its derivatives at u = 0, s = 0."""

    def __init__(self, action: Action, psi: Generator, m: Values, t: Values, terms: int) -> None:
        self.action, self.psi, self.m, self.t, self.terms = action, psi, m, t, terms
        self.shape = (*np.shape(m)[:-1], action.dimension)
        self.start: Values = psi(m, t)  # f(0, 0)

    def value(self, u: Values, s: Real) -> Values:
        """f(u, s), of the shape of u."""
        velocity = self.psi(self.action.act(u, self.m), self.t + s)
        if self.terms > 1:
            velocity = self.action.exponential.differential_inverse(u, velocity, self.terms)
        return velocity

    @cached_property
    def jacobian(self) -> Values:
        """df/du, shape (..., n, n)."""
        equation = Equation(lambda y: [self.value(y[0], 0.0)], [((0, 1.0),)])
        return equation.blocks(zeros(self.m, (1, *self.shape)))[0]

    @cached_property
    def rate(self) -> Values | None:
        """df/ds, shape (..., n); None if psi does not depend on t."""
        if not self.psi.field.time_dependent:
            return None
        try:
            moved: Any = self.psi(Jet.constant(self.m, 1), Jet.variable(self.t, 1))
            return moved.coefficient(1) if isinstance(moved, Jet) else 0 * moved
        except NOT_ON_JETS:
            return (self.psi(self.m, self.t + DIFFERENCE) - self.start) / DIFFERENCE

    def solve(self, scale: Values, right: Values) -> Values:
        """x with (1 - scale J) x = right, for scale (..., 1)."""
        return solve(np.eye(self.shape[-1]) - scale[..., None] * self.jacobian, right[..., None])[..., 0]


# StiffRKMK: implicit Runge-Kutta-Munthe-Kaas steps with an estimate of the error that stays small for stiff fields. For
# a collocation method with s stages the comparison is the quadrature with the nodes 0, c_1, ..., c_s and weight gamma
# at 0, of order s (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.8). The difference is
# multiplied by (1 - h gamma J)^-1, J the derivative of the equation in the algebra, which keeps it bounded for stiff J.
# It is gamma times the difference of field and collocation polynomial at the start of the step, and the same is asked
# for at looks within the step (`liehom.flow.run.check`), which is as long as its error allows.
#
# Steps of adaptive sizes, of up to 18 unknowns, solve their equations to a small part of the tolerance. They are given
# up, and tried with a smaller size, if Newton's method does not converge or X grows too fast at the solution: L-stable
# methods damp what grows, and stay where a trajectory leaves.

MAX_ITERATIONS = 12
SOLVED = 1e-6  # of the error that is allowed: engines that solve the equations to round-off have the same points
ROUNDED = 1e-11  # changes below this, in units of the reach, may be round-off


@final
@dataclasses.dataclass(frozen=True, init=False, repr=False)
class StiffRKMK(OneExponential):
    """The Runge-Kutta-Munthe-Kaas step of an implicit tableau, with a step size for stiff fields.

    With a fixed step size it is `RKMK` of the same tableau. An adaptive size follows from an embedded estimate, whereas
    that of `RKMK` follows from Taylor coefficients of the error, which are large for stiff fields.

    Parameters
    ----------
    tableau : Tableau or str
        "radau3", "radau5", "radau9" (Radau IIA, L-stable), "sdirk4" (L-stable), "gauss2", "gauss3", ... (A-stable).

    Examples
    --------
    A field with the rate 10^4, in a few steps:

    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 1e4 * np.cross(m, [0, 0, 1.0]))
    >>> sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=StiffRKMK("radau5"), rtol=1e-6)
    >>> sol.success, sol.n_steps < 60, bool(abs(sol.y[2, -1] - 1) < 1e-9)
    (True, True, True)
    """

    tableau: Tableau
    _base: RKMK = dataclasses.field(compare=False)

    def __init__(self, tableau: Tableau | str) -> None:
        object.__setattr__(self, "tableau", tableau_of(tableau))
        object.__setattr__(self, "_base", RKMK(self.tableau))
        if self.tableau.explicit:
            raise InputError(f"tableau {self.tableau.name!r} is explicit: take RKMK({self.tableau.name!r})")
        object.__setattr__(self, "_estimate", _estimate_of(self.tableau))
        object.__setattr__(self, "_polynomial", _collocation_of(self.tableau))

    @property
    def order(self) -> int:
        return self.tableau.order

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        stages = Stages(self._base, action, psi, m, t)
        few = len(self.tableau.b) * action.dimension <= MAX_TRACED and not psi.field.sites
        polynomial = self._polynomial if error_terms and few else None  # type: ignore[attr-defined]
        return StiffStep(stages, polynomial, *self._estimate)  # type: ignore[attr-defined]

    def __repr__(self) -> str:
        return f"StiffRKMK({self.tableau.name!r})"


@final
class StiffStep(EmbeddedStep):
    """An implicit step at one point, with the estimate of its error; `StiffRKMK.at` returns it."""

    def __init__(
        self, stages: Stages, collocation: Collocation | None, weights: SparseRow, gamma: float, at_start: bool,
        order: int,
    ) -> None:  # fmt: skip
        action, numbers = stages.action, stages.numbers
        generator = partial(stages.combined, numbers.b)
        super().__init__(action, stages.m, generator, self._filtered, order, numbers.widest_gap)
        self._stages, self._weights, self._gamma, self._at_start = stages, weights, gamma, at_start
        self._linear = linear = Linearization(action, stages.psi, stages.m, stages.t, stages.method.terms)
        self._filter = LastSize(lambda h: inverse(np.eye(action.dimension) - (gamma * h)[..., None] * linear.jacobian))
        if collocation is not None:
            self._collocation, self.collocates, stages.solver = collocation, True, self._solved

    def _filtered(self, h: Values) -> Values:
        """The difference of two methods, filtered."""
        stages = self._stages
        known = stages.through(h, max(i for i, _ in (*stages.numbers.b, *self._weights)) + 1)
        difference: Any = combined(self._weights, known)
        if self._at_start:
            difference = difference + self._gamma * h * self._linear.start
        x: Any = applied(self._filter(h), difference)
        return namespace(x).where(self._settled[..., None], x, np.nan) if self.collocates else x

    def estimate_within(self, h: Values, part: Values) -> Values:
        """The same vectors (..., N) with psi at the time part h, 0 <= part < 1, in place of the start."""
        k = self._stages.through(h, len(self._collocation.powers))
        slope: list[Any] = [combined(row, k) for row in self._collocation.powers]
        u = part * polynomial([x / (j + 1) for j, x in enumerate(slope)], part)
        difference = self._gamma * (h * self._linear.value(u, part * h) - polynomial(slope, part))
        return self.action.infinitesimal(applied(self._filter(h), difference), self.action.act(u, self.m))

    def _equation(self, function: Callable[[Any, Any], Any]) -> Equation:
        """An equation for the stages one by one: a function of a generator or point, and of the time of the stage."""
        times = self._stages.numbers.c
        return Equation(
            lambda y: [function(x, c) for x, c in zip(y, times, strict=True)], [((i, 1.0),) for i in range(len(times))]
        )

    def _solved(self, h: Values) -> list[Any]:
        """k_1, ..., k_s with k = A^-1 u, by Newton's method for A^-1 u = k(u); NaN where it finds no solution."""
        linear, rows, unit = self._linear, self._collocation.inverse, reach_of(self.action)
        xp, bound = namespace(h, linear.start), SOLVED * unit * self.allowed / length(self.m)
        equation = self._equation(lambda u, c: h * linear.value(u, c * h))

        def iteration(active: Lanes, u: Lanes, before: Lanes, solved: Lanes) -> list[Lanes]:
            rest = equation.value(u) - xp.stack([combined(row, u) for row in rows])
            change: Any = xp.stack(_eliminated(rows, equation.blocks(u), list(rest)))
            size = xp.sqrt((change * change).sum(axis=(0, -1)))
            rounded = (size <= ROUNDED * unit) & (size >= before / 2)
            ends = (size <= unit) & ((size**3 <= bound * before**2) | rounded)  # the next change is about the square
            good = active & xp.isfinite(size) & ~(ends & (size > ROUNDED * unit) & self._grows(u, change, h))
            change = xp.where(size > unit, unit / xp.where(size > unit, size, 1.0), 1.0)[..., None] * change
            return [good & ~ends, xp.where(active[..., None], u + change, u), size, solved | (good & ends)]

        # first the derivative at the start of the step: those at the times of the stages, where the start is far from
        # the solution, have large derivatives along the isotropy
        zero: Any = 0.0 * (h * linear.start)
        rest = [h * linear.psi(linear.m, linear.t + c * h) + zero for c in self._stages.numbers.c]
        u = xp.stack(_eliminated(rows, [h[..., None] * linear.jacobian] * len(rows), rest))
        no = zero[..., 0] != 0
        with np.errstate(over="ignore", invalid="ignore"):
            _, u, _, self._settled = repeated(
                iteration, [~no, u, xp.sqrt((u * u).sum(axis=(0, -1))), no], MAX_ITERATIONS
            )
        # a kernel rejects the step by its estimate if the point is finite
        u = xp.where(self._settled[..., None], u, 0.0 if isinstance(h, Traced) else np.nan)
        return [combined(row, u) for row in rows]

    def _grows(self, u: Lanes, change: Lanes, h: Values) -> Lanes:
        """Whether X grows at a stage, in the direction of its change, so fast that the step would damp it."""
        action, linear, xp = self.action, self._linear, namespace(u)
        flow = self._equation(lambda y, c: action.infinitesimal(linear.psi(y, linear.t + c * h), y))
        points: Any = xp.stack([action.act(x, self.m) for x in u])
        d: Any = xp.stack([action.infinitesimal(x, y) for x, y in zip(change, points, strict=True)])
        growth: Any = self._gamma * h * (flow.along(points, d) * d).sum(axis=-1, keepdims=True)
        return (growth > (d * d).sum(axis=-1, keepdims=True))[..., 0].any(axis=0)

    def valid(self, h: Values) -> Values | bool:
        if not self.collocates:
            return True
        self._stages.through(h, 1)
        return self._settled


class Collocation(NamedTuple):
    """The rows of A^-1, and of the polynomial h u'(x h) = sum_j x^j sum_i powers[j][i] k_i of the stages k_i."""

    powers: tuple[SparseRow, ...]
    inverse: tuple[SparseRow, ...]


def _collocation_of(tableau: Tableau) -> Collocation | None:
    """None if the points of the stages are not those of a polynomial, or one of them is the start."""
    a, _, c, _ = tableau.to_numpy()
    power = np.arange(1, len(c) + 1)
    if not np.allclose(a @ c[:, None] ** (power - 1), c[:, None] ** power / power, rtol=0, atol=1e-10) or not c.all():
        return None
    parts = np.linalg.inv(np.vander(c, increasing=True)), np.linalg.inv(a)
    return Collocation(*(tuple(sparse_row(row) for row in part.tolist()) for part in parts))


def _eliminated(rows: Sequence[SparseRow], blocks: Sequence[Any] | Values, rest: list[Any]) -> list[Any]:
    """x with sum_j rows[i][j] x_j - blocks[i] x_i = rest[i], by elimination of the whole x_i one after the other."""
    parts: Any = blocks
    s, one = len(rows), identity(parts[0])
    m: list[list[Any]] = [
        [one * dict(row).get(j, 0.0) - (parts[i] if i == j else 0.0) for j in range(s)] for i, row in enumerate(rows)
    ]
    for i in range(s):
        m[i][i] = inverse(m[i][i])
        for j in range(i + 1, s):
            factor = m[j][i] @ m[i][i]
            rest[j] = rest[j] - applied(factor, rest[i])
            for k in range(i + 1, s):
                m[j][k] = m[j][k] - factor @ m[i][k]
    for i in reversed(range(s)):
        for k in range(i + 1, s):
            rest[i] = rest[i] - applied(m[i][k], rest[k])
        rest[i] = applied(m[i][i], rest[i])
    return rest


def _estimate_of(tableau: Tableau) -> tuple[SparseRow, float, bool, int]:
    """Weights of the estimate, gamma, whether f(0) takes part, and the order of the estimate."""
    a, b, c, embedded = tableau.to_numpy()
    eigenvalues = np.linalg.eigvals(a)
    real = np.abs(eigenvalues[np.abs(eigenvalues.imag) < 1e-6])
    gamma = float(real.max() if real.size and real.max() > 0 else np.abs(eigenvalues).max())
    if embedded is not None:
        return sparse_row((embedded - b).tolist()), gamma, False, estimate_order(tableau)
    s = len(c)
    if len(np.unique(np.round(c, 12))) < s or bool((np.abs(c) < 1e-12).any()):
        raise InputError(
            f"tableau {tableau.name!r} has no embedded method, and its nodes {c.round(6).tolist()} give none: take "
            "distinct nodes other than 0, or RKMK with a fixed step size"
        )
    # sum_i w_i c_i^(q-1) = 1/q for q = 1, ..., s, where the node 0 contributes gamma to q = 1
    powers = np.vander(c, s, increasing=True).T
    wanted = 1 / np.arange(1, s + 1)
    wanted[0] -= gamma
    return sparse_row((np.linalg.solve(powers, wanted) - b).tolist()), gamma, True, s + 1


# Rosenbrock: linearly implicit steps, which solve linear systems with 1 - h gamma J and iterate nothing. For u' = f(u,
# s), u(0) = 0 in the algebra, with J = f_u(0, 0) and f_s at the start,
#     (1/gamma - h J) U_i = h f(sum_j a_ij U_j, alpha_i h) + sum_j c_ij U_j + gamma_i h^2 f_s,    u = sum_i m_i U_i
# (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.7).

_G = 1 - 1 / sqrt(2)


class RosenbrockData(NamedTuple):
    """Coefficients of a method; `e` are the weights of the estimate of the error, of order `estimate_order`."""

    order: int
    gamma: float
    a: tuple[tuple[float, ...], ...]
    c: tuple[tuple[float, ...], ...]
    m: tuple[float, ...]
    e: tuple[float, ...]
    alpha: tuple[float, ...]
    gammas: tuple[float, ...]
    estimate_order: int


_RODAS5 = (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950)
METHODS = {
    "ros2": RosenbrockData(
        2, _G, ((), (1 / _G,)), ((), (-2 / _G,)), (1.5 / _G, 0.5 / _G), (0.5 / _G, 0.5 / _G), (0.0, 1.0), (_G, -_G), 2
    ),
    "rodas3": RosenbrockData(
        3, 0.5, ((), (0.0,), (2.0, 0.0), (2.0, 0.0, 1.0)), ((), (4.0,), (1.0, -1.0), (1.0, -1.0, -8 / 3)),
        (2.0, 0.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0), (0.5, 1.5, 0.0, 0.0), 3,
    ),
    "rodas4": RosenbrockData(
        4, 0.25,
        (
            (), (1.544,), (0.9466785280815826, 0.2557011698983284),
            (3.314825187068521, 2.896124015972201, 0.9986419139977817), _RODAS5, (*_RODAS5, 1.0),
        ),
        (
            (), (-5.6688,), (-2.430093356833875, -0.2063599157091915),
            (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
            (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160),
            (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054),
        ),
        (*_RODAS5, 1.0, 1.0), (0.0, 0.0, 0.0, 0.0, 0.0, 1.0), (0.0, 0.386, 0.21, 0.63, 1.0, 1.0),
        (0.25, -0.1043, 0.1035, -0.03620000000000023, 0.0, 0.0), 4,
    ),
}  # fmt: skip
"""ros2: J. G. Verwer et al. 1999; rodas3: A. Sandu et al. 1997; rodas4: E. Hairer, G. Wanner 1996. All are L-stable."""


@final
@dataclass(frozen=True)
class Rosenbrock(OneExponential):
    """A linearly implicit step of order 2, 3 or 4 for stiff fields, with an estimate of its error.

    Parameters
    ----------
    name : str
        "ros2", "rodas3" or "rodas4".

    Notes
    -----
    psi is differentiated by Jets; psi that does not run on Jets is differentiated by differences.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 1e4 * np.cross(m, [0, 0, 1.0]))
    >>> sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=Rosenbrock("rodas4"))
    >>> sol.success, sol.n_steps < 80, bool(abs(sol.y[2, -1] - 1) < 1e-9)
    (True, True, True)
    """

    name: str = "rodas4"

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or self.name not in METHODS:
            known = ", ".join(map(repr, METHODS))
            raise InputError(f"no Rosenbrock method is called {displayed(self.name)}; known: {known}")

    @property
    def order(self) -> int:
        return METHODS[self.name].order

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        method, linear = METHODS[self.name], Linearization(action, psi, m, t, max(self.order - 1, 1))
        stages = LastSize(lambda h: _rosenbrock_stages(method, linear, h))
        generator, difference = sparse_row(method.m), sparse_row(method.e)
        return EmbeddedStep(
            action, m, lambda h: combined(generator, stages(h)), lambda h: combined(difference, stages(h)),
            method.estimate_order, widest_gap(method.alpha),
        )  # fmt: skip


def _rosenbrock_stages(method: RosenbrockData, linear: Linearization, h: Values) -> list[Any]:
    """U_1, ..., U_s."""
    stages: list[Any] = []
    for i, gamma_i in enumerate(method.gammas):
        u = combined(sparse_row(method.a[i]), stages)
        if u is None:
            right = h * (linear.start if method.alpha[i] == 0 else linear.psi(linear.m, linear.t + method.alpha[i] * h))
        else:
            right = h * linear.value(u, method.alpha[i] * h)
        before = combined(sparse_row(method.c[i]), stages)
        right = right if before is None else right + before
        if gamma_i and linear.rate is not None:
            right = right + gamma_i * h * h * linear.rate
        stages.append(linear.solve(method.gamma * h, method.gamma * right))
    return stages


# ExponentialRosenbrock: steps that integrate the linearization of the field exactly. For u' = f(u), u(0) = 0 in the
# algebra, J = f'(0), D(u) = f(u) - f(0) - J u and phi_k(z) = sum_j z^j / (j + k)!,
#     order 2:  u = h phi_1 f(0)
#     order 3:  u = v + 2 h phi_3 D(v),   v = h phi_1 f(0)
#     order 4:  u = v + h (16 phi_3 - 48 phi_4) D(p) + h (12 phi_4 - 2 phi_3) D(q),
#               p = h/2 phi_1(h J/2) f(0),   q = v + h phi_1 D(p)
# with phi_k = phi_k(h J) (M. Hochbruck, A. Ostermann, J. Schweitzer, SIAM J. Numer. Anal. 47, 2009). Time is an
# additional coordinate s of the linear equation, s' = 1.

PHIS = 4  # phi_1, ..., phi_4 are computed together


@final
@dataclass(frozen=True)
class ExponentialRosenbrock(OneExponential):
    """An exponential step of order 2, 3 or 4 for stiff and for rapidly oscillating fields.

    Parameters
    ----------
    order : int

    Notes
    -----
    Orders 3 and 4 have an estimate of the error. The functions phi_k are those of matrices, computed by
    ``scipy.linalg.expm``, so the step is not compiled.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 1e4 * np.cross(m, [0, 0, 1.0]))
    >>> sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=ExponentialRosenbrock(4))
    >>> sol.success, sol.n_steps < 80, bool(abs(sol.y[2, -1] - 1) < 1e-9)
    (True, True, True)
    """

    order: int = 4

    def __post_init__(self) -> None:
        if isinstance(self.order, bool) or self.order not in (2, 3, 4):
            raise InputError(f"exponential Rosenbrock steps have order 2, 3 or 4, got {displayed(self.order)}")

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        if is_lazy(m):
            raise TraceError("exponential Rosenbrock steps need exponentials of matrices: take Rosenbrock('rodas4')")
        linear = Linearization(action, psi, m, t, max(self.order - 1, 1))
        both = LastSize(lambda h: self._computed(linear, h))
        order = None if self.order == 2 else self.order
        return EmbeddedStep(action, m, lambda h: both(h)[0], lambda h: both(h)[1], order, 1.0)

    def _computed(self, at: Linearization, h: Values) -> tuple[Any, Any]:
        """The generator of the step of size h, and the difference from the one of lower order."""
        rate = at.rate
        jacobian: Any = at.jacobian
        phi = _phis(h, jacobian)
        v = h * applied(phi[0], at.start)
        if rate is not None:
            v = v + h * h * applied(phi[1], rate)
        if self.order == 2:
            return v, None

        def rest(u: Values, s: Values) -> Stage:
            difference = at.value(u, s) - at.start - applied(jacobian, u)
            return difference if rate is None else difference - s * rate

        if self.order == 3:
            extra = 2 * h * applied(phi[2], rest(v, h))
            return v + extra, extra
        half = _phis(h / 2, jacobian)
        p = h / 2 * applied(half[0], at.start)
        if rate is not None:
            p = p + h * h / 4 * applied(half[1], rate)
        d = rest(p, h / 2)
        e = rest(v + h * applied(phi[0], d), h)
        extra = h * applied(phi[3], 12 * e - 48 * d)
        return v + h * applied(phi[2], 16 * d - 2 * e) + extra, extra


def _phis(h: Values, jacobian: Values) -> list[Any]:
    """phi_1(h J), ..., phi_4(h J), each of shape (..., n, n), for h (..., 1)."""
    a: Any = h[..., None] * jacobian
    n = jacobian.shape[-1]
    if isinstance(a, Jet):
        return [_series(a, k, n) for k in range(1, PHIS + 1)]
    from scipy.linalg import expm

    wide = np.zeros((*a.shape[:-2], n * (PHIS + 1), n * (PHIS + 1)))
    wide[..., :n, :n] = np.where(np.isfinite(a).all(axis=(-1, -2), keepdims=True), a, 0.0)
    for k in range(PHIS):
        wide[..., n * k : n * (k + 1), n * (k + 1) : n * (k + 2)] = np.eye(n)
    exponential = expm(wide)
    return [exponential[..., :n, n * k : n * (k + 1)] for k in range(1, PHIS + 1)]


def _series(a: Jet, k: int, n: int) -> Stage:
    """phi_k of a series without constant term."""
    total, power = np.eye(n) / factorial(k), a
    for j in range(1, a.order + 1):
        total = total + power / factorial(j + k)
        power = power @ a
    return total
