"""Real structures of complex modules: antilinear maps that commute with a real form.

Let sigma be the conjugation of the complex algebra that fixes the real form.  On the Chevalley generators it is
sigma(e_i) = -s_i f_i', where i' is the image of the node i under the automorphism of the Vogan diagram and s_i = -1 for
painted nodes, else 1.  The module V(lambda) is conjugate to itself if lambda' = -w_0(lambda); then there is an
integer matrix T of the admissible lattice with

    T e_i = -s_i f_i' T,   T f_i = -s_i e_i' T,   T v_highest = v_lowest,   T^2 = 1 or -1,

and J(v) = T conj(v) commutes with the real form.  For T^2 = 1 the vectors with J(v) = v are a real module of dimension
dim V.  For T^2 = -1, and if there is no T, the real space V of twice the dimension is irreducible.
"""

from __future__ import annotations

from fractions import Fraction
from typing import final

from liehom.algebra.roots.vogan import VoganDiagram
from liehom.representations.highest_weight.admissible_lattice import (
    AdmissibleLattice,
    Vector,
    add_multiple,
    divided_power,
)
from liehom.representations.highest_weight.highest_weight import Columns
from liehom.representations.highest_weight.weights import Weight, weight_space
from liehom.scalars import QQ, Scalar
from liehom.scalars.spaces.integral_basis import integral_basis

Operator = tuple[bool, Columns]
"""(imaginary, M): the operator M on V, or i M."""

Reader = dict[int, int | Fraction]
"""Contributions of a coordinate in the old basis to the coordinates in the new basis."""


def commutant_letter(vogan: VoganDiagram, top: Weight) -> str:
    """Commutant of the real module: 'R' for T^2 = 1, 'H' for T^2 = -1, 'C' if there is no T.

    With lambda - w_0(lambda) = sum_i n_i alpha_i, T^2 = (-1)^n, where n is the sum of n_i over the nodes that are not
    painted. Along a reduced word of w_0 the lowest vector is a product of divided powers of the f_i, with n_i factors
    f_i in all, applied to the highest vector. T turns each factor into -s_i e_i', and these lead back to the highest
    vector.

    Examples
    --------
    >>> [commutant_letter(VoganDiagram("A1", painted), (1,)) for painted in ((), (0,))]
    ['H', 'R']
    """
    roots = vogan.root_system()
    dual = weight_space(roots).dominant(tuple(-x for x in top))[0]
    if tuple(top[i] for i in vogan.automorphism) != dual:
        return "C"
    # lambda - w_0(lambda) = lambda + dual, in the simple roots
    numbers = [Fraction(0)] * roots.rank
    for x, y, row in zip(top, dual, roots.fundamental_weights(), strict=True):
        numbers = [n + (x + y) * c for n, c in zip(numbers, row, strict=True)]
    return "H" if sum(int(n) for i, n in enumerate(numbers) if i not in vogan.painted) % 2 else "R"


def conjugation(vogan: VoganDiagram, lattice: AdmissibleLattice) -> list[Vector]:
    """The columns of T, for a highest weight whose module is conjugate to itself."""
    columns: list[Vector] = [{len(lattice.weights) - 1: 1}]
    for recipe in lattice.recipes[1:]:
        total: Vector = {}
        for coefficient, i, power, source in recipe:
            # T f_i^(k) = (-s_i)^k e_i'^(k) T
            factor = coefficient * (1 if i in vogan.painted else (-1) ** power)
            add_multiple(total, divided_power(lattice.raising[vogan.automorphism[i]], columns[source], power), factor)
        columns.append({b: v for b, v in total.items() if v})
    return columns


@final
class RealBasis:
    """A basis of the integer vectors x + i y with T x = x and T y = -y: the x first, then the i y.

    T exchanges the spaces of the weights mu and -mu'.  If they differ, the basis has u + T u and u - T u for the basis
    vectors u at the first weight; if they agree, it has bases of the two eigenspaces of T.  Coordinates are read at the
    first weight.

    Parameters
    ----------
    vogan : VoganDiagram
    lattice : AdmissibleLattice
        The lattice of a module with T^2 = 1.

    Examples
    --------
    >>> from liehom.representations import admissible_lattice
    >>> basis = RealBasis(VoganDiagram("A1"), admissible_lattice("A1", [2]))
    >>> basis.vectors
    ([{0: 1, 2: 1}], [{0: 1, 2: -1}, {1: 1}])
    """

    __slots__ = ("readers", "vectors")

    def __init__(self, vogan: VoganDiagram, lattice: AdmissibleLattice) -> None:
        self.vectors: tuple[list[Vector], list[Vector]] = ([], [])
        # for x in V+ or V-: at the old coordinate b, the new coordinates it contributes to
        self.readers: tuple[dict[int, Reader], dict[int, Reader]] = ({}, {})
        conjugate = conjugation(vogan, lattice)
        places: dict[Weight, list[int]] = {}
        for b, mu in enumerate(lattice.weights):
            places.setdefault(mu, []).append(b)
        done: set[Weight] = set()
        for mu, block in places.items():
            partner = tuple(-mu[i] for i in vogan.automorphism)
            if partner == mu:
                self._add_block(block, conjugate)
            elif partner not in done:
                for b in block:
                    for side, sign in ((0, 1), (1, -1)):
                        self.readers[side][b] = {len(self.vectors[side]): 1}
                        self.vectors[side].append({b: 1, **{c: sign * v for c, v in conjugate[b].items()}})
            done.add(mu)

    def _add_block(self, block: list[int], conjugate: list[Vector]) -> None:
        m = len(block)
        table = QQ.matrix([[conjugate[b].get(c, 0) for c in block] for b in block])  # transposed
        for side, sign in ((0, 1), (1, -1)):
            rows = (table - QQ.identity(m).scale(sign)).left_null_space()
            if rows.nrows == 0:
                continue
            basis = integral_basis(rows)
            inverse = basis.T @ (basis @ basis.T).inverse()  # x = c basis has the coordinates c = x inverse
            start = len(self.vectors[side])
            for b, row in zip(block, inverse.to_rows(), strict=True):
                self.readers[side][b] = {start + k: _number(v) for k, v in enumerate(row) if v != 0}
            for row in basis.to_rows():
                self.vectors[side].append({b: int(QQ.convert(v)) for b, v in zip(block, row, strict=True) if v != 0})

    def matrices(self, operators: list[Operator]) -> list[list[Vector]]:
        """The matrices of operators on the real subspace."""
        return [self._matrix(operator) for operator in operators]

    def _matrix(self, operator: Operator) -> list[Vector]:
        """The matrix of M, which maps V+ and V- to themselves, or of i M, which exchanges them: i M (i y) = -M y."""
        imaginary, columns = operator
        starts = (0, len(self.vectors[0]))
        made = []
        for side, vectors in enumerate(self.vectors):
            target = 1 - side if imaginary else side
            sign = -1 if imaginary and side else 1
            for vector in vectors:
                total: Reader = {}
                image: Vector = {}
                for b, v in vector.items():
                    add_multiple(image, columns[b], v)
                for b, v in image.items():
                    for k, f in self.readers[target].get(b, {}).items():
                        total[k] = total.get(k, 0) + sign * v * f
                made.append({starts[target] + k: int(v) for k, v in total.items() if v})
        return made


def _number(value: Scalar) -> int | Fraction:
    rational = QQ.convert(value)
    return int(rational.p) if rational.q == 1 else Fraction(int(rational.p), int(rational.q))
