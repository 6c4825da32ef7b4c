"""Rooted trees and the order conditions of Runge-Kutta methods.

A method (a, b) has order p if and only if, for every rooted tree t with at most p vertices (J. C. Butcher,
Numerical Methods for Ordinary Differential Equations, section 31),

    Phi(t) = sum_i b_i s_i(t) = 1/gamma(t),    s(single vertex) = 1,    s([t1, ..., tk]) = prod_j a s(tj),

products entry by entry.  gamma is the density: gamma([t1, ..., tk]) = (number of vertices) prod_j gamma(tj).
Every tree except the vertex arises in exactly one way by grafting its last subtree v to the root of the rest u, so that
s(u with v) = s(u) * (a s(v)). This is one product of whole arrays per number of vertices, over exact scalars as over
floats.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from math import prod
from typing import Any, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, ShapeError

MethodArray: TypeAlias = npt.ArrayLike | Sequence[Any]
"""Coefficients of a method: floats or exact scalars, in lists or arrays."""

MAX_ORDER = 14
"""The largest number of vertices of a tree: there are 32973 trees with 14 vertices, 53272 with at most 14."""


@final
@dataclass(frozen=True)
class RootedTree:
    """A rooted tree, written as the bracket of the subtrees at its root; the single vertex is ``RootedTree()``.

    Parameters
    ----------
    children : tuple of RootedTree
        The subtrees at the root. Their order does not matter for the tree, but it does for ``==``; `rooted_trees`
        returns each tree in one order only.

    Examples
    --------
    >>> vertex = RootedTree()
    >>> cherry = RootedTree((vertex, vertex))
    >>> print(RootedTree((cherry,)), RootedTree((cherry,)).order, RootedTree((cherry,)).density)
    [[τ, τ]] 4 12
    """

    children: tuple[RootedTree, ...] = ()

    @cached_property
    def order(self) -> int:
        """The number of vertices."""
        return 1 + sum(child.order for child in self.children)

    @cached_property
    def density(self) -> int:
        """gamma(t): the product, over the vertices, of the number of vertices from there upward."""
        return self.order * prod(child.density for child in self.children)

    def __str__(self) -> str:
        return f"[{', '.join(map(str, self.children))}]" if self.children else "τ"

    def __repr__(self) -> str:
        return f"<rooted tree {self} of order {self.order}>"


@dataclass(frozen=True, slots=True)
class _Level:
    """All trees of one order: tree `start + i` is tree `left[i]` with tree `right[i]` grafted to its root."""

    start: int
    left: npt.NDArray[np.int64]
    right: npt.NDArray[np.int64]
    density: npt.NDArray[np.int64]

    @property
    def count(self) -> int:
        return len(self.left)


@cache
def _level(order: int) -> _Level:
    """All trees of one order, each once, because a grafted tree is not later in the list than those grafted before."""
    if order == 1:
        anything_may_follow = np.array([np.iinfo(np.int64).max])
        return _Level(0, np.array([-1]), anything_may_follow, np.array([1]))
    below = _level(order - 1)
    left, right, density = [], [], []
    for grafted in range(1, order):
        u, v = _level(order - grafted), _level(grafted)
        i, j = np.nonzero(v.start + np.arange(v.count) <= u.right[:, None])
        left.append(u.start + i)
        right.append(v.start + j)
        density.append(u.density[i] // (order - grafted) * v.density[j] * order)
    return _Level(below.start + below.count, np.concatenate(left), np.concatenate(right), np.concatenate(density))


@cache
def _tree(index: int) -> RootedTree:
    """The tree at an index in the list of all trees, sorted by order."""
    level, order = _level(1), 1
    while index >= level.start + level.count:
        order += 1
        level = _level(order)
    if index == 0:
        return RootedTree()
    left, right = int(level.left[index - level.start]), int(level.right[index - level.start])
    return RootedTree((*_tree(left).children, _tree(right)))


def checked_order(order: object, what: str = "order") -> int:
    """The order as an int between 1 and `MAX_ORDER`.

    Raises
    ------
    InputError
        If it is anything else.

    Examples
    --------
    >>> checked_order(4)
    4
    """
    if isinstance(order, bool) or not isinstance(order, int | np.integer) or not 1 <= order <= MAX_ORDER:
        raise InputError(f"the {what} is an integer from 1 to {MAX_ORDER}, got {order!r}")
    return int(order)


def rooted_trees(order: int) -> tuple[RootedTree, ...]:
    """All rooted trees with `order` vertices, each once, in the order in which violations are looked for.

    Raises
    ------
    InputError
        If the order is not an integer from 1 to `MAX_ORDER`.

    Examples
    --------
    >>> [str(tree) for tree in rooted_trees(4)]
    ['[τ, τ, τ]', '[[τ], τ]', '[[τ, τ]]', '[[[τ]]]']
    >>> [len(rooted_trees(n)) for n in range(1, 9)]
    [1, 1, 2, 4, 9, 20, 48, 115]
    """
    level = _level(checked_order(order))
    return tuple(_tree(level.start + i) for i in range(level.count))


def densities(order: int) -> npt.NDArray[np.int64]:
    """gamma of all trees with `order` vertices, in the order of `rooted_trees`, shape (count,).

    Examples
    --------
    >>> densities(4).tolist()
    [4, 8, 12, 24]
    """
    return _level(checked_order(order)).density


def _arrays(a: MethodArray, b: MethodArray) -> tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any]]:
    """(a, b, ones) as numpy arrays that can be multiplied; exact scalars stay objects."""
    matrix, weights = np.asarray(a), np.asarray(b)
    stages = weights.shape[0] if weights.ndim == 1 else 0
    if not stages or matrix.shape != (stages, stages):
        raise ShapeError(f"a method has a of shape (s, s) and b of shape (s,), got {matrix.shape} and {weights.shape}")
    exact = object in (matrix.dtype, weights.dtype)
    return matrix, weights, np.ones(stages, dtype=object if exact else np.result_type(matrix, weights))


def elementary_weight(tree: RootedTree, a: MethodArray, b: MethodArray) -> Any:
    """Phi(t), the weight of a tree in a method, a number; its weight in the exact solution is 1/gamma(t).

    Parameters
    ----------
    tree : RootedTree
    a, b : array-like, shapes (s, s) and (s,)
        Floats, or exact scalars (``Fraction``, field elements) as lists or numpy arrays of objects.

    Raises
    ------
    ShapeError
        If a is not a square matrix or b has another length.

    Examples
    --------
    >>> from fractions import Fraction
    >>> heun = [[0, 0], [1, 0]], [Fraction(1, 2), Fraction(1, 2)]
    >>> [elementary_weight(tree, *heun) for n in (1, 2, 3) for tree in rooted_trees(n)]
    [Fraction(1, 1), Fraction(1, 2), Fraction(1, 2), Fraction(0, 1)]
    """
    matrix, weights, ones = _arrays(a, b)

    def stages(t: RootedTree) -> npt.NDArray[Any]:
        values = ones
        for child in t.children:
            values = values * (matrix @ stages(child))
        return values

    return weights @ stages(tree)


def elementary_weights(a: MethodArray, b: MethodArray) -> Iterator[npt.NDArray[Any]]:
    """Iterator over the arrays of Phi(t) for the trees of order 1, of order 2, and so on through `MAX_ORDER`.

    Parameters
    ----------
    a, b : array-like, shapes (s, s) and (s,)
        As in `elementary_weight`.

    Yields
    ------
    ndarray (count,)
        The weights of ``rooted_trees(n)``; those of order n + 1 are computed when they are asked for.

    Raises
    ------
    ShapeError
        If a is not a square matrix or b has another length.

    Examples
    --------
    >>> midpoint = [[0, 0], [0.5, 0]], [0.0, 1.0]
    >>> by_order = elementary_weights(*midpoint)
    >>> next(by_order), next(by_order), next(by_order)
    (array([1.]), array([0.5]), array([0.25, 0.  ]))
    """
    matrix, weights, ones = _arrays(a, b)
    return _weights_by_order(matrix, weights, ones)


def _weights_by_order(
    matrix: npt.NDArray[Any], weights: npt.NDArray[Any], ones: npt.NDArray[Any]
) -> Iterator[npt.NDArray[Any]]:
    stages = ones[None, :]  # s(t), one row per tree
    grafts = stages[:0]  # a s(t), likewise
    fresh = stages
    yield fresh @ weights
    for order in range(2, MAX_ORDER + 1):
        grafts = np.concatenate([grafts, fresh @ matrix.T])
        level = _level(order)
        fresh = stages[level.left] * grafts[level.right]
        stages = np.concatenate([stages, fresh])
        yield fresh @ weights
