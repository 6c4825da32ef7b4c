"""Subsets of the simple roots up to the Weyl group: conjugacy classes of standard Levi subalgebras.

For a subset S and a simple root a outside S, let K be the component of S + {a} that contains a.  The product of the
longest elements of the Weyl groups of S and K moves S to (S without K) + opposition_K(S in K), again a set of simple
roots.  Two subsets that are conjugate under the Weyl group are joined by such moves (Deodhar, Howlett).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from liehom.algebra.roots.dynkin import diagram_components
from liehom.algebra.roots.root_system import RootSystem

Nodes = tuple[int, ...]


def levi_classes(system: RootSystem) -> list[list[Nodes]]:
    """Classes under the Weyl group of the subsets of simple roots, given by numbers from 0; small subsets first.

    Examples
    --------
    >>> import liehom as lh
    >>> levi_classes(lh.root_system("A3"))
    [[()], [(0,), (1,), (2,)], [(0, 1), (1, 2)], [(0, 2)], [(0, 1, 2)]]
    """
    waiting = [s for size in range(system.rank + 1) for s in combinations(range(system.rank), size)]
    seen: set[Nodes] = set()
    classes = []
    for start in waiting:
        if start in seen:
            continue
        found, frontier = {start}, [start]
        while frontier:
            subset = frontier.pop()
            for moved in _moves(system, subset):
                if moved not in found:
                    found.add(moved)
                    frontier.append(moved)
        seen |= found
        classes.append(sorted(found))
    return classes


def _moves(system: RootSystem, subset: Nodes) -> list[Nodes]:
    return [_moved(system, subset, a) for a in range(system.rank) if a not in subset]


def _moved(system: RootSystem, subset: Nodes, node: int) -> Nodes:
    component = _component(system, {*subset, node}, node)
    opposite = opposition(system, component)
    return tuple(sorted(opposite.get(i, i) for i in subset))


def _component(system: RootSystem, nodes: set[int], start: int) -> list[int]:
    found, frontier = {start}, [start]
    while frontier:
        i = frontier.pop()
        for j in nodes - found:
            if system.cartan[i][j]:
                found.add(j)
                frontier.append(j)
    return sorted(found)


def opposition(system: RootSystem, nodes: Sequence[int]) -> dict[int, int]:
    """The permutation -w of simple roots, w the longest element of the Weyl group that the roots of `nodes` generate.

    Examples
    --------
    >>> import liehom as lh
    >>> opposition(lh.root_system("A3"), [0, 1, 2])
    {0: 2, 1: 1, 2: 0}
    """
    found: dict[int, int] = {}
    for kind, places in diagram_components([[system.cartan[i][j] for j in nodes] for i in nodes]):
        own = [nodes[p] for p in places]
        image = list(own)
        series, rank = kind[0], len(own)
        if series == "A":
            image = own[::-1]
        elif series == "D" and rank % 2:
            image[-2], image[-1] = own[-1], own[-2]
        elif kind == "E6":
            image = [own[x] for x in (5, 1, 4, 3, 2, 0)]
        found.update(zip(own, image, strict=True))
    return {i: found[i] for i in sorted(found)}
