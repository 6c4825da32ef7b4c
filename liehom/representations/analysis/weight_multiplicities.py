"""The weights of a representation of a semisimple algebra, in any basis, and its irreducible parts over C.

On a rational Cartan subalgebra h, which need not split, rho(h) is a commuting family of semisimple matrices; its joint
eigenvalues are the weights, certain balls, and their values on the coroots are integers.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

from liehom.algebra.roots.dynkin import diagram_components
from liehom.algebra.structure.root_data import root_data
from liehom.errors import InternalError
from liehom.representations.highest_weight.characters import decompose_character
from liehom.scalars.roots.joint_multiplicities import coroot_pairings, joint_multiplicities

if TYPE_CHECKING:
    from liehom.representations.core.representation import Representation

Weight = tuple[int, ...]
ATTEMPTS = 20


def weight_multiplicities(rho: Representation) -> dict[Weight, int]:
    """The weights of a representation of a semisimple algebra with their multiplicities.

    Returns
    -------
    dict
        {weight: multiplicity} in fundamental coordinates, in Bourbaki's numbering of ``algebra.semisimple_type()``.

    Raises
    ------
    InputError
        If the algebra is not semisimple.
    FieldError
        Over float64.

    Notes
    -----
    Where the Dynkin diagram has symmetries (A_n, D_n, E6, equal components) the weights are those for one choice of
    simple roots up to such a symmetry: V and its dual may change places.

    Examples
    --------
    >>> import liehom as lh
    >>> weight_multiplicities(lh.defining(lh.so(3)))
    {(2,): 1, (0,): 1, (-2,): 1}
    """
    data = root_data(rho.algebra)
    rank = data.cartan.dimension
    if rank == 0 or rho.size == 0:
        return {(0,) * rank: rho.size} if rho.size else {}
    h = data.cartan.basis
    matrices = [rho(h.row(j)) for j in range(rank)]
    form = (h @ rho.algebra.killing_form() @ h.T).inverse()
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
    raise InternalError("the weights could not be told from their neighbours")


def highest_weights(rho: Representation) -> dict[Weight, int]:
    """The highest weights of the irreducible parts of the complexification, with how often each occurs.

    Examples
    --------
    >>> import liehom as lh
    >>> su3 = lh.defining(lh.su(3))
    >>> highest_weights(su3), highest_weights(lh.adjoint(su3.algebra))
    ({(1, 0): 1, (0, 1): 1}, {(1, 1): 1})
    """
    weights = weight_multiplicities(rho)
    if not weights:
        return {}
    character: dict[Sequence[int], int] = dict(weights.items())
    return decompose_character(rho.algebra.semisimple_type(), character)
