"""Step: one step m -> Exp(xi(m, t, h)) m of a Lie group method, written once for arrays and for Jets.

On arrays a step integrates.  With the Jet h = 0 + 1 t it is expanded in the step size.  A step is one exponential
(`OneExponential`) or a product of several.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable
from copy import copy
from typing import TYPE_CHECKING, Any, TypeAlias, final

import numpy as np

from liehom.correctors.local_step import Diagnostics as Diagnostics
from liehom.correctors.local_step import Factors as Factors
from liehom.correctors.local_step import LocalStep as LocalStep
from liehom.correctors.local_step import apply_factors as apply_factors
from liehom.correctors.local_step import moved_by_isotropy as moved_by_isotropy
from liehom.correctors.local_step import with_correction as with_correction
from liehom.errors import InputError, displayed
from liehom.homogeneous import Action, Exponential, GeneratorField
from liehom.series.arrays import zeros
from liehom.series.jet import Jet
from liehom.series.node import Node
from liehom.typing import IntegerArray, Values

if TYPE_CHECKING:
    from typing import Self

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
        self.field: GeneratorField = field
        self.orbit_dimension: int | IntegerArray = orbit_dimension
        self.start: Values | None = start

    def __setstate__(self, state: tuple[object, dict[str, Any]]) -> None:
        for name in self.__slots__:  # pickles of 0.1.0 have further ones
            setattr(self, name, state[1][name])

    def __call__(self, m: Values, t: Values) -> Values:
        found: Values = self.field.psi(m, t[..., 0] if np.ndim(t) else t)
        return found


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
        """A copy of the step with further attributes, for `prepare`; also of frozen steps.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.Euler().with_prepared(table=(1, 2)).table
        (1, 2)
        """
        made = copy(self)
        for name, value in data.items():
            object.__setattr__(made, name, value)
        return made

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


StepLike: TypeAlias = Step | str
"""A step, or its name, such as "rk45"."""

_NAMED: list[Callable[[str], Step]] = []


def give_names(named: Callable[[str], Step]) -> None:
    """Let `as_step` find steps by this function; the layer of methods, which is above this one, gives its own.

    Examples
    --------
    >>> import liehom as lh
    >>> give_names(lh.integrators.step_named)
    """
    _NAMED[:] = [named]


def as_step(step: StepLike, what: str = "step") -> Step:
    """A step by its name, or the step itself.

    Parameters
    ----------
    step : Step or str
    what : str
        Its name in error messages.

    Raises
    ------
    InputError
        If no step has this name, or it is not a step.

    Examples
    --------
    >>> import liehom as lh
    >>> as_step(lh.Euler()), lh.Corrected("heun", 4)
    (Euler(), Corrected(Heun(), order=4))
    """
    if isinstance(step, Step):
        return step
    if not isinstance(step, str):
        raise InputError(
            f"{what} is {displayed(step)}, expected a step such as liehom.Euler() or liehom.LieTaylor(4), or its name"
        )
    if not _NAMED:
        raise InputError(f"{what} is {step!r}, but no step has a name yet: import liehom.integrators, or give a step")
    return _NAMED[0](step)


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

    @property
    def one_exponential(self) -> bool:
        """Whether `factors` is always a single generator: True."""
        return True

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        """The generator xi(m, t, h) of the step, array or Jet of shape (..., dim g)."""
        return Step.factors(self, action, psi, m, t, h)[0]

    def factors(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Factors:
        return (self.generator(action, psi, m, t, h),)


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
