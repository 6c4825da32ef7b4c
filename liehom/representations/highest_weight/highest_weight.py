"""Irreducible modules by their highest weight, as integer matrices of the split algebra in its Chevalley basis.

The generators e_i, f_i act on the admissible lattice by integer matrices (`admissible_lattice`), and the simple coroots
act by the weights.  The other root vectors are commutators, rho(e_(a+b)) = [rho(e_a), rho(e_b)] / N_ab with the
constants [e_a, e_b] = N_ab e_(a+b) of the algebra.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import final

from liehom.algebra import LieAlgebra, StructureConstants
from liehom.algebra.matrices.matrix_basis import require_room
from liehom.algebra.roots.chevalley import chevalley, chevalley_constants
from liehom.algebra.roots.root_system import RootSystem
from liehom.display import Displayed
from liehom.errors import RepresentationError
from liehom.representations.core.representation import Representation
from liehom.representations.highest_weight.admissible_lattice import AdmissibleLattice, Vector, add_multiple, lattice_of
from liehom.representations.highest_weight.characters import weyl_dimension
from liehom.representations.highest_weight.weights import Weight, checked_weight, root_system_of, weight_space
from liehom.representations.invariants.generator_proof import SparseStack, failing_generator_pair
from liehom.scalars import QQ, ExactMatrix

Columns = Sequence[Vector]
OTHER_WAYS = "liehom.representations.admissible_lattice gives the generators sparsely, liehom.character the weights"


@final
@dataclass(frozen=True, slots=True)
class HighestWeightModule(Displayed):
    """The irreducible module of a split semisimple algebra with a given highest weight; see `highest_weight_module`.

    Attributes
    ----------
    highest_weight : tuple of int
    weights : tuple of tuples of int
        The weight of every basis vector, in fundamental coordinates; the first is the highest.
    representation : Representation
        Of ``liehom.chevalley(type)``, with integer matrices.

    Examples
    --------
    >>> import liehom as lh
    >>> module = lh.highest_weight_module("A2", [1, 0])
    >>> module
    <module of highest weight (1, 0) of A2, dimension 3>
    >>> module.weights
    ((1, 0), (-1, 1), (0, -1))
    """

    system: RootSystem
    highest_weight: Weight
    weights: tuple[Weight, ...]
    representation: Representation = field(repr=False)

    @property
    def dimension(self) -> int:
        """The dimension of the module."""
        return len(self.weights)

    def character(self) -> dict[Weight, int]:
        """The weights with their multiplicities, by decreasing height.

        Examples
        --------
        >>> import liehom as lh
        >>> module = lh.highest_weight_module("B2", [1, 0])
        >>> module.character() == lh.character("B2", [1, 0])
        True
        """
        found: dict[Weight, int] = {}
        for mu in self.weights:
            found[mu] = found.get(mu, 0) + 1
        return found

    def __repr__(self) -> str:
        shown = f"({', '.join(map(str, self.highest_weight))})"
        return f"<module of highest weight {shown} of {self.system.type}, dimension {self.dimension}>"


def highest_weight_module(
    system: RootSystem | str, weight: Sequence[int], *, check: bool = True
) -> HighestWeightModule:
    """The irreducible module with a given highest weight, by integer matrices.

    Parameters
    ----------
    system : RootSystem or str
        A type such as 'E8' or 'A2 + G2', in Bourbaki's numbering, or a root system with its own numbering.
    weight : sequence of int
        Dominant, in fundamental coordinates.
    check : bool, optional
        Prove the identity of the matrices again, for the generators with all basis elements (default). The matrices are
        a representation by construction, so the proof only guards against errors of the program.

    Returns
    -------
    HighestWeightModule
        Its ``representation`` is a representation of ``liehom.chevalley(type)`` on a basis of weight vectors, the
        highest weight vector first; ``weights`` are their weights.

    Raises
    ------
    ShapeError, InputError
        If the weight does not have one integer, not negative, per simple root, or if the dense matrices would take more
        than 2 GB.
    CatalogError
        If there is no such type.

    Notes
    -----
    V(lambda) exists, and a vector of a weight other than lambda is zero in it if all e_j annihilate it. The
    recursion of `admissible_lattice` therefore computes the matrices of e_i and f_i in V(lambda), and the brackets of
    the Chevalley basis determine those of the other elements. The matrices are integer because the basis spans the
    lattice that all e_i^k / k! and f_i^k / k! preserve. A representation has dim g dense matrices, 0.13 GB for the
    module 248 of E8. For modules with thousands of dimensions `admissible_lattice` gives the sparse matrices of the
    generators only.

    Examples
    --------
    >>> import liehom as lh
    >>> module = lh.highest_weight_module("G2", [1, 0])
    >>> module.dimension, module.weights[0], module.weights[3]
    (7, (1, 0), (0, 0))
    >>> module.representation.isotropy([1, 0, 0, 0, 0, 0, 0]).dimension
    8
    """
    roots = root_system_of(system)
    space = weight_space(roots)
    top = checked_weight(space, weight)
    require_room(roots.rank + roots.number_of_roots, weyl_dimension(roots, top), OTHER_WAYS)
    lattice = lattice_of(space, top)
    # The constants of a Chevalley basis are those of a Lie algebra.
    algebra = (
        chevalley(system)
        if isinstance(system, str)
        else LieAlgebra(chevalley_constants(roots), name=roots.type, check=False)
    )
    columns = chevalley_matrices(roots, lattice)
    size = len(lattice.weights)
    if check:
        _prove(algebra.table, columns, size, roots)
    # The matrices of V(lambda), see the Notes; proved if `check`.
    name = f"V({', '.join(map(str, top))})"
    rho = Representation(algebra, [sparse_matrix(c, size) for c in columns], size=size, name=name, check=False)
    return HighestWeightModule(roots, top, lattice.weights, rho)


def chevalley_matrices(roots: RootSystem, lattice: AdmissibleLattice) -> list[Columns]:
    """The matrices of h_1, ..., h_r, of e_a and of e_(-a) for the positive roots a, as columns."""
    brackets = chevalley_constants(roots).by_pair()
    rank, count = roots.rank, len(roots.positive_roots)
    places = {alpha: x for x, alpha in enumerate(roots.positive_roots)}
    found: list[list[Columns]] = []
    for start, generators in ((rank, lattice.raising), (rank + count, lattice.lowering)):
        made: list[Columns] = list(generators)
        for alpha in roots.positive_roots[rank:]:
            i, below = next((i, b) for i in range(rank) if (b := places.get(_lowered(alpha, i))) is not None)
            ((_, constant),) = brackets[start + i, start + below]
            made.append(_commutator(made[i], made[below], int(constant)))
        found.append(made)
    coroots: list[Columns] = [
        [{b: mu[i]} if mu[i] else {} for b, mu in enumerate(lattice.weights)] for i in range(rank)
    ]
    return [*coroots, *found[0], *found[1]]


def _prove(table: StructureConstants, columns: list[Columns], size: int, roots: RootSystem) -> None:
    """Raise if the identity fails for the e_i, f_i with all basis elements; brackets of these give the others."""
    rank, count = roots.rank, len(roots.positive_roots)
    generators = [*range(rank, 2 * rank), *range(rank + count, 2 * rank + count)]
    failure = failing_generator_pair(table, SparseStack(size, columns), generators)
    if failure is not None:
        i, j = failure
        raise RepresentationError(
            failure, f"not a representation: rho([e{i}, e{j}]) differs from [rho(e{i}), rho(e{j})]"
        )


def _lowered(alpha: tuple[int, ...], i: int) -> tuple[int, ...]:
    return tuple(c - (i == j) for j, c in enumerate(alpha))


def _commutator(left: Columns, right: Columns, divisor: int) -> list[Vector]:
    """The columns of (left right - right left) / divisor, which the admissible lattice contains."""
    made = []
    for x, y in zip(left, right, strict=True):
        total: Vector = {}
        for middle, v in y.items():
            add_multiple(total, left[middle], v)
        for middle, v in x.items():
            add_multiple(total, right[middle], -v)
        made.append({b: v // divisor for b, v in total.items() if v})
    return made


def sparse_matrix(columns: Columns, size: int) -> ExactMatrix:
    """The square matrix over QQ with these columns."""
    matrix: ExactMatrix = QQ.zeros(size, size)
    (numerators,) = matrix.parts  # of a new matrix, which is written to entry by entry
    for c, column in enumerate(columns):
        for b, v in column.items():
            numerators[b, c] = v
    return matrix
