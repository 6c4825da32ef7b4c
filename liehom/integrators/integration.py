"""integrate: trajectories of a generator field, with the interface of scipy's solve_ivp.

This module checks the arguments; the loop over steps is in `liehom.integrators.run.run`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.correctors.isotropy.corrected import Corrected
from liehom.correctors.step import ExponentialLike, Generator, Step
from liehom.errors import InputError, ShapeError, displayed
from liehom.homogeneous import Action, GeneratorField
from liehom.homogeneous.fields.field import check_point
from liehom.homogeneous.frames.branch_free_frames import tight_frame
from liehom.integrators.compiled.compiled import compiled_steps
from liehom.integrators.compiled.jax_integration import integrate_on_jax
from liehom.integrators.methods.steps import LieTaylor
from liehom.integrators.run.checkpoint import checked_path
from liehom.integrators.run.events import EventFunction
from liehom.integrators.run.options import Options, Span
from liehom.integrators.run.points import points_of, span_of
from liehom.integrators.run.run import Run
from liehom.integrators.run.solution import Solution, warn_of_order
from liehom.series.arrays import is_jax
from liehom.typing import Array, IntegerArray

CLOCKS = ("corrected", "nominal")
WARNS: ContextVar[bool] = ContextVar("WARNS", default=True)
"""Whether `integrate` issues an `OrderWarning`."""


@contextmanager
def without_order_warning() -> Iterator[None]:
    """A context in which `integrate` issues no `OrderWarning`, for callers that show the message or merge reports.

    Examples
    --------
    >>> with without_order_warning():
    ...     WARNS.get()
    False
    """
    token = WARNS.set(False)
    try:
        yield
    finally:
        WARNS.reset(token)


def integrate(
    field: GeneratorField,
    t_span: Iterable[float] | Span,
    y0: npt.ArrayLike,
    *,
    step: Step | None = None,
    dt: npt.ArrayLike | None = None,
    rtol: float = 1e-6,
    atol: float = 1e-9,
    t_eval: npt.ArrayLike | None = None,
    dense_output: bool = False,
    events: EventFunction | Sequence[EventFunction] | None = None,
    exponential: ExponentialLike = "exp",
    clock: str = "corrected",
    max_step: float = np.inf,
    first_step: float | None = None,
    max_steps: int = 10_000_000,
    progress: bool | Callable[[float], object] = False,
    checkpoint: str | os.PathLike[str] | None = None,
    checkpoint_every: float = 30.0,
    compile: str | None = None,
) -> Solution:
    """Trajectories of m' = rho(psi(m, t)) m, a `Solution` that stays on the orbit of the initial point.

    Parameters
    ----------
    field : GeneratorField
    t_span : (float, float)
        Initial and final time; the final time may be the smaller one.
    y0 : array_like of shape (N,) or (..., N)
        The initial point, or the initial points of an ensemble, which is integrated at once (psi is always called on
        the whole ensemble). numpy.longdouble gives a solution in extended precision.
    step : Step, optional
        The method (default ``LieTaylor(6)``): ``Corrected(Euler(), order=4)``, ``RKMK("rk45")``, ....
    dt : float or array of shape (...,), optional
        A fixed step size. Without it the step size is adaptive, by `rtol` and `atol`, for every trajectory separately.
    rtol, atol : float
        The error of a step is at most atol + rtol |m|, as root mean squares over the coordinates. The tolerance is
        never below 10 units of round-off.
    t_eval : array_like of shape (k,), optional
        Times at which to store the solution, in the direction of integration; by default every step. With ``t_eval``
        no other points are stored, so that ``t_eval=[end]`` saves memory.
    dense_output : bool
        Whether to return the solution as a function of time, in `sol`.
    events : callable or list of callables, optional
        Functions g(t, y) whose zeros are recorded, with the attributes `terminal` and `direction` of solve_ivp. For
        an ensemble they return one number per trajectory. A change of sign between the ends of a step is located on
        the dense output to round-off. Two zeros within one step are not noticed: see `max_step` (with events, an
        adaptive step moves a point by at most half of |m|). A zero at the initial time is recorded, but does not end
        the run.
    exponential : str, Exponential or callable
        "exp", "cayley", ...: see `liehom.homogeneous.exponential_of`.
    clock : "corrected" or "nominal"
        The time that passes in a step of size h: "corrected" for the time reparametrization τ(h) of the step (its
        "clock"), with which a corrected step has its order as a trajectory; "nominal" for h, as in the paper, with
        which only the orbit has the order of the correction.
    max_step, first_step : float, optional
        Bound for adaptive step sizes, and the first size.
    max_steps : int
        The largest number of steps of a trajectory; at that number it ends with status -1.
    progress : bool or callable
        A progress bar on standard error, or a function of the fraction done.
    checkpoint : path, optional
        A file (.npz) to which the state is written every `checkpoint_every` seconds, and when an interruption or an
        error ends the run. A run that finds it continues from it, bit for bit, and deletes it at the end.
    checkpoint_every : float
        Seconds between two checkpoints.
    compile : "llvm" or "jax", optional
        Compile the step (extra ``llvm`` or ``jax``), for fixed and for adaptive step sizes: see Notes.

    Returns
    -------
    Solution
        With the entries `t`, `y`, `sol`, `t_events`, `status`, ... of solve_ivp, and `report`.

    Raises
    ------
    ShapeError, InputError
        If the initial point, psi at that point, or an option is not right.
    TangencyError
        If a field X is not tangent to the orbit.
    SeriesError
        If the step expands psi, and psi branches on values; `RKMK` only calls it.
    TraceError
        With `compile`, if the step cannot be compiled; the message says why.
    FormatError
        If the file at `checkpoint` is not a checkpoint, or is damaged.

    Warns
    -----
    OrderWarning
        If a `Corrected` step does not keep its order: see Notes.

    Notes
    -----
    The last step is shortened (τ(h) = remaining time, by Newton), so that t[-1] == t_span[1]. If trajectories take
    different numbers of steps, t and y are filled up with NaN unless `t_eval` is given. For an ensemble, psi gets
    times t of the shape of the leading axes.

    An adaptive step size follows from the estimate of an embedded pair, or from the Taylor coefficients of the error at
    the initial point of a step. The latter cannot foresee a jump of psi: take a pair, or `max_step`.

    A trajectory ends with status -1, and with the points computed so far, if one of the following occurs; the other
    trajectories of an ensemble go on, and `statuses` and `message` say which ended and when.

    * psi is not finite;
    * the step size is below round-off;
    * τ does not increase at an admissible rate, between 1/5 and 5, over the step;
    * the equations of an implicit step have no solution;
    * `max_steps` is reached.

    A `Corrected` step claims its order only if every linear system of its corrections has a solution, and if no step
    comes within two steps of the cone on which the range condition fails (docs/theory/correctors.md). Both are
    checked at every step. A trajectory that reaches its end without its order has status -2, so that `success` is
    False, and an `OrderWarning` names the first time.

    With ``compile`` the step is traced once, with everything that derives it, and compiled to machine code, which is
    cached on disk. Compiled code makes the ordinary steps. The first and the last step, steps that pass a time of
    `t_eval` and steps that fail are made without it. The results agree to round-off. psi is called while the step is
    traced, not in the steps, so it must be the same function all the time. `nfev` is the number of calls that the
    trajectory with the most of them would make. Adaptive step sizes depend on the estimate of the error, a small
    difference of large numbers. If it is far below the tolerance, sizes may differ by 1e-7 relatively, and a step
    accepted by less than that may be rejected.

    With ``compile="jax"`` and a JAX array y0 the result holds JAX arrays at t_eval (by default the initial and the
    final time), and works under jax.jit, jax.grad and jax.vmap. It needs `dt`. Under jax.jit and
    jax.vmap `report` only says what was asked for, and there is no warning; `statuses` is a JAX array.

    Examples
    --------
    The free rigid body on the sphere, Euler's step corrected to order 4:

    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
    >>> sol = lh.integrate(field, (0, 10), [0.6, 0.0, 0.8], step=lh.Corrected(lh.Euler(), order=4), dt=0.1)
    >>> sol.y.shape[0], bool(abs(np.linalg.norm(sol.y[:, -1]) - 1) < 1e-13), sol.report.order
    (3, True, 4)
    """
    if not isinstance(field, GeneratorField):
        raise InputError(f"expected a GeneratorField, got {displayed(field)}: call liehom.GeneratorField(rho, psi)")
    step = LieTaylor(6) if step is None else step
    if not isinstance(step, Step):
        raise InputError(f"step is {displayed(step)}, expected a step such as liehom.Euler() or liehom.LieTaylor(4)")
    if isinstance(compile, str) and compile == "jax" and is_jax(y0):
        possible = events is None and not dense_output and checkpoint is None
        return _on_jax(field, t_span, y0, step, dt if possible else None, t_eval, exponential, clock)
    start = points_of(y0)
    orbit_dimension = check_point(field.representation, start)
    span = span_of(t_span, start.dtype)
    action = Action(field.representation, exponential)
    _check_generator(field, start, span[0])
    if clock not in CLOCKS:
        raise InputError(f"clock is {displayed(clock)}, expected one of {', '.join(map(repr, CLOCKS))}")
    options = Options(
        dt=None if dt is None else _step_size(dt, start, span),
        rtol=_positive("rtol", rtol, zero=True),
        atol=_positive("atol", atol, zero=True),
        t_eval=None if t_eval is None else _times(t_eval, span),
        dense_output=_flag("dense_output", dense_output),
        events=events,
        nominal=clock == "nominal",
        max_step=_positive("max_step", max_step),
        first_step=None if first_step is None else _positive("first_step", first_step),
        max_steps=_positive("max_steps", max_steps),
        checkpoint_every=_positive("checkpoint_every", checkpoint_every, zero=True),
    )
    if options.dt is None and options.rtol == 0 and options.atol == 0:
        raise InputError("rtol and atol are both 0: no step size meets that; give one of them, or dt")
    path = None if checkpoint is None else checked_path(checkpoint)
    action = _with_tight_frame(action, step, start, orbit_dimension)
    # numbers that are not finite are noticed, and end a trajectory with a message
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        run = Run(action, Generator(field, orbit_dimension), step, span, start, options)
        if compile is not None:
            run.fast_path = compiled_steps(run, compile)
        return _warned(run.execute(progress, path), stacklevel=3)


def _with_tight_frame(action: Action, step: Step, start: Array, orbit_dimension: int | IntegerArray) -> Action:
    """The action with what a corrected step can use of the orbits, if all orbits are of one dimension."""
    dimensions = np.unique(orbit_dimension)
    if len(dimensions) != 1 or start.dtype != np.float64 or not isinstance(step, Corrected):
        return action
    return action.with_tight_frame(tight_frame(action, start.reshape(-1, start.shape[-1]), int(dimensions[0])))


def _on_jax(
    field: GeneratorField,
    t_span: Iterable[float] | Span,
    y0: npt.ArrayLike,
    step: Step,
    dt: npt.ArrayLike | None,
    t_eval: npt.ArrayLike | None,
    exponential: ExponentialLike,
    clock: str,
) -> Solution:
    """`integrate_on_jax` with checked arguments; without t_eval, the points at the initial and the final time."""
    if dt is None:
        raise InputError(
            "integrate on JAX arrays takes fixed steps (give dt), and no events, dense output or checkpoints: from "
            "numpy arrays compile='jax' adapts steps too"
        )
    size = float(dt)  # type: ignore[arg-type]
    span = span_of(t_span, np.dtype(np.float64))
    if clock not in CLOCKS:
        raise InputError(f"clock is {displayed(clock)}, expected one of {', '.join(map(repr, CLOCKS))}")
    if not (np.isfinite(size) and size > 0):
        raise InputError(f"dt is {displayed(size)}, expected a positive step size (the direction is that of t_span)")
    ends: Any = np.unique(span)[:: 1 if span[1] >= span[0] else -1]
    times = ends if t_eval is None else _times(t_eval, span)
    action = Action(field.representation, exponential)
    solution = integrate_on_jax(action, field, step, span, y0, size, times, nominal=clock == "nominal")
    return _warned(solution, stacklevel=4)


def _warned(solution: Solution, stacklevel: int) -> Solution:
    if WARNS.get():
        warn_of_order(solution.report, stacklevel)
    return solution


def _check_generator(field: GeneratorField, start: Array, t: np.floating[Any]) -> None:
    """Raise InputError unless psi is real and finite at the initial points (`field.psi` checks its shape)."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        psi = np.asarray(field.psi(start, np.full(start.shape[:-1], t)))
    if psi.dtype.kind not in "iuf":
        raise InputError(f"psi has the type {psi.dtype} at the start, expected real numbers")
    bad = ~np.isfinite(psi).all(axis=-1)
    if bool(bad.any()):
        index = tuple(int(i) for i in np.argwhere(bad)[0])
        where = f" of trajectory {index}" if index else ""
        raise InputError(f"psi is {psi[index]} at the start{where}, t = {t}, m = {start[index]}: it must be finite")


def _step_size(dt: npt.ArrayLike, start: Array, span: Span) -> Array:
    """Fixed step sizes of shape (...,), checked."""
    try:
        sizes = np.asarray(dt).astype(start.dtype, casting="same_kind")
    except (TypeError, ValueError):
        raise InputError(f"dt is {displayed(dt)}, expected a positive step size") from None
    if not bool(np.all(np.isfinite(sizes) & (sizes > 0))):
        raise InputError(f"dt is {displayed(dt)}, expected a positive step size (the direction is that of t_span)")
    least = 8 * np.finfo(start.dtype).eps * max(abs(span[0]), abs(span[1]))
    if span[0] != span[1] and bool(np.any(sizes < least)):
        raise InputError(f"dt is {displayed(dt)}, below the round-off of times in t_span, {least:.2g}")
    try:
        return np.broadcast_to(sizes, start.shape[:-1]).copy()
    except ValueError:
        raise ShapeError(f"dt has shape {sizes.shape}, the ensemble {start.shape[:-1]}") from None


def _flag(name: str, value: object) -> bool:
    """The value as a boolean; `InputError` for arrays, which have none."""
    try:
        return bool(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} is {displayed(value)}, expected True or False") from None


def _positive(name: str, value: float, *, zero: bool = False) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        number = np.nan
    if not (number > 0 or (zero and number == 0)):
        raise InputError(f"{name} is {displayed(value)}, expected a positive number")
    return number


def _times(t_eval: npt.ArrayLike, span: Span) -> Array:
    """Times of t_eval, shape (k,), checked."""
    try:
        times: Any = np.asarray(t_eval, dtype=span[0].dtype)
    except (TypeError, ValueError):
        raise InputError(f"t_eval is {displayed(t_eval)}, expected a list of times") from None
    if times.ndim != 1:
        raise ShapeError(f"t_eval has shape {times.shape}, expected a list of times")
    low, high = min(span), max(span)
    if not bool(np.all((times >= low) & (times <= high))):
        raise InputError(f"t_eval must lie within t_span, {low} to {high}")
    steps = np.diff(times) * (1 if span[1] >= span[0] else -1)
    if bool(np.any(steps <= 0)):
        raise InputError("t_eval must be sorted in the direction of integration, without repetitions")
    checked: Array = times.copy()
    return checked
