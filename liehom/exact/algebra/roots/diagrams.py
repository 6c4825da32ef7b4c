"""Vogan and Satake diagrams; unknown types raise `CatalogError`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import TYPE_CHECKING, final

import numpy as np

from liehom.base.errors import InputError, InternalError
from liehom.base.typing import BooleanArray, IntegerArray
from liehom.exact.algebra.roots.root_system import (
    Root,
    RootSystem,
    diagram_components,
    isomorphisms,
    join_types,
    root_system,
)

if TYPE_CHECKING:
    import networkx

# Vogan diagrams: Cartan involutions on Dynkin diagrams, which determine real forms.
# On a Chevalley basis of the complex algebra the involution is theta e_a = s(a) e_{sigma a}, where sigma is an
# automorphism of the diagram with sigma^2 = 1 and, modulo 2, for a = sum_i a_i alpha_i
#
#     s(a) = (-1)^q(a),    q(a) = sum_{i painted} a_i + sum_{i < j} a_i a_j (B(sigma i, sigma j) - B(i, j)),
#
# with the bilinear form B of `bilinear_form`. Roots with sigma a = a are compact if s(a) = 1 and noncompact
# if s(a) = -1. All other roots are complex and come in pairs {a, sigma a}.


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
        return 1 - 2 * (q % 2)

    def maximal_compact_type(self) -> tuple[str, int]:
        """The type of the semisimple part of k, and the dimension of the centre of k.

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
        return (roots[:, list(self.automorphism)] == roots).all(axis=1)


def bilinear_form(system: RootSystem) -> IntegerArray:
    """The matrix (r, r) of a form B with B(a, a) = (a, a) / 2 and B(a, b) + B(b, a) = (a, b), simply laced.

    In the simple roots B(i, j) is 1 for i = j, -1 for neighbours i < j, else 0. For systems that are not simply laced
    the entries are weighted by norms, which is only used with the identity automorphism.
    """
    rank = system.rank
    norms = np.array(system.norms, dtype=np.int64)
    gram = np.array(system.cartan, dtype=np.int64).reshape(rank, rank) * norms // 2
    return np.triu(gram, 1) + np.diag(norms // 2)


def simple_system(roots: Iterable[Root], key: Callable[[Root], tuple[int, ...]]) -> list[tuple[int, ...]]:
    """The simple roots of the positive system {a : key(a) > 0}, for an additive, injective key on the roots."""
    keys = {tuple(a): key(a) for a in roots}
    positive = {a for a, value in keys.items() if value > (0,) * len(value)}
    simple: list[tuple[int, ...]] = []
    for a in sorted(positive, key=keys.__getitem__):
        # a positive root that is not simple is the sum of a simple root and a positive root, both smaller
        if not any(tuple(x - y for x, y in zip(a, s, strict=True)) in positive for s in simple):
            simple.append(a)
    return simple


def gram_to_cartan(system: RootSystem, vectors: Sequence[Sequence[int]]) -> list[list[int]]:
    """The Cartan matrix 2 (u, v) / (v, v) of vectors of the root lattice that are simple roots of a root system."""
    norms = [system.norm(v) for v in vectors]
    return [[2 * system.inner(u, v) // norm for v, norm in zip(vectors, norms, strict=True)] for u in vectors]


def generic_form(a: Sequence[int], base: int = 1024) -> int:
    """The value of a linear form that has no zeros on non-zero integer vectors with |coordinates| < base / 2."""
    return reduce(lambda value, x: value * base + int(x), a, 0)


# Satake diagrams: involutions on maximally split Cartan subalgebras, drawn on Dynkin diagrams.
# The involution theta fixes the black nodes. For a white node, -theta(alpha_i) = alpha_{tau i} + (black nodes), where
# tau is the permutation by the arrows. Let w be the longest element of the Weyl group of the black nodes. Then
#
#     theta(alpha_i) = -w(alpha_{tau i})  (white),      theta(alpha_i) = alpha_i  (black),
#
# and the restricted roots are the non-zero differences (a - theta a) / 2. The Cartan subalgebra of a Vogan diagram is
# maximally compact. Cayley transforms lead from it to a maximally split one: theta is replaced by theta s_b with a
# noncompact root b, until no noncompact root is left.


@final
@dataclass(frozen=True, slots=True)
class SatakeDiagram:
    """A Dynkin diagram with black nodes and arrows between white ones that define an involution, of a real form or not.

    Parameters
    ----------
    type : str
        The type of the complex algebra, nodes in Bourbaki's order from 0.
    black : tuple of int
        Nodes whose roots vanish on the split part of the Cartan subalgebra.
    arrows : tuple of (int, int)
        Pairs i < j of white nodes that have the same restriction.

    Examples
    --------
    >>> so41 = SatakeDiagram("B2", black=(1,))
    >>> so41.real_rank, so41.restricted_type, so41.multiplicities
    (1, 'A1', {'all': 3})
    """

    type: str
    black: tuple[int, ...] = ()
    arrows: tuple[tuple[int, int], ...] = ()

    def __post_init__(self) -> None:
        rank = self.root_system().rank
        touched = [i for arrow in self.arrows for i in arrow]
        if len(set(touched)) < len(touched) or set(touched) & set(self.black):
            raise InputError(f"arrows join different white nodes, each at most once; got {self.arrows}")
        if not set(touched) | set(self.black) <= set(range(rank)):
            raise InputError(f"the nodes of {self.type} are 0, ..., {rank - 1}; got {self.black}, {self.arrows}")
        theta, cartan = self.involution(), np.array(self.root_system().cartan, dtype=np.int64).reshape(rank, rank)
        gram = cartan * np.array(self.root_system().norms, dtype=np.int64)
        if (theta @ theta != np.eye(rank, dtype=np.int64)).any() or (theta @ gram @ theta.T != gram).any():
            raise InputError(
                f"black nodes {self.black} and arrows {self.arrows} do not define an involution of {self.type}"
            )

    @classmethod
    def of(cls, vogan: VoganDiagram) -> SatakeDiagram:
        """The Satake diagram of the real form with a given Vogan diagram.

        If the Dynkin diagram has symmetries, the diagram with the last possible nodes black is returned.

        Examples
        --------
        >>> SatakeDiagram.of(VoganDiagram("A3", painted=(0,)))
        SatakeDiagram(type='A3', black=(1,), arrows=((0, 2),))
        """
        return _from_vogan(vogan)

    # -- properties --------------------------------------------------------------------------------------
    @property
    def real_rank(self) -> int:
        """The real rank, an int: the number of white nodes, two nodes joined by an arrow counted once."""
        return self.root_system().rank - len(self.black) - len(self.arrows)

    @property
    def restricted_nodes(self) -> tuple[tuple[int, ...], ...]:
        """The white nodes that restrict to the same simple restricted root, for each of these roots in turn.

        The simple restricted roots are numbered from 0 in the order of their first white nodes.

        Examples
        --------
        >>> SatakeDiagram("E6", arrows=((0, 5), (2, 4))).restricted_nodes
        ((0, 5), (1,), (2, 4), (3,))
        """
        other = dict(self.arrows)
        second = set(other.values()) | set(self.black)
        white = [i for i in range(self.root_system().rank) if i not in second]
        return tuple((i, other[i]) if i in other else (i,) for i in white)

    @property
    def anisotropic_dimension(self) -> int:
        """The dimension of m, the centralizer in k of the split part of the Cartan subalgebra, an int."""
        zero = (0,) * self.root_system().rank
        return self._projections()[zero] + self.root_system().rank - self.real_rank

    @property
    def compact_dimension(self) -> int:
        """dim k, an int: dim m plus the multiplicities of the positive restricted roots."""
        return self.anisotropic_dimension + sum(self.restricted_roots().values()) // 2

    @property
    def restricted_type(self) -> str:
        """The type of the restricted root system, such as 'A1', 'B2' or 'BC1', and '0' for a compact algebra."""
        return _restricted_system(self)[0]

    @property
    def multiplicities(self) -> dict[str, int]:
        """The multiplicities of the restricted roots by their length.

        The key is 'all' if there is one length. The keys are 'short' and 'long' if there are two lengths, and
        'short', 'middle', 'long' for BC_n, n > 1. For BC_1 the 'long' roots are doubles of 'short' ones. The result
        is {} if the restricted root system is empty or has several components.

        Examples
        --------
        >>> SatakeDiagram("F4", black=(0, 1, 2)).multiplicities
        {'short': 8, 'long': 7}
        """
        return _restricted_system(self)[1]

    # -- verbs -------------------------------------------------------------------------------------------
    def root_system(self) -> RootSystem:
        """The root system of the complex algebra."""
        return root_system(self.type)

    def involution(self) -> IntegerArray:
        """The matrix (r, r) of theta on rows of coefficients in the simple roots.

        Examples
        --------
        >>> SatakeDiagram("B2", black=(1,)).involution().tolist()
        [[-1, -2], [0, 1]]
        """
        roots = self.root_system()
        tau, simple = self._other_ends(), roots.simple_roots
        rows = [
            simple[i] if i in self.black else tuple(-x for x in self._raised(simple[tau.get(i, i)]))
            for i in range(roots.rank)
        ]
        return np.array(rows, dtype=np.int64).reshape(roots.rank, roots.rank)

    def restricted_roots(self) -> dict[Root, int]:
        """The multiplicities of the restricted roots, by twice the restriction: {a - theta a: multiplicity}.

        Examples
        --------
        >>> SatakeDiagram("B2", black=(1,)).restricted_roots()
        {(2, 2): 3, (-2, -2): 3}
        """
        return {root: times for root, times in self._projections().items() if any(root)}

    def simple_restricted_roots(self) -> list[Root]:
        """The simple restricted roots as a - theta a, in the order of `restricted_nodes`.

        Examples
        --------
        >>> SatakeDiagram("B2", black=(1,)).simple_restricted_roots()
        [(2, 2)]
        """
        projected = np.eye(self.root_system().rank, dtype=np.int64) - self.involution()
        return [tuple(projected[nodes[0]].tolist()) for nodes in self.restricted_nodes]

    def graph(self) -> networkx.DiGraph[int]:
        """The diagram as a networkx graph.

        It is the Dynkin diagram of `liehom.algebra.dynkin_diagram`; nodes have the attributes ``black`` (bool) and
        ``arrow`` (the node at the other end of the arrow, or None).

        Examples
        --------
        >>> SatakeDiagram("A3", (1,), ((0, 2),)).graph().nodes[0]
        {'black': False, 'arrow': 2}
        """
        graph = self.root_system().dynkin_diagram()
        other = self._other_ends()
        for i in graph.nodes:
            graph.nodes[i].update(black=i in self.black, arrow=other.get(i))
        return graph

    # -- helpers -----------------------------------------------------------------------------------------
    def _other_ends(self) -> dict[int, int]:
        """For each node of an arrow the node at its other end."""
        return dict([*self.arrows, *((j, i) for i, j in self.arrows)])

    def _raised(self, weight: Root) -> Root:
        """w(alpha) for alpha that is antidominant for the black nodes, by reflections while a pairing is negative."""
        cartan = self.root_system().cartan
        row = list(weight)
        while True:
            pairings = {k: sum(x * cartan[i][k] for i, x in enumerate(row) if x) for k in self.black}
            k = next((k for k, value in pairings.items() if value < 0), None)
            if k is None:
                return tuple(row)
            row[k] -= pairings[k]

    def _projections(self) -> Counter[Root]:
        """How many roots a have each value of a - theta a."""
        roots = self.root_system().root_matrix()
        return Counter(map(tuple, (roots - roots @ self.involution()).tolist()))


@lru_cache(maxsize=256)
def _restricted_system(diagram: SatakeDiagram) -> tuple[str, dict[str, int]]:
    """The type of the restricted roots and their multiplicities by length."""
    system, restricted = diagram.root_system(), diagram.restricted_roots()
    simple = diagram.simple_restricted_roots()
    doubled = {i for i, a in enumerate(simple) if tuple(2 * x for x in a) in restricted}
    components = diagram_components(gram_to_cartan(system, simple))
    names = [f"BC{len(nodes)}" if doubled & set(nodes) else name for name, nodes in components]
    if len(names) > 1:
        return join_types(names), {}
    by_norm = {system.norm(root): times for root, times in restricted.items()}
    if any(by_norm[system.norm(root)] != times for root, times in restricted.items()):
        raise InternalError(f"restricted roots of one length have several multiplicities in {diagram}")
    labels = {0: (), 1: ("all",), 2: ("short", "long"), 3: ("short", "middle", "long")}[len(by_norm)]
    return join_types(names), dict(zip(labels, (by_norm[norm] for norm in sorted(by_norm)), strict=True))


@lru_cache(maxsize=256)
def _from_vogan(vogan: VoganDiagram) -> SatakeDiagram:
    """The Satake diagram of the real form of a Vogan diagram."""
    system = vogan.root_system()
    theta = _maximally_split(vogan)
    rows = _simple_roots_for(system, theta)
    images = [tuple(x) for x in (np.array(rows, dtype=np.int64).reshape(system.rank, system.rank) @ theta).tolist()]
    black = {i for i, image in enumerate(images) if image == rows[i]}
    tau = {i: _white_part(system, rows, black, images[i]) for i in range(len(rows)) if i not in black}
    diagrams = []
    for order in isomorphisms(system.cartan, gram_to_cartan(system, rows)):
        position = {row: node for node, row in enumerate(order)}
        arrows = sorted((position[i], position[j]) for i, j in tau.items() if position[i] < position[j])
        single = sorted(position[i] for i, j in tau.items() if i == j)
        # prefer black nodes at the end, then arrows that leave the first nodes fixed
        diagrams.append((sorted(-position[i] for i in black), single, arrows))
    last_black, _, arrows = min(diagrams)
    return SatakeDiagram(vogan.type, tuple(sorted(-x for x in last_black)), tuple(arrows))


def _maximally_split(vogan: VoganDiagram) -> IntegerArray:
    """The involution (r, r) on the root lattice after Cayley transforms by all noncompact roots."""
    system, theta = vogan.root_system(), vogan.involution()
    gram = np.array(system.cartan, dtype=np.int64).reshape(system.rank, system.rank) * np.array(system.norms) // 2
    roots = system.root_matrix()
    imaginary = (roots @ theta == roots).all(axis=1)
    roots, signs = roots[imaginary], vogan.signs()[imaginary]
    while (signs == -1).any():
        b = roots[np.flatnonzero(signs == -1)[0]]
        norm = int(b @ gram @ b)
        reflection = np.eye(system.rank, dtype=np.int64) - np.outer(2 * (gram @ b) // norm, b)
        theta = reflection @ theta
        orthogonal = roots @ gram @ b == 0
        roots, signs = roots[orthogonal], signs[orthogonal]
        # a root that is orthogonal to b, but not strongly orthogonal, changes between compact and noncompact
        signs = np.array([-s if system.is_root(x) else s for s, x in zip(signs, (roots + b).tolist(), strict=True)])
    return theta


def _simple_roots_for(system: RootSystem, theta: IntegerArray) -> list[Root]:
    """Simple roots for an order that compares first the components in the (-1)-eigenspace of theta."""
    roots = system.root_matrix()
    split = dict(zip(system.roots, (roots - roots @ theta).tolist(), strict=True))
    return simple_system(system.roots, lambda a: (generic_form(split[a]), generic_form(a)))


def _white_part(system: RootSystem, simple: Sequence[Root], black: set[int], image: Root) -> int:
    """The index j with -image = simple[j] + (black simple roots), found by subtracting simple roots."""
    rest = tuple(-x for x in image)
    while rest not in simple:
        lower = (tuple(x - y for x, y in zip(rest, s, strict=True)) for s in simple)
        rest, taken = next((low, i) for i, low in enumerate(lower) if system.is_root(low))
        if taken not in black:
            return taken
    return simple.index(rest)
