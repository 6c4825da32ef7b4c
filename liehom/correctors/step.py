"""Step: one step m -> Exp(xi(m, t, h)) m of a Lie group method, written once for arrays and for Jets.

On arrays a step integrates.  With the Jet h = 0 + 1 t it is expanded in the step size.  A step is one exponential
(`OneExponential`) or a product of several.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable
from typing import Any, TypeAlias, final

import numpy as np

from liehom.errors import InputError
from liehom.homogeneous import Action, Exponential, GeneratorField
from liehom.series.arrays import zeros
from liehom.series.jet import Jet
from liehom.series.node import Node
from liehom.typing import IntegerArray, Values

Factors: TypeAlias = tuple[Values, ...]
"""Generators x_1, ..., x_s of shape (..., dim g); their step is m -> Exp(x_s) ... Exp(x_1) m."""

ExponentialLike: TypeAlias = str | Exponential | Callable[..., Any]
"""A name such as "exp" or "cayley", an `Exponential`, or a function that `Action` takes as one."""


@final
class Generator:
    """The generator as steps call it, (m, t) -> (..., dim g) with t of shape (..., 1).

    It also carries data of the run.

    Parameters
    ----------
    field : GeneratorField
    orbit_dimension : int or array of shape (...,)
        Dimension of the orbit of each trajectory, which is constant along it.
    start : array of shape (..., N), optional
        Initial points of the run.

    Attributes
    ----------
    prepared : dict
        Results that steps derived from field and initial points, by step; only the step itself uses its entry.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> psi = Generator(lh.GeneratorField(lh.defining(lh.so(2)), ["t"]), 1)
    >>> psi(np.zeros((3, 2)), np.array([[1.0], [2.0], [3.0]])).tolist()
    [[1.0], [2.0], [3.0]]
    """

    __slots__ = ("field", "orbit_dimension", "prepared", "start")

    def __init__(self, field: GeneratorField, orbit_dimension: int | IntegerArray, start: Values | None = None) -> None:
        self.field: GeneratorField = field
        self.orbit_dimension: int | IntegerArray = orbit_dimension
        self.start: Values | None = start
        self.prepared: dict[Hashable, Any] = {}

    def __call__(self, m: Values, t: Values) -> Values:
        found: Values = self.field.psi(m, t[..., 0] if np.ndim(t) else t)
        return found


class Step(ABC):
    """A one-step method on homogeneous spaces.

    A new method needs `order` and one of

    * `factors(action, psi, m, t, h)`, for a product of exponentials (`OneExponential`: `generator`, for one);
    * `at(action, psi, m, t)`, for a step that projects, is a symplectic map, has its own clock or an estimate of its
      error: it returns a `LocalStep`.

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

    def factors(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Factors:
        """Tuple of generators x_1, ..., x_s (..., dim g); the step is m -> Exp(x_s) ... Exp(x_1) m.

        Raises
        ------
        InputError
            If the step is not a product of exponentials.
        """
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
    >>> Midpoint().one_exponential
    True
    """

    @property
    def one_exponential(self) -> bool:
        """Whether `factors` is always a single generator: True."""
        return True

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        """The generator xi(m, t, h) of the step, array or Jet of shape (..., dim g)."""
        return Step.factors(self, action, psi, m, t, h)[0]

    def factors(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Factors:
        return (self.generator(action, psi, m, t, h),)


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

    defects: tuple[tuple[int, Values], ...] | None = None
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
        """Tuple of the generators of the step of size h (..., 1).

        Raises
        ------
        InputError
            If the step is not a product of exponentials.
        """
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
        coefficients, total = dict(self.clock), None
        for k in range(max(coefficients), 1, -1):
            total = total * h if total is not None else None
            if k in coefficients:
                total = coefficients[k] if total is None else total + coefficients[k]
        found: Values = (total * h + 1) * h
        return found


def moved_by_isotropy(local: LocalStep, h: Values, zeta: Values | None, one_exponential: bool) -> Values:
    """Point after a step of size h (..., 1) with the isotropy zeta (..., dim g), as `with_correction` adds it.

    For a step that is not a product of exponentials it is Exp(zeta) of the point after the step.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> action, m = lh.Action(lh.defining(lh.so(2))), np.array([1.0, 0.0])
    >>> local = LocalStep(action, m, point=lambda h: m)
    >>> moved_by_isotropy(local, np.array([0.1]), np.array([np.pi / 2]), False).round(12).tolist()
    [0.0, 1.0]
    """
    if zeta is None:
        return local.point(h)
    if not local.has_factors:
        return local.action.act(zeta, local.point(h))
    return apply_factors(local.action, with_correction(local.factors(h), zeta, one_exponential), local.m)


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
    """Factors of a corrected step: zeta is added to the single generator, or is an additional, outermost factor.

    Examples
    --------
    >>> import numpy as np
    >>> x, zeta = Jet([[0.0], [1.0]]), Jet([[0.0], [2.0]])
    >>> len(with_correction((x,), zeta, True)), len(with_correction((x, x), zeta, False))
    (1, 3)
    """
    if zeta is None:
        return factors
    return (factors[0] + zeta,) if one_exponential else (*factors, zeta)


def step_variable(order: int, like: Values) -> Jet:
    """The Jet h = 0 + 1 t with values of shape (1,) and numbers of the kind of `like`.

    Examples
    --------
    >>> import numpy as np
    >>> step_variable(2, np.zeros(3)).coefficients.ravel().tolist()
    [0.0, 1.0, 0.0]
    """
    zero = zeros(like, (1,))
    return Jet.from_node(Node(order, zero, [None, zero + 1, *[None] * (order - 1)][: order + 1]))
