"""Automorphisms that permute the root vectors of a Chevalley basis up to powers of i.

For an automorphism w of a root system and exponents m(a) modulo 4, given on the simple roots, there is one automorphism

    s e_a = i^m(a) e_{w a},      s h_a = h_{w a}

of the complex algebra: for a root c = a + alpha_i with [e_a, e_{alpha_i}] = N e_c,

    m(c) = m(a) + m(alpha_i) + (0 if N_{wa, w alpha_i} = N, 2 if it is -N),      m(-a) = -m(a).

It preserves the compact form, on whose basis H_j, X_a, Y_a (`liehom.algebra.roots.compact_form`) it acts by integers:
the vectors X_a and Y_a are permuted up to signs. The Cartan involution of a Vogan diagram is such an automorphism.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import final

import numpy as np

from liehom.algebra.roots.chevalley import coroots, root_brackets
from liehom.algebra.roots.root_system import Root, RootSystem, root_system
from liehom.algebra.roots.vogan import VoganDiagram
from liehom.typing import IntegerArray


@final
@dataclass(frozen=True, slots=True)
class RootAutomorphism:
    """An automorphism s e_a = i^m(a) e_{w a} of a complex semisimple algebra and of its compact form.

    Attributes
    ----------
    type : str
        The type of the algebra.
    images : tuple of roots
        The images w alpha_i of the simple roots; w preserves the root system.
    exponents : tuple of int
        m(alpha_i) modulo 4.

    Examples
    --------
    The Cartan involution of sl(3,R) on the basis H1, H2, X1, X2, X3, Y1, Y2, Y3 of su(3); its trace is dim k - dim p:

    >>> theta = RootAutomorphism.of_vogan(VoganDiagram("A2", (), (1, 0)))
    >>> theta.images, theta.exponents, int(theta.matrix().trace())
    (((0, 1), (1, 0)), (0, 0), -2)
    """

    type: str
    images: tuple[Root, ...]
    exponents: tuple[int, ...]

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
        found: IntegerArray = (base_exponents(self.type, self.images) + linear) % 4
        return found

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


def permutation_of(system: RootSystem, images: tuple[Root, ...]) -> IntegerArray:
    """The index of the image of each root under the linear map with given images of the simple roots.

    Examples
    --------
    >>> permutation_of(root_system("A2"), ((0, 1), (1, 0))).tolist()
    [1, 0, 2, 4, 3, 5]
    """
    moved = system.root_matrix() @ np.array(images, dtype=np.int64).reshape(system.rank, system.rank)
    return np.array([system.index(root) for root in moved.tolist()], dtype=np.int64)


@lru_cache(maxsize=4096)
def base_exponents(type_name: str, images: tuple[Root, ...]) -> IntegerArray:
    """The exponents m(a) of all roots for m = 0 on the simple roots, 0 or 2.

    Examples
    --------
    >>> base_exponents("A2", ((0, 1), (1, 0))).tolist()
    [0, 0, 2, 0, 0, 2]
    """
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
    """The numbers N_{a,b} as a matrix over all roots, 0 where a + b is not a root.

    Examples
    --------
    >>> bracket_numbers("A2")[0].tolist()
    [0, -1, 0, 0, 0, 1]
    """
    system = root_system(type_name)
    found = root_brackets(system)
    numbers = np.zeros((system.number_of_roots,) * 2, dtype=np.int64)
    numbers[found.a, found.b] = found.number
    return numbers
