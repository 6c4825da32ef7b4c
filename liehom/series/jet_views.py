"""Assignment into Jets: entries are replaced by new series, so results computed before do not change.

Entries of a Jet may be assigned if numpy would return a new array in its place.  Its slices and transposes are views:
they show what is assigned to it later, and assignment into a slice assigns to it, as for numpy arrays.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from liehom.errors import SeriesError
from liehom.series import recurrences
from liehom.series.arrays import is_jax, is_lazy, namespace
from liehom.series.node import Node
from liehom.typing import Key, Values


class ViewOperation(NamedTuple):
    """One step from an array to a view of it: a linear function, and its index if it is indexing."""

    function: Callable[[Any], Values]
    key: Key
    writable: bool


class View(NamedTuple):
    """The origin of a view: the Jet that owns the entries, the operations from it, its node when last seen."""

    owner: Any
    operations: tuple[ViewOperation, ...]
    seen: Node


def frozen(x: Any) -> Any:
    """Copy of an index or option, as the caller may change it later.

    Examples
    --------
    >>> mask = [True, False]
    >>> frozen((mask, 0))
    ([True, False], 0)
    """
    if isinstance(x, np.ndarray):
        return x.copy()
    if isinstance(x, list):
        return [frozen(entry) for entry in x]
    return tuple(frozen(entry) for entry in x) if type(x) is tuple else x


def checked_index(key: Key, x: Values) -> Key:
    """Copy of an index of the array x, with lists as arrays, checked against the shape (JAX would clip it).

    Raises
    ------
    IndexError
        As from numpy.

    Examples
    --------
    >>> checked_index((0, [1]), np.zeros((2, 2)))
    (0, array([1]))
    """
    if isinstance(key, tuple):
        key = tuple(_copied_index(part) for part in key)
    else:
        key = _copied_index(key)
    parts = key if isinstance(key, tuple) else (key,)
    if is_jax(x) and not any(is_jax(part) for part in parts):
        np.broadcast_to(np.zeros(()), x.shape)[key]
    return key


def _copied_index(part: Key) -> Key:
    if isinstance(part, list):
        return np.array(part, dtype=None if part else int)
    return part.copy() if isinstance(part, np.ndarray) else part


def kind_of_index(key: Key, ndim: int) -> str:
    """The result of indexing an array with `ndim` axes in numpy: "number", "view" or "copy".

    Examples
    --------
    >>> kind_of_index((0, slice(None)), 2), kind_of_index(0, 1), kind_of_index(0, 2), kind_of_index([0, 1], 1)
    ('view', 'number', 'view', 'copy')
    """
    parts = key if isinstance(key, tuple) else (key,)
    whole = [part for part in parts if isinstance(part, int | np.integer) and not isinstance(part, bool)]
    slices = [part for part in parts if part is Ellipsis or part is None or isinstance(part, slice)]
    if len(whole) + len(slices) < len(parts):
        return "copy"
    return "number" if not slices and len(whole) == ndim else "view"


def followed(view: View) -> list[Node]:
    """Current nodes of the owner, of the views in between, and of the view itself."""
    nodes = [view.owner.node]
    for operation in view.operations:
        nodes.append(recurrences.linear(operation.function, [nodes[-1]]))
    return nodes


def written(view: View, key: Key, value: Node) -> Node:
    """Node of the owner after assignment of `value` to the view at `key`."""
    nodes = followed(view)
    new = replaced(nodes[-1], key, value)
    for operation, below in zip(reversed(view.operations), reversed(nodes[:-1]), strict=True):
        if not operation.writable:
            raise SeriesError("this series is a transposed or reshaped view of another one: write into that one")
        new = replaced(below, operation.key, new)
    return new


def replaced(whole: Node, key: Key, part: Node) -> Node:
    """Node of the series with the entries at `key` replaced by those of `part`."""
    return recurrences.linear(lambda x, y: _replaced(x, key, y), [whole, part])


def _replaced(whole: Values, key: Key, part: Values) -> Values:
    if is_jax(whole) or is_jax(part):
        xp = namespace(whole, part)
        found: Values = xp.asarray(whole, dtype=xp.result_type(whole, part)).at[key].set(part)
        return found
    if is_lazy(whole) or is_lazy(part):
        made = (whole + 0.0 * part if is_lazy(part) and not is_lazy(whole) else whole).copy()
        made[key] = part
        found = made
        return found
    out = np.array(whole, dtype=np.result_type(whole, part))
    out[key] = part
    return out
