"""The weights of a representation of a reductive algebra, in any basis, and its irreducible parts over C.

On a rational Cartan subalgebra h of the semisimple part, which need not split, and on the centre, rho is a commuting
family of semisimple matrices.  Its joint eigenvalues are computed as rigorous enclosures.  Their values on the coroots
are integers, their values on the centre are among the exact `central_charges`.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from typing import Any, NamedTuple, cast

from liehom.algebra import LieAlgebra
from liehom.algebra.roots.dynkin import diagram_components
from liehom.algebra.structure.root_data import RootData, root_data
from liehom.errors import InputError, InternalError
from liehom.representations.analysis.central_charges import Charges, central_charges
from liehom.representations.core.representation import Representation
from liehom.representations.highest_weight.characters import decompose_character
from liehom.scalars import ExactMatrix, as_exact
from liehom.scalars.roots.joint_multiplicities import JointMultiplicities, coroot_pairings, joint_multiplicities
from liehom.scalars.spaces.ball_matrices import complex_ball

Weight = tuple[int, ...]
ATTEMPTS = 20
PRECISIONS = (1, 4, 16, 64)  # times that of the roots
FIRST_PRECISION = 128


class ChargedWeight(NamedTuple):
    """A weight of a reductive algebra with centre.

    Attributes
    ----------
    weight : tuple of int
        Its values on the simple coroots of the semisimple part.
    charges : tuple of Charge
        Its values on the canonical basis of the centre, ``algebra.center()``.
    """

    weight: Weight
    charges: Charges


def weight_multiplicities(rho: Representation) -> dict[Any, int]:
    """Implements `Representation.weights`."""
    g = rho.algebra
    if g.is_semisimple():
        return _weights(rho, rho, [])
    center = g.center()
    if not g.is_reductive():
        raise InputError(
            "weights are defined for representations of reductive algebras: the radical must be the centre; "
            "restrict to the Levi factor of levi_decomposition()"
        )
    derived = rho.restriction(g.derived_subalgebra())
    central = [cast(ExactMatrix, rho(row)) for row in center.rows()]
    return _weights(rho, derived, central)


def _weights(rho: Representation, derived: Representation, central: list[ExactMatrix]) -> dict[Any, int]:
    """Weights of the semisimple part, with charges if there are elements of the centre."""
    if rho.size == 0:
        return {}
    charges = central_charges(central) if central else [()]
    data = root_data(derived.algebra)
    rank = data.cartan.dimension
    cartan = [cast(ExactMatrix, derived(row)) for row in data.cartan.rows()]
    if not cartan and not central:
        return {(): rho.size}
    found = _separated([*cartan, *central])
    form = _dual_form(derived.algebra, data)
    precision = max(data.spectrum.precision, FIRST_PRECISION)
    for factor in PRECISIONS:
        bits = factor * precision
        values = found.values(bits)
        weights = coroot_pairings([v[:rank] for v, _ in values], data.simple_values(), form, bits) if rank else []
        places = _matched([v[rank:] for v, _ in values], charges, bits)
        if weights is None or places is None:
            continue
        order = [i for _, nodes in diagram_components(data.root_system.cartan) for i in nodes]
        counted: Counter[tuple[Weight, int]] = Counter()
        for i, (_, m) in enumerate(values):
            counted[tuple(weights[i][k] for k in order) if rank else (), places[i]] += m
        ordered = sorted(counted, key=lambda key: (key[1], tuple(-x for x in key[0])))
        if not central:
            return {w: counted[w, 0] for w, _ in ordered}
        return {ChargedWeight(w, charges[place]): counted[w, place] for w, place in ordered}
    raise InternalError("the weights could not be distinguished")


def _separated(matrices: list[ExactMatrix]) -> JointMultiplicities:
    rng = random.Random(matrices[0].nrows)
    for attempt in range(ATTEMPTS):
        bound = (3 + matrices[0].nrows ** 2) << attempt
        found = joint_multiplicities(matrices, [rng.randint(-bound, bound) for _ in matrices])
        if found is not None:
            return found
    raise InternalError("no element of a Cartan subalgebra separates the weights")


def _dual_form(algebra: LieAlgebra, data: RootData) -> ExactMatrix:
    h = as_exact(data.cartan.basis)
    return as_exact(h @ as_exact(algebra.killing_form()) @ h.T).inverse()


def _matched(values: Sequence[Sequence[Any]], charges: Sequence[Charges], precision: int) -> list[int] | None:
    """For each joint eigenvalue of the centre, in balls, its place among the exact charges; None if not unique."""
    balls = [[complex_ball(c.real, c.imaginary, precision) for c in row] for row in charges]
    found = []
    for value in values:
        near = [i for i, row in enumerate(balls) if all(a.overlaps(b) for a, b in zip(value, row, strict=True))]
        if len(near) != 1:
            return None
        found.append(near[0])
    return found


def highest_weights(rho: Representation) -> dict[Any, int]:
    """Implements `Representation.highest_weights`."""
    weights = weight_multiplicities(rho)
    if not weights:
        return {}
    if rho.algebra.is_semisimple():
        return decompose_character(rho.algebra.semisimple_type(), weights)
    derived = rho.algebra.derived_subalgebra().as_algebra()
    name = derived.semisimple_type() if derived.dimension else None
    characters: dict[Charges, dict[Sequence[int], int]] = {}
    for (weight, charges), m in weights.items():
        characters.setdefault(charges, {})[weight] = m
    found: dict[Any, int] = {}
    for charges, character in characters.items():
        parts = character if name is None else decompose_character(name, character)
        found |= {ChargedWeight(tuple(w), charges): m for w, m in parts.items()}
    return found
