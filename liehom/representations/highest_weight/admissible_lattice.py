"""The admissible lattice of an irreducible module: integer matrices of the Chevalley generators, weight by weight.

All f_i^(k) f_j^(l) ... v, with f^(k) = f^k / k! and v a highest weight vector, span a lattice in V(lambda), and the
generators e_i, f_i map it to itself.  Going down from v, the vectors f_i^(k) b, b in the basis at mu + k alpha_i, span
the lattice at the weight mu.  Their images under the raising operators are known from the higher weights,

    e_j f_i^(k) b = f_i^(k) e_j b + delta_ij (<mu + k alpha_i, alpha_i^vee> - k + 1) f_i^(k-1) b,

and a vector of weight mu other than lambda is zero if and only if all e_j annihilate it, because V(lambda) is
irreducible.  The images under (e_1, ..., e_r) therefore determine a basis among these vectors and the coordinates of
the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial
from typing import final

from liehom.algebra.roots.root_system import RootSystem
from liehom.representations.highest_weight.weights import Weight, WeightSpace, checked_weight, weight_space
from liehom.scalars import QQ

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
    >>> from liehom.representations import admissible_lattice
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
    """The admissible lattice of the irreducible module with a given highest weight.

    Parameters
    ----------
    system : RootSystem or str
        A root system, or a type such as 'E8' or 'A2 + G2'.
    weight : sequence of int
        Dominant, in fundamental coordinates, in Bourbaki's numbering.

    Raises
    ------
    ShapeError, InputError
        If the weight is not dominant and integral.
    CatalogError
        If there is no such type.

    Examples
    --------
    >>> lattice = admissible_lattice("A1", [2])
    >>> lattice.raising, lattice.lowering
    ((({}, {0: 2}, {1: 1}),), (({1: 1}, {2: 2}, {}),))
    """
    space = weight_space(system)
    return lattice_of(space, checked_weight(space, weight))


def lattice_of(space: WeightSpace, top: Weight) -> AdmissibleLattice:
    """The admissible lattice of the module with a given highest weight, which is not checked."""
    builder = _Builder(space, top)
    level = [top]
    while level:
        below = {_moved(space, mu, i, -1) for mu in level for i in range(space.rank)}
        level = [mu for mu in sorted(below, reverse=True) if builder.add_weight(mu)]
    return builder.finished()


@final
@dataclass(frozen=True, slots=True)
class _Candidate:
    """The vector f_i^(power) b and the sum of its images under e_1, ..., e_r, whose weights differ."""

    i: int
    power: int
    source: int
    image: Vector


class _Builder:
    """The basis found so far, and the generators on it; lowering operators as far as the basis reaches."""

    def __init__(self, space: WeightSpace, top: Weight) -> None:
        self.space = space
        self.weights = [top]
        self.places: dict[Weight, range] = {top: range(1)}
        self.recipes: list[tuple[tuple[int, int, int, int], ...]] = [()]
        self.raising: list[list[Vector]] = [[{}] for _ in range(space.rank)]
        self.lowering: list[list[Vector]] = [[{}] for _ in range(space.rank)]

    def finished(self) -> AdmissibleLattice:
        raising, lowering = (tuple(tuple(columns) for columns in maps) for maps in (self.raising, self.lowering))
        return AdmissibleLattice(tuple(self.weights), raising, lowering, tuple(self.recipes))

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
            self._append(mu, image, tuple((v, c.i, c.power, c.source) for v, c in used))
        for candidate, row in zip(candidates, coordinates, strict=True):
            if candidate.power == 1:
                self.lowering[candidate.i][candidate.source] = {start + k: v for k, v in row.items()}
        return True

    def _append(self, mu: Weight, image: Vector, recipe: tuple[tuple[int, int, int, int], ...]) -> None:
        self.weights.append(mu)
        self.recipes.append(recipe)
        for j in range(self.space.rank):
            place = self.places.get(_moved(self.space, mu, j, 1), range(0))
            self.raising[j].append({b: v for b, v in image.items() if b in place})
            self.lowering[j].append({})

    def _candidates(self, mu: Weight) -> list[_Candidate]:
        """The candidates at a weight, by decreasing power: a divided power is preferred to its multiples."""
        found = []
        for i in range(self.space.rank):
            power, nu = 1, _moved(self.space, mu, i, 1)
            while nu in self.places:
                for b in self.places[nu]:
                    # f_i^(k) f_i^(l) c is a multiple of f_i^(k + l) c, which is a candidate itself
                    if power == 1 or {step[1] for step in self.recipes[b]} != {i}:
                        found.append(_Candidate(i, power, b, self._image(i, power, b)))
                power, nu = power + 1, _moved(self.space, nu, i, 1)
        return sorted(found, key=lambda candidate: -candidate.power)

    def _image(self, i: int, power: int, b: int) -> Vector:
        total: Vector = {}
        for j in range(self.space.rank):
            add_multiple(total, divided_power(self.lowering[i], self.raising[j][b], power), 1)
        factor = self.weights[b][i] - power + 1
        if factor:
            add_multiple(total, divided_power(self.lowering[i], {b: 1}, power - 1), factor)
        return {c: v for c, v in total.items() if v}


def divided_power(columns: Sequence[Vector], vector: Vector, power: int) -> Vector:
    """The vector x^power / power! b for b in the admissible lattice, x a root vector given by its columns.

    Examples
    --------
    >>> (lower,) = admissible_lattice("A1", [2]).lowering
    >>> divided_power(lower, {0: 1}, 2)
    {2: 1}
    """
    for _ in range(power):
        image: Vector = {}
        for b, v in vector.items():
            add_multiple(image, columns[b], v)
        vector = image
    divisor = factorial(power)  # the lattice contains the quotient
    return {b: v // divisor for b, v in vector.items() if v}


def _moved(space: WeightSpace, mu: Weight, i: int, times: int) -> Weight:
    return tuple(m + times * a for m, a in zip(mu, space.cartan[i], strict=True))


def add_multiple(total: Vector, vector: Vector, factor: int) -> None:
    """Add factor * vector to a total, in place.

    Examples
    --------
    >>> total = {0: 1}
    >>> add_multiple(total, {0: 2, 3: 1}, -1)
    >>> total
    {0: -1, 3: -1}
    """
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
    while (found := _not_integral(table)) is not None:
        x, k = found
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
        fractions = [(abs(c - round(c)), k) for k, c in enumerate(row) if c.denominator > 1]
        if fractions:
            return x, min(fractions)[1]
    return None


def _exchanged(row: list[Fraction], shift: list[Fraction], k: int) -> list[Fraction]:
    """Coordinates after basis vector k is replaced by the combination `shift` of the old basis."""
    factor = row[k] / shift[k]
    return [factor if x == k else c - factor * s for x, (c, s) in enumerate(zip(row, shift, strict=True))]
