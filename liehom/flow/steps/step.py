"""Step: one step of a Lie group method, written once for arrays and for Jets."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeAlias, TypeVar, cast, final

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.objects import provider
from liehom.base.typing import Array, BooleanArray, IntegerArray, Lanes, Values
from liehom.flow.action.exponential import Exponential
from liehom.flow.action.field import GeneratorField, check_point
from liehom.flow.action.space import Action
from liehom.flow.door import Representation
from liehom.flow.series.arrays import as_values, is_exact, is_jax, namespace, norm, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.series.node import Node

if TYPE_CHECKING:
    from typing import Self

# Step sizes from the Taylor coefficients of the error of a step. For a step with defects d_k = |[t^k](F - step)|, F the
# flow, the step size is the largest h with d_k h^k within the tolerance and below a fraction of |X| h, the length of
# the step; the second bound keeps h where the series converges, also next to equilibria. The rules run on arrays, and
# on the tracers of compiled steps (`Values`); results are of the same kind.

SAFETY = 0.9  # fraction of the step size at which the estimated error equals the tolerance
SERIES_FRACTION = 0.1  # the largest length of a term of the error, in units of the length |X| h of the step
MAX_SUM, LEAST_SHARE = 5.0, 1 / 32
"""A term of order k of the error is at most the tolerance times `MAX_SUM` r^(1/(k-1)), where r is the tolerance in
units of |m|, between `LEAST_SHARE` and 1. A run makes about r^(-1/(k-1)) such steps for each |m| of its way, so their
errors add up to the same multiple of the tolerance, whatever it is. With low orders they add up to more."""

Defects: TypeAlias = tuple[tuple[int, Values], ...]
"""(k, |[t^k] (flow - step)|) for the orders k above the order of a step; arrays of shape (...,)."""


class StepLimits(NamedTuple):
    """Bounds of a step size, the argument of `LocalStep.size`; arrays of shape (...,)."""

    allowed: Values  # the error allowed in the step, a 2-norm
    speed: Values  # |X|, or 0 to disregard the length of the step
    largest: Values
    axes: int = 0  # the last axes that are the sites of a lattice, which has one size
    relative: Values | None = None  # the allowed error in units of |m|; None to allow it in each step


def size_from_defects(
    defects: Defects, allowed: Values, speed: Values, largest: Values, axes: int = 0, relative: Values | None = None
) -> Array:
    """The largest step size (...,) within the tolerance, by its Taylor coefficients and the entries of `StepLimits`."""
    xp = namespace(largest, speed)
    h: Array = floats(largest)
    way: Any = speed
    for k, defect in defects:
        size: Any = over_sites(floats(defect), axes)
        some = size > 0
        safe = xp.where(some, size, 1.0)
        share: Any = 1.0 if relative is None else xp.clip(MAX_SUM * relative ** (1 / (k - 1)), LEAST_SHARE, 1.0)
        allows: Any = (share * allowed / safe) ** (1 / k)
        if k > 2:  # not for k = 2: next to a time at which X vanishes steps would shrink with X
            series = (SERIES_FRACTION * way / safe) ** (1 / (k - 1))
            allows = xp.where(way > 0, xp.minimum(allows, series), allows)
        h = xp.minimum(h, xp.where(some, SAFETY * allows, xp.where(xp.isnan(size), np.nan, np.inf)))
    return h


def length(x: Values) -> Array:
    """2-norm over the last axis, in float64."""
    return norm(floats(x))  # type: ignore[return-value]


def squared_length(x: Values, axes: int = 0) -> Array:
    """Sum of squares over the last axis, in float64, and over the `axes` before it, the sites of a lattice."""
    values = floats(x)
    square: Array = (values * values).sum(axis=-1)
    if not axes:
        return square
    xp = namespace(square)
    return xp.broadcast_to(xp.sum(square, axis=tuple(range(-axes, 0)), keepdims=True), square.shape)


def over_sites(x: Values, axes: int) -> Array:
    """Root of the sum of squares over the last axes, the sites of a lattice, repeated for each site."""
    if not axes:
        return x  # type: ignore[return-value]
    xp = namespace(x)
    root: Array = xp.sqrt(xp.sum(x * x, axis=tuple(range(-axes, 0)), keepdims=True))
    return xp.broadcast_to(root, x.shape)


def floats(x: Values) -> Array:
    """x in float64; tracers and JAX arrays as they are."""
    values: Any = x
    if is_jax(x):
        return values
    return values.astype(np.float64, copy=False) if hasattr(x, "astype") else np.asarray(x, dtype=np.float64)


# LocalStep: a step at one point and time as a function of its size, which is all that a run knows of a method. It gives
# the point after the step, the time that passes, a step size or an estimate of its error, whether the step may be
# taken, and numbers for the report.

Diagnostics: TypeAlias = dict[str, tuple[Values, str]]
"""Numbers of a step by name, each of shape (...,), with what a run records of them: "max", "min" or "sum"."""

Factors: TypeAlias = tuple[Values, ...]
"""Generators x_1, ..., x_s of shape (..., dim g); their step is m -> Exp(x_s) ... Exp(x_1) m."""

Term: TypeAlias = Any  # a number, array, Jet or tracer, or None for 0


class LocalStep:
    """A step at one point and time, as a function of its size h.

    A product of exponentials gives `factors`; any other step (a projection, a symplectic map) gives `point`. Both are
    written for arrays, and also for Jets if the step is to be expanded: to correct it, or to adapt its size without
    an estimate of its error. A class derived from this one overrides the methods of these names.

    Parameters
    ----------
    action : Action
    m : array of shape (..., N)
        The point before the step.
    factors : callable, optional
        h (..., 1) -> tuple of generators x_1, ..., x_s; the step is Exp(x_s) ... Exp(x_1) m.
    point : callable, optional
        h (..., 1) -> point after the step, shape (..., N).
    clock : tuple of (int, array of shape (...,))
        (k, c_k) for k > 1: the time tau(h) = h + c_2 h^2 + c_3 h^3 + ... passes in a step of size h. Empty: the
        time h. Whether it is empty does not depend on m, t.

    Attributes
    ----------
    defects : tuple of (int, array), or None
        (k, |[t^k] (flow - step)|), for the k for which it has been computed.
    trajectory : sequence of arrays of shape (..., N)
        The Taylor coefficients m_1, m_2, ... of the trajectory, as many as have been computed.
    velocity : sequence of arrays of shape (..., dim g)
        The Taylor coefficients psi_0, psi_1, ... of the generator along it, if `quick`.
    quick : bool
        Whether `point` needs neither equations nor values of psi, so that points within the step are quickly computed.
    looks_ahead : bool
        Whether the point of `look` is `point` itself, which is then computed once.
    estimate_order : int or None
        k if `estimate` is O(h^k); None if there is no estimate.
    widest_gap : float
        The longest time between two calls of psi, in units of the step, for a step with an estimate.
    collocates : bool
        Whether the step has an estimate by psi at any time within it, `estimate_within`.
    allowed : array of shape (...,)
        The error that is allowed in the step, which a run sets: equations need not be solved better.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> action, m = lh.Action(lh.defining(lh.so(2))), np.array([1.0, 0.0])
    >>> local = LocalStep(action, m, lambda h: (h * np.array([2.0]),), clock=((2, -0.5),))
    >>> local.point(np.array([np.pi / 4])).round(12).tolist(), local.time(0.5)
    ([0.0, 1.0], 0.375)

    A rotation that is not written as an exponential:

    >>> rotated = LocalStep(action, m, point=lambda h: np.concatenate([np.cos(2 * h), np.sin(2 * h)], axis=-1))
    >>> rotated.point(np.array([np.pi / 4])).round(12).tolist(), rotated.has_factors
    ([0.0, 1.0], False)
    """

    defects: Defects | None = None
    trajectory: Sequence[Values] = ()
    velocity: Sequence[Values] = ()
    quick: bool = False
    looks_ahead: bool = False
    estimate_order: int | None = None
    widest_gap: float = 1.0
    collocates: bool = False
    allowed: Lanes = 0.0
    clock: tuple[tuple[int, Values], ...] = ()

    def __init__(
        self,
        action: Action,
        m: Values,
        factors: Callable[[Any], Factors] | None = None,
        *,
        point: Callable[[Any], Values] | None = None,
        clock: tuple[tuple[int, Values], ...] = (),
    ) -> None:
        self.action, self.m, self.clock = action, m, clock
        self._factors, self._point = factors, point

    @property
    def has_factors(self) -> bool:
        """Whether the step is a product of exponentials, so that `factors` is defined."""
        return self._factors is not None or type(self).factors is not LocalStep.factors

    def factors(self, h: Values) -> Factors:
        """Tuple of the generators of the step of size h (..., 1)."""
        if self._factors is None:
            raise InputError("the step is not a product of exponentials: it has a `point`, and no `factors`")
        return self._factors(h)

    def point(self, h: Values) -> Values:
        """Point after the step of size h (..., 1), shape (..., N)."""
        if self._point is not None:
            return self._point(h)
        return apply_factors(self.action, self.factors(h), self.m)

    def time(self, h: Values) -> Values:
        """Time tau(h) that passes in the step of size h (...,); h without a clock."""
        if not self.clock:
            return h
        known = dict(self.clock)
        return polynomial([None, 1, *(known.get(k) for k in range(2, max(known) + 1))], h)

    def look(self, h: Values, time: Values) -> tuple[Values, Values]:
        """A point within the step, at the size h (..., 1) and the time that passes, and its velocity by the series."""
        if self.velocity:
            point = self.point(h)
            return point, self.action.infinitesimal(polynomial(self.velocity, time), point)
        return series_with_slope(self.m, self.trajectory, time)

    def size(self, limits: StepLimits) -> Values | None:
        """Step size (...,) that is known before the step is made, at most `limits.largest`; None if it is not known.

        By default it follows from `defects`. If it is None and there is no `estimate`, a run expands the step to find
        its defects.
        """
        return None if self.defects is None else size_from_defects(self.defects, *limits)

    def estimate(self, h: Values) -> Values:
        """Estimate (..., N) of the error of the step of size h (..., 1), if `estimate_order` is not None."""
        raise InputError("the step has no estimate of its error: its `estimate_order` is None")

    def departure(self, h: Values) -> Values | None:
        """Distance (...,) of the point after a step of size h (..., 1) from the series of the trajectory, by which a
        step of adaptive size is judged after it is made; None (default) for a step that is not.
        """
        return None

    def estimate_within(self, h: Values, part: Values) -> Values:
        """Estimate (..., N) of the error by psi at the time part h, part (..., 1), if `collocates`."""
        raise InputError("the step has no estimate within it: it is not a collocation method")

    def valid(self, h: Values) -> Values | bool:
        """Whether the step of size h (..., 1) may be taken, bool (...,): its equations are solved, a rank is reached.

        A step that is not valid is repeated with a smaller size if sizes are adaptive; otherwise it ends its
        trajectory. The clock is judged by the run.
        """
        return True

    def diagnostics(self, h: Values) -> Diagnostics:
        """Numbers of the step of size h (..., 1) for the report: name -> (array, "max", "min" or "sum").

        The arrays have shape (...,). "lost", if there is one, says whether the step misses its order. A step that
        contains another one adds its numbers to those of the other.
        """
        return {}

    def detail(self, name: str, index: tuple[int, ...]) -> Array | None:
        """Details of a summed diagnostic at the first trajectory for which it is not 0, stored with time and point."""
        return None

    def is_near_cone(self, h: Values) -> BooleanArray:
        """Whether the points at which the equations of the step fail are within two steps of size h (...,)."""
        return np.zeros(np.shape(h), dtype=bool)


Result = TypeVar("Result")


@final
class LastSize(Generic[Result]):
    """A function of the step size that keeps its last result."""

    def __init__(self, compute: Callable[[Values], Result]) -> None:
        self._compute = compute
        self._h: Any = None
        self._last: list[Result] = []

    def __call__(self, h: Values) -> Result:
        """The result for the size h; arrays are compared by value, because their owner may have changed them."""
        arrays = isinstance(h, np.ndarray) and isinstance(self._h, np.ndarray)
        same = h is self._h if not arrays else h.dtype == self._h.dtype and np.array_equal(h, self._h)
        if not (same and self._last):
            self._last = [self._compute(h)]
            self._h = h.copy() if isinstance(h, np.ndarray) else h
        return self._last[0]


def polynomial(coefficients: Sequence[Term], h: Values) -> Term:
    """Value at h of a polynomial, by Horner's rule."""
    total = None
    for x in reversed(coefficients):
        if total is not None:
            total = total * h
        if x is not None:
            total = x if total is None else total + x
    return total


def series_at(m: Values, coefficients: Sequence[Values], s: Values) -> Values:
    """m + c_1 s + c_2 s^2 + ... for s of shape (..., 1), in pairs, so that few operations wait for each other."""
    level: list[Any] = list(coefficients)
    power: Any = s
    while len(level) > 1:
        pairs = [a + b * power for a, b in zip(level[::2], level[1::2], strict=False)]
        level = pairs + level[len(level) // 2 * 2 :]
        power = power * power
    return m + level[0] * s


def series_with_slope(m: Values, coefficients: Sequence[Values], s: Values) -> tuple[Values, Values]:
    """The same and its derivative c_1 + 2 c_2 s + ..."""
    slope: Any = len(coefficients) * coefficients[-1]
    for k, c in reversed(list(enumerate(coefficients[:-1], 1))):
        slope = k * c + slope * s
    return series_at(m, coefficients, s), slope


def apply_factors(action: Action, factors: Factors, m: Values) -> Values:
    """The point Exp(x_s) ... Exp(x_1) m, shape (..., N).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> action = lh.Action(lh.defining(lh.so(2)))
    >>> np.round(apply_factors(action, (np.array([0.5]), np.array([-0.5])), np.array([1.0, 0.0])), 12).tolist()
    [1.0, 0.0]
    """
    for x in factors:
        m = action.act(x, m)
    return m


def with_correction(factors: Factors, zeta: Values | None, one_exponential: bool) -> Factors:
    """Factors of a corrected step: zeta is added to the single generator, or is an additional, outermost factor."""
    if zeta is None:
        return factors
    return (factors[0] + zeta,) if one_exponential else (*factors, zeta)


def moved_by_isotropy(local: LocalStep, h: Values, zeta: Values | None, one_exponential: bool) -> Values:
    """Point after a step with the isotropy zeta added as by `with_correction`, or Exp(zeta) of the point after it."""
    if zeta is None:
        return local.point(h)
    if not local.has_factors:
        return local.action.act(zeta, local.point(h))
    return apply_factors(local.action, with_correction(local.factors(h), zeta, one_exponential), local.m)


# Step: one step m -> Exp(xi(m, t, h)) m of a Lie group method, written once for arrays and for Jets. On arrays a step
# integrates. With the Jet h = 0 + 1 t it is expanded in the step size. A step is one exponential (`OneExponential`) or
# a product of several.

ExponentialLike: TypeAlias = str | Exponential | Callable[..., Any]
"""A name such as "exp" or "cayley", an `Exponential`, or a function that `Action` takes as one."""


@final
class Generator:
    """The generator as steps call it, (m, t) -> (..., dim g) with t of shape (..., 1).

    Parameters
    ----------
    field : GeneratorField
    orbit_dimension : int or array of shape (...,)
        Dimension of the orbit of each trajectory, which is constant along it.
    start : array of shape (..., N), optional
        Initial points of the run.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> psi = Generator(lh.GeneratorField(lh.defining(lh.so(2)), ["t"]), 1)
    >>> psi(np.zeros((3, 2)), np.array([[1.0], [2.0], [3.0]])).tolist()
    [[1.0], [2.0], [3.0]]
    """

    __slots__ = ("field", "orbit_dimension", "start")

    def __init__(self, field: GeneratorField, orbit_dimension: int | IntegerArray, start: Values | None = None) -> None:
        self.field, self.orbit_dimension, self.start = field, orbit_dimension, start

    def __call__(self, m: Values, t: Values) -> Values:
        return self.field.psi(m, t[..., 0] if np.ndim(t) else t)


class Step(ABC):
    """A one-step method on homogeneous spaces.

    A new method needs `order` and one of

    * `factors(action, psi, m, t, h)`, for a product of exponentials. (`OneExponential` has `generator` in its place.)
    * `at(action, psi, m, t)`, which returns a `LocalStep`, for a step that projects, is a symplectic map, has its own
      clock or an estimate of its error.

    The arguments of `factors` are

    * `action`: the `Action`, for which ``action.act(x, m)`` is Exp(x) m;
    * `psi`: the generator, a function (m, t) -> (..., dim g);
    * `m`: the point, of shape (..., N);
    * `t` and `h`: time and step size, with a last axis of length 1 so that ``h * psi(m, t)`` broadcasts.

    When the step is expanded, `h` is a `Jet` without constant term.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.Euler().order, lh.Euler().one_exponential
    (1, True)
    """

    @property
    @abstractmethod
    def order(self) -> int:
        """Order of convergence as a method for trajectories, an int."""

    @property
    def one_exponential(self) -> bool:
        """Whether `factors` is always a single generator."""
        return False

    @property
    def base_order(self) -> int:
        """Order of the step that this one raises, an int; `order` for a step that raises none."""
        return self.order

    @property
    def uses_isotropy(self) -> bool:
        """Whether the step asks for isotropy frames, so that a run prepares the action for them."""
        return False

    @property
    def prepares_by_psi(self) -> bool:
        """Whether `prepare` calls psi, so that a prepared step is for the args of one run only."""
        return False

    @property
    def trace_key(self) -> Hashable:
        """Data of the prepared step on which its trace depends, besides orbits and options, hashable."""
        return None

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> Step:
        """The step for a run from the points m (..., N) at times t (...,), with all that it derives from them.

        A run asks once for it, before its first step. By default the step itself; a step that contains another one
        prepares it too.
        """
        return self

    def with_exponential_of(self, action: Action) -> Step:
        """The step, of the order that it has with the exponential of an action, as a base that `Corrected` raises.

        By default the step itself. A step that is of lower order with some exponentials refuses these if it is not
        corrected.
        """
        return self

    def with_prepared(self, **data: object) -> Self:
        """A copy of the step with further attributes, for `prepare`; also of frozen steps."""
        step = copy(self)
        for name, value in data.items():
            object.__setattr__(step, name, value)
        return step

    def factors(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Factors:
        """Tuple of generators x_1, ..., x_s (..., dim g); the step is m -> Exp(x_s) ... Exp(x_1) m."""
        if type(self).at is Step.at:
            raise InputError(f"{type(self).__name__} defines no step: write its method `factors`, `generator` or `at`")
        return self.at(action, psi, m, t).factors(h)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        """The step at (m, t) as a function of h alone; methods that precompute something there override this.

        `error_terms` is the number of orders beyond `order` for which `LocalStep.defects` are computed.
        """
        return LocalStep(action, m, lambda h: self.factors(action, psi, m, t, h))

    def __repr__(self) -> str:
        # without the address, as reports and the fingerprints of checkpoints contain the repr
        return f"{type(self).__name__}()"


StepLike: TypeAlias = Step | str
"""A step, or its name, such as "rk45"."""


def as_step(step: StepLike) -> Step:
    """A step by its name, or the step itself."""
    if isinstance(step, Step):
        return step
    if not isinstance(step, str):
        raise InputError(
            f"step is {displayed(step)}, expected a step such as liehom.Euler() or liehom.LieTaylor(4), or its name"
        )
    return cast(Step, provider("step by name")(step))


class Derived(Step, ABC):
    """A step that changes another one, `step`, with the properties that it has from it."""

    step: Step

    @property
    def one_exponential(self) -> bool:
        return self.step.one_exponential

    @property
    def prepares_by_psi(self) -> bool:
        return self.step.prepares_by_psi

    @property
    def trace_key(self) -> Hashable:
        return self.step.trace_key


class OneExponential(Step, ABC):
    """A step with one exponential: `generator` in place of `factors`.

    Examples
    --------
    The midpoint method, as a user would write it:

    >>> import liehom as lh
    >>> class Midpoint(OneExponential):
    ...     order = 2
    ...     def generator(self, action, psi, m, t, h):
    ...         middle = action.act(h / 2 * psi(m, t), m)
    ...         return h * psi(middle, t + h / 2)
    ...
    >>> Midpoint().one_exponential
    True
    """

    one_exponential = True

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        """The generator xi(m, t, h) of the step, array or Jet of shape (..., dim g)."""
        return Step.factors(self, action, psi, m, t, h)[0]

    def factors(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Factors:
        return (self.generator(action, psi, m, t, h),)


def step_variable(order: int, like: Values) -> Jet:
    """The Jet h = 0 + 1 t with values of shape (1,) and numbers of the kind of `like`."""
    zero = zeros(like, (1,))
    return Jet.from_node(Node(order, zero, [None, zero + 1, *[None] * (order - 1)][: order + 1]))


def zero_series(zero: Values, order: int) -> Jet:
    """The Jet 0 to an order, whose coefficients are to be replaced."""
    return Jet.from_node(Node(order, zero, [None] * (order + 1)))


def read_point(representation: Representation, m: ArrayLike) -> tuple[npt.NDArray[Any], IntegerArray]:
    """(points as floats or as exact numbers of the representation's field, dimensions of their orbits)."""
    point = as_values(m)
    if not is_exact(point):
        return point, check_point(representation, point)
    if point.ndim == 0 or point.shape[-1] != representation.size:
        raise ShapeError(f"a point has {representation.size} coordinates (on its last axis), got shape {point.shape}")
    exact = np.empty(point.shape, dtype=object)
    for index, value in np.ndenumerate(point):
        exact[index] = representation.field.convert(value)
    dimensions = np.empty(point.shape[:-1], dtype=int)
    for index in np.ndindex(dimensions.shape):
        dimensions[index] = representation.orbit_dimension(exact[index])
        if dimensions[index] == 0:
            raise InputError(f"the group leaves the point {exact[index]} fixed: its orbit has dimension 0")
    return exact, dimensions
