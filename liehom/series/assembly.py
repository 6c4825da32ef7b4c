"""One Jet from the nested lists and arrays of objects that generators return, with Jets and numbers as entries.

numpy makes ``np.array([m[0] * m[1], 0.0])`` an array of objects; `as_jet` makes it one Jet again.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from liehom.errors import SeriesError, ShapeError
from liehom.series import recurrences
from liehom.series.arrays import constant_like, is_exact, is_lazy, namespace
from liehom.series.jet import Jet
from liehom.series.jet_dispatch import Operand, dispatch
from liehom.series.node import Node
from liehom.typing import Values

T = TypeVar("T")


def holds_jets(x: object) -> bool:
    """Whether x is a Jet, or a nested list or array of objects with a Jet in it.

    Examples
    --------
    >>> holds_jets([[1.0], [Jet([0.0, 1.0])]]), holds_jets([1.0])
    (True, False)
    """
    if isinstance(x, Jet):
        return True
    if isinstance(x, float | int):
        return False
    if isinstance(x, np.ndarray):
        return x.dtype == object and any(isinstance(entry, Jet) for entry in x.flat)
    return isinstance(x, list | tuple) and any(holds_jets(entry) for entry in x)


def as_jet(x: Operand, order: int | None = None) -> Jet:
    """x as one Jet.

    Parameters
    ----------
    x : Jet, array_like, or nested list or array of objects that holds Jets and numbers
        The entries of a list have one shape, except that numbers stand for constant arrays of that shape.
    order : int, optional
        The order of the result if x holds no Jet.

    Returns
    -------
    Jet
        The entries along the first axes, to the lowest order among the Jets.

    Raises
    ------
    ShapeError
        If the entries of a list do not have one shape.
    SeriesError
        If there is no Jet and no order, or an entry is not a number.

    Examples
    --------
    >>> import numpy as np
    >>> m = Jet([[1.0, 2.0], [3.0, 4.0]])
    >>> as_jet(np.array([m[0] * m[1], 5.0])).coefficients
    array([[ 2.,  5.],
           [10.,  0.]])
    """
    if isinstance(x, Jet):
        return x
    if not holds_jets(x):
        if order is None:
            raise SeriesError("an array without a Jet in it needs an order to become a Jet")
        return Jet.constant(_plain(x), order)
    shape, entries = _flattened(x)
    first = next(entry for entry in entries if isinstance(entry, Jet))
    inner = max((np.shape(entry) for entry in entries), key=len)
    for entry in entries:
        if np.shape(entry) not in ((), inner):
            raise ShapeError(f"entries of shapes {inner} and {np.shape(entry)} do not make one array; see np.stack")

    def stacked(*parts: Values) -> Values:
        xp = namespace(*parts)
        full = [part if np.shape(part) == inner else xp.broadcast_to(part, inner) for part in parts]
        if xp is np and not inner:
            return _array(full, shape)
        found: Values = xp.stack(full).reshape((*shape, *inner))
        return found

    return Jet.from_node(recurrences.linear(stacked, nodes(*entries, like=first)), writable=True)


def _array(parts: list[Values], shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """Numbers as an array of this shape, without numpy looking into them."""
    dtype = np.result_type(*[getattr(part, "dtype", np.dtype(object)) for part in parts])
    out = np.empty(len(parts), dtype=dtype)
    for i, part in enumerate(parts):
        out[i] = part[()] if isinstance(part, np.ndarray) else part
    return out.reshape(shape)


def _plain(x: Operand) -> Operand:
    """x, with a list of JAX arrays stacked by JAX, as numpy would look into their values."""
    if isinstance(x, list | tuple) and any(is_lazy(entry) for entry in x):
        return namespace(*x).stack([namespace(*x).asarray(entry) for entry in x])
    return x


def _flattened(x: Operand) -> tuple[tuple[int, ...], list[Operand]]:
    """(outer shape, entries in order) of a nested list or array of objects."""
    if isinstance(x, np.ndarray):
        return x.shape, list(x.flat)
    parts = [_flattened(entry) if isinstance(entry, list | tuple) else ((), [entry]) for entry in x]
    if len({shape for shape, _ in parts}) != 1:
        raise ShapeError("lists of several lengths do not make one array")
    if all(isinstance(entry, np.ndarray) and entry.dtype == object for entry in x):
        parts = [_flattened(entry) for entry in x]
    return (len(parts), *parts[0][0]), [entry for _, entries in parts for entry in entries]


def nodes(*values: Operand, like: Jet | None = None) -> list[Node]:
    """Nodes of Jets and constants, to the lowest order among the Jets; constants become numbers of the kind of `like`.

    Examples
    --------
    >>> [node.value.tolist() for node in nodes(Jet([1.0, 2.0]), 3)]
    [1.0, 3.0]
    """
    made = [x if type(x) is Jet or not holds_jets(x) else as_jet(x) for x in values]
    found = [x.node for x in made if type(x) is Jet]
    if len(found) == len(made):
        return found
    order = min(node.order for node in found)
    kind = found[0].value if like is None else like.node.value
    kind = next((node.value for node in found if is_exact(np.asarray(node.value))), kind) if not is_lazy(kind) else kind
    return [x.node if type(x) is Jet else recurrences.constant(constant_like(kind, x), order) for x in made]


def on_series(function: Callable[..., T], *arguments: object) -> T:
    """The value ``function(*arguments)``; if numpy fails because of a Jet in a float array, `SeriesError` says so.

    Writing a Jet into an entry of a float array ends in numpy's "setting an array element with a sequence".

    Raises
    ------
    SeriesError
        If that happens, or if an operation on a Jet raises it.

    Examples
    --------
    >>> on_series(lambda m: 2 * m, Jet([1.0, 1.0])).coefficients
    array([2., 2.])
    """
    try:
        return function(*arguments)
    except (ValueError, TypeError) as error:
        reason: BaseException | None = error
        while reason is not None and not isinstance(reason, SeriesError):
            reason = reason.__cause__
        if reason is None or reason is error:
            raise
        raise SeriesError(str(reason)) from error


dispatch.nodes = nodes
