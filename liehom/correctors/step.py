"""Step: one step m -> Exp(xi(m, t, h)) m of a Lie group method, written once for arrays and for Jets.

On arrays a step integrates; with the Jet h = 0 + 1 t it is expanded in the step size.  A step is one exponential
(`OneExponential`) or a product of several.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from importlib import import_module
from typing import Any, final

import numpy as np

from liehom.errors import ConvergenceError
from liehom.homogeneous import Action, GeneratorField
from liehom.series.arrays import is_jax, zeros
from liehom.series.jet import Jet
from liehom.series.node import Node
from liehom.tracing import Traced, while_loop

MAX_ITERATIONS = 200
JAX_ITERATIONS = 60


@final
class Generator:
    """psi as steps call it: (m, t) -> (..., dim g) with t of shape (..., 1); and what is known of the run.

    Parameters
    ----------
    field : GeneratorField
    orbit_dimension : int or array of shape (...,)
        Of the orbits of the trajectories; constant along each.
    start : array of shape (..., N), optional
        Where the run began.

    Attributes
    ----------
    prepared : dict
        What steps have derived from field and start, computed once: by the step, nothing else.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> psi = Generator(lh.GeneratorField(lh.defining(lh.so(2)), ["t"]), 1)
    >>> psi(np.zeros((3, 2)), np.array([[1.0], [2.0], [3.0]])).tolist()
    [[1.0], [2.0], [3.0]]
    """

    __slots__ = ("field", "orbit_dimension", "prepared", "start")

    def __init__(self, field: GeneratorField, orbit_dimension: Any, start: Any = None) -> None:
        self.field = field
        self.orbit_dimension = orbit_dimension
        self.start = start
        self.prepared: dict[Any, Any] = {}

    def __call__(self, m: Any, t: Any) -> Any:
        return self.field.psi(m, t[..., 0] if np.ndim(t) else t)


class Step(ABC):
    """A one-step method on homogeneous spaces.

    A new method needs `order` and `factors(action, psi, m, t, h)`, with

    * `action`, the `Action`: ``action.act(x, m)`` is Exp(x) m;
    * `psi`, the generator as a function (m, t) -> (..., dim g);
    * `m`, the point, of shape (..., N);
    * `t` and `h`, time and step size, with a last axis of length 1 so that ``h * psi(m, t)`` broadcasts; to be
      expanded, `h` is a `Jet` without constant term.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.Euler().order, lh.Euler().one_exponential
    (1, True)
    """

    @property
    @abstractmethod
    def order(self) -> int:
        """The order as a method for trajectories."""

    @property
    def one_exponential(self) -> bool:
        """Whether `factors` is always a single generator."""
        return False

    @abstractmethod
    def factors(self, action: Action, psi: Generator, m: Any, t: Any, h: Any) -> tuple[Any, ...]:
        """Generators x_1, ..., x_s; the step is m -> Exp(x_s) ... Exp(x_1) m."""

    def at(self, action: Action, psi: Generator, m: Any, t: Any, *, error_terms: int = 0) -> LocalStep:
        """The step at (m, t) as a function of h alone; methods that prepare something there override this.

        `error_terms` asks for `LocalStep.defects` of so many orders beyond `order`.
        """
        return LocalStep(lambda h: self.factors(action, psi, m, t, h))

    def __repr__(self) -> str:
        # no address: reports and the fingerprints of checkpoints contain it
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
        """True."""
        return True

    @abstractmethod
    def generator(self, action: Action, psi: Generator, m: Any, t: Any, h: Any) -> Any:
        """xi(m, t, h), array or Jet of shape (..., dim g)."""

    def factors(self, action: Action, psi: Generator, m: Any, t: Any, h: Any) -> tuple[Any, ...]:
        return (self.generator(action, psi, m, t, h),)


class LocalStep:
    """A step at one point and time, as a function of h.

    Parameters
    ----------
    factors : callable
        h -> tuple of generators.

    Attributes
    ----------
    defects : tuple of (int, array), or None
        (k, |[t^k] (flow - step)|) where it has been computed.

    Examples
    --------
    >>> import numpy as np
    >>> local = LocalStep(lambda h: (h * np.array([1.0, 0.0]),))
    >>> local.factors(0.5)[0].tolist(), local.time(0.5)
    ([0.5, 0.0], 0.5)
    """

    defects: tuple[tuple[int, Any], ...] | None = None

    def __init__(self, factors: Callable[[Any], tuple[Any, ...]]) -> None:
        self._factors = factors

    def factors(self, h: Any) -> tuple[Any, ...]:
        """The generators of the step of size h (..., 1)."""
        return self._factors(h)

    def time(self, h: Any) -> Any:
        """The time that passes in the step, h (...,) unless the step has a clock of its own."""
        return h


def apply_factors(action: Action, factors: tuple[Any, ...], m: Any) -> Any:
    """Exp(x_s) ... Exp(x_1) m.

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


def step_variable(order: int, like: Any) -> Jet:
    """The Jet h = 0 + 1 t with values of shape (1,), of the kind of `like`.

    Examples
    --------
    >>> import numpy as np
    >>> step_variable(2, np.zeros(3)).coefficients.ravel().tolist()
    [0.0, 1.0, 0.0]
    """
    zero = zeros(like, (1,))
    return Jet.from_node(Node(order, zero, [None, zero + 1, *[None] * (order - 1)][: order + 1]))


def solve_implicitly(function: Callable[[Any], Any], start: Any, h: Any, *, stacked: bool = False) -> Any:
    """The solution x of x = function(x), where function has a factor h.

    On Jets coefficient by coefficient; on arrays by iteration from `start` until x no longer changes, for every
    trajectory apart, so that none depends on what it is solved with. `stacked`: the first axis is none of the ensemble.

    Raises
    ------
    ConvergenceError
        If the iteration does not converge: the step size is too large.

    Examples
    --------
    >>> import numpy as np
    >>> float(solve_implicitly(lambda x: 0.5 * np.cos(x), np.array(0.0), 0.5).round(6))
    0.450184
    """
    if isinstance(h, Jet):
        x = Jet.growing(zeros(start, np.shape(start)), h.order, zero=True)
        made = function(x)
        x.node.depends((made.node, 0), rule=lambda k: made.node.known[k])
        return x
    if isinstance(start, Traced) or isinstance(h, Traced):
        return _solved_on_tape(function, start, h.tape if isinstance(h, Traced) else start.tape)
    if is_jax(start):
        # a loop, not sixty copies of the function, which would take minutes to compile
        return import_module("jax.lax").fori_loop(0, JAX_ITERATIONS, lambda _, x: function(x), start)
    eps = np.finfo(np.result_type(start, float)).eps
    axes = (0, -1) if stacked else (-1,) if np.ndim(start) else ()
    before: Any = np.inf
    change: Any = np.zeros(())
    settled: Any = np.zeros((), dtype=bool)
    for _ in range(MAX_ITERATIONS):
        with np.errstate(over="ignore", invalid="ignore"):  # an iteration that diverges says so below
            x = function(start)
            change = np.where(settled, 0.0, np.abs(x - start).max(axis=axes, keepdims=True, initial=0.0))
        size = np.abs(x).max(axis=axes, keepdims=True, initial=0.0)
        start = np.where(settled, start, x) if settled.any() else x
        settled = settled | (change <= 2 * eps * size) | ((change <= 1e4 * eps * size) & (change >= before))
        if settled.all():
            return start
        if not np.isfinite(change).all():
            break
        before = change
    raise ConvergenceError(
        f"an implicit step did not converge in {MAX_ITERATIONS} iterations (last change {np.max(change):.2g}): "
        "take a smaller step size"
    )


def _solved_on_tape(function: Callable[[Any], Any], start: Any, tape: Any) -> Any:
    """The same iteration for one trajectory in compiled code; a step whose iteration fails is not made there."""
    eps = float(np.finfo(np.float64).eps)

    def iteration(x: Any, before: Any, settled: Any) -> Any:
        made = function(x)
        change = np.where(settled, 0.0, np.abs(made - x).max())
        size = np.abs(made).max()
        kept = np.where(settled, x, made)
        settled = settled | (change <= 2 * eps * size) | ((change <= 1e4 * eps * size) & (change >= before))
        return [kept, change, settled], ~settled & np.isfinite(change)

    solved, _, settled = while_loop(iteration, [start, np.inf, tape.false], tape, MAX_ITERATIONS)
    tape.required.append(settled.entries[()])
    return solved
