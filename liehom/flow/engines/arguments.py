"""Arguments of `Propagator` and `integrate`: their names and types, and checks that say what is not right."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from typing import Any, TypedDict

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, LiehomError, ShapeError, displayed
from liehom.base.objects import refuse_masked
from liehom.base.pytrees import Leaf, PerTrajectory, leaves, mapped, unwrapped
from liehom.base.typing import Array, IntegerArray, Pytree, Values
from liehom.flow.action.field import GeneratorField, check_point
from liehom.flow.action.space import Action, tight_frame
from liehom.flow.door import Representation
from liehom.flow.engines.engine import Engine
from liehom.flow.run.events import EventFunction
from liehom.flow.run.options import ATOL, Options, Span, points_of
from liehom.flow.run.solution import checked_path
from liehom.flow.series.arrays import is_jax, is_traced
from liehom.flow.steps.corrected import Corrected
from liehom.flow.steps.step import ExponentialLike, Step, StepLike

CLOCKS = ("corrected", "nominal")


class SharedOptions(TypedDict, total=False):
    """Options of a call of a `Propagator` that make sense for every kind of run."""

    rtol: float
    atol: npt.ArrayLike
    t_eval: npt.ArrayLike | None
    events: EventFunction | Sequence[EventFunction] | None
    max_step: float
    min_step: float
    first_step: float | None
    max_steps: int
    looks: int | None


class FileOptions(TypedDict, total=False):
    """Options of a call of a `Propagator` that are for one run, not for an ensemble in chunks."""

    dense_output: bool
    progress: bool | Callable[[float], object]
    checkpoint: str | os.PathLike[str] | None
    checkpoint_every: float


class CallOptions(SharedOptions, FileOptions, total=False):
    """Keyword arguments of a call of a `Propagator`."""

    dt: npt.ArrayLike | None


class RunOptions(SharedOptions, total=False):
    """Keyword arguments of `integrate` that ensembles and lattices of spins hand on to it."""

    args: Pytree
    exponential: ExponentialLike
    clock: str
    engine: str | Engine


class EnsembleOptions(RunOptions, total=False):
    """Keyword arguments of `integrate` that `integrate_ensemble` hands on to it."""

    step: StepLike | None
    dt: npt.ArrayLike | None


class SingleRunOptions(RunOptions, FileOptions, total=False):
    """All keyword arguments of `integrate` but `step` and `dt`."""


def with_tight_frame(action: Action, step: Step, start: Array, orbit_dimension: int | IntegerArray) -> Action:
    """The action with what a corrected step can use of the orbits, if all orbits are of one dimension."""
    dimensions = np.unique(orbit_dimension)
    if len(dimensions) != 1 or start.dtype != np.float64 or not isinstance(step, Corrected):
        return action
    return action.with_tight_frame(tight_frame(action, start.reshape(-1, start.shape[-1]), int(dimensions[0])))


def has_jax(args: Pytree) -> bool:
    """Whether a leaf is a JAX array."""
    return any(is_jax(leaf.value) for leaf in leaves(unwrapped(args)))


def without_jax(args: Pytree) -> Pytree:
    """args with numpy arrays in place of JAX arrays, for engines that take no others."""

    def plain(leaf: Leaf) -> object:
        inner = leaf.value.value if isinstance(leaf.value, PerTrajectory) else leaf.value
        if not is_jax(inner):
            return leaf.value
        if is_traced(inner):
            raise InputError(f"JAX traces {leaf.path}: take engine='jax', which passes through jax.jit and jax.grad")
        array = np.asarray(inner)
        return PerTrajectory(array) if isinstance(leaf.value, PerTrajectory) else array

    return mapped(args, plain)


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def check_generator(field: GeneratorField, start: Array, span: Span) -> None:
    """Raise an error unless psi is real and finite at the initial points, and reads of each trajectory its own time."""
    times = np.full(start.shape[:-1], span[0])
    psi = np.asarray(field.psi(start, times))
    if psi.dtype.kind not in "iuf":
        raise InputError(f"psi has the type {psi.dtype} at the start, expected real numbers")
    for index in map(tuple, np.argwhere(~np.isfinite(psi).all(axis=-1)).tolist()):
        where = f" of trajectory {index}" if index else ""
        raise InputError(f"psi is {psi[index]} at the start{where}, t = {span[0]}, m = {start[index]}: not finite")
    if field.time_dependent and start.shape[-2:-1] in {psi.shape[-1:], start.shape[-1:]}:
        times[..., 1:] += (span[1] - span[0]) / 64  # np.sin(t) * c raises no error for as many trajectories
        first, noise = np.asarray(field.psi(start, times))[..., 0, :], 1e-9 * np.abs(psi).max(initial=0.0)
        if not np.allclose(first, psi[..., 0, :], rtol=1e-6, atol=noise, equal_nan=True):
            raise ShapeError("psi of a trajectory depends on the times of other ones: write np.sin(t)[..., None] * m")


def step_sizes(dt: npt.ArrayLike, start: Values, span: Span) -> Array:
    """Fixed step sizes of shape (...,), checked."""
    refuse_masked("dt", dt)
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


@contextmanager
def shapes_named(args: Pytree) -> Iterator[None]:
    """A context in which a ValueError of psi, such as one of numpy about shapes, names the shapes of its args."""
    try:
        yield
    except ValueError as error:
        if args is None or isinstance(error, LiehomError):
            raise
        shapes = ", ".join(f"{leaf.path} has shape {np.shape(leaf.value)}" for leaf in leaves(unwrapped(args)))
        raise ShapeError(f"psi fails with these args ({error}): {shapes}") from error


OF_SOLVE_IVP = {  # options of scipy's solve_ivp, and what there is in their place
    "method": "the method is step, such as step='rk45' or step=liehom.LieTaylor(6)",
    "vectorized": "psi is called on whole ensembles always: m of shape (..., N), t of shape (...,)",
    **dict.fromkeys(("jac", "jac_sparsity", "lband", "uband"), "derivatives of psi are computed by series or tracing"),
}
OF_PROPAGATOR = ("step", "exponential", "clock", "engine")  # what a propagator has, and its calls do not take
OPTIONS = tuple({**EnsembleOptions.__annotations__, **FileOptions.__annotations__})


def check_option_names(given: Iterable[str]) -> None:
    """Raise TypeError if there is an option that a call does not have, with the one that was meant."""
    for name in set(given).difference(CallOptions.__annotations__):
        if name in OF_PROPAGATOR:
            raise TypeError(f"{name} is given once, as in Propagator(field, {name}=...), and not to a call")
        near = get_close_matches(name, OPTIONS, n=1)
        hint = OF_SOLVE_IVP.get(name) or (f"did you mean {near[0]!r}?" if near else f"known: {', '.join(OPTIONS)}")
        raise TypeError(f"integrate has no option {name!r}: {hint}")


def least_atol(atol: npt.ArrayLike, size: int) -> float:
    """The absolute tolerance as one number: the least, if there is one for each of the N coordinates."""
    refuse_masked("atol", atol)
    if np.ndim(atol) == 0:
        return positive("atol", atol, zero=True)  # type: ignore[arg-type]
    try:
        values = np.asarray(atol, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"atol is {displayed(atol)}, expected a positive number or {size} of them") from None
    if values.shape != (size,):
        raise ShapeError(f"atol has shape {values.shape}, expected a number or an array of shape ({size},)")
    if not bool(np.all(values >= 0)):
        raise InputError(f"atol is {displayed(atol)}, expected positive numbers")
    return float(values.min())


POSITIVE = dict.fromkeys(["rtol", "min_step", "checkpoint_every"], True)  # numbers, and whether they may be 0
POSITIVE |= dict.fromkeys(["max_step", "first_step", "max_steps"], False)


def checked_options(given: CallOptions, size: int, dt: Array | None, t_eval: Array | None, nominal: bool) -> Options:
    """The options of a call for points of N coordinates, with its step sizes and times."""
    o: Any = {name: x for name, x in given.items() if name != "first_step" or x is not None}
    o |= {name: positive(name, o[name], zero=zero) for name, zero in POSITIVE.items() if name in o}
    o["first_step"] = o.get("first_step", o.get("min_step")) or None
    o |= {"atol": least_atol(o.get("atol", ATOL), size), "looks": number_of_looks(o.get("looks"))}
    o["dense_output"] = flag("dense_output", o.get("dense_output", False))
    path = o.get("checkpoint")
    o |= {"dt": dt, "t_eval": t_eval, "checkpoint": None if path is None else checked_path(path)}
    options = Options(nominal=nominal, **o)
    if options.min_step > options.max_step:
        raise InputError(f"min_step is {options.min_step}, larger than max_step, {options.max_step}")
    if options.dt is None and options.rtol == 0 and options.atol == 0:
        raise InputError("rtol and atol are both 0: no step size meets that; give one of them, or dt")
    return options


def flag(name: str, value: object) -> bool:
    """The value as a boolean; `InputError` for arrays, which have none."""
    try:
        return bool(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} is {displayed(value)}, expected True or False") from None


def positive(name: str, value: float, *, zero: bool = False) -> float:
    """The value as a positive float, or 0 if that is allowed."""
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        number = np.nan
    if not (number > 0 or (zero and number == 0)):
        raise InputError(f"{name} is {displayed(value)}, expected a positive number")
    return number


def number_of_looks(looks: int | None) -> int | None:
    """The option `looks`, checked."""
    if looks is None:
        return None
    if isinstance(looks, bool) or not isinstance(looks, int | np.integer) or looks < 0:
        raise InputError(f"looks is {displayed(looks)}, expected an integer: how often psi is looked at, 0 for never")
    return int(looks)


def times_of(t_eval: npt.ArrayLike, span: Span) -> Array:
    """Times of t_eval, shape (k,), checked."""
    refuse_masked("t_eval", t_eval)
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
    return times.copy()


# Arguments of a call on JAX arrays: start, times and step sizes may be arrays that JAX traces. The type of the start is
# the type of the solution: float64 or float32. It is never changed: for float64, JAX has to be told once, by
# ``jax.config.update("jax_enable_x64", True)``.

REMEDY = 'jax.config.update("jax_enable_x64", True)'


def jax_start(representation: Representation, y0: npt.ArrayLike) -> tuple[Values, int | IntegerArray]:
    """Initial points as a JAX array, and the dimensions of their orbits; the largest one if JAX traces them."""
    start: Any = y0
    if not is_jax(start):
        from jax import numpy as jnp

        points = points_of(y0)
        start = jnp.asarray(points)
        if start.dtype != points.dtype:
            raise InputError(
                f"the start is of type {points.dtype}, and JAX computes in {start.dtype}: {REMEDY}, or start from a "
                "JAX array"
            )
    if start.dtype not in (np.float64, np.float32):
        raise InputError(f"the start is a JAX array of type {start.dtype}, expected float64 or float32: {REMEDY}")
    n = representation.size
    if start.ndim == 0 or start.shape[-1] != n:
        raise InputError(f"a point has {n} coordinates (on its last axis), got shape {start.shape}")
    if is_traced(start):
        points = np.random.default_rng(0).normal(size=(16, n))
        return start, int(check_point(representation, points).max())
    return start, check_point(representation, np.asarray(start))


def traces_times(t_span: Iterable[float] | Span, others: Sequence[object]) -> bool:
    """Whether JAX traces an end of the time span, or one of the other arrays."""
    return any(map(is_traced, [*(t_span if isinstance(t_span, list | tuple) else [t_span]), *others]))


def jax_span(t_span: Iterable[float] | Span) -> Span:
    """Start and end of a time span, of which JAX may trace one or both."""
    ends: list[Any] = list(t_span)
    if len(ends) != 2 or any(np.ndim(t) for t in ends):
        raise InputError(f"t_span has {len(ends)} entries, expected two numbers (start, end)")
    return ends[0], ends[1]


def jax_times(
    dt: npt.ArrayLike | None, t_eval: npt.ArrayLike | None, start: Values
) -> tuple[Array | None, Array | None]:
    """Step sizes and output times of a call where JAX traces one of them or the span, checked as far as possible."""
    sizes: Any = dt
    if dt is not None and not is_traced(dt):
        sizes = step_sizes(dt, start, (np.float64(0), np.float64(0)))
    elif dt is not None and np.shape(dt) not in ((), start.shape[:-1]):
        raise ShapeError(f"dt has shape {np.shape(dt)}, the ensemble {start.shape[:-1]}")
    times: Any = t_eval if t_eval is None or is_traced(t_eval) else np.asarray(t_eval, dtype=np.float64)
    if times is not None and np.ndim(times) != 1:
        raise ShapeError(f"t_eval has shape {np.shape(times)}, expected a list of times")
    return sizes, times
