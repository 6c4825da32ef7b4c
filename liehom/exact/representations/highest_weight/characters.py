"""Characters of irreducible modules: dimensions, multiplicities, tensor products, decompositions.

dim V(lambda) = prod (lambda + rho, alpha) / (rho, alpha) over the positive roots.  Multiplicities are computed by
Freudenthal's recursion, one per dominant weight, with the roots grouped under the stabilizer of that weight.  Tensor
products are decomposed by reflecting weights into the dominant chamber.  A character is a mapping
{weight: multiplicity}.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod

from liehom.base.budget import in_time
from liehom.base.errors import InputError
from liehom.exact.algebra.roots.root_system import RootSystem
from liehom.exact.representations.highest_weight.weights import Root, Weight, WeightSpace, checked_weight, weight_space


def weyl_dimension(system: RootSystem | str, weight: Sequence[int]) -> int:
    """The dimension of the irreducible module with a given highest weight.

    Parameters
    ----------
    system : RootSystem or str
        A root system, or a type such as 'B3' or 'A2 + G2'.
    weight : sequence of int
        Dominant, in fundamental coordinates, in Bourbaki's numbering.

    Notes
    -----
    The product over the positive roots of (lambda + rho, alpha) / (rho, alpha).

    Examples
    --------
    >>> import liehom as lh
    >>> lh.weyl_dimension("E8", [0, 0, 0, 0, 0, 0, 0, 1]), lh.weyl_dimension("A2", [10, 10])
    (248, 1331)
    """
    space = weight_space(system)
    return _dimension(space, checked_weight(space, weight))


def dominant_character(system: RootSystem | str, weight: Sequence[int]) -> dict[Weight, int]:
    """The multiplicities of the dominant weights of an irreducible module, {weight: int} by decreasing height.

    The arguments are those of `weyl_dimension`.

    Freudenthal: ((lambda + rho)^2 - (mu + rho)^2) m(mu) = 2 sum_alpha sum_k m(mu + k alpha) (mu + k alpha, alpha),
    over the positive roots alpha and k = 1, 2, ...

    Examples
    --------
    >>> import liehom as lh
    >>> lh.representations.dominant_character("G2", [0, 1])
    {(0, 1): 1, (1, 0): 1, (0, 0): 2}
    """
    space = weight_space(system)
    return _dominant_multiplicities(space, checked_weight(space, weight))


def character(system: RootSystem | str, weight: Sequence[int]) -> dict[Weight, int]:
    """The multiplicities of all weights of an irreducible module, {weight: int} by decreasing height.

    The arguments are those of `weyl_dimension`.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.representations.character("A1", [3])
    {(3,): 1, (1,): 1, (-1,): 1, (-3,): 1}
    >>> sum(lh.representations.character("F4", [0, 0, 0, 1]).values())
    26
    """
    space = weight_space(system)
    return _character(space, checked_weight(space, weight))


def decompose_character(system: RootSystem | str, character: Mapping[Sequence[int], int]) -> dict[Weight, int]:
    """The highest weights, with multiplicities, of the irreducible modules whose characters add up to {weight: int}.

    The argument has all weights; the result is by decreasing height.

    A weight of greatest height is a highest weight; its character is subtracted, and so on.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.representations.decompose_character("A1", {(2,): 1, (0,): 2, (-2,): 1})
    {(2,): 1, (0,): 1}
    """
    space = weight_space(system)
    return irreducible_parts(space, _dominant_part(space, character))


def tensor_product_decomposition(
    system: RootSystem | str, left: Sequence[int], right: Sequence[int]
) -> dict[Weight, int]:
    """The highest weights, with multiplicities, of the irreducible parts of the tensor product of two modules.

    The arguments are dominant, as in `weyl_dimension`. The result is {weight: int} by decreasing height.

    The product is the sum over the weights nu of the smaller factor of sign(w) V(w(nu + mu + rho) - rho). Here mu is
    the other highest weight, and w takes nu + mu + rho to the dominant chamber. Weights on a wall do not contribute.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.tensor_product_decomposition("G2", [1, 0], [1, 0])
    {(2, 0): 1, (0, 1): 1, (1, 0): 1, (0, 0): 1}
    """
    space = weight_space(system)
    first, second = checked_weight(space, left), checked_weight(space, right)
    if _dimension(space, first) > _dimension(space, second):
        first, second = second, first
    found: dict[Weight, int] = {}
    _add_product(space, found, _character(space, first), second)
    return {top: found[top] for top in _falling(space, found) if found[top]}


def symmetric_power_decomposition(system: RootSystem | str, weight: Sequence[int], k: int) -> dict[Weight, int]:
    """The highest weights, with multiplicities, of the irreducible parts of the k-th symmetric power of a module.

    Newton's identity k S^k = sum_i psi^i S^(k-i), i = 1, ..., k, where the Adams operation psi^i multiplies all weights
    by i. Its product with an irreducible module is decomposed as in `tensor_product_decomposition`.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.representations.symmetric_power_decomposition("E6", [1, 0, 0, 0, 0, 0], 3)
    {(3, 0, 0, 0, 0, 0): 1, (1, 0, 0, 0, 0, 1): 1, (0, 0, 0, 0, 0, 0): 1}
    """
    return _power(system, weight, k, 1)


def exterior_power_decomposition(system: RootSystem | str, weight: Sequence[int], k: int) -> dict[Weight, int]:
    """The highest weights, with multiplicities, of the irreducible parts of the k-th exterior power of a module.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.representations.exterior_power_decomposition("E7", [0, 0, 0, 0, 0, 0, 1], 2)
    {(0, 0, 0, 0, 0, 1, 0): 1, (0, 0, 0, 0, 0, 0, 0): 1}
    """
    return _power(system, weight, k, -1)


def irreducible_parts(space: WeightSpace, dominant: Mapping[Weight, int]) -> dict[Weight, int]:
    """`decompose_character` from the multiplicities of the dominant weights of a character."""
    rest, parts = dict(dominant), {}
    for top in _falling(space, rest):
        count = rest[top]
        if count == 0:
            continue
        in_time()
        parts[top] = count
        for mu, m in _dominant_multiplicities(space, top).items():
            if rest.get(mu, 0) < count * m:
                raise InputError(f"this is the character of no module: {mu} occurs too rarely below {top}")
            rest[mu] -= count * m
    return parts


def weights_up_to(space: WeightSpace, bound: int) -> dict[Weight, int]:
    """The dominant weights of the irreducible modules whose dimension is at most a bound, with the dimensions."""
    found = {(0,) * space.rank: 1}
    waiting = list(found)
    while waiting:
        mu = waiting.pop()
        for i in range(space.rank):
            nu = (*mu[:i], mu[i] + 1, *mu[i + 1 :])
            if nu not in found and (size := _dimension(space, nu)) <= bound:
                found[nu] = size
                waiting.append(nu)
    return found


def _power(system: RootSystem | str, weight: Sequence[int], k: int, sign: int) -> dict[Weight, int]:
    """The symmetric (sign 1) or exterior (sign -1) power of degree k."""
    space = weight_space(system)
    weights = _character(space, checked_weight(space, weight))
    if isinstance(k, bool) or not isinstance(k, int) or k < 0:
        raise InputError(f"the degree of a power is an integer that is not negative, such as 2; got {k!r}")
    powers: list[dict[Weight, int]] = [{(0,) * space.rank: 1}]
    for degree in range(1, k + 1):
        total: dict[Weight, int] = {}
        for i in range(1, degree + 1):
            adams = {tuple(i * x for x in mu): m * sign ** (i - 1) for mu, m in weights.items()}
            for top, m in powers[degree - i].items():
                _add_product(space, total, adams, top, m)
        powers.append({top: total[top] // degree for top in _falling(space, total) if total[top]})
    return powers[k]


def _add_product(
    space: WeightSpace, total: dict[Weight, int], weights: Mapping[Weight, int], top: Weight, times: int = 1
) -> None:
    """Add to a total, in place, the parts of the product of a character with the module of highest weight `top`."""
    for nu, m in weights.items():
        shifted, sign = space.dominant(tuple(x + y + 1 for x, y in zip(nu, top, strict=True)))
        if 0 not in shifted:
            part = tuple(x - 1 for x in shifted)
            total[part] = total.get(part, 0) + sign * m * times


# -- Weyl and Freudenthal -------------------------------------------------------------------------------------
def _dimension(space: WeightSpace, top: Weight) -> int:
    shifted, rho = tuple(x + 1 for x in top), (1,) * space.rank
    roots = space.positive_roots
    return prod(space.product(shifted, a) for a in roots) // prod(space.product(rho, a) for a in roots)


def _dominant_multiplicities(space: WeightSpace, top: Weight) -> dict[Weight, int]:
    below = _dominant_weights(space, top)
    grouped: dict[Weight, list[tuple[Root, Weight, int]]] = {}
    found: dict[Weight, int] = {}
    for mu in _falling(space, below):
        if mu == top:
            found[mu] = 1
            continue
        walls = tuple(int(x == 0) for x in mu)
        if walls not in grouped:
            grouped[walls] = _roots_under_stabilizer(space, walls)
        total = 0
        for alpha, step, count in grouped[walls]:
            norm, value = space.product(step, alpha), space.product(mu, alpha)
            nu = mu
            while True:
                nu = tuple(x + y for x, y in zip(nu, step, strict=True))
                m = found.get(space.dominant(nu)[0], 0)
                if m == 0:  # the weights on a line in the direction of a root have no gap
                    break
                value += norm
                total += count * m * value
        middle = tuple(x + y + 2 for x, y in zip(top, mu, strict=True))
        found[mu] = 2 * total // space.product(middle, below[mu])
    return found


def _dominant_weights(space: WeightSpace, top: Weight) -> dict[Weight, Root]:
    """The dominant weights mu of V(top), with top - mu in the simple roots.

    Neighbours in the order of dominant weights differ by a positive root, so steps by positive roots reach all of them.
    """
    steps = [(alpha, space.as_weight(alpha)) for alpha in space.positive_roots]
    found: dict[Weight, Root] = {top: (0,) * space.rank}
    waiting = [top]
    while waiting:
        mu = waiting.pop()
        for alpha, step in steps:
            nu = tuple(x - y for x, y in zip(mu, step, strict=True))
            if nu not in found and all(x >= 0 for x in nu):
                found[nu] = tuple(x + y for x, y in zip(found[mu], alpha, strict=True))
                waiting.append(nu)
    return found


def _roots_under_stabilizer(space: WeightSpace, walls: Weight) -> list[tuple[Root, Weight, int]]:
    """Representatives (root, as weight, number) of the positive roots under the reflections in the walls.

    The group permutes the positive roots outside its own root system, and each of its own is conjugate to a
    positive one; the terms of Freudenthal's sum agree on conjugates because the group fixes the weight.
    """
    kept = [i for i, wall in enumerate(walls) if wall]
    counts: dict[Root, int] = {}
    for alpha in space.positive_roots:
        root, weight = alpha, space.as_weight(alpha)
        while (i := next((i for i in kept if weight[i] < 0), None)) is not None:
            root = tuple(c - weight[i] * (i == j) for j, c in enumerate(root))
            weight = space.reflected(weight, i)
        counts[root] = counts.get(root, 0) + 1
    return [(root, space.as_weight(root), count) for root, count in counts.items()]


def _character(space: WeightSpace, top: Weight) -> dict[Weight, int]:
    multiplicities = _dominant_multiplicities(space, top)
    weights = {nu: m for mu, m in multiplicities.items() for nu in space.orbit(mu)}
    return {mu: weights[mu] for mu in _falling(space, weights)}


def _falling(space: WeightSpace, weights: Mapping[Weight, object]) -> list[Weight]:
    """The weights by decreasing height, then in decreasing lexicographic order."""
    return sorted(weights, key=lambda mu: (-space.height(mu), *(-x for x in mu)))


def _dominant_part(space: WeightSpace, character: Mapping[Sequence[int], int]) -> dict[Weight, int]:
    """The multiplicities of the dominant weights of a mapping that must be constant on Weyl orbits."""
    given = {checked_weight(space, mu, dominant=False): m for mu, m in character.items()}
    for mu, m in given.items():
        if isinstance(m, bool) or not isinstance(m, int) or m < 0:
            raise InputError(f"this is the character of no module: {mu} has the multiplicity {m!r}")
        for i in range(space.rank):
            mirrored = given.get(space.reflected(mu, i), 0)
            if mirrored != m:
                image = space.reflected(mu, i)
                raise InputError(f"this is the character of no module: {mu} occurs {m} times, {image} {mirrored} times")
    return {mu: m for mu, m in given.items() if all(x >= 0 for x in mu)}
