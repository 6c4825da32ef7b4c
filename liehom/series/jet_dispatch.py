"""What numpy's protocols, and the methods of arrays, do with Jets: the functions that the class `Jet` calls.

They are written in terms of Jets, so they stand above the class (`assembly`, `jet_ufuncs`, `jet_functions`) and enter
themselves here when `liehom.series` is loaded.  The class imports this module only.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias, final

from liehom.series.node import Node

Operand: TypeAlias = Any
"""A Jet, an array, a number, or a nested list or array of objects that holds Jets."""


@final
class Dispatch:
    """The functions behind the methods of `Jet`.

    Attributes
    ----------
    nodes : callable
        `liehom.series.assembly.nodes`.
    apply_ufunc : callable
        `liehom.series.jet_ufuncs.apply_ufunc`, for ``__array_ufunc__``.
    apply_function : callable
        `liehom.series.jet_functions.apply_function`, for ``__array_function__``.
    method : callable
        `liehom.series.jet_functions.method`, for methods that the class does not have.
    """

    __slots__ = ("apply_function", "apply_ufunc", "method", "nodes")

    nodes: Callable[..., list[Node]]
    apply_ufunc: Callable[[Any, str, tuple[Any, ...], dict[str, Any]], Any]
    apply_function: Callable[[Any, tuple[Any, ...], dict[str, Any]], Any]
    method: Callable[[Any, str], Any]


dispatch: Dispatch = Dispatch()
