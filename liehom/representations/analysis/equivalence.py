"""Equivalence of representations: an invertible intertwiner, or the proof that there is none.

Over an infinite field there is an invertible intertwiner over the field if there is a real one (Noether-Deuring).  For
completely reducible V = sum m_i V_i and W = sum n_i V_i with End(V_i) of dimension d_i, dim End V + dim End W - 2 dim
Hom(V, W) = sum d_i (m_i - n_i)^2 is zero if and only if V and W are equivalent.  In general Hom(V, W) is a module over
End V; if T generates it and is not invertible, then no T u is invertible.
"""

from __future__ import annotations

import random

from liehom.errors import FieldError, InputError, UndecidedError
from liehom.representations.analysis.complete_reducibility import is_completely_reducible
from liehom.representations.core.generating_matrices import generating_matrices
from liehom.representations.core.representation import Representation
from liehom.representations.invariants.intertwiners import commutant, intertwiners
from liehom.scalars import ExactMatrix

ATTEMPTS = 30


def intertwining_maps(rho: Representation, sigma: Representation) -> list[ExactMatrix]:
    """Implements `Representation.intertwiners`."""
    for given in (rho, sigma):
        if not hasattr(given, "algebra") or not hasattr(given, "matrices"):
            raise InputError(f"expected a Representation of the same algebra, such as lh.adjoint(g); got {given!r}")
    if rho.algebra is not sigma.algebra and rho.field != sigma.field:
        raise FieldError(f"representations over {rho.field.name} and {sigma.field.name}: bring both over one field")
    if rho.algebra is not sigma.algebra and rho.algebra != sigma.algebra:
        raise InputError(f"representations of two algebras, {rho.algebra!r} and {sigma.algebra!r}")
    if not rho.field.exact:
        raise UndecidedError(
            "floats do not decide which maps are intertwiners: build the representations over QQ or a number field, or "
            "go to exact numbers by lh.rationalize(rho, max_denominator=...)"
        )
    if not rho.matrices:
        return [
            rho.field.unit(sigma.size, i).T @ rho.field.unit(rho.size, j)
            for i in range(sigma.size)
            for j in range(rho.size)
        ]
    size = max(rho.size, sigma.size)
    left, right = generating_matrices(rho, size), generating_matrices(sigma, size)
    return intertwiners(left, right, (sigma.size, rho.size), rho.field)


def equivalence(rho: Representation, sigma: Representation) -> ExactMatrix | None:
    """Implements `Representation.equivalence`."""
    maps = intertwining_maps(rho, sigma)
    if rho.size != sigma.size:
        return None
    if rho.size == 0:
        empty: ExactMatrix = rho.field.identity(0)
        return empty
    own = len(_endomorphisms(rho))
    if len(maps) != own or len(maps) != len(_endomorphisms(sigma)):
        return None
    rng = random.Random(own)
    for attempt in range(ATTEMPTS):
        bound = attempt // 4 + 1
        total: ExactMatrix = rho.field.zeros(rho.size, rho.size)
        for t in maps:
            total = total + t.scale(rng.randint(-bound, bound))
        # invertible modulo a prime proves it; the rank decides otherwise
        if total.rank() == rho.size:
            return total
        if attempt >= ATTEMPTS // 3 and _generates(rho, total, own):
            return None
    if is_completely_reducible(rho) and is_completely_reducible(sigma):
        raise UndecidedError("the dimensions say equivalent, and no invertible intertwiner was found: try again")
    raise UndecidedError(
        "the representations are not completely reducible, all dimensions of intertwiners agree, and no random "
        "intertwiner is invertible: they are very likely not equivalent, which is not proved"
    )


def _endomorphisms(rho: Representation) -> list[ExactMatrix]:
    return commutant(generating_matrices(rho), rho.size, rho.field)


def _generates(rho: Representation, t: ExactMatrix, dimension: int) -> bool:
    """Whether u -> t u is injective on End(rho): then t generates Hom(rho, sigma), of the same dimension."""
    n = rho.size
    rows = [(t @ u).reshape(1, n * n) for u in _endomorphisms(rho)]
    return int(rho.field.stack_rows(rows, n * n).rank()) == dimension
