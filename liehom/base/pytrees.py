"""Pytrees: numbers and arrays in nested containers, the arguments `args` of a generator psi(m, t, args).

The containers are dicts, lists, tuples, named tuples, dataclasses and None; where JAX is loaded, also those that are
registered as pytrees there. The rest are leaves.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, MutableMapping
from copy import copy
from dataclasses import fields, is_dataclass
from typing import Any, NamedTuple, TypeVar, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.objects import refuse_masked
from liehom.base.typing import Pytree

T = TypeVar("T")

NUMBERS = "biuf"  # Kinds of numpy types that leaves may have


@final
class PerTrajectory:
    """A leaf of args with one slice per trajectory of an ensemble.

    Parameters
    ----------
    value : array_like of shape (..., *shape)
        Its leading axes are those of the ensemble. Where all trajectories are stepped at once, psi gets the array, and
        where one is traced, its slice. So it is used like t: a number for each trajectory, of shape (...,), multiplies
        a point as ``value[..., None] * m``. With one initial point, its first axis is that of the ensemble.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), lambda m, t, args: args["rate"][..., None])
    >>> args = {"rate": lh.PerTrajectory([0.5, 1.0])}
    >>> ends = lh.integrate(field, (0, np.pi), [1, 0], args=args, dt=0.1).y[..., -1]
    >>> np.round(ends, 8) + 0.0
    array([[ 0.,  1.],
           [-1.,  0.]])
    """

    __slots__ = ("value",)

    def __init__(self, value: npt.ArrayLike) -> None:
        self.value: Any = value if hasattr(value, "dtype") else np.asarray(value)
        if self.value.dtype.kind not in NUMBERS:
            raise InputError(f"PerTrajectory takes an array of real numbers, got {displayed(value)}")

    def rows(self, index: object) -> PerTrajectory:
        """The slices of some trajectories."""
        return PerTrajectory(self.value[index])

    def __repr__(self) -> str:
        return f"PerTrajectory(shape={tuple(self.value.shape)})"


class Leaf(NamedTuple):
    """A leaf of a pytree, and where it is, such as ``args['inertia'][0]``."""

    path: str
    value: Any


def mapped(tree: T, function: Callable[[Leaf], object], path: str = "args") -> T:
    """A pytree of the same structure, with the values of a function of its leaves."""
    return _mapped(tree, function, path)


def _mapped(tree: Pytree, function: Callable[[Leaf], object], path: str) -> Pytree:
    if tree is None:
        return None
    if isinstance(tree, Mapping):
        items = {key: _mapped(x, function, f"{path}[{key!r}]") for key, x in tree.items()}
        return items if type(tree) is dict or not isinstance(tree, MutableMapping) else _updated(tree, items)
    if isinstance(tree, tuple) and hasattr(tree, "_fields"):
        return type(tree)(*(_mapped(getattr(tree, name), function, f"{path}.{name}") for name in tree._fields))
    if isinstance(tree, list | tuple):
        return type(tree)(_mapped(x, function, f"{path}[{i}]") for i, x in enumerate(tree))
    jax = sys.modules.get("jax")
    if jax is not None and not isinstance(tree, PerTrajectory) and not jax.tree_util.all_leaves([tree]):
        # one level of a container that is registered there
        inner, structure = jax.tree_util.tree_flatten_with_path(tree, is_leaf=lambda x: x is not tree)
        return structure.unflatten([_mapped(x, function, path + jax.tree_util.keystr(at)) for at, x in inner])
    if is_dataclass(tree) and not isinstance(tree, type):
        changed = copy(tree)  # without its constructor, which may check its arguments
        for entry in fields(tree):
            object.__setattr__(
                changed, entry.name, _mapped(getattr(tree, entry.name), function, f"{path}.{entry.name}")
            )
        return changed
    return function(Leaf(path, tree))


def _updated(tree: MutableMapping[Any, Any], values: dict[Any, Any]) -> MutableMapping[Any, Any]:
    updated = copy(tree)
    updated.update(values)
    return updated


def leaves(tree: Pytree, path: str = "args") -> list[Leaf]:
    """The leaves of a pytree, in the order of its containers."""
    if type(tree) is dict:
        return [leaf for key, x in tree.items() for leaf in leaves(x, f"{path}[{key!r}]")]
    if type(tree) in (float, np.ndarray):
        return [Leaf(path, tree)]
    leaves_: list[Leaf] = []
    mapped(tree, leaves_.append, path)
    return leaves_


def unwrapped(tree: T) -> T:
    """The pytree with arrays in place of `PerTrajectory`."""
    return mapped(tree, lambda leaf: leaf.value.value if isinstance(leaf.value, PerTrajectory) else leaf.value)


def numbers_of(tree: Pytree) -> list[npt.NDArray[Any]]:
    """The leaves as numpy arrays."""
    return [np.asarray(leaf.value) for leaf in leaves(unwrapped(tree))]


def check_numbers(tree: Pytree, lead: tuple[int, ...]) -> None:
    """Check that the leaves are real numbers or arrays of them."""
    for path, leaf in leaves(tree):
        value = leaf.value if isinstance(leaf, PerTrajectory) else leaf
        refuse_masked(path, value)
        kind = getattr(getattr(value, "dtype", None), "kind", "O")
        if isinstance(value, bool | int | float):
            continue
        if kind not in NUMBERS:
            raise InputError(f"{path} is {displayed(value)}, expected a real number or an array: let psi close over it")
        if isinstance(leaf, PerTrajectory) and tuple(value.shape[: len(lead)]) != lead:
            raise ShapeError(
                f"{path} has shape {tuple(value.shape)}, but its leading axes must be those of the ensemble, {lead}"
            )
