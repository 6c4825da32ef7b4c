"""Hamiltonians of spin models on graphs, as lists of Pauli words: one word for each coupling and each site.

Each function takes the edges of a graph, pairs of integers from 0 on, such as `chain` or the edges of a networkx graph.
"""

from __future__ import annotations

from collections.abc import Iterable

from liehom.errors import InputError
from liehom.pauli.words import encode, spell

Edges = Iterable[tuple[int, int]]


def chain(sites: int, *, periodic: bool = False) -> list[tuple[int, int]]:
    """The edges (q, q + 1) of a chain, and (sites - 1, 0) if it is periodic.

    Examples
    --------
    >>> chain(3), chain(3, periodic=True)
    ([(0, 1), (1, 2)], [(0, 1), (1, 2), (2, 0)])
    """
    if isinstance(sites, bool) or not isinstance(sites, int) or sites < (3 if periodic else 2):
        raise InputError(f"a chain has {sites!r} sites, expected an integer of at least {3 if periodic else 2}")
    return [(q, q + 1) for q in range(sites - 1)] + ([(sites - 1, 0)] if periodic else [])


def ising(edges: Edges) -> list[str]:
    """The words Z Z on each edge and X on each site: the Ising model in a transverse field.

    On an open chain of n >= 2 sites they generate so(2n), on a periodic chain of n >= 3 sites so(2n) + so(2n).

    Examples
    --------
    >>> ising(chain(2))
    ['ZZ', 'XI', 'IX']
    """
    return _words(edges, ["ZZ"], "X")


def xy(edges: Edges) -> list[str]:
    """The words X X and Y Y on each edge: the XY model.

    On an open chain of n >= 3 sites they generate so(n) + so(n).

    Examples
    --------
    >>> xy(chain(2))
    ['XX', 'YY']
    """
    return _words(edges, ["XX", "YY"])


def heisenberg(edges: Edges) -> list[str]:
    """The words X X, Y Y and Z Z on each edge: the Heisenberg model.

    On an open chain of n >= 3 sites they generate su(2^(n-1)) for odd n, and four copies of su(2^(n-2)) for even n.

    Examples
    --------
    >>> heisenberg(chain(2))
    ['XX', 'YY', 'ZZ']
    """
    return _words(edges, ["XX", "YY", "ZZ"])


def kitaev(edges: Edges) -> list[str]:
    """The words X X and Y Y on each edge and Z on each site: the Kitaev chain of fermions by Jordan and Wigner.

    On an open chain of n >= 2 sites they generate so(2n).

    Examples
    --------
    >>> kitaev(chain(2))
    ['XX', 'YY', 'ZI', 'IZ']
    """
    return _words(edges, ["XX", "YY"], "Z")


def _words(edges: Edges, couplings: list[str], field: str | None = None) -> list[str]:
    pairs = [_edge(edge) for edge in edges]
    if not pairs:
        raise InputError("the graph has no edges")
    n = 1 + max(q for pair in pairs for q in pair)
    words = [encode({a: letters[0], b: letters[1]}, n) for letters in couplings for a, b in pairs]
    words += [encode({q: field}, n) for q in range(n)] if field else []
    return [spell(word, n) for word in words]


def _edge(edge: tuple[int, int]) -> tuple[int, int]:
    try:
        a, b = (int(q) for q in edge)
    except (TypeError, ValueError):
        raise InputError(f"{edge!r} is not an edge; write a pair of site numbers such as (0, 1)") from None
    if a == b or min(a, b) < 0:
        raise InputError(f"the edge {edge!r} should join two different sites with numbers from 0 on")
    return a, b
