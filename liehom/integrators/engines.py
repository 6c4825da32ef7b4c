"""Engines by name, and the former name of the option for them."""

from __future__ import annotations

import warnings
from collections.abc import Callable

from liehom.errors import InputError, displayed
from liehom.integrators.compiled.llvm_engine import LlvmEngine
from liehom.integrators.engine import Engine, NumpyEngine
from liehom.integrators.jax_engine import JaxEngine

ENGINES: dict[str, Callable[[], Engine]] = {"numpy": NumpyEngine, "llvm": LlvmEngine, "jax": JaxEngine}


def engine_of(engine: str | Engine) -> Engine:
    """A new engine by its name, or the engine itself.

    Raises
    ------
    InputError
        If the name is unknown.

    Examples
    --------
    >>> engine_of("numpy").name
    'numpy'
    """
    hint = ""
    if isinstance(engine, str):
        if engine in ENGINES:
            return ENGINES[engine]()
        hint = '; what was called "numba" is "llvm" (it needs llvmlite only)' if engine == "numba" else ""
    elif callable(getattr(engine, "solve", None)) and isinstance(getattr(engine, "name", None), str):
        return engine
    raise InputError(f"engine is {displayed(engine)}, expected one of {', '.join(map(repr, ENGINES))}{hint}")


def engine_option(engine: str | Engine, compile: str | None, *, stacklevel: int) -> str | Engine:
    """The option `engine`, by its former name `compile` if that was given, which is deprecated.

    Parameters
    ----------
    engine, compile
        As for `integrate`.
    stacklevel : int
        That of `warnings.warn`.

    Examples
    --------
    >>> engine_option("llvm", None, stacklevel=2)
    'llvm'
    """
    if compile is None:
        return engine
    if engine != "numpy":
        raise InputError(
            f"engine={displayed(engine)} and compile={displayed(compile)} are one option: leave out compile"
        )
    engine_of(compile)
    warnings.warn(
        f"compile= is called engine= now: write engine={compile!r}", DeprecationWarning, stacklevel=stacklevel
    )
    return compile
