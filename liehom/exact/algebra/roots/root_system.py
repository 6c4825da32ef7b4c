"""Cartan matrices, Dynkin diagrams and root systems; unknown types raise `CatalogError`."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from math import prod
from typing import TYPE_CHECKING, final

import numpy as np
import numpy.typing as npt

from liehom.base.budget import small_integer, within
from liehom.base.errors import CatalogError, InputError, ShapeError, displayed
from liehom.base.objects import Displayed

if TYPE_CHECKING:
    import networkx

# Cartan matrices and Dynkin diagrams: from the name of a type, and the name of a given diagram.
# The Cartan matrix is a[i][j] = <alpha_i, alpha_j^vee> = 2 (alpha_i, alpha_j) / (alpha_j, alpha_j). Simple roots are in
# Bourbaki's order, numbered from 0. The diagram is a directed graph with an edge i -> j of weight -a[i][j] for each
# non-zero a[i][j], i != j. Graph isomorphism determines the names of its components.

CartanMatrix = tuple[tuple[int, ...], ...]

_LOWEST_RANK = {"A": 1, "B": 1, "C": 1, "D": 2, "E": 6, "F": 4, "G": 2}
_HIGHEST_RANK = {"E": 8, "F": 4, "G": 2}  # the classical series have no highest rank
_MULTIPLE_EDGES = {"B": (-2, -1, -2), "C": (-1, -2, -2), "F": (1, 2, -2), "G": (1, 0, -3)}


def parse_type(name: str) -> tuple[tuple[str, int], ...]:
    """The pairs (letter, rank) of a type such as 'E8' or 'A2 + G2'; empty for '0'."""
    if not isinstance(name, str):
        raise CatalogError(f"a type is a string such as 'E8' or 'A2 + G2', got {displayed(name)}")
    if name.strip() == "0":
        return ()
    return tuple(_parse_simple(part.strip()) for part in name.split("+"))


def cartan_matrix(name: str) -> CartanMatrix:
    """The Cartan matrix ``a[i][j] = <alpha_i, alpha_j^vee>``, tuples of int, of a type such as 'A2 + G2' (Bourbaki).

    Examples
    --------
    The first simple root of B2 is the long one, that of G2 the short one:

    >>> import liehom as lh
    >>> lh.algebra.cartan_matrix("B2"), lh.algebra.cartan_matrix("G2")
    (((2, -2), (-1, 2)), ((2, -1), (-3, 2)))
    """
    parts = parse_type(name)
    size = sum(rank for _, rank in parts)
    within("entries", size**2, "the Cartan matrix has {} entries")
    matrix = [[0] * size for _ in range(size)]
    start = 0
    for letter, rank in parts:
        for i, row in enumerate(_simple_matrix(letter, rank)):
            matrix[start + i][start : start + rank] = row
        start += rank
    return tuple(map(tuple, matrix))


def dynkin_diagram(cartan: Sequence[Sequence[int]] | str) -> networkx.DiGraph[int]:
    """The Dynkin diagram of a Cartan matrix (r, r), or of a type, as a networkx graph.

    It has nodes 0, ..., r - 1, and for i != j with non-zero a[i][j] an edge i -> j with the attribute ``entry =
    -a[i][j]``. A simple edge is a pair of edges with entry 1. The entry exceeds 1 on the edge from a longer root to a
    shorter root.

    Examples
    --------
    >>> diagram = dynkin_diagram("G2")
    >>> sorted(diagram.edges(data="entry"))
    [(0, 1, 1), (1, 0, 3)]
    """
    import networkx

    cartan = cartan_matrix(cartan) if isinstance(cartan, str) else cartan
    graph = networkx.DiGraph()
    graph.add_nodes_from(range(len(cartan)))
    for i, row in enumerate(cartan):
        graph.add_edges_from((i, j, {"entry": -x}) for j, x in enumerate(row) if x and i != j)
    return graph


def diagram_components(cartan: Sequence[Sequence[int]]) -> list[tuple[str, tuple[int, ...]]]:
    """The irreducible components of a Cartan matrix: pairs of type and nodes in Bourbaki's order."""
    return list(_identified(tuple(tuple(int(x) for x in row) for row in cartan)))


def join_types(names: Iterable[str]) -> str:
    """The sum of simple types as a string, sorted by letter and rank; '0' for the empty sum."""
    return " + ".join(sorted(names, key=lambda name: (name.rstrip("0123456789"), len(name), name))) or "0"


def isomorphisms(first: Sequence[Sequence[int]], second: Sequence[Sequence[int]]) -> list[tuple[int, ...]]:
    """The sorted isomorphisms of two Dynkin diagrams: tuples p with second[p[i]][p[j]] = first[i][j]."""
    n, found = len(first), list[tuple[int, ...]]([()] if len(first) == len(second) else [])
    kinds = [[sorted(zip(m[i], (row[i] for row in m), strict=True)) for i in range(len(m))] for m in (first, second)]
    for i in range(n):  # tuples of the images of the nodes before i
        found = [
            (*p, j)
            for p in found
            for j in range(n)
            if kinds[0][i] == kinds[1][j]
            and j not in p
            and all(second[x][j] == first[k][i] and second[j][x] == first[i][k] for k, x in enumerate(p))
        ]
    return found


@lru_cache(maxsize=256)
def _identified(cartan: CartanMatrix) -> tuple[tuple[str, tuple[int, ...]], ...]:
    components, left = [], set(range(len(cartan)))
    while left:
        nodes = [left.pop()]
        for i in nodes:  # which grows
            joined = {j for j in left if cartan[i][j]}
            left -= joined
            nodes += joined
        nodes.sort()
        block = [[cartan[i][j] for j in nodes] for i in nodes]
        orders = ((name, isomorphisms(cartan_matrix(name), block)) for name in _candidates(len(nodes)))
        name, isomorphic = next((pair for pair in orders if pair[1]), ("", []))
        if not name:
            raise InputError(f"the nodes {nodes} do not form a Dynkin diagram of finite type: {cartan}")
        components.append((name, tuple(nodes[i] for i in isomorphic[0])))
    return tuple(sorted(components, key=lambda pair: (pair[0][0], int(pair[0][1:]), pair[1])))


def _candidates(rank: int) -> list[str]:
    """The names of the connected diagrams of a rank, one name for each diagram."""
    least = {**_LOWEST_RANK, "B": 2, "C": 3, "D": 4}
    return [f"{letter}{rank}" for letter, low in least.items() if low <= rank <= _HIGHEST_RANK.get(letter, rank)]


def _parse_simple(name: str) -> tuple[str, int]:
    match = re.fullmatch(r"([A-G])([1-9]\d*)", name)
    if match is not None:
        letter, rank = match[1], small_integer(match[2])
        if _LOWEST_RANK[letter] <= rank <= _HIGHEST_RANK.get(letter, rank):
            return letter, rank
    if name != name.upper() and re.fullmatch(r"[A-G][1-9][0-9]*", name.upper()):
        raise CatalogError(f"{displayed(name)} is not the type of a simple Lie algebra: write {name.upper()!r}")
    if (form := re.fullmatch(r"(su|sl|so|sp)\((\d{1,4})\)", name)) is not None:
        n = int(form[2])
        kind = f"A{n - 1}" if form[1][1] in "ul" else f"C{n}" if form[1] == "sp" else f"{'DB'[n % 2]}{n // 2}"
        if int(kind[1:]) >= _LOWEST_RANK[kind[0]]:
            raise CatalogError(f"{displayed(name)} is an algebra, and a type was expected: write {kind!r}")
    known = "A1, A2, ...; B1, ...; C1, ...; D3, ...; E6, E7, E8, F4, G2"
    raise CatalogError(f"{displayed(name)} is not the type of a simple Lie algebra; known: {known}")


def _simple_matrix(letter: str, rank: int) -> list[list[int]]:
    """The Cartan matrix of a simple type: its simple edges, then the entry of its multiple edge."""
    a = [[2 if i == j else 0 for j in range(rank)] for i in range(rank)]
    for i, j in _simple_edges(letter, rank):
        a[i][j] = a[j][i] = -1
    if letter in _MULTIPLE_EDGES and rank > 1:
        i, j, entry = _MULTIPLE_EDGES[letter]
        a[i][j] = entry
    return a


def _simple_edges(letter: str, rank: int) -> list[tuple[int, int]]:
    """The edges of the diagram without their multiplicities."""
    if letter in "ABCFG":
        return [(i, i + 1) for i in range(rank - 1)]
    if letter == "D":
        return [*((i, i + 1) for i in range(rank - 2)), *([(rank - 3, rank - 1)] if rank > 2 else [])]
    return [(0, 2), (1, 3), *((i, i + 1) for i in range(2, rank - 1))]  # E


# Root systems of Cartan matrices of finite type, in coordinates of the simple roots.
# A root is a tuple of integers, alpha = sum_i alpha[i] alpha_i. Positive roots are found height by height. For a
# positive root beta, beta + alpha_i is a root if and only if p > <beta, alpha_i^vee>, where beta - p alpha_i is the
# last root of the string through beta.

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
    positive_roots : tuple of tuples of int
        Sorted by height, and for one height in reverse lexicographic order. So the simple roots come first, in order.
    norms : tuple of int
        (alpha_i, alpha_i), normalized to 2 for the short roots of each component, so the values are 2, 4 and 6.

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
        signed = [*positive, *(tuple(-x for x in root) for root in positive)]
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
        double = (
            x * sum(y * a * d for y, a, d in zip(beta, row, self.norms, strict=True) if y)
            for x, row in zip(alpha, self.cartan, strict=True)
            if x
        )
        return sum(double) // 2

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
        """The dominant weight in the Weyl orbit of a weight, both by their coefficients in the fundamental weights.

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
    """The root system of a type such as 'E8' or 'A2 + G2', with simple roots in Bourbaki's order.

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
            if not (x == 2 if i == j else x <= 0 and (x == 0) == (matrix[j][i] == 0)):
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
    roots: list[Root] = []
    # depth[root][i]: the largest p such that root - p alpha_i is a root
    depth: dict[Root, dict[int, int]] = {tuple(int(i == j) for j in range(rank)): {} for i in range(rank)}
    while depth:
        above: dict[Root, dict[int, int]] = {}
        level = sorted(depth, reverse=True)
        roots += level
        for root in level:
            steps = depth[root]
            for i in range(rank):
                pairing = sum(x * cartan[k][i] for k, x in enumerate(root) if x)
                if steps.get(i, 0) > pairing:
                    raised = (*root[:i], root[i] + 1, *root[i + 1 :])
                    above.setdefault(raised, {})[i] = steps.get(i, 0) + 1
        depth = above
    return tuple(roots)


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
