"""Methods of a comparison: steps of the library and solvers of scipy, each run with a step size or a tolerance."""

from __future__ import annotations

import re
import warnings
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple, TypeAlias, final

import numpy as np

from liehom.correctors.step import ExponentialLike, StepLike, as_step
from liehom.errors import ConvergenceError, InputError, displayed
from liehom.homogeneous import GeneratorField
from liehom.integrators.propagator import Propagator, without_order_warning
from liehom.integrators.run.options import Span
from liehom.typing import Array

MethodLike: TypeAlias = StepLike | None
"""A step, its name, None for the default step, or "scipy NAME" for a method of scipy's solve_ivp."""
Methods: TypeAlias = MethodLike | Mapping[str, MethodLike] | Iterable[MethodLike]

PEERS = {name.lower(): name for name in ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")}
_PEER = re.compile(r"scipy[\s:.]+(\w+)", re.IGNORECASE)
DEFAULT = "default"
"""Label of the default step."""


class Setting(NamedTuple):
    """A fixed step size or a tolerance; the other one is None.

    Examples
    --------
    >>> str(Setting(dt=0.1)), str(Setting(tolerance=1e-6))
    ('dt 0.1', 'tol 1e-06')
    """

    dt: float | None = None
    tolerance: float | None = None

    def __str__(self) -> str:
        return f"tol {self.tolerance:.6g}" if self.dt is None else f"dt {self.dt:.6g}"


class Outcome(NamedTuple):
    """Points (..., N) at the end of a run, calls of the field, steps, and a message if the order was lost."""

    points: Array
    calls: int
    steps: int
    message: str = ""


class Compared(ABC):
    """A method of a comparison, for one field, time span and initial point."""

    label: str
    compiles: bool = False

    def takes(self, setting: Setting) -> bool:
        """Whether the method is run with this setting."""
        return True

    @abstractmethod
    def run(self, setting: Setting) -> Outcome:
        """The outcome of a run to the end; raises `ConvergenceError` if it fails."""


@final
class StepMethod(Compared):
    """A step of the library, as a `Propagator` that is made once.

    Examples
    --------
    >>> import liehom as lh
    >>> field, span = lh.GeneratorField(lh.defining(lh.so(2)), [1]), (np.float64(0), np.float64(1))
    >>> method = StepMethod("", "euler", Propagator(field, "euler"), span, np.array([1.0, 0.0]), 100)
    >>> method.run(Setting(dt=0.25))[1:]
    (4, 4, '')
    """

    def __init__(
        self, label: str, step: StepLike | None, propagator: Propagator, span: Span, start: Array, max_steps: int
    ) -> None:
        self.label = label or (DEFAULT if step is None else step if isinstance(step, str) else repr(step))
        self.compiles = propagator.engine.name != "numpy"
        self._propagator, self._span, self._start, self._max_steps = propagator, span, start, max_steps

    def run(self, setting: Setting) -> Outcome:
        options: dict[str, Any] = {"dt": setting.dt}
        if setting.tolerance is not None:
            options = {"rtol": setting.tolerance, "atol": setting.tolerance}
        with without_order_warning():
            found = self._propagator(
                self._span, self._start, t_eval=[self._span[1]], max_steps=self._max_steps, **options
            )
        if found.status == -1:
            raise ConvergenceError(found.message)
        message = found.message if found.status == -2 else ""
        return Outcome(found.y[..., -1], int(found.nfev), int(np.max(found.n_steps)), message)


@final
class ScipyMethod(Compared):
    """A method of scipy's solve_ivp on m' = X(m, t), all trajectories of an ensemble as one system.

    Examples
    --------
    >>> import liehom as lh
    >>> field, span = lh.GeneratorField(lh.defining(lh.so(2)), [1]), (np.float64(0), np.float64(1))
    >>> found = ScipyMethod("", "DOP853", field, span, np.array([1.0, 0.0])).run(Setting(tolerance=1e-10))
    >>> bool(abs(found.points[0] - np.cos(1)) < 1e-9)
    True
    """

    def __init__(self, label: str, name: str, field: GeneratorField, span: Span, start: Array) -> None:
        self.label = label or f"scipy {name}"
        self._name, self._field, self._span, self._start = name, field, span, start.astype(float)

    def takes(self, setting: Setting) -> bool:
        return setting.tolerance is not None

    def run(self, setting: Setting) -> Outcome:
        from scipy.integrate import solve_ivp

        shape, field = self._start.shape, self._field

        def rates(t: float, y: Array) -> Array:
            found: Array = np.asarray(field.vector(y.reshape(shape), np.full(shape[:-1], t))).reshape(-1)
            return found

        span = float(self._span[0]), float(self._span[1])
        options = {"rtol": setting.tolerance, "atol": setting.tolerance}
        with warnings.catch_warnings(record=True) as said:  # for example that the tolerance is replaced
            warnings.simplefilter("always")
            made = solve_ivp(rates, span, self._start.reshape(-1), self._name, **options)
        if not made.success:
            raise ConvergenceError(made.message)
        message = " ".join(dict.fromkeys(str(warning.message) for warning in said))
        return Outcome(made.y[:, -1].reshape(shape), int(made.nfev), len(made.t) - 1, message)


def compared_methods(
    methods: Methods,
    field: GeneratorField,
    span: Span,
    start: Array,
    *,
    exponential: ExponentialLike = "exp",
    clock: str = "corrected",
    engine: str = "numpy",
    max_steps: int = 100_000,
) -> list[Compared]:
    """The methods of a comparison, with labels that differ.

    Raises
    ------
    InputError
        If there is no method, a name is unknown, or two labels agree.

    Examples
    --------
    >>> import liehom as lh
    >>> field, span = lh.GeneratorField(lh.defining(lh.so(2)), [1]), (np.float64(0), np.float64(1))
    >>> made = compared_methods({"RK4": "rk4", "peer": "scipy dop853"}, field, span, np.array([1.0, 0.0]))
    >>> [method.label for method in made]
    ['RK4', 'peer']
    """
    if isinstance(methods, Mapping):
        given = [(str(label), method) for label, method in methods.items()]
    elif isinstance(methods, str) or methods is None or not isinstance(methods, Iterable):
        given = [("", methods)]
    else:
        given = [("", method) for method in methods]
    made: list[Compared] = []
    for label, method in given:
        peer = _PEER.fullmatch(method.strip()) if isinstance(method, str) else None
        if peer is not None:
            if peer[1].lower() not in PEERS:
                raise InputError(
                    f"no method of scipy is called {displayed(peer[1])}; known: {', '.join(PEERS.values())}"
                )
            made.append(ScipyMethod(label, PEERS[peer[1].lower()], field, span, start))
            continue
        step = None if method is None else as_step(method)
        propagator = Propagator(field, step, exponential=exponential, clock=clock, engine=engine)
        made.append(StepMethod(label, method, propagator, span, start, max_steps))
    labels = [method.label for method in made]
    if not made or len(set(labels)) < len(labels):
        raise InputError(f"expected methods with different labels, got {labels}: give a mapping of labels to steps")
    return made
