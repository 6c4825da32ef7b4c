"""Irreducible modules by their highest weight, as integer matrices on an admissible lattice."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import factorial
from typing import final

from liehom.base.errors import RepresentationError
from liehom.base.objects import Displayed
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.linear.linear_bases import require_room
from liehom.exact.algebra.roots.chevalley import chevalley, chevalley_constants
from liehom.exact.algebra.roots.root_system import RootSystem
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.highest_weight.characters import weyl_dimension
from liehom.exact.representations.highest_weight.weights import (
    Weight,
    WeightSpace,
    checked_weight,
    root_system_of,
    weight_space,
)
from liehom.exact.representations.invariants.representation_identity import SparseStack, failing_generator_pair
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.rational import QQ

# All f_i^(k) f_j^(l) ... v, with f^(k) = f^k / k! and v a highest weight vector, span a lattice in V(lambda), and the
# generators e_i, f_i map it to itself.  Going down from v, the vectors f_i^(k) b, b in the basis at mu + k alpha_i,
# span the lattice at the weight mu.  Their images under the raising operators are known from the higher weights,
#
#     e_j f_i^(k) b = f_i^(k) e_j b + delta_ij (<mu + k alpha_i, alpha_i^vee> - k + 1) f_i^(k-1) b,
#
# and a vector of weight mu other than lambda is zero if and only if all e_j annihilate it, because V(lambda) is
# irreducible.  The images under (e_1, ..., e_r) therefore determine a basis among these vectors and the coordinates of
# the others.

Vector = dict[int, int]
"""Integer coefficients by the number of the basis vector."""


@final
@dataclass(frozen=True, slots=True)
class AdmissibleLattice:
    """A basis of weight vectors of V(lambda), and the Chevalley generators in this basis.

    Attributes
    ----------
    weights : tuple of Weight
        The weights of the basis vectors, by decreasing height; the first is the highest weight.
    raising, lowering : tuples of tuples of Vector
        raising[i][b] is e_i applied to basis vector b, lowering[i][b] is f_i applied to it.
    recipes : tuple of tuples of (coefficient, i, k, b)
        Each basis vector as a sum of coefficient * f_i^(k) b with earlier basis vectors b; () for the first.

    Examples
    --------
    >>> from liehom.exact.representations import admissible_lattice
    >>> admissible_lattice("E8", [0, 0, 0, 0, 0, 0, 0, 1])
    <admissible lattice of highest weight (0, 0, 0, 0, 0, 0, 0, 1), rank 248>
    """

    weights: tuple[Weight, ...]
    raising: tuple[tuple[Vector, ...], ...]
    lowering: tuple[tuple[Vector, ...], ...]
    recipes: tuple[tuple[tuple[int, int, int, int], ...], ...]

    def __repr__(self) -> str:
        return f"<admissible lattice of highest weight {self.weights[0]}, rank {len(self.weights)}>"


def admissible_lattice(system: RootSystem | str, weight: Sequence[int]) -> AdmissibleLattice:
    """The admissible lattice of the irreducible module with a dominant highest weight, as in `weyl_dimension`.

    Examples
    --------
    >>> lattice = admissible_lattice("A1", [2])
    >>> lattice.raising, lattice.lowering
    ((({}, {0: 2}, {1: 1}),), (({1: 1}, {2: 2}, {}),))
    """
    space = weight_space(system)
    return lattice_of(space, checked_weight(space, weight))


def lattice_of(space: WeightSpace, top: Weight) -> AdmissibleLattice:
    """The admissible lattice of the module with a highest weight, which is not checked."""
    builder, level = _Builder(space, top), [top]
    while level:
        below = {_moved(space, mu, i, -1) for mu in level for i in range(space.rank)}
        level = [mu for mu in sorted(below, reverse=True) if builder.add_weight(mu)]
    raising, lowering = (tuple(map(tuple, maps)) for maps in (builder.raising, builder.lowering))
    return AdmissibleLattice(tuple(builder.weights), raising, lowering, tuple(builder.recipes))


@final
@dataclass(frozen=True, slots=True)
class _Candidate:
    """The vector f_i^(power) b and the sum of its images under e_1, ..., e_r, whose weights differ."""

    i: int
    power: int
    source: int
    image: Vector


class _Builder:
    """The basis of the weights so far, and the generators on it; lowering operators as far as the basis reaches."""

    def __init__(self, space: WeightSpace, top: Weight) -> None:
        self.space = space
        self.weights = [top]
        self.places: dict[Weight, range] = {top: range(1)}
        self.recipes: list[tuple[tuple[int, int, int, int], ...]] = [()]
        self.raising: list[list[Vector]] = [[{}] for _ in range(space.rank)]
        self.lowering: list[list[Vector]] = [[{}] for _ in range(space.rank)]

    def add_weight(self, mu: Weight) -> bool:
        """Whether a weight below the known weights occurs; its lattice is added."""
        candidates = [candidate for candidate in self._candidates(mu) if candidate.image]
        if not candidates:
            return False
        chosen, coordinates = _lattice_basis([candidate.image for candidate in candidates])
        start = len(self.weights)
        self.places[mu] = range(start, start + len(chosen))
        for image, origin in chosen:
            used = [(v, candidates[x]) for x, v in origin.items() if v]
            self.weights.append(mu)
            self.recipes.append(tuple((v, c.i, c.power, c.source) for v, c in used))
            for j in range(self.space.rank):
                place = self.places.get(_moved(self.space, mu, j, 1), range(0))
                self.raising[j].append({b: v for b, v in image.items() if b in place})
                self.lowering[j].append({})
        for candidate, row in zip(candidates, coordinates, strict=True):
            if candidate.power == 1:
                self.lowering[candidate.i][candidate.source] = {start + k: v for k, v in row.items()}
        return True

    def _candidates(self, mu: Weight) -> list[_Candidate]:
        """The candidates at a weight, by decreasing power: a divided power is preferred to its multiples."""
        candidates = []
        for i in range(self.space.rank):
            power, nu = 1, _moved(self.space, mu, i, 1)
            while nu in self.places:
                for b in self.places[nu]:
                    # f_i^(k) f_i^(l) c is a multiple of f_i^(k + l) c, which is a candidate itself
                    if power == 1 or {step[1] for step in self.recipes[b]} != {i}:
                        candidates.append(_Candidate(i, power, b, self._image(i, power, b)))
                power, nu = power + 1, _moved(self.space, nu, i, 1)
        return sorted(candidates, key=lambda candidate: -candidate.power)

    def _image(self, i: int, power: int, b: int) -> Vector:
        total: Vector = {}
        for raising in self.raising:
            add_multiple(total, divided_power(self.lowering[i], raising[b], power), 1)
        if factor := self.weights[b][i] - power + 1:
            add_multiple(total, divided_power(self.lowering[i], {b: 1}, power - 1), factor)
        return {c: v for c, v in total.items() if v}


def divided_power(columns: Sequence[Vector], vector: Vector, power: int) -> Vector:
    """The vector x^power / power! b for b in the admissible lattice, x a root vector given by its columns."""
    for _ in range(power):
        vector = applied(columns, vector)
    divisor = factorial(power)  # the lattice contains the quotient
    return {b: v // divisor for b, v in vector.items() if v}


def applied(columns: Sequence[Vector], vector: Vector) -> Vector:
    """The image of a vector under the matrix with these columns; entries may be 0."""
    image: Vector = {}
    for b, v in vector.items():
        add_multiple(image, columns[b], v)
    return image


def _moved(space: WeightSpace, mu: Weight, i: int, times: int) -> Weight:
    return tuple(m + times * a for m, a in zip(mu, space.cartan[i], strict=True))


def add_multiple(total: Vector, vector: Vector, factor: int) -> None:
    """Add factor * vector to a total, in place."""
    for b, v in vector.items():
        total[b] = total.get(b, 0) + factor * v


def _lattice_basis(vectors: list[Vector]) -> tuple[list[tuple[Vector, Vector]], list[Vector]]:
    """A basis of the lattice spanned by non-zero integer vectors, and the coordinates of these vectors.

    Each basis vector comes with its coefficients in the given vectors.  The first independent vectors are a basis of
    the space.  While a given vector has a coordinate that is not an integer, its difference to the nearest combination
    replaces a basis vector; the index of the lattice falls at least by half each time.
    """
    if len(vectors) == 1:
        return [(vectors[0], {0: 1})], [{0: 1}]
    columns = sorted({b for vector in vectors for b in vector})
    entries = [vector.get(b, 0) for b in columns for vector in vectors]
    reduced, pivots = QQ.from_integers(entries, len(columns), len(vectors)).echelon()
    basis: list[tuple[Vector, Vector]] = [(vectors[x], {x: 1}) for x in pivots]
    table = [[Fraction(int(v.p), int(v.q)) for v in map(QQ.convert, row)] for row in reduced.T.to_rows()]
    while fraction := _not_integral(table):
        x, k = fraction
        nearest = [round(c) for c in table[x]]
        shift = [c - n for c, n in zip(table[x], nearest, strict=True)]
        new: tuple[Vector, Vector] = (dict(vectors[x]), {x: 1})
        for old, n in zip(basis, nearest, strict=True):
            add_multiple(new[0], old[0], -n)
            add_multiple(new[1], old[1], -n)
        basis[k] = ({b: v for b, v in new[0].items() if v}, new[1])
        table = [_exchanged(row, shift, k) for row in table]
    return basis, [{k: int(c) for k, c in enumerate(row) if c} for row in table]


def _not_integral(table: list[list[Fraction]]) -> tuple[int, int] | None:
    """The first row with a fraction, and the index of its fraction nearest to an integer, or None."""
    for x, row in enumerate(table):
        if fractions := [(abs(c - round(c)), k) for k, c in enumerate(row) if c.denominator > 1]:
            return x, min(fractions)[1]
    return None


def _exchanged(row: list[Fraction], shift: list[Fraction], k: int) -> list[Fraction]:
    """Coordinates after basis vector k is replaced by the combination `shift` of the old basis."""
    factor = row[k] / shift[k]
    return [factor if x == k else c - factor * s for x, (c, s) in enumerate(zip(row, shift, strict=True))]


# The generators e_i, f_i act on the admissible lattice by integer matrices (`admissible_lattice`), and the simple
# coroots act by the weights.  The other root vectors are commutators, rho(e_(a+b)) = [rho(e_a), rho(e_b)] / N_ab with
# the constants [e_a, e_b] = N_ab e_(a+b) of the algebra.

Columns = Sequence[Vector]
OTHER_WAYS = (
    "liehom.representations.admissible_lattice gives the generators sparsely, "
    "liehom.representations.character the weights"
)


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
        >>> lh.highest_weight_module("B2", [1, 0]).character() == lh.representations.character("B2", [1, 0])
        True
        """
        return dict(Counter(self.weights))

    def __repr__(self) -> str:
        shown = f"({', '.join(map(str, self.highest_weight))})"
        return f"<module of highest weight {shown} of {self.system.type}, dimension {self.dimension}>"


def highest_weight_module(
    system: RootSystem | str, weight: Sequence[int], *, check: bool = True
) -> HighestWeightModule:
    """The irreducible module with a highest weight, by integer matrices of ``liehom.chevalley(type)``.

    The basis consists of weight vectors, the highest weight vector first.

    Parameters
    ----------
    system : RootSystem or str
        A type such as 'E8' or 'A2 + G2', in Bourbaki's numbering, or a root system with its own numbering.
    weight : sequence of int
        Dominant, in fundamental coordinates.
    check : bool, optional
        Prove the identity of the matrices again, for the generators with all basis elements (default). The matrices are
        a representation by construction, so the proof only guards against errors of the program.

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
    return HighestWeightModule(roots, top, lattice.weights, module_representation(algebra, columns, size, top))


def module_representation(algebra: LieAlgebra, matrices: Sequence[Columns], size: int, top: Weight) -> Representation:
    """The representation with a highest weight by matrices, as columns, of which the caller knows the identity."""
    name = f"V({', '.join(map(str, top))})"
    return Representation(algebra, [sparse_matrix(c, size) for c in matrices], size=size, name=name, check=False)


def chevalley_matrices(roots: RootSystem, lattice: AdmissibleLattice) -> list[Columns]:
    """The matrices of h_1, ..., h_r, of e_a and of e_(-a) for the positive roots a, as columns."""
    brackets = chevalley_constants(roots).by_pair()
    rank, count = roots.rank, len(roots.positive_roots)
    places = {alpha: x for x, alpha in enumerate(roots.positive_roots)}
    weights = lattice.weights
    matrices: list[Columns] = [[{b: mu[i]} if mu[i] else {} for b, mu in enumerate(weights)] for i in range(rank)]
    for start, generators in ((rank, lattice.raising), (rank + count, lattice.lowering)):
        matrices += generators
        for alpha in roots.positive_roots[rank:]:
            lowered = (tuple(c - (i == j) for j, c in enumerate(alpha)) for i in range(rank))
            i, below = next((i, places[beta]) for i, beta in enumerate(lowered) if beta in places)
            ((_, constant),) = brackets[start + i, start + below]
            matrices.append(_commutator(matrices[start + i], matrices[start + below], int(constant)))
    return matrices


def _prove(table: StructureConstants, columns: list[Columns], size: int, roots: RootSystem) -> None:
    """Raise if the identity fails for the e_i, f_i with all basis elements; brackets of these give the others."""
    rank, count = roots.rank, len(roots.positive_roots)
    generators = [*range(rank, 2 * rank), *range(rank + count, 2 * rank + count)]
    if failure := failing_generator_pair(table, SparseStack(size, columns), generators):
        i, j = failure
        raise RepresentationError(
            failure, f"not a representation: rho([e{i}, e{j}]) differs from [rho(e{i}), rho(e{j})]"
        )


def _commutator(left: Columns, right: Columns, divisor: int) -> list[Vector]:
    """The columns of (left right - right left) / divisor, which the admissible lattice contains."""
    columns = []
    for x, y in zip(left, right, strict=True):
        total: Vector = {}
        for middle, v in y.items():
            add_multiple(total, left[middle], v)
        for middle, v in x.items():
            add_multiple(total, right[middle], -v)
        columns.append({b: v // divisor for b, v in total.items() if v})
    return columns


def sparse_matrix(columns: Columns, size: int) -> ExactMatrix:
    """The square matrix over QQ with these columns."""
    matrix: ExactMatrix = QQ.zeros(size, size)
    (numerators,) = matrix.parts  # of a new matrix, which is written to entry by entry
    for c, column in enumerate(columns):
        for b, v in column.items():
            numerators[b, c] = v
    return matrix
