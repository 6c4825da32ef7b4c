"""LocalStep: a step at one point and time as a function of its size, which is all that a run knows of a method.

It gives the point after the step, the time that passes, a step size or an estimate of its error, whether the step may
be taken, and numbers for the report.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from liehom.correctors.step_size import Defects, StepLimits, size_from_defects
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.typing import Array, BooleanArray, Values

Diagnostics: TypeAlias = dict[str, tuple[Values, str]]
"""Numbers of a step by name, each of shape (...,), with what a run records of them: "max", "min" or "sum"."""

Factors: TypeAlias = tuple[Values, ...]
"""Generators x_1, ..., x_s of shape (..., dim g); their step is m -> Exp(x_s) ... Exp(x_1) m."""


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
    estimate_order : int or None
        k if `estimate` is O(h^k); None if there is no estimate.

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
    estimate_order: int | None = None
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

    def size(self, limits: StepLimits) -> Values | None:
        """Step size (...,) that is known before the step is made, at most `limits.largest`; None if it is not known.

        By default it follows from `defects`. If it is None and there is no `estimate`, a run expands the step to find
        its defects.
        """
        return None if self.defects is None else size_from_defects(self.defects, *limits)

    def estimate(self, h: Values) -> Values:
        """Estimate (..., N) of the error of the step of size h (..., 1), if `estimate_order` is not None.

        Raises
        ------
        InputError
            If the step has no estimate.
        """
        raise InputError("the step has no estimate of its error: its `estimate_order` is None")

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
    >>> from liehom.series import Jet
    >>> x, zeta = Jet([[0.0], [1.0]]), Jet([[0.0], [2.0]])
    >>> len(with_correction((x,), zeta, True)), len(with_correction((x, x), zeta, False))
    (1, 3)
    """
    if zeta is None:
        return factors
    return (factors[0] + zeta,) if one_exponential else (*factors, zeta)


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
