"""The simple ideals of a Lie algebra, over the reals.

A simple ideal has only inner derivations and no centre, so it is a direct summand.  The simple ideals over the field
are therefore among the indecomposable summands, and over the reals each of them splits by the places of its centroid.
"""

from __future__ import annotations

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.structure.direct_sum_decomposition import direct_sum_decomposition
from liehom.algebra.structure.real_splitting import real_ideals


def simple_ideals(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.simple_ideals`."""
    found = []
    for ideal in direct_sum_decomposition(algebra):
        if ideal.dimension > 2 and ideal.as_algebra().is_semisimple():
            found += real_ideals(ideal)
    return found
