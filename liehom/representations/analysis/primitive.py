"""Primitive pairs: whether a subalgebra is maximal, decided by the irreducible submodules of g/h.

A subalgebra strictly between h and g is an h-submodule of g that contains h. Its image in g/h contains an irreducible
submodule S of g/h. Hence h is maximal if and only if h and S generate g for every irreducible S. These S are in the
socle of g/h. If its irreducible components are pairwise inequivalent over the reals, they are the only ones.
"""

from __future__ import annotations

from liehom.algebra.structure.real_splitting import over_extension
from liehom.errors import UndecidedError
from liehom.representations.analysis.decomposition import Component
from liehom.representations.core.pair import Pair
from liehom.scalars import ExactField, Subspace, as_exact


def is_primitive(pair: Pair) -> bool:
    """Implements `Pair.is_primitive`."""
    if not isinstance(pair.field, ExactField):
        raise UndecidedError(
            f"maximal subalgebras are decided over exact fields; found {pair.field.name}; make the pair exact by "
            "lh.rationalize"
        )
    if pair.dimension == 0:
        return False
    rho = pair.isotropy_representation()
    socle = rho.socle()
    found = rho.subrepresentation(socle).decomposition()
    if not all(_generates(pair, component, socle) for component in found.components):
        return False
    if any(part.multiplicity > 1 for part in found.isotypic):
        raise UndecidedError(
            f"g/h of {pair!r} contains equivalent irreducible subspaces, so infinitely many: {found!r}; no subalgebra "
            "between h and g was found in the ones that were tried"
        )
    return True


def _generates(pair: Pair, component: Component, socle: Subspace) -> bool:
    """Whether h and an irreducible subspace of the socle of g/h generate g."""
    up = component.extension
    algebra = over_extension(pair.algebra, up)
    lift = up.matrix(as_exact(socle.basis) @ as_exact(pair.subalgebra.quotient().lift))
    rows = [up.matrix(as_exact(pair.subalgebra.basis)), as_exact(component.subspace.basis) @ lift]
    whole = component.subspace.field.stack_rows(rows, algebra.dimension)
    return algebra.subalgebra_generated_by(whole).dimension == algebra.dimension
