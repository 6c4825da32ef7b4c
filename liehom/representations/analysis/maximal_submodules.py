"""Maximal invariant subspaces: every proper invariant subspace is contained in one of them.

They are the annihilators of the irreducible subspaces of the dual representation, which lie in its socle.  There are
finitely many over the reals if and only if no irreducible representation occurs twice in the socle of the dual.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from liehom.representations.core.representation import Representation
from liehom.scalars import Subspace, as_exact


@final
@dataclass(frozen=True, slots=True)
class MaximalSubmodules:
    """The maximal invariant subspaces of a representation over the reals.

    Attributes
    ----------
    isolated : tuple of Subspace
        Maximal invariant subspaces, each over the smallest real field of its component.
    families : tuple of Subspace
        For each irreducible representation that occurs several times in the socle of the dual: the intersection of the
        infinitely many maximal invariant subspaces that belong to it.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(3)).direct_sum(lh.trivial(lh.so(3), 2))
    >>> found = rho.maximal_submodules()
    >>> [space.dimension for space in found.isolated], [space.dimension for space in found.families]
    ([2], [3])
    """

    isolated: tuple[Subspace, ...]
    families: tuple[Subspace, ...]

    @property
    def is_finite(self) -> bool:
        """Whether `isolated` lists all maximal invariant subspaces."""
        return not self.families


def maximal_submodules(rho: Representation) -> MaximalSubmodules:
    """Implements `Representation.maximal_submodules`."""
    dual = rho.dual()
    socle = dual.socle()
    isolated: list[Subspace] = []
    families: list[Subspace] = []
    for part in dual.subrepresentation(socle).decomposition().isotypic if socle.dimension else ():
        rows = as_exact(part.subspace.basis) @ part.extension.matrix(as_exact(socle.basis))
        annihilator = Subspace(part.field, rows.null_space(), rho.size)
        (isolated if part.multiplicity == 1 else families).append(annihilator)
    return MaximalSubmodules(tuple(isolated), tuple(families))
