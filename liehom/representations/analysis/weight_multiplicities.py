"""The weights of a representation of a semisimple algebra, in any basis, and its irreducible parts over C.

On a rational Cartan subalgebra h, which need not split, rho(h) is a commuting family of semisimple matrices.  Its joint
eigenvalues, the weights, are computed as rigorous enclosures; their values on the coroots are integers.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from typing import cast

from liehom.algebra.roots.dynkin import diagram_components
from liehom.algebra.structure.root_data import root_data
from liehom.errors import InternalError
from liehom.representations.core.representation import Representation
from liehom.representations.highest_weight.characters import decompose_character
from liehom.scalars import ExactMatrix, as_exact
from liehom.scalars.roots.joint_multiplicities import coroot_pairings, joint_multiplicities

Weight = tuple[int, ...]
ATTEMPTS = 20


def weight_multiplicities(rho: Representation) -> dict[Weight, int]:
    """Implements `Representation.weights`."""
    data = root_data(rho.algebra)
    rank = data.cartan.dimension
    if rank == 0 or rho.size == 0:
        return {(0,) * rank: rho.size} if rho.size else {}
    h = data.cartan.basis
    matrices = [cast(ExactMatrix, rho(h.row(j))) for j in range(rank)]
    form = as_exact(h @ rho.algebra.killing_form() @ h.T).inverse()
    rng = random.Random(rho.size)
    for attempt in range(ATTEMPTS):
        bound = (3 + rho.size**2) << attempt
        found = joint_multiplicities(matrices, [rng.randint(-bound, bound) for _ in matrices])
        if found is not None:
            break
    else:
        raise InternalError("no element of a Cartan subalgebra separates the weights")
    precision = data.spectrum.precision
    for bits in (2 * precision, 8 * precision, 32 * precision):
        values = found.values(bits)
        weights = coroot_pairings([v for v, _ in values], data.simple_values(), form, bits)
        if weights is not None:
            order = [i for _, nodes in diagram_components(data.root_system.cartan) for i in nodes]
            counted: Counter[Weight] = Counter()
            for w, (_, m) in zip(weights, values, strict=True):
                counted[tuple(w[i] for i in order)] += m
            return {w: counted[w] for w in sorted(counted, reverse=True)}
    raise InternalError("the weights could not be distinguished")


def highest_weights(rho: Representation) -> dict[Weight, int]:
    """Implements `Representation.highest_weights`."""
    weights = weight_multiplicities(rho)
    if not weights:
        return {}
    character: dict[Sequence[int], int] = dict(weights.items())
    return decompose_character(rho.algebra.semisimple_type(), character)
