"""Cartan matrices and Dynkin diagrams: from the name of a type, and the name of a given diagram.

The Cartan matrix is a[i][j] = <alpha_i, alpha_j^vee> = 2 (alpha_i, alpha_j) / (alpha_j, alpha_j). Simple roots are in
Bourbaki's order, numbered from 0. The diagram is a directed graph with an edge i -> j of weight -a[i][j] for each
non-zero a[i][j], i != j. Graph isomorphism determines the names of its components.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

from liehom.budget import small_integer, within
from liehom.errors import CatalogError, InputError, InternalError, displayed

if TYPE_CHECKING:
    import networkx

CartanMatrix = tuple[tuple[int, ...], ...]

_LOWEST_RANK = {"A": 1, "B": 1, "C": 1, "D": 2, "E": 6, "F": 4, "G": 2}
_HIGHEST_RANK = {"E": 8, "F": 4, "G": 2}  # the classical series have no highest rank


def parse_type(name: str) -> tuple[tuple[str, int], ...]:
    """The pairs (letter, rank) of a type such as 'E8' or 'A2 + G2'; empty for '0'.

    Raises
    ------
    CatalogError
        If a summand is not one of A1, A2, ...; B1, ...; C1, ...; D2, ...; E6, E7, E8, F4, G2.

    Examples
    --------
    >>> parse_type("A2 + G2")
    (('A', 2), ('G', 2))
    """
    if not isinstance(name, str):
        raise CatalogError(f"a type is a string such as 'E8' or 'A2 + G2', got {displayed(name)}")
    if name.strip() == "0":
        return ()
    return tuple(_parse_simple(part.strip()) for part in name.split("+"))


def cartan_matrix(name: str) -> CartanMatrix:
    """The Cartan matrix of a type in Bourbaki's order; block diagonal for a sum.

    Parameters
    ----------
    name : str
        'A1', 'B2', ..., 'E8', or a sum such as 'A2 + G2'; '0' for rank 0.

    Returns
    -------
    tuple of tuples of int, shape (rank, rank)
        ``a[i][j] = <alpha_i, alpha_j^vee>``.

    Raises
    ------
    CatalogError
        If there is no such type.

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
    """The Dynkin diagram as a networkx graph.

    Parameters
    ----------
    cartan : (r, r) integers, or str
        A Cartan matrix, or the name of a type as for `cartan_matrix`.

    Returns
    -------
    networkx.DiGraph
        Nodes 0, ..., r - 1, and for i != j with non-zero a[i][j] an edge i -> j with the attribute
        ``entry = -a[i][j]``. A simple edge is a pair of edges with entry 1. The entry exceeds 1 on the edge from a
        longer root to a shorter root.

    Raises
    ------
    CatalogError
        If there is no such type.

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
    """The irreducible components of a Cartan matrix: pairs of type and nodes in Bourbaki's order.

    Parameters
    ----------
    cartan : (r, r) integers
        A Cartan matrix of finite type, with the simple roots in any order.

    Returns
    -------
    list of (str, tuple of int)
        Sorted by type. C2 is named B2, D3 is named A3, and D2 is named A1 + A1. If a diagram has symmetries, the
        lexicographically smallest order of nodes is returned.

    Raises
    ------
    InputError
        If a component is not isomorphic to a Dynkin diagram of finite type.

    Examples
    --------
    >>> diagram_components([[2, 0, -1], [0, 2, 0], [-2, 0, 2]])
    [('A1', (1,)), ('B2', (2, 0))]
    """
    return list(_identified(tuple(tuple(int(x) for x in row) for row in cartan)))


def type_name(cartan: Sequence[Sequence[int]]) -> str:
    """The type of a Cartan matrix as a string such as 'A1 + B2', components sorted; '0' for rank 0.

    Raises
    ------
    InputError
        If a component is not isomorphic to a Dynkin diagram of finite type.

    Examples
    --------
    >>> type_name(cartan_matrix("D2")), type_name(cartan_matrix("G2 + C2 + D3"))
    ('A1 + A1', 'A3 + B2 + G2')
    """
    return join_types(name for name, _ in diagram_components(cartan))


def join_types(names: Iterable[str]) -> str:
    """The sum of simple types as a string, sorted by letter and rank; '0' for the empty sum.

    Examples
    --------
    >>> join_types(["A10", "B2", "A9"])
    'A9 + A10 + B2'
    """
    return " + ".join(sorted(names, key=lambda name: (name.rstrip("0123456789"), len(name), name))) or "0"


def isomorphisms(first: Sequence[Sequence[int]], second: Sequence[Sequence[int]]) -> list[tuple[int, ...]]:
    """The sorted isomorphisms of two Dynkin diagrams: tuples p with second[p[i]][p[j]] = first[i][j].

    Examples
    --------
    >>> isomorphisms(cartan_matrix("A3"), cartan_matrix("D3"))
    [(1, 0, 2), (2, 0, 1)]
    >>> len(isomorphisms(cartan_matrix("D4"), cartan_matrix("D4")))
    6
    """
    return sorted(_isomorphisms(dynkin_diagram(first), dynkin_diagram(second)))


@lru_cache(maxsize=256)
def _identified(cartan: CartanMatrix) -> tuple[tuple[str, tuple[int, ...]], ...]:
    import networkx

    diagram = dynkin_diagram(cartan)
    found = []
    for nodes in networkx.weakly_connected_components(diagram):
        component = diagram.subgraph(sorted(nodes))
        for name in _candidates(len(nodes)):
            orders = list(_isomorphisms(dynkin_diagram(cartan_matrix(name)), component))
            if orders:
                found.append((name, min(orders)))
                break
        else:
            raise InputError(f"the nodes {sorted(nodes)} do not form a Dynkin diagram of finite type: {cartan}")
    return tuple(sorted(found, key=lambda pair: (pair[0][0], int(pair[0][1:]), pair[1])))


def _isomorphisms(first: networkx.DiGraph, second: networkx.DiGraph) -> Iterator[tuple[int, ...]]:
    """The isomorphisms of two weighted graphs, as tuples of the images of the nodes 0, 1, ... of the first."""
    from networkx.algorithms.isomorphism import DiGraphMatcher, numerical_edge_match

    matcher = DiGraphMatcher(first, second, edge_match=numerical_edge_match("entry", 1))
    for mapping in matcher.isomorphisms_iter():
        yield tuple(mapping[i] for i in range(len(first)))


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
    known = "A1, A2, ...; B1, ...; C1, ...; D3, ...; E6, E7, E8, F4, G2"
    raise CatalogError(f"{displayed(name)} is not the type of a simple Lie algebra; known: {known}")


def _simple_matrix(letter: str, rank: int) -> list[list[int]]:
    """The Cartan matrix of a simple type: its simple edges, then the entry of its multiple edge."""
    a = [[2 if i == j else 0 for j in range(rank)] for i in range(rank)]
    for i, j in _simple_edges(letter, rank):
        a[i][j] = a[j][i] = -1
    if letter == "B" and rank > 1:
        a[-2][-1] = -2
    elif letter == "C" and rank > 1:
        a[-1][-2] = -2
    elif letter == "F":
        a[1][2] = -2
    elif letter == "G":
        a[1][0] = -3
    return a


def _simple_edges(letter: str, rank: int) -> list[tuple[int, int]]:
    """The edges of the diagram without their multiplicities."""
    if letter in "ABCFG":
        return [(i, i + 1) for i in range(rank - 1)]
    if letter == "D":
        return [*((i, i + 1) for i in range(rank - 2)), *([(rank - 3, rank - 1)] if rank > 2 else [])]
    if letter == "E":
        return [(0, 2), (1, 3), *((i, i + 1) for i in range(2, rank - 1))]
    raise InternalError(f"there is no diagram with the letter {displayed(letter)}")
