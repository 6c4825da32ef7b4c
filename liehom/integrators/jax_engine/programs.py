"""Functions compiled by JAX that are kept: by an engine for its calls, and between engines for equal functions.

A function is traced once.  Its arrays that are not arguments (numbers that psi closes over, tables) become inputs of
the compiled code, so that functions which differ in such numbers alone share it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Hashable, Sequence
from typing import Any, NamedTuple, TypeAlias, final

import numpy as np

from liehom.errors import LiehomError, TraceError
from liehom.integrators.compiled.jax_kernel import options_of
from liehom.tracing.jax_code import JaxArray

Jaxpr: TypeAlias = Any
"""A jaxpr, one of its operations or of their parameters; JAX has no public types for them."""

Leaves: TypeAlias = list[JaxArray]
"""A flat list of JAX arrays."""

Compiled: TypeAlias = Callable[..., Any]
"""A function that jax.jit compiles."""

MAX_SHARED = 64
"""Number of compiled functions that engines share."""
LONG_EQUATIONS = 150
"""Number of operations from which on XLA compiles gradients without its optimizations by LLVM, which take longest."""
_SHARED: dict[tuple[str, Hashable], Any] = {}


@final
class Program(NamedTuple):
    """A traced function.

    Attributes
    ----------
    jaxpr : Jaxpr
        Its operations, with the constants and then the arguments as inputs.
    constants : list of arrays
    digest : str or None
        Equal for equal operations; None if that cannot be told.
    """

    jaxpr: Any
    constants: Leaves
    digest: str | None

    @classmethod
    def of(cls, function: Callable[..., Sequence[JaxArray]], arguments: Leaves) -> Program:
        """The trace of a function of arrays that returns a sequence of arrays.

        Raises
        ------
        TraceError
            If the function does something with values that JAX cannot trace.
        """
        import jax

        try:
            closed = jax.make_jaxpr(function)(*arguments)
        except LiehomError:
            raise
        except (TypeError, AttributeError, ValueError, IndexError, NotImplementedError) as error:
            raise TraceError(
                f"the step cannot be traced by JAX ({type(error).__name__}: {str(error).splitlines()[0]}): write psi "
                "with numpy functions, or take engine='numpy'"
            ) from error
        return cls(closed.jaxpr, list(closed.consts), _digest(closed.jaxpr))

    def __call__(self, constants: Leaves, arguments: Leaves) -> Leaves:
        """The results; JAX traces through this call."""
        import jax

        made: Leaves = jax.core.eval_jaxpr(self.jaxpr, constants, *arguments)
        return made

    def compiled(self, how: str = "nested") -> Callable[[Leaves, Leaves], Leaves]:
        """The function of (constants, arguments) compiled.

        Parameters
        ----------
        how : "nested" or "forward"
            Whether it is called within a transformation of JAX, where options of the compiler are not allowed.
        """
        return _shared(self.digest, how, lambda: self.__call__, options_of(how))

    def pullback(
        self, differentiable: Sequence[bool], *, nested: bool
    ) -> Callable[[Leaves, Leaves, JaxArray], tuple[Leaves, Leaves]]:
        """The compiled function (constants, arguments, cotangent of the first result) -> cotangents of both.

        Parameters
        ----------
        differentiable : sequence of bool
            For each argument whether it is differentiated; cotangents are given for these, and float constants.
        nested : bool
            Whether it is called within a transformation of JAX.
        """
        import jax

        def pulled(constants: Leaves, arguments: Leaves, cotangent: JaxArray) -> tuple[Leaves, Leaves]:
            moving = [is_float(c) for c in constants]

            def first(some: Leaves, others: Leaves) -> JaxArray:
                return self(merged(moving, some, constants), merged(differentiable, others, arguments))[0]

            parts = chosen(moving, constants), chosen(differentiable, arguments)
            found: tuple[Leaves, Leaves] = jax.vjp(first, *parts)[1](cotangent)
            return found

        how = "nested" if nested else "long" if len(_all_equations(self.jaxpr)) > LONG_EQUATIONS else "forward"
        return _shared(self.digest, ("pullback", how, *differentiable), lambda: pulled, options_of(how))


def is_float(x: JaxArray) -> bool:
    """Whether an array has real entries that can be differentiated.

    Examples
    --------
    >>> is_float(np.zeros(2)), is_float(np.zeros(2, dtype=int))
    (True, False)
    """
    return bool(np.issubdtype(x.dtype, np.floating))


def chosen(which: Sequence[bool], values: Leaves) -> Leaves:
    """The values for which a boolean is true.

    Examples
    --------
    >>> chosen([True, False], [1, 2])
    [1]
    """
    return [v for take, v in zip(which, values, strict=True) if take]


def merged(which: Sequence[bool], some: Leaves, values: Leaves) -> Leaves:
    """The values, those for which a boolean is true replaced by `some`.

    Examples
    --------
    >>> merged([True, False], [3], [1, 2])
    [3, 2]
    """
    left = iter(some)
    return [next(left) if take else v for take, v in zip(which, values, strict=True)]


def _shared(digest: str | None, kind: Hashable, make: Callable[[], Compiled], options: dict[str, Any]) -> Compiled:
    """The jitted function of a digest, made if there is none."""
    import jax

    if digest is None:
        alone: Compiled = jax.jit(make(), **options)
        return alone
    key = digest, kind
    if key not in _SHARED:
        if len(_SHARED) >= MAX_SHARED:
            _SHARED.pop(next(iter(_SHARED)))
        _SHARED[key] = jax.jit(make(), **options)
    found: Compiled = _SHARED[key]
    return found


# -- digests ---------------------------------------------------------------------------------------------
class _UnknownError(Exception):
    """An operation has a parameter, such as a Python function, of which equality cannot be told."""


def _digest(jaxpr: Jaxpr) -> str | None:
    """Digest of all operations, numbers and shapes; None if a parameter cannot be compared."""
    try:
        return hashlib.sha256(repr(_rows(jaxpr)).encode()).hexdigest()
    except _UnknownError:
        return None


def _rows(jaxpr: Jaxpr) -> list[Any]:
    names: dict[Any, int] = {}

    def atom(x: Jaxpr) -> Jaxpr:
        if hasattr(x, "val"):
            value = np.asarray(x.val)
            return str(value.dtype), value.shape, value.tobytes(), bool(getattr(x.aval, "weak_type", False))
        return names.setdefault(x, len(names))

    rows: list[Any] = [[(atom(x), str(x.aval)) for x in (*jaxpr.constvars, *jaxpr.invars)]]
    for equation in jaxpr.eqns:
        parameters = [(k, _parameter(v)) for k, v in sorted(equation.params.items())]
        inputs, outputs = [atom(x) for x in equation.invars], [(atom(x), str(x.aval)) for x in equation.outvars]
        rows.append((equation.primitive.name, parameters, inputs, outputs))
    return [*rows, [atom(x) for x in jaxpr.outvars]]


def _parameter(value: Jaxpr) -> Jaxpr:
    if hasattr(value, "jaxpr") and hasattr(value, "consts"):
        if value.consts:
            raise _UnknownError
        return _rows(value.jaxpr)
    if hasattr(value, "eqns"):
        return _rows(value)
    if isinstance(value, tuple | list):
        return [_parameter(x) for x in value]
    if isinstance(value, np.ndarray):
        return str(value.dtype), value.shape, value.tobytes()
    text = repr(value)
    if " at 0x" in text:
        raise _UnknownError
    return text


def _all_equations(jaxpr: Jaxpr) -> list[Any]:
    """All operations, those of loops and branches included."""
    found = []
    for equation in jaxpr.eqns:
        found.append(equation)
        for value in equation.params.values():
            for part in value if isinstance(value, tuple | list) else (value,):
                inner = getattr(part, "jaxpr", part)
                if hasattr(inner, "eqns"):
                    found += _all_equations(inner)
    return found
