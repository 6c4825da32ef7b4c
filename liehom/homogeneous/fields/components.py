"""Components: a generator or vector field, in any form a user may give, as one function (m, t) -> components.

The forms are

* a function psi(m) or psi(m, t) written with numpy functions over leading axes,
* a list of sympy expressions, strings of the whitelist grammar or numbers, in the symbols m0, m1, ..., t,
* an array of constant components.

All of them run on arrays, on exact numbers and on Jets.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, ShapeError, displayed
from liehom.homogeneous.fields.evaluation import Evaluation, Value
from liehom.homogeneous.fields.expression import FUNCTIONS as FUNCTIONS
from liehom.homogeneous.fields.expression import ComponentLike, compiled
from liehom.homogeneous.fields.signature import CallForm, Evaluated, called, called_with, checked_form
from liehom.pytrees import leaves, mapped, unwrapped
from liehom.series.arrays import as_values, is_exact, is_jax, is_lazy, is_traced, namespace, zeros
from liehom.series.jax_functions import expanded_by_jax
from liehom.series.jet import Jet
from liehom.typing import Array, Pytree, Real, Values, ValuesLike

GeneratorLike: TypeAlias = "Callable[..., Any] | Sequence[ComponentLike] | npt.NDArray[Any]"
"""What is read as a generator or vector field: a function of m (and t), a list of components, or a constant array."""


@final
class Components:
    """A function (m, t) -> array of shape (..., count), from any form that a user may give.

    Parameters
    ----------
    source : callable, array, or sequence of numbers, strings, sympy expressions or parsed strings
        A function is called as f(m), or as f(m, t) if it has a second parameter without a default, or one named t,
        and with args too if it has a third parameter without a default, or one named args.
        A constant array may have leading axes, which broadcast against those of m.
    size : int
        N, the number of coordinates of m.
    counts : tuple of int
        The admissible numbers of components.
    what : str
        Name in error messages.
    time_dependent : bool, optional
        Whether a function is called with t (default: decided by its parameters).
    bound : tuple
        (args,), what a function with args is called with; () if they are not known yet.

    Attributes
    ----------
    takes_args : bool
        Whether the source is a function with args.

    Raises
    ------
    ShapeError
        If the number of components is wrong.
    InputError
        If the source has none of these forms. On evaluation, if the values are not real numbers.

    Examples
    --------
    >>> import numpy as np
    >>> f = Components(["m0*m1", "sin(t)"], 2, (2,), "psi")
    >>> f(np.array([2.0, 3.0]), 0.0), f.time_dependent
    (array([6., 0.]), True)
    """

    counts: tuple[int, ...]
    size: int
    time_dependent: bool
    what: str
    bound: tuple[Pytree, ...]

    __slots__ = ("_form", "_function", "_jax_leaves", "_source", "bound", "counts", "size", "time_dependent", "what")

    def __init__(
        self,
        source: GeneratorLike,
        size: int,
        counts: tuple[int, ...],
        what: str,
        time_dependent: bool | None = None,
        bound: tuple[Pytree, ...] = (),
    ) -> None:
        self.size, self.counts, self.what, self._source, self.bound = size, counts, what, source, ()
        self._function: Evaluated
        self._form: CallForm | None = None
        self._jax_leaves: tuple[Values, ...] = ()
        if callable(source):
            self._form, self.time_dependent = checked_form(source, what, time_dependent)
            self._function = called(source, self._form, self.time_dependent)
            if self.takes_args:
                self._bind(bound)
        elif is_jax(source) or (isinstance(source, np.ndarray) and (source.dtype != object or source.ndim != 1)):
            self._function, self.time_dependent = self._constant(source), False
        elif isinstance(source, str | bytes | dict | set | frozenset) or not np.iterable(source):
            raise InputError(
                f"{what} is {displayed(source)}: expected a function of m (and t), or a list of "
                f"{self._wanted()} components"
            )
        else:
            self._function, self.time_dependent = self._from_list(list(source))

    def __reduce__(self) -> tuple[Any, ...]:
        # closures over the source cannot be pickled; the source can, if it is not a function or has a name in a module
        return Components, (self._source, self.size, self.counts, self.what, self.time_dependent, self.bound)

    @property
    def takes_args(self) -> bool:
        """Whether the source is a function with args."""
        return self._form is not None and self._form.args is not None

    def with_args(self, args: Pytree) -> Components:
        """The function with these args.

        Parameters
        ----------
        args : pytree

        Raises
        ------
        InputError
            If the source takes no args.

        Examples
        --------
        >>> f = Components(lambda m, t, args: args["gain"] * m, 1, (1,), "psi")
        >>> f.with_args({"gain": 3.0})(np.array([2.0]))
        array([6.])
        """
        if not self.takes_args:
            raise InputError(f"args were given, but {self.what} takes none: write a function (m, t, args)")
        made = object.__new__(Components)
        made.size, made.counts, made.what, made._source = self.size, self.counts, self.what, self._source
        made.time_dependent, made._form, made._jax_leaves = self.time_dependent, self._form, ()
        made._bind((args,))
        return made

    def _bind(self, bound: tuple[Pytree, ...]) -> None:
        """Set the function for args, or for a message that there are none yet."""
        source: Any = self._source
        self.bound = bound
        if bound and self._form is not None:
            form, timed, args = self._form, self.time_dependent, unwrapped(bound[0])
            self._function = called_with(source, form, timed, args)
            self._jax_leaves = tuple(leaf.value for leaf in leaves(args) if is_jax(leaf.value))
            if self._jax_leaves:
                self._function = lambda m, t: called_with(source, form, timed, _as_jets(args, m))(m, t)
            return
        name = self.what

        def unbound(m: Values, t: Real) -> Values:
            raise InputError(
                f"{name} takes args, but none were given: integrate(..., args=...), or field.with_args(args)"
            )

        self._function = unbound

    def __call__(self, m: ValuesLike, t: Real = 0.0) -> Values:
        """The components at m (..., N) and t (...,): array or Jet of shape (..., count)."""
        if isinstance(m, Jet):
            time = Jet.constant(t, m.order) if is_jax(t) else t
            try:
                made = self._function(m, time)
            except TypeError as error:  # functions of JAX do not take Jets
                made = self._expanded_by_jax(m, time, error)
            return self._checked(made, m)
        point: Values = as_values(m)
        if is_jax(point) or is_jax(t) or self._jax_leaves:
            # numpy functions run on Jets over JAX arrays, not on the arrays themselves
            xp = namespace(point, t, *self._jax_leaves)
            found = self(Jet.constant(xp.asarray(point), 0), t)
            value: Values = found.value if isinstance(found, Jet) else xp.asarray(found)
            return value
        return self._checked(self._function(point, t), point)

    def _expanded_by_jax(self, m: Jet, t: Any, error: TypeError) -> Jet:
        """The components at a Jet of JAX arrays, for a function written with the functions of JAX."""
        if self._form is None or not is_jax(m.value):
            raise error
        source: Any = self._source
        if self.takes_args:
            function = called_with(source, self._form, self.time_dependent, unwrapped(self.bound[0]))
        else:
            function = called(source, self._form, self.time_dependent)
        try:
            return expanded_by_jax(lambda m, t: joined(function(m, t), m), m, t)
        except TypeError:
            raise error from None

    def check(self, m: ValuesLike, t: Real = 0.0) -> None:
        """Check at initial points that the values are finite and that trajectories do not depend on each other.

        Parameters
        ----------
        m : array of shape (..., N)
        t : float or array of shape (...,)

        Raises
        ------
        ShapeError
            If the values have the wrong shape, or the values of one trajectory depend on another trajectory.
        InputError
            If a value is not a finite real number; names the component.

        Examples
        --------
        >>> Components(["1/m0"], 1, (1,), "psi").check(np.array([0.0]))
        Traceback (most recent call last):
        ...
        liehom.errors.InputError: psi[0] is inf at m = [0.], t = 0.0: start where it is defined, ...
        """
        point: Values = as_values(m)
        if point.ndim == 0 or point.shape[-1] != self.size:
            raise ShapeError(f"a point has {self.size} coordinates (on its last axis), got shape {point.shape}")
        if is_exact(point) or is_traced(point) or is_traced(t):
            self(point, t)
            return
        with np.errstate(all="ignore"):
            made = np.asarray(self(point, t))
            bad = np.argwhere(~np.isfinite(made))
            if len(bad):
                index = tuple(int(i) for i in bad[0])
                time = np.broadcast_to(np.asarray(t), point.shape[:-1])[index[:-1]]
                raise InputError(
                    f"{self.what}[{index[-1]}] is {made[index]} at m = {np.asarray(point)[index[:-1]]}, t = {time}"
                    f"{_of_trajectory(index[:-1])}: start where it is defined, or change the field"
                )
            self._check_trajectories(np.asarray(point), t, made)

    def _check_trajectories(self, m: Array, t: Real, made: Array) -> None:
        """Check that the values of one trajectory stay the same if all others are moved to its point."""
        if m.ndim == 1 or m.size == 0:
            return
        for index in {(0,) * (m.ndim - 1), tuple(n - 1 for n in m.shape[:-1])}:
            alike = np.asarray(self(np.broadcast_to(m[index], m.shape).copy(), t))[index]
            if not np.allclose(alike, made[index], rtol=1e-6, atol=1e-6 * float(np.abs(made[index]).max(initial=0.0))):
                raise ShapeError(
                    f"{self.what} of trajectory {index} depends on the points of other trajectories: coordinates are "
                    "on the last axis of m (write m[..., 0], and np.stack(..., axis=-1))"
                )

    def _checked(self, made: object, m: Values) -> Values:
        found = joined(made, m)
        values = found if isinstance(found, Jet) else self._real(found, m)
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

    def _real(self, made: Any, m: Values) -> Any:
        """The values as an array of real numbers in the arithmetic of m."""
        kind = made.dtype.kind
        if kind == "f" or is_jax(made):
            return made
        exact = is_exact(m.value if isinstance(m, Jet) else m)
        if kind in "iu":
            return (
                made.astype(object) + zeros(m.value if isinstance(m, Jet) else m, ()) if exact else made.astype(float)
            )
        if kind == "O" and exact:
            return made
        if kind == "O" and not any(x is None for x in made.flat):
            try:
                return made.astype(float)
            except (TypeError, ValueError):
                pass
        if kind == "c":
            raise InputError(f"{self.what} is complex: {made} at m of shape {m.shape}, expected real numbers")
        found = made.item() if made.ndim == 0 else made
        raise InputError(
            f"{self.what} returned {displayed(found)} at m of shape {m.shape}, expected an array of real numbers"
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
        made = [compiled(part, self.size, f"{self.what}[{i}]") for i, part in enumerate(parts)]
        functions = [function for function, _ in made]

        def evaluated(m: Values, t: Real) -> Values:
            at = Evaluation(m, t)
            return _stacked([function(at) for function in functions], m)

        return evaluated, any(timed for _, timed in made)


# -- one array or Jet from the results of functions ----------------------------------------------------
def joined(made: Any, m: Values) -> Any:
    """One array or Jet from a list, tuple or object array of numbers, arrays or Jets.

    A list or tuple has either the components, each of shape (...,), or the rows of the trajectories as its entries.

    Examples
    --------
    >>> import numpy as np
    >>> joined([1.0, np.float64(2)], np.zeros(2))
    array([1., 2.])
    >>> joined([np.zeros(5), np.ones(5)], np.zeros((5, 3))).shape
    (5, 2)
    """
    if isinstance(made, Jet) or is_lazy(made):
        return made
    if isinstance(made, np.ndarray):
        if made.dtype != object or not any(isinstance(x, Jet) or is_lazy(x) for x in made.flat):
            return made
        return _joined([joined(part, m) for part in made], 0) if made.ndim else made.item()
    if isinstance(made, list | tuple) and made:
        parts = [joined(part, m) for part in made]
        shapes = [np.shape(p.value) if isinstance(p, Jet) else np.shape(p) for p in parts]
        return _joined(parts, -1 if all(s in (m.shape[:-1], ()) for s in shapes) else 0)
    return np.asarray(made)


def _joined(parts: list[Any], axis: int) -> Any:
    shape = np.broadcast_shapes(*[np.shape(p.value) if isinstance(p, Jet) else np.shape(p) for p in parts])
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
        spread = [p if np.shape(p) == lead else np.broadcast_to(_arrayed(p), lead) for p in map(_arrayed, parts)]
        stacked: Values = np.stack(spread, axis=-1)
        return stacked
    value = m.value if isinstance(m, Jet) else m
    if is_lazy(value) or any(map(is_lazy, parts)):
        with_zeros: Values = _joined([*parts, namespace(value).zeros(lead)], -1)[..., :-1]
        return with_zeros
    if is_exact(value):
        out = np.empty((*lead, len(parts)), dtype=object)
    else:
        kind = np.result_type(value.dtype, *[p for p in parts if np.ndim(p)])
        out = np.moveaxis(np.empty((len(parts), *lead), dtype=kind), 0, -1)
    for i, part in enumerate(parts):
        out[..., i] = part
    return out


def _of_trajectory(index: tuple[int, ...]) -> str:
    return f" (trajectory {index[0] if len(index) == 1 else index})" if index else ""
