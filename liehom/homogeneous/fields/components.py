"""What a user may give as a generator or a vector field, as one function (m, t) -> components.

A function psi(m) or psi(m, t) written with numpy functions over leading axes; a list of sympy expressions, texts of
the whitelist grammar or numbers, in the symbols m0, m1, ..., t; or constant components.  All run on arrays, on
exact scalars and on Jets.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np

from liehom.errors import InputError, ShapeError
from liehom.homogeneous.fields.evaluation import Evaluation
from liehom.homogeneous.fields.expression import FUNCTIONS as FUNCTIONS
from liehom.homogeneous.fields.expression import compiled
from liehom.series.arrays import as_values, is_exact, is_jax, is_lazy, is_traced, namespace, zeros
from liehom.series.jet import Jet


@final
class Components:
    """A function (m, t) -> array of shape (..., count), from any of the forms a user may give.

    Parameters
    ----------
    source : callable, array, or sequence of numbers, texts, sympy expressions or parsed texts
        A function is called as f(m), or as f(m, t) if it has a second parameter without a default, or one named t.
        A constant array may have leading axes, which broadcast against those of m.
    size : int
        N, the number of coordinates of m.
    counts : tuple of int
        The numbers of components that are right.
    what : str
        What error messages call it.
    time_dependent : bool, optional
        Whether a function is called with t, where its parameters are not to decide.

    Raises
    ------
    ShapeError
        If the number of components is wrong.
    InputError
        If it is none of the forms; when it is evaluated, if the values are no real numbers.

    Examples
    --------
    >>> import numpy as np
    >>> f = Components(["m0*m1", "sin(t)"], 2, (2,), "psi")
    >>> f(np.array([2.0, 3.0]), 0.0), f.time_dependent
    (array([6., 0.]), True)
    """

    __slots__ = ("_function", "_source", "counts", "size", "time_dependent", "what")

    def __init__(
        self, source: Any, size: int, counts: tuple[int, ...], what: str, time_dependent: bool | None = None
    ) -> None:
        self.size, self.counts, self.what, self._source = size, counts, what, source
        self._function: Callable[[Any, Any], Any]
        if callable(source):
            self._function, self.time_dependent = _called(source, what, time_dependent)
        elif is_jax(source) or (isinstance(source, np.ndarray) and (source.dtype != object or source.ndim != 1)):
            self._function, self.time_dependent = self._constant(source), False
        elif isinstance(source, str | bytes | dict | set | frozenset) or not np.iterable(source):
            raise InputError(
                f"{what} is {source!r}: expected a function of m (and t), or a list of {self._wanted()} components"
            )
        else:
            self._function, self.time_dependent = self._from_list(list(source))

    def __reduce__(self) -> Any:
        # closures over the source cannot be pickled; the source can, if it is no function or has a name in a module
        return Components, (self._source, self.size, self.counts, self.what, self.time_dependent)

    def __call__(self, m: Any, t: Any = 0.0) -> Any:
        """The components at m (..., N) and t (...,): array or Jet of shape (..., count)."""
        if not isinstance(m, Jet):
            m = as_values(m)
            if is_jax(m) or is_jax(t):
                # numpy functions run on Jets over JAX arrays, not on the arrays themselves
                found = self(Jet.constant(namespace(m, t).asarray(m), 0), t)
                return found.value if isinstance(found, Jet) else namespace(m, t).asarray(found)
        return self._checked(self._function(m, t), m)

    def check(self, m: Any, t: Any = 0.0) -> None:
        """Evaluate at starting points, and check that the values are finite and belong to the right trajectory.

        Parameters
        ----------
        m : array of shape (..., N)
        t : float or array of shape (...,)

        Raises
        ------
        ShapeError
            If the values have the wrong shape, or those of one trajectory depend on another one.
        InputError
            If a value is not a finite real number; names the component.

        Examples
        --------
        >>> Components(["1/m0"], 1, (1,), "psi").check(np.array([0.0]))
        Traceback (most recent call last):
        ...
        liehom.errors.InputError: psi[0] is inf at m = [0.], t = 0.0: start where it is defined, ...
        """
        m = as_values(m)
        if m.ndim == 0 or m.shape[-1] != self.size:
            raise ShapeError(f"a point has {self.size} coordinates (on its last axis), got shape {m.shape}")
        if is_exact(m) or is_traced(m) or is_traced(t):
            self(m, t)
            return
        with np.errstate(all="ignore"):
            made = np.asarray(self(m, t))
            bad = np.argwhere(~np.isfinite(made))
            if len(bad):
                index = tuple(int(i) for i in bad[0])
                time = np.broadcast_to(np.asarray(t), m.shape[:-1])[index[:-1]]
                raise InputError(
                    f"{self.what}[{index[-1]}] is {made[index]} at m = {np.asarray(m)[index[:-1]]}, t = {time}"
                    f"{_of_trajectory(index[:-1])}: start where it is defined, or change the field"
                )
            self._check_trajectories(np.asarray(m), t, made)

    def _check_trajectories(self, m: Any, t: Any, made: Any) -> None:
        """Where all others start at the point of one trajectory, its value must be what it was."""
        if m.ndim == 1 or m.size == 0:
            return
        for index in {(0,) * (m.ndim - 1), tuple(n - 1 for n in m.shape[:-1])}:
            alike = np.asarray(self(np.broadcast_to(m[index], m.shape).copy(), t))[index]
            if not np.allclose(alike, made[index], rtol=1e-6, atol=1e-6 * float(np.abs(made[index]).max(initial=0.0))):
                raise ShapeError(
                    f"{self.what} of trajectory {index} depends on the points of other trajectories: coordinates are "
                    "on the last axis of m (write m[..., 0], and np.stack(..., axis=-1))"
                )

    def _checked(self, made: Any, m: Any) -> Any:
        made = joined(made, m)
        if not isinstance(made, Jet):
            made = self._real(made, m)
        shape = made.shape
        if not shape or shape[-1] not in self.counts:
            raise ShapeError(f"{self.what} has shape {shape} at m of shape {m.shape}, expected (..., {self._wanted()})")
        lead = m.shape[:-1]
        if shape[:-1] == lead:
            return made
        try:
            return np.broadcast_to(made, (*lead, shape[-1]))
        except ValueError:
            raise ShapeError(
                f"{self.what} has shape {shape} at m of shape {m.shape}: its leading axes must be those of m "
                "(write m[..., 0], and np.stack(..., axis=-1))"
            ) from None

    def _real(self, made: Any, m: Any) -> Any:
        """An array of real numbers, of the kind of m."""
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
        raise InputError(f"{self.what} returned {found!r} at m of shape {m.shape}, expected an array of real numbers")

    def _wanted(self) -> str:
        return " or ".join(map(str, sorted(set(self.counts))))

    def _constant(self, array: Any) -> Callable[[Any, Any], Any]:
        if not array.shape or array.shape[-1] not in self.counts:
            raise ShapeError(f"{self.what} is an array of shape {array.shape}, expected (..., {self._wanted()})")
        if not is_jax(array) and (array.dtype.kind not in "iuf" or not bool(np.all(np.isfinite(array)))):
            raise InputError(f"{self.what} is {array!r}: expected finite real numbers")
        return lambda m, t: array

    def _from_list(self, parts: Sequence[Any]) -> tuple[Callable[[Any, Any], Any], bool]:
        if len(parts) not in self.counts:
            raise ShapeError(f"{self.what} has {len(parts)} components, expected {self._wanted()}")
        made = [compiled(part, self.size, f"{self.what}[{i}]") for i, part in enumerate(parts)]
        functions = [function for function, _ in made]

        def evaluated(m: Any, t: Any) -> Any:
            at = Evaluation(m, t)
            return _stacked([function(at) for function in functions], m)

        return evaluated, any(timed for _, timed in made)


def takes_time(function: Callable[..., Any]) -> bool:
    """Whether a function takes (m, t) rather than m alone.

    Examples
    --------
    >>> takes_time(lambda m: m), takes_time(lambda m, t: m), takes_time(lambda m, scale=2.0: m)
    (False, True, False)
    """
    return _signature(function)[0]


def _signature(function: Callable[..., Any]) -> tuple[bool, bool, list[str]]:
    """Whether it takes t, whether by keyword only, and which other parameters must be given beyond m."""
    try:
        parameters = list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):
        return False, False, []
    positional = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    needed = [p for p in positional if p.default is p.empty]
    by_name = any(p.kind is p.KEYWORD_ONLY and p.name == "t" for p in parameters)
    second = len(needed) >= 2 or (len(positional) >= 2 and positional[1].name == "t")
    more = [p.name for p in needed[2:]]
    more += [p.name for p in parameters if p.kind is p.KEYWORD_ONLY and p.default is p.empty and p.name != "t"]
    if not positional and not any(p.kind is p.VAR_POSITIONAL for p in parameters):
        more.append("no m")
    return second or by_name, by_name and not second, more


def _called(source: Any, what: str, time_dependent: bool | None) -> tuple[Callable[[Any, Any], Any], bool]:
    """A user's function as a function of (m, t), and whether it depends on t."""
    timed, by_name, more = _signature(source)
    if more:
        raise InputError(
            f"{what} is a function with the parameters {inspect.signature(source)}: expected (m) or (m, t); "
            "bind others with functools.partial or a default"
        )
    timed = timed if time_dependent is None else time_dependent
    if timed and by_name:
        return (lambda m, t: source(m, t=t)), True
    return (source, True) if timed else ((lambda m, t: source(m)), False)


# -- making one array or Jet of what functions return ----------------------------------------------------
def joined(made: Any, m: Any) -> Any:
    """Lists and object arrays that hold Jets, or arrays, as one Jet or array of the kind of m.

    A list or tuple holds the components, each of shape (...,), or the rows of the trajectories.

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


def _arrayed(part: Any) -> Any:
    return part if isinstance(part, Jet) or is_lazy(part) else np.asarray(part)


def _stacked(parts: list[Any], m: Any) -> Any:
    """Components, each a number or of shape (...,), on the last axis; over exact numbers none is a float."""
    lead = m.shape[:-1]
    if any(isinstance(p, Jet) for p in parts):
        spread = [p if np.shape(p) == lead else np.broadcast_to(_arrayed(p), lead) for p in map(_arrayed, parts)]
        return np.stack(spread, axis=-1)
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


def _of_trajectory(index: tuple[int, ...]) -> str:
    return f" (trajectory {index[0] if len(index) == 1 else index})" if index else ""
