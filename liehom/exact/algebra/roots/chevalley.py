"""Chevalley bases, compact forms and automorphisms that permute root vectors; unknown types raise `CatalogError`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any, NamedTuple, final

import numpy as np

from liehom.base.typing import IntegerArray
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.roots.diagrams import VoganDiagram
from liehom.exact.algebra.roots.root_system import CartanMatrix, Root, RootSystem, root_system
from liehom.exact.scalars.rational import QQ

# The Chevalley basis of a semisimple Lie algebra, with integer structure constants for every root system.
# In a simply laced system let B be a bilinear form on the root lattice with B(a, a) = (a, a) / 2 and
# B(a, b) + B(b, a) = (a, b). Then for roots a, b with (a, b) = -1
#
#     [E_a, E_b] = (-1)^B(a, b) E_{a + b},      e_a = E_a,  f_a = -E_{-a}   (a positive)
#
# is a Lie algebra with [e_a, f_a] = h_a. Every other system is obtained by folding a simply laced one, in which each
# short simple root has two or three copies that a symmetry of the diagram permutes. The sums of e over the orbits are a
# Chevalley basis of the fixed algebra.


class RootBrackets(NamedTuple):
    """The brackets [e_a, e_b] = number * e_c of all ordered pairs of roots whose sum is a root."""

    a: IntegerArray  # (m,) indices of roots, as b and c
    b: IntegerArray
    c: IntegerArray
    number: IntegerArray  # (m,), p + 1 or -(p + 1) if b - p a is the last root of the string through b


def chevalley(type_name: str) -> LieAlgebra:
    """The split semisimple Lie algebra of a type such as 'E8' or 'A2 + G2', over QQ, in its Chevalley basis.

    The basis h1, ..., hr, e1, ..., eN, f1, ..., fN is described at `chevalley_constants`.

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.chevalley("A1"))
    Lie algebra A1 over QQ, dimension 3
      basis h1, e1, f1
      [h1, e1] = 2*e1
      [h1, f1] = -2*f1
      [e1, f1] = h1
    """
    system = root_system(type_name)
    count = len(system.positive_roots)
    names = [f"h{i + 1}" for i in range(system.rank)] + [f"{x}{i + 1}" for x in "ef" for i in range(count)]
    # no check: (-1)^B satisfies the cocycle identity, and the fixed points of an automorphism are a subalgebra
    return LieAlgebra(chevalley_constants(system), basis=names, name=system.type, check=False)


def chevalley_constants(system: RootSystem) -> StructureConstants:
    """The integer structure constants of a Chevalley basis, over QQ."""
    rank, count = system.rank, len(system.positive_roots)
    a, b, c, number = root_brackets(system)
    ordered = a < b
    weights = cartan_weights(system)
    root, node = np.nonzero(weights)
    positive, coordinate = np.nonzero(coroots(system))
    parts: list[tuple[Any, Any, Any, Any]] = [
        (node, rank + root, rank + root, weights[root, node]),
        (rank + positive, rank + count + positive, coordinate, coroots(system)[positive, coordinate]),
        (rank + a[ordered], rank + b[ordered], rank + c[ordered], number[ordered]),
    ]
    i, j, k, values = (np.concatenate(column) for column in zip(*parts, strict=True))
    return StructureConstants.from_integers(QQ, rank + 2 * count, i, j, k, values.tolist())


def cartan_weights(system: RootSystem) -> IntegerArray:
    """The integers <a, alpha_i^vee> for all roots a, shape (number of roots, r)."""
    return system.root_matrix() @ _square(system.cartan)


def coroots(system: RootSystem) -> IntegerArray:
    """The coroots of the positive roots in the simple coroots, shape (N, r)."""
    norms = np.array([system.norm(a) for a in system.positive_roots], dtype=np.int64).reshape(-1, 1)
    return system.root_matrix()[: len(norms)] * np.array(system.norms, dtype=np.int64) // norms


def root_brackets(system: RootSystem) -> RootBrackets:
    """The numbers N_{a,b} of the Chevalley basis for all pairs of roots whose sum is a root."""
    cover, folding = _unfolded(system)
    a, b, c, number = _simply_laced_brackets(cover)
    if folding is None:
        return RootBrackets(a, b, c, number)
    orbit = np.array([system.index(x) for x in (cover.root_matrix() @ folding).tolist()], dtype=np.int64)
    # a bracket has the same coefficient at every e of an orbit, so one representative of each orbit is read
    _, representatives = np.unique(orbit, return_index=True)
    kept = np.isin(c, representatives) & (orbit[a] != orbit[b])
    total = system.number_of_roots
    keys, inverse = np.unique(orbit[a[kept]] * total + orbit[b[kept]], return_inverse=True)
    sums = np.zeros(len(keys), dtype=np.int64)
    np.add.at(sums, inverse, number[kept])
    targets = np.zeros(len(keys), dtype=np.int64)
    targets[inverse] = orbit[c[kept]]
    return RootBrackets(keys // total, keys % total, targets, sums)


def _simply_laced_brackets(system: RootSystem) -> RootBrackets:
    """The brackets by the signs (-1)^B(a, b)."""
    rank, half = system.rank, len(system.positive_roots)
    roots, cartan = system.root_matrix(), _square(system.cartan)
    a, b = np.nonzero(roots @ cartan @ roots.T == -1)
    index = {root.tobytes(): i for i, root in enumerate(roots)}
    c = np.array([index[root.tobytes()] for root in roots[a] + roots[b]], dtype=np.int64)
    form = (roots @ np.triu(cartan % 2 + np.eye(rank, dtype=np.int64))) % 2  # B modulo 2
    parity = np.einsum("xi,xi->x", form[a], roots[b])
    parity += (a >= half).astype(np.int64) + (b >= half) + (c >= half)  # f_a is -E_{-a}
    return RootBrackets(a, b, c, 1 - 2 * (parity % 2))


def _unfolded(system: RootSystem) -> tuple[RootSystem, IntegerArray | None]:
    """A simply laced cover and the folding matrix (rank of cover, r); the system and None if it is simply laced."""
    copies = [max(system.norms[k] for k in _component(system, i)) // norm for i, norm in enumerate(system.norms)]
    if set(copies) <= {1}:
        return system, None
    nodes = [(i, copy) for i, times in enumerate(copies) for copy in range(times)]

    def entry(i: int, m: int, j: int, n: int) -> int:
        if i == j:
            return 2 if m == n else 0
        # nodes with equally many copies are joined copy by copy, a single node is joined to all copies of its neighbour
        joined = system.cartan[i][j] != 0 and (copies[i] != copies[j] or m == n)
        return -1 if joined else 0

    cover = RootSystem(tuple(tuple(entry(i, m, j, n) for j, n in nodes) for i, m in nodes))
    folding = np.array([[int(i == j) for j in range(system.rank)] for i, _ in nodes], dtype=np.int64)
    return cover, folding


def _component(system: RootSystem, node: int) -> list[int]:
    """The nodes in the component of a node: the largest support of a root that contains the node."""
    supports = ([i for i, x in enumerate(root) if x] for root in system.positive_roots if root[node])
    return max(supports, key=len)


def _square(cartan: CartanMatrix) -> IntegerArray:
    """The Cartan matrix as an array (r, r), also for r = 0."""
    return np.array(cartan, dtype=np.int64).reshape(len(cartan), len(cartan))


# Automorphisms that permute the root vectors of a Chevalley basis up to powers of i.
# For an automorphism w of a root system and exponents m(a) modulo 4, given on the simple roots, there is one
# automorphism
#
#     s e_a = i^m(a) e_{w a},      s h_a = h_{w a}
#
# of the complex algebra: for a root c = a + alpha_i with [e_a, e_{alpha_i}] = N e_c,
#
#     m(c) = m(a) + m(alpha_i) + (0 if N_{wa, w alpha_i} = N, 2 if it is -N),      m(-a) = -m(a).
#
# It preserves the compact form, on whose basis H_j, X_a, Y_a it acts by
# integers: the vectors X_a and Y_a are permuted up to signs. The Cartan involution of a Vogan diagram is such an
# automorphism.


@final
@dataclass(frozen=True, slots=True)
class RootAutomorphism:
    """An automorphism s e_a = i^m(a) e_{w a} of a complex semisimple algebra and of its compact form."""

    type: str  # of the algebra
    images: tuple[Root, ...]  # w alpha_i; w preserves the root system
    exponents: tuple[int, ...]  # m(alpha_i) modulo 4

    @classmethod
    def of_vogan(cls, vogan: VoganDiagram) -> RootAutomorphism:
        """The Cartan involution of a Vogan diagram."""
        rank = len(vogan.automorphism)
        simple = tuple(map(tuple, vogan.involution().tolist()))
        return cls(vogan.type, simple, tuple(2 * (s < 0) for s in vogan.signs()[:rank].tolist()))

    def root_system(self) -> RootSystem:
        """The root system of the algebra."""
        return root_system(self.type)

    def permutation(self) -> IntegerArray:
        """The index of w a for each root a, in the order of `RootSystem.roots`."""
        return permutation_of(self.root_system(), self.images)

    def all_exponents(self) -> IntegerArray:
        """The exponents m(a) modulo 4 of all roots a, in the order of `RootSystem.roots`."""
        system = self.root_system()
        linear = system.root_matrix() @ np.array(self.exponents, dtype=np.int64)
        return (base_exponents(self.type, self.images) + linear) % 4

    def matrix(self) -> IntegerArray:
        """The matrix (n, n) on the basis H_j, X_a, Y_a of the compact form; rows are images."""
        system = self.root_system()
        rank, count = system.rank, len(system.positive_roots)
        matrix = np.zeros((rank + 2 * count,) * 2, dtype=np.int64)
        for j, image in enumerate(self.images):
            matrix[j, :rank] = np.sign(sum(image)) * coroots(system)[system.index(image) % count]
        moved, power = self.permutation()[:count], self.all_exponents()[:count]
        down = np.where(moved >= count, -1, 1)  # X_{-a} = -X_a, Y_{-a} = Y_a
        turned = power % 2  # i e_a: X_a to Y_wa, Y_a to -X_wa
        sign = np.where(power >= 2, -1, 1)
        x, y, to = rank + np.arange(count), rank + count + np.arange(count), rank + moved % count
        matrix[x, to + turned * count] = sign * np.where(turned, 1, down)
        matrix[y, to + (1 - turned) * count] = sign * np.where(turned, -down, 1)
        return matrix

    def __matmul__(self, other: RootAutomorphism) -> RootAutomorphism:
        """The composition: other first, then this automorphism."""
        system = self.root_system()
        where = [system.index(image) for image in other.images]
        permuted, powers = self.permutation()[where], self.all_exponents()[where]
        images = tuple(system.roots[i] for i in permuted.tolist())
        exponents = ((np.array(other.exponents, dtype=np.int64) + powers) % 4).tolist()
        return RootAutomorphism(self.type, images, tuple(exponents))


def permutation_of(system: RootSystem, images: tuple[Root, ...] | IntegerArray) -> IntegerArray:
    """The index of the image of each root under the linear map with these images of the simple roots."""
    moved = system.root_matrix() @ np.array(images, dtype=np.int64).reshape(system.rank, system.rank)
    return np.array([system.index(root) for root in moved.tolist()], dtype=np.int64)


@lru_cache(maxsize=4096)
def base_exponents(type_name: str, images: tuple[Root, ...]) -> IntegerArray:
    """The exponents m(a) of all roots for m = 0 on the simple roots, 0 or 2."""
    system = root_system(type_name)
    count, rank = len(system.positive_roots), system.rank
    number = bracket_numbers(type_name)
    moved = permutation_of(system, images)
    exponents = np.zeros(2 * count, dtype=np.int64)
    for c in range(rank, count):
        root = system.positive_roots[c]
        lower = (tuple(x - (k == i) for k, x in enumerate(root)) for i in range(rank))
        i, a = next((i, system.index(part)) for i, part in enumerate(lower) if system.is_root(part))
        changed = number[a, i] != number[moved[a], moved[i]]
        exponents[c] = (exponents[a] + 2 * changed) % 4
    exponents[count:] = -exponents[:count] % 4
    return exponents


@lru_cache(maxsize=64)
def bracket_numbers(type_name: str) -> IntegerArray:
    """The numbers N_{a,b} as a matrix over all roots, 0 where a + b is not a root."""
    system = root_system(type_name)
    a, b, _, number = root_brackets(system)
    numbers = np.zeros((system.number_of_roots,) * 2, dtype=np.int64)
    numbers[a, b] = number
    return numbers


# Compact forms from Chevalley bases, and all other real forms from compact forms and involutions.
# The compact form is spanned by H_j = i h_j and, for the positive roots a,
#
#     X_a = e_a - f_a,    Y_a = i (e_a + f_a),
#
# with integer structure constants. The involution theta of a Vogan diagram permutes these basis elements up to signs.
# Let u = k + p be the decomposition of the compact form into eigenspaces of theta. The real form is k + i p: in a basis
# of eigenvectors, the brackets of two elements of p change sign.


def compact_form(type_name: str) -> LieAlgebra:
    """The compact semisimple Lie algebra of a type such as 'E8' or 'A2 + G2', over QQ, with integer constants.

    The basis is H1, ..., Hr, X1, ..., XN, Y1, ..., YN, positive roots in the order of `RootSystem.positive_roots`.

    Examples
    --------
    >>> print(compact_form("A1"))
    Lie algebra compact A1 over QQ, dimension 3
      basis H1, X1, Y1
      [H1, X1] = 2*Y1
      [H1, Y1] = -2*X1
      [X1, Y1] = 2*H1
    """
    system = root_system(type_name)
    count = len(system.positive_roots)
    names = [f"H{i + 1}" for i in range(system.rank)] + [f"{x}{i + 1}" for x in "XY" for i in range(count)]
    # no check: this is a real form of the algebra with the Chevalley basis
    return LieAlgebra(compact_constants(system), basis=names, name=f"compact {system.type}", check=False)


def compact_constants(system: RootSystem) -> StructureConstants:
    """The integer structure constants of the compact form in the basis H_j, X_a, Y_a.

    With X_{-c} = -X_c and Y_{-c} = Y_c, and for different positive roots a, b,

        [X_a, X_b] =  N_{a,b} X_{a+b} - N_{a,-b} X_{a-b},     [H_j, X_a] = a(h_j) Y_a,
        [Y_a, Y_b] = -N_{a,b} X_{a+b} - N_{a,-b} X_{a-b},     [H_j, Y_a] = -a(h_j) X_a,
        [X_a, Y_b] =  N_{a,b} Y_{a+b} + N_{a,-b} Y_{a-b},     [X_a, Y_a] = 2 i h_a.
    """
    rank, count = system.rank, len(system.positive_roots)
    x, y = rank, rank + count
    a, b, c, number = root_brackets(system)
    first = a < count
    a, b, c, number = a[first], b[first], c[first], number[first]
    opposite = b >= count  # the root -b in the formulas
    b, sign_of_c, c = b % count, np.where(c >= count, -1, 1), c % count
    upper = a < b
    of_xx = np.where(opposite, -number, number) * sign_of_c
    of_yy = -number * sign_of_c
    weights, coroot = cartan_weights(system)[:count], coroots(system)
    root, node = np.nonzero(weights)
    same, coordinate = np.nonzero(coroot)
    parts: list[tuple[Any, Any, Any, Any]] = [
        (node, x + root, y + root, weights[root, node]),
        (node, y + root, x + root, -weights[root, node]),
        (x + same, y + same, coordinate, 2 * coroot[same, coordinate]),
        (x + a[upper], x + b[upper], x + c[upper], of_xx[upper]),
        (y + a[upper], y + b[upper], x + c[upper], of_yy[upper]),
        (x + a, y + b, y + c, number),
    ]
    i, j, k, values = (np.concatenate(column) for column in zip(*parts, strict=True))
    return StructureConstants.from_integers(QQ, rank + 2 * count, i, j, k, values.tolist())


def real_form_of(vogan: VoganDiagram, name: str | None = None) -> LieAlgebra:
    """The real semisimple Lie algebra with a given Vogan diagram.

    The structure constants are integers. The first ``vogan.compact_dimension`` basis elements, k1, k2, ..., span the
    maximal compact subalgebra k, the others, p1, p2, ..., its complement p in a Cartan decomposition.

    Examples
    --------
    The form of E6 with the maximal compact subalgebra su(6) + su(2):

    >>> real_form_of(VoganDiagram("E6", painted=(1,)), "e6(2)").killing_signature()
    (40, 38, 0)
    """
    table = compact_constants(vogan.root_system())
    image, sign = _involution(vogan)
    size = table.dimension
    plus = [i for i in range(size) if i < image[i] or (i == image[i] and sign[i] == 1)]
    minus = [i for i in range(size) if i < image[i] or (i == image[i] and sign[i] == -1)]
    if (image == np.arange(size)).all():
        table = _reordered(table, [*plus, *minus])
    else:
        table = _in_eigenvectors(table, image, sign, plus, minus)
    flipped = [-v if i >= len(plus) else v for i, v in zip(table.i.tolist(), table.parts[0], strict=True)]
    # i < j: if i is in p, so is j
    constants = StructureConstants.from_integers(QQ, size, table.i, table.j, table.k, flipped, table.den)
    names = [f"k{i + 1}" for i in range(len(plus))] + [f"p{i + 1}" for i in range(len(minus))]
    # no check: this is a real form of the same complex algebra, since theta is an automorphism of order 2
    return LieAlgebra(constants, basis=names, name=name, check=False)


def _involution(vogan: VoganDiagram) -> tuple[IntegerArray, IntegerArray]:
    """theta on the basis of the compact form: the index and the sign of each image."""
    system = vogan.root_system()
    rank, count = system.rank, len(system.positive_roots)
    sigma = np.array(vogan.automorphism, dtype=np.int64)
    moved = permutation_of(system, vogan.involution())[:count]
    signs = vogan.signs()[:count]
    image = np.concatenate([sigma, rank + moved, rank + count + moved])
    return image, np.concatenate([np.ones(rank, dtype=np.int64), signs, signs])


def _reordered(table: StructureConstants, order: list[int]) -> StructureConstants:
    """The table in the basis elements with these indices, in this order."""
    position = np.argsort(np.array(order, dtype=np.int64))
    i, j, k = position[table.i], position[table.j], position[table.k]
    values = [-v if swap else v for v, swap in zip(table.parts[0], (i > j).tolist(), strict=True)]
    return StructureConstants.from_integers(QQ, table.dimension, np.minimum(i, j), np.maximum(i, j), k, values)


def _in_eigenvectors(
    table: StructureConstants, image: IntegerArray, sign: IntegerArray, plus: list[int], minus: list[int]
) -> StructureConstants:
    """The table in the basis v + theta v, v - theta v for the two-element orbits, and v for the others."""
    size = table.dimension
    # e_i is half the sum of coefficient * new vector over two indices; an unused index has the coefficient 0
    new_indices, coefficients = np.zeros((2, size), dtype=np.int64), np.zeros((2, size), dtype=np.int64)
    single = image == np.arange(size)
    for row, i in enumerate([*plus, *minus]):
        side, j = int(row >= len(plus)), int(image[i])
        new_indices[side, [i, j]] = row
        coefficients[side, j] = -sign[i] if side else sign[i]
        coefficients[side, i] = 1
    first, second = np.concatenate([table.i, table.j]), np.concatenate([table.j, table.i])
    third = np.concatenate([table.k, table.k])
    values = np.array([*table.parts[0], *(-v for v in table.parts[0])], dtype=np.int64)
    halves = coefficients * np.where(single, 2, 1)
    keys, terms = [], []
    for a, b, c in product((0, 1), repeat=3):
        x, y, z = new_indices[a, first], new_indices[b, second], new_indices[c, third]
        term = coefficients[a, first] * coefficients[b, second] * halves[c, third] * values
        kept = (x < y) & (term != 0)
        keys.append(((x * size + y) * size + z)[kept])
        terms.append(term[kept])
    key, inverse = np.unique(np.concatenate(keys), return_inverse=True)
    sums = np.zeros(len(key), dtype=np.int64)
    np.add.at(sums, inverse, np.concatenate(terms))
    return StructureConstants.from_integers(
        QQ, size, key // size**2, key // size % size, key % size, sums.tolist(), den=2
    )
