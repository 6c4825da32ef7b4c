"""Taylor coefficients of the flow and of a step at a point, and of the reparametrized flow.

    F_t(m) = w_0 + w_1 t + ...,  (k + 1) w_(k+1) = sum_(i <= k) rho(psi_i) w_(k-i),  psi_i along the flow,
    step(t) = z_0 + z_1 t + ...

All coefficients are plain Taylor coefficients, not derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from liehom.base.errors import InputError
from liehom.base.typing import Array, Real, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.series.arrays import across_lanes, as_values, constant_like, in_lanes, is_exact, namespace, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.series.node import Node
from liehom.flow.steps.step import LocalStep, apply_factors, moved_by_isotropy, step_variable, with_correction

ROUND_OFF_UNITS = 64  # a Taylor coefficient counts as zero if it is below this many units of round-off of its terms


@final
@dataclass(frozen=True, slots=True)
class Flow:
    """Taylor expansion of the flow at a point.

    Attributes
    ----------
    points : Jet
        w(t), values of shape (..., N), order n.
    generator : Jet
        psi along the flow, values of shape (..., dim g), order n - 1 at least.
    field : GeneratorField

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> flow_series(field, np.array([1.0, 0.0]), 2).points.coefficients.tolist()
    [[1.0, 0.0], [0.0, 1.0], [-0.5, 0.0]]
    """

    points: Jet
    generator: Jet
    field: GeneratorField

    @property
    def time_dependent(self) -> bool:
        """Whether the field depends on time."""
        return self.field.time_dependent

    def point(self, k: int) -> Values:
        """Coefficient w_k of the flow, shape (..., N)."""
        return self.points.coefficient(k)

    def psi(self, k: int) -> Values:
        """Coefficient psi_k of the generator along the flow, shape (..., dim g)."""
        return self.generator.coefficient(k)

    def note(self, local: LocalStep, order: int) -> None:
        """Tell a step the coefficients up to an order, with which its points are compared with psi."""
        local.trajectory = [self.point(k) for k in range(1, order + 1)]
        if local.quick:
            local.velocity = [self.psi(k) for k in range(order)]


def flow_series(field: GeneratorField, m: ArrayLike, order: int, t: Real = 0.0) -> Flow:
    """`Flow`: the expansion of the flow of m' = rho(psi(m, t)) m from (m, t) to a given order.

    Parameters
    ----------
    field : GeneratorField
    m : array_like of shape (..., N)
        Floats, or exact scalars of the representation's field in an object array.
    order : int
        At least 1.
    t : float or array of shape (...,)
        The time at which a time-dependent field is expanded; an exact number if the point is exact.

    Raises
    ------
    SeriesError
        If psi cannot be expanded.

    Notes
    -----
    Section 5 of the paper. psi is called once, on a series whose coefficients follow from those of psi.

    Examples
    --------
    Exact coefficients at a rational point of the circle:

    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> m = np.array([lh.QQ.convert("3/5"), lh.QQ.convert("4/5")])
    >>> flow_series(field, m, 2).point(1).tolist()
    [-12/25, 9/25]
    """
    if order < 1:
        raise InputError(f"the order of an expansion is at least 1, got {order}")
    start = as_values(m)
    points = Jet.growing(start, order)
    time: Any = t
    if field.time_dependent:
        first = constant_like(start, t) + zeros(start, start.shape[:-1])
        time = Jet.from_node(Node(order, first, [first, 0 * first + 1, *[None] * (order - 1)][: order + 1]))
    generator = field.psi(points, time)
    if not isinstance(generator, Jet):  # a constant psi
        generator = Jet.constant(generator, order)
    slope = field.infinitesimal(generator, points)

    def rule(k: int) -> Values | None:
        w = slope.node.known[k - 1]
        return w if k == 1 or w is None else w / k

    points.node.depends((slope.node, 1), rule=rule)
    return Flow(points, generator, field)


def step_series(action: Action, local: LocalStep, m: Values, order: int, zeta: Jet | None = None) -> Jet:
    """Expansion of a step in h, a Jet with values (..., N).

    Parameters
    ----------
    action : Action
    local : LocalStep
        ``step.at(action, psi, m, t)``.
    m : array of shape (..., N)
    order : int
    zeta : Jet, optional
        A correction, added as `with_correction` does.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> action, m = lh.Action(field.representation), np.array([1.0, 0.0])
    >>> local = lh.Euler().at(action, lh.steps.Generator(field, 1), m, 0.0)
    >>> step_series(action, local, m, 2).coefficients.tolist()
    [[1.0, 0.0], [0.0, 1.0], [-0.5, 0.0]]
    """
    h = step_variable(order, as_values(m))
    if zeta is None or not local.has_factors:
        series = moved_by_isotropy(local, h, zeta, one_exponential=False)
    else:
        factors = local.factors(h)
        series = apply_factors(action, with_correction(factors, zeta, len(factors) == 1), m)
    return series if isinstance(series, Jet) else Jet.constant(series, order)


@final
class Clock:
    """A clock tau(t) = t + c_2 t^2 + ... for each trajectory of an ensemble, and the coefficients of F_tau(t)."""

    def __init__(self, flow: Flow, order: int, shape: tuple[int, ...]) -> None:
        self._flow = flow
        one = zeros(flow.points.value, shape) + 1
        self.coefficients: list[Values | None] = [None, one, *[None] * (order - 1)]
        self._powers: dict[tuple[int, int], Values | None] = {}

    def set(self, k: int, value: Values) -> None:
        """Set c_k for k >= 2, or add to it if it has been set."""
        old = self.coefficients[k]
        self.coefficients[k] = value if old is None else old + value
        self._powers = {key: x for key, x in self._powers.items() if key[1] - key[0] < k - 1}

    def point(self, k: int) -> Values:
        """Coefficient k of F_tau(t), shape (..., N)."""
        if k == 0:
            return self._flow.point(0)
        total = self._flow.point(k)  # tau^k = t^k + ...
        for i in range(1, k):
            power = self._power(i, k)
            if power is not None:
                # products of 0-d arrays of objects are the objects themselves
                lifted = power if hasattr(power, "ndim") else np.asarray(power, dtype=object)
                total = total + lifted[..., None] * self._flow.point(i)
        return total

    def _power(self, i: int, k: int) -> Values | None:
        """Coefficient k of tau^i, k >= i >= 1; None if it is a structural zero."""
        if i == 1 or i == k:
            return self.coefficients[1 if i == k else k]
        if (i, k) not in self._powers:
            total = None
            for j in range(1, k - i + 2):
                left, right = self.coefficients[j], self._power(i - 1, k - j)
                if left is not None and right is not None:
                    term = right if j == 1 else left if i - 1 == k - j else left * right
                    total = term if total is None else total + term
            self._powers[i, k] = total
        return self._powers[i, k]


def leading_order(flow: Flow, order: int) -> Values:
    """The smallest l with w_l not `vanishing`, shape (...,); 0 if all coefficients up to `order` vanish."""
    leading: Any = np.zeros(flow.points.shape[:-1], dtype=int)
    # if w_1 = 0 for an autonomous field, the point is an equilibrium and all w_k vanish
    for k in range(1, order + 1 if flow.time_dependent else 2):
        leading = np.where((leading == 0) & ~vanishing(flow, k), k, leading)
        if bool(np.all(leading)):
            break
    return leading


def vanishing(flow: Flow, k: int) -> Values:
    """Whether w_k, k >= 1, is zero up to round-off, shape (...,): that of its terms and, for an autonomous field, of
    psi, eps |m| times its derivative along the flow, |psi_1| / |w_1|, at least.
    """
    w = flow.point(k)
    if is_exact(w):
        return np.array([all(x == 0 for x in row) for row in w.reshape(-1, w.shape[-1])]).reshape(w.shape[:-1])
    xp = namespace(w)
    size = xp.max(xp.abs(w), axis=-1)
    if k == 1 and not flow.time_dependent and _all_move(flow, size):
        return np.zeros(size.shape, dtype=bool)
    terms: Any = 0.0
    for i in range(k):
        terms = terms + _moved(xp, flow, flow.psi(i), flow.point(k - 1 - i))
    if k == 1 and not flow.time_dependent and flow.generator.order >= 1:
        m = flow.point(0)
        floor = xp.maximum(size, np.finfo(w.dtype).tiny * (1 + xp.max(xp.abs(m), axis=-1)))
        terms = terms + _moved(xp, flow, flow.psi(1), m) * (xp.max(xp.abs(m), axis=-1) / floor)
    return size <= ROUND_OFF_UNITS * np.finfo(w.dtype).eps * terms / k


def _all_move(flow: Flow, size: Array) -> bool:
    """Whether norms prove that w_1, with largest coordinates `size`, is beyond round-off in all trajectories."""
    m = flow.point(0)
    norm = flow.field.frobenius_norms(flow.psi(0), m)
    if norm is None or not bool((size > 0).all()):
        return False
    if flow.generator.order >= 1:
        norm = norm + flow.field.frobenius_norms(in_lanes(flow.psi(1)), m) * (np.abs(m).max(axis=-1) / size)
    return bool((size > 2 * ROUND_OFF_UNITS * np.finfo(m.dtype).eps * norm * np.sqrt(_square(m))).all())


def at_rest(action: Action, flow: Flow) -> Values:
    """Whether w_1 of an autonomous field is zero up to round-off, shape (...,), by norms only; cf. `vanishing`."""
    w, m = flow.point(1), flow.point(0)
    bound = (ROUND_OFF_UNITS * float(np.finfo(w.dtype).eps) * action.max_norm) ** 2
    size = _square(m)
    rate = _square(w) / np.where(size > 0, size, 1.0)  # fourth powers of coordinates could overflow
    gram, twice = action.inner_product.matrix, flow.generator.order >= 1
    if isinstance(w, np.ndarray):  # in most calls no point is at rest, even by a larger norm
        largest = float(np.abs(gram).sum(axis=0).max()) * bound
        far = rate > largest * _square(flow.psi(0))
        if bool(far.all()) and (not twice or bool((rate * rate > largest * _square(flow.psi(1))).all())):
            return ~far
    root = np.linalg.cholesky(gram)

    still = rate <= bound * _square(across_lanes(flow.psi(0), root))
    if not twice:
        return still
    return still | (rate * rate <= bound * _square(across_lanes(flow.psi(1), root)))


def _square(x: Values) -> Values:
    return np.einsum("...i,...i->...", x, x) if isinstance(x, np.ndarray) else namespace(x).sum(x * x, axis=-1)


def _moved(xp: ModuleType, flow: Flow, x: Values, m: Values) -> Values:
    """The largest coordinate of |rho(x)| |m|, which bounds the round-off of rho(x) m in units of eps."""
    columns = flow.field.infinitesimal(x[..., None, :], xp.eye(m.shape[-1], dtype=m.dtype))
    return xp.max((xp.abs(m)[..., None, :] @ xp.abs(columns))[..., 0, :], axis=-1)
