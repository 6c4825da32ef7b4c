"""What a user may give as a generator or a vector field, as one function (m, t) -> components.

A function psi(m) or psi(m, t) written with numpy functions over leading axes; a list of sympy expressions, texts of
the whitelist grammar or numbers, in the symbols m0, m1, ..., t; or constant components.  All run on arrays, on
exact scalars and on Jets.  Imports series, scalars, errors.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np

from liehom.errors import InputError, ShapeError
from liehom.scalars.grammar import Call, Name, Node, Number, Operation, evaluate, parse
from liehom.series.arrays import elementary, is_exact, is_jax, namespace
from liehom.series.jet import Jet

FUNCTIONS = ("sqrt", "sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh")
_TREES = (Number, Name, Call, Operation)


@final
class Components:
    """A function (m, t) -> array of shape (..., count), from any of the forms a user may give.

    Parameters
    ----------
    source : callable, or sequence of numbers, texts, sympy expressions or parsed texts
    size : int
        N, the number of coordinates of m.
    counts : tuple of int
        The numbers of components that are right.
    what : str
        What error messages call it.

    Raises
    ------
    ShapeError
        If the number of components is wrong.
    InputError
        If it is none of the forms.

    Examples
    --------
    >>> import numpy as np
    >>> f = Components(["m0*m1", "sin(t)"], 2, (2,), "psi")
    >>> f(np.array([2.0, 3.0]), 0.0), f.time_dependent
    (array([6., 0.]), True)
    """

    __slots__ = ("_function", "counts", "size", "time_dependent", "what")

    def __init__(self, source: Any, size: int, counts: tuple[int, ...], what: str) -> None:
        self.size, self.counts, self.what = size, counts, what
        if callable(source):
            self.time_dependent = takes_time(source)
            self._function: Callable[..., Any] = source
        elif isinstance(source, str | bytes) or not hasattr(source, "__iter__"):
            raise InputError(f"{what} is {source!r}: expected a function of m (and t), or a list of components")
        else:
            self._function, self.time_dependent = self._from_list(list(source))

    def __call__(self, m: Any, t: Any = 0.0) -> Any:
        """The components at m (..., N) and t (...,): array or Jet of shape (..., count)."""
        if is_jax(m) or is_jax(t):
            # numpy functions run on Jets over JAX arrays, not on the arrays themselves
            found = self(Jet.constant(m, 0), t)
            return found.value if isinstance(found, Jet) else namespace(m, t).asarray(found)
        made = self._function(m, t) if self.time_dependent else self._function(m)
        return self._normal(made, m)

    def _normal(self, made: Any, m: Any) -> Any:
        made = joined(made, m)
        if made.ndim == 0 or made.shape[-1] not in self.counts:
            wanted = " or ".join(map(str, sorted(set(self.counts))))
            raise ShapeError(f"{self.what} has shape {made.shape} at m of shape {m.shape}, expected (..., {wanted})")
        shape = (*m.shape[:-1], made.shape[-1])
        if made.shape == shape:
            return made
        try:
            return np.broadcast_to(made, shape)
        except ValueError:
            raise ShapeError(
                f"{self.what} has shape {made.shape} at m of shape {m.shape}: its leading axes must be those of m "
                "(write m[..., 0], and np.stack(..., axis=-1))"
            ) from None

    def _from_list(self, parts: Sequence[Any]) -> tuple[Callable[..., Any], bool]:
        if len(parts) not in self.counts:
            wanted = " or ".join(map(str, sorted(set(self.counts))))
            raise ShapeError(f"{self.what} has {len(parts)} components, expected {wanted}")
        made = [_component(part, self.size, f"{self.what}[{i}]") for i, part in enumerate(parts)]

        def function(m: Any, t: Any = 0.0) -> Any:
            lead = m[..., 0]
            return joined([f(m, t) + 0 * lead for f, _ in made], m, axis=-1)

        if any(timed for _, timed in made):
            return (lambda m, t: function(m, t)), True
        return (lambda m: function(m)), False


def takes_time(function: Callable[..., Any]) -> bool:
    """Whether a function takes (m, t) rather than m alone.

    Examples
    --------
    >>> takes_time(lambda m: m), takes_time(lambda m, t: m), takes_time(lambda m, scale=2.0: m)
    (False, True, False)
    """
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return False
    positional = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    needed = [p for p in positional if p.default is p.empty]
    return len(needed) >= 2 or (len(positional) >= 2 and positional[1].name == "t")


def joined(made: Any, m: Any, axis: int = 0) -> Any:
    """Lists and object arrays that hold Jets, or arrays, as one Jet or array of the kind of m.

    Examples
    --------
    >>> import numpy as np
    >>> joined([1.0, np.float64(2)], np.zeros(2))
    array([1., 2.])
    """
    if isinstance(made, Jet) or is_jax(made):
        return made
    if isinstance(made, np.ndarray) and (made.dtype != object or not any(isinstance(x, Jet) for x in made.flat)):
        return made
    if isinstance(made, np.ndarray | list | tuple):
        parts = [joined(part, m) for part in made]
        shape = np.broadcast_shapes(*[np.shape(p.value) if isinstance(p, Jet) else np.shape(p) for p in parts])
        if any(isinstance(p, Jet) for p in parts):
            spread = [p if p.shape == shape else np.broadcast_to(p, shape) for p in map(_arrayed, parts)]
            return np.stack(spread, axis=axis)
        xp = namespace(*parts)
        return xp.stack([xp.broadcast_to(xp.asarray(p), shape) for p in parts], axis=axis)
    return np.asarray(made)


def _arrayed(part: Any) -> Any:
    return part if isinstance(part, Jet) or hasattr(part, "shape") else np.asarray(part)


# -- components as texts and expressions -----------------------------------------------------------------
def _component(part: Any, size: int, what: str) -> tuple[Callable[[Any, Any], Any], bool]:
    """One component as a function of (m, t), and whether it depends on t."""
    if isinstance(part, str):
        part = parse(part, frozenset([*(f"m{i}" for i in range(size)), "t"]), FUNCTIONS)
    if isinstance(part, _TREES):
        tree = part
        return (lambda m, t: _evaluated(tree, m, t)), _mentions_time(tree)
    if hasattr(part, "free_symbols"):
        return _sympy_component(part, size, what)
    try:
        number = float(part)
    except (TypeError, ValueError):
        raise InputError(f"{what} is {part!r}: expected a number, a text or a sympy expression") from None
    exact = int(number) if number == int(number) else part
    return (lambda m, t: exact), False


def _sympy_component(part: Any, size: int, what: str) -> tuple[Callable[[Any, Any], Any], bool]:
    names = frozenset([*(f"m{i}" for i in range(size)), "t"])
    unknown = sorted(str(s) for s in part.free_symbols if str(s) not in names)
    if unknown:
        raise InputError(f"{what} has the symbols {', '.join(unknown)}; known are m0 ... m{size - 1} and t")
    timed = any(str(s) == "t" for s in part.free_symbols)
    try:
        tree = parse(str(part), names, FUNCTIONS)
    except InputError:
        return _compiled(part, size), timed
    return (lambda m, t: _evaluated(tree, m, t)), timed


def _compiled(part: Any, size: int) -> Callable[[Any, Any], Any]:
    """What the grammar does not know (pi, fractional powers, atan, ...) as numpy code made by sympy."""
    import sympy

    by_name = {str(s): s for s in part.free_symbols}
    symbols = [by_name.get(f"m{i}", sympy.Symbol(f"m{i}")) for i in range(size)]
    function = sympy.lambdify([*symbols, by_name.get("t", sympy.Symbol("t"))], part, modules="numpy", cse=True)
    return lambda m, t: function(*[m[..., i] for i in range(size)], t)


def _evaluated(tree: Node, m: Any, t: Any) -> Any:
    value = m.value if isinstance(m, Jet) else m
    exact = is_exact(value)
    zero = 0 * value.flat[0] if exact else 0.0
    names = _Coordinates(m, t)
    return evaluate(tree, lambda n: zero + int(n), names, {name: _function(name) for name in FUNCTIONS})  # type: ignore[arg-type]


class _Coordinates(dict[str, Any]):
    """m0, m1, ... and t, sliced from m when they are asked for."""

    def __init__(self, m: Any, t: Any) -> None:
        super().__init__(t=t)
        self._m = m

    def __missing__(self, name: str) -> Any:
        self[name] = self._m[..., int(name[1:])]
        return self[name]


def _function(name: str) -> Callable[[Any], Any]:
    return lambda x: getattr(np, name)(x) if isinstance(x, Jet) else elementary(name, x)


def _mentions_time(tree: Node) -> bool:
    match tree:
        case Name(name):
            return name == "t"
        case Call(_, argument):
            return _mentions_time(argument)
        case Operation(_, operands):
            return any(_mentions_time(o) for o in operands)
    return False
