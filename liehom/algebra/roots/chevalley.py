"""The Chevalley basis of a semisimple Lie algebra, with integer structure constants for every root system.

In a simply laced system let B be a bilinear form on the root lattice with B(a, a) = (a, a) / 2 and
B(a, b) + B(b, a) = (a, b). Then for roots a, b with (a, b) = -1

    [E_a, E_b] = (-1)^B(a, b) E_{a + b},      e_a = E_a,  f_a = -E_{-a}   (a positive)

is a Lie algebra with [e_a, f_a] = h_a. Every other system is obtained by folding a simply laced one, in which each
short simple root has two or three copies that a symmetry of the diagram permutes. The sums of e over the orbits are a
Chevalley basis of the fixed algebra.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.roots.dynkin import CartanMatrix
from liehom.algebra.roots.root_system import RootSystem, root_system
from liehom.scalars import QQ
from liehom.typing import IntegerArray


class RootBrackets(NamedTuple):
    """The brackets [e_a, e_b] = number * e_c of all ordered pairs of roots whose sum is a root.

    Attributes
    ----------
    a, b, c : (m,) int64
        Indices of the roots in `RootSystem.roots`.
    number : (m,) int64
        N_{a,b}, which is p + 1 or -(p + 1) if b - p a is the last root of the string through b.
    """

    a: IntegerArray
    b: IntegerArray
    c: IntegerArray
    number: IntegerArray


def chevalley(type_name: str) -> LieAlgebra:
    """The split semisimple Lie algebra of a type, over QQ, in its Chevalley basis.

    Parameters
    ----------
    type_name : str
        'A1', ..., 'E8', or a sum such as 'A2 + G2'.

    Returns
    -------
    LieAlgebra
        Over QQ, with the basis h1, ..., hr, e1, ..., eN, f1, ..., fN described at `chevalley_constants`.

    Raises
    ------
    CatalogError
        If there is no such type.

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
    names = [f"h{i + 1}" for i in range(system.rank)]
    names += [f"{letter}{i + 1}" for letter in "ef" for i in range(count)]
    # no check: (-1)^B satisfies the cocycle identity, and the fixed points of an automorphism are a subalgebra
    return LieAlgebra(chevalley_constants(system), basis=names, name=system.type, check=False)


def chevalley_constants(system: RootSystem) -> StructureConstants:
    """The integer structure constants of a Chevalley basis, over QQ.

    Parameters
    ----------
    system : RootSystem

    Returns
    -------
    StructureConstants
        Over QQ. The basis is h_1, ..., h_r, then e_a for the positive roots a in their order, then f_a = e_{-a}:

        [h_i, e_a] = <a, alpha_i^vee> e_a,   [e_a, f_a] = h_a = sum_i a^vee[i] h_i,   [e_a, e_b] = N_{a,b} e_{a+b},

        with N_{a,b} = p + 1 or -(p + 1), and N_{-a,-b} = -N_{a,b}.

    Examples
    --------
    >>> table = chevalley_constants(root_system("G2"))
    >>> table.dimension, max(table.parts[0]), min(table.parts[0])
    (14, 3, -3)
    """
    rank, count = system.rank, len(system.positive_roots)
    found = root_brackets(system)
    ordered = found.a < found.b
    weights = cartan_weights(system)
    root, node = np.nonzero(weights)
    positive, coordinate = np.nonzero(coroots(system))
    parts: list[tuple[Any, Any, Any, Any]] = [
        (node, rank + root, rank + root, weights[root, node]),
        (rank + positive, rank + count + positive, coordinate, coroots(system)[positive, coordinate]),
        (rank + found.a[ordered], rank + found.b[ordered], rank + found.c[ordered], found.number[ordered]),
    ]
    i, j, k, values = (np.concatenate(column) for column in zip(*parts, strict=True))
    return StructureConstants.from_integers(QQ, rank + 2 * count, i, j, k, values.tolist())


def cartan_weights(system: RootSystem) -> IntegerArray:
    """The integers <a, alpha_i^vee> for all roots a, shape (number of roots, r).

    Examples
    --------
    >>> cartan_weights(root_system("A1")).tolist()
    [[2], [-2]]
    """
    return system.root_matrix() @ _square(system.cartan)


def coroots(system: RootSystem) -> IntegerArray:
    """The coroots of the positive roots in the simple coroots, shape (N, r).

    Examples
    --------
    >>> coroots(root_system("B2")).tolist()
    [[1, 0], [0, 1], [2, 1], [1, 1]]
    """
    norms = np.array([system.norm(a) for a in system.positive_roots], dtype=np.int64).reshape(-1, 1)
    return system.root_matrix()[: len(norms)] * np.array(system.norms, dtype=np.int64) // norms


def root_brackets(system: RootSystem) -> RootBrackets:
    """The numbers N_{a,b} of the Chevalley basis for all pairs of roots whose sum is a root.

    Examples
    --------
    >>> [part.tolist() for part in root_brackets(root_system("A2"))][3]
    [-1, 1, 1, -1, 1, -1, -1, 1, 1, -1, -1, 1]
    """
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
