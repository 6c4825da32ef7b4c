"""Vogan diagrams: Cartan involutions on Dynkin diagrams, which determine real forms.

On a Chevalley basis of the complex algebra the involution is theta e_a = s(a) e_{sigma a}, where sigma is an
automorphism of the diagram with sigma^2 = 1 and, modulo 2, for a = sum_i a_i alpha_i

    s(a) = (-1)^q(a),    q(a) = sum_{i painted} a_i + sum_{i < j} a_i a_j (B(sigma i, sigma j) - B(i, j)),

with the bilinear form B of `liehom.algebra.chevalley`. Roots with sigma a = a are compact if s(a) = 1 and noncompact if
s(a) = -1. All other roots are complex and come in pairs {a, sigma a}.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.algebra.roots.dynkin import diagram_components, join_types
from liehom.algebra.roots.root_system import Root, RootSystem, root_system
from liehom.errors import InputError
from liehom.typing import BooleanArray, IntegerArray


@final
@dataclass(frozen=True, slots=True)
class VoganDiagram:
    """A Dynkin diagram with an involutive automorphism and painted nodes: a real form of a semisimple algebra.

    Parameters
    ----------
    type : str
        The type of the complex algebra, nodes in Bourbaki's order from 0.
    painted : tuple of int
        The nodes that the automorphism fixes and whose root vectors are noncompact.
    automorphism : tuple of int, optional
        The image of each node; () for the identity.

    Raises
    ------
    CatalogError
        If there is no such type.
    InputError
        If the automorphism is not an involution of the diagram, or it moves a painted node.

    Examples
    --------
    The split form of G2, and the rank-one form of E6:

    >>> VoganDiagram("G2", painted=(1,)).character, VoganDiagram("E6", (), (5, 1, 4, 3, 2, 0)).character
    (2, -26)
    """

    type: str
    painted: tuple[int, ...] = ()
    automorphism: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        cartan = self.root_system().cartan
        sigma = self.automorphism or tuple(range(len(cartan)))
        if sorted(sigma) != list(range(len(cartan))) or any(sigma[sigma[i]] != i for i in sigma):
            raise InputError(f"{sigma} is not an involution of the {len(cartan)} nodes 0, ..., {len(cartan) - 1}")
        if any(cartan[sigma[i]][sigma[j]] != cartan[i][j] for i in sigma for j in sigma):
            raise InputError(f"{sigma} does not preserve the Dynkin diagram of {self.type}")
        wrong = [i for i in self.painted if not 0 <= i < len(cartan) or sigma[i] != i]
        if wrong:
            raise InputError(f"painted nodes must be nodes that the automorphism {sigma} fixes; got {wrong}")
        object.__setattr__(self, "automorphism", sigma)
        object.__setattr__(self, "painted", tuple(sorted(set(self.painted))))

    # -- properties --------------------------------------------------------------------------------------
    @property
    def compact_dimension(self) -> int:
        """The dimension of k, the fixed algebra of the involution, an int."""
        fixed, signs = self._fixed(), self.signs()
        orbits = sum(i <= j for i, j in enumerate(self.automorphism))
        return orbits + int((fixed & (signs == 1)).sum()) + int((~fixed).sum()) // 2

    @property
    def character(self) -> int:
        """The character dim p - dim k, an int."""
        roots = self.root_system()
        return roots.rank + roots.number_of_roots - 2 * self.compact_dimension

    # -- verbs -------------------------------------------------------------------------------------------
    def root_system(self) -> RootSystem:
        """The root system of the complex algebra."""
        return root_system(self.type)

    def involution(self) -> IntegerArray:
        """The matrix (r, r) of the involution on rows of coefficients in the simple roots."""
        return np.eye(len(self.automorphism), dtype=np.int64)[list(self.automorphism)]

    def signs(self) -> IntegerArray:
        """The signs s(a) of all roots a, 1 or -1, in the order of `RootSystem.roots`; shape (number of roots,).

        Examples
        --------
        The involution of A2 changes the sign of the highest root vector:

        >>> VoganDiagram("A2", (), (1, 0)).signs().tolist()
        [1, 1, -1, 1, 1, -1]
        """
        roots = self.root_system().root_matrix()
        b = bilinear_form(self.root_system())
        sigma = list(self.automorphism)
        change = np.triu(b[np.ix_(sigma, sigma)] - b, 1)
        q = np.einsum("ai,ij,aj->a", roots, change, roots) + roots[:, list(self.painted)].sum(axis=1)
        signs: IntegerArray = 1 - 2 * (q % 2)
        return signs

    def maximal_compact_type(self) -> tuple[str, int]:
        """The type of the semisimple part of k, and the dimension of the centre of k.

        Notes
        -----
        The roots of k are the restrictions (a + sigma a) / 2 to the fixed part of the Cartan subalgebra, of all
        compact roots and one root of each complex pair.

        Examples
        --------
        >>> VoganDiagram("E7", painted=(6,)).maximal_compact_type()
        ('E6', 1)
        """
        system = self.root_system()
        roots = system.root_matrix()
        kept = ~self._fixed() | (self.signs() == 1)
        restricted = {tuple(x) for x in (roots + roots @ self.involution())[kept].tolist()}
        simple = simple_system(restricted, lambda a: (generic_form(a),))
        orbits = sum(i <= j for i, j in enumerate(self.automorphism))
        return join_types(name for name, _ in diagram_components(gram_to_cartan(system, simple))), orbits - len(simple)

    def _fixed(self) -> BooleanArray:
        """Mask of the roots that the automorphism fixes."""
        roots = self.root_system().root_matrix()
        fixed: BooleanArray = (roots[:, list(self.automorphism)] == roots).all(axis=1)
        return fixed


def bilinear_form(system: RootSystem) -> IntegerArray:
    """The matrix (r, r) of a form B with B(a, a) = (a, a) / 2 and B(a, b) + B(b, a) = (a, b), simply laced.

    In the simple roots B(i, j) is 1 for i = j, -1 for neighbours i < j, else 0. For systems that are not simply laced
    the entries are weighted by norms, which is only used with the identity automorphism.

    Examples
    --------
    >>> bilinear_form(root_system("A2")).tolist()
    [[1, -1], [0, 1]]
    """
    rank = system.rank
    norms = np.array(system.norms, dtype=np.int64)
    gram = np.array(system.cartan, dtype=np.int64).reshape(rank, rank) * norms // 2
    return np.triu(gram, 1) + np.diag(norms // 2)


def simple_system(roots: Iterable[Root], key: Callable[[Root], tuple[int, ...]]) -> list[tuple[int, ...]]:
    """The simple roots of the positive system {a : key(a) > 0}, for an additive, injective key on the roots.

    Parameters
    ----------
    roots : collection of tuples of int
        Closed under -1.
    key : callable
        Additive, with non-zero tuples as values, which are compared lexicographically.

    Examples
    --------
    >>> simple_system([(1, 0), (0, 1), (1, 1), (-1, 0), (0, -1), (-1, -1)], lambda a: (3 * a[0] - a[1],))
    [(0, -1), (1, 1)]
    """
    keys = {tuple(a): key(a) for a in roots}
    positive = {a for a, value in keys.items() if value > (0,) * len(value)}
    simple: list[tuple[int, ...]] = []
    for a in sorted(positive, key=keys.__getitem__):
        # a positive root that is not simple is the sum of a simple root and a positive root, both smaller
        if not any(tuple(x - y for x, y in zip(a, s, strict=True)) in positive for s in simple):
            simple.append(a)
    return simple


def gram_to_cartan(system: RootSystem, vectors: Sequence[Sequence[int]]) -> list[list[int]]:
    """The Cartan matrix 2 (u, v) / (v, v) of vectors of the root lattice that are simple roots of a root system.

    Examples
    --------
    >>> gram_to_cartan(root_system("G2"), [(0, 1), (1, 0)])
    [[2, -3], [-1, 2]]
    """
    norms = [system.norm(v) for v in vectors]
    return [[2 * system.inner(u, v) // norm for v, norm in zip(vectors, norms, strict=True)] for u in vectors]


def generic_form(a: Sequence[int], base: int = 1024) -> int:
    """The value of a linear form that has no zeros on non-zero integer vectors with |coordinates| < base / 2.

    Examples
    --------
    >>> generic_form((1, -1))
    1023
    """
    value = 0
    for x in a:
        value = value * base + int(x)
    return value
