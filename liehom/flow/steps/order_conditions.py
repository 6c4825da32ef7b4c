"""The condition of Theorem 5 at a point: chi, and whether a given step can be raised to the next order.

With zeta(t) = zeta_1 t + zeta_2 t^2 + ... in g_m added to the generator of a step (an outermost factor for a step
with several exponentials),

    chi^(n)(zeta) = (d/dt)^n [step_zeta(t) - F_t(m)] at t = 0,    (5.5): c w_l in the range of chi^(n) for some c

The answer is exact if point and field are exact; in floats it comes with the singular values that decided.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial
from typing import Any, final

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from liehom.base.errors import InputError, ShapeError, checked_integer
from liehom.base.typing import Real
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.door import RankDecision, Scalar
from liehom.flow.series.arrays import as_values, is_exact, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.series.node import Node
from liehom.flow.steps.corrected import generator_norm, round_off
from liehom.flow.steps.expansion import Clock, Flow, flow_series, leading_order
from liehom.flow.steps.range_solver import RangeSolver
from liehom.flow.steps.step import (
    ExponentialLike,
    Generator,
    Step,
    moved_by_isotropy,
    read_point,
    step_variable,
    with_correction,
)
from liehom.flow.steps.symbolic_problem import solve_exactly

SOLVED_RTOL = 1e-8
ISOTROPY_RTOL = 1e-9


@final
@dataclass(frozen=True, slots=True)
class OrderCondition:
    """Whether a step that agrees with the flow to order n - 1 can be made to agree to order n at a point.

    Attributes
    ----------
    order : int
        n.
    leading : int
        l, the order of the first non-zero coefficient of the flow; 0 at an equilibrium.
    chi : array of shape (N,)
        chi^(n)(0), the n-th derivative of step - flow.
    solvable : bool
        Whether (5.5) holds for this step.
    zeta : array of shape (dim g,)
        The coefficient of t^(n-l) that satisfies (5.5), or the least-squares solution if (5.5) fails.
    c : number
        The coefficient of t^(n-l+1) in tau.
    residual : array of shape (N,)
        The remaining [t^n] (F_tau - step), 0 if (5.5) holds.
    range_holds : bool
        Whether the range condition (6.1) holds at m; (5.5) then holds for every step.
    rank, dimension : int
        Rank of [rho(g_m) w_l, w_l], and dimension of the orbit; (6.1) holds if they are equal.
    singular_value : float or None
        In floats, the smallest singular value that decides (6.1).
    numerical : RankDecision or None
        In floats, the singular values that decided the rank; None for an exact answer.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), ["m0", "2*m1", "3*m2"])
    >>> print(order_condition(field, lh.Euler(), [0.6, 0.48, 0.64], 2))
    order 2 at m (l = 1): (5.5) holds for this step; the range condition (6.2) holds for every step (rank 2 of 2)
    """

    order: int
    leading: int
    chi: npt.NDArray[Any]
    solvable: bool
    zeta: npt.NDArray[Any]
    c: Scalar
    residual: npt.NDArray[Any]
    range_holds: bool
    rank: int
    dimension: int
    singular_value: float | None = None
    numerical: RankDecision | None = None

    def __bool__(self) -> bool:
        return self.solvable

    def __str__(self) -> str:
        if self.leading == 0:
            state = "and so is it of the step" if self.solvable else "but the step moves it"
            return f"order {self.order} at m: an equilibrium of the flow, {state}"
        head = f"order {self.order} at m (l = {self.leading}): (5.5) {'holds' if self.solvable else 'fails'}"
        own = "for this step"
        if not self.solvable:
            size = float(np.linalg.norm(np.asarray([float(x) for x in self.residual])))
            own += f" (a residual of size {size:.3g} is left)"
        name = "(6.2)" if self.leading == 1 else "(6.1)"
        every = "holds for every step" if self.range_holds else "does not hold for every step"
        return f"{head} {own}; the range condition {name} {every} (rank {self.rank} of {self.dimension})"


def chi(
    field: GeneratorField,
    step: Step,
    m: ArrayLike,
    n: int,
    zeta: ArrayLike | None = None,
    *,
    t: Real = 0,
    exponential: ExponentialLike = "exp",
) -> npt.NDArray[Any]:
    """The value chi_m^(n)(zeta) of (5.4), shape (..., N): the n-th derivative of step - flow, zeta added to the step.

    Parameters
    ----------
    field : GeneratorField
    step : Step
    m : array_like of shape (..., N)
        Floats, or exact numbers of the representation's field in an array of objects.
    n : int
        At least 1.
    zeta : array_like of shape (k, ..., dim g), optional
        zeta_1, ..., zeta_k in g_m, the (plain Taylor) coefficients of a polynomial without constant term.
    t : number or array of shape (...,)
    exponential : str, Exponential or callable

    Returns
    -------
    array of shape (..., N)

    Raises
    ------
    FieldError
        If an exact coordinate is not in the representation's field.

    Notes
    -----
    Computed by definition, from the expansions. If all z_j = w_j for j < n and zeta begins with t^(n-l), it is
    n! (rho(zeta_(n-l)) w_l / 2 + z_n - w_n), affine in zeta, with w and z the Taylor coefficients of flow and step;
    for a step with several exponentials without the 1/2. For a step with a clock the flow is F_tau.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> m = np.array([lh.QQ.convert("3/5"), lh.QQ.convert("4/5")])
    >>> chi(field, lh.Euler(), m, 1).tolist(), chi(field, lh.Euler(), m, 2).tolist()
    ([0, 0], [-48/125, 36/125])
    """
    return -factorial(n) * _Expansion(field, step, m, n, zeta, t, exponential).difference(n)


def order_condition(
    field: GeneratorField, step: Step, m: ArrayLike, n: int, *, t: Real = 0, exponential: ExponentialLike = "exp"
) -> OrderCondition:
    """`OrderCondition`: whether Theorem 5 gives order n at a point, for this step (5.5) and for all steps (6.1).

    Parameters
    ----------
    field : GeneratorField
    step : Step
        It must agree with the flow (along its own clock, if it has one) through order n - 1 at m.
    m : array_like of shape (N,)
        Floats, or exact numbers of the representation's field in an array of objects.
    n : int
    t : number
    exponential : str, Exponential or callable

    Raises
    ------
    FieldError
        If an exact coordinate is not in the representation's field.

    Notes
    -----
    The system (1/2) rho(zeta) w_l - l c w_l = w_n - z_n in Taylor coefficients, with zeta in g_m. Of its solutions
    the one with the smallest |c| and, among those, the smallest |zeta| is returned. For n <= l isotropy does not enter,
    and (5.5) asks for z_n = w_n.

    Examples
    --------
    With three different eigenvalues the isotropy is trivial, and Euler's step cannot be raised:

    >>> import numpy as np
    >>> import liehom as lh
    >>> psi = ["m0 + m4", "m1*m5", "1 - m2"]
    >>> m = np.array([lh.QQ.convert(x) for x in [1, 0, 0, 2, 0, 3]])
    >>> condition = order_condition(lh.GeneratorField(lh.sym_conjugation(3), psi), lh.Euler(), m, 2)
    >>> condition.solvable, condition.rank, condition.dimension, condition.numerical
    (False, 1, 3, None)
    """
    if np.ndim(m) != 1:
        raise ShapeError(f"the order condition is decided at one point, got an array of shape {np.shape(m)}")
    expansion = _Expansion(field, step, m, n, None, t, exponential)
    expansion.require_agreement(n)
    leading = int(np.asarray(leading_order(expansion.flow, n)))
    right = expansion.difference(n)
    derivative = -factorial(n) * right
    if leading == 0:
        zeta, c = zeros(expansion.point, (expansion.action.dimension,)), zeros(expansion.point, (1,))[0]
        solvable, dimension = expansion.vanishes(right, n), int(expansion.orbit_dimension)
        return OrderCondition(n, 0, derivative, solvable, zeta, c, right, False, 0, dimension)
    return (_exactly if expansion.exact else _numerically)(expansion, leading, n, right, derivative)


class _Expansion:
    """Flow, step and clock at a point, expanded to order n."""

    def __init__(
        self,
        field: GeneratorField,
        step: Step,
        m: ArrayLike,
        n: int,
        zeta: ArrayLike | None,
        t: Real,
        exponential: ExponentialLike,
    ) -> None:
        checked_integer(n, "the order")
        self.representation = field.representation
        self.point, self.orbit_dimension = read_point(field.representation, m)
        self.exact, self.one_exponential = is_exact(self.point), step.one_exponential
        self.action = Action(field.representation, exponential)
        self.flow: Flow = flow_series(field, self.point, n, t)
        local = step.at(self.action, Generator(field, self.orbit_dimension), self.point, np.asarray(t)[..., None])
        h = step_variable(n, self.point)
        correction = self._polynomial(zeta, n)
        self.factors = (
            with_correction(local.factors(h), correction, step.one_exponential) if local.has_factors else None
        )
        self.step: Any = moved_by_isotropy(local, h, correction, step.one_exponential)
        self.clock = Clock(self.flow, n, tuple(self.point.shape[:-1]))
        tau: Any = local.time(h[..., 0])
        for k in range(2, n + 1):
            if tau.node.coefficient(k) is not None:
                self.clock.set(k, tau.coefficient(k))

    def _polynomial(self, zeta: ArrayLike | None, n: int) -> Jet | None:
        if zeta is None:
            return None
        values = as_values(zeta)
        if values.ndim < 2 or values.shape[-1] != self.action.dimension:
            expected = f"(k, ..., {self.action.dimension})"
            raise ShapeError(f"zeta has shape {values.shape}, expected coefficients of shape {expected}")
        for k, x in enumerate(values):
            self._require_isotropy(x, k + 1)
        known = [None, *values[:n], *[None] * (n - len(values))]
        return Jet.from_node(Node(n, zeros(values, values.shape[1:]), known))

    def _require_isotropy(self, x: npt.NDArray[Any], k: int) -> None:
        moved: Any = self.action.infinitesimal(x, self.point)
        if self.exact:
            wrong = any(value != 0 for value in moved.flat)
        else:
            size = np.max(generator_norm(self.action, x)) * np.max(np.linalg.norm(self.point, axis=-1))
            wrong = bool(np.abs(moved).max(initial=0.0) > ISOTROPY_RTOL * size)
        if wrong:
            raise InputError(f"zeta_{k} = {x} is not in the isotropy subalgebra: rho(zeta_{k}) m = {moved}")

    def difference(self, n: int) -> npt.NDArray[Any]:
        """Coefficient [t^n] (F_tau - step), shape (..., N)."""
        point: Any = self.clock.point(n)
        return point - self.step.coefficient(n)

    def require_agreement(self, n: int) -> None:
        for k in range(1, n):
            if not self.vanishes(self.difference(k), k):
                raise InputError(
                    f"the step agrees with the flow at m to order {k - 1} only, not to {n - 1}: ask for order {k}"
                )

    def vanishes(self, difference: npt.NDArray[Any], k: int) -> bool:
        if self.exact:
            return all(x == 0 for x in difference.flat)
        return bool(np.linalg.norm(difference) <= round_off(self.action, self.point, self.flow, self.factors, k))


def _exactly(
    expansion: _Expansion, leading: int, n: int, right: npt.NDArray[Any], derivative: npt.NDArray[Any]
) -> OrderCondition:
    field = expansion.representation.field
    factor = field.one / 2 if expansion.one_exponential else field.one
    velocity: Any = expansion.flow.point(leading)
    system = right if n > leading else 0 * right
    solution = solve_exactly(expansion.representation, expansion.point, velocity, system, leading, factor)
    solvable, residual = solution.solvable, solution.residual
    if n <= leading:
        solvable, residual = expansion.vanishes(right, n), right
    holds = solution.rank == solution.dimension
    return OrderCondition(
        n, leading, derivative, solvable, solution.zeta, solution.c, residual, holds, solution.rank, solution.dimension
    )


def _numerically(
    expansion: _Expansion, leading: int, n: int, right: npt.NDArray[Any], derivative: npt.NDArray[Any]
) -> OrderCondition:
    frame = expansion.action.isotropy_frame(expansion.point, expansion.orbit_dimension)
    factor = 0.5 if expansion.one_exponential else 1.0
    solver = RangeSolver(expansion.action, frame, expansion.flow.point(leading), leading, factor)
    solution: Any = solver.solve(right if n > leading else 0 * right)
    zeta, c, residual = solution if n > leading else (*solution[:2], right)
    small = np.linalg.norm(residual) <= SOLVED_RTOL * np.linalg.norm(right) and n > leading
    rank, dimension = int(solver.rank), int(expansion.orbit_dimension)
    values = np.linalg.svd(np.asarray(solver.matrix, dtype=float), compute_uv=False)
    relative = np.concatenate([values / values[0], [0.0]])
    return OrderCondition(
        n,
        leading,
        derivative,
        bool(small) or expansion.vanishes(residual, n),
        zeta,
        c,
        residual,
        rank == dimension,
        rank,
        dimension,
        float(np.asarray(solver.singular_value)),
        RankDecision(rank, float(relative[rank - 1]), float(relative[rank])),
    )
