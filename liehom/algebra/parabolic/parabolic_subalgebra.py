"""Parabolic subalgebras: sums of the restricted root spaces on which a grading element has eigenvalues at least 0."""

from __future__ import annotations

from collections.abc import Iterable
from operator import index

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.parabolic.restricted_root_spaces import restricted_root_spaces
from liehom.errors import InputError, displayed
from liehom.scalars import as_exact
from liehom.scalars.spaces.integral_basis import short_basis


def parabolic_subalgebra(algebra: LieAlgebra, crossed: Iterable[int]) -> Subalgebra:
    """Implements `LieAlgebra.parabolic_subalgebra`."""
    found = restricted_root_spaces(algebra)
    nodes = _checked(crossed, found.rank)
    kept = [space for root, space in found.spaces.items() if sum(root[i] for i in nodes) >= 0]
    rows = as_exact(algebra.field.stack_rows([found.centralizer, *kept], algebra.dimension))
    # no check: the grading by the sum of the coefficients at the crossed roots is one of the algebra
    return Subalgebra(algebra, short_basis(rows), check=False)


def _checked(crossed: Iterable[int], rank: int) -> list[int]:
    """The numbers of the crossed roots, sorted; `InputError` if one is not an integer in range(rank)."""
    if isinstance(crossed, Iterable) and not isinstance(crossed, str | bytes):
        nodes = list(crossed)
        if all(hasattr(i, "__index__") and 0 <= i < rank for i in nodes):
            return sorted({index(i) for i in nodes})
    known = f"0, ..., {rank - 1}" if rank else "none, because the algebra is compact"
    raise InputError(
        f"expected the numbers of crossed simple restricted roots ({known}), such as [0]; got {displayed(crossed)}"
    )
