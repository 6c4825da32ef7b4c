"""Table of the functions that `Jet` calls for numpy's protocols and the methods of arrays.

These functions are written in terms of Jets.  Their modules (`assembly`, `jet_ufuncs`, `jet_functions`) therefore
import `jet`, and enter the functions here when `liehom.series` is loaded; `jet` imports only this module.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias, final

from liehom.series.node import Node

Operand: TypeAlias = Any
"""A Jet, an array, a number, or a nested list or array of objects that holds Jets."""


WITHOUT_SERIES = (
    "a Runge-Kutta step such as liehom.RKMK('rk45') calls the generator on points only, and runs it as it is"
)
"""Remedy of messages about generators that cannot be expanded."""


@final
class Dispatch:
    """Functions that implement methods of `Jet`.

    Attributes
    ----------
    nodes : callable
        `liehom.series.assembly.nodes`.
    apply_ufunc : callable
        `liehom.series.jet_ufuncs.apply_ufunc`, for ``__array_ufunc__``.
    apply_function : callable
        `liehom.series.jet_functions.apply_function`, for ``__array_function__``.
    method : callable
        `liehom.series.jet_functions.method`, for methods of arrays that the class does not define.
    """

    __slots__ = ("apply_function", "apply_ufunc", "method", "nodes")

    nodes: Callable[..., list[Node]]
    apply_ufunc: Callable[[Any, str, tuple[Any, ...], dict[str, Any]], Any]
    apply_function: Callable[[Any, tuple[Any, ...], dict[str, Any]], Any]
    method: Callable[[Any, str], Any]


dispatch: Dispatch = Dispatch()
