"""Generators and vector fields in any form a user may give."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import Any, NamedTuple, Self, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, LiehomError, SeriesError, ShapeError, displayed
from liehom.base.objects import refuse_masked
from liehom.base.pytrees import leaves, mapped, unwrapped
from liehom.base.typing import Array, Pytree, Real, Values, ValuesLike
from liehom.flow.action.expression import ComponentLike, Evaluation, Value, compiled
from liehom.flow.series.arrays import as_values, is_exact, is_jax, is_lazy, is_traced, namespace, zeros
from liehom.flow.series.jet import WITHOUT_SERIES, Jet
from liehom.flow.series.jet_functions import expanded_by_jax
from liehom.flow.tracing.array import Traced

# How a user's function of a point is called: f(m), f(m, t), f(m, t, args) or f(m, args), by its parameters.

Evaluated: TypeAlias = Callable[[Any, Any], Any]
"""A function of (m, t)."""

TIMES = ("t", "time")
"""Names of a parameter that is the time, so that it cannot be the point."""


class CallForm(NamedTuple):
    """The parameters of a function of a point, besides the point."""

    time: str | None = None  # name of the parameter for the time
    args: str | None = None  # name of the parameter for args
    time_keyword: bool = False  # whether it is given by name
    args_keyword: bool = False
    time_needed: bool = False  # whether the time has no default
    more: tuple[str, ...] = ()  # further parameters that are required


def _parameters(function: Callable[..., Any]) -> tuple[list[inspect.Parameter], list[inspect.Parameter]] | None:
    """The positional and the keyword-only parameters of a function; None if it has no signature."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return None
    positional = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    return positional, [p for p in parameters if p.kind is p.KEYWORD_ONLY]


def call_form(function: Callable[..., Any], what: str) -> CallForm:
    """The `CallForm` of a function, whose time and args are parameters of these names, or the second and the third
    without a default.
    """
    parameters = _parameters(function)
    if parameters is None:
        return CallForm()
    positional, keywords = parameters
    signature = inspect.signature(function)
    if positional and positional[0].name in TIMES:
        raise InputError(
            f"{what} has the parameters {signature}, expected the point first: (m, t). With {signature} it would get "
            "the point as the time"
        )
    needed = [p for p in positional if p.default is p.empty]
    named = {p.name: p for p in (*positional[1:], *keywords)}
    args = named.get("args") or next((p for p in needed[2:3] if p.name != "t"), None)
    time = next((p for p in needed[1:2] if p is not args), None) or named.get("t")
    more = [p.name for p in (*needed[1:], *keywords) if p.default is p.empty and p is not args and p is not time]
    if not positional and not any(p.kind is p.VAR_POSITIONAL for p in signature.parameters.values()):
        more.append("no m")
    after = 1 if time is None else 2
    return CallForm(
        time.name if time else None, args.name if args else None, time is not None and positional[1:2] != [time],
        args is not None and positional[after : after + 1] != [args], time is not None and time.default is time.empty,
        tuple(more),
    )  # fmt: skip


def called_as_event(function: Callable[..., Any], args: Pytree, what: str) -> Evaluated:
    """An event function as a function of (t, y), as in scipy's solve_ivp, or, if the second parameter is named t, of
    (m, t) as psi is; args as for psi.
    """
    parameters = _parameters(function)
    if parameters is None:
        return function
    positional, keywords = parameters
    swapped = [p.name in TIMES for p in positional[:2]] == [False, True]
    by_name = any(p.name == "args" for p in keywords)
    if by_name or any(p.name == "args" or p.default is p.empty for p in positional[2:]):
        if args is None:
            raise InputError(f"{what} takes args, but none were given: give args=...")
        last = unwrapped(args)
        if not by_name:
            return (lambda t, y: function(y, t, last)) if swapped else (lambda t, y: function(t, y, last))
        function = partial(function, args=last)
    return (lambda t, y: function(y, t)) if swapped else function


def parameters_like(function: object, inner: Callable[..., Any], what: str, point: str) -> Callable[..., Any]:
    """The function inner(m, *rest) with the parameters of a user's function of (m), (m, t) or (m, t, args)."""
    forms = f"({point}), ({point}, t) or ({point}, t, args)"
    if not callable(function):
        raise InputError(f"the {what} is a function of {forms}, got {displayed(function)}")
    positional, _ = _parameters(function) or ([], [])
    count = sum(p.default is p.empty for p in positional)
    if not 1 <= count <= 3:
        raise InputError(f"the {what} has the parameters {inspect.signature(function)}: expected {forms}")
    return (lambda m: inner(m), lambda m, t: inner(m, t), lambda m, t, args: inner(m, t, args))[count - 1]


def guarded(function: Callable[..., Any], what: str, *values: Values | Real) -> Any:
    """The value of a user's function of points and times, which it reads and cannot change."""
    try:
        return function(*map(_read_only, values))
    except ValueError as error:
        if "read-only" not in str(error):
            raise
        remedy = "write into a copy, as after m = m.copy(), or use m = 2 * m in place of m *= 2"
        raise InputError(f"{what} writes into its argument ({error}), a point or time of the run: {remedy}") from error


def _read_only(x: Any) -> Any:
    if type(x) is Traced:
        return Traced(x.tape, _read_only(x.entries))
    if not isinstance(x, np.ndarray):
        return x  # Jets and JAX arrays are not written into
    view = x.view()
    view.flags.writeable = False
    return view


def takes_time(function: Callable[..., Any]) -> bool:
    """Whether a function is called with (m, t), and not with m alone."""
    return call_form(function, "the function").time is not None


def checked_form(source: Callable[..., Any], what: str, time_dependent: bool | None) -> tuple[CallForm, bool]:
    """The `CallForm` of a user's function, and whether it depends on the time."""
    form = call_form(source, what)
    if form.more:
        raise InputError(
            f"{what} is a function with the parameters {inspect.signature(source)}: expected (m) or (m, t), "
            "or (m, t, args); bind others with functools.partial or a default"
        )
    return form, form.time is not None if time_dependent is None else bool(time_dependent)


def called(source: Callable[..., Any], form: CallForm, timed: bool, *args: Pytree) -> Evaluated:
    """A function, with its args if it has any, as a function of (m, t)."""
    timed = timed or form.time_needed
    if not (args and form.args_keyword) and not (timed and form.time_keyword):
        if not timed:
            return (lambda m, t: source(m, *args)) if args else lambda m, t: source(m)  # quicker without a tuple
        return (lambda m, t: source(m, t, *args)) if args else source
    time, fixed = str(form.time), {str(form.args): x for x in args}
    return (lambda m, t: source(m, **{time: t}, **fixed)) if timed else (lambda m, t: source(m, **fixed))


# Components: a generator or vector field as one function (m, t) -> components, on arrays, exact numbers and Jets. It
# is made from a function written with numpy over leading axes, a list of expressions in m0, m1, ..., t, or an array.

GeneratorLike: TypeAlias = "Callable[..., Any] | Sequence[ComponentLike] | npt.NDArray[Any]"
"""What is read as a generator or vector field: a function of m (and t), a list of components, or a constant array."""


class Components:
    """A function (m, t) -> array of shape (..., count), from any form that a user may give."""

    time_dependent: bool

    def __init__(
        self, source: GeneratorLike, size: int, counts: tuple[int, ...], what: str, time_dependent: bool | None = None
    ) -> None:
        self.size, self.counts, self.what, self._source = size, counts, what, source
        self.bound: tuple[Pytree, ...] = ()  # (args,) that the source is called with
        self._function: Evaluated
        self._form: CallForm | None = None
        self._jax_leaves: tuple[Values, ...] = ()
        self._read(time_dependent)

    def _read(self, time_dependent: bool | None) -> None:
        """Set the function, and whether it depends on time."""
        source, what = self._source, self.what
        refuse_masked(what, source)
        if callable(source):
            self._form, self.time_dependent = checked_form(source, what, time_dependent)
            self._function = called(source, self._form, self.time_dependent)
            if self.takes_args:
                self._bind(self.bound)
        elif is_jax(source) or (isinstance(source, np.ndarray) and (source.dtype != object or source.ndim != 1)):
            self._function, self.time_dependent = self._constant(source), False
        elif isinstance(source, str | bytes | dict | set | frozenset) or not np.iterable(source):
            raise InputError(
                f"{what} is {displayed(source)}: expected a function of m (and t), or a list of "
                f"{self._wanted()} components"
            )
        else:
            self._function, self.time_dependent = self._from_list(list(source))

    def __getstate__(self) -> dict[str, Any]:
        # closures over the source cannot be pickled; the source can, if it is not a function or has a name in a module
        return {name: value for name, value in vars(self).items() if name != "_function"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._read(self.time_dependent)

    @property
    def takes_args(self) -> bool:
        """Whether the source is a function with args."""
        return self._form is not None and self._form.args is not None

    def with_args(self, args: Pytree) -> Self:
        """The function with these args."""
        if not self.takes_args:
            raise InputError(f"args were given, but {self.what} takes none: write a function (m, t, args)")
        other = object.__new__(type(self))
        vars(other).update(vars(self))
        other._bind((args,))
        return other

    def _bind(self, bound: tuple[Pytree, ...]) -> None:
        """Set the function for args, or for a message that there are none yet."""
        source: Any = self._source
        self.bound = bound
        if bound and self._form is not None:
            form, timed, args = self._form, self.time_dependent, unwrapped(bound[0])
            self._jax_leaves = tuple(leaf.value for leaf in leaves(args) if is_jax(leaf.value))
            self._function = (
                (lambda m, t: called(source, form, timed, _as_jets(args, m))(m, t))
                if self._jax_leaves
                else called(source, form, timed, args)
            )
            return
        name = self.what

        def unbound(m: Values, t: Real) -> Values:
            raise InputError(
                f"{name} takes args, but none were given: integrate(..., args=...), or field.with_args(args)"
            )

        self._function = unbound

    def value(self, m: ValuesLike, t: Real = 0.0) -> Values:
        """The components at m (..., N) and t (...,): array or Jet of shape (..., count)."""
        if isinstance(m, Jet):
            time = Jet.constant(t, m.order) if is_jax(t) else t
            try:
                components = guarded(self._function, self.what, m, time)
            except TypeError as error:  # functions of JAX do not take Jets
                components = self._expanded_by_jax(m, time, error)
            except ValueError as error:
                if isinstance(error, LiehomError):
                    raise
                raise SeriesError(f"{self.what} has no Taylor series here ({error}); {WITHOUT_SERIES}") from error
            return self._checked(components, m)
        point: Values = as_values(m)
        if is_jax(point) or is_jax(t) or self._jax_leaves:
            # numpy functions run on Jets over JAX arrays, not on the arrays themselves
            xp = namespace(point, t, *self._jax_leaves)
            components = self.value(Jet.constant(xp.asarray(point), 0), t)
            return components.value if isinstance(components, Jet) else xp.asarray(components)
        return self._checked(guarded(self._function, self.what, point, t), point)

    __call__ = value

    def _expanded_by_jax(self, m: Jet, t: Any, error: TypeError) -> Jet:
        """The components at a Jet of JAX arrays, for a function written with the functions of JAX."""
        if self._form is None or not is_jax(m.value):
            raise error
        source: Any = self._source
        function = called(source, self._form, self.time_dependent, *map(unwrapped, self.bound))
        try:
            return expanded_by_jax(lambda m, t: joined(function(m, t), m), m, t)
        except TypeError:
            raise error from None

    def check(self, m: ValuesLike, t: Real = 0.0) -> None:
        """Check at initial points that the values are finite and that trajectories do not depend on each other."""
        point: Values = as_values(m)
        if point.ndim == 0 or point.shape[-1] != self.size:
            raise ShapeError(f"a point has {self.size} coordinates (on its last axis), got shape {point.shape}")
        if is_exact(point) or is_traced(point) or is_traced(t):
            self.value(point, t)
            return
        with np.errstate(all="ignore"):
            components = np.asarray(self.value(point, t))
            bad = np.argwhere(~np.isfinite(components))
            if len(bad):
                index = tuple(int(i) for i in bad[0])
                time = np.broadcast_to(np.asarray(t), point.shape[:-1])[index[:-1]]
                raise InputError(
                    f"{self.what}[{index[-1]}] is {components[index]} at m = {np.asarray(point)[index[:-1]]}, t = "
                    f"{time}{of_trajectory(index[:-1])}: start where it is defined, or change the field"
                )
            self._check_trajectories(np.asarray(point), t, components)

    def _check_trajectories(self, m: Array, t: Real, components: Array) -> None:
        """Check that the values of one trajectory stay the same if all others are moved to its point."""
        if m.ndim == 1 or m.size == 0:
            return
        for index in {(0,) * (m.ndim - 1), tuple(n - 1 for n in m.shape[:-1])}:
            alike, own = np.asarray(self.value(np.broadcast_to(m[index], m.shape).copy(), t))[index], components[index]
            if not np.allclose(alike, own, rtol=1e-6, atol=1e-6 * float(np.abs(own).max(initial=0.0))):
                raise ShapeError(
                    f"{self.what} of trajectory {index} depends on the points of other trajectories: coordinates are "
                    "on the last axis of m (write m[..., 0], and np.stack(..., axis=-1))"
                )

    def _checked(self, components: object, m: Values) -> Values:
        values = joined(components, m)
        values = values if isinstance(values, Jet) else self._real(values, m)
        shape = values.shape
        if not shape or shape[-1] not in self.counts:
            raise ShapeError(f"{self.what} has shape {shape} at m of shape {m.shape}, expected (..., {self._wanted()})")
        lead = m.shape[:-1]
        if shape[:-1] == lead:
            return values
        try:
            return np.broadcast_to(values, (*lead, shape[-1]))
        except ValueError:
            raise ShapeError(
                f"{self.what} has shape {shape} at m of shape {m.shape}: its leading axes must be those of m "
                "(write m[..., 0], and np.stack(..., axis=-1))"
            ) from None

    def _real(self, values: Any, m: Values) -> Any:
        """The values as an array of real numbers in the arithmetic of m."""
        kind, point = values.dtype.kind, m.value if isinstance(m, Jet) else m
        if kind == "f" or is_jax(values):
            return values
        exact = is_exact(point)
        if kind in "iu":
            return values.astype(object) + zeros(point, ()) if exact else values.astype(float)
        if kind == "O" and exact:
            return values
        if kind == "O" and not any(x is None for x in values.flat):
            with suppress(TypeError, ValueError):
                return values.astype(float)
        if kind == "c":
            raise InputError(f"{self.what} is complex: {values} at m of shape {m.shape}, expected real numbers")
        raise InputError(
            f"{self.what} returned {displayed(values if values.ndim else values.item())} at m of shape {m.shape}, "
            "expected an array of real numbers"
        )

    def _wanted(self) -> str:
        return " or ".join(map(str, sorted(set(self.counts))))

    def _constant(self, array: Any) -> Evaluated:
        if not array.shape or array.shape[-1] not in self.counts:
            raise ShapeError(f"{self.what} is an array of shape {array.shape}, expected (..., {self._wanted()})")
        if not is_jax(array) and (array.dtype.kind not in "iuf" or not bool(np.all(np.isfinite(array)))):
            raise InputError(f"{self.what} is {displayed(array)}: expected finite real numbers")
        return lambda m, t: array

    def _from_list(self, parts: Sequence[ComponentLike]) -> tuple[Evaluated, bool]:
        if len(parts) not in self.counts:
            raise ShapeError(f"{self.what} has {len(parts)} components, expected {self._wanted()}")
        functions, timed = zip(
            *[compiled(part, self.size, f"{self.what}[{i}]") for i, part in enumerate(parts)], strict=True
        )

        def evaluated(m: Values, t: Real) -> Values:
            at = Evaluation(m, t)
            return _stacked([function(at) for function in functions], m)

        return evaluated, any(timed)


# -- one array or Jet from the results of functions ----------------------------------------------------
def joined(x: Any, m: Values) -> Any:
    """One array or Jet from an object array, or a list of the components (...,) or the rows of the trajectories."""
    if isinstance(x, Jet) or is_lazy(x):
        return x
    if isinstance(x, np.ndarray):
        refuse_masked("a value of the field", x)
        if x.dtype != object or not any(isinstance(entry, Jet) or is_lazy(entry) for entry in x.flat):
            return x
        return _joined([joined(part, m) for part in x], 0) if x.ndim else x.item()
    if isinstance(x, list | tuple) and x:
        parts = [joined(part, m) for part in x]
        return _joined(parts, -1 if all(getattr(p, "shape", ()) in (m.shape[:-1], ()) for p in parts) else 0)
    return np.asarray(x)


def _joined(parts: list[Any], axis: int) -> Any:
    shape = np.broadcast_shapes(*[getattr(p, "shape", ()) for p in parts])
    if any(isinstance(p, Jet) for p in parts):
        return np.stack([np.broadcast_to(p, shape) if p.shape != shape else p for p in map(_arrayed, parts)], axis=axis)
    xp = namespace(*parts)
    return xp.stack([xp.broadcast_to(p if is_lazy(p) else xp.asarray(p), shape) for p in parts], axis=axis)


def _as_jets(args: Pytree, m: Values) -> Pytree:
    """args with series in place of JAX arrays, on which numpy functions do not run."""
    order = m.order if isinstance(m, Jet) else 0
    return mapped(args, lambda leaf: Jet.constant(leaf.value, order) if is_jax(leaf.value) else leaf.value)


def _arrayed(part: Value) -> Any:
    return part if isinstance(part, Jet) or is_lazy(part) else np.asarray(part)


def _stacked(parts: list[Value], m: Values) -> Values:
    """Components, each a number or of shape (...,), stacked on the last axis; exact if m is."""
    lead = m.shape[:-1]
    if any(isinstance(p, Jet) for p in parts):
        return np.stack([p if np.shape(p) == lead else np.broadcast_to(p, lead) for p in map(_arrayed, parts)], axis=-1)
    value = m.value if isinstance(m, Jet) else m
    if is_lazy(value) or any(map(is_lazy, parts)):
        return _joined([*parts, namespace(value).zeros(lead)], -1)[..., :-1]
    if is_exact(value):
        out = np.empty((*lead, len(parts)), dtype=object)
    else:
        kind = np.result_type(value.dtype, *[p for p in parts if np.ndim(p)])
        out = np.moveaxis(np.empty((len(parts), *lead), dtype=kind), 0, -1)
    for i, part in enumerate(parts):
        out[..., i] = part
    return out


def of_trajectory(index: tuple[int, ...]) -> str:
    """The end of a message that names the trajectory, or nothing for a single point."""
    return f" (trajectory {index[0] if len(index) == 1 else index})" if index else ""
