"""Parabolic subalgebras of simple real algebras by the crossed nodes of Satake diagrams: ``G/P{1,6}``.

Nodes are numbered from 1, in the order of Bourbaki, in the diagram of the type that `RealForm` gives to the algebra: B2
for sp(4,R) and so(3,2), A3 for so(3,3). A node that is joined to another one by an arrow is crossed together with it.
Black nodes are never crossed. For a complex algebra, regarded as real, the nodes are those of its complex diagram.

``P{k}`` is conjugate to ``Pk`` in sl(n), in su(p,q) with k and n - k crossed, in sp(2n,R) for n > 2, and in so(p,q),
p + q > 6, for k < min(p, q). In sl(n,H), ``Pk`` is ``P{2k}``, since k counts quaternionic dimensions.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from liehom.algebra import LieAlgebra, RealForm, simple
from liehom.catalog.names import Term
from liehom.errors import CatalogError
from liehom.representations import Pair


def parabolic_pair(top: Term, bottom: Term) -> Pair:
    """The pair of a simple real algebra and the parabolic subalgebra with given crossed nodes.

    Raises
    ------
    CatalogError
        If the algebra is not a simple real algebra, or the crossed nodes are not white or not closed under arrows.

    Examples
    --------
    >>> parabolic_pair(Term("e6(2)"), Term("P{1,6}")).dimension
    24
    """
    form = RealForm.of_name(str(top))
    nodes = crossed_nodes(form)
    crossed = [int(number) for number in bottom.head[2:-1].split(",")]
    chosen = [i for i, together in enumerate(nodes) if set(together) & set(crossed)]
    if sorted(node for i in chosen for node in nodes[i]) != crossed:
        known = ", ".join(crossed_name([together]) for together in nodes) or "none"
        raise CatalogError(f"{top}/{bottom}: the maximal parabolic subalgebras of {top} are {known}")
    algebra = _algebra(str(top))
    return Pair(algebra, algebra.parabolic_subalgebra(chosen), name=f"{top}/{bottom}")


def crossed_nodes(form: RealForm) -> tuple[tuple[int, ...], ...]:
    """For each simple restricted root the nodes, from 1, that are crossed with it.

    Examples
    --------
    >>> crossed_nodes(RealForm.of_name("e6(2)")), crossed_nodes(RealForm.of_name("sl(3,C)"))
    (((1, 6), (2,), (3, 5), (4,)), ((1,), (2,)))
    """
    nodes = form.satake.restricted_nodes
    return tuple(tuple(i + 1 for i in (together[:1] if form.is_complex else together)) for together in nodes)


def crossed_name(together: Iterable[tuple[int, ...]]) -> str:
    """The name of a parabolic subalgebra with these crossed nodes.

    Examples
    --------
    >>> crossed_name([(3, 5), (1, 6)])
    'P{1,3,5,6}'
    """
    return f"P{{{','.join(map(str, sorted(i for nodes in together for i in nodes)))}}}"


@lru_cache(maxsize=8)
def _algebra(name: str) -> LieAlgebra:
    """The algebra with a name: its restricted root spaces are computed once for all its parabolic subalgebras."""
    return simple(name)
