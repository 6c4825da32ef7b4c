"""The order to which a step conserves a first integral at a point (Definition 9), by expanding F along the step.

    F(step(t)) - F(m) = E_n t^n + E_(n+1) t^(n+1) + ...,    conserved to order n - 1

At exact points the coefficients E_n are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from liehom.correctors.conserving.first_integral import FirstIntegral, IntegralSource, conditioning
from liehom.correctors.expansion import ROUND_OFF_UNITS, Flow, flow_series
from liehom.correctors.isotropy.order_by_order import round_off
from liehom.correctors.points import read_point
from liehom.correctors.step import ExponentialLike, Generator, LocalStep, Step, step_variable
from liehom.errors import InputError
from liehom.homogeneous import Action, GeneratorField
from liehom.series.arrays import is_exact
from liehom.series.jet import Jet
from liehom.typing import Array, IntegerArray, Real, Values

EXTRA_ORDERS = 4
"""Default number of coefficients beyond the order of the step that are computed."""


@final
@dataclass(frozen=True, slots=True)
class ConservedOrder:
    """Order to which a step conserves F, at one or several points.

    Attributes
    ----------
    order : int or array of shape (...,)
        The largest p, up to `bound`, with F(step(t)) - F(m) = O(t^(p+1)).
    coefficients : tuple
        E_0, ..., E_bound, the Taylor coefficients of F(step(t)) - F(m): arrays of shape (...,), or (..., k) if F is
        a list. E_n with n = order + 1 is the first that is not 0.
    bound : int
        Index of the last coefficient that was computed.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> print(conserved_order(field, lh.Euler(), [1.0, 0.0], "m0**2 + m1**2"))
    conserved to order 5 at least
    """

    order: int | IntegerArray
    coefficients: tuple[Values, ...]
    bound: int

    def __str__(self) -> str:
        order = int(np.min(self.order))
        return f"conserved to order {order}" + (" at least" if order == self.bound else "")


def conserved_order(
    field: GeneratorField,
    step: Step,
    m: ArrayLike,
    F: IntegralSource,
    *,
    up_to: int | None = None,
    t: Real = 0,
    exponential: ExponentialLike = "exp",
) -> ConservedOrder:
    """`ConservedOrder`: the order to which a step conserves a first integral, with the coefficients E_n.

    Parameters
    ----------
    field : GeneratorField
    step : Step
    m : array_like of shape (..., N)
        Floats, or exact numbers of the representation's field in an array of objects; E_n is then exact.
    F : callable, string, sympy expression or list of these
        See `FirstIntegral`.
    up_to : int, optional
        Index of the last coefficient to compute (default: the order of the step plus 4).
    t : number or array of shape (...,)
    exponential : str, Exponential or callable

    Raises
    ------
    InputError
        If F is not a first integral of the field; the message shows its derivative along the flow.
    ShapeError
        If m does not have N coordinates.

    Notes
    -----
    Definition 9 of the paper: F is conserved to order n - 1 if F(step(t)) - F(m) = O(t^n). The coefficients
    come from the expansion of the step in its size.

    Examples
    --------
    Heun's step of the free rigid body conserves the energy to order 3, its own order plus 1:

    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"])
    >>> m = np.array([lh.QQ.convert(x) for x in ["3/5", "12/25", "16/25"]])
    >>> found = conserved_order(field, lh.Heun(), m, "m0**2/2 + m1**2/4 + m2**2/8")
    >>> found.order, found.coefficients[4]
    (3, 100899/25000000)
    """
    if up_to is not None and (isinstance(up_to, bool) or not isinstance(up_to, int | np.integer) or up_to < 1):
        raise InputError(f"up_to is an integer at least 1, got {up_to!r}")
    bound = step.order + EXTRA_ORDERS if up_to is None else int(up_to)
    point, dimension = read_point(field.representation, m)
    integral = FirstIntegral(F, field.representation.size)
    action = Action(field.representation, exponential)
    flow = flow_series(field, point, bound, t)
    integral.check(flow, bound)
    local = step.at(action, Generator(field, dimension), point, np.asarray(t)[..., None])
    made = expanded(integral, local, bound)
    order = agreement(made, None if is_exact(point) else round_off_of(action, integral, flow, local, point, bound))
    return ConservedOrder(order if order.ndim else int(order), tuple(integral.squeezed(x) for x in made), bound)


def agreement(coefficients: list[Array], noise: list[Array] | None) -> IntegerArray:
    """The largest p with E_1 = ... = E_p = 0, shape (...,), exactly or up to the noise given.

    Examples
    --------
    >>> import numpy as np
    >>> int(agreement([np.zeros(1), np.full(1, 1e-18), np.ones(1)], [np.full(1, 1e-15)] * 3))
    1
    """
    bound = len(coefficients) - 1
    order = np.full(np.shape(coefficients[0])[:-1], bound)
    for k in range(bound, 0, -1):
        value = np.asarray(coefficients[k])
        if noise is None:
            some = np.array([x != 0 for x in value.flat], dtype=bool).reshape(value.shape)
        else:
            some = ~(np.abs(value) <= noise[k])
        order = np.where(some.any(axis=-1), k - 1, order)
    return order


def expanded(integral: FirstIntegral, local: LocalStep, bound: int) -> list[Array]:
    """List of E_0, ..., E_bound, arrays of shape (..., k).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> action, m = lh.Action(lh.defining(lh.so(2))), np.array([1.0, 0.0])
    >>> local = LocalStep(action, m, lambda h: (h * np.array([1.0]),))
    >>> [float(e[0]) for e in expanded(FirstIntegral("m0", 2), local, 2)]
    [0.0, 0.0, -0.5]
    """
    made: Any = integral(local.point(step_variable(bound, local.m)))
    if not isinstance(made, Jet):
        return [0 * made] * (bound + 1)
    return [0 * made.coefficient(0), *[made.coefficient(k) for k in range(1, bound + 1)]]


def round_off_of(
    action: Action, integral: FirstIntegral, flow: Flow, local: LocalStep, m: Values, bound: int
) -> list[Array]:
    """List of bounds of the round-off in E_0, ..., E_bound, arrays of shape (..., k).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field, m = lh.GeneratorField(lh.defining(lh.so(2)), [1]), np.array([1.0, 0.0])
    >>> action = lh.Action(field.representation)
    >>> local = LocalStep(action, m, lambda h: (h * np.array([1.0]),))
    >>> flow = flow_series(field, m, 2)
    >>> bool(round_off_of(action, FirstIntegral("m0", 2), flow, local, m, 2)[2] < 1e-12)
    True
    """
    eps = np.finfo(m.dtype).eps
    scale = conditioning(*integral.gradient(m), m)
    size = np.linalg.norm(np.asarray(m, dtype=float), axis=-1)
    factors: Any = local.factors(step_variable(bound, m)) if local.has_factors else None
    rate, found = 0.0 * size, [ROUND_OFF_UNITS * eps * scale]
    for k in range(1, bound + 1):
        term = round_off(action, m, flow, factors, k) / (ROUND_OFF_UNITS * eps * size)
        rate = np.maximum(rate, term ** (1 / k))
        found.append(4 * ROUND_OFF_UNITS * eps * scale * rate[..., None] ** k)
    return found
