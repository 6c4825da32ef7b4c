"""Root systems of Cartan matrices of finite type, in coordinates of the simple roots.

A root is a tuple of integers, alpha = sum_i alpha[i] alpha_i. Positive roots are found height by height. For a
positive root beta, beta + alpha_i is a root if and only if p > <beta, alpha_i^vee>, where beta - p alpha_i is the
last root of the string through beta.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from math import prod
from typing import TYPE_CHECKING, final

import numpy as np
import numpy.typing as npt

from liehom.algebra.roots.dynkin import CartanMatrix, cartan_matrix, diagram_components, dynkin_diagram, join_types
from liehom.budget import within
from liehom.display import Displayed
from liehom.errors import InputError, ShapeError

if TYPE_CHECKING:
    import networkx

Root = tuple[int, ...]


@final
@dataclass(frozen=True, slots=True)
class RootSystem(Displayed):
    """The reduced root system with a given Cartan matrix.

    Parameters
    ----------
    cartan : (r, r) integers
        ``a[i][j] = <alpha_i, alpha_j^vee> = 2 (alpha_i, alpha_j) / (alpha_j, alpha_j)``, of finite type; stored
        as a tuple of tuples.

    Attributes
    ----------
    cartan : tuple of tuples of int
    positive_roots : tuple of tuples of int
        Sorted by height, and for one height in reverse lexicographic order. So the simple roots come first, in order.
    norms : tuple of int
        (alpha_i, alpha_i), normalized to 2 for the short roots of each component, so the values are 2, 4 and 6.

    Raises
    ------
    ShapeError
        If the matrix is not square.
    InputError
        If it is not a Cartan matrix of finite type.

    Notes
    -----
    Roots, weights and linear forms are tuples of integers. No floating-point numbers are used.

    Examples
    --------
    >>> import liehom as lh
    >>> g2 = lh.root_system("G2")
    >>> g2.positive_roots
    ((1, 0), (0, 1), (1, 1), (2, 1), (3, 1), (3, 2))
    >>> g2.weyl_group_order(), g2.pairing((0, 1), (1, 0))
    (12, -3)
    """

    cartan: CartanMatrix
    positive_roots: tuple[Root, ...] = field(init=False, repr=False, compare=False)
    norms: tuple[int, ...] = field(init=False, repr=False, compare=False)
    _index: dict[Root, int] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        matrix = _checked(self.cartan)
        norms = _norms(matrix)
        _require_finite(matrix, norms)
        positive = _positive_roots(matrix)
        signed = [*positive, *(_negative(root) for root in positive)]
        for name, value in (("cartan", matrix), ("norms", norms), ("positive_roots", positive)):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "_index", {root: i for i, root in enumerate(signed)})

    # -- properties --------------------------------------------------------------------------------------
    @property
    def rank(self) -> int:
        """The number of simple roots, an int."""
        return len(self.cartan)

    @property
    def type(self) -> str:
        """The type as a string, such as 'B2' or 'A1 + G2'; '0' for rank 0."""
        return join_types(name for name, _ in self.components())

    @property
    def number_of_roots(self) -> int:
        """The number of roots, positive and negative, an int."""
        return 2 * len(self.positive_roots)

    @property
    def roots(self) -> tuple[Root, ...]:
        """All roots: the positive roots, then their negatives in the same order."""
        return tuple(self._index)

    @property
    def simple_roots(self) -> tuple[Root, ...]:
        """The simple roots, which are the unit vectors of length r."""
        return self.positive_roots[: self.rank]

    @property
    def highest_roots(self) -> tuple[Root, ...]:
        """The highest root of each component, in the order of `components`.

        Examples
        --------
        >>> root_system("E8").highest_roots
        ((2, 3, 4, 6, 5, 4, 3, 2),)
        """
        highest = {frozenset(i for i, x in enumerate(root) if x): root for root in self.positive_roots}
        return tuple(highest[frozenset(nodes)] for _, nodes in self.components())

    # -- verbs -------------------------------------------------------------------------------------------
    def root_matrix(self) -> npt.NDArray[np.int64]:
        """The roots as rows of an integer array, shape (number of roots, rank)."""
        return np.array(self.roots, dtype=np.int64).reshape(self.number_of_roots, self.rank)

    def components(self) -> list[tuple[str, tuple[int, ...]]]:
        """The irreducible components, sorted: pairs of type and nodes in Bourbaki's order.

        Examples
        --------
        >>> RootSystem([[2, 0, -1], [0, 2, 0], [-2, 0, 2]]).components()
        [('A1', (1,)), ('B2', (2, 0))]
        """
        return diagram_components(self.cartan)

    def dynkin_diagram(self) -> networkx.DiGraph[int]:
        """The Dynkin diagram as a networkx.DiGraph; see `liehom.algebra.dynkin_diagram`."""
        return dynkin_diagram(self.cartan)

    def weyl_group_order(self) -> int:
        """The order of the Weyl group, an int: the product of m + 1 over the exponents m.

        Notes
        -----
        The exponents are the partition dual to the numbers of roots by height (Kostant). So the multiplicity of the
        exponent m is the number of roots of height m minus the number of roots of height m + 1.

        Examples
        --------
        >>> root_system("E8").weyl_group_order(), root_system("A1 + A2").weyl_group_order()
        (696729600, 12)
        """
        heights = Counter(map(sum, self.positive_roots))
        return prod((m + 1) ** (heights[m] - heights[m + 1]) for m in heights)

    def is_root(self, alpha: Sequence[int]) -> bool:
        """Whether integer coefficients in the simple roots define a root."""
        return tuple(alpha) in self._index

    def index(self, alpha: Sequence[int]) -> int:
        """The index of a root in `roots`.

        Raises
        ------
        InputError
            If alpha is not a root.

        Examples
        --------
        >>> root_system("A2").index((-1, -1))
        5
        """
        index = self._index.get(tuple(alpha))
        if index is None:
            raise InputError(f"{tuple(alpha)} is not a root of {self.type}; `roots` lists them")
        return index

    def inner(self, alpha: Sequence[int], beta: Sequence[int]) -> int:
        """The inner product (alpha, beta), an int, with (a, a) = 2 for the short roots a of each component."""
        self._require_length(alpha, beta)
        double = 0
        for x, row in zip(alpha, self.cartan, strict=True):
            if x:
                double += x * sum(y * a * d for y, a, d in zip(beta, row, self.norms, strict=True) if y)
        return double // 2

    def norm(self, alpha: Sequence[int]) -> int:
        """(alpha, alpha), an int: 2 for a short root of its component, otherwise 4, or 6 in G2.

        Examples
        --------
        >>> b2 = root_system("B2")
        >>> [b2.norm(alpha) for alpha in b2.positive_roots]
        [4, 2, 2, 4]
        """
        return self.inner(alpha, alpha)

    def pairing(self, alpha: Sequence[int], beta: Sequence[int]) -> int:
        """The integer <alpha, beta^vee> = 2 (alpha, beta) / (beta, beta) of a root beta and alpha in the root lattice.

        Raises
        ------
        InputError
            If beta is not a root.

        Examples
        --------
        >>> root_system("C3").pairing((0, 0, 1), (0, 1, 0))
        -2
        """
        self.index(beta)
        return 2 * self.inner(alpha, beta) // self.norm(beta)

    def reflection(self, alpha: Sequence[int], beta: Sequence[int]) -> Root:
        """The reflection of alpha in the hyperplane orthogonal to the root beta, in the simple roots.

        Examples
        --------
        >>> root_system("A2").reflection((0, 1), (1, 0))
        (1, 1)
        """
        times = self.pairing(alpha, beta)
        return tuple(x - times * y for x, y in zip(alpha, beta, strict=True))

    def coroot(self, alpha: Sequence[int]) -> Root:
        """The coroot of alpha in the simple coroots, with coefficients alpha[i] (alpha_i, alpha_i) / (alpha, alpha).

        Examples
        --------
        >>> root_system("B2").coroot((1, 1))
        (2, 1)
        """
        self.index(alpha)
        norm = self.norm(alpha)
        return tuple(x * d // norm for x, d in zip(alpha, self.norms, strict=True))

    def fundamental_weights(self) -> tuple[tuple[Fraction, ...], ...]:
        """The fundamental weights in the simple roots: <omega_i, alpha_j^vee> is 1 for i = j, else 0.

        Examples
        --------
        >>> [[str(x) for x in row] for row in root_system("B2").fundamental_weights()]
        [['1', '1'], ['1/2', '1']]
        """
        return _inverse(self.cartan)

    def dominant(self, weight: Sequence[int]) -> tuple[int, ...]:
        """The dominant weight in the Weyl orbit of a weight.

        Parameters
        ----------
        weight : (r,) integers
            The coefficients <weight, alpha_i^vee> in the fundamental weights; the result has the same form.

        Examples
        --------
        >>> root_system("A2").dominant((-1, 0))
        (0, 1)
        """
        self._require_length(weight)
        moved = [int(x) for x in weight]
        while (i := next((i for i, x in enumerate(moved) if x < 0), None)) is not None:
            times = moved[i]
            moved = [x - times * a for x, a in zip(moved, self.cartan[i], strict=True)]
        return tuple(moved)

    def _require_length(self, *vectors: Sequence[int]) -> None:
        for vector in vectors:
            if len(vector) != self.rank:
                raise ShapeError(f"{tuple(vector)} has {len(vector)} coordinates, the root system has rank {self.rank}")

    def __repr__(self) -> str:
        return f"<root system {self.type} of rank {self.rank} with {self.number_of_roots} roots>"


def root_system(name: str) -> RootSystem:
    """The root system of a type, with simple roots in Bourbaki's order.

    Parameters
    ----------
    name : str
        'A1', 'B2', ..., 'E8', or a sum such as 'A2 + G2'.

    Raises
    ------
    CatalogError
        If there is no such type.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.root_system("E8")
    <root system E8 of rank 8 with 240 roots>
    """
    return _of_type(name)


@lru_cache(maxsize=64)
def _of_type(name: str) -> RootSystem:
    matrix = cartan_matrix(name)
    within("entries", len(matrix) ** 3, "the roots have {} coefficients, up to a constant")
    return RootSystem(matrix)


def _negative(root: Root) -> Root:
    return tuple(-x for x in root)


def _checked(cartan: Sequence[Sequence[int]]) -> CartanMatrix:
    """The matrix as a tuple of tuples, with the signs and zeros of a Cartan matrix."""
    rows = tuple(tuple(row) for row in cartan)
    if any(len(row) != len(rows) for row in rows):
        raise ShapeError(f"a Cartan matrix is square; got rows of lengths {[len(row) for row in rows]}")
    if any(x != int(x) for row in rows for x in row):
        raise InputError(f"a Cartan matrix has integer entries; got {rows}")
    matrix = tuple(tuple(int(x) for x in row) for row in rows)
    for i, row in enumerate(matrix):
        for j, x in enumerate(row):
            right = x == 2 if i == j else x <= 0 and (x == 0) == (matrix[j][i] == 0)
            if not right:
                raise InputError(
                    f"entry ({i}, {j}) = {x} is impossible in a Cartan matrix (2 on the diagonal, else <= 0)"
                )
    return matrix


def _norms(cartan: CartanMatrix) -> tuple[int, ...]:
    """The norms (alpha_i, alpha_i), by a[i][j] (alpha_j, alpha_j) = a[j][i] (alpha_i, alpha_i)."""
    norms: dict[int, Fraction] = {}
    for start in range(len(cartan)):
        if start in norms:
            continue
        component, stack = {start: Fraction(2)}, [start]
        while stack:
            i = stack.pop()
            for j, x in enumerate(cartan[i]):
                if x and j not in component:
                    component[j] = component[i] * cartan[j][i] / x
                    stack.append(j)
        least = min(component.values())
        norms |= {i: 2 * x / least for i, x in component.items()}
    if any(cartan[i][j] * norms[j] != cartan[j][i] * norms[i] for i in norms for j in norms):
        raise InputError(f"the matrix {cartan} does not come from an inner product: it is not of finite type")
    return tuple(int(norms[i]) for i in range(len(cartan)))


def _require_finite(cartan: CartanMatrix, norms: tuple[int, ...]) -> None:
    """Raise `InputError` unless the inner product is positive definite, by the signs of exact pivots."""
    n = len(cartan)
    gram = [[Fraction(cartan[i][j] * norms[j], 2) for j in range(n)] for i in range(n)]
    for i, pivot in enumerate(gram):
        if pivot[i] <= 0:
            raise InputError(f"the Cartan matrix {cartan} is not of finite type: its root system would be infinite")
        for row in gram[i + 1 :]:
            if row[i]:
                factor = row[i] / pivot[i]
                row[i:] = [x - factor * y for x, y in zip(row[i:], pivot[i:], strict=True)]


def _positive_roots(cartan: CartanMatrix) -> tuple[Root, ...]:
    """The positive roots by height, from the strings in the directions of simple roots."""
    rank = len(cartan)
    level: list[Root] = [tuple(int(i == j) for j in range(rank)) for i in range(rank)]
    # depth[root][i]: the largest p such that root - p alpha_i is a root
    depth: dict[Root, dict[int, int]] = {root: {} for root in level}
    found = list(level)
    while level:
        above: dict[Root, dict[int, int]] = {}
        for root in level:
            steps = depth[root]
            for i in range(rank):
                pairing = sum(x * cartan[k][i] for k, x in enumerate(root) if x)
                if steps.get(i, 0) > pairing:
                    raised = (*root[:i], root[i] + 1, *root[i + 1 :])
                    above.setdefault(raised, {})[i] = steps.get(i, 0) + 1
        level = sorted(above, reverse=True)
        depth = above
        found += level
    return tuple(found)


def _inverse(cartan: CartanMatrix) -> tuple[tuple[Fraction, ...], ...]:
    """The exact inverse of a Cartan matrix."""
    n = len(cartan)
    rows = [[Fraction(x) for x in row] + [Fraction(i == j) for j in range(n)] for i, row in enumerate(cartan)]
    for i, pivot in enumerate(rows):  # the leading minors are positive: no exchange of rows is needed
        pivot[:] = [x / pivot[i] for x in pivot]
        for k, row in enumerate(rows):
            if k != i and row[i]:
                row[:] = [x - row[i] * y for x, y in zip(row, pivot, strict=True)]
    return tuple(tuple(row[n:]) for row in rows)
